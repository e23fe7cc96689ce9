"""Where the program phase of a tick ends by a clock, and that a robot that is given the places stops there again."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median

import pytest

from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.cut import WHOLE, Cut
from elitescript.messages.events import TextMessage
from elitescript.messages.inputs import Do, Input, RunUnit
from elitescript.messages.machine import StopTask
from elitescript.runtime.threads.meter import (
    BEGIN_SHARES,
    CLEANUP_NS,
    CREDIT_SHARES,
    HURRIED_PART,
    LATE_NS,
    SHARE_NS,
    ClockMeter,
    Meter,
    RepeatingMeter,
)
from elitescript.services.output_text import output_text
from tests.stops.programs import FURTHER, looping, programs

MS = 1_000_000


class MadeUpTime:
    """A clock, and the processor time of the thread that reads it."""

    def __init__(self, step_ns: int = 0) -> None:
        self.ns = self.worked_ns = 0
        self.step_ns = step_ns

    def now(self) -> int:
        self.ns += self.step_ns
        self.worked_ns += self.step_ns
        return self.ns

    def worked(self) -> int:
        return self.worked_ns

    def work(self, time_ns: int) -> None:
        self.ns += time_ns
        self.worked_ns += time_ns


def metered(clock: MadeUpTime) -> ClockMeter:
    meter = ClockMeter(clock.now, clock.worked)
    meter.begin_tick(0)
    meter.end_tick()
    return meter


class TestMeter:
    def test_a_tick_ends_when_its_share_and_what_was_kept_of_earlier_ones_is_used(self):
        clock = MadeUpTime()
        meter = metered(clock)
        meter.begin_tick(1)
        clock.work((1 + CREDIT_SHARES) * SHARE_NS - 1)
        assert not meter.look()
        clock.work(1)
        assert meter.look()
        assert meter.look()
        assert meter.cut == Cut(2, 0)
        meter.end_tick()
        meter.begin_tick(2)
        clock.work(SHARE_NS - 1)
        assert not meter.look()
        clock.work(1)
        assert meter.look()
        assert meter.was_spent

    def test_a_busy_computer_ends_none(self):
        clock = MadeUpTime()
        meter = metered(clock)
        meter.begin_tick(1)
        clock.ns += 1000 * MS
        assert not meter.look()
        clock.ns += 1000 * MS
        clock.worked_ns += (1 + CREDIT_SHARES) * SHARE_NS
        assert meter.look()

    def test_one_that_uses_ticks_up_has_a_part_of_its_share_while_they_begin_late(self):
        clock = MadeUpTime()
        meter = metered(clock)

        def used(tick, begins_ms):
            """Work until the tick is over; return how long that was."""
            meter.end_tick()
            clock.ns = begins_ms * MS
            meter.begin_tick(tick)
            began = clock.worked_ns
            while not meter.look():
                clock.work(SHARE_NS // 16)
            return clock.worked_ns - began

        assert used(1, 4) == (1 + CREDIT_SHARES) * SHARE_NS
        assert used(2, 8) == SHARE_NS
        # The computer was away for three periods, and what was missed comes without a pause.
        assert used(3, 24) == SHARE_NS // HURRIED_PART
        assert [used(tick, 24) for tick in (4, 5)] == [SHARE_NS // HURRIED_PART] * 2
        # In time again: of what it did not use, no more than the rest of one share was saved up.
        assert used(6, 24) == 2 * SHARE_NS - SHARE_NS // HURRIED_PART
        assert used(7, 28) == SHARE_NS

    def test_one_that_waits_in_its_ticks_has_its_share_however_late_they_begin(self):
        clock = MadeUpTime()
        meter = metered(clock)
        for tick in range(1, 20):
            clock.ns = tick * 4 * MS + (tick > 10) * 30 * MS
            meter.begin_tick(tick)
            clock.work(SHARE_NS - 1)
            assert not meter.look(), tick
            meter.end_tick()

    def test_ticks_that_are_late_for_good_are_in_time_after_a_while(self):
        clock = MadeUpTime()
        meter = metered(clock)
        late = []
        for tick in range(1, 1000):
            clock.ns = tick * 4 * MS + (tick >= 10) * 20 * MS
            meter.begin_tick(tick)
            began = clock.worked_ns
            while not meter.look():
                clock.work(SHARE_NS // 16)
            late.append(clock.worked_ns - began < SHARE_NS)
            meter.end_tick()
        assert late[9]
        assert not any(late[500:])

    def test_what_a_call_takes_too_much_is_missing_behind_it(self):
        clock = MadeUpTime()
        meter = metered(clock)
        meter.begin_tick(1)
        clock.work((1 + CREDIT_SHARES + 5) * SHARE_NS)
        assert meter.look()
        for tick in range(2, 7):
            meter.end_tick()
            meter.begin_tick(tick)
            assert meter.look(), tick
        meter.end_tick()
        meter.begin_tick(7)
        assert not meter.look()

    def test_ticks_that_were_leapt_over_pay_too_and_no_more_than_so_much_is_kept(self):
        clock = MadeUpTime()
        meter = metered(clock)
        meter.begin_tick(1)
        clock.work((1 + CREDIT_SHARES + 5) * SHARE_NS)
        meter.end_tick()
        meter.begin_tick(1000)
        clock.work((1 + CREDIT_SHARES) * SHARE_NS)
        assert meter.look()

    def test_the_begin_of_a_program_and_what_is_loaded_are_free(self):
        clock = MadeUpTime()
        meter = metered(clock)
        meter.begin_program()
        meter.begin_tick(1)
        clock.work(BEGIN_SHARES * SHARE_NS)
        assert not meter.look()
        with meter.pardon():
            clock.work(1000 * MS)
        assert not meter.look()
        clock.work(SHARE_NS)
        assert meter.look()

    def test_what_others_do_for_a_program_counts(self):
        clock = MadeUpTime()
        meter = metered(clock)
        meter.begin_tick(1)
        clock.ns += 100 * MS
        meter.spend(100 * MS)
        assert meter.look()

    def test_stopped_threads_are_given_up_after_a_time_of_their_own(self):
        clock = MadeUpTime()
        meter = metered(clock)
        meter.begin_tick(1)
        assert not meter.look_at_cleanup()
        clock.work(CLEANUP_NS)
        assert meter.look_at_cleanup()
        assert meter.look_at_cleanup()
        assert meter.cut == Cut(0, 2)

    def test_a_program_that_takes_the_place_of_another_begins_in_the_same_tick(self):
        clock = MadeUpTime()
        meter = metered(clock)
        meter.begin_tick(1)
        assert not meter.look()
        meter.end_tick()
        # Its text is compiled.
        clock.work(1000 * MS)
        meter.begin_tick(1)
        assert not meter.look()
        clock.work((1 + CREDIT_SHARES) * SHARE_NS)
        assert meter.look()
        assert meter.cut == Cut(3, 0)

    def test_calls_that_are_much_too_long_add_up_and_what_they_may_for_good_is_taken_off(self):
        clock = MadeUpTime()
        meter = metered(clock)
        held_up = []
        for tick in (1, 1001, 1001 + 25 * 250):
            meter.begin_tick(tick)
            clock.work((1 + CREDIT_SHARES) * SHARE_NS + 60 * MS)
            assert meter.look()
            assert meter.late_ms == 60
            held_up.append(meter.held_up_us)
            meter.end_tick()
        assert held_up == [60_000, 80_000, 60_000]
        meter.begin_program()
        assert meter.held_up_us == 0

    @pytest.mark.parametrize(("every_s", "is_too_much"), [(0.2, True), (2.0, True), (8.0, False)])
    def test_a_long_call_every_few_seconds_is_not_too_much(self, every_s, is_too_much):
        clock = MadeUpTime()
        meter = metered(clock)
        found = False
        for call in range(1, 100):
            meter.begin_tick(int(call * every_s * 250))
            clock.work((1 + CREDIT_SHARES) * SHARE_NS + 70 * MS)
            assert meter.look()
            found |= meter.held_up_us > meter.held_up_max_us
            meter.end_tick()
        assert found == is_too_much

    def test_a_tick_that_was_leapt_over_was_not_spent(self):
        for tick, was_spent in ((2, True), (3, False)):
            clock = MadeUpTime()
            meter = metered(clock)
            meter.begin_tick(1)
            clock.work((1 + CREDIT_SHARES) * SHARE_NS)
            assert meter.look()
            meter.end_tick()
            meter.begin_tick(tick)
            assert meter.was_spent == was_spent

    def test_a_call_of_less_than_10_ms_holds_nothing_up(self):
        clock = MadeUpTime()
        meter = metered(clock)
        meter.begin_tick(1)
        clock.work((1 + CREDIT_SHARES) * SHARE_NS + LATE_NS - 1)
        assert meter.look()
        assert (meter.late_ms, meter.held_up_us) == (0, 0)

    @pytest.mark.parametrize(("calls", "is_too_much"), [(1, False), (2, False), (4, True)])
    def test_two_calls_are_never_too_much_however_long(self, calls, is_too_much):
        clock = MadeUpTime()
        meter = metered(clock)
        for tick in range(1, 1 + 400 * calls, 400):
            meter.begin_tick(tick)
            clock.work(650 * MS)
            assert meter.look()
            meter.end_tick()
        assert (meter.held_up_us > meter.held_up_max_us) == is_too_much

    def test_the_line_is_that_of_the_statement_that_has_taken_longest(self):
        clock = MadeUpTime()
        meter = metered(clock)
        for tick, before, behind, expected in ((1, 5, 60, 4), (1000, 60, 5, 3), (2000, 1, 1, 0)):
            meter.begin_tick(tick)
            meter.note_statement(3)
            clock.work(before * MS)
            meter.note_statement(4)
            clock.work(behind * MS)
            assert meter.look() == (expected > 0)
            assert meter.late_line == meter.cut.late_line == expected
            meter.end_tick()


# ---------------------------------------------------------------- robots

ALL = programs()
EVERY = 256
"""Of so many programs of the catalogue one is tried; the others are tried by a slow test."""
PARTS = 16
"""Of the slow test."""
TICKS = 5
STEP_NS = 400_000
LOOKS_MAX = (BEGIN_SHARES + 1) * SHARE_NS // STEP_NS + 1


def played(
    inputs_of: Callable[[int], Sequence[Input]], ticks: int, meter: Meter, cuts: Sequence[Cut] = ()
) -> tuple[list[str], list[Cut]]:
    """Return what a robot has given in each tick, and how far its programs came."""
    robot = Kernel(RobotOptions(power_on=True), meter=meter)
    texts, found = [], []
    for tick in range(ticks):
        if cuts:
            assert isinstance(meter, RepeatingMeter)
            meter.expect(cuts[tick])
        texts.append(output_text(robot.tick_and_snapshot(inputs_of(tick))))
        found.append(robot.cut)
    robot.host.forget_threads()
    return texts, found


def of_programs(texts: Sequence[str]) -> Callable[[int], list[Input]]:
    """Return inputs that run one program after the other."""

    def inputs_of(tick: int) -> list[Input]:
        number, within = divmod(tick, TICKS)
        return [RunUnit(f"primary#{number}", "program", texts[number])] if not within else []

    return inputs_of


def check(texts: Sequence[str]) -> None:
    """Run each program by a clock that goes on at each look, and all again by what that has given."""
    inputs_of, ticks = of_programs(texts), TICKS * len(texts)
    clock = MadeUpTime(STEP_NS)
    given, cuts = played(inputs_of, ticks, ClockMeter(clock.now, clock.worked))
    assert max(cut.looks for cut in cuts) <= LOOKS_MAX
    assert any(cut != WHOLE for cut in cuts)
    again, found = played(inputs_of, ticks, RepeatingMeter(), cuts)
    assert found == cuts
    different = [tick for tick, (ours, theirs) in enumerate(zip(given, again, strict=True)) if ours != theirs]
    assert not different, texts[different[0] // TICKS]


def test_commands_and_functions_end_their_tick_by_the_clock_and_a_replay_ends_there_too():
    check([text for name, text in itertools.islice(ALL.items(), 0, None, EVERY) if name not in FURTHER])


@pytest.mark.slow
@pytest.mark.parametrize("part", range(PARTS))
def test_every_command_and_function_ends_its_tick_by_the_clock(part):
    check([text for name, text in itertools.islice(ALL.items(), part, None, PARTS) if name not in FURTHER])


KINDS = {
    name: ALL[name]
    for name in (
        "movel out of reach",
        "forward kinematics",
        "open nothing",
        "re",
        "eval",
        "import of nothing",
        "start of threads",
        "generator that is closed",
        "recursion with finally",
        "five threads of refused moves",
        "a plain loop",
    )
}


@pytest.mark.parametrize("kind", KINDS)
def test_each_kind_of_endless_program_leaves_most_of_a_tick(kind):
    """By the real clock, but only what the thread itself has worked counts, and the middle of several ticks."""
    meter = ClockMeter(time.monotonic_ns, time.thread_time_ns)
    robot = Kernel(RobotOptions(power_on=True), meter=meter)
    robot.tick([RunUnit("primary#1", "program", KINDS[kind])])
    for _ in range(15):
        robot.tick()
    used_ns = []
    for _ in range(9):
        robot.tick()
        used_ns.append(meter._used_ns)
    robot.host.forget_threads()
    assert median(used_ns) <= 1.5 * SHARE_NS


def test_threads_take_turns_after_a_cut():
    """The one that was cut is not the first again: each gets its share in time."""
    text = """def p():
  def one(n):
    while True:
      textmsg(n)
      get_steptime()
    end
  end
  for n in range(1, 6):
    start_thread(one, (n,))
  end
  one(0)
