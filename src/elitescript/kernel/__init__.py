"""One robot as a function: inputs of a tick in, its output out.

The names are loaded on first use: the options alone are needed where no robot is made.
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from elitescript.kernel.kernel import Kernel as Kernel
    from elitescript.kernel.options import RobotOptions as RobotOptions

_HOMES = {"Kernel": "elitescript.kernel.kernel", "RobotOptions": "elitescript.kernel.options"}

__all__ = ["Kernel", "RobotOptions"]


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    import importlib

    return getattr(importlib.import_module(_HOMES[name]), name)
