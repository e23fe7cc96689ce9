"""The controller's own Modbus server as the machine sees it."""

from __future__ import annotations

import ast

import pytest

from elitescript.errors import ArgumentRangeError, InvalidValueError, ScriptError, ScriptStateError
from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.enums import AnalogDomain, RunstateChoice
from elitescript.messages.events import TextMessage
from elitescript.messages.inputs import RunUnit
from elitescript.messages.machine import (
    MachineRequest,
    SetRunstateChoice,
    SetTcp,
    SetToolPin,
    ToolPinMode,
    WritePortCoils,
    WritePortRegisters,
    WriteSignal,
)
from elitescript.modbus.port_image import PortImage
from elitescript.modbus.port_map import REGISTER_COUNT, View
from elitescript.robot import VirtualRobot


def machine(*requests: MachineRequest) -> VirtualRobot:
    robot = VirtualRobot("CS66")
    for request in requests:
        robot.controller.request(request)
    return robot


def register(robot: VirtualRobot, address: int) -> int:
    return robot.controller.port_register(address, (2, 15, 0))


def test_coils_of_one_word_do_not_disturb_each_other() -> None:
    robot = machine(WritePortCoils(33, (True,)), WritePortCoils(40, (True, True)), WritePortCoils(41, (False,)))
    assert register(robot, 2) == 0x0102
    assert robot.controller.port_coil(40)
    assert not robot.controller.port_coil(41)


def test_general_values_are_signals() -> None:
    robot = machine(WritePortRegisters(256, (1, 2)), WritePortCoils(60, (True,)))
    assert (robot.signals["general_register[1]"], robot.signals["general_coil[0]"]) == (2, True)
    robot.signals["general_register[127]"] = 65535
    robot.signals["general_coil[67]"] = True
    assert register(robot, 383) == 65535
    assert robot.controller.port_coil(127)


def test_a_level_belongs_to_the_domain_that_is_written_with_it() -> None:
    robot = machine(WritePortRegisters(10, (12, 0)))
    assert robot.signals["standard_analog_out[0]"] == 0.012
    assert robot.controller.signals.domain("standard_analog_out", 0) is AnalogDomain.CURRENT
    robot.controller.request(WritePortRegisters(10, (9999, 1)))
    assert robot.signals["standard_analog_out[0]"] == 9.999
    assert (register(robot, 10), register(robot, 11)) == (9999, 1)


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        (WritePortRegisters(10, (21, 0)), r"standard_analog_out\[0\] must be in \[0, 0.02\] A"),
        (WritePortRegisters(12, (10001, 1)), r"standard_analog_out\[1\] must be in \[0, 10\] V"),
        (WritePortRegisters(2, (3, 0x0801)), r"tool pin 3 is an input"),
        (WritePortRegisters(15, (1, 13)), r"register 16: the tool voltage"),
        (WritePortCoils(57, (True, True)), r"tool pin 2 is an input"),
        (WritePortCoils(30, (True,) * 4), r"coil 30 \(reserved\) cannot be written"),
        (WritePortRegisters(256, (1,), 510, 3), r"there is no register 510 to 512"),
        (WritePortRegisters(16, (12, 0)), r"register 17 \(reserved\) cannot be written"),
    ],
)
def test_a_write_is_all_or_nothing(request_: MachineRequest, message: str) -> None:
    robot = machine()
    before = robot.controller.signals.image
    domains = robot.controller.signals.domain_image
    with pytest.raises(ScriptError, match=message):
        robot.controller.request(request_)
    assert robot.controller.signals.image == before
    assert robot.controller.signals.domain_image == domains


def test_a_word_of_outputs_can_be_written_back_whatever_its_pins_are() -> None:
    robot = machine(WriteSignal("tool_digital_out", 0, True), SetToolPin(0, ToolPinMode.PNP, False, False))
    word = register(robot, 3)
    assert word == 0x0100
    robot.controller.request(WritePortRegisters(3, (word | 1,)))
    assert register(robot, 3) == 0x0101
    with pytest.raises(ScriptStateError, match="tool pin 0 is disabled"):
        robot.controller.request(WritePortRegisters(3, (1,)))


def test_an_output_that_is_tied_to_the_task_is_not_written_from_outside() -> None:
    robot = machine(
        SetRunstateChoice("standard_digital_out", 4, RunstateChoice.LOW_WHEN_STOPPED), WritePortCoils(36, (True,))
    )
    assert not robot.controller.port_coil(36)
    run = robot.run("def p():\n  textmsg(read_port_bit(36))\nend\n")
    assert run.log == ["False"]
    assert not robot.controller.port_coil(36)


def test_programs_and_clients_see_the_same() -> None:
    program = (
        "def p():\n  def look():\n    while True:\n"
        "      textmsg([read_port_register(n) for n in range(512)])\n      sync()\n    end\n  end\n"
        "  start_thread(look, ())\n  movej([0.1, -1.4, -1.6, -1.5, 1.5, 0.2])\nend\n"
    )
    kernel = Kernel(RobotOptions(power_on=True))
    version = kernel.description.version
    seen = 0
    for tick in range(60):
        output = kernel.tick_and_snapshot([RunUnit("primary#1", "program", program)] if tick == 3 else ())
        outside = PortImage(View(output.snapshot, version)).registers(0, REGISTER_COUNT)
        for event in output.events:
            if isinstance(event, TextMessage):
                assert ast.literal_eval(event.text) == outside
                seen += 1
    assert seen > 50
    assert outside[84] != 0


def test_the_tcp_offset_is_shown_from_the_flange() -> None:
    robot = machine(SetTcp((0.01, -0.02, 0.15, 0.0, 0.0, -1.0)))
    words = [register(robot, address) for address in range(410, 416)]
    assert words == [100, 65536 - 200, 1500, 0, 0, 65536 - 1000]


def test_classes_of_refusals_are_those_of_commands() -> None:
    robot = machine()
    for kind, request in (
        (InvalidValueError, WritePortRegisters(0, (1,))),
        (ArgumentRangeError, WritePortRegisters(16, (1,))),
        (ScriptStateError, WritePortCoils(59, (True,))),
        (ArgumentRangeError, WritePortRegisters(512, (1,))),
    ):
        with pytest.raises(kind):
            robot.controller.request(request)
