"""Bytes under way: what arrives in which tick."""

from __future__ import annotations

from random import Random

from elitescript.devices.agenda import Agenda
from elitescript.devices.channels.delay_line import DelayLine

CHARACTER_S = 0.001


def arrivals(sendings, **settings):
    """Bytes by tick; `sendings` has what is sent in which tick."""
    agenda = Agenda()
    arrived = {}
    wire = DelayLine(
        agenda, lambda data: arrived.__setitem__(agenda.tick, arrived.get(agenda.tick, b"") + data), **settings
    )
    for tick in range(1, 400):
        agenda.run(tick)
        for data in sendings.get(tick, ()):
            wire.send(data)
    assert wire.waiting == 0
    return arrived


def test_all_of_it_comes_one_tick_later():
    assert arrivals({5: [b"abc", b"de"]}) == {6: b"abcde"}


def test_latency_comes_on_top():
    assert arrivals({5: [b"abc"]}, latency_s=0.04) == {15: b"abc"}


def test_a_line_carries_four_characters_in_a_tick():
    assert arrivals({5: [b"abcdef"]}, byte_s=CHARACTER_S) == {6: b"abcd", 7: b"ef"}


def test_what_is_sent_on_a_busy_line_follows_without_a_gap():
    assert arrivals({5: [b"abcdef"], 6: [b"gh"]}, byte_s=CHARACTER_S) == {6: b"abcd", 7: b"efgh"}


def test_a_device_thinks_before_its_next_answer_also_while_the_one_before_is_under_way():
    found = arrivals({5: [b"abcdefgh"], 15: [b"ij"]}, byte_s=CHARACTER_S, latency_s=0.04)
    assert found == {15: b"abcd", 16: b"efgh", 25: b"ij"}


def test_chunks_of_a_later_sending_wait_for_its_latency():
    assert arrivals({5: [b"abcdef"], 15: [b"gh"]}, chunk=3, latency_s=0.04) == {15: b"abc", 16: b"def", 25: b"gh"}


def test_two_sendings_share_a_chunk():
    assert arrivals({5: [b"abcd", b"ef"]}, chunk=3) == {6: b"abc", 7: b"def"}


def test_the_end_comes_behind_the_bytes():
    agenda = Agenda()
    arrived = []
    wire = DelayLine(agenda, arrived.append, byte_s=CHARACTER_S)
    wire.send(b"abcdef")
    wire.finish(lambda: arrived.append("end"))
    for tick in range(1, 5):
        agenda.run(tick)
    assert arrived == [b"abcd", b"ef", "end"]


def test_nothing_is_lost_doubled_too_early_or_too_fast():
    for seed in range(200):
        random = Random(seed)
        latency = random.choice([0, 1, 7])
        chunk = random.choice([0, 1, 5])
        byte_s = random.choice([0.0, 0.0003, 0.001, 0.0047])
        sendings, number = {}, 0
        for tick in sorted(random.sample(range(1, 60), 6)):
            size = random.randrange(1, 12)
            sendings[tick] = [bytes(range(number, number + size))]
            number += size
        found = arrivals(sendings, latency_s=latency * 0.004, chunk=chunk, byte_s=byte_s)
        assert b"".join(found[tick] for tick in sorted(found)) == bytes(range(number))
        for tick, data in found.items():
            assert not chunk or len(data) <= chunk
            assert not byte_s or len(data) <= 0.004 / byte_s + 1
            for sent, parts in sendings.items():
                assert not set(data) & set(parts[0]) or tick >= sent + max(1, latency)
