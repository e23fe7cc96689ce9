"""Random sessions of one robot: a program, devices with faults, people, and clients of ports, drawn from a seed.

A session is a list of acts, each at a tick, so that it can be made shorter and played again. It is JSON-able.
"""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import Any

from elitescript.messages.timing import seconds
from tests.chaos import rare
from tests.chaos.clients import random_client
from tests.chaos.programs import PROGRAMS, SHARES
from tests.chaos.scenes import random_options
from tests.faults.test_inputs import random_settings
from tests.invariants.random_devices import random_secondary

RARE_SHARE = 0.06
"""Of the sessions: journals and debuggers, which take long."""

WAYS = {"leaps": 0.1, "pieces": 0.6, "steps": 0.3}
"""How time goes when a session is played again, and in which share of the sessions: as far as nothing is due; so too,
but cut at random ticks; tick by tick."""

TICKS = 1000
"""Ticks in which something is done; the program goes on a little longer."""

Act = list[Any]
"""Tick, name, arguments."""

Session = dict[str, Any]
"""`seed`, `kind`, `way`, `program`, `options`, `acts`."""


def drawn(seed: int) -> Session:
    """Return the session of a seed."""
    chance = Random(f"session {seed}")
    kinds = Random(f"kind {seed}")
    if kinds.random() < RARE_SHARE:
        return rare.drawn(seed, kinds.choice(list(rare.KINDS)))
    kind = chance.choices(list(PROGRAMS), [SHARES.get(name, 1) for name in PROGRAMS])[0]
    acts: list[Act] = []
    # Each session has some kinds of acts and not the others, so that rare combinations occur.
    kinds = [name for name in ACTS if chance.random() < 0.45]
    for _ in range(chance.randrange(1, 25) if kinds else 0):
        name = chance.choice(kinds)
        acts += ACTS[name](chance, chance.randrange(TICKS))
    if kind in ALWAYS:
        acts += ALWAYS[kind](chance, chance.randrange(TICKS // 2)) + ALWAYS[kind](chance, chance.randrange(TICKS // 2))
    if kind == "talk":
        acts += [[chance.randrange(TICKS), "device fault", chance.randrange(10**6)] for _ in range(chance.randrange(4))]
    options = random_options(chance, kind)
    way = chance.choices(list(WAYS), list(WAYS.values()))[0]
    return {
        "seed": seed,
        "kind": kind,
        # How deep contacts are found to be depends on the stretches, within a tolerance; they are compared otherwise.
        "way": "leaps" if "things" in options else way,
        "program": PROGRAMS[kind](chance),
        "options": options,
        "acts": sorted(acts, key=lambda act: act[0]),
    }


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


def _belt(chance: Random, tick: int) -> list[Act]:
    return [[tick, "signal", f"encoder_speed[{chance.randrange(2)}]", round(chance.uniform(-250.0, 250.0), 1)]]


def _schedule(chance: Random, tick: int) -> list[Act]:
    at_s = seconds(tick + chance.randrange(200))
    return [[tick, "schedule", at_s, f"standard_digital_in[{chance.randrange(4)}]", chance.random() < 0.7]]


def _input_fault(chance: Random, tick: int) -> list[Act]:
    """A fault of an input, and changes at it."""
    name, settings = random_settings(chance, chance.randrange(100))
    for key in ("at_s", "for_s"):
        settings.pop(key, None)
    if chance.random() < 0.7:
        settings["for_s"] = chance.choice((0.004, 0.1, 0.3, 2.0))
    acts: list[Act] = [[tick, "input fault", settings.pop("kind"), name, settings]]
    for _ in range(chance.randrange(4)):
        level: Any = chance.random() < 0.5 if "digital" in name else round(chance.uniform(0.0, 10.0), 2)
        acts.append([tick + chance.randrange(150), "signal", name, level])
    if chance.random() < 0.2:
        acts.append([tick + chance.randrange(150), "end faults"])
    return acts


def _another(chance: Random, tick: int) -> list[Act]:
    """Another program, which is refused while one runs."""
    acts: list[Act] = [[tick, "stop"], [tick + 1, "start", ""]] if chance.random() < 0.5 else [[tick, "start", ""]]
    acts[-1][2] = PROGRAMS[chance.choice(("moves", "threads", "presses", "raises"))](chance)
    return acts


def _lines(chance: Random, tick: int) -> list[Act]:
    """A client whose lines are interpreted."""
    return random_client(chance, tick, "interpreter")


def _client(chance: Random, tick: int) -> list[Act]:
    return random_client(chance, tick)


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
    "belt": _belt,
    "schedule": _schedule,
    "input fault": _input_fault,
    "another program": _another,
}

ALWAYS: dict[str, Callable[[Random, int], list[Act]]] = {"interpreted": _lines, "belts": _belt}
"""Acts that belong to a kind of sessions: two of them are in each."""
