from __future__ import annotations

from typing import Any

import pytest

from elitescript.commands import conveyor, speed
from elitescript.errors import ScriptError
from elitescript.messages.motion import SpeedJ, SpeedL

QD = [0.2, 0.0, 0.0, 0.0, 0.0, -0.1]
XD = [0.0, 0.1, 0.0, 0.0, 0.0, 0.2]


def test_speedj_passes_its_arguments_on(call: Any, robot: Any) -> None:
    assert call("speedj", QD, 0.5) is None
    call("speedj", QD, 0.5, 1)
    assert robot.asked == [SpeedJ(tuple(QD), 0.5, None), SpeedJ(tuple(QD), 0.5, 1.0)]


def test_speedl_takes_its_acceleration_for_the_rotation_too(call: Any, robot: Any) -> None:
    call("speedl", XD, 0.5)
    call("speedl", XD, 0.5, 0.02, "a")
    call("speedl", XD, 0.5, 0.02, aRot=2)
    x = tuple(XD)
    assert robot.asked == [SpeedL(x, 0.5, 0.5, None), SpeedL(x, 0.5, 0.5, 0.02), SpeedL(x, 0.5, 2.0, 0.02)]


@pytest.mark.parametrize("arguments", [(QD, 0), (QD, -1), (QD, 1, 0), (QD[:5], 1), (QD, float("nan"))])
def test_accelerations_and_times_must_be_positive(call: Any, robot: Any, arguments: Any) -> None:
    for name in ("speedj", "speedl"):
        with pytest.raises(ScriptError, match=f"^{name}: "):
            call(name, *arguments)
    assert robot.asked == []


@pytest.mark.parametrize("name", ["speedj", "speedl", "track_conveyor_linear"])
def test_what_ends_with_a_protective_stop_says_so(name: str) -> None:
    text = " ".join((getattr(conveyor, name, None) or getattr(speed, name)).__doc__.split())
    assert "R140" in text
    assert "with a warning" not in text
