"""The catalogue, complete: importing this module registers every command of every family."""

from __future__ import annotations

from typing import Final

from elitescript.commands import (  # noqa: F401  (importing a family registers its commands)
    analog_io,
    conveyor,
    digital_io,
    force,
    freedrive,
    input_actions,
    kinematics,
    lists,
    maths,
    messages,
    micro_line,
    modbus_port,
    modbus_rtu,
    modbus_tcp,
    motion,
    observed,
    path_offset,
    payload,
    poses,
    positions,
    registers,
    rpc,
    runstate,
    safety,
    serial,
    servo,
    sockets,
    speed,
    strings,
    system,
    task,
    threads,
    tool_io,
)
from elitescript.commands.definition.registry import REGISTRY, Catalogue

CATALOGUE: Final[Catalogue] = REGISTRY
