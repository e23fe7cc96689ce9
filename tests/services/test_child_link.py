"""Robots in child processes: fakes in the first class; then real ones, which take as long as processes do."""

import asyncio
import os
import signal
import subprocess
import sys
import time
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest

from elitescript.cli.main import main
from elitescript.codec.json_text import from_text, to_text
from elitescript.codec.messages import shape_of
from elitescript.environment.memory import MemoryFiles
from elitescript.errors import ElitescriptError
from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.enums import SafetyMode, TaskState
from elitescript.messages.events import Alarm, Event, TaskStateChanged, TextMessage, Warned
from elitescript.messages.inputs import ChannelCredit, ChannelData, Do, Input, LoadTask, RunUnit
from elitescript.messages.line import LineSettings
from elitescript.messages.machine import PauseTask, PowerOff, SetTcp, StopTask, WriteSignal
from elitescript.messages.outputs import CloseChannel, OpenChannel, OpenLine, Output, TickResult
from elitescript.messages.snapshot import RobotDescription
from elitescript.messages.snapshot_parts import ALL_PARTS, TIME
from elitescript.services.child import buffers, frames, supervision, transport, urgent
from elitescript.services.child import link as child_link
from elitescript.services.child.frames import REFRESH_TICKS
from elitescript.services.child.jail import is_complete
from elitescript.services.child.link import ChildLink
from elitescript.services.child.process import child_environment, is_runnable, processor_time_s
from elitescript.services.child.supervision import BOOTS_MAX, COMPILE_HINT, HANG_LIMIT_TICKS, HINT
from elitescript.services.clients.input_queue import InputQueue
from elitescript.services.journal.replay import Replay
from elitescript.services.journal.writer import Journal, JournalReader
from elitescript.services.options_data import options_from_data
from elitescript.services.time.cycle import Cycle
from tests.protocol.snapshots import description, output

TCP = (0.1, 0.0, 0.2, 0.0, 0.5, 0.0)
PATIENT_S = 30.0
IMPATIENT_S = 0.25
"""Enough for a child that is alive on a busy computer, or the test repeats itself."""


class FakeChild:
    """Stands in for `ChildProcess`: says what the test tells it to."""

    made: list["FakeChild"]

    def __init__(self, on_message: Callable[[str, bytes], None], on_end: Callable[[str], None]) -> None:
        self._on_message, self.end = on_message, on_end
        self.is_watched = True
        """Whether the event loop reads what it says."""
        self.unread: list[tuple[str, bytes]] = []
        self.told: list[tuple[str, Any]] = []
        self.asked: list[int] = []
        """Parts of the snapshot that are read, tick by tick."""
        self.is_killed = self.is_asked = self.is_mute = self.is_compiling = False
        self.has_changed = False
        """Whether its discrete state has changed, so that it shows a snapshot that is not asked for."""
        self.pid, self.log = 4711, "last words"
        self.tick: int | None = None
        """The one that it answers next."""
        self.numbers: list[int] = []
        """Of the ticks that it was asked for."""
        self.due = frames.NEVER
        self.processor_s: float | None = None
        self.has_no_processor = False
        type(self).made.append(self)

    def watch(self, is_watched: bool) -> None:
        self.is_watched = is_watched

    def say(self, letter: str, text: bytes) -> None:
        self.unread.append((letter, text))
        if self.is_watched:
            self.read()

    def read(self) -> None:
        while self.unread:
            self._on_message(*self.unread.pop(0))

    def send(self, letter: str, text: str | bytes) -> None:
        parts = 0
        if letter == frames.TICK:
            number, parts, *_, text = frames.read_tick(text)
            self.numbers.append(number)
            self.asked.append(parts)
        self.told.append((letter, from_text(text) if text else []))
        if letter == frames.LOCK_IN:
            self.say(frames.LOCKED_IN, b'[["files",true,"all of it"]]')
        elif letter == frames.BEGIN:
            self.tick = options_from_data(from_text(text)).first_tick
            self.say(frames.DESCRIBED, to_text(shape_of(RobotDescription).encode(description())).encode())
        elif letter == frames.TICK and not self.is_mute:
            if parts or self.has_changed:
                self.answer()
            else:
                self.answer_without_snapshot()

    def answer(self, **changes: Any) -> None:
        assert self.tick is not None
        whole = output(self.tick, task_state=TaskState.PLAYING, **changes)
        self.tick += 1
        self.say(frames.OUTPUT, frames.answer_content(self.due, to_text(shape_of(Output).encode(whole))))

    def answer_without_snapshot(self) -> None:
        assert self.tick is not None
        result = TickResult(self.tick, (), (), ())
        self.tick += 1
        self.say(frames.RESULT, frames.answer_content(self.due, to_text([31, shape_of(TickResult).encode(result)])))

    def worked_s(self) -> float | None:
        return self.processor_s

    def is_runnable(self) -> bool:
        return self.has_no_processor

    def ask_where(self) -> None:
        self.is_asked = True

    def where(self) -> tuple[str, int] | None:
        return ("<primary#1>", 12) if self.is_asked and not self.is_compiling else None

    def kill(self) -> None:
        self.is_killed = True

    async def gone(self) -> None:
        """It is."""


@pytest.fixture
def children(monkeypatch):
    FakeChild.made = []
    monkeypatch.setattr(transport, "ChildProcess", FakeChild)
    return FakeChild.made


@pytest.fixture
def clock(monkeypatch):
    """A monotonic clock that the test moves."""
    now = [100.0]
    monkeypatch.setattr(child_link.time, "monotonic", lambda: now[0])
    return now


