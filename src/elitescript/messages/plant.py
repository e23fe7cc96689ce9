"""Settings of the simulated drives: how the joints follow their targets, exactly by default."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Final

from elitescript.errors import UsageError, did_you_mean
from elitescript.records import fields_of, record

LAG_MIN_S: Final = 0.001
"""A shorter lag would end within the control period."""


@record
class PlantConfig:
    """Differences of *actual* from *target*; none by default. All values are *assumed*.

    Args:
        lag_s: tracking lag of every joint. At a constant speed a joint is behind its target by the speed times this; at
            rest it is at its target. Servo drives have some 5 to 30 ms.
        noise_rad: standard deviation of the encoders; speeds are worked out from their positions, so they have it too.
        viscous_friction: share of a joint's rated torque that friction takes at the joint's largest speed.
        coulomb_friction: share of a joint's rated torque that friction takes at any speed.
        rated_acceleration: acceleration that the rated torque gives to a joint, rad/s^2: how far friction drags a
            lagging drive behind.
        seed: of the noise.

    Raises:
        UsageError: a value outside its range; the text names it.
    """

    lag_s: float = 0.0
    noise_rad: float = 0.0
    viscous_friction: float = 0.0
    coulomb_friction: float = 0.0
    rated_acceleration: float = 20.0
    seed: int = 0

    def __post_init__(self) -> None:
        for name, (low, high, unit) in _RANGES.items():
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
                raise UsageError(f"{name} of the plant needs a number, has {value!r}")
            if not low <= value <= high:
                raise UsageError(f"{name} of the plant must be in [{low:g}, {high:g}]{unit}, got {value:g}")
        if 0.0 < self.lag_s < LAG_MIN_S:
            raise UsageError(f"lag_s of the plant must be 0 or at least {LAG_MIN_S:g} s, got {self.lag_s:g}")
        if isinstance(self.seed, bool) or not isinstance(self.seed, int):
            raise UsageError(f"seed of the plant needs a whole number, has {self.seed!r}")

    @classmethod
    def from_table(cls, table: Mapping[str, object]) -> PlantConfig:
        """Return the plant of a `[plant]` section, whose keys are the names above.

        Raises:
            UsageError: an unknown key, or a value that makes no sense; the text begins with `plant`.
        """
        known = list(fields_of(cls))
        for name in table:
            if name not in known:
                near = did_you_mean(name, known)
                raise UsageError(f"plant.{name}: unknown key (known: {', '.join(known)}){near}")
        try:
            return cls(**table)  # type: ignore[arg-type]
        except UsageError as error:
            raise UsageError(f"plant: {error}") from None


_RANGES: Final = {
    "lag_s": (0.0, 1.0, " s"),
    "noise_rad": (0.0, 0.1, " rad"),
    "viscous_friction": (0.0, 1.0, ""),
    "coulomb_friction": (0.0, 1.0, ""),
    "rated_acceleration": (0.1, 1000.0, " rad/s^2"),
}
