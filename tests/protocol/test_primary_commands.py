"""Plain command lines: exactly these words, nothing that looks like them."""

from __future__ import annotations

import pytest

from elitescript.messages.machine import (
    AskSafety,
    PauseTask,
    PowerOff,
    PowerOn,
    ReleaseBrakes,
    SetSpeedScale,
    StopTask,
)
from elitescript.protocol.primary.commands import COMMANDS, request_of

REQUESTS = {
    "power on": PowerOn(),
    "power off": PowerOff(),
    "set robotmode run": ReleaseBrakes(),
    "pause task": PauseTask(),
    "stop task": StopTask(),
    "set unlock protective stop": AskSafety("unlock_protective_stop"),
    "restart safetyboard": AskSafety("restart_safety"),
    "set speed 0.50": SetSpeedScale(0.5),
}


@pytest.mark.parametrize("line", REQUESTS)
def test_each_line_makes_its_request(line):
    assert request_of(line) == REQUESTS[line]


def test_every_command_of_the_table_is_tried_above():
    assert len(REQUESTS) == len(COMMANDS)


@pytest.mark.parametrize("line", ["  stop   task ", "\tstop task\t", "stop task\r"])
def test_blanks_do_not_matter(line):
    assert request_of(line) == StopTask()


@pytest.mark.parametrize("fraction", [0.0, 0.01, 0.29, 1.0])
def test_speed_is_the_fraction_that_was_written(fraction):
    assert request_of(f"set speed {fraction:.2f}") == SetSpeedScale(fraction)


@pytest.mark.parametrize("text", ["", "1.01", "-0.1", "nan", "inf", "fast", "0,5", "0.5 0.5"])
def test_a_speed_that_makes_no_sense_is_refused(text):
    with pytest.raises(ValueError, match="takes a fraction from 0 to 1"):
        request_of(f"set speed {text}")


@pytest.mark.parametrize(
    "line",
    [
        "",
        "stop",
        "stop_task()",
        "Stop task",
        "stop task now",
        "power",
        "set",
        "set_speed(0.5)",
        "set robotmode",
        "movej([0, 0, 0, 0, 0, 0])",
        "x = 'stop task'",
    ],
)
def test_everything_else_is_script(line):
    assert request_of(line) is None