def with_link(body: Callable[[ChildLink], Awaitable[None]], **options: Any) -> None:
    async def run() -> None:
        link = ChildLink(RobotOptions(), **{"grace_s": 0.0, **options})
        await link.open()
        try:
            await body(link)
        finally:
            await link.close()

    asyncio.run(run())


class TestLink:
    """The rules, with a child that does what the test wants."""

    def test_asks_for_a_snapshot_only_where_one_is_read_and_now_and_then(self, children):
        async def body(link):
            shown = []
            for tick in range(2 * REFRESH_TICKS + 10):
                shown.append((await link.tick((), ALL_PARTS if tick in (3, 40) else 0)).snapshot.robot.tick)
            asked = [tick for tick, parts in enumerate(children[0].asked) if parts]
            assert asked == [0, 3, 3 + REFRESH_TICKS, 40, 40 + REFRESH_TICKS - 6][:4]
            assert [tick for tick, of in enumerate(shown) if tick == of] == asked

        with_link(body, grace_s=IMPATIENT_S)

    def test_leaps_to_the_tick_that_it_is_given(self, children):
        async def body(link):
            assert link.due_tick == 0
            child = children[0]
            child.due = 900
            await link.tick(())
            assert link.due_tick == 900
            child.tick, child.due = 40, frames.NEVER
            assert (await link.tick((), 0, 40)).tick == child.numbers[-1] == 40
            assert link.due_tick is None
            child.tick, child.due = 50, 7
            await link.tick((), 0, 50)
            assert link.due_tick == 51

        with_link(body, grace_s=IMPATIENT_S)

    def test_every_tick_is_due_while_the_child_is_late_or_gone(self, children):
        async def body(link):
            due = []
            link.watch(lambda: due.append(link.due_tick))
            await link.tick(())
            assert link.due_tick is None
            children[0].is_mute = True
            for tick in range(1, 4):
                await link.tick((), 0)
                assert link.due_tick == tick + 1
            for _ in range(3):
                children[0].answer()
            children[0].is_mute = False
            # Three outputs wait for the ticks to come.
            assert link.due_tick == 4
            while link.due_tick is not None:
                await link.tick((), 0)
                assert link._next < 1000
            tick = link._next
            assert due == []
            children[0].end("it has ended")
            assert due == [tick]
            (alarm, _) = (await link.tick((), 0, tick)).events
            assert (alarm.code, alarm.tick) == ("R132", tick)
            assert link.due_tick == tick + 1
            await link.tick((), 0)
            assert (await link.tick((), 0)).tick == tick + 2
            assert link.due_tick is None

        with_link(body, grace_s=IMPATIENT_S)

    def test_reads_answers_when_outputs_leave_while_every_tick_runs(self, children):
        async def body(link):
            child = children[0]
            await link.tick(())
            seen = []

            async def outlet() -> None:
                seen.append((child.is_watched, len(child.unread)))

            for _ in range(3):
                assert (await link.tick((), 0, asks_due=False, outlet=outlet)).tick == link._next - 1
            assert seen == [(False, 1)] * 3
            # The end of a child that is leapt over ticks is seen at once.
            await link.tick((), 0, outlet=outlet)
            assert seen.pop() == (True, 0)
            await link.tick((), 0, asks_due=False, outlet=outlet)
            await link.tick((), 0)
            assert child.is_watched

        with_link(body, grace_s=IMPATIENT_S)

    def test_an_answer_that_is_there_at_the_outlet_takes_no_turn_of_the_event_loop(self, children):
        async def body(link):
            async def outlet() -> None:
                pass

            await link.tick(())
            for _ in range(3):
                with pytest.raises(StopIteration) as ended:
                    link.tick((), 0, asks_due=False, outlet=outlet).send(None)
                assert ended.value.value.tick == link._next - 1
            # Nothing but the link gives the loop a turn where ticks come without a pause.
            without_outlet = link.tick((), 0)
            without_outlet.send(None)
            with pytest.raises(StopIteration):
                without_outlet.send(None)

        with_link(body, grace_s=IMPATIENT_S)

    def test_a_child_whose_answer_was_late_is_watched_for_a_second(self, children):
        async def body(link):
            child = children[0]
            await link.tick(())
            watched = []

            async def outlet() -> None:
                watched.append(child.is_watched)

            child.is_mute = True
            await link.tick((), 0, asks_due=False, outlet=outlet)
            assert child.is_watched
            child.answer()
            child.is_mute = False
            for _ in range(252):
                await link.tick((), 0, asks_due=False, outlet=outlet)
            assert watched == [False] + [True] * 249 + [False] * 3

        with_link(body, grace_s=IMPATIENT_S)

    def test_takes_a_snapshot_that_the_child_sends_by_itself(self, children):
        async def body(link):
            await link.tick((), ALL_PARTS)
            children[0].has_changed = True
            outputs = [await link.tick((), 0) for _ in range(3)]
            assert [found.has(TIME) for found in outputs] == [True] * 3

        with_link(body, grace_s=IMPATIENT_S)

    def test_a_child_that_keeps_a_snapshot_back_is_replaced(self, children):
        async def body(link):
            await link.tick(())
            children[0].is_mute = True
            await link.tick(())
            children[0].answer_without_snapshot()
            found = await link.tick(())
            assert "lacks the snapshot that was asked for" in found.events[0].text

        with_link(body)

    def test_the_alarm_has_the_line_of_a_tick_without_a_snapshot(self, children):
        async def body(link):
            await link.tick(())
            await link.tick((), 0)
            children[0].end("it has ended")
            (alarm, _) = (await link.tick((), 0)).events
            assert (alarm.code, alarm.line) == ("R132", 31)

        with_link(body, grace_s=IMPATIENT_S)

    def test_while_outputs_leave_late_every_tick_has_its_snapshot(self, children):
        async def body(link):
            await link.tick(())
            children[0].is_mute = True
            await link.tick((), 0)
            await link.tick((), 0)
            assert children[0].asked[-2:] == [0, ALL_PARTS]

        with_link(body)

    def test_gives_ticks_and_takes_outputs(self, children):
        async def body(link):
            outputs = [await link.tick([Do("a", SetTcp(TCP))] if tick == 1 else ()) for tick in range(3)]
            assert [found.tick for found in outputs] == [0, 1, 2]
            assert [len(data) for letter, data in children[0].told if letter == frames.TICK] == [0, 1, 0]

        with_link(body)

    def test_shows_the_last_picture_while_the_child_is_late(self, children):
        async def body(link):
            first = await link.tick(())
            children[0].is_mute = True
            late = [await link.tick(()) for _ in range(5)]
            assert [found.tick for found in late] == [1, 2, 3, 4, 5]
            assert all(found.snapshot is first.snapshot for found in late)
            for _ in range(5):
                children[0].answer(events=(TextMessage(1, "x", "main", 1),))
            children[0].is_mute = False
            made_up = await link.tick(())
            assert (made_up.tick, made_up.snapshot.robot.tick, len(made_up.events)) == (6, 4, 4)
            after = await link.tick(())
            assert (after.tick, after.snapshot.robot.tick, len(after.events)) == (7, 5, 1)
            assert link.restarts == 0

        with_link(body)

    def test_a_silent_child_is_replaced_and_reported(self, children, clock):
        async def body(link):
            await link.tick(())
            children[0].is_mute = True
            await link.tick([Do("poison", SetTcp(TCP))])
            await link.tick([Do("later", WriteSignal("flag", 0, True))])
            clock[0] += 0.8
            for _ in range(HANG_LIMIT_TICKS - 1):
                await link.tick(())
            assert children[0].is_asked
            assert not children[0].is_killed
            reported = await link.tick(())
            assert children[0].is_killed
            alarm, stopped = reported.events
            assert isinstance(alarm, Alarm)
            assert (alarm.code, alarm.line, alarm.details["program"]) == ("R132", 12, "<primary#1>")
            assert "0.80 s" in alarm.text
            assert stopped == TaskStateChanged(reported.tick, TaskState.STOPPED, "", "alarm")
            after = await link.tick(())
            assert after.snapshot.robot.tick == after.tick == reported.tick + 1
            _, inputs = next((letter, data) for letter, data in children[1].told if letter == frames.TICK)
            assert ["Do", "later", ["WriteSignal", "flag", 0, True], False] in inputs
            assert not any(item[1] == "poison" for item in inputs)
            assert link.restarts == 1

        with_link(body)

    @pytest.mark.parametrize(
        "wall_s, processor_s, is_given_up",
        [
            (0.8, 0.75, True),
            (0.8, 0.6, False),
            (4.9, 0.6, False),
            (4.9, 0.75, True),
            (5.1, 0.0, True),
            (0.8, None, True),
            (0.6, None, False),
        ],
    )
    def test_a_child_that_only_gets_no_processor_is_waited_for(self, children, clock, wall_s, processor_s, is_given_up):
        async def body(link):
            worked_before_s = None if processor_s is None else 3.0
            children[0].processor_s = worked_before_s
            await link.tick(())
            children[0].is_mute = True
            for _ in range(HANG_LIMIT_TICKS + 1):
                await link.tick(())
            clock[0] += wall_s
            if processor_s is not None:
                children[0].processor_s = worked_before_s + processor_s
            await link.tick(())
            assert children[0].is_asked is is_given_up

        with_link(body)

    @pytest.mark.parametrize("has_no_processor", [True, False])
    def test_a_child_that_waits_for_a_processor_does_not_hang(self, children, clock, has_no_processor):
        async def body(link):
            child = children[0]
            child.processor_s, child.has_no_processor = 3.0, has_no_processor
            await link.tick(())
            child.is_mute = True
            for _ in range(HANG_LIMIT_TICKS + 1):
                await link.tick(())
            clock[0] += 60.0
            child.processor_s += 0.6
            await link.tick(())
            assert child.is_asked is not has_no_processor
            # What it has worked counts in any case.
            child.processor_s += 0.2
            await link.tick(())
            assert child.is_asked

        with_link(body)

    @pytest.mark.parametrize(
        "size, busy_s, is_given_up", [(0, 1.0, True), (400_000, 15.5, False), (400_000, 17.0, True)]
    )
    def test_a_long_program_has_longer_to_compile(self, children, clock, size, busy_s, is_given_up):
        async def body(link):
            children[0].processor_s = 0.0
            await link.tick(())
            children[0].is_mute = children[0].is_compiling = True
            await link.tick([RunUnit("primary#1", "program", "x" * size)] if size else ())
            for _ in range(HANG_LIMIT_TICKS + 1):
                await link.tick(())
            clock[0] += busy_s
            children[0].processor_s += busy_s
            await link.tick(())
            clock[0] += 1.0
            found = await link.tick(())
            alarms = [event for event in found.events if isinstance(event, Alarm)]
            assert bool(alarms) is is_given_up
            if size and is_given_up:
                assert f"a program text of {size} bytes was not compiled within 18.0 s" in alarms[0].text
                assert alarms[0].details == {"hint": COMPILE_HINT}

        with_link(body)

    def test_the_text_of_a_task_counts_like_that_of_a_client(self, children, clock):
        async def body(link):
            children[0].processor_s = 0.0
            await link.tick(())
            children[0].is_mute = True
            await link.tick([LoadTask("dashboard#1", "long.task")])
            children[0].say(frames.QUESTION, to_text(["open", "long.script", "rb"]).encode())
            children[0].say(frames.QUESTION, to_text(["read", 1, 0, 1 << 18]).encode())
            for _ in range(HANG_LIMIT_TICKS + 1):
                await link.tick(())
            clock[0] += 2.0
            children[0].processor_s += 2.0
            await link.tick(())
            assert not children[0].is_asked

        with_link(body, files=MemoryFiles({"long.script": b"x" * (1 << 18)}))

    @pytest.mark.parametrize("lasts_s, is_given_up", [(9.0, False), (12.0, True)])
    def test_a_loop_over_files_is_no_hang_until_it_lasts_too_long(self, children, clock, lasts_s, is_given_up):
        async def body(link):
            children[0].processor_s = 0.0
            await link.tick(())
            children[0].is_mute = True
            for _ in range(HANG_LIMIT_TICKS + 1):
                await link.tick(())
            found = []
            for _ in range(round(lasts_s / 0.5)):
                clock[0] += 0.5
                children[0].processor_s += 0.5
                children[0].say(frames.QUESTION, to_text(["kind", "x"]).encode())
                found += (await link.tick(())).events
            texts = [event.text for event in found if isinstance(event, Alarm)]
            assert bool(texts) is is_given_up
            assert all("has worked with files for more than 10 s in one tick" in text for text in texts)

        with_link(body)

    def test_clients_do_not_wait_for_what_queued_up_while_a_program_compiled(self, children, monkeypatch):
        waited: list[float] = []

        async def wait(link, is_over, longest_s):
            waited.append(longest_s)

        async def body(link):
            await link.tick(())
            monkeypatch.setattr(ChildLink, "_wait_until", wait)
            children[0].is_mute = True
            await link.tick([RunUnit("primary#1", "program", "x")])
            for _ in range(child_link.LAG_MAX + 20):
                await link.tick(())
            children[0].answer()
            waited.clear()
            await link.tick(())
            assert waited == []

        with_link(body)

    def test_a_child_that_is_a_little_late_is_waited_for_so_that_no_tick_is_missing(self, children):
        async def body(link):
            await link.tick(())
            loop = asyncio.get_running_loop()
            children[0].is_mute = True
            for tick in range(1, 20):
                loop.call_soon(children[0].answer)
                found = await link.tick(())
                assert (found.tick, found.snapshot.robot.tick) == (tick, tick)

        with_link(body, grace_s=PATIENT_S / 2, hang_limit_s=PATIENT_S)

    def test_who_waits_again_and_again_runs_out_of_grace(self, children, monkeypatch):
        waited: list[float] = []

        async def wait(link, is_over, longest_s):
            waited.append(longest_s)
            now[0] += longest_s

        now = [100.0]

        async def body(link):
            await link.tick(())
            monkeypatch.setattr(child_link.time, "monotonic", lambda: now[0])
            monkeypatch.setattr(ChildLink, "_wait_until", wait)
            children[0].is_mute = True
            for _ in range(6):
                await link.tick(())
            assert waited == pytest.approx([0.02, 0.0025, 0.0025, 0.0, 0.0, 0.0])

        with_link(body, grace_s=0.02)

    def test_every_answer_begins_the_silence_anew(self, children, clock):
        async def body(link):
            children[0].processor_s = 0.0
            await link.tick(())
            children[0].is_mute = True
            for _ in range(2 * HANG_LIMIT_TICKS):
                await link.tick(())
            for _ in range(HANG_LIMIT_TICKS):
                await link.tick(())
                clock[0] += 0.5
                children[0].processor_s += 0.5
                children[0].answer()
            assert not children[0].is_asked

        with_link(body)

    def test_who_was_away_himself_does_not_complain(self, children, clock):
        async def body(link):
            await link.tick(())
            children[0].is_mute = True
            await link.tick(())
            clock[0] += 1000.0
            await link.tick(())
            assert not children[0].is_asked

        with_link(body)

    def test_at_most_two_ticks_are_under_way_and_what_comes_in_joins_the_next_one(self, children):
        """A stop does not wait behind ticks that were asked for before it came."""

        async def body(link):
            await link.tick(())
            child = children[0]
            child.is_mute = True
            for _ in range(10):
                await link.tick(())
            await link.tick((Do("dashboard#1", StopTask()),))
            assert child.numbers == [0, 1, 2]
            child.answer()
            assert child.numbers == [0, 1, 2, 3]
            assert [text for letter, text in child.told if letter == frames.TICK][-1]
            for _ in range(3):
                child.answer()
            assert child.numbers == [*range(7)]
            assert [text for letter, text in child.told if letter == frames.TICK][-3:] == [[], [], []]
            assert link.due_tick == 12

        with_link(body)

    def test_a_child_that_takes_the_place_of_another_one_gets_no_tick_of_before(self, children):
        async def body(link):
            await link.tick(())
            children[0].is_mute = True
            for _ in range(5):
                await link.tick(())
            children[0].end("gone")
            await link.tick(())
            await link.tick(())
            assert children[1].numbers == [7]

        with_link(body)

    @pytest.mark.parametrize(
        ("item", "limit_s"),
        [
            (Do("dashboard#1", StopTask()), urgent.STOP_S),
            (Do("ctl#1", WriteSignal("emergency_stop", 0, True)), urgent.STOP_S),
            (Do("ctl#1", PowerOff()), urgent.STOP_S),
            (RunUnit("primary#2", "program", "def other():\n  pass\nend\n"), urgent.REPLACE_S),
        ],
        ids=["stop", "emergency stop", "power off", "program"],
    )
    def test_a_child_that_does_not_answer_a_stop_is_ended_for_it(self, children, clock, item, limit_s):
        async def body(link):
            await link.tick(())
            child = children[0]
            child.is_mute, child.processor_s = True, 1.0
            await link.tick(())
            clock[0] += 0.3
            await link.tick((item,))
            clock[0] += 1.01 * limit_s
            # On a busy computer it has not worked: it is waited for.
            await link.tick(())
            assert not child.is_killed
            assert child.is_asked
            child.processor_s += 1.01 * limit_s * urgent.WORKED_SHARE
            found = await link.tick(())
            assert child.is_killed
            stopped, alarm = (event for event in found.events if isinstance(event, TaskStateChanged | Alarm))
            assert (stopped.state, stopped.ending) == (TaskState.STOPPED, "stopped")
            assert (alarm.code, alarm.line) == ("R132", 12)
            shown = found.rows[-1].snapshot.robot
            assert (shown.tick, shown.task_state) == (found.tick, TaskState.STOPPED)
            is_emergency = isinstance(item, Do) and isinstance(item.request, WriteSignal)
            assert (shown.safety_mode is SafetyMode.ROBOT_EMERGENCY_STOP) == is_emergency
            assert found.rows[-1].snapshot.signals["emergency_stop"] == (is_emergency,)
            # The next child gets it, whatever the last one has done.
            await link.tick(())
            assert len(children) == 2
            assert to_text(shape_of(Input).encode(item)) in to_text([text for _, text in children[1].told])

        with_link(body)

    @pytest.mark.parametrize("item", [Do("dashboard#1", PauseTask()), Do("ctl#1", SetTcp(TCP))], ids=["pause", "tcp"])
    def test_no_child_is_ended_for_anything_else(self, children, clock, item):
        async def body(link):
            await link.tick(())
            children[0].is_mute = True
            await link.tick(())
            await link.tick((item,))
            clock[0] += 0.5
            await link.tick(())
            assert not children[0].is_killed

        with_link(body)

    def test_a_stop_waits_for_a_text_that_is_compiled_but_not_for_a_call_of_the_program(self, children, clock):
        async def body(link):
            await link.tick(())
            child = children[0]
            child.is_mute = child.is_compiling = True
            await link.tick((RunUnit("primary#1", "program", "def p():\n  pass\nend\n"),))
            await link.tick((Do("dashboard#1", StopTask()),))
            clock[0] += 0.3
            await link.tick(())
            assert not child.is_killed
            child.is_compiling = False
            await link.tick(())
            assert child.is_killed

        with_link(body)

    def test_something_urgent_ends_the_wait_for_a_late_output(self, children):
        """The tick that has it is not sent behind a wait of a tenth of a second."""

        async def body(link):
            await link.tick(())
            children[0].is_mute = True
            waiting = asyncio.get_running_loop().create_task(link.tick(()))
            await asyncio.sleep(0)
            assert not waiting.done()
            link.hurry((Do("ctl#1", SetTcp(TCP)),))
            await asyncio.sleep(0)
            assert not waiting.done()
            link.hurry((Do("dashboard#1", StopTask()),))
            await waiting

        with_link(body, grace_s=PATIENT_S)

    def test_a_caller_that_does_not_pace_itself_waits_for_room(self, children, monkeypatch):
        monkeypatch.setattr(child_link, "BEHIND_MAX", 4)

        async def body(link):
            await link.tick(())
            children[0].is_mute = True
            for _ in range(4):
                await link.tick(())
            waiting = asyncio.get_running_loop().create_task(link.tick(()))
            await asyncio.sleep(0)
            assert not waiting.done()
            for _ in range(4):
                children[0].answer()
            await waiting
            assert [letter for letter, _ in children[0].told].count(frames.TICK) == 6

        with_link(body)

    def test_a_child_that_answers_too_slowly_holds_time_back(self, children, monkeypatch):
        """Who keeps time counts it then; otherwise what is asked for would be done later and later."""
        monkeypatch.setattr(child_link, "LAG_MAX", 4)

        async def body(link):
            await link.tick(())
            children[0].is_mute = True
            for _ in range(4):
                await link.tick(())
            for _ in range(10):
                waiting = asyncio.get_running_loop().create_task(link.tick(()))
                await asyncio.sleep(0)
                assert not waiting.done()
                children[0].answer()
                await waiting
                assert link._behind(link._transport) == 4

        with_link(body)

    def test_a_child_that_does_not_answer_at_all_holds_nothing_back(self, children, clock, monkeypatch):
        monkeypatch.setattr(child_link, "LAG_MAX", 4)

        async def body(link):
            await link.tick(())
            children[0].is_mute = True
            await link.tick(())
            clock[0] += 2 * child_link.LAG_S
            for _ in range(10):
                await link.tick(())
            assert link._behind(link._transport) == 11

        with_link(body)

    def test_programs_reach_a_child_that_never_catches_up(self, children):
        async def body(link):
            await link.tick(())
            children[0].is_mute = True
            box = InputQueue()
            box.post([RunUnit("primary#1", "program", "def p():\n  pass\nend\n") for _ in range(3)])
            for _ in range(2 * buffers.BUSY_TICKS):
                await link.tick(())
            taken = []
            for _ in range(30):
                found = box.take(link.room)
                taken.append(len(found))
                await link.tick(found)
            assert sum(taken) == 3
            assert max(taken) == 1

        with_link(body)

    @pytest.mark.parametrize(
        "request_",
        [OpenChannel(7, "tcp", "10.0.0.1", 50001, 1.0), OpenLine(7, "tool", LineSettings(9600, 0, 1, 8))],
        ids=["connection", "serial line"],
    )
    def test_channels_of_a_dead_child_are_closed(self, children, request_):
        async def body(link):
            await link.tick(())
            children[0].is_mute = True
            await link.tick(())
            children[0].answer(requests=(request_,))
            await link.tick([ChannelData(7, b"x"), ChannelData(8, b"of nobody")])
            assert [item[1] for item in children[0].told[-1][1]] == [7]
            children[0].end("it has ended")
            found = await link.tick(())
            assert CloseChannel(7) in found.requests
            await link.tick([ChannelData(7, b"late")])
            assert not any(item[0] == "ChannelData" for item in children[1].told[-1][1])

        with_link(body)

    @pytest.mark.parametrize(
        ("letter", "text"),
        [
            (frames.OUTPUT, b"[]"),
            (frames.OUTPUT, b"{"),
            (frames.OUTPUT, b'["__import__","os"]'),
            (frames.QUESTION, b'["open","../../etc/passwd"]'),
            (frames.QUESTION, b"5"),
            (frames.LOCKED_IN, b"[1]"),
            (frames.DESCRIBED, b"[]"),
            (frames.FAILED, b"[1,2,3]"),
            ("x", b"[]"),
            ("\xff", b""),
        ],
    )
    def test_a_child_that_talks_nonsense_is_replaced(self, children, letter, text):
        async def body(link):
            await link.tick(())
            children[0].is_mute = True
            await link.tick(())
            children[0].say(letter, text)
            found = await link.tick(())
            assert children[0].is_killed
            assert found.events[0].code == "R132"
            assert link.restarts == 1

        with_link(body)

    def test_a_child_that_answers_unasked_or_another_tick_is_replaced(self, children):
        async def body(link):
            await link.tick(())
            children[0].answer()
            await link.tick(())
            assert children[0].is_killed
            await link.tick(())
            children[1].tick += 5
            await link.tick(())
            await link.tick(())
            assert children[1].is_killed

        with_link(body)

    def test_a_child_that_talks_too_much_is_replaced(self, children):
        async def body(link):
            await link.tick(())
            talk = tuple(TextMessage(1, "x", "main", number) for number in range(20_000))
            children[0].is_mute = True
            for _ in range(50):
                await link.tick(())
                if not link.restarts:
                    children[0].answer(events=talk)
            assert link.restarts == 1

        with_link(body)

    def test_gives_up_when_no_child_answers(self, children, monkeypatch):
        monkeypatch.setattr(supervision, "PAUSES_TICKS", (0,))

        async def body(link):
            await link.tick(())
            children[0].is_mute = True
            for _ in range(BOOTS_MAX + 5):
                children[-1].is_mute = True
                children[-1].end("it has ended")
                await link.tick(())

        with pytest.raises(ElitescriptError, match="times"):
            with_link(body)

    def test_nothing_of_the_connections_of_one_child_comes_to_the_next(self, children):
        async def body(link):
            await link.tick(())
            children[0].is_mute = True
            await link.tick(())
            children[0].answer(requests=(OpenChannel(1, "tcp", "10.0.0.1", 50001, 1.0),))
            await link.tick(())
            await link.tick([ChannelData(1, b"x"), Do("later", SetTcp(TCP)), ChannelCredit(1, 5)])
            children[0].end("it has ended")
            for _ in range(3):
                await link.tick([ChannelCredit(1, 5)])
            told = [item for letter, data in children[1].told if letter == frames.TICK for item in data]
            assert any(item[1] == "later" for item in told)
            assert not any(item[0].startswith("Channel") for item in told)

        with_link(body)

    def test_what_came_while_there_was_no_child_is_done_over_ticks_in_its_order(self, children):
        async def body(link):
            await link.tick(())
            children[0].end("it has ended")
            children[0].is_mute = True
            sent = [RunUnit("primary#1", "secondary", f"sec s():\n  x = {number}\nend\n") for number in range(100)]
            assert link.room is None
            for number in range(0, 100, 10):
                await link.tick(sent[number : number + 10])
            for _ in range(20):
                await link.tick(())
            ticks = [data for letter, data in children[1].told if letter == frames.TICK]
            assert max(len([item for item in data if item[0] == "RunUnit"]) for data in ticks) <= 40
            assert [item[3] for data in ticks for item in data if item[0] == "RunUnit"] == [one.text for one in sent]
            assert link.room == 1.0

        with_link(body)

    def test_children_that_end_again_and_again_are_started_later_each_time(self, children, monkeypatch):
        monkeypatch.setattr(supervision, "PAUSES_TICKS", (0, 0, 0, 6, 12, 25, 50, 100))
        monkeypatch.setattr(supervision, "CALM_TICKS", 60)

        async def body(link):
            await link.tick(())
            alarms, ticks = [], []
            for _ in range(6):
                children[-1].end("it has ended")
                known = len(children)
                alarms.append((await link.tick(())).events[0].text)
                waited = 0
                while len(children) == known:
                    assert link.room is None
                    assert (await link.tick([Do("a", WriteSignal("flag", 0, True))])).events == ()
                    waited += 1
                await link.tick(())
                ticks.append(waited)
            assert ticks == [0, 0, 6, 12, 25, 50]
            assert "later" not in alarms[1]
            assert "after 3 times in a row it starts 0.024 s later" in alarms[2]
            for _ in range(60):
                await link.tick(())
            children[-1].end("it has ended")
            assert "later" not in (await link.tick(())).events[0].text

        with_link(body)

    def test_a_child_that_cannot_be_started_just_now_is_started_later(self, children, monkeypatch):
        async def body(link):
            await link.tick(())
            failures = [OSError(11, "Resource temporarily unavailable")]

            def starting(*arguments):
                if failures:
                    raise failures.pop()
                return FakeChild(*arguments)

            monkeypatch.setattr(transport, "ChildProcess", starting)
            children[0].end("it has ended")
            for _ in range(supervision.PAUSES_TICKS[-1] + 5):
                last = await link.tick(())
            assert last.snapshot.robot.tick == last.tick

        with_link(body)

    def test_inputs_that_find_no_room_are_told_once_with_their_number(self, children, monkeypatch):
        monkeypatch.setattr(buffers, "WAITING_MAX", 3)

        async def body(link):
            await link.tick(())
            children[0].end("it has ended")
            found = await link.tick([Do("a", SetTcp(TCP))] * 5)
            found = [*found.events, *(await link.tick([Do("a", SetTcp(TCP))] * 5)).events]
            found += (await link.tick(())).events
            warnings = [event.text for event in found if isinstance(event, Warned)]
            assert len(warnings) == 1
            assert "7 inputs were refused" in warnings[0]

        with_link(body)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such clock")
