"""Robot state on the primary port: every byte has its place."""

from __future__ import annotations

import math
import struct

import pytest

from elitescript.messages.enums import AnalogDomain, RobotMode, SafetyMode, TaskState
from elitescript.protocol.binary import UINT8
from elitescript.protocol.primary.packets import (
    STATE_SIZE,
    SUB_MESSAGES,
    PacketField,
    SubMessage,
    pack_state,
    timestamp,
)
from tests.protocol import primary_client as client
from tests.protocol.snapshots import description, snapshot

SIX = (0.1, -1.5, 1.7, -1.25, -1.5, 3.0)
ORDER = [(0, 53), (1, 347), (4, 101), (6, 445), (3, 88), (8, 10), (2, 37), (10, 43), (11, 28)]
"""Type and length of each sub-message, as public clients have found them."""

OFFSETS = {
    "robot mode": [5, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 30, 38, 46, 47, 48, 49],
    "joints": [5 + at for at in (0, 8, 16, 24, 28, 32, 36, 40, 44, 48, 52, 53)],
    "cartesian": [5, 53],
    "configuration": [5, 101, 197, 205, 213, 221, 229, 237, 285, 333, 381, 429, 433, 437, 441],
    "master board": [5, 9, 13, 14, 15, 16, 24, 32, 40, 41, 42, 43, 51, 59, 67, 71, 75, 79, 83, 84, 85, 86, 87],
    "additional info": [5, 6, 7, 8, 9],
    "tool": [5, 6, 7, 15, 23, 27, 28, 32, 36],
    "safety": [5, 9, 10, 11, 35],
    "tool communication": [5, 6, 10, 14, 18, 19, 20, 24],
}
"""Where the fields begin."""


def state(**changes) -> dict[int, bytes]:
    """The sub-messages by type."""
    return dict(client.sub_messages(pack_state(SUB_MESSAGES, snapshot(**changes), description())))


def single(*values: float) -> tuple:
    """Values as 32-bit floats keep them."""
    return tuple(pytest.approx(value, rel=1e-6) for value in values)


def with_signals(**levels: tuple) -> dict:
    """Levels of families, from index 0 on."""
    return {"signals": {family: dict(enumerate(values)) for family, values in levels.items()}}


class TestLayout:
    @pytest.mark.parametrize(("value", "shown"), [(1e200, math.inf), (-1e200, -math.inf), (math.nan, math.nan)])
    def test_a_value_that_no_float_holds_goes_as_infinity_and_the_state_keeps_its_length(self, value, shown):
        currents = (value, 1.0, 2.0, 3.0, 4.0, 5.0)
        message = pack_state(SUB_MESSAGES, snapshot(joint_currents=currents), description())
        assert len(message) == STATE_SIZE
        joints = dict(client.sub_messages(message))[1]
        sent = [struct.unpack_from(">f", joints, 5 + 57 * index + 36)[0] for index in range(6)]
        assert sent == pytest.approx([shown, *currents[1:]], nan_ok=True)

    def test_state_has_exactly_the_length_that_clients_insist_on(self):
        message = pack_state(SUB_MESSAGES, snapshot(), description())
        assert len(message) == STATE_SIZE == 1157
        assert message[:5] == bytes([0, 0, 0x04, 0x85, 16])

    def test_sub_messages_come_in_the_observed_order_and_sizes(self):
        message = pack_state(SUB_MESSAGES, snapshot(), description())
        assert [(number, len(data)) for number, data in client.sub_messages(message)] == ORDER

    def test_every_field_begins_where_clients_look_for_it(self):
        assert {part.name: list(part.offsets()) for part in SUB_MESSAGES} == OFFSETS

    def test_every_row_says_how_well_it_is_known(self):
        known = {"documented", "observed", "assumed"}
        assert {row.field.evidence for part in SUB_MESSAGES for row in part.rows} <= known
        assert {part.evidence for part in SUB_MESSAGES} <= known

    def test_a_table_with_the_wrong_size_is_found_at_once(self):
        with pytest.raises(AssertionError, match="6 bytes in the table, not 7"):
            SubMessage("wrong", 9, 7, "assumed", PacketField("only", UINT8, "", "assumed", 0))

    def test_a_part_may_be_left_out(self):
        message = pack_state(SUB_MESSAGES[:3], snapshot(), description())
        assert [number for number, _ in client.sub_messages(message)] == [0, 1, 4]


