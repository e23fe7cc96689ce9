"""What ends motions: the arm stands within a tick of the condition and its way of braking, for each kind of until."""

from __future__ import annotations

from math import dist, sqrt
from pathlib import Path

import pytest

from elitescript import VirtualRobot
from elitescript.controller.force.contact import ContactConfig, Plane
from elitescript.program_tree import nodes
from elitescript.program_tree.cells import expression
from elitescript.program_tree.nodes import Node, Position
from elitescript.run import Run
from tests.program_tree.test_running import HOME, to, written

TICK_S = 0.004
SPEED = 0.05
DECELERATION = 0.4
BRAKING_M = SPEED**2 / (2 * DECELERATION)
BRAKING_S = SPEED / DECELERATION


def line(*untils: Node, axis: str = "ZNegative") -> Node:
    direction = nodes.Direction(axis=axis, children=untils)
    return nodes.Move(movement="linear", speed=SPEED, acceleration=1.2, children=(direction,))


def until(kind: str, **given: object) -> Node:
    """Return an until with a deceleration of its own, and an output that says that it was reached."""
    given.setdefault("children", (nodes.Set(pin="digital_out[1]"),))
    return nodes.Until(kind=kind, has_own_deceleration=True, deceleration=DECELERATION, **given)  # type: ignore[arg-type]


def run_of(folder: Path, *children: Node, at: float | None = None, **options: object) -> Run:
    robot = VirtualRobot(model="CS66", **options)  # type: ignore[arg-type]
    if at is not None:
        robot.at(at, "standard_digital_in[3]", True)
    run = robot.run(written(folder, *children), until_s=30.0, trace=True)
    assert run.state == "finished", run.alarms
    return run


def start_of(folder: Path) -> tuple[float, tuple[float, ...]]:
    """Return when the arm is at the beginning of the line, s, and where, m."""
    run = VirtualRobot(model="CS66").run(written(folder, to(HOME), name="home"))
    return run.time_s, run.tcp_pose


@pytest.mark.parametrize(
    "kind",
    [until("input", pin="digital_in[3]"), until("expression", condition=expression("get_standard_digital_in(3)"))],
)
def test_an_input_stops_the_arm(kind: Node, tmp_path: Path) -> None:
    begins_s, start = start_of(tmp_path)
    at = begins_s + 1.0
    run = run_of(tmp_path, to(HOME), line(kind), at=at)
    # It has sped up for v / a, which costs half of that way.
    seen = SPEED * (1.0 - SPEED / 1.2 / 2)
    way = dist(run.tcp_pose[:3], start[:3])
    assert seen <= way - BRAKING_M + 1e-5 <= seen + 2 * TICK_S * SPEED + 1e-5
    assert run.time_s == pytest.approx(at + BRAKING_S, abs=2 * TICK_S + 1e-9)
    assert run.signals["standard_digital_out[1]"] is True


def test_a_distance_stops_the_arm(tmp_path: Path) -> None:
    _, start = start_of(tmp_path)
    run = run_of(tmp_path, to(HOME), line(until("distance", distance=0.03)))
    way = dist(run.tcp_pose[:3], start[:3])
    assert 0.03 <= way - BRAKING_M + 1e-5 <= 0.03 + 2 * TICK_S * SPEED + 1e-5


def test_a_contact_stops_the_arm(tmp_path: Path) -> None:
    """A plane with a stiffness: the force rises along the way in it, up to that of the until."""
    _, start = start_of(tmp_path)
    stiffness = 20_000.0
    contact = ContactConfig((Plane((0.0, 0.0, start[2] - 0.02), (0.0, 0.0, 1.0), stiffness),))
    run = run_of(tmp_path, to(HOME), line(until("contact", force=20.0)), contact=contact)
    way = start[2] - run.tcp_pose[2]
    assert 0.02 < way < 0.02 + 20.0 / stiffness + BRAKING_M + 2 * TICK_S * SPEED + 1e-4
    assert run.signals["standard_digital_out[1]"] is True


def test_the_first_of_several_ends_it(tmp_path: Path) -> None:
    begins_s, start = start_of(tmp_path)
    both = (
        until("distance", distance=0.5),
        until("input", pin="digital_in[3]", children=(nodes.Set(pin="digital_out[2]"),)),
    )
    run = run_of(tmp_path, to(HOME), line(*both), at=begins_s + 0.5)
    assert dist(run.tcp_pose[:3], start[:3]) < 0.04
    assert (run.signals["standard_digital_out[1]"], run.signals["standard_digital_out[2]"]) == (False, True)


def test_the_deceleration_of_the_move_is_inherited(tmp_path: Path) -> None:
    begins_s, _ = start_of(tmp_path)
    inherited = nodes.Until(kind="input", pin="digital_in[3]", deceleration=DECELERATION)
    run = run_of(tmp_path, to(HOME), line(inherited), at=begins_s + 1.0)
    assert run.time_s == pytest.approx(begins_s + 1.0 + SPEED / 1.2, abs=2 * TICK_S + 1e-9)