def test_processor_time_of_a_process_is_known():
    before_s = time.process_time()
    found_s = processor_time_s(os.getpid())
    assert found_s is not None
    assert before_s <= found_s <= time.process_time()
    assert processor_time_s(2**22 + 1) is None


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not show it")
def test_whether_a_process_waits_for_a_processor_is_known():
    assert is_runnable(os.getpid())
    with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as sleeping:
        while is_runnable(sleeping.pid):
            time.sleep(0.01)
        sleeping.communicate(b"\n")
    assert not is_runnable(sleeping.pid)


def test_a_child_gets_a_clean_environment(monkeypatch):
    monkeypatch.setenv("SECRET_TOKEN", "x")
    environment = child_environment()
    assert "SECRET_TOKEN" not in environment
    assert environment["PYTHONHASHSEED"] == "0"
    assert set(environment) <= {
        "PYTHONHASHSEED",
        "PYTHONUTF8",
        "PYTHONPATH",
        "PYTHONHOME",
        "LD_LIBRARY_PATH",
    }


real = pytest.mark.skipif(os.name != "posix", reason="children inherit a socket, as POSIX has it")


def served(body: Callable[[ChildLink], Awaitable[None]], **options: Any) -> None:
    """Run with a real child."""

    async def run() -> None:
        link = ChildLink(RobotOptions(power_on=True), **options)
        await link.open()
        try:
            await body(link)
        finally:
            await link.close()

    asyncio.run(run())


