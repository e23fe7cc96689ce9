"""Many runs of one program: varied values, disturbances, properties that hold or do not.

>>> from elitescript.sweep import sweep, uniform
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from elitescript.sweep.many_runs import Sweep as Sweep
    from elitescript.sweep.many_runs import sweep as sweep
    from elitescript.sweep.plan import Choices as Choices
    from elitescript.sweep.plan import Failure as Failure
    from elitescript.sweep.plan import Row as Row
    from elitescript.sweep.variations import choice as choice
    from elitescript.sweep.variations import grid as grid
    from elitescript.sweep.variations import normal as normal
    from elitescript.sweep.variations import uniform as uniform

_HOMES = {
    "Sweep": "many_runs",
    "sweep": "many_runs",
    "Choices": "plan",
    "Failure": "plan",
    "Row": "plan",
    "choice": "variations",
    "grid": "variations",
    "normal": "variations",
    "uniform": "variations",
}

__all__ = list(_HOMES)


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'elitescript.sweep' has no attribute {name!r}")
    import importlib

    return getattr(importlib.import_module(f"elitescript.sweep.{_HOMES[name]}"), name)