class TestRobotMode:
    def test_time_is_in_microseconds(self):
        assert client.robot_mode(state(tick=10)[0])["timestamp"] == timestamp(10) == 40_000

    @pytest.mark.parametrize(
        ("mode", "number", "powered"),
        [
            (RobotMode.NO_CONTROLLER, 255, False),
            (RobotMode.POWER_OFF, 3, False),
            (RobotMode.POWER_ON, 4, True),
            (RobotMode.IDLE, 5, True),
            (RobotMode.RUNNING, 7, True),
        ],
    )
    def test_shows_power_and_mode(self, mode, number, powered):
        shown = client.robot_mode(state(robot_mode=mode)[0])
        assert (shown["mode"], shown["powered"]) == (number, powered)

    @pytest.mark.parametrize(
        ("mode", "emergency", "protective"),
        [
            (SafetyMode.NORMAL, False, False),
            (SafetyMode.PROTECTIVE_STOP, False, True),
            (SafetyMode.SYSTEM_EMERGENCY_STOP, True, False),
            (SafetyMode.ROBOT_EMERGENCY_STOP, True, False),
            (SafetyMode.SAFEGUARD_STOP, False, False),
        ],
    )
    def test_shows_stops(self, mode, emergency, protective):
        shown = client.robot_mode(state(safety_mode=mode)[0])
        assert (shown["emergency"], shown["protective"]) == (emergency, protective)

    @pytest.mark.parametrize(
        ("task", "running", "paused"),
        [(TaskState.PLAYING, True, False), (TaskState.PAUSED, False, True), (TaskState.STOPPED, False, False)],
    )
    def test_shows_the_task(self, task, running, paused):
        shown = client.robot_mode(state(task_state=task)[0])
        assert (shown["running"], shown["paused"]) == (running, paused)

    def test_shows_speeds_and_hand_guiding(self):
        shown = client.robot_mode(state(speed_scale=0.75, speed_scaling=0.125, is_freedrive=True)[0])
        assert (shown["slider"], shown["scaling"], shown["limit"], shown["control"]) == (0.75, 0.125, 1.0, 1)


class TestArm:
    def test_joints_stand_in_six_records(self):
        changes = {
            "q_actual": SIX,
            "q_target": tuple(x + 1 for x in SIX),
            "qd_actual": tuple(x / 2 for x in SIX),
            "joint_currents": tuple(x + 2 for x in SIX),
            "joint_voltages": tuple(x + 3 for x in SIX),
            "joint_temperatures": tuple(x + 4 for x in SIX),
            "joint_torques": tuple(x + 5 for x in SIX),
        }
        records = client.joints(state(**changes)[1])
        for index, record in enumerate(records):
            q = SIX[index]
            assert (record["q_actual"], record["q_target"], record["qd"]) == (q, q + 1, q / 2)
            measured = record["current"], record["voltage"], record["temperature"], record["torque"]
            assert measured == single(q + 2, q + 3, q + 4, q + 5)
            assert record["mode"] == 253
            assert record["reserved"] == 0

    @pytest.mark.parametrize(
        ("robot", "safe", "number"),
        [
            (RobotMode.POWER_OFF, SafetyMode.NORMAL, 239),
            (RobotMode.IDLE, SafetyMode.NORMAL, 255),
            (RobotMode.RUNNING, SafetyMode.PROTECTIVE_STOP, 253),
            (RobotMode.RUNNING, SafetyMode.FAULT, 252),
            (RobotMode.RUNNING, SafetyMode.VIOLATION, 251),
        ],
    )
    def test_joint_mode_follows_power_and_safety(self, robot, safe, number):
        records = client.joints(state(robot_mode=robot, safety_mode=safe)[1])
        assert {record["mode"] for record in records} == {number}

    @pytest.mark.parametrize("mode", RobotMode)
    def test_every_robot_mode_can_be_shown(self, mode):
        assert 235 <= client.tool(state(robot_mode=mode)[2])[-1] <= 255

    def test_cartesian_is_pose_and_offset(self):
        offset = tuple(x / 8 for x in SIX)
        parts = state(tcp_pose_actual=SIX, tcp_offset=offset)
        assert client.cartesian(parts[4]) == (SIX, offset)

    def test_not_a_number_is_passed_on(self):
        assert math.isnan(client.cartesian(state(tcp_pose_actual=(math.nan,) * 6)[4])[0][0])

    def test_configuration_is_the_description(self):
        robot = description()
        shown = client.configuration(state()[6])
        assert shown["limits"] == list(zip(robot.q_min, robot.q_max, strict=True))
        assert shown["maxima"] == list(zip(robot.qd_max, robot.qdd_max, strict=True))
        assert shown["defaults"] == (
            robot.default_joint_speed,
            robot.default_joint_acceleration,
            robot.default_tool_speed,
            robot.default_tool_acceleration,
        )
        assert shown["radius"] == robot.equivalent_radius_m
        assert (shown["a"], shown["d"], shown["alpha"]) == (robot.dh_a, robot.dh_d, robot.dh_alpha)
        assert shown["versions"] == (0, 0, robot.type_id, 0)


