"""Messages keep their order; of a page that does not read, only the newest state is kept, and all events."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable

from elitescript.studio import outbox
from elitescript.studio.outbox import Outbox


def run(steps: Callable[[Outbox, asyncio.Event], None]) -> tuple[list[object], int]:
    """Return what is sent, and how often the page was disconnected; `send` waits until the event is set."""
    sent: list[object] = []
    overflows: list[None] = []

    async def go() -> None:
        reads = asyncio.Event()

        async def send(data: str | bytes) -> None:
            await reads.wait()
            sent.append(data if isinstance(data, bytes) else json.loads(data))

        box = Outbox(send, lambda: overflows.append(None))
        sending = asyncio.create_task(box.run())
        steps(box, reads)
        for _ in range(50):
            await asyncio.sleep(0)
        sending.cancel()

    asyncio.run(go())
    return sent, len(overflows)


def test_everything_comes_in_its_order() -> None:
    def steps(box: Outbox, reads: asyncio.Event) -> None:
        reads.set()
        box.put({"type": "run_began", "run": 1})
        box.put(b"rows")
        box.put({"type": "events", "list": [1.5, "é", "\ud800", float("nan")]})

    sent, overflows = run(steps)
    assert sent == [
        {"type": "run_began", "run": 1},
        b"rows",
        {"type": "events", "list": [1.5, "é", r"\ud800", "NaN"]},
    ]
    assert overflows == 0


def test_a_newer_state_takes_the_place_of_older_ones_and_events_stay() -> None:
    def steps(box: Outbox, reads: asyncio.Event) -> None:
        for number in range(5):
            box.put({"type": "progress", "t": number})
            box.put({"type": "events", "list": [number]})
            box.put({"type": "moment", "t": number})
        reads.set()

    sent, _ = run(steps)
    assert sent == [
        *({"type": "events", "list": [number]} for number in range(4)),
        {"type": "progress", "t": 4},
        {"type": "events", "list": [4]},
        {"type": "moment", "t": 4},
    ]


def test_a_page_that_never_reads_is_disconnected(monkeypatch) -> None:
    monkeypatch.setattr(outbox, "WAITING_BYTES_MAX", 1000)

    def steps(box: Outbox, reads: asyncio.Event) -> None:
        for _ in range(100):
            box.put({"type": "events", "list": ["x" * 90]})
        reads.set()

    sent, overflows = run(steps)
    assert (sent, overflows) == ([], 1)


def test_a_source_that_can_wait_is_held_back_until_the_page_reads(monkeypatch) -> None:
    monkeypatch.setattr(outbox, "ROOM_BYTES", 100)

    async def go() -> None:
        reads = asyncio.Event()

        async def send(_: str | bytes) -> None:
            await reads.wait()

        box = Outbox(send, lambda: None)
        sending = asyncio.create_task(box.run())
        box.put(b"x" * 90)
        await asyncio.wait_for(box.room(), 1.0)
        box.put(b"x" * 90)
        box.put(b"x" * 90)
        waiting = asyncio.create_task(box.room())
        for _ in range(10):
            await asyncio.sleep(0)
        assert not waiting.done()
        reads.set()
        await asyncio.wait_for(waiting, 1.0)
        sending.cancel()

    asyncio.run(go())
