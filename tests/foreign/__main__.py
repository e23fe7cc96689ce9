"""Runs CPython's own tests as programs, on a virtual robot and beside it by CPython itself: `make foreign`.

The methods of the installed package `test` are cut into programs; the operands of each assertion must be the same on
both sides. What differs is printed, unless `known.toml` has a row with its reason; a row that does not hold any more is
printed too.

    python -m tests.foreign --only test_list --only test_scope.ScopeTests
    python -m tests.foreign --show test_scope.ScopeTests.testSimpleNesting

Exit code: 0 if all that differs is known, 1 if not, 2 if the package `test` is not installed.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

from tests.foreign.comparing import IS_DIFFERENT, Cause, Verdict, compare, settle
from tests.foreign.known import load_known
from tests.foreign.page import PAGE, Result, page, program_row, table
from tests.foreign.programs import ANOTHER, ROUNDS, Timed, summary, timed
from tests.foreign.running import Outcome, on_python, run_all, warm_up
from tests.foreign.slicing import Case, cases
from tests.foreign.sources import GROUPS, Library, tests_folder

SEED: Final = "0"
"""The seed of hashes on both sides, so that sets of texts have one order."""
MISSING: Final = (
    "The package `test` of this Python is not installed, and nothing was run. In Debian and Ubuntu:"
    " apt install libpython3-testsuite; else take a Python that has it, as those of python.org, pyenv and uv do:"
    " make PYTHON=/path/to/python3.11 foreign"
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run, compare and report."""
    parser = argparse.ArgumentParser(prog="python -m tests.foreign", description=__doc__.partition("\n")[0])
    parser.add_argument("--only", action="append", default=[], help="tests whose names begin so; again for more")
    parser.add_argument(
        "--width", type=int, default=len(os.sched_getaffinity(0)), help="programs at once (%(default)s)"
    )
    parser.add_argument("--list", type=Path, help="file for all that came out, one JSON record a line")
    parser.add_argument("--show", help="print the program of a test, and what comes of it")
    parser.add_argument("--programs", type=Path, help="folder where pyperformance is installed; its programs run too")
    parser.add_argument("--installed", action="store_true", help="only say whether the package `test` is there")
    parser.add_argument("--write", action="store_true", help="write the page")
    parser.add_argument("--again", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    folder = tests_folder()
    if folder is None:
        print(MISSING, file=sys.stderr)
        return 2
    if options.installed:
        return 0
    if options.again:
        return _again()
    if os.environ.get("PYTHONHASHSEED") != SEED:
        os.environ["PYTHONHASHSEED"] = SEED
        os.execv(sys.executable, [sys.executable, "-m", "tests.foreign", *(arguments or sys.argv[1:])])
    chosen = chosen_cases(Library(folder), [options.show] if options.show else options.only)
    if options.show:
        return _show(list(chosen))
    began_s = time.monotonic()
    rows = list(judged(chosen, options.width))
    if options.list:
        options.list.write_text("".join(map(recorded, rows)), encoding="utf-8")
    result = Result.of([(case, verdict) for case, verdict, _ in rows], load_known(), is_whole=not options.only)
    print(table(result))
    for line in result.lines():
        print(line)
    print(f"{result.summary} {time.monotonic() - began_s:.0f} s.")
    programs = list(shown_programs(options.programs)) if options.programs else []
    if options.write:
        PAGE.write_text(page(result, programs, ROUNDS), encoding="utf-8")
        print(f"written: {PAGE.name}")
    return 0 if result.is_known and not any(program.why == ANOTHER for program in programs) else 1


def shown_programs(folder: Path) -> Iterator[Timed]:
    """Run the programs of pyperformance, print a row for each, and the mean of them all."""
    rows = []
    for row in timed(folder):
        rows.append(row)
        print(program_row(row), flush=True)
        yield row
    same, mean, worst = summary(rows)
    print(
        f"{same} of {len(rows)} programs give the same output; {mean:.2f} times the time of CPython, worst {worst:.2f}"
    )


def chosen_cases(library: Library, only: Sequence[str]) -> Iterator[Case]:
    """Yield the tests of all groups, or those whose names begin in a way that was asked for."""
    for group in GROUPS:
        for name in library.names_of(group):
            if not only or any(name.startswith(each) or each.startswith(f"{name}.") for each in only):
                for case in cases(library, group, [name]):
                    if not only or case.name.startswith(tuple(only)):
                        yield case


def recorded(row: tuple[Case, Verdict, dict[str, Outcome]]) -> str:
    """Return a line of the list."""
    case, verdict, outcomes = row
    sides = {side: asdict(outcome) for side, outcome in outcomes.items()} if verdict.cause in IS_DIFFERENT else {}
    return (
        json.dumps({"test": case.name, "group": case.group, "cause": verdict.cause, "text": verdict.text, **sides})
        + "\n"
    )


def judged(chosen: Iterator[Case], width: int) -> Iterator[tuple[Case, Verdict, dict[str, Outcome]]]:
    """Run tests on both sides, and yield how each came out; where they differ, CPython once more in a fresh process."""
    warm_up()
    found: dict[str, tuple[Case, dict[str, Outcome]]] = {}
    different: dict[str, tuple[Case, dict[str, Outcome], Verdict]] = {}
    unsliced: list[Case] = []

    def jobs() -> Iterator[tuple[Any, str, str]]:
        for case in chosen:
            if case.why:
                unsliced.append(case)
                continue
            found[case.name] = (case, {})
            for side in ("python", "robot"):
                yield (case.name, side), side, case.text

    count = 0
    for (name, side), outcome in run_all(jobs(), width):
        case, outcomes = found[name]
        outcomes[side] = outcome
        if len(outcomes) < 2:
            continue
        del found[name]
        count += 1
        if count % 500 == 0:
            print(f"... {count} programs", file=sys.stderr, flush=True)
        verdict = compare(outcomes["python"], outcomes["robot"])
        if verdict.cause in IS_DIFFERENT:
            different[name] = (case, outcomes, verdict)
        else:
            yield case, verdict, outcomes
    for name, outcome in run_all(((name, "fresh", case.text) for name, (case, _, _) in different.items()), width):
        case, outcomes, verdict = different[name]
        if outcome.end not in ("late", "crash", "internal"):
            verdict = settle(outcomes["python"], outcomes["robot"], outcome)
        yield case, verdict, outcomes
    for case in unsliced:
        yield case, Verdict(Cause.UNSLICED, case.why), {}


def _again() -> int:
    print(json.dumps(asdict(on_python(sys.stdin.buffer.read().decode()))))
    return 0


def _show(found: list[Case]) -> int:
    for case in found:
        print(case.name, case.why)
        for number, line in enumerate(case.text.split("\n"), 1):
            print(f"{number:4} {line}")
        sides: dict[str, Outcome] = {}
        for side, outcome in run_all([(side, side, case.text) for side in ("python", "robot")] if case.text else (), 2):
            sides[side] = outcome
        for side in sorted(sides):
            outcome = sides[side]
            print(f"{side}: {outcome.end} {outcome.kind} {outcome.text} line {outcome.line}")
            for note in outcome.notes[-20:]:
                print(f"    {' '.join(note)}")
        if sides:
            print(*compare(sides["python"], sides["robot"]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
