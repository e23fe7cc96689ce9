"""Many runs of one program: varied values, disturbances, properties that hold or do not.

>>> from elitescript.sweep import sweep, uniform
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from elitescript.sweep.many_runs import Sweep as Sweep
    from elitescript.sweep.many_runs import sweep as sweep
    from elitescript.sweep.plans.plan import Choices as Choices
    from elitescript.sweep.plans.plan import Failure as Failure
    from elitescript.sweep.plans.plan import Row as Row
    from elitescript.sweep.plans.variations import choice as choice
    from elitescript.sweep.plans.variations import grid as grid
    from elitescript.sweep.plans.variations import normal as normal
    from elitescript.sweep.plans.variations import uniform as uniform

_HOMES = {
    "Sweep": "many_runs",
    "sweep": "many_runs",
    "Choices": "plans.plan",
    "Failure": "plans.plan",
    "Row": "plans.plan",
    "choice": "plans.variations",
    "grid": "plans.variations",
    "normal": "plans.variations",
    "uniform": "plans.variations",
}

__all__ = list(_HOMES)


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'elitescript.sweep' has no attribute {name!r}")
    import importlib

    return getattr(importlib.import_module(f"elitescript.sweep.{_HOMES[name]}"), name)
