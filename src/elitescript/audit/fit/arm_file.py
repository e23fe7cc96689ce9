"""Writes what was found as the file of an own arm, for `--robot`."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from math import ceil, log10
from typing import Any, Final

from elitescript.audit.fit.parameters import DETERMINED, Parameter

PLANT: Final = "plant."
KEYS: Final = {
    **{name: ("arm", name) for name in ("d1", "a2", "a3", "d4", "d5", "d6")},
    **{
        f"default_{part}": ("", f"default_{part}")
        for part in ("joint_speed", "joint_acceleration", "tool_speed", "tool_acceleration")
    },
    "plant.lag_s": ("plant", "lag_s"),
    "plant.noise_rad": ("plant", "noise_rad"),
}
"""Table and key of each parameter that an arm file takes; of a joint's speed limit see `arm_text`."""


def arm_text(base: Mapping[str, Any], parameters: Iterable[Parameter], qd_max: Iterable[float], *, about: str) -> str:
    """Return the text of an arm file.

    Args:
        base: what the file begins with: `{"base": "CS66"}`, or the content of the file of an own arm.
        parameters: those that are determined are written.
        qd_max: speed limits of the model, rad/s, for the joints of which nothing is known.
        about: where the numbers come from, one line.
    """
    document: dict[str, Any] = {
        key: dict(value) if isinstance(value, Mapping) else value for key, value in base.items()
    }
    document["about"], document["evidence"] = about, "observed"
    limits, has_limit = list(qd_max), False
    for parameter in parameters:
        if parameter.state != DETERMINED or parameter.found is None:
            continue
        value = rounded(parameter)
        if parameter.name.startswith("qd_max."):
            limits[int(parameter.name.removeprefix("qd_max.")) - 1] = value
            has_limit = True
        elif parameter.name in KEYS:
            table, key = KEYS[parameter.name]
            target = document.setdefault(table, {}) if table else document
            target[key] = value
            target.pop(f"{key}_deg", None)
    if has_limit:
        joints = document.setdefault("joints", {})
        joints["qd_max"] = limits
        joints.pop("qd_max_deg", None)
    return _toml(document)


def rounded(parameter: Parameter) -> float:
    """Return the found value with one digit more than its interval determines."""
    assert parameter.found is not None
    assert parameter.interval is not None
    half = 0.5 * (parameter.interval[1] - parameter.interval[0])
    digits = 12 if half <= 0.0 else min(12, max(0, ceil(-log10(half)) + 1))
    return round(parameter.found, digits)


def _toml(document: Mapping[str, Any], name: str = "") -> str:
    plain = {key: value for key, value in document.items() if not isinstance(value, Mapping)}
    tables = {key: value for key, value in document.items() if isinstance(value, Mapping)}
    lines = [f"[{name}]"] if name and plain else []
    # JSON writes texts, numbers, true and rows of numbers as TOML does.
    lines.extend(f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in plain.items())
    text = "\n".join(lines) + ("\n" if lines else "")
    parts = [_toml(table, f"{name}.{key}" if name else key) for key, table in tables.items()]
    return "\n".join(part for part in (text, *parts) if part)
