"""What a change of a signal is put down to, by the origin of the input that asks for it."""

from __future__ import annotations

from typing import Final

WORLD: Final = "world"
"""Origin of what the devices beside a robot do to its signals, followed by `:` and what does it."""

RESTART: Final = "restart"
"""Origin of the inputs that give a fresh robot the state of the one before it."""

_BESIDE: Final = {f"{WORLD}:{by}": by for by in ("device", "wire", "schedule", "fault")}


def cause_of(origin: str) -> str:
    """`SignalChanged.by` for an input: what the origin says of a world, else `client`."""
    if origin == RESTART:
        return "schedule"
    return _BESIDE.get(origin, "client")
