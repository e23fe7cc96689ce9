"""EliteScript without the robot: the language, the arm and the controller of the Elite Robots CS series.

The public names are loaded on first use, so that a tool that needs one of them does not pay
for the others.
"""

from __future__ import annotations

# What type checkers look for; importing `typing` for it would cost every start some milliseconds.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from elitescript.errors import AlarmError as AlarmError
    from elitescript.errors import ElitescriptError as ElitescriptError
    from elitescript.errors import ProgramError as ProgramError
    from elitescript.errors import UsageError as UsageError
    from elitescript.messages.plant import PlantConfig as PlantConfig
    from elitescript.robot import VirtualRobot as VirtualRobot
    from elitescript.run import Run as Run

__version__ = "0.1.0"

_HOMES = {
    "VirtualRobot": "elitescript.robot",
    "Run": "elitescript.run",
    "PlantConfig": "elitescript.messages.plant",
    "AlarmError": "elitescript.errors",
    "ElitescriptError": "elitescript.errors",
    "ProgramError": "elitescript.errors",
    "UsageError": "elitescript.errors",
}

__all__ = [*_HOMES, "__version__"]


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'elitescript' has no attribute {name!r}")
    import importlib

    return getattr(importlib.import_module(_HOMES[name]), name)
