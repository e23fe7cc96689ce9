"""What the page draws of a controller: the arm of its model with the lengths and limits that the controller says."""

from __future__ import annotations

from math import isfinite
from typing import Any

from elitescript.kernel.arm import named_model
from elitescript.models.model import RobotModel, load_model, model_names
from elitescript.protocol.binary import Number, WireValue
from elitescript.solids.scene import scene


def model_by_number(number: int) -> RobotModel | None:
    """Return the model with this number on the wire; None if there is none here."""
    return next((model for name in model_names() if (model := load_model(name)).type_id == number), None)


def scene_of(
    configuration: dict[str, WireValue] | None, tcp_offset: tuple[float, ...] | None, robot: str
) -> dict[str, Any] | None:
    """Return the message `scene`; None as long as nothing says which arm it is.

    Args:
        configuration: values of that part of the primary port's state.
        tcp_offset: from the flange, as the controller sends it.
        robot: model or model file that was given, for a controller whose number is not known here.

    Raises:
        UsageError: there is no such model.
    """
    number = None if configuration is None else configuration["robot type"]
    model = model_by_number(number) if isinstance(number, int) else None
    if model is None:
        if not robot and configuration is None:
            return None
        model = named_model(robot or "cs66")[0]
    tcp = _numbers(tcp_offset or ()) or (0.0,) * 6
    message = scene(model, tcp=tcp)  # type: ignore[arg-type]
    if configuration is None:
        return message
    if number != model.type_id:
        message["robot"] = robot or f"robot type {number}"
    a, d, alpha = (_numbers(configuration[f"DH {name}"]) for name in ("a", "d", "alpha"))
    if a and d and alpha and any((*a, *d)):
        message["dh"] = [{"a": a[i], "d": d[i], "alpha": alpha[i]} for i in range(6)]
    ranges, highest = _numbers(configuration["joint limits"]), _numbers(configuration["joint maxima"])
    if any(ranges) and any(highest):
        message["limits"] |= {
            "position_min": list(ranges[0::2]),
            "position_max": list(ranges[1::2]),
            "speed": list(highest[0::2]),
            "acceleration": list(highest[1::2]),
        }
    return message


def _numbers(vector: WireValue) -> tuple[Number, ...]:
    """Return the numbers of a vector; none if one of them is not finite."""
    return vector if isinstance(vector, tuple) and all(map(isfinite, vector)) else ()
