"""Clients of random sessions: what they say, whole, in pieces, cut off, spoilt, or as nobody should say it."""

from __future__ import annotations

import struct
from collections.abc import Callable
from random import Random
from typing import Any

from elitescript.protocol.dashboard.verbs import VERBS
from tests.chaos.programs import PROGRAMS
from tests.kernel.test_interpreter_interleavings import COMMON, RARE
from tests.protocol import modbus_client, rtsi_client

PORTS = (
    "primary",
    "primary",
    "secondary",
    "readonly",
    "dashboard",
    "dashboard",
    "rtsi",
    "rtsi",
    "interpreter",
    "query",
    "modbus",
)


def random_client(chance: Random, tick: int, port: str = "") -> list[list[Any]]:
    """Return the acts of a client: it connects, says what makes sense and what does not, and may leave."""
    port = port or chance.choice(PORTS)
    number = chance.randrange(10**6)
    acts: list[list[Any]] = [[tick, "connect", number, port]]
    if port == "rtsi" and chance.random() < 0.8:
        for data in _rtsi_beginning(chance):
            tick += chance.choice((0, 1, 1, 3))
            acts.append([tick, "send", number, data.hex()])
    for _ in range(chance.randrange(6)):
        tick += chance.choice((0, 1, 1, 5, 60))
        data = SAYINGS.get(port, _nothing)(chance)
        for part in _spoilt(chance, data):
            acts.append([tick, "send", number, part.hex()])
            tick += chance.choice((0, 1))
    if chance.random() < 0.4:
        acts.append([tick + chance.randrange(100), "close", number])
    return acts


HOSTILE = (
    bytes(3000),
    b"\xff" * 3000,
    b"a" * 70_000,
    b"\n" * 2000,
    b"(" * 3000 + b"\n",
    b"textmsg(" + b"[" * 150 + b"]" * 150 + b")\n",
    b"def f():\n" + b"  x = 1\n" * 3000,
    b"def f():\n" * 200,
    b"x = " + b"9" * 5000 + b"\n",
    b"\xef\xbb\xbfdef f():\r\n\ttextmsg(1)\r\nend\r\n",
    b"\x00\x00S",
    b"\x00\x03",
    b"\xff\xffO" + bytes(100),
    struct.pack(">HBd", 13, ord("O"), float("nan")) + b"q,",
    struct.pack(">HHHB", 1, 0, 0xFFFF, 1),
    struct.pack(">HHHB", 1, 7, 2, 1),
    struct.pack(">HHHBBHH", 1, 0, 6, 1, 3, 65535, 125) * 50,
)
"""What no client should say, of any port; not `9 ** 9 ** 9`, which never ends in one operation, as documented."""


def _spoilt(chance: Random, data: bytes) -> list[bytes]:
    """Return bytes as they come: whole, in pieces, cut off, changed, or something else."""
    form = chance.random()
    if form < 0.6 or not data:
        return [data]
    if form < 0.75:
        at = chance.randrange(len(data) + 1)
        return [data[:at], data[at:]]
    if form < 0.85:
        return [data[: chance.randrange(len(data))]]
    if form < 0.95:
        changed = bytearray(data)
        for _ in range(chance.randrange(1, 4)):
            changed[chance.randrange(len(changed))] = chance.randrange(256)
        return [bytes(changed)]
    if form < 0.98:
        return [chance.randbytes(chance.randrange(1, 300))]
    return [chance.choice(HOSTILE)]


def _script(chance: Random) -> bytes:
    text = chance.choice(
        (
            'def other():\n  textmsg("other")\n  sleep(0.05)\nend\n',
            "def other():\n  while True:\n    sync()\n  end\nend\n",
            "sec s():\n  set_standard_digital_out(4, True)\nend\n",
            "set_standard_digital_out(5, True)\n",
            "stop\n",
            "def broken(:\n  1abc\nend\n",
            "movej([0.1, -1.5, -1.5, -1.5, 1.5, 0], a=1, v=1)\n",
            "stopj(2)\n",
            "def nothing\n",
            PROGRAMS[chance.choice(("moves", "threads", "raises", "presses", "language"))](chance),
        )
    )
    return text.encode()