end
"""
    clock = MadeUpTime(STEP_NS)
    robot = Kernel(RobotOptions(power_on=True), meter=ClockMeter(clock.now, clock.worked))
    ran = [
        {
            event.text
            for event in robot.tick([RunUnit("primary#1", "program", text)] if not tick else ()).events
            if isinstance(event, TextMessage)
        }
        for tick in range(60)
    ]
    robot.host.forget_threads()
    for begin in range(15, 60, 15):
        assert set().union(*ran[begin : begin + 15]) == {"0", "1", "2", "3", "4", "5"}


def test_clean_up_without_end_is_given_up_and_a_replay_does_the_same():
    def inputs_of(tick: int) -> list[Input]:
        if tick == 0:
            return [RunUnit("primary#1", "program", FURTHER["clean-up without end"])]
        return [Do("dashboard#1", StopTask())] if tick == 5 else []

    clock = MadeUpTime(STEP_NS)
    given, cuts = played(inputs_of, 8, ClockMeter(clock.now, clock.worked))
    assert 0 < cuts[5].cleanups <= CLEANUP_NS // STEP_NS + 2
    assert "R131" in given[5]
    assert played(inputs_of, 8, RepeatingMeter(), cuts) == (given, cuts)


CALLS = """def p():
  while True:
    a = 1
    get_steptime()
    b = 2
    sync()
  end
