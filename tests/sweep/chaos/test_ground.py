"""What there is to disturb is what the world has, what the program reads, and when something happens there."""

from __future__ import annotations

from typing import Any

import pytest

from elitescript import VirtualRobot
from elitescript.controller.safety.limits import SafetyLimits
from elitescript.devices.channels.faults import TABLE, Fault
from elitescript.language.text.source import SourceFile
from elitescript.messages.profile import profile
from elitescript.sweep.chaos.ground import read_of, survey
from elitescript.testing.world import ModbusDevice, World
from tests.sweep.chaos.cells import GRIPPER, surveyed, world


def test_places_are_those_of_the_world_that_the_program_uses() -> None:
    ground, _, _ = surveyed()
    places = {(one.place.on, one.place.kind, one.place.device) for one in ground.chances if one.place}
    # Input 5 is driven but not read, and a register is no input that can be disturbed.
    assert places == {(5000, "tcp", "gripper"), ("standard_digital_in[4]", "digital", "sensor")}


@pytest.mark.parametrize("place", [{"port": 502}, {"line": "tool", "unit": 1}])
def test_a_modbus_device_can_be_disturbed_at_its_port_or_line(place: dict[str, Any]) -> None:
    robot = VirtualRobot("CS66", world=World([ModbusDevice(name="plc", coils=1, **place)]), task_dir={})
    assert robot.surroundings is not None
    ((on, _, device),) = robot.surroundings.fault_places()
    assert (on, device) == (str(place.get("port", "tool")), "plc")
    assert str(robot.surroundings.check_fault(Fault("drop", "plc")).on) == on
    ground = survey(robot, robot.run("def p():\n  sleep(0.1)\nend"), ())
    assert {"drop", "silence", "wrong_reply"} <= {one.kind for one in ground.chances}


def test_every_chance_is_a_fault_that_the_world_takes() -> None:
    ground, _, _ = surveyed()
    faults = [(one.kind, one.place.on, one.settings) for one in ground.chances if one.kind in TABLE and one.place]
    assert len(faults) == 15
    for kind, on, settings in faults:
        world().check_fault(Fault(kind, on, **settings))
    assert {settings["form"] for kind, _, settings in faults if kind == "wrong_reply"} == {"text"}


def test_moments_are_those_of_the_plain_run() -> None:
    ground, _, run = surveyed()
    by_kind = {one.kind: one.place for one in ground.chances if one.place}
    drop, stuck = by_kind["drop"], by_kind["stuck"]
    assert drop is not None
    assert stuck is not None
    assert len(drop.moments) == 6  # three requests, three answers
    assert len(stuck.moments) == 6  # three times up and down
    assert len(ground.rises["standard_digital_in[4]"]) == 3
    assert ground.plain.state == "finished"
    assert ground.plain.time_s == run.time_s


def test_reduced_mode_needs_limits_and_a_push_a_program_that_feels() -> None:
    kinds = {one.kind for one in surveyed()[0].chances}
    assert {"pause", "protective_stop", "safeguard_stop", "slider"} <= kinds
    assert not {"reduced_mode", "push"} & kinds
    robot = VirtualRobot("CS66", safety=SafetyLimits())
    run = robot.run("def p():\n  x = get_tcp_force(True)\nend")
    assert {"reduced_mode", "push"} <= {one.kind for one in survey(robot, run, ()).chances}


def test_a_program_without_a_world_has_the_inputs_that_it_reads() -> None:
    robot = VirtualRobot("CS66")
    run = robot.run("def p():\n  x = get_tool_analog_in()\n  y = get_configurable_digital_in(2)\nend")
    places = {one.place.on for one in survey(robot, run, ()).chances if one.place}
    assert places == {"configurable_digital_in[2]", "tool_analog_in"}


def test_an_index_that_is_not_known_stands_for_what_is_driven() -> None:
    program = "def p():\n  for n in range(16):\n    x = get_standard_digital_in(n)\n  end\nend"
    ground, _, _ = surveyed(program)
    assert {one.place.on for one in ground.chances if one.place and one.place.kind == "digital"} == {
        "standard_digital_in[4]",
        "standard_digital_in[5]",
    }


def test_constants_of_the_program_are_followed() -> None:
    found = read_of(SourceFile("p", GRIPPER), profile("2.14"))
    assert found.inputs == {"standard_digital_in[4]"}
    assert not found.families
