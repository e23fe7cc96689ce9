"""Rows and messages as they come: for what follows an arm live."""

from __future__ import annotations

import asyncio

import pytest

from elitescript.recorder import live
from elitescript.recorder.live import LiveRow, LiveSink
from elitescript.recorder.recording import Message
from elitescript.recorder.session import Session
from tests.recorder.controller import FakeController, served, ticks


def test_rows_have_the_newest_of_everything_in_the_order_of_arrival():
    controller = FakeController(
        ticks(1.0, 60), values=lambda t: {"output_int_register3": int(t > 1.1), "actual_joint_positions": (t,) * 6}
    )
    found: list[LiveRow | Message] = []

    async def test() -> None:
        async with served(controller) as target:
            sink = LiveSink()

            async def follow() -> None:
                while sum(isinstance(item, LiveRow) for item in found) < 60:
                    found.extend(await sink.take())

            await Session(target, [sink], lambda _: None).run(follow())

    asyncio.run(asyncio.wait_for(test(), 20.0))
    rows = [item for item in found if isinstance(item, LiveRow)]
    assert [row.t for row in rows] == ticks(1.0, 60)
    assert all(row.values["actual_joint_positions"] == (row.t,) * 6 for row in rows)
    assert [row.values["output_int_register3"] for row in rows] == [int(t > 1.1) for t in ticks(1.0, 60)]
    assert {item.channel for item in found if isinstance(item, Message)} >= {"events", "dashboard"}
    assert [item.arrived_s for item in found] == sorted(item.arrived_s for item in found)
    assert found[0].arrived_s == 0.0


def test_what_is_not_taken_in_time_is_counted(monkeypatch):
    monkeypatch.setattr(live, "WAITING_MAX", 3)
    sink = LiveSink()
    for number in range(5):
        sink.message("/events", {"type": "gap", "missing": number}, 1_000_000_000 * number)

    async def test() -> list:
        return await sink.take()

    found = asyncio.run(test())
    assert [item.data["missing"] for item in found] == [2, 3, 4]
    assert [item.arrived_s for item in found] == pytest.approx([2.0, 3.0, 4.0])
    assert sink.left_out == 2
