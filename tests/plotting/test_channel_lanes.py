"""Lanes of connections."""

from collections import Counter

from elitescript.messages.events import ChannelActivity, SignalChanged
from elitescript.plotting.channel_lanes import CHANNELS_MAX, ENTRIES_IN_ALL, ENTRIES_MAX, channel_lanes
from elitescript.plotting.packing import undo_deltas


def test_a_lane_has_what_a_channel_did():
    events = [
        ChannelActivity(250, "camera", "socket", "open", "127.0.0.1:5000", 39, "main"),
        SignalChanged(260, "flag[0]", True),
        ChannelActivity(500, "camera", "socket", "sent", "go\n", 40, "main"),
        ChannelActivity(500, "camera", "rpc", "timeout", "no answer", 41, "main"),
    ]
    found = channel_lanes(events)
    socket, rpc = found["lanes"]
    assert (socket["name"], socket["kind"], socket["total"]) == ("camera", "socket", 2)
    assert undo_deltas(socket["t"]) == [1000, 2000]
    assert [found["whats"][index] for index in socket["what"]] == ["open", "sent"]
    assert [found["texts"][index] for index in socket["data"]] == ["127.0.0.1:5000", "go\n"]
    assert socket["line"] == [39, 40]
    assert "count" not in socket
    assert (rpc["kind"], rpc["total"]) == ("rpc", 1)


def test_a_lane_with_too_many_entries_counts_them_and_keeps_each_trouble():
    whats = ["sent", "received"] * 5000
    whats[7001] = "timeout"
    events = [ChannelActivity(tick, "c", "socket", what, str(tick)) for tick, what in enumerate(whats)]
    found = channel_lanes(events)
    (lane,) = found["lanes"]
    assert ENTRIES_MAX / 3 < len(lane["t"]) <= ENTRIES_MAX
    counts = Counter()
    for what, count in zip(lane["what"], lane["count"], strict=True):
        counts[found["whats"][what]] += count
    assert counts == Counter(whats)
    assert lane["total"] == 10_000
    assert undo_deltas(lane["t"])[[found["whats"][what] for what in lane["what"]].index("timeout")] == 28_004
    assert undo_deltas(lane["t"]) == sorted(undo_deltas(lane["t"]))


def test_entries_of_one_tick_are_thinned_too():
    (lane,) = channel_lanes([ChannelActivity(7, "c", "socket", "sent", str(k)) for k in range(1000)])["lanes"]
    assert (lane["count"], lane["total"]) == ([1000], 1000)


def test_many_channels_share_the_last_lane():
    events = [ChannelActivity(k, f"c{k % 60}", "socket", "sent", "x") for k in range(60 * 40)]
    found = channel_lanes(events)
    *lanes, last = found["lanes"]
    assert [lane["name"] for lane in lanes] == [f"c{k}" for k in range(CHANNELS_MAX)]
    assert (last["name"], last["kind"], last["total"], found["others"]) == ("20 more channels", "", 800, 20)
    assert found["texts"][last["data"][0]] == "socket c40: x"
    assert sum(len(lane["t"]) for lane in found["lanes"]) <= ENTRIES_IN_ALL


def test_hidden_characters_are_written_out():
    found = channel_lanes([ChannelActivity(1, "c\u202ed", "socket", "sent", "a\x07\x00b")])
    assert found["lanes"][0]["name"] == "c\\u202ed"
    assert found["texts"] == ["a\\x07\\x00b"]
