"""Controllers that send without end, or never enough: the port is closed with a reason, and the page goes on."""

from __future__ import annotations

import asyncio
import struct
from collections.abc import Callable
from time import perf_counter

import pytest

from elitescript.client import connecting, dashboard, primary, rtsi
from elitescript.client.connecting import Inflow, LinkError
from elitescript.client.primary import PrimaryClient
from elitescript.conversation import limits
from elitescript.errors import PeerError
from elitescript.studio.connected.target import Target
from tests.client.test_primary_messages import message
from tests.studio.connected.fake_controller import FakeController, run, shown

resource = pytest.importorskip("resource", reason="needs POSIX")

FIVE = struct.pack(">IB", 5, 99) * 3000
"""Messages of five bytes, of a type that does not exist."""
TEXTS = message(0, b"y" * 60_000 + b"\0") * 2
EMPTY_FRAMES = struct.pack(">HB", 3, ord("U")) * 5000
OTHER_RECIPES = struct.pack(">HBB", 4, ord("U"), 77) * 5000
RTSI_TEXTS = struct.pack(">HB", 60_003, ord("M")) + b"y" * 60_000


def flooding(data: bytes):
    """Return what serves a port by sending this again and again, whatever is asked."""

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while True:
            writer.write(data)
            await writer.drain()
            await asyncio.sleep(0)

    return serve


async def _longest_pause(done: Callable[[], bool]) -> float:
    """Return the longest time for which other tasks had to wait until something is so, s."""
    longest = 0.0
    for _ in range(20_000):
        if done():
            return longest
        began = perf_counter()
        await asyncio.sleep(0.001)
        longest = max(longest, perf_counter() - began)
    raise AssertionError("it never was so")


@pytest.mark.parametrize(
    ("port", "data", "why"),
    [
        ("primary", FIVE, "sends more than 400 messages a second"),
        ("primary", TEXTS, "sends more than 0.4 MB a second"),
        ("primary", struct.pack(">IB", 0xFFFF_FFFF, 16), "says that it has 4294967295 bytes"),
        ("rtsi", EMPTY_FRAMES, "sends more than 1000 messages a second"),
        ("rtsi", OTHER_RECIPES, "sends more than 1000 messages a second"),
        ("rtsi", RTSI_TEXTS, "sends more than 0.8 MB a second"),
        ("rtsi", bytes(3), "says that it has 0 bytes"),
        ("dashboard", b"y" * 70_000, "has no end"),
    ],
    ids=["five bytes", "texts", "a huge length", "empty frames", "other recipes", "RTSI texts", "no length", "no line"],
)
def test_a_flood_is_closed_with_a_reason_that_every_page_gets(port, data, why, monkeypatch):
    for module, of in ((primary, 0.1), (rtsi, 0.1)):
        monkeypatch.setattr(module, "MESSAGES_PER_S", module.MESSAGES_PER_S * of)
        monkeypatch.setattr(module, "BYTES_PER_S", module.BYTES_PER_S * of)

    async def test():
        fake = FakeController()
        fake.serve[port] = flooding(data)
        await fake.open()
        async with shown(Target("127.0.0.1", fake.ports)) as (_, (page,)):
            pause_s = await _longest_pause(lambda: any(why in notice["text"] for notice in page.of("notice")))
            assert pause_s < 0.5
            text = page.of("notice")[-1]["text"]
            assert all(name not in text for name in ("Error", "Errno"))
            assert text.lower().count(port) == 1, text
        await fake.close()

    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    run(test())
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 64 << 10, "kB"


def test_a_page_that_comes_later_gets_the_reason(monkeypatch):
    async def test():
        fake = FakeController()
        fake.serve["rtsi"] = flooding(bytes(3))
        await fake.open()
        async with shown(Target("127.0.0.1", fake.ports)) as (controller, (page,)):
            await page.until(lambda: page.of("notice"))
            got: list = []
            controller.join(got.append)
            (said,) = [m["text"] for m in got if not isinstance(m, bytes) and m["type"] == "notice"]
            where = f"RTSI port 127.0.0.1:{fake.ports['rtsi']}"
            assert said.endswith(f"{where}: a message says that it has 0 bytes; the shortest has 3")
            controller.leave(got.append)
        await fake.close()

    run(test())