@pytest.mark.parametrize(("at", "is_reached"), [(0.3, False), (None, True)])
def test_an_until_below_a_waypoint(at: float | None, is_reached: bool, tmp_path: Path) -> None:
    """The arm stops on its way, or arrives, and the program goes on in both cases."""
    away = (0.6, *HOME[1:])
    stop = nodes.Until(kind="input", pin="digital_in[3]", children=(nodes.Set(pin="digital_out[1]"),))
    point = nodes.Waypoint(name="W", target=Position(away), children=(stop,))
    move = nodes.Move(has_joint_positions=True, joint_speed=0.5, joint_acceleration=2.0, children=(point,))
    begins_s, _ = start_of(tmp_path)
    run = run_of(tmp_path, to(HOME), move, nodes.Set(pin="digital_out[2]"), at=None if at is None else begins_s + at)
    assert (run.joints[0] == pytest.approx(0.6)) is is_reached
    assert run.signals["standard_digital_out[1]"] is not is_reached
    assert run.signals["standard_digital_out[2]"] is True
    if not is_reached:
        # Sped up and slowed down by 2 rad/s^2; seen within a tick.
        assert run.joints[0] == pytest.approx(0.5 * (0.3 - 0.125) + 0.5**2 / 4, abs=0.5 * 2 * TICK_S + 1e-3)


class TestLoops:
    def test_by_count(self, tmp_path: Path) -> None:
        loop = nodes.Loop(kind="count", count=4, variable="k", children=(nodes.Wait(duration=0.1),))
        assert run_of(tmp_path, loop).time_s == pytest.approx(0.4)

    def test_none_at_all(self, tmp_path: Path) -> None:
        loop = nodes.Loop(kind="count", count=0, variable="k", children=(nodes.Set(pin="digital_out[1]"),))
        assert run_of(tmp_path, loop).signals["standard_digital_out[1]"] is False

    @pytest.mark.parametrize(("is_post_test", "turns"), [(False, 0), (True, 1)])
    def test_by_an_expression(self, is_post_test: bool, turns: int, tmp_path: Path) -> None:
        count = nodes.Assignment(variable="n", value=expression("n + 1"))
        loop = nodes.Loop(
            kind="expression", condition=expression("n < 0"), is_post_test=is_post_test, children=(count,)
        )
        run = run_of(tmp_path, nodes.Assignment(variable="n", value=expression("0")), loop)
        assert run.globals["n"] == turns

    def test_that_is_checked_all_the_time(self, tmp_path: Path) -> None:
        """The input ends it in the middle of its wait."""
        wait = (nodes.Wait(duration=10.0), nodes.Set(pin="digital_out[1]"))
        condition = expression("get_standard_digital_in(3) == False")
        loop = nodes.Loop(kind="expression", condition=condition, is_checked_continuously=True, children=wait)
        run = run_of(tmp_path, loop, at=1.0)
        assert run.time_s == pytest.approx(1.0, abs=2 * TICK_S)
        assert run.signals["standard_digital_out[1]"] is False

    def test_for_ever(self, tmp_path: Path) -> None:
        loop = nodes.Loop(kind="always", children=(nodes.Wait(duration=0.1),))
        run = VirtualRobot("CS66").run(written(tmp_path, loop), until_s=2.0)
        assert (run.state, run.time_s) == ("time_limit", pytest.approx(2.0))

    def test_broken_off_by_a_line(self, tmp_path: Path) -> None:
        stop = nodes.If(condition=expression("k >= 2"), children=(nodes.ScriptLine(statement=expression("break")),))
        loop = nodes.Loop(kind="count", count=9, variable="k", children=(stop, nodes.Wait(duration=0.1)))
        run = run_of(tmp_path, loop)
        assert (run.globals["k"], run.time_s) == (2, pytest.approx(0.2))


class TestWaits:
    def test_for_an_input(self, tmp_path: Path) -> None:
        run = run_of(tmp_path, nodes.Wait(kind="input", pin="digital_in[3]"), at=0.7)
        assert run.time_s == pytest.approx(0.7, abs=2 * TICK_S)

    @pytest.mark.parametrize(("at", "ends_s"), [(0.2, 0.2), (None, 0.5)])
    def test_with_a_time_out(self, at: float | None, ends_s: float, tmp_path: Path) -> None:
        wait = nodes.Wait(kind="input", pin="digital_in[3]", has_timeout=True, timeout=0.5)
        assert run_of(tmp_path, wait, at=at).time_s == pytest.approx(ends_s, abs=2 * TICK_S)


def test_the_way_of_braking_is_that_of_the_law() -> None:
    assert sqrt(2 * DECELERATION * BRAKING_M) == pytest.approx(SPEED)
