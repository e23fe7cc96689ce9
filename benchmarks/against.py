"""The same benchmarks with the package of another working copy and with this one's, in turn: old, new and the ratio.

Each measurement is a process of its own, and both packages are measured in each round, so that what else the machine
does disturbs both alike. The benchmarks are those of this checkout; one that the other package cannot run has no old
figure.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from statistics import median

from benchmarks.measure import ROOT, environment
from benchmarks.table import Row, print_table

HEAD = ("what", "of", "old: least", "median", "new: least", "median", "new / old", "medians")


def print_comparison(names: list[str], old: Path, rounds: int) -> int:
    """Print the table of the named modules; return 1 if this checkout cannot run one."""
    lines: list[tuple[str, ...]] = []
    failed: list[tuple[Path, str]] = []
    new = ROOT / "src"
    for name in names:
        measured: dict[Path, list[list[Row]]] = {old: [], new: []}
        for number in range(rounds):
            for source, tables in measured.items():
                if (source, name) in failed:
                    continue
                print(f"measuring {name}, round {number + 1} of {rounds}, with {source} ...", file=sys.stderr)
                try:
                    tables.append(_rows(name, source))
                except subprocess.CalledProcessError as error:
                    failed.append((source, name))
                    reason = error.stderr.strip().rpartition("\n")[2]
                    print(f"{name} does not run with it: {reason}", file=sys.stderr)
        lines += comparison(measured[old], measured[new])
    print(f"old: {old}; new: {new}; {rounds} rounds in turn")
    print_table(HEAD, lines)
    return 1 if any(source == new for source, _ in failed) else 0


def _rows(name: str, source: Path) -> list[Row]:
    command = [sys.executable, "-m", "benchmarks", "--json", name]
    done = subprocess.run(command, check=True, capture_output=True, text=True, cwd=ROOT, env=environment(source))
    return [Row(**data) for data in json.loads(done.stdout)]


def comparison(old: list[list[Row]], new: list[list[Row]]) -> list[tuple[str, ...]]:
    """Return a line for each figure of each row that the new package has: CPU, wall, or what is no time."""
    lines = []
    for row in new[0] if new else []:
        for of, field in (("CPU", "cpu_s"), ("wall", "wall_s"), ("", "value")):
            before, after = _figures(old, row.what, field), _figures(new, row.what, field)
            if not after:
                continue
            pairs = [(min(before), min(after)), (median(before), median(after))] if before else []
            ratios = [f"{now / then:.2f}" if then else "-" for then, now in pairs] or ["-", "-"]
            said = [
                [row.shown(min(figures)), row.shown(median(figures))] if figures else ["-", "-"]
                for figures in (before, after)
            ]
            lines.append((row.what, of, *said[0], *said[1], *ratios))
    return lines


def _figures(tables: list[list[Row]], what: str, field: str) -> list[float]:
    figures = (getattr(row, field) for table in tables for row in table if row.what == what)
    return [figure for figure in figures if figure is not None]
