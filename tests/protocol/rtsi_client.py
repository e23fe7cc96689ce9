"""A small RTSI client of our own, independent of the code under test: it makes messages and reads them."""

from __future__ import annotations

import struct
from collections.abc import Iterable
from typing import Any

SIZES = {
    "BOOL": ("?", 1),
    "UINT8": ("B", 1),
    "UINT16": ("H", 1),
    "UINT32": ("I", 1),
    "UINT64": ("Q", 1),
    "INT32": ("i", 1),
    "DOUBLE": ("d", 1),
    "VECTOR3D": ("d", 3),
    "VECTOR6D": ("d", 6),
    "VECTOR6INT32": ("i", 6),
    "VECTOR6UINT32": ("I", 6),
}

STANDARD_OUTPUTS = [
    "timestamp",
    "payload_mass",
    "payload_cog",
    "script_control_line",
    "target_joint_positions",
    "target_joint_speeds",
    "actual_joint_torques",
    "actual_joint_positions",
    "actual_joint_speeds",
    "actual_joint_current",
    "actual_TCP_pose",
    "actual_TCP_speed",
    "actual_TCP_force",
    "target_TCP_pose",
    "target_TCP_speed",
    "actual_digital_input_bits",
    "actual_digital_output_bits",
    "joint_temperatures",
    "robot_mode",
    "joint_mode",
    "safety_status",
    "speed_scaling",
    "target_speed_fraction",
    "actual_robot_voltage",
    "actual_robot_current",
    "runtime_state",
    "elbow_position",
    "robot_status_bits",
    "safety_status_bits",
    "analog_io_types",
    "standard_analog_input0",
    "standard_analog_input1",
    "standard_analog_output0",
    "standard_analog_output1",
    "io_current",
    "tool_mode",
    "tool_analog_input_types",
    "tool_analog_output_types",
    "tool_analog_input",
    "tool_analog_output",
    "tool_output_voltage",
    "tool_output_current",
    "tool_temperature",
    "tool_digital_mode",
    "tool_digital0_mode",
    "tool_digital1_mode",
    "tool_digital2_mode",
    "tool_digital3_mode",
    "output_bit_registers0_to_31",
    "output_bit_registers32_to_63",
    "input_bit_registers0_to_31",
    "input_bit_registers32_to_63",
]
"""The 52 variables that common clients ask for."""

STANDARD_INPUTS = [
    "speed_slider_mask",
    "speed_slider_fraction",
    "standard_digital_output_mask",
    "standard_digital_output",
    "configurable_digital_output_mask",
    "configurable_digital_output",
    "tool_digital_output_mask",
    "tool_digital_output",
    "standard_analog_output_mask",
    "standard_analog_output_type",
    "standard_analog_output_0",
    "standard_analog_output_1",
    "external_force_torque",
    "input_bit_registers0_to_31",
    "input_bit_registers32_to_63",
]
"""The 15 variables that common clients write."""


def message(letter: str, payload: bytes = b"") -> bytes:
    """One message."""
    return struct.pack(">HB", 3 + len(payload), ord(letter)) + payload


def output_recipe(frequency_hz: float, names: Iterable[str]) -> bytes:
    """The message that sets up an output recipe."""
    return message("O", struct.pack(">d", frequency_hz) + ",".join(names).encode())


def input_recipe(names: Iterable[str]) -> bytes:
    """The message that sets up an input recipe."""
    return message("I", ",".join(names).encode())


def text(words: str, source: str = "test", level: int = 3) -> bytes:
    """A text message of the client."""
    return message("M", bytes([len(words)]) + words.encode() + bytes([len(source)]) + source.encode() + bytes([level]))


def package(ident: int, types: Iterable[str], values: Iterable[Any]) -> bytes:
    """A data package of the client."""
    body = bytes([ident])
    for kind, value in zip(types, values, strict=True):
        code, count = SIZES[kind]
        body += struct.pack(f">{count}{code}", *(value if count > 1 else [value]))
    return message("U", body)


def messages(stream: bytes) -> list[tuple[str, bytes]]:
    """Cut a stream into messages: letter and payload of each."""
    found = []
    while stream:
        size, letter = struct.unpack_from(">HB", stream)
        assert 4 <= size <= len(stream), "a message of the controller is whole and has a payload"
        found.append((chr(letter), stream[3:size]))
        stream = stream[size:]
    return found


def set_up(payload: bytes) -> tuple[int, list[str]]:
    """Number and types in the answer to a set-up."""
    return payload[0], payload[1:].decode().split(",") if len(payload) > 1 else []


def values(payload: bytes, types: Iterable[str]) -> list[Any]:
    """Values of a data package, whose number is skipped."""
    at, found = 1, []
    for kind in types:
        code, count = SIZES[kind]
        parts = struct.unpack_from(f">{count}{code}", payload, at)
        found.append(parts if count > 1 else parts[0])
        at += struct.calcsize(f">{count}{code}")
    assert at == len(payload), "the package is as long as its types say"
    return found
