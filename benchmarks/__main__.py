"""`python -m benchmarks [NAME ...]`: one table of measured times, ours beside what a user would otherwise have.

`--quoted` prints every measured figure that README and docs quote, beside what is measured now.
`--against CHECKOUT` measures the package of another working copy with the same benchmarks, in turn, and prints both.
"""

from __future__ import annotations

import argparse
import json
import platform
import sys
from importlib import import_module
from pathlib import Path

from benchmarks.table import Row, as_data, print_rows

MODULES = (
    "programs",
    "streams",
    "language_loop",
    "kinematics",
    "motion",
    "ticks",
    "trees",
    "serving",
    "devices",
    "choices",
    "editor",
    "debugger",
    "studio",
    "plot",
    "cluster",
    "sweep",
    "record",
    "compiling",
    "checking",
    "observed",
    "metered",
)
LONG = ("growth", "rules")
"""Measured only by name: each takes ten minutes."""
KNOWN = MODULES + LONG


def main(arguments: list[str]) -> int:
    """Print the table of the named modules, or of all."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description="Print a table of measured times.")
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help=f"one of {', '.join(KNOWN)}; all but growth and rules if none"
    )
    parser.add_argument("--against", type=Path, metavar="CHECKOUT", help="measure the package of this working copy too")
    parser.add_argument("--rounds", type=int, default=5, help="how often each of the two is measured (default: 5)")
    parser.add_argument(
        "--quoted", action="store_true", help="print what README and docs quote beside what is measured"
    )
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    chosen = parser.parse_args(arguments)
    names = chosen.names or list(MODULES)
    if chosen.quoted and chosen.names:
        parser.error("--quoted measures all that is quoted; name nothing")
    if chosen.against is not None and (chosen.quoted or chosen.json):
        parser.error("--against prints its own table; it goes with neither --quoted nor --json")
    for name in names:
        if name not in KNOWN:
            parser.error(f"no benchmark is called {name!r}; there are {', '.join(KNOWN)}")
    if chosen.rounds < 1:
        parser.error(f"--rounds is {chosen.rounds}; it has to be 1 or more")
    if chosen.against is not None:
        if not (chosen.against / "src" / "elitescript").is_dir():
            parser.error(f"{chosen.against} has no src/elitescript")
        from benchmarks.against import print_comparison

        return print_comparison(names, chosen.against.resolve() / "src", chosen.rounds)
    rows: list[Row] = []
    for name in names:
        print(f"measuring {name} ...", file=sys.stderr)
        rows += import_module(f"benchmarks.{name}").rows()
    if chosen.quoted:
        from benchmarks.quoted import print_quotes

        return print_quotes(rows)
    if chosen.json:
        print(json.dumps([as_data(row) for row in rows]))
        return 0
    print(
        f"Python {platform.python_version()}, {platform.machine()}; medians or best of several runs, see the modules;"
    )
    print("ratios are of CPU times, `x real time` is robot time in wall time")
    print_rows(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