end
"""


class CallTime(MadeUpTime):
    """Lets a call of `CALLS` take a time, in chosen ticks: between two looks of the thread."""

    def __init__(self, time_ns: int, is_long: Callable[[int], bool]) -> None:
        super().__init__()
        self._time_ns = time_ns
        self._is_long = is_long
        self._reads = 0

    def inputs(self, tick: int) -> list[Input]:
        self._reads = 0 if tick >= 5 and self._is_long(tick) else -1000
        return [RunUnit("primary#1", "program", CALLS)] if not tick else []

    def now(self) -> int:
        self._reads += 1
        if self._reads == 5:
            self.work(self._time_ns)
        return self.ns


def test_a_program_is_warned_once_of_a_call_that_is_too_long_and_a_replay_says_the_same():
    clock = CallTime(60 * MS, lambda tick: tick in (5, 150))
    given, cuts = played(clock.inputs, 300, ClockMeter(clock.now, clock.worked))
    assert [cut.late_ms for cut in cuts if cut.late_ms] == [38, 54]
    assert sum("took 38 ms too long" in output for output in given) == 1
    assert not any("R135" in output for output in given)
    assert played(clock.inputs, 300, RepeatingMeter(), cuts) == (given, cuts)


def test_a_program_that_holds_the_robot_up_again_and_again_ends_with_an_alarm():
    clock = CallTime(76 * MS, lambda tick: tick % 50 == 0)
    given, cuts = played(clock.inputs, 300, ClockMeter(clock.now, clock.worked))
    (alarm,) = [output for output in given if "R135" in output]
    assert "for more than 250 ms beyond 1 % of the time; the last took 70 ms too long" in alarm
    assert played(clock.inputs, 300, RepeatingMeter(), cuts) == (given, cuts)


def test_a_served_program_does_what_a_free_one_does():
    """One that waits now and then is never cut."""
    text = """def p():
  n = 0
  while n < 50:
    for i in range(100):
      n = n + get_steptime() * 0
    end
    n = n + 1
    textmsg(n)
    sync()
  end
