"""What each port reads of a snapshot: no more than it says, and all that it says."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.snapshot_parts import ALL_PARTS, ELBOW, JOINTS, LOADS, POSES, TCP_SPEEDS, TEMPERATURES, TIME
from elitescript.modbus.port_image import PortImage
from elitescript.modbus.port_map import REGISTER_COUNT, REGISTER_PARTS, REGISTERS, View
from elitescript.protocol.dashboard.answers import Asked
from elitescript.protocol.dashboard.verbs import VERBS as DASHBOARD_VERBS
from elitescript.protocol.primary.connection import PORTS, PrimaryConnection, PrimaryFeed
from elitescript.protocol.primary.packets import STATE_PARTS, SUB_MESSAGES, pack_state
from elitescript.protocol.rtsi.connection import RtsiConnection
from elitescript.protocol.rtsi.recipes import OutputRecipe, RtsiPort
from elitescript.protocol.rtsi.variables import OUTPUT_ROWS, OUTPUTS
from elitescript.services.control.verbs import VERBS, VerbRequest
from tests.messages.snapshot_fields import FIELDS, with_parts_of
from tests.protocol import rtsi_client
from tests.protocol.snapshots import description, output, six, snapshot

HERE = snapshot(1000)
THERE = snapshot(
    2000,
    is_moving=True,
    line=5,
    node=(7, "MoveL"),
    speed_scaling=0.25,
    **{name: six(30.0 + number) for number, name in enumerate(sorted(FIELDS[JOINTS] | FIELDS[POSES]))},
    **{name: six(50.0 + number) for number, name in enumerate(sorted(FIELDS[TCP_SPEEDS]))},
    joint_torques=six(60.0),
    joint_currents=six(61.0),
    joint_temperatures=six(62.0),
    tcp_force=six(63.0),
    raw_wrench=six(64.0),
    elbow_position=(65.0, 65.1, 65.2),
    elbow_velocity=(66.0, 66.1, 66.2),
    controller_temperature=67.0,
    robot_current=68.0,
    tool_temperature=69.0,
)
"""Every field that is in a part is another one."""


def parts_that_matter(read: Callable[[Snapshot], object]) -> int:
    """Return the parts without which the same is not read."""
    whole = read(HERE)
    return sum(part for part in FIELDS if read(with_parts_of(HERE, THERE, part)) != whole)


@pytest.mark.parametrize("name", OUTPUTS)
def test_an_rtsi_variable_reads_its_parts(name: str) -> None:
    assert parts_that_matter(OUTPUTS[name].read) == OUTPUTS[name].parts


def test_a_recipe_reads_the_parts_of_its_variables_and_the_time() -> None:
    for names, parts in (
        (("robot_mode",), TIME),
        (("actual_joint_positions", "actual_TCP_pose"), TIME | JOINTS | POSES),
        ((*tuple(OUTPUTS)[:100], "ft_raw_wrench"), ALL_PARTS),
    ):
        recipe = OutputRecipe(1, names, 250.0)
        assert recipe.parts == parts
        package = recipe.packed(output(1000))
        assert recipe.packed(Output(1000, (), (), (), with_parts_of(HERE, THERE, ALL_PARTS & ~parts))) == package
    assert {row.parts for row in OUTPUT_ROWS} >= {0, *FIELDS}


@pytest.mark.parametrize("part", SUB_MESSAGES, ids=lambda part: part.name)
def test_a_field_of_the_primary_packet_reads_its_parts(part) -> None:
    robot = description()
    for row in part.rows:
        assert parts_that_matter(lambda seen, row=row: row.read(seen, robot)) == row.parts, row.field.name


def test_the_primary_packet_reads_what_its_fields_read() -> None:
    assert parts_that_matter(lambda seen: pack_state(SUB_MESSAGES, seen, description())) == STATE_PARTS
    assert STATE_PARTS == TIME | JOINTS | POSES | LOADS | TEMPERATURES | ELBOW


@pytest.mark.parametrize("row", REGISTERS, ids=lambda row: str(row.first))
def test_a_register_reads_its_parts(row) -> None:
    assert parts_that_matter(lambda seen: list(row.read(View(seen, (2, 14, 2))))) == row.parts


def test_the_modbus_port_reads_what_its_registers_read() -> None:
    def image(seen: Snapshot) -> list[int]:
        return PortImage(View(seen, (2, 14, 2))).registers(0, REGISTER_COUNT)

    assert parts_that_matter(image) == REGISTER_PARTS == JOINTS | POSES | TCP_SPEEDS | LOADS | TEMPERATURES


@pytest.mark.parametrize("row", [row for rows in DASHBOARD_VERBS.values() for row in rows], ids=lambda row: row.usage)
def test_the_dashboard_reads_the_discrete_state_alone(row) -> None:
    def answer(seen: Snapshot) -> object:
        refusal = "" if row.guard is None else row.guard.refusal(seen)
        return refusal, row.answer(Asked("dashboard#1", "", seen, description()))

    assert parts_that_matter(answer) == 0


@pytest.mark.parametrize("verb", [verb for verb in VERBS.values() if verb.read], ids=lambda verb: verb.name)
def test_a_verb_of_ctl_reads_its_parts(verb) -> None:
    def read(seen: Snapshot) -> object:
        request = VerbRequest("ctl#1/1", (), {}, seen, description())
        return verb.read(request, Output(1000, (), (), (), seen))

    assert parts_that_matter(read) == verb.parts


def test_a_client_of_the_primary_port_reads_them_when_its_state_is_due() -> None:
    connection = PrimaryConnection("primary#1", description(), PrimaryFeed(description(), PORTS[0]))
    assert connection.reads(1000) == STATE_PARTS
    connection.publish(output(1000))
    assert [tick for tick in range(1001, 1060) if connection.reads(tick)] == list(range(1025, 1060))


def streaming(*names: str) -> RtsiConnection:
    connection = RtsiConnection("rtsi#1", description(), RtsiPort())
    assert connection.reads(1000) == ALL_PARTS
    connection.receive(rtsi_client.output_recipe(25.0, names) + rtsi_client.message("S"), output(1000))
    connection.take()
    return connection


def test_an_rtsi_client_reads_the_parts_of_the_recipes_that_are_due() -> None:
    connection = streaming("timestamp", "actual_TCP_pose")
    connection.receive(rtsi_client.output_recipe(125.0, ["joint_temperatures"]), output(1000))
    connection.publish(output(1000))
    found = {tick: connection.reads(tick) for tick in range(1001, 1011)}
    assert found == dict.fromkeys(range(1001, 1011), TIME | TEMPERATURES) | {1001: 0, 1010: TIME | TEMPERATURES | POSES}


def test_a_recipe_that_comes_later_waits_for_its_parts() -> None:
    connection = streaming("actual_TCP_pose")
    seen = output(1001)
    lacking = Output(1001, (), (), (), seen.snapshot, TIME)
    connection.receive(rtsi_client.output_recipe(250.0, ["joint_temperatures"]), lacking)
    connection.take()
    connection.publish(lacking)
    under_way = output(1002)
    connection.publish(Output(1002, (), (), (), under_way.snapshot, TIME))
    assert connection.take() == []
    assert connection.reads(1003) == TIME | TEMPERATURES
    connection.publish(output(1003))
    assert len(connection.take()) == 1
