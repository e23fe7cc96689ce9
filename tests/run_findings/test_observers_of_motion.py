"""Observers of motions and of refused commands: each as a function of what it is given, and in a run."""

import pytest

from elitescript import VirtualRobot
from elitescript.findings.observers.free_force import FreeForce
from elitescript.findings.observers.outputs_before_points import OutputsBeforePoints
from elitescript.findings.observers.short_stops import ShortStops
from elitescript.findings.observers.starved_servo import IN_A_ROW, StarvedServo
from elitescript.findings.observers.still_encoders import StillEncoders
from elitescript.findings.observers.swallowed_refusals import (
    CALLS_MAX,
    EVER_MAX,
    MOVES_MAX,
    PAUSE_TICKS,
    SwallowedRefusals,
)
from elitescript.messages.observations import (
    CommandRefused,
    EncoderStill,
    ForceMetNothing,
    OutputBeforePoint,
    ServoStarved,
    StoppedAgain,
)


def told(observer, *seen):
    rows = [row for one in seen for row in observer.see(one)] + list(observer.end("finished"))
    assert all((row.line, row.thread) == (7, "main") for row in rows)
    return [(row.code, row.text, row.hint) for row in rows]


def test_starved_servo_at_the_third_stop():
    seen = ServoStarved(9, 7, "main", 25, 0.008)
    assert told(StarvedServo(), *[seen] * (IN_A_ROW - 1)) == []
    ((code, text, hint),) = told(StarvedServo(), *[seen] * (IN_A_ROW + 5))
    assert code == "W290"
    assert "servoj has t=0.008 s and gets a target every 0.1 s" in text
    assert "give t=0.1" in hint


@pytest.mark.parametrize(("counting", "words"), [((1,), "encoder 1 counts"), ((), "encoder_set_tick_count sets")])
def test_still_encoder(counting, words):
    ((code, text, hint),) = told(StillEncoders(), EncoderStill(900, 7, "main", 0, 250, counting))
    assert code == "W291"
    assert "tracked encoder 0 for 1 s" in text
    assert words in hint


def test_free_force_once_a_line():
    seen = ForceMetNothing(900, 7, "main", (0.0, 0.0, -10.0, 0.0, 0.0, 0.0), 250)
    ((code, text, _),) = told(FreeForce(), seen, seen)
    assert code == "N288"
    assert "on for 1 s with a target of [0, 0, -10, 0, 0, 0] N, N m" in text


class TestSwallowedRefusals:
    @staticmethod
    def refused(count, *, moves=True, step_ticks=1):
        return [CommandRefused(i * step_ticks, 7, "main", "movel", f"reason {i}", moves) for i in range(count)]

    @pytest.mark.parametrize(("moves", "most"), [(True, MOVES_MAX), (False, CALLS_MAX)])
    def test_told_once_at_a_number_with_the_first_reason(self, moves, most):
        assert told(SwallowedRefusals(), *self.refused(most - 1, moves=moves)) == []
        ((code, text, _),) = told(SwallowedRefusals(), *self.refused(3 * most, moves=moves))
        assert (code, text) == (
            "W292",
            f"movel was refused {most} times in a row, and the program goes on: reason 0",
        )

    def test_refusals_that_are_far_apart_are_not_in_a_row(self):
        assert told(SwallowedRefusals(), *self.refused(2 * MOVES_MAX, step_ticks=PAUSE_TICKS + 1)) == []

    def test_a_hundred_of_them_are_told_all_the_same(self):
        seen = self.refused(3 * EVER_MAX, step_ticks=PAUSE_TICKS + 1)
        ((code, text, _),) = told(SwallowedRefusals(), *seen)
        assert (code, text) == ("W292", "movel was refused 100 times, and the program goes on: reason 99")


def test_short_stops_are_told_with_their_number():
    seen = [StoppedAgain(9, 7, "main", stops, 0.001) for stops in (30, 31, 32, 30)]
    ((code, text, _),) = told(ShortStops(), *seen)
    assert code == "N224"
    assert "the last of 1 mm, came to rest at 32 points" in text


@pytest.mark.parametrize(("left_m", "expected"), [(0.0198, ["N223"]), (0.0009, [])])
def test_an_output_before_its_point(left_m, expected):
    seen = OutputBeforePoint(9, "standard_digital_out[0]", 7, "main", 6, left_m)
    rows = told(OutputsBeforePoints(), seen, seen)
    assert [row[0] for row in rows] == expected
    assert all("changed 19.8 mm before the point of the move in line 6" in row[1] for row in rows)


