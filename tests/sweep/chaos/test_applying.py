"""Disturbances happen at their times, whether time leaps or not, and what makes no sense is refused."""

from __future__ import annotations

import pytest

from elitescript import VirtualRobot
from elitescript.errors import UsageError
from elitescript.messages.events import SafetyModeChanged, TaskStateChanged
from elitescript.messages.timing import seconds
from elitescript.run import Run
from elitescript.sweep.chaos.applying import STOP_REASON, apply, check, disturbance_of, settings_of
from elitescript.sweep.plans.plan import Disturbance
from tests.sweep.chaos.cells import GRIPPER, world

WAIT = "def p():\n  sleep(10)\nend"
MOVE = "def p():\n  movej([0.5, -1.2, 1.0, -1.2, -1.2, 0], a=1, v=0.2)\nend"


def played(program: str, *disturbances: Disturbance, beside: bool = False, **more: object) -> Run:
    robot = VirtualRobot("CS66", world=world() if beside else None, task_dir={}, **more)  # type: ignore[arg-type]
    apply(robot, disturbances)
    return robot.run(program, until_s=60)


def states(run: Run) -> list[tuple[float, str]]:
    return [(seconds(event.tick), event.state.name) for event in run.events if isinstance(event, TaskStateChanged)]


def test_a_pause_holds_the_task_for_its_time() -> None:
    run = played(WAIT, Disturbance("pause", at_s=2.0, for_s=3.0))
    assert run.time_s == pytest.approx(13.0, abs=0.01)
    assert (2.0, "PAUSED") in states(run)
    assert (5.0, "PLAYING") in states(run)


def test_a_safeguard_opens_and_closes() -> None:
    run = played(WAIT, Disturbance("safeguard_stop", at_s=1.0, for_s=0.5))
    modes = [(seconds(event.tick), event.mode.name) for event in run.events if isinstance(event, SafetyModeChanged)]
    assert modes == [(1.0, "SAFEGUARD_STOP"), (1.5, "NORMAL")]
    assert run.state == "finished"


def test_a_task_is_resumed_once_the_safeguard_is_closed() -> None:
    pause, door = Disturbance("pause", at_s=1.0, for_s=2.0), Disturbance("safeguard_stop", at_s=2.5, for_s=1.5)
    run = played(WAIT, pause, door)
    assert run.state == "finished"
    assert run.time_s == pytest.approx(13.0, abs=0.02)


def test_a_protective_stop_ends_the_program() -> None:
    run = played(MOVE, Disturbance("protective_stop", at_s=1.0))
    assert (run.state, run.alarms[-1].code, run.alarms[-1].text) == ("alarm", "R140", STOP_REASON)
    assert seconds(run.alarms[-1].tick) == 1.0


def test_the_slider_goes_back_to_where_it_was() -> None:
    plain_s = played(MOVE, speed=0.8).time_s
    slow_s = played(MOVE, Disturbance("slider", at_s=0.5, for_s=2.0, settings={"fraction": 0.2}), speed=0.8).time_s
    assert slow_s == pytest.approx(plain_s + 2.0 * (1 - 0.2 / 0.8), abs=0.15)


def test_reduced_mode_is_asked_for() -> None:
    run = played(WAIT, Disturbance("reduced_mode", at_s=1.0, for_s=1.0))
    assert [event.mode.name for event in run.events if isinstance(event, SafetyModeChanged)] == ["REDUCED", "NORMAL"]


def test_an_input_that_people_cover_reads_what_is_applied_afterwards() -> None:
    program = (
        "def p():\n  global seen\n  seen = []\n  for n in range(6):\n    seen.append(get_standard_digital_in(1))\n"
    )
    program += "    sleep(1)\n  end\nend"
    early = Disturbance("early_press", "standard_digital_in[1]", 0.5, 1.0)
    late = Disturbance("no_part", "standard_digital_in[1]", 2.5, 1.0)
    robot = VirtualRobot("CS66")
    robot.at(2.0, "standard_digital_in[1]", True)
    apply(robot, [late, early])
    assert robot.run(program).globals["seen"] == [False, True, True, False, True, True]


