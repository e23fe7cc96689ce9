"""Force control and hand guiding: what the commands make of their arguments."""

from __future__ import annotations

from typing import Any

import pytest

from elitescript.errors import ArgumentRangeError, ScriptError
from elitescript.messages.machine import SetForceDamping, SetForceGain, ZeroForceSensor
from elitescript.messages.yielding import EndForceMode, EndFreedrive, ForceMode, Freedrive

FRAME = [0.1, 0.2, 0.3, 0.0, 0.0, 1.5]
WRENCH = [0.0, 0.0, -20.0, 0.0, 0.0, 0.0]
LIMITS = [0.1, 0.1, 0.05, 1.0, 1.0, 1.0]
Z = (False, False, True, False, False, False)


def test_force_mode_passes_its_arguments_on(call: Any, robot: Any) -> None:
    assert call("force_mode", FRAME, [0, 0, 1, 0, 0, 0], WRENCH, 2, LIMITS) is None
    call("end_force_mode")
    assert robot.asked == [ForceMode(tuple(FRAME), Z, tuple(WRENCH), 2, tuple(LIMITS)), EndForceMode()]


def test_of_numbers_as_the_vendors_client_sends_them_only_1_selects_with_one_warning(call: Any, robot: Any) -> None:
    call("force_mode", FRAME, [0.0, 2.0, 1.0, 0.0, 0.0, 6.0], WRENCH, 0, LIMITS)
    (kind, _, text), request = robot.asked
    assert kind == "warn_once"
    assert "selection_vector" in text
    assert request.selection == Z


def test_booleans_and_floats_of_zero_and_one_select_without_a_warning(call: Any, robot: Any) -> None:
    call("force_mode", FRAME, [False, False, True, 0.0, 0, 0], WRENCH, 0, LIMITS)
    assert [request.selection for request in robot.asked] == [Z]


def test_speed_limits_count_without_their_sign(call: Any, robot: Any) -> None:
    call("force_mode", FRAME, [0, 0, 1, 0, 0, 0], WRENCH, 0, [-0.1, *LIMITS[1:]])
    assert robot.asked[0][0] == "warn_once"
    assert robot.asked[1].speed_limits == tuple(LIMITS)


@pytest.mark.parametrize(
    "text",
    [
        "force_mode([0]*6, [0]*6, [0]*6, 4, [1]*6)",
        "force_mode([0]*6, [0]*6, [float('nan')] + [0]*5, 0, [1]*6)",
        "force_mode([0]*6, [0]*5, [0]*6, 0, [1]*6)",
        "force_mode_set_gain_scaling(2.1)",
        "force_mode_set_gain_scaling(-0.1)",
        "force_mode_set_damping(1.01)",
        "freedrive_mode([2, 0, 0, 0, 0, 0])",
        "freedrive_mode([1] * 6, 'flange')",
    ],
)
def test_what_no_client_sends_is_refused(script: Any, robot: Any, text: str) -> None:
    with pytest.raises(ScriptError):
        script(text.replace("float('nan')", "1e999"))
    assert robot.asked == []


def test_settings_are_requests(script: Any, robot: Any) -> None:
    script("[force_mode_set_gain_scaling(2), force_mode_set_damping(0.5), zero_ftsensor()]")
    assert robot.asked == [SetForceGain(2.0), SetForceDamping(0.5), ZeroForceSensor()]


def test_out_of_range_gain_says_the_range(script: Any) -> None:
    with pytest.raises(ArgumentRangeError) as caught:
        script("force_mode_set_gain_scaling(3)")
    assert caught.value.limit == "in [0, 2]"


def test_force_is_the_length_of_the_compensated_force(script: Any) -> None:
    assert script("get_tcp_force(True)") == [3.0, 4.0, 12.0, 0.1, 0.2, 0.3]
    assert script("get_tcp_force(False)")[0] == 3.5
    assert script("force()") == 13.0


def test_freedrive_takes_axes_and_frame(script: Any, robot: Any) -> None:
    script("freedrive_mode()")
    script("freedrive_mode([0, 1, 0, 0, 0, 0], 'tool')")
    script("freedrive_mode(frame='base')")
    script("freedrive_mode(frame=[0, 0, 0.1, 0, 0, 1])")
    script("end_freedrive_mode()")
    everything = (True,) * 6
    assert robot.asked == [
        Freedrive(everything, (0.0,) * 6),
        Freedrive((False, True, False, False, False, False), None),
        Freedrive(everything, (0.0,) * 6),
        Freedrive(everything, (0.0, 0.0, 0.1, 0.0, 0.0, 1.0)),
        EndFreedrive(),
    ]
