"""Tables of parameters for people."""

from __future__ import annotations

from collections.abc import Iterable
from math import floor, log10

from elitescript.audit.fit.parameters import DETERMINED, Parameter

HEAD = ("parameter", "model", "found", "95 % interval", "")


def table(parameters: Iterable[Parameter]) -> list[str]:
    """Return the lines of a table: name, value of the model, found value, interval, and why there is none."""
    rows = [HEAD, *map(_row, parameters)]
    widths = [max(len(row[column]) for row in rows) for column in range(4)]
    return [
        "  ".join((*(cell.ljust(width) for cell, width in zip(row, widths, strict=False)), row[4])).rstrip()
        for row in rows
    ]


def _row(parameter: Parameter) -> tuple[str, str, str, str, str]:
    model = "" if parameter.model is None else f"{parameter.model:.9g} {parameter.unit}"
    if parameter.found is None:
        return parameter.name, model, "", "", f"{parameter.state}: {parameter.why}"
    if parameter.state != DETERMINED or parameter.interval is None:
        return parameter.name, model, f"at least {parameter.found:.6g} {parameter.unit}", "", parameter.why
    half = 0.5 * (parameter.interval[1] - parameter.interval[0])
    digits = 12 if half <= 0.0 else min(12, max(0, 1 - floor(log10(half))))
    found = f"{round(parameter.found, digits) + 0.0:.{digits}f} {parameter.unit}"
    mark = "differs" if parameter.differs else ""
    return parameter.name, model, found, f"± {half:.2g}", mark
