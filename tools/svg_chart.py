"""Charts over time as SVG texts: panels one above the other with one time axis.

Written by hand, so that the figures of the documents need no package and come out the same everywhere. Curves are
thinned as those of the page of `plot` are; coordinates have one decimal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from math import ceil, floor, log10
from typing import Final

from elitescript.plotting.decimation import decimated

WIDTH: Final = 760
"""px, like all sizes here."""

_LEFT: Final = 64
_RIGHT: Final = 16
_TOP: Final = 34
_KEY: Final = 22
"""Height of the key above a panel."""
_GAP: Final = 14
_BOTTOM: Final = 40
_LETTER: Final = 6.8
"""Mean width of a letter of the key."""

_POINTS_MAX: Final = 800
_RESOLUTION: Final = 1500.0
"""A curve is true to its range divided by this."""

_COLOURS: Final = ("#1f6fd6", "#d9580d", "#1d8f4e", "#a12fb8", "#8a6d00", "#0a93a5")
_INK, _SOFT, _FRAME, _GRID, _LIMIT = "#1b1f24", "#5d6672", "#b9c0c9", "#e3e7ec", "#d6232f"


@dataclass(frozen=True, slots=True)
class Curve:
    """One quantity over time.

    Args:
        label: what the key says.
        times: s, strictly increasing.
        values: one for each time.
        colour: index of the colour.
        is_dashed: drawn dashed, as what was asked for is.
    """

    label: str
    times: Sequence[float]
    values: Sequence[float]
    colour: int = 0
    is_dashed: bool = False


@dataclass(frozen=True, slots=True)
class Panel:
    """Curves with one scale.

    Args:
        label: quantity and unit.
        curves: in the order of the key.
        levels: heights drawn as red dashes.
        height: px.
        level: what the key calls these heights.
    """

    label: str
    curves: tuple[Curve, ...]
    levels: tuple[float, ...] = ()
    height: int = 150
    level: str = "limit"


def drawing(title: str, panels: Sequence[Panel], time_label: str = "time, s") -> str:
    """Return the text of an SVG file."""
    begin = min(curve.times[0] for panel in panels for curve in panel.curves)
    end = max(curve.times[-1] for panel in panels for curve in panel.curves)
    height = _TOP + sum(_KEY + panel.height + _GAP for panel in panels) - _GAP + _BOTTOM
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" height="{height}" '
        f'font-family="system-ui, sans-serif" font-size="12" fill="{_INK}">',
        f"<title>{escape(title)}</title>",
        f'<rect width="{WIDTH}" height="{height}" fill="#ffffff"/>',
        f'<text x="{_LEFT}" y="20" font-size="14" font-weight="600">{escape(title)}</text>',
    ]
    top = float(_TOP)
    for panel in panels:
        parts += _key(panel, top)
        top += _KEY
        parts += _panel(panel, top, begin, end, is_last=panel is panels[-1])
        top += panel.height + _GAP
    middle = 0.5 * (_LEFT + WIDTH - _RIGHT)
    parts.append(f'<text x="{middle:.1f}" y="{height - 8}" text-anchor="middle" fill="{_SOFT}">{time_label}</text>')
    return "\n".join([*parts, "</svg>"]) + "\n"


def ticks(low: float, high: float, count: int) -> list[float]:
    """Round numbers from low to high, about as many as asked for."""
    raw = (high - low) / count
    power = 10.0 ** floor(log10(raw))
    step = next(power * factor for factor in (1.0, 2.0, 5.0, 10.0) if power * factor >= raw * (1.0 - 1e-9))
    first, last = ceil(low / step - 1e-9), floor(high / step + 1e-9)
    return [number * step for number in range(first, last + 1)]


def _key(panel: Panel, top: float) -> list[str]:
    entries = [(curve.label, _COLOURS[curve.colour], curve.is_dashed) for curve in panel.curves]
    entries += [(panel.level, _LIMIT, True)] * bool(panel.levels)
    parts = [f'<text x="8" y="{top + 15:.1f}" fill="{_SOFT}">{escape(panel.label)}</text>']
    x = WIDTH - _RIGHT - sum(34.0 + _LETTER * len(label) for label, _, _ in entries)
    for label, colour, is_dashed in entries:
        dash = ' stroke-dasharray="5 3"' if is_dashed else ""
        parts.append(
            f'<path d="M{x:.1f} {top + 11:.1f}h18" stroke="{colour}" stroke-width="2"{dash}/>'
            f'<text x="{x + 23:.1f}" y="{top + 15:.1f}">{escape(label)}</text>'
        )
        x += 34.0 + _LETTER * len(label)
    return parts


def _panel(panel: Panel, top: float, begin: float, end: float, *, is_last: bool) -> list[str]:
    values = [value for curve in panel.curves for value in curve.values]
    low, high = min([*values, *panel.levels]), max([*values, *panel.levels])
    margin = 0.06 * (high - low or 1.0)
    low, high = low - margin, high + margin
    right, bottom = WIDTH - _RIGHT, top + panel.height

    def x_of(time: float) -> float:
        return _LEFT + (time - begin) / (end - begin) * (right - _LEFT)

    def y_of(value: float) -> float:
        return bottom - (value - low) / (high - low) * panel.height

    parts = []
    for value in ticks(low, high, 5):
        y = y_of(value)
        parts.append(f'<path d="M{_LEFT} {y:.1f}H{right}" stroke="{_GRID}"/>')
        parts.append(f'<text x="{_LEFT - 6}" y="{y + 4:.1f}" text-anchor="end" fill="{_SOFT}">{_number(value)}</text>')
    for time in ticks(begin, end, 8):
        x = x_of(time)
        parts.append(f'<path d="M{x:.1f} {top:.1f}V{bottom:.1f}" stroke="{_GRID}"/>')
        if is_last:
            parts.append(
                f'<text x="{x:.1f}" y="{bottom + 15:.1f}" text-anchor="middle" fill="{_SOFT}">{_number(time)}</text>'
            )
    for level in panel.levels:
        y = y_of(level)
        parts.append(f'<path d="M{_LEFT} {y:.1f}H{right}" stroke="{_LIMIT}" stroke-dasharray="5 3"/>')
    for curve in panel.curves:
        kept = decimated(curve.times, curve.values, tolerance=(high - low) / _RESOLUTION, points_max=_POINTS_MAX)
        points = " ".join(f"{x_of(curve.times[index]):.1f},{y_of(curve.values[index]):.1f}" for index in kept)
        dash = ' stroke-dasharray="5 3"' if curve.is_dashed else ""
        parts.append(
            f'<polyline points="{points}" fill="none" stroke="{_COLOURS[curve.colour]}" stroke-width="1.6"{dash}/>'
        )
    parts.append(
        f'<rect x="{_LEFT}" y="{top:.1f}" width="{right - _LEFT}" height="{panel.height}" fill="none" '
        f'stroke="{_FRAME}"/>'
    )
    return parts


def _number(value: float) -> str:
    return f"{round(value, 9) + 0.0:g}"
