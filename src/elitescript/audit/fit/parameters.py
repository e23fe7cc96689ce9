"""What a fit says of one parameter: the model's value, the found one with its interval, or why there is none."""

from __future__ import annotations

from typing import Any, Final

from elitescript.records import record

DETERMINED: Final = "determined"
AT_LEAST: Final = "at least"
NOT_DETERMINED: Final = "not determined"
CONFIDENCE: Final = 0.95
"""Share of intervals that hold the true value."""
RELEVANT: Final = 1e-6
"""Difference from the model, in SI units, below which a parameter is the model's however well it is known."""


@record
class Parameter:
    """One parameter, in its SI unit.

    Attributes:
        name: as in arm files and world files: `d6`, `default_joint_speed`, `plant.lag_s`.
        unit: SI.
        model: value of the model that it is compared with; None if the model has none.
        found: estimate; None if the data determines none. Of `at least` the largest value that was seen.
        interval: holds the true value in 95 of 100 cases; None unless `state` is `determined`.
        state: `determined`, `at least` or `not determined`.
        why: what it comes from, or why it is not determined.
    """

    name: str
    unit: str
    model: float | None
    found: float | None
    interval: tuple[float, float] | None
    state: str
    why: str

    @property
    def differs(self) -> bool:
        """Whether the data contradicts the model's value, by more than `RELEVANT`."""
        if self.model is None or self.found is None:
            return False
        if self.interval is None:
            return self.found > self.model + RELEVANT
        low, high = self.interval
        return not low <= self.model <= high and abs(self.found - self.model) > RELEVANT

    def json(self) -> dict[str, Any]:
        """Return the parameter as JSON has it."""
        return {
            "model": self.model,
            "found": self.found,
            "interval": None if self.interval is None else list(self.interval),
            "unit": self.unit,
            "state": self.state,
            "why": self.why,
        }


def determined(name: str, unit: str, model: float | None, found: float, half_width: float, why: str) -> Parameter:
    """Return a parameter with a symmetric interval."""
    return Parameter(name, unit, model, found, (found - half_width, found + half_width), DETERMINED, why)


def not_determined(name: str, unit: str, model: float | None, why: str) -> Parameter:
    """Return a parameter that the data says nothing of."""
    return Parameter(name, unit, model, None, None, NOT_DETERMINED, why)
