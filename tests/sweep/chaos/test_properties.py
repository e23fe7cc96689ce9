"""Built-in properties: what holds, what does not, by how much, and what is asked for by itself."""

from __future__ import annotations

import pytest

from elitescript import VirtualRobot
from elitescript.errors import UsageError
from elitescript.messages.motion import Six
from elitescript.models.model import load_model
from elitescript.properties.checks import Checks
from elitescript.properties.verdicts import Verdict
from elitescript.records import replace
from elitescript.run import Run
from elitescript.solids.cell import read_cell
from elitescript.sweep.chaos.applying import apply
from elitescript.sweep.chaos.ground import End, end_of
from elitescript.sweep.chaos.properties import (
    BUILT_INS,
    USUAL_OF_CHAOS,
    Situation,
    built_in,
    failure_of,
    is_built_in,
    properties_of,
)
from elitescript.sweep.plans.plan import Disturbance, Plan

MODEL = load_model("CS66")
LAMP = "def p():\n  set_standard_digital_out(2, True)\n  sleep(2)\n  set_standard_digital_out(2, False)\nend"
WAIT = "def p():\n  while not get_standard_digital_in(1):\n    sync()\n  end\nend"
STOP = Disturbance("protective_stop", at_s=1.0)


def verdict(
    text: str, program: str, *disturbances: Disturbance, plain: End | None = None, robot: VirtualRobot | None = None
) -> tuple[Verdict, Run]:
    robot = robot or VirtualRobot(MODEL)
    situation = Situation(MODEL, robot.options.safety, None if plain is None else lambda: plain)
    situation.disturbances = disturbances
    watching = Checks([built_in(text, situation)]).watch()
    apply(robot, disturbances)
    run = robot.run(program, until_s=4.0, trace=watching.trace)
    return watching.results(run).verdicts[0], run


def plain_of(program: str) -> End:
    return end_of(VirtualRobot(MODEL).run(program, until_s=4.0))


def test_a_deadlock_is_stuck() -> None:
    found, run = verdict("never_stuck", "def p():\n  pause()\nend")
    assert run.state == "stuck"
    assert not found.holds
    assert "main" in found.words
    assert "line 2" in found.words


def test_polling_for_ever_is_stuck_if_the_plain_run_ends() -> None:
    ended = End("finished", (), {}, 1.0)
    found, run = verdict("never_stuck", WAIT, plain=ended)
    assert run.state == "time_limit"
    assert not found.holds
    assert found.words.startswith(
        "it is not over after 4 s; without disturbances it ends after 1 s: main waited in line"
    )
    assert verdict("never_stuck", WAIT)[0].holds
    assert verdict("never_stuck", WAIT, plain=End("time_limit", (), {}, 4.0))[0].holds


def test_an_alarm_does_not_hold_unless_it_is_the_stop_that_was_asked_for() -> None:
    found, _ = verdict("no_alarm", "def p():\n  x = 1 / 0\nend")
    assert (found.holds, found.words) == (False, "ZeroDivisionError: division by zero: the divisor is 0")
    assert verdict("no_alarm", LAMP, STOP)[0].holds
    # A stop by the program's own speed is none that was asked for.
    world = "def p():\n  movej([0.5, -1.2, 1.0, -1.2, -1.2, 0], a=5, v=2)\nend"
    from elitescript.controller.safety.limits import SafetyBounds, SafetyLimits

    robot = VirtualRobot(MODEL, safety=SafetyLimits(SafetyBounds(tcp_speed_max=0.1)))
    found, run = verdict("no_alarm", world, Disturbance("protective_stop", at_s=3.0), robot=robot)
    assert run.alarms[0].code == "R140"
    assert not found.holds


@pytest.mark.parametrize(
    "others",
    [
        (Disturbance("safeguard_stop", at_s=0.9, for_s=0.5),),
        (Disturbance("pause", at_s=0.9, for_s=0.5),),
        (Disturbance("protective_stop", at_s=0.0),),
    ],
)
def test_a_stop_that_was_asked_for_is_no_alarm_whatever_else_happens(others: tuple[Disturbance, ...]) -> None:
    move = "def p():\n  movej([0.5, -1.2, 1.0, -1.2, -1.2, 0], a=1, v=0.2)\nend"
    found, run = verdict("no_alarm", move, *others, STOP)
    assert (run.state, run.alarms[-1].code) == ("alarm", "R140")
    assert found.holds
    situation = Situation(MODEL)
    situation.disturbances = (*others, STOP)
    assert failure_of("same_end", found, run, situation).code == ""


def test_a_deadlock_is_no_alarm_but_stuck() -> None:
    assert verdict("no_alarm", "def p():\n  pause()\nend")[0].holds


def test_an_output_is_left_on_by_a_stop() -> None:
    found, run = verdict("no_output_left_on", LAMP, STOP, plain=plain_of(LAMP))
    assert not found.holds
    assert "standard_digital_out[2], switched on in line 2 at 0.000 s" in found.words
    assert verdict("no_output_left_on", LAMP)[0].holds
    situation = Situation(MODEL, None, lambda: plain_of(LAMP))
    situation.disturbances = (STOP,)
    failure = failure_of("no_output_left_on", found, run, situation)
    assert (failure.code, failure.line, failure.disturbance, failure.state) == ("", 2, "protective_stop", "alarm")


def test_an_output_that_is_tied_to_the_program_is_not_left_on() -> None:
    tied = "def p():\n  set_runstate_standard_digital_output_to_value(2, 1)\n  set_standard_digital_out(2, True)\n"
    found, run = verdict("no_output_left_on", tied + "  sleep(2)\nend", STOP)
    assert run.state == "alarm"
    assert found.holds