class TestSignals:
    def test_digital_words_hold_standard_configurable_and_tool_points(self):
        def lit(size, *indices):
            return tuple(index in indices for index in range(size))

        changes = with_signals(
            standard_digital_in=lit(16, 0, 15),
            configurable_digital_in=lit(8, 1),
            tool_digital_in=lit(4, 3),
            standard_digital_out=lit(16, 2),
            configurable_digital_out=lit(8, 0, 7),
            tool_digital_out=lit(4, 0),
        )
        shown = client.master_board(state(**changes)[3])
        assert shown["inputs"] == 1 | 1 << 15 | 1 << 17 | 1 << 27
        assert shown["outputs"] == 1 << 2 | 1 << 16 | 1 << 23 | 1 << 24

    def test_analog_channels_have_value_and_domain(self):
        volt, ampere = AnalogDomain.VOLTAGE, AnalogDomain.CURRENT
        changes = with_signals(
            standard_analog_in=(1.5, 0.004),
            standard_analog_out=(0.02, 2.5),
            tool_analog_in=(3.5,),
            tool_analog_out=(4.5,),
        )
        domains = {
            "standard_analog_in": (volt, ampere),
            "standard_analog_out": (ampere, volt),
            "tool_analog_in": (volt,),
            "tool_analog_out": (ampere,),
        }
        parts = state(**changes, domains=domains)
        shown = client.master_board(parts[3])
        assert (shown["analog_in"], shown["input_domains"]) == ((1.5, 0.004, 3.5), (1, 0, 1))
        assert (shown["analog_out"], shown["output_domains"]) == ((0.02, 2.5, 4.5), (0, 1, 0))
        assert client.tool(parts[2])[:4] == (0, 1, 4.5, 3.5)

    def test_board_shows_supply_and_safety(self):
        shown = client.master_board(
            state(
                controller_temperature=31.5,
                robot_voltage=48.25,
                robot_current=2.5,
                io_current=0.75,
                safety_mode=SafetyMode.REDUCED,
            )[3]
        )
        assert shown["board"] == (31.5, 48.25, 2.5, 0.75)
        assert (shown["safety"], shown["reduced"], shown["rest"]) == (2, 1, bytes(3))


class TestSmallParts:
    def test_tool_shows_its_supply(self):
        changes = with_signals(tool_voltage=(24,)) | {"tool_current": 0.5, "tool_temperature": 36.5}
        assert client.tool(state(**changes)[2])[4:] == (24.0, 24, 0.5, 36.5, 253)

    def test_additional_info_shows_hand_guiding(self):
        assert state(is_freedrive=True)[8][5:] == bytes([1, 0, 0, 0, 0])
        assert state(is_freedrive=True, is_guided_by_input=True)[8][5:] == bytes([1, 0, 1, 0, 0])
        assert state()[8][5:] == bytes(5)

    def test_safety_shows_checksum_and_elbow(self):
        shown = client.safety(state(elbow_position=(0.25, -0.5, 0.75))[10])
        assert shown == (description().safety_checksum, -1, 0, 0.25, -0.5, 0.75, 0.0)

    def test_tool_communication_is_off(self):
        assert client.tool_communication(state()[11]) == (False, 115200, 0, 1, False, 0, 0.0, 0.0)


class TestBadValues:
    @pytest.mark.parametrize(("changes", "field"), [(with_signals(tool_voltage=(999,)), "output voltage")])
    def test_a_value_that_does_not_fit_is_named(self, changes, field):
        with pytest.raises(ValueError, match=rf"^{field}: "):
            state(**changes)

    def test_a_type_number_that_does_not_fit_is_named(self):
        wrong = description(type_id=-1)
        with pytest.raises(ValueError, match=r"^robot type: -1 "):
            pack_state(SUB_MESSAGES, snapshot(), wrong)
