"""Print the coverage of the tests by package, and the places that no test reaches: `make coverage`.

Both come from what `coverage json` writes. A *place* is a range of lines that never ran, or a branch `12->15` that was
never taken: a line that ran, and the line that never followed it.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

SOURCE: Final = "src/elitescript/"


@dataclass(slots=True)
class Package:
    """What was counted in one package."""

    statements: int = 0
    ran: int = 0
    branches: int = 0
    taken: int = 0
    places: dict[str, list[str]] = field(default_factory=dict)
    """For each file, the places that no test reaches."""

    @property
    def percent(self) -> float:
        """Share of statements and branches together, as coverage.py counts it."""
        possible = self.statements + self.branches
        return 100.0 * (self.ran + self.taken) / possible if possible else 100.0

    def add(self, other: Package) -> None:
        """Count another one in."""
        self.statements += other.statements
        self.ran += other.ran
        self.branches += other.branches
        self.taken += other.taken


def package_of(path: str) -> str:
    """Name the package of a file: `controller` of `src/elitescript/controller/tasks.py`, `.` of what is beside them."""
    folder, slash, _ = path.removeprefix(SOURCE).partition("/")
    return folder if slash else "."


def packages(report: Mapping[str, Any]) -> dict[str, Package]:
    """Count by package what a report of coverage.py says of files."""
    found: dict[str, Package] = {}
    for path, entry in sorted(report["files"].items()):
        package = found.setdefault(package_of(path), Package())
        summary = entry["summary"]
        package.add(
            Package(
                summary["num_statements"],
                summary["covered_lines"],
                summary["num_branches"],
                summary["covered_branches"],
            )
        )
        missed = set(entry["missing_lines"])
        # A branch from or to a line that never ran is told by that line.
        jumps = [pair for pair in entry["missing_branches"] if not missed & set(pair)]
        places = [*ranges(sorted(missed), set(entry["executed_lines"])), *map(_jump, jumps)]
        if places:
            package.places[path.removeprefix(SOURCE)] = places
    return found


def ranges(lines: Sequence[int], ran: set[int]) -> Iterator[str]:
    """Write lines as ranges; blank lines and comments, which can never run, do not end one."""
    if not lines:
        return
    first = lines[0]
    for line, after in pairwise([*lines, None]):
        if after is None or any(between in ran for between in range(line + 1, after)):
            yield f"{first}" if first == line else f"{first}-{line}"
            first = after or 0


def _jump(pair: Sequence[int]) -> str:
    return f"{pair[0]}->{'exit' if pair[1] < 0 else pair[1]}"


def table(found: Mapping[str, Package]) -> Iterator[str]:
    """Yield the lines of the table, the least covered package first, the whole at the end."""
    whole = Package()
    for package in found.values():
        whole.add(package)
    yield f"{'package':<14}{'statements':>12}{'missed':>9}{'branches':>11}{'missed':>9}{'percent':>10}"
    for name, package in [*sorted(found.items(), key=lambda item: item[1].percent), ("all", whole)]:
        yield (
            f"{name:<14}{package.statements:>12}{package.statements - package.ran:>9}"
            f"{package.branches:>11}{package.branches - package.taken:>9}{package.percent:>10.1f}"
        )


def uncovered(found: Mapping[str, Package]) -> Iterator[str]:
    """Yield a heading for each package and a line for each file, with the places that no test reaches."""
    for name, package in sorted(found.items()):
        if package.places:
            yield ""
            yield name
            for path, places in package.places.items():
                yield f"  {path}: {', '.join(places)}"


def main() -> int:
    """Print the table of the report that the command line names; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("report", type=Path, help="what `coverage json` has written")
    found = packages(json.loads(parser.parse_args().report.read_text(encoding="utf-8")))
    for line in (*table(found), *uncovered(found)):
        print(line)
    return 0


if __name__ == "__main__":
    sys.exit(main())