def test_an_output_that_stays_on_anyway_is_not_left_on() -> None:
    program = "def p():\n  set_standard_digital_out(2, True)\n  sleep(2)\nend"
    assert verdict("no_output_left_on", program, STOP, plain=plain_of(program))[0].holds


def test_a_contact_has_a_depth_and_a_clearance_a_distance() -> None:
    def found(height: float) -> Verdict:
        robot = VirtualRobot(MODEL)
        robot.cell = read_cell({"box": [{"name": "post", "size": [0.4, 0.4, height], "pose": [0.5, 0.2, height / 2]}]})
        return verdict("no_contact", "def p():\n  movej([0.6, -1.2, 1.4, -1.2, 1.5, 0], a=2, v=2)\nend", robot=robot)[0]

    low, high = found(0.02), found(0.9)
    assert low.holds
    assert low.margin is not None
    assert low.margin > 0.0
    assert not high.holds
    assert high.margin is not None
    assert high.margin < 0.0
    assert "post" in high.words


def test_the_same_end_counts_once_everything_is_over() -> None:
    plain = plain_of(LAMP)
    pause = Disturbance("pause", at_s=0.5, for_s=0.5)
    assert verdict("same_end", LAMP, pause, plain=plain)[0].holds
    assert verdict("same_end", LAMP, STOP, plain=plain)[0].holds  # a stop is never over
    program = "def p():\n  x = get_standard_digital_in(1)\n  sleep(1)\n  set_standard_digital_out(3, x)\nend"
    pressed = Disturbance("early_press", "standard_digital_in[1]", 0.0, 0.5)
    found, _ = verdict("same_end", program, pressed, plain=plain_of(program))
    assert not found.holds
    assert found.words.endswith("standard_digital_out[3] is True, not False")
    endless = Disturbance("stuck", "standard_digital_in[1]", 0.0, None, {"value": True})
    assert verdict("same_end", program, endless, plain=plain_of(program))[0].holds


def test_the_plain_run_of_the_same_values_decides_before_an_end_differs() -> None:
    asked: list[bool] = []

    def plain_end() -> End:
        asked.append(True)
        return plain_of(LAMP)

    situation = Situation(MODEL, None, lambda: End("alarm", (), {}, 1.0), plain_end)
    situation.disturbances = (Disturbance("pause", at_s=0.5, for_s=0.5),)
    watch = built_in("same_end", situation).watch()
    assert watch.verdict(VirtualRobot(MODEL).run(LAMP), 0).holds
    assert asked == [True]


MOVE = "def p():\n  movej([1.0, -1.2, -1.4, -1.2, 1.5, 0], a=2, v=1)\nend"


@pytest.mark.parametrize(
    ("name", "unit", "low", "high"),
    [
        ("joint_range", "rad", 4.7, 4.72),
        ("joint_speed", "rad/s", 1.0, 2.5),
        ("tcp_speed_limit", "m/s", 0.1, 5.0),
        ("reach", "m", 0.18, 0.2),
    ],
)
def test_limits_have_margins(name: str, unit: str, low: float, high: float) -> None:
    found, _ = verdict(name, MOVE)
    assert found.holds
    assert found.unit == unit
    assert found.margin is not None
    assert low <= found.margin <= high
    wanted, _ = verdict(f"{name}({found.margin + 0.1:.3f})", MOVE)
    assert not wanted.holds
    assert wanted.margin == pytest.approx(-0.1, abs=0.001)
    assert wanted.t is not None


def test_a_range_is_that_of_the_safety_system() -> None:
    from elitescript.controller.safety.limits import SafetyBounds, SafetyLimits

    low: Six = (-2.0, -3.0, -3.0, -3.0, -3.0, -3.0)
    high: Six = (1.3, 3.0, 3.0, 3.0, 3.0, 3.0)
    robot = VirtualRobot(MODEL, safety=SafetyLimits(SafetyBounds(low, high)))
    found, _ = verdict("joint_range", MOVE, robot=robot)
    assert found.margin == pytest.approx(0.3, abs=1e-9)
    assert found.words == "joint base is nearest to the end of its range"


def test_the_usual_ones_are_asked_for_unless_one_is_written() -> None:
    plan = Plan("def p():\nend\n", chaos="all")
    assert properties_of(plan) == USUAL_OF_CHAOS
    assert properties_of(replace(plan, ensure=("time_s < 3",))) == (*USUAL_OF_CHAOS, "time_s < 3")
    assert properties_of(replace(plan, ensure=("time_s < 3", "never_stuck"))) == ("time_s < 3", "never_stuck")
    assert properties_of(replace(plan, ensure=("time_s < 3",), chaos="")) == ("time_s < 3",)
    assert properties_of(replace(plan, chaos="")) == ("never_stuck", "no_alarm")


@pytest.mark.parametrize(
    ("text", "expected"),
    [("never_stuck", True), (" joint_range( 0.1 ) ", True), ("time_s", False), ("reach < 3", False)],
)
def test_names_are_told_from_expressions(text: str, expected: bool) -> None:
    assert is_built_in(text) is expected


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("never_stuk", r"never_stuk: there is no such property; .*'never_stuck'\?"),
        ("never_stuck(3)", r"never_stuck\(3\): never_stuck has no margin"),
        ("reach(x)", r"reach\(x\): write the margin as a number in m"),
        ("reach(-1)", r"reach\(-1\): write the margin as a number in m"),
        ("reach(nan)", r"reach\(nan\): write the margin"),
    ],
)
def test_nonsense_is_refused(text: str, message: str) -> None:
    with pytest.raises(UsageError, match=f"^{message}"):
        built_in(text, Situation(MODEL))


def test_every_property_is_described() -> None:
    assert all(row.text and (row.judge is None) is not (row.limit is None) for row in BUILT_INS.values())
