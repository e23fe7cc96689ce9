"""Bytes of the RTSI port, written by hand, as a client sends and reads them."""

from __future__ import annotations

import struct

import pytest

from elitescript.client.rtsi_messages import (
    TYPES,
    Frame,
    FrameReader,
    InputLayout,
    LossCounter,
    OutputLayout,
    accepted,
    controller_version,
    input_request,
    known,
    output_request,
    set_up_of,
    text_of,
    version_request,
)
from elitescript.errors import PeerError
from tests.protocol import rtsi_client as peer

STREAM = (
    bytes.fromhex("000456 01") + bytes.fromhex("0013 76 00000002 0000000e 00000001 0000002a") + b"\x00\x08M\x02hey!"
)
FRAMES = [
    Frame(ord("V"), b"\x01"),
    Frame(ord("v"), bytes.fromhex("000000020000000e000000010000002a")),
    Frame(ord("M"), b"\x02hey!"),
]


class TestFrames:
    def test_whole(self):
        assert FrameReader().feed(STREAM) == FRAMES

    @pytest.mark.parametrize("size", [1, 2, 3, 5, 7])
    def test_in_pieces(self, size):
        reader = FrameReader()
        found = [frame for at in range(0, len(STREAM), size) for frame in reader.feed(STREAM[at : at + size])]
        assert found == FRAMES

    def test_the_rest_waits(self):
        reader = FrameReader()
        assert reader.feed(STREAM + b"\x00") == FRAMES
        assert reader.feed(b"\x04S\x01") == [Frame(ord("S"), b"\x01")]

    @pytest.mark.parametrize("size", [0, 1, 2])
    def test_sizes_that_no_message_has(self, size):
        with pytest.raises(PeerError, match=f"says that it has {size} bytes; the shortest has 3"):
            FrameReader().feed(bytes((0, size, 86)))


class TestRequests:
    def test_they_are_those_of_another_client(self):
        assert version_request() == b"\x00\x05V\x00\x01"
        assert output_request(["timestamp", "robot_mode"], 125.0) == peer.output_recipe(
            125.0, ["timestamp", "robot_mode"]
        )
        assert input_request(["input_int_register24"]) == peer.input_recipe(["input_int_register24"])

    def test_a_package_of_inputs(self):
        layout = InputLayout(7, ["input_int_register3", "external_force_torque"], ["INT32", "VECTOR6D"])
        values = {"external_force_torque": (1.0, 2.0, 3.0, 4.0, 5.0, 6.0), "input_int_register3": -2}
        assert layout.package(values) == peer.package(7, ["INT32", "VECTOR6D"], [-2, [1, 2, 3, 4, 5, 6]])

    def test_a_value_that_does_not_fit(self):
        with pytest.raises(ValueError, match="input_int_register3"):
            InputLayout(1, ["input_int_register3"], ["INT32"]).package({"input_int_register3": 2**31})


class TestAnswers:
    def test_yes_and_no(self):
        assert accepted(b"\x01", "S") is True
        assert accepted(b"\x00", "S") is False
        with pytest.raises(PeerError, match="the answer to S is empty"):
            accepted(b"", "S")

    def test_versions(self):
        assert controller_version(FRAMES[1].payload) == (2, 14, 1, 42)
        with pytest.raises(PeerError, match="has 3 bytes, not 16"):
            controller_version(b"\x00\x00\x02")

    def test_texts(self):
        assert text_of(b"\x02hey!") == ("warning", "hey!")
        assert text_of(b"\x09\xff") == ("level 9", "\ufffd")
        assert text_of(b"") == ("level 4", "")

    def test_set_ups(self):
        names = ["timestamp", "sparkle", "robot_mode"]
        answer = set_up_of(b"\x01DOUBLE,NOT_FOUND,INT32", names, "output")
        assert answer == (1, ("DOUBLE", "NOT_FOUND", "INT32"))
        assert not answer.is_complete
        assert known(names, answer.words) == ("timestamp", "robot_mode")
        assert set_up_of(b"\x02DOUBLE", ["timestamp"], "output").is_complete
        assert not set_up_of(b"\x00DOUBLE", ["timestamp"], "output").is_complete

    def test_set_ups_that_do_not_fit(self):
        with pytest.raises(PeerError, match="2 output variables were asked for, and 1 types came back"):
            set_up_of(b"\x01DOUBLE", ["timestamp", "robot_mode"], "output")
        with pytest.raises(PeerError, match="the answer to the input recipe is empty"):
            set_up_of(b"", ["timestamp"], "input")

    def test_all_types(self):
        assert {name: (wire.code, wire.length) for name, wire in TYPES.items()} == peer.SIZES


class TestPackages:
    NAMES = ("timestamp", "actual_joint_positions", "robot_mode", "payload_cog")
    WORDS = ("DOUBLE", "VECTOR6D", "INT32", "VECTOR3D")
    PAYLOAD = b"\x05" + struct.pack(">d6di3d", 1.5, *range(6), -1, 0.1, 0.2, 0.3)

    def test_values(self):
        layout = OutputLayout(5, self.NAMES, self.WORDS, 250.0)
        flat = layout.flat(self.PAYLOAD)
        assert layout.values(flat) == {
            "timestamp": 1.5,
            "actual_joint_positions": (0.0, 1.0, 2.0, 3.0, 4.0, 5.0),
            "robot_mode": -1,
            "payload_cog": (0.1, 0.2, 0.3),
        }
        assert layout.getter("timestamp")(flat) == 1.5
        assert layout.getter("payload_cog")(flat) == (0.1, 0.2, 0.3)

    @pytest.mark.parametrize("payload", [PAYLOAD[:-1], PAYLOAD + b"\x00", b""])
    def test_another_size(self, payload):
        with pytest.raises(PeerError, match="a package of recipe 5 has"):
            OutputLayout(5, self.NAMES, self.WORDS, 250.0).flat(payload)


class TestLosses:
    def test_none(self):
        counter = LossCounter(250.0)
        assert [counter.take(tick * 0.004) for tick in range(2500)] == [0] * 2500
        assert (counter.arrived, counter.lost) == (2500, 0)

    def test_some(self):
        counter = LossCounter(125.0)
        assert [counter.take(time) for time in (10.0, 10.008, 10.024, 10.032, 10.08)] == [0, 0, 1, 0, 5]
        assert counter.lost == 6

    def test_a_restart_loses_nothing(self):
        counter = LossCounter(125.0)
        assert [counter.take(time) for time in (10.0, 0.0, 0.008)] == [0, 0, 0]
        assert (counter.lost, counter.restarts) == (0, 1)
