"""Bytes of the primary port, some written by hand, some by our own server, as a client reads them."""

from __future__ import annotations

import struct

import pytest

from elitescript.client.primary_messages import MessageReader, RobotState, RobotText
from elitescript.errors import PeerError
from elitescript.protocol.primary.messages import KINDS, POPUP
from elitescript.protocol.primary.packets import (
    CARTESIAN,
    CONFIGURATION,
    JOINTS,
    ROBOT_MODE,
    SUB_MESSAGES,
    pack_state,
)
from tests.protocol.snapshots import description, snapshot


def whole(kind: int, body: bytes) -> bytes:
    return struct.pack(">IB", 5 + len(body), kind) + body


def message(kind: int, body: bytes, source: int = 104) -> bytes:
    return whole(20, struct.pack(">QBB", 123456, source, kind) + body)


EXCEPTION = message(10, struct.pack(">ii", 12, 5) + b"NameError: name 'x' is not defined\0")
ERROR = message(6, struct.pack(">iiiI", 51, 3, 2, 5) + "C51: Gelenk übersetzt".encode() + b"\0", source=120)


def one(data: bytes) -> RobotState | RobotText:
    (found,) = MessageReader().feed(data)
    return found


class TestTexts:
    def test_a_script_exception(self):
        found = one(EXCEPTION)
        assert isinstance(found, RobotText)
        assert (found.kind, found.source, found.values["line"], found.values["column"]) == (
            "script exception",
            104,
            12,
            5,
        )
        assert found.texts == {"text": "NameError: name 'x' is not defined"}

    def test_a_robot_error_with_text(self):
        found = one(ERROR)
        assert isinstance(found, RobotText)
        assert (found.kind, found.source) == ("robot error", 120)
        assert [found.values[name] for name in ("code", "sub-code", "level")] == [51, 3, 2]
        assert found.texts == {"text": "C51: Gelenk übersetzt"}

    @pytest.mark.parametrize(
        ("kind", "data", "text"),
        [
            (0, bytes(4), ""),
            (1, struct.pack(">I", 7), "7"),
            (2, struct.pack(">i", -7), "-7"),
            (3, struct.pack(">f", 1.5), "1.5"),
            (4, struct.pack(">I", 255), "0xff"),
            (6, struct.pack(">i", 3), "3"),
            (1, b"\0", ""),
            (77, b"what", ""),
        ],
    )
    def test_a_robot_error_with_a_number(self, kind, data, text):
        found = one(message(6, struct.pack(">iiiI", 1, 0, 1, kind) + data))
        assert isinstance(found, RobotText)
        assert found.texts == {"text": text}

    def test_a_popup(self):
        data = POPUP.pack(250, (0, 0, True, False, True), "Title", "go on?")
        found = one(data)
        assert isinstance(found, RobotText)
        assert found.texts == {"title": "Title", "text": "go on?"}
        assert (found.values["is warning"], found.values["is error"], found.values["is blocking"]) == (
            True,
            False,
            True,
        )

    def test_kinds_that_are_not_known(self):
        assert one(message(99, b"whatever")) == RobotText("kind 99", 104, {}, {"text": ""})

    @pytest.mark.parametrize("kind", [kind for kind in KINDS if len(kind.texts) > 1 or len(kind.fields.fields) > 5])
    def test_a_message_that_is_cut_short_is_no_end(self, kind):
        reader = MessageReader()
        cut, exception = reader.feed(message(kind.number, b"\x01") + EXCEPTION)
        assert isinstance(cut, RobotText)
        assert "cannot be read" in cut.texts["text"]
        assert exception == one(EXCEPTION)


class TestStates:
    STATE = pack_state(SUB_MESSAGES, snapshot(), description())

    def test_the_values_of_our_own_server(self):
        found = one(self.STATE)
        assert isinstance(found, RobotState)
        state, robot = snapshot(), snapshot().robot
        joints, mode = found.part(JOINTS), found.part(ROBOT_MODE)
        cartesian, configuration = found.part(CARTESIAN), found.part(CONFIGURATION)
        assert joints is not None and mode is not None and cartesian is not None and configuration is not None
        assert joints["actual position"] == robot.q_actual
        assert joints["target position"] == robot.q_target
        assert mode["robot mode"] == robot.robot_mode
        assert mode["target speed fraction"] == state.robot.speed_scale
        assert cartesian["TCP pose"] == pytest.approx(robot.tcp_pose_actual)
        assert configuration["DH a"] == description().dh_a
        assert configuration["robot type"] == description().type_id

    def test_further_parts_and_longer_parts_of_newer_firmware(self):
        joints = CARTESIAN.pack(snapshot(), description())
        longer = struct.pack(">IB", len(joints) + 4, CARTESIAN.number) + joints[5:] + b"more"
        found = one(whole(16, whole(200, b"internal") + longer))
        assert isinstance(found, RobotState)
        assert found.part(CARTESIAN) == CARTESIAN.unpack(joints)
        assert found.part(JOINTS) is None

    def test_a_shorter_part_of_older_firmware(self):
        found = one(whole(16, whole(CARTESIAN.number, bytes(48))))
        assert isinstance(found, RobotState)
        assert found.part(CARTESIAN) is None

    @pytest.mark.parametrize("size", [1, 4, 100, 1156])
    def test_in_pieces(self, size):
        reader, stream = MessageReader(), self.STATE + EXCEPTION + whole(77, b"skipped") + ERROR
        found = [item for at in range(0, len(stream), size) for item in reader.feed(stream[at : at + size])]
        assert found == [one(self.STATE), one(EXCEPTION), one(ERROR)]


class TestGarbage:
    @pytest.mark.parametrize("size", [0, 4, (1 << 20) + 1, 0xFFFFFFFF])
    def test_lengths(self, size):
        with pytest.raises(PeerError, match=f"says that it has {size} bytes"):
            MessageReader().feed(struct.pack(">IB", size, 16))

    @pytest.mark.parametrize("body", [b"\0", struct.pack(">IB", 0, 1), struct.pack(">IB", 9, 1)])
    def test_parts(self, body):
        with pytest.raises(PeerError, match="robot state"):
            MessageReader().feed(whole(16, body))

    def test_heads(self):
        with pytest.raises(PeerError, match="its head alone has 15"):
            MessageReader().feed(whole(20, b"\0\0"))
