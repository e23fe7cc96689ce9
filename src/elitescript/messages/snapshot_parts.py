"""Parts of a snapshot: groups of fields that are computed only where something reads them.

A set of parts is the sum of their bits. What is in no part is the *discrete state*: levels, modes, tool, payload, task.
It is up to date in the snapshot of every output, a part only where it was asked for; see `messages.outputs.Output.has`.
"""

from __future__ import annotations

from typing import Final

TIME: Final = 1 << 0
"""In every snapshot: tick and time, `is_moving`, line and node of the program, `speed_scaling`."""
JOINTS: Final = 1 << 1
"""Positions and speeds of the joints, as commanded and as measured."""
POSES: Final = 1 << 2
"""Poses of TCP and flange, as commanded and as measured."""
TCP_SPEEDS: Final = 1 << 3
"""Velocities of the TCP, as commanded and as measured."""
LOADS: Final = 1 << 4
"""Torques and currents of the joints, and `robot_current`."""
WRENCHES: Final = 1 << 5
"""`tcp_force` and `raw_wrench`."""
ELBOW: Final = 1 << 6
"""Position and velocity of the elbow."""
TEMPERATURES: Final = 1 << 7
"""Temperatures of joints, control box and tool."""
ALL_PARTS: Final = (1 << 8) - 1
"""All of them."""
