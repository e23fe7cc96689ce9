from __future__ import annotations

from typing import Any

import pytest

from elitescript.messages.motion import ServoJ
from elitescript.messages.profile import profile

Q = [0.1, -1.5, 1.2, -1.3, -1.57, 0.3]


@pytest.mark.parametrize(("firmware", "t_s"), [("2.10", 0.010), ("2.14", 0.004)])
def test_the_control_time_is_that_of_the_firmware(call: Any, robot: Any, firmware: str, t_s: float) -> None:
    robot.profile = profile(firmware)
    assert call("servoj", Q) is None
    assert robot.asked == [ServoJ(tuple(Q), t_s, 0.1, 300.0)]


def test_values_outside_their_ranges_are_limited_with_a_warning(call: Any, robot: Any) -> None:
    call("servoj", Q, 0.001, 0.3, 2500)
    warnings, requests = robot.asked[:-1], robot.asked[-1:]
    assert requests == [ServoJ(tuple(Q), 0.004, 0.2, 2000.0)]
    assert [key for _, key, _ in warnings] == ["servoj t", "servoj lookahead_time", "servoj gain"]
    assert warnings[1][2] == "servoj: lookahead_time must be in [0.03, 0.2] s, got 0.3; 0.2 is used"


def test_values_that_real_clients_send_at_the_ends_of_the_ranges_are_taken(call: Any, robot: Any) -> None:
    call("servoj", Q, 0.008, 0.03, 2000)
    assert robot.asked == [ServoJ(tuple(Q), 0.008, 0.03, 2000.0)]


def test_the_gain_has_no_effect_before_it_was_brought(call: Any, robot: Any) -> None:
    robot.profile = profile("2.10")
    call("servoj", Q, 0.01, 0.1, 5000)
    assert robot.asked == [ServoJ(tuple(Q), 0.01, 0.1, 300.0)]


def test_a_period_that_the_firmware_does_not_document_is_used_with_a_warning(call: Any, robot: Any) -> None:
    robot.profile = profile("2.10")
    call("servoj", Q, 0.004)
    warning, request = robot.asked
    assert request == ServoJ(tuple(Q), 0.004, 0.1, 300.0)
    assert warning == (
        "warn_once",
        "servoj period",
        "servoj: t is 0.004 s; firmware 2.10 documents 0.01 s, and what the real robot does with a shorter one is "
        "not known",
    )
