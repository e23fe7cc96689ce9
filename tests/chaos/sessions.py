"""Random sessions of one robot: a program, devices with faults, people, and clients of ports, drawn from a seed.

A session is a list of acts, each at a tick, so that it can be made shorter and played again. It is JSON-able.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from random import Random
from typing import Any

from elitescript.protocol.dashboard.verbs import VERBS
from tests.chaos import rare
from tests.debugger import random_programs as threads_programs
from tests.invariants.random_devices import random_secondary, random_talk
from tests.invariants.random_programs import random_program
from tests.protocol import modbus_client, rtsi_client

RARE_SHARE = 0.06
"""Of the sessions: journals and debuggers, which take long."""

TICKS = 1000
"""Ticks in which something is done; the program goes on a little longer."""

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

Act = list[Any]
"""Tick, name, arguments."""

Session = dict[str, Any]
"""`seed`, `kind`, `program`, `options`, `acts`."""

PROGRAMS: dict[str, Callable[[Random], str]] = {
    "moves": random_program,
    "threads": threads_programs.random_program,
    "talk": lambda chance: random_talk(chance)[0],
}


def drawn(seed: int) -> Session:
    """Return the session of a seed."""
    chance = Random(f"session {seed}")
    kinds = Random(f"kind {seed}")
    if kinds.random() < RARE_SHARE:
        return rare.drawn(seed, kinds.choice(list(rare.KINDS)))
    kind = chance.choice(("moves", "moves", "threads", "talk"))
    acts: list[Act] = []
    # Each session has some kinds of acts and not the others, so that rare combinations occur.
    kinds = [name for name in ACTS if chance.random() < 0.45]
    for _ in range(chance.randrange(1, 25) if kinds else 0):
        name = chance.choice(kinds)
        acts += ACTS[name](chance, chance.randrange(TICKS))
    if kind == "talk":
        acts += [[chance.randrange(TICKS), "device fault", chance.randrange(10**6)] for _ in range(chance.randrange(4))]
    return {
        "seed": seed,
        "kind": kind,
        "program": PROGRAMS[kind](chance),
        "options": _options(chance),
        "acts": sorted(acts, key=lambda act: act[0]),
    }


def _options(chance: Random) -> dict[str, Any]:
    options: dict[str, Any] = {"seed": chance.randrange(1000)}
    if chance.random() < 0.4:
        options["model"] = chance.choice(("CS63", "CS612", "CS620"))
    if chance.random() < 0.3:
        options["firmware"] = chance.choice(("2.10", "2.14"))
    if chance.random() < 0.3:
        options["work_per_tick"] = chance.choice((150, 1000))
    if chance.random() < 0.2:
        options["lag_s"] = chance.choice((0.01, 0.04))
    elif chance.random() < 0.1:
        options["noise_rad"] = 1e-5
    if chance.random() < 0.1:
        options["power_on"] = False
    return options


# ---------------------------------------------------------------- people and signals


def _pause(chance: Random, tick: int) -> list[Act]:
    return [[tick, "pause"], [tick + chance.choice((0, 1, 2, 10, 150)), "resume"]]


def _stop(chance: Random, tick: int) -> list[Act]:
    return [[tick, "stop"]] if chance.random() < 0.3 else []


def _slider(chance: Random, tick: int) -> list[Act]:
    return [[tick, "slider", chance.choice((0.0, 0.01, 0.3, 0.63, 1.0))], [tick + chance.randrange(300), "slider", 1.0]]


def _signal(chance: Random, tick: int) -> list[Act]:
    family, size = chance.choice((("standard_digital_in", 4), ("configurable_digital_in", 8), ("tool_digital_in", 4)))
    acts: list[Act] = [[tick, "signal", f"{family}[{chance.randrange(size)}]", chance.random() < 0.7]]
    if chance.random() < 0.5:
        acts.append([tick + chance.randrange(1, 50), "signal", acts[0][2], not acts[0][3]])
    return acts


def _number(chance: Random, tick: int) -> list[Act]:
    index = chance.randrange(6)
    return [
        chance.choice(
            (
                [tick, "signal", "standard_analog_in[0]", round(chance.uniform(0.0, 10.0), 2)],
                [tick, "signal", f"input_int_register[{index}]", chance.randrange(-5, 5)],
                [tick, "signal", f"external_wrench[{index}]", round(chance.uniform(-20.0, 20.0), 1)],
            )
        )
    ]


def _safety(chance: Random, tick: int) -> list[Act]:
    name = chance.choice(
        ("safeguard_stop", "safeguard_stop", "reduced_mode", "emergency_stop", "system_emergency_stop")
    )
    return [[tick, "signal", name, True], [tick + chance.choice((1, 2, 30, 300)), "signal", name, False]]


def _protective(chance: Random, tick: int) -> list[Act]:
    return [[tick, "protective stop"], [tick + chance.choice((10, 1250, 1300)), "unlock"]]


def _restart(chance: Random, tick: int) -> list[Act]:
    return [[tick, "restart safety"]] if chance.random() < 0.5 else []


def _secondary(chance: Random, tick: int) -> list[Act]:
    text = chance.choice(
        (
            "sec s():\n  set_standard_digital_out(3, True)\nend\n",
            "sec s():\n  textmsg(get_target_joint_positions())\nend\n",
            "sec s():\n  raise ValueError(1)\nend\n",
            "sec s():\n  global count\n  count = -1\nend\n",
            "sec s():\n  movej([0, 0, 0, 0, 0, 0])\nend\n",
            random_secondary(chance),
        )
    )
    return [[tick, "secondary", text]]


# ---------------------------------------------------------------- clients


def _client(chance: Random, tick: int) -> list[Act]:
    """A client that connects, says some of what makes sense and some of what does not, and may leave."""
    port = chance.choice(PORTS)
    number = chance.randrange(10**6)
    acts: list[Act] = [[tick, "connect", number, port]]
    if port == "rtsi" and chance.random() < 0.8:
        for data in _rtsi_beginning(chance):
            tick += chance.choice((0, 1, 1, 3))
            acts.append([tick, "send", number, data.hex()])
    for _ in range(chance.randrange(6)):
        tick += chance.choice((0, 1, 1, 5, 60))
        data = SAYINGS.get(port, _nothing)(chance)
        acts += [[tick, "send", number, part.hex()] for part in _spoilt(chance, data)]
    if chance.random() < 0.4:
        acts.append([tick + chance.randrange(100), "close", number])
    return acts


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
    return [chance.randbytes(chance.randrange(1, 300))]


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
            random_program(chance),
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
        )
    )
    return text.encode() + b"\n"


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

ACTS: dict[str, Callable[[Random, int], list[Act]]] = {
    "pause": _pause,
    "stop": _stop,
    "slider": _slider,
    "signal": _signal,
    "number": _number,
    "safety": _safety,
    "protective": _protective,
    "restart": _restart,
    "secondary": _secondary,
    "client": _client,
    "more clients": _client,
}
