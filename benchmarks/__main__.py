"""`python -m benchmarks [NAME ...]`: one table of measured times, ours beside what a user would otherwise have."""

from __future__ import annotations

import platform
import sys
from importlib import import_module

MODULES = ("programs", "streams", "language_loop", "kinematics", "motion", "ticks", "serving", "devices", "choices")
HEAD = ("what", "ours", "the other", "ratio")


def main(names: list[str]) -> int:
    """Print the table of the named modules, or of all."""
    unknown = [name for name in names if name not in MODULES]
    if unknown:
        print(f"no benchmark is called {unknown[0]!r}; there are {', '.join(MODULES)}", file=sys.stderr)
        return 2
    table: list[tuple[str, ...]] = [HEAD]
    for name in names or MODULES:
        print(f"measuring {name} ...", file=sys.stderr)
        table += import_module(f"benchmarks.{name}").rows()
    widths = [max(len(row[column]) for row in table) for column in range(len(HEAD))]
    print(f"Python {platform.python_version()}, {platform.machine()}; medians or best of several runs, see the modules")
    for number, row in enumerate(table):
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
        if number == 0:
            print("  ".join("-" * width for width in widths))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