PROGRAM = """def p():
  f = open("points.txt")
  textmsg(f.read())
  f.close()
  with open("log.txt", "a") as f:
    f.write("began")
  movej([0.1, -1.4, -1.6, -1.5, 1.5, 0.2])
  set_standard_digital_out(1, True)
  textmsg({"c", "a", "b"})
"""


@real
class TestChild:
    def test_does_the_same_as_a_robot_in_this_process(self):
        files = {"points.txt": b"1, 2, 3"}
        inputs = {3: [RunUnit("primary#1", "program", PROGRAM)], 50: [Do("rtsi#1", WriteSignal("flag", 1, True))]}
        from elitescript.environment.memory import MemoryEnvironment

        world = MemoryEnvironment(dict(files))
        kernel = Kernel(RobotOptions(power_on=True), world)
        expected = [kernel.tick_and_snapshot(inputs.get(tick, ())) for tick in range(300)]
        theirs = MemoryFiles(dict(files))

        async def body(link):
            found = [await link.tick(inputs.get(tick, ())) for tick in range(300)]
            order = [event.text for one in found for event in one.events if isinstance(event, TextMessage)]
            assert order[0] == "1, 2, 3"
            # The order of a set depends on the hash seed of the process.
            strip = [
                tuple(event for event in one.events if not (isinstance(event, TextMessage) and "{" in event.text))
                for one in found
            ]
            wanted = [
                tuple(event for event in one.events if not (isinstance(event, TextMessage) and "{" in event.text))
                for one in expected
            ]
            assert strip == wanted
            assert [one.snapshot for one in found] == [one.snapshot for one in expected]
            assert theirs.contents == world.files.contents
            assert theirs.contents["log.txt"] == b"began"

        served(body, files=theirs, grace_s=PATIENT_S, hang_limit_s=PATIENT_S)

    def test_a_restart_keeps_what_a_program_has_done_though_nothing_reads_it(self):
        lines = (
            "set_tcp([0.1, 0, 0.2, 0, 0.5, 0])",
            "set_payload(1.5, [0, 0, 0.1])",
            "movej([0.1, -1.4, -1.6, -1.5, 1.5, 0.2], a=6, v=3)",
            "set_standard_digital_out(1, True)",
            "write_output_integer_register(3, 77)",
            'textmsg("done")',
            "sleep(0.3)",
            "sum(range(10**12))",
        )
        program = "def p():\n" + "".join(f"  {line}\n" for line in lines)

        async def body(link):
            cycle, outputs = Cycle(), [await link.tick([RunUnit("primary#1", "program", program)])]
            alarms: list[Alarm] = []
            while not alarms or outputs[-1].snapshot.robot.tick <= alarms[0].tick:
                assert len(outputs) < 2500
                await cycle.next()
                outputs.append(await link.tick((), 0))
                alarms += [event for event in outputs[-1].events if isinstance(event, Alarm)]
            cycle.close()
            events = [event for one in outputs for event in one.events]
            assert [event.text for event in events if isinstance(event, TextMessage)] == ["done"]
            assert link.restarts == 1
            before, after = next(one for one in outputs if one.tick == alarms[0].tick - 1), outputs[-1]
            old, new = before.snapshot, after.snapshot
            assert old.robot.tcp_offset == new.robot.tcp_offset == TCP
            assert old.robot.payload.mass_kg == new.robot.payload.mass_kg == 1.5
            assert new.signals["standard_digital_out"][1] is True
            assert new.signals["output_int_register"][3] == 77
            assert new.robot.q_actual == pytest.approx((0.1, -1.4, -1.6, -1.5, 1.5, 0.2), abs=0.02)

        served(body, hang_limit_s=0.5)

    def test_is_locked_in(self):
        async def body(link):
            if sys.platform != "linux":
                pytest.skip("the jail needs Linux")
            if not is_complete(link.layers):
                pytest.skip("; ".join(layer.detail for layer in link.layers if not layer.is_active))
            assert len(link.layers) == 5

        served(body)

    def test_says_why_it_cannot_begin(self):
        async def run() -> None:
            link = ChildLink(RobotOptions(joints=(99.0,) * 6), is_jailed=False)
            await link.open()

        with pytest.raises(ElitescriptError, match="joint"):
            asyncio.run(run())

    def test_an_endless_loop_disturbs_nothing(self):
        async def body(link):
            await link.tick([RunUnit("primary#1", "program", "def p():\n  while True:\n    pass\n")])
            found = [await link.tick(()) for _ in range(50)]
            assert [one.tick for one in found] == list(range(1, 51))
            assert [one.snapshot.robot.tick for one in found] == list(range(1, 51))
            assert found[-1].snapshot.robot.task_state is TaskState.PLAYING
            assert link.restarts == 0

        served(body, grace_s=PATIENT_S, hang_limit_s=PATIENT_S)

    def test_a_call_that_never_returns_is_killed_and_the_robot_goes_on(self, tmp_path, capsys):
        path = tmp_path / "session.journal"
        heard: list[Event] = []

        async def body(link):
            first = await link.tick([Do("test", SetTcp(TCP)), Do("test", WriteSignal("output_int_register", 5, -7))])
            before = await link.tick(())
            heard.extend((*first.events, *before.events))
            while before.snapshot.robot.tcp_offset != TCP:
                before = await link.tick(())
                heard.extend(before.events)
            program = "def p():\n  textmsg('on')\n  sum(range(10**12))\n"
            cycle, late_s = Cycle(), 0.0
            loop = asyncio.get_running_loop()
            began_s = loop.time()
            outputs = [await link.tick([RunUnit("primary#1", "program", program)])]
            try:
                # Until a fresh child shows its first picture.
                while not any(
                    isinstance(event, Alarm) and outputs[-1].snapshot.robot.tick > event.tick
                    for one in outputs
                    for event in one.events
                ):
                    assert loop.time() - began_s < 20.0
                    await cycle.next()
                    before_s = loop.time()
                    outputs.append(await link.tick(()))
                    late_s = max(late_s, loop.time() - before_s)
            finally:
                cycle.close()
            # Clients see a picture in every tick, whatever happens to the child.
            ticks = [one.tick for one in outputs]
            assert ticks == list(range(ticks[0], ticks[0] + len(ticks)))
            assert late_s < 1.0
            alarms = [event for one in outputs for event in one.events if isinstance(event, Alarm)]
            assert [(alarm.code, alarm.line) for alarm in alarms] == [("R132", 3)]
            heard.extend(event for one in outputs for event in one.events)
            states = [(event.state, event.name) for event in heard if isinstance(event, TaskStateChanged)]
            assert states[-2:] == [(TaskState.PLAYING, "p"), (TaskState.STOPPED, "p")]
            after = outputs[-1].snapshot
            assert after.robot.tcp_offset == TCP
            assert after.robot.q_actual == before.snapshot.robot.q_actual
            assert after.robot.robot_mode == before.snapshot.robot.robot_mode
            assert after.robot.task_state is TaskState.STOPPED
            assert after.signals["output_int_register"][5] == -7
            assert link.restarts == 1

        journal = Journal(path, RobotOptions(power_on=True))
        served(body, hang_limit_s=IMPATIENT_S, journal=journal)
        session = Replay(JournalReader(path))
        restarts = []
        played = list(session.outputs(lambda tick, reason: restarts.append(reason)))
        assert session.difference is None
        assert session.checked_ticks == len(played) - 1 >= 3
        assert "did not come back" in restarts[0]
        told = [event for one in played for event in one.events]
        assert told[: len(heard)] == heard
        assert main(["replay", str(path)]) == 0
        captured = capsys.readouterr()
        assert "line 3" in captured.err and HINT in captured.err

    def test_a_program_of_ten_thousand_lines_begins(self):
        lines = "".join(
            f"  movej([{number * 1e-6}, -1.57, 0, -1.57, 0, 0], a=1.4, v=1.05)\n" for number in range(10_000)
        )
        text = f'def long():\n  textmsg("begun")\n{lines}end'

        async def body(link):
            await link.tick(())
            events: list[Event] = []
            cycle = Cycle()
            events += (await link.tick([RunUnit("primary#1", "program", text)])).events
            for _ in range(10_000):
                await cycle.next()
                events += (await link.tick(())).events
                if any(isinstance(event, TextMessage | Alarm) for event in events):
                    break
            cycle.close()
            assert [event.text for event in events if isinstance(event, TextMessage | Alarm)] == ["begun"]
            assert not link.restarts

        served(body)

    def test_a_child_that_is_killed_is_replaced(self):
        async def body(link):
            await link.tick(())
            os.kill(link.pid, signal.SIGKILL)
            loop = asyncio.get_running_loop()
            began_s, found = loop.time(), await link.tick(())
            while not link.restarts:
                assert loop.time() - began_s < 20.0
                found = await link.tick(())
            assert "killed by signal 9" in found.events[0].text
            cycle, restarted = Cycle(), found.tick
            while found.snapshot.robot.tick < restarted:
                assert loop.time() - began_s < 20.0
                await cycle.next()
                found = await link.tick(())
            cycle.close()

        served(body)

    def test_ends_with_its_parent(self):
        async def body(link):
            await link.tick(())
            self.pid = link.pid

        served(body)
        assert not Path(f"/proc/{self.pid}/status").exists()