_ARGUMENTS = ("-s", "-m", "-on", "-off", "-p", "-r", "-a", "50", "x.task", "safeguard", "", "-e", "\xe9")


def _dashboard(chance: Random) -> bytes:
    verb = (
        chance.choice(list(VERBS))
        if chance.random() < 0.5
        else chance.choice(
            (
                "robotMode",
                "status",
                "play",
                "pause",
                "stop",
                "robotControl -on",
                "robotControl -off",
                "brakeRelease",
                "speed -v 30",
                "speed -v 100",
                "unlockProtectiveStop",
                "safety -s",
                "help",
                "closeSafetyDialog",
            )
        )
    )
    arguments = [chance.choice(_ARGUMENTS) for _ in range(chance.randrange(3))] if chance.random() < 0.4 else []
    # A controller that restarts ends every connection, which is a session of its own.
    words = " ".join([verb, *arguments])
    return (("echo" if verb in ("reboot", "shutdown") else words) + chance.choice(("\n", "\n", "\r\n", ""))).encode()


def _rtsi_beginning(chance: Random) -> list[bytes]:
    names = chance.sample(rtsi_client.STANDARD_OUTPUTS, chance.randrange(1, 8))
    rate = chance.choice((250.0, 125.0, 10.0, 0.0, 1000.0))
    found = [rtsi_client.message("V", b"\0\1"), rtsi_client.output_recipe(rate, names), rtsi_client.message("S")]
    if chance.random() < 0.4:
        found.insert(2, rtsi_client.input_recipe(chance.sample(rtsi_client.STANDARD_INPUTS, 2)))
    return found


def _rtsi(chance: Random) -> bytes:
    return chance.choice(
        (
            rtsi_client.message("v"),
            rtsi_client.message("S"),
            rtsi_client.message("P"),
            rtsi_client.text("hello"),
            rtsi_client.output_recipe(chance.choice((0.0, 1.0, 60.0)), ["timestamp", "no_such"]),
            rtsi_client.input_recipe(["standard_digital_output_mask", "standard_digital_output"]),
            rtsi_client.message("U", bytes([1]) + chance.randbytes(chance.randrange(20))),
            rtsi_client.message("I", chance.randbytes(chance.randrange(30))),
        )
    )


def _interpreter(chance: Random) -> bytes:
    text = chance.choice(
        (
            "x = 1",
            "sleep(0.1)",
            "clear_interpreter()",
            "abort",
            "skipbuffer",
            "state_movement_is_blocked",
            "set_standard_digital_out(1, True)",
            "1 +",
            "undefined_name",
            "movej([0, -1.5, -1.5, -1.5, 1.5, 0])",
            "end_interpreter()",
            *COMMON,
            *RARE,
        )
    ).format(n=chance.randrange(1000))
    return text.encode("utf-8", "surrogateescape") + b"\n"


def _query(chance: Random) -> bytes:
    return chance.choice((b"get_actual_joint_positions()\n", b"get_target_tcp_pose()\n", b"nothing()\n", b"1\n"))


def _modbus(chance: Random) -> bytes:
    pdu = chance.choice(
        (
            modbus_client.read(chance.choice((1, 2, 3, 4)), chance.randrange(500), chance.randrange(1, 130)),
            modbus_client.write(6, chance.randrange(100, 300), chance.randrange(65536)),
            modbus_client.write(5, chance.randrange(130), chance.choice((0, 0xFF00, 1))),
            modbus_client.write_registers(chance.randrange(120, 300), [1, 2, 3]),
            struct.pack(">BHH", chance.randrange(256), chance.randrange(65536), chance.randrange(65536)),
        )
    )
    return modbus_client.frame(chance.randrange(65536), pdu)


def _nothing(chance: Random) -> bytes:
    return chance.randbytes(chance.randrange(30))


SAYINGS: dict[str, Callable[[Random], bytes]] = {
    "primary": _script,
    "secondary": _script,
    "dashboard": _dashboard,
    "rtsi": _rtsi,
    "interpreter": _interpreter,
    "query": _query,
    "modbus": _modbus,
}