def found(*body, until=None, robot=None):
    text = "def f():\n" + "".join(f"  {line}\n" for line in body) + "end\n"
    run = (robot or VirtualRobot("CS66")).run(text)
    return [(row.code, row.line) for row in run.findings if row.source != "check" or row.code == "N224"]


def stream(t, sleep):
    return [
        "q = get_actual_joint_positions()",
        "for i in range(6):",
        "  q[0] = q[0] + 0.02",
        f"  servoj(q, t={t}, lookahead_time=0.03, gain=2000)",
        *([f"  sleep({sleep})"] if sleep else []),
        "end",
        "stopj(2)",
    ]


class TestInRuns:
    @pytest.mark.parametrize(
        ("t", "sleep", "expected"),
        [(0.008, 0.2, [("W290", 5)]), (0.1, 0.1, [("W290", 5)]), (0.2, 0, []), (0.008, 0, []), (0.1, 0, [])],
    )
    def test_servo_targets(self, t, sleep, expected):
        assert found(*stream(t, sleep)) == expected

    BELT = (
        "encoder_enable_set_tick_count(0, 0)",
        "def belt():",
        "  n = 0",
        "  while True:",
        "    n = n + 4",
        "    encoder_set_tick_count(0, n)",
        "    sync()",
        "  end",
        "end",
        "start_thread(belt, ())",
    )

    @pytest.mark.parametrize(("encoder", "seconds", "expected"), [(0, 1, []), (1, 1, [("W291", 12)]), (1, 0.2, [])])
    def test_encoders(self, encoder, seconds, expected):
        body = [f"track_conveyor_linear([1, 0, 0, 0, 0, 0], 10000, {encoder})", f"sleep({seconds})"]
        assert found(*self.BELT, *body, "stop_conveyor_tracking()") == expected

    @pytest.mark.parametrize(
        ("force", "seconds", "expected"), [(-10, 0.6, [("N288", 2)]), (-10, 0.2, []), (0, 0.6, [])]
    )
    def test_force_mode_in_the_air(self, force, seconds, expected):
        mode = f"force_mode([0] * 6, [0, 0, 1, 0, 0, 0], [0, 0, {force}, 0, 0, 0], 0, [0.02] * 6)"
        assert found(mode, f"sleep({seconds})", "end_force_mode()") == expected

    def test_refused_moves(self):
        loop = [
            "for i in range({}):",
            "  try:",
            "    movej([9, 0, 0, 0, 0, 0])",
            "  except:",
            "    sleep(0.05)",
            "  end",
        ]
        text = "\n".join(loop)
        assert found(*text.format(12).splitlines(), "end") == [("W292", 4)]
        assert found(*text.format(9).splitlines(), "end") == []

    def test_a_path_of_short_moves(self):
        def path(step, r):
            return [
                "p = get_target_tcp_pose()",
                "for i in range(35):",
                f"  p[2] = p[2] - {step}",
                f"  movel(p, v=1, a=10, r={r})",
                "end",
            ]

        assert found(*path(0.001, 0)) == [("N224", 5)]
        assert [row for row in found(*path(0.001, 0.0004)) if row[0] == "N224"] == []
        assert found(*path(0.006, 0)) == []

    @pytest.mark.parametrize(("r", "expected"), [(0.02, [("N223", 5)]), (0, [])])
    def test_an_output_behind_a_blended_move(self, r, expected):
        body = ["p = get_target_tcp_pose()", "p[2] = p[2] - 0.1", f"movel(p, v=0.1, r={r})", "set_flag(0, True)"]
        assert found(*body, "p[0] = p[0] + 0.1", "movel(p, v=0.1)") == expected


@pytest.mark.parametrize(
    ("call", "a_tick"),
    [("movel([2.0, 0, 0.3, 3.14, 0, 0])", 10), ("get_inverse_kin([2.0, 0, 0.3, 3.14, 0, 0])", 100)],
)
def test_a_loop_that_swallows_refusals_makes_few_in_a_tick(call: str, a_tick: int) -> None:
    lines = f"n = 0\nwhile True:\n  try:\n    {call}\n  except:\n    n = n + 1\n  end\nend\n"
    run = VirtualRobot().run(lines.replace("n = 0", "global n\nn = 0"), until_s=0.04)
    assert 0.8 * a_tick < run.globals["n"] / 10 <= 1.2 * a_tick
    assert any(row.code == "W292" for row in run.findings)


def test_refusals_that_are_told_take_no_tick_of_their_own() -> None:
    call = "  try:\n    movel([2.0, 0, 0.3, 3.14, 0, 0])\n  except Exception as e:\n    textmsg(e)\n  end\n"
    run = VirtualRobot().run(f"def job():\n{8 * call}  textmsg(controller_timestamp())\nend\n")
    assert run.time_s == 0.0
