"""A small client of the primary port, written from the description of the wire: it shares nothing with the server."""

from __future__ import annotations

import struct


class Reader:
    """Takes big-endian values one after the other."""

    def __init__(self, data: bytes, at: int = 0) -> None:
        self.data = data
        self.at = at

    def take(self, layout: str):
        values = struct.unpack_from(">" + layout, self.data, self.at)
        self.at += struct.calcsize(">" + layout)
        return values[0] if len(values) == 1 else values

    def rest(self) -> bytes:
        data, self.at = self.data[self.at :], len(self.data)
        return data

    def text(self) -> str:
        """The rest as clients take it that drop the last byte."""
        return self.rest()[:-1].decode("utf-8")


def messages(stream: bytes) -> list[tuple[int, bytes]]:
    """Split a stream into (type, whole message); it has to end with one."""
    found = []
    while stream:
        length, kind = struct.unpack_from(">IB", stream)
        assert 5 < length <= len(stream), f"length {length} of {len(stream)} bytes"
        found.append((kind, stream[:length]))
        stream = stream[length:]
    return found


def sub_messages(message: bytes) -> list[tuple[int, bytes]]:
    """Split a robot state into (type, whole sub-message) in their order."""
    assert message[4] == 16
    return messages(message[5:])


def robot_mode(data: bytes) -> dict:
    names = "timestamp _ _ powered emergency protective running paused mode control slider scaling limit speed_mode"
    values = struct.unpack_from(">Q???????BBdddB", data, 5)
    return dict(zip(names.split(), values, strict=True)) | {"package": data[48]}


def joints(data: bytes) -> list[dict]:
    names = (
        "q_actual q_target qd pulses_target pulses_actual pulses_zero current voltage temperature torque mode reserved"
    )
    found = []
    for joint in range(6):
        values = struct.unpack_from(">dddiiiffffBI", data, 5 + 57 * joint)
        found.append(dict(zip(names.split(), values, strict=True)))
    return found


def cartesian(data: bytes) -> tuple[tuple[float, ...], tuple[float, ...]]:
    return struct.unpack_from(">6d", data, 5), struct.unpack_from(">6d", data, 53)


def configuration(data: bytes) -> dict:
    return {
        "limits": [struct.unpack_from(">dd", data, 5 + 16 * joint) for joint in range(6)],
        "maxima": [struct.unpack_from(">dd", data, 101 + 16 * joint) for joint in range(6)],
        "defaults": struct.unpack_from(">4d", data, 197),
        "radius": struct.unpack_from(">d", data, 229)[0],
        "a": struct.unpack_from(">6d", data, 237),
        "d": struct.unpack_from(">6d", data, 285),
        "alpha": struct.unpack_from(">6d", data, 333),
        "reserved": struct.unpack_from(">6d", data, 381),
        "versions": struct.unpack_from(">4I", data, 429),
    }


def master_board(data: bytes) -> dict:
    return {
        "inputs": struct.unpack_from(">I", data, 5)[0],
        "outputs": struct.unpack_from(">I", data, 9)[0],
        "input_domains": tuple(data[13:16]),
        "analog_in": struct.unpack_from(">3d", data, 16),
        "output_domains": tuple(data[40:43]),
        "analog_out": struct.unpack_from(">3d", data, 43),
        "board": struct.unpack_from(">4f", data, 67),
        "safety": data[83],
        "reduced": data[84],
        "rest": data[85:],
    }


def tool(data: bytes) -> tuple:
    return struct.unpack_from(">BBddfBffB", data, 5)


def safety(data: bytes) -> tuple:
    return struct.unpack_from(">IbB4d", data, 5)


def tool_communication(data: bytes) -> tuple:
    return struct.unpack_from(">?III?Bff", data, 5)


def robot_message(message: bytes) -> dict:
    """Decode a message of type 20 as far as its kind is known."""
    reader = Reader(message)
    length, kind, timestamp, source, number = reader.take("IBQBB")
    assert (length, kind) == (len(message), 20)
    found = {"timestamp": timestamp, "source": source, "kind": number}
    if number == 0:
        found["text"] = reader.text()
    elif number == 2:
        found["flags"] = reader.take("IB???")
        found["title"] = _counted(reader)
        found["text"] = reader.text()
    elif number == 3:
        found["title"] = _counted(reader)
        found["version"] = reader.take("BBii")
        found["text"] = reader.text()
    elif number == 6:
        found["code"], found["sub_code"], found["level"], found["data_type"] = reader.take("iiiI")
        assert reader.at == 31
        found["text"] = reader.text()
    elif number == 7:
        found["code"], found["argument"] = reader.take("ii")
        found["title"] = _counted(reader)
        found["text"] = reader.text()
    elif number == 10:
        found["line"], found["column"] = reader.take("ii")
        assert reader.at == 23
        found["text"] = reader.text()
    else:
        raise AssertionError(f"kind {number}")
    return found


def _counted(reader: Reader) -> str:
    length = reader.take("B")
    text = reader.data[reader.at : reader.at + length]
    assert len(text) == length
    reader.at += length
    return text.decode("utf-8")
