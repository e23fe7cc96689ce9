"""Write the figures and the measured tables of docs/explanation/motion.md: `make figures`.

A table stands in the page between two marks, `<!-- begin NAME ... -->` and `<!-- end NAME -->`; what is between them
is written here and nowhere else. Sweeps and comparisons that take long are not run again: their tables come from the
records that `make invariants` and `make peers` leave beside the page.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable
from math import dist, pi, sqrt
from pathlib import Path
from typing import Any, Final

from elitescript import VirtualRobot
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model
from tools import motion_figures, pipeline_figures
from tools.motion_figures import STOPS, servo_table
from tools.motion_runs import HOME, MODEL, RAMP, SINE, STEP, program, tool_speeds, traced
from tools.pipeline_figures import PLANTS, PRESS_N, STIFFNESSES, plant_rows, pressed, tracking_errors

PAGE: Final = Path(__file__).resolve().parent.parent / "docs" / "explanation" / "motion.md"
FOLDER: Final = PAGE.parent / "figures"
COMMAND: Final = "make figures"
FIGURES: Final = {**motion_figures.FIGURES, **pipeline_figures.FIGURES}


def servo() -> list[str]:
    """Lag and overshoot of `servoj`."""
    lines = [
        f"Measured on the base joint of a {MODEL}: a ramp of {RAMP:g} rad/s that ends, a step of {STEP:g} rad, and",
        f"a sine of {SINE:g} rad at 1 Hz.",
        "",
        "| look-ahead, s | gain | lag behind the ramp, s | beyond its end, mrad | 90 % of the step, s "
        "| beyond the step, % | lag behind the sine, s | its amplitude, % |",
        "|---:|---:|---:|---:|---:|---:|---:|---:|",
    ]
    lines += [
        f"| {row.lookahead_s:.2f} | {row.gain} | {row.ramp_lag_s:.3f} | {1e3 * row.ramp_overshoot:.2f} "
        f"| {row.step_90_s:.3f} | {100 * row.step_overshoot:.2f} | {row.sine_lag_s:.3f} | {100 * row.sine_gain:.1f} |"
        for row in servo_table()
    ]
    return lines


def durations() -> list[str]:
    """Single moves against the law."""
    lines = ["| move | way | law, s | measured, s |", "|---|---:|---:|---:|"]
    moves = (
        ("movej, a = 1.4, v = 1.05", [f"movej({[1.5, *HOME[1:]]}, a=1.4, v=1.05)"], 1.5, 1.4, 1.05, "rad"),
        ("movej, a = 1.4, v = 1.05", [f"movej({[0.4, *HOME[1:]]}, a=1.4, v=1.05)"], 0.4, 1.4, 1.05, "rad"),
        ("movel, a = 1.2, v = 0.25", _shift("p[1] = p[1] + 0.2", "movel(p, a=1.2, v=0.25)"), 0.2, 1.2, 0.25, "m"),
        ("movel, a = 1.2, v = 0.25", _shift("p[2] = p[2] + 0.02", "movel(p, a=1.2, v=0.25)"), 0.02, 1.2, 0.25, "m"),
        ("movel, turns on the spot", _shift("p[5] = p[5] + 0.5", "movel(p, a=1.2, v=0.25)"), 0.5, 1.2, 0.25, "rad"),
        (
            "movec, half a circle of 0.05 m",
            _shift(
                "via = [p[0] - 0.05, p[1] + 0.05, *p[2:]]",
                "to = [p[0], p[1] + 0.1, *p[2:]]",
                "movec(via, to, 0.8, 0.15)",
            ),
            0.05 * pi,
            0.8,
            0.15,
            "m",
        ),
    )
    for name, text, way, a, v, unit in moves:
        run = VirtualRobot(MODEL).run(program(*text)).check()
        law_s = way / v + v / a if way >= v * v / a else 2.0 * sqrt(way / a)
        lines.append(f"| {name} | {way:.4g} {unit} | {law_s:.4f} | {run.time_s:.3f} |")
    return lines


def _shift(*lines: str) -> list[str]:
    return ["p = get_target_tcp_pose()", *lines]


def stops() -> list[str]:
    """How long the stop commands take, and how far the flange goes."""
    arm = load_model(MODEL).arm
    lines = ["| stop at 0.25 m/s | time, s | way of the flange, mm |", "|---|---:|---:|"]
    for stop in STOPS:
        rows = traced(
            program(
                *_shift("p[1] = p[1] + 0.3", "def brake():", "  sleep(0.5)", f"  {stop}", "end"),
                "start_thread(brake, ())",
                "movel(p, a=1.2, v=0.25)",
                "sleep(0.2)",
            )
        )
        speeds = tool_speeds(arm, rows)
        # The state of tick N is in the row before it.
        first = round(0.5 / PERIOD_S) - 1
        last = next(index for index in range(first, len(rows)) if speeds[index] == 0.0)
        way = dist(rows[first].tcp_pose[:3], rows[last].tcp_pose[:3])
        lines.append(f"| `{stop}` | {(last - first) * PERIOD_S:.3f} | {1e3 * way:.1f} |")
    return lines


def force() -> list[str]:
    """How long force control takes, from the first contact on."""
    lines = [
        f"From the first contact to {PRESS_N:g} N within 1 %, and how far the force goes beyond them:",
        "",
        "| gain scaling | " + " | ".join(f"{stiffness:g} N/m" for stiffness in STIFFNESSES) + " |",
        "|---:|" + "---:|" * len(STIFFNESSES),
    ]
    for scaling in (0.1, 0.2, 0.5):
        cells = []
        for stiffness in STIFFNESSES:
            times, forces = pressed(stiffness, scaling, 0.5 + 1000.0 / (scaling * stiffness))
            contact = next(index for index, force in enumerate(forces) if force > 0.0)
            settled = max(index for index, force in enumerate(forces) if abs(force / PRESS_N - 1.0) > 0.01) + 1
            over = max(0.0, max(forces) / PRESS_N - 1.0)
            cells.append(f"{times[settled] - times[contact]:.3f} s, {100 * over:.0f} %")
        lines.append(f"| {scaling:g} | " + " | ".join(cells) + " |")
    return lines


def plant() -> list[str]:
    """How far actual is behind target, and for how long."""
    lines = [
        "| plant | behind at 1 rad/s, mrad | less than 0.1 mrad after the target rests, s | exact, s |",
        "|---|---:|---:|---:|",
    ]
    for name, config in PLANTS.items():
        rows = plant_rows(config)
        errors = tracking_errors(rows)
        # From the row at which the target is where it stays.
        rest = next(index for index, row in enumerate(rows) if row.q == rows[-1].q)
        near = next(k for k in range(rest, len(rows)) if max(map(abs, errors[k:])) < 1e-4)
        exact = next(k for k in range(rest, len(rows)) if not any(errors[k:]))
        lines.append(
            f"| {name} | {1e3 * max(errors):.2f} | {(near - rest) * PERIOD_S:.3f} | {(exact - rest) * PERIOD_S:.3f} |"
        )
    return lines


def invariants() -> list[str]:
    """The last long sweep."""
    return _record("invariants.json", "make invariants", "sweep", "cases", "nearest to its limit")


def peers() -> list[str]:
    """The last comparison with other packages."""
    return _record("peers.json", "make peers", "comparison", "with", "largest difference")


def _record(name: str, command: str, what: str, how: str, found: str) -> list[str]:
    path = PAGE.parent / name
    if not path.exists():
        return [f"Not run yet; `{command}` writes this."]
    record: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    asked = f"{command} CASES={record['cases']}" if record["cases"] else command
    lines = [
        f"`{asked}` on {record['date']}, {record['python']}, elitescript {record['version']}: "
        f"{record['passed']} tests passed, {record['failed']} failed, {record['skipped']} skipped; "
        f"{record['minutes']} min.",
        "",
        f"| {what} | {how} | {found} |",
        "|---|---|---|",
    ]
    lines += [f"| {row['what']} | {row['how']} | {row['found']} |" for row in record["findings"]]
    return lines


BLOCKS: Final[dict[str, Callable[[], list[str]]]] = {
    "servo": servo,
    "durations": durations,
    "stops": stops,
    "force": force,
    "plant": plant,
    "invariants": invariants,
    "peers": peers,
}
"""Mark in the page and what writes the lines between its marks."""


def block(name: str, lines: list[str]) -> str:
    """A block with its marks."""
    return "\n".join([f"<!-- begin {name}; written by `{COMMAND}`, do not edit -->", *lines, f"<!-- end {name} -->"])


def found_block(text: str, name: str) -> re.Match[str]:
    """Where a block is in a text.

    Raises:
        ValueError: the text has no marks of that name.
    """
    match = re.search(rf"<!-- begin {name};.*?<!-- end {name} -->", text, re.DOTALL)
    if match is None:
        raise ValueError(f"the page has no block {name!r}: marks `<!-- begin {name}; -->` and `<!-- end {name} -->`")
    return match


def main() -> int:
    """Write figures and page."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name, draw in FIGURES.items():
        (FOLDER / name).write_text(draw(), encoding="utf-8", newline="\n")
        print(FOLDER / name)
    text = PAGE.read_text(encoding="utf-8")
    for name, lines in BLOCKS.items():
        match = found_block(text, name)
        text = text[: match.start()] + block(name, lines()) + text[match.end() :]
    PAGE.write_text(text, encoding="utf-8", newline="\n")
    print(PAGE)
    return 0


if __name__ == "__main__":
    sys.exit(main())