def test_lines_that_nobody_asked_for_are_no_replies_and_a_flood_of_them_ends_the_connection():
    async def test():
        reader = asyncio.StreamReader(limit=1 << 20)
        sent = []

        class Writer:
            def write(self, data: bytes) -> None:
                sent.append(data)
                reader.feed_data(b"Loaded\n")

        client = dashboard.DashboardClient(reader, Writer(), may_command=True)  # type: ignore[arg-type]
        reader.feed_data(b"surprise\nsurprise\n")
        assert await client.ask("task -s") == "Loaded"
        reader.feed_data(b"surprise\n" * 10_000)
        with pytest.raises(PeerError, match="without being asked"):
            await client.ask("task -s")
        with pytest.raises(LinkError, match="out of step"):
            await client.ask("task -s")
        assert sent == [b"task -s\n"]

    run(test())


def test_a_message_that_never_ends_is_silence():
    async def test():
        reader = asyncio.StreamReader()
        client = PrimaryClient(reader, None, may_command=False)  # type: ignore[arg-type]
        reader.feed_data(struct.pack(">IB", 5, 99))
        assert await client.messages(0.2) == []

        async def drip() -> None:
            reader.feed_data(struct.pack(">IB", 1000, 16))
            while True:
                await asyncio.sleep(0.02)
                reader.feed_data(b"\0")

        dripping = asyncio.create_task(drip())
        with pytest.raises(LinkError, match="nothing came in time"):
            while True:
                await client.messages(0.2)
        dripping.cancel()

    run(test())


class TestInflow:
    def test_a_burst_passes_and_what_follows_counts_again_after_a_while(self):
        inflow = Inflow("port", 10, 1e9)
        inflow.take(50, 0, 0.0)
        inflow.take(10, 0, 1.0)
        with pytest.raises(PeerError, match=r"^port: the controller sends more than 10 messages a second"):
            inflow.take(1, 0, 1.0)

    def test_bytes(self):
        inflow = Inflow("port", 1e9, 2e6)
        inflow.take(1, 10_000_000, 100.0)
        inflow.take(1, 2_000_000, 101.0)
        with pytest.raises(PeerError, match="more than 2 MB a second"):
            inflow.take(1, 1, 101.0)

    def test_what_waited_for_a_minute_at_full_speed_is_no_flood(self):
        # 250 packages of 2 kB a second; the socket holds 6 MB of them.
        inflow = Inflow("RTSI", rtsi.MESSAGES_PER_S, rtsi.BYTES_PER_S)
        inflow.take(min(60 * 250, 6_000_000 // 2_000), 6_000_000, 60.0)
        assert connecting.BURST_S == 5.0


def test_reports_are_bounded_and_a_new_run_begins_when_there_are_too_many(monkeypatch):
    monkeypatch.setattr(limits, "LAST_EVENTS", 10)
    monkeypatch.setattr(limits, "BYTES_MAX", 20_000)
    monkeypatch.setattr("elitescript.studio.connected.trail.RENEW_S", 0.5)

    async def test():
        fake = FakeController()
        fake.state += message(0, b"y" * 5_000 + b"\0")
        await fake.open()
        async with shown(Target("127.0.0.1", fake.ports)) as (_, (page,)):
            await page.until(lambda: page.of("left_out") and page.of("left_out")[-1]["events"])
            first = page.of("left_out")[-1]["run"]
            await page.until(lambda: page.of("run_began")[-1]["run"] > first)
            for number in range(1, first + 1):
                lists = [m["list"] for m in page.of("events") if m["run"] == number]
                assert sum(len(event["text"]) for events in lists for event in events) <= 20_000
        await fake.close()

    run(test())