end
"""

    def inputs_of(tick: int) -> list[Input]:
        return [RunUnit("primary#1", "program", text)] if not tick else []

    given, cuts = played(inputs_of, 60, ClockMeter(MadeUpTime(1000).now, lambda: 0))
    assert set(cuts) == {WHOLE}
    free = Kernel(RobotOptions(power_on=True))
    assert given == [output_text(free.tick_and_snapshot(inputs_of(tick))) for tick in range(60)]


def test_work_of_events_counts_the_same_however_it_is_paid_out():
    """A free run, and one whose portions are small because a meter looks in between."""
    text = looping('textmsg("x")')

    def inputs_of(tick: int) -> list[Input]:
        return [RunUnit("primary#1", "program", text)] if not tick else []

    free = Kernel(RobotOptions(power_on=True))
    given, _ = played(inputs_of, 10, Meter())
    assert given == [output_text(free.tick_and_snapshot(inputs_of(tick))) for tick in range(10)]


EXAMPLES = sorted((Path(__file__).resolve().parents[2] / "examples").glob("*.script"))


@pytest.mark.slow
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_the_examples_do_the_same_by_the_real_clock_as_in_a_free_run(path):
    """As in `serve` and in `run`: programs that move, wait and compute a little are not cut so that it shows."""
    text = path.read_text(encoding="utf-8")

    def events(meter: Meter | None) -> list[tuple[object, ...]]:
        robot = Kernel(RobotOptions(power_on=True), meter=meter)
        found = [robot.tick([RunUnit("primary#1", "program", text)]).events]
        found += [robot.tick().events for _ in range(10 * 250)]
        robot.host.forget_threads()
        return found

    given = events(ClockMeter(time.monotonic_ns, time.thread_time_ns))
    assert sum(map(len, given)) > 2
    assert given == events(None)
