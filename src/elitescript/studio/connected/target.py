"""Which controller: its address, its ports, and the `ctl` socket of a robot that is served on this computer."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Final

from elitescript.records import field, record
from elitescript.services.port_numbers import port_numbers

JOG_REGISTER: Final = 40
"""First of two integer and six float input registers that jogging writes; free, *assumed*."""


@record
class Target:
    """What the studio connects to."""

    host: str
    ports: Mapping[str, int] = field(default_factory=lambda: port_numbers(0, {}))
    """Numbers by the name of the service: `rtsi`, `primary`, `dashboard`."""
    robot: str = ""
    """Model to show if the controller does not say it; empty: the controller's word alone."""
    may_control: bool = False
    """Whether commands may be sent at all; without it, nothing that changes anything leaves this computer."""
    control_socket: Path | None = None
    """Of `ctl`, if the robot is served on this computer."""
    programs: tuple[str, ...] = ()
    """Names of programs that can be loaded, as far as they are known."""
    jog_register: int = JOG_REGISTER