def test_a_push_is_a_force_that_goes_away() -> None:
    read = "get_tcp_force(True)[2]"
    program = f"def p():\n  global f\n  sleep(1.5)\n  f = [{read}]\n  sleep(1)\n  f.append({read})\nend"
    run = played(program, Disturbance("push", at_s=1.0, for_s=1.0, settings={"force_n": -20.0, "axis": 2}))
    before, after = run.globals["f"]
    assert abs(before) == pytest.approx(20.0, abs=1.0)
    assert abs(after) < 1.0


def test_faults_come_from_the_table() -> None:
    plain = played(GRIPPER, beside=True)
    run = played(GRIPPER, Disturbance("drop", 5000, 0.0, None, {"count": 1, "direction": "to_robot"}), beside=True)
    assert run.time_s > plain.time_s + 0.8  # one answer was waited for in vain


def test_a_run_that_leaps_equals_one_that_runs_every_tick() -> None:
    disturbances = [
        Disturbance("late", "standard_digital_in[4]", 0.1, 3.0, {"delay_s": 0.3}),
        Disturbance("pause", at_s=1.1, for_s=0.5),
        Disturbance("delay", 5000, 0.0, None, {"delay_s": 0.2}),
    ]

    def events(*, is_leaping: bool) -> list[object]:
        robot = VirtualRobot("CS66", world=world(), task_dir={})
        apply(robot, disturbances)
        return list(robot.run(GRIPPER, until_s=60, pace=None if is_leaping else lambda tick: None).events)

    assert events(is_leaping=True) == events(is_leaping=False)


@pytest.mark.parametrize(
    ("disturbance", "message"),
    [
        (Disturbance("pauze", at_s=1.0), r"kind: there is no 'pauze'; .*'pause'\?"),
        (Disturbance("pause", at_s=-1.0), r"at_s: must be a number in \[0, 1e\+09\] s, got -1.0"),
        (Disturbance("pause", at_s=1.0, for_s=float("nan")), r"for_s: must be a number"),
        (Disturbance("pause", 5000, 1.0), r"on: pause has no place"),
        (Disturbance("no_part", "", 1.0, 1.0), r"on: is missing; name an input"),
        (Disturbance("no_part", "standard_analog_in[0]", 1.0, 1.0), r"on: no_part is at a digital input"),
        (Disturbance("protective_stop", at_s=1.0, for_s=1.0), r"for_s: a protective stop ends the program"),
        (Disturbance("slider", at_s=1.0), r"fraction: is missing"),
        (Disturbance("slider", at_s=1.0, settings={"fraction": 2.0}), r"fraction: must be in \[0, 1\], got 2.0"),
        (Disturbance("pause", at_s=1.0, settings={"fraction": 0.5}), r"fraction: pause has no such setting"),
        (Disturbance("drop", "tool", 1.0, None, {"bounces": 3}), r"bounces: drop has no such setting; bouncing has"),
    ],
)
def test_what_makes_no_sense_anywhere_is_refused(disturbance: Disturbance, message: str) -> None:
    with pytest.raises(UsageError, match=f"^{message}"):
        check(disturbance)


def test_what_makes_no_sense_there_is_refused_with_its_number() -> None:
    with pytest.raises(UsageError, match=r"^disturbance 2: on: no device of this world is at 6000"):
        played(GRIPPER, Disturbance("pause", for_s=1.0), Disturbance("drop", 6000, 1.0), beside=True)


def test_a_disturbance_is_a_row_and_back() -> None:
    for item in (
        Disturbance("drop", 5000, 1.5, None, {"count": 2, "direction": "to_robot"}),
        Disturbance("slider", "", 0.0, 3.0, {"fraction": 0.5}),
    ):
        assert disturbance_of(settings_of(item)) == item
