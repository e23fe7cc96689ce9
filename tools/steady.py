"""Run tests again and again beside busy processes, and print the tests that failed in any run: `make steady`.

A test that passes on a quiet computer can depend on how quickly it is served: turns of an event loop that are counted
where an event should be awaited, places of a page that move between two looks, times that are asserted. Such a test
fails when both cores are busy, or when there is only one. So the tests run `--times` times beside one process a core
that never waits, and then `--one-core` times on one core. There are no second tries and no longer time-outs.

The output of each run is kept in build/steady/. Exit code: 0 if every run passed, 1 if a test failed in one, 2 if tests
could not be run.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import re
import shutil
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final, NamedTuple

ROOT: Final = Path(__file__).resolve().parent.parent
KEPT: Final = ROOT / "build" / "steady"
FAILED: Final = re.compile(r"^(?:FAILED|ERROR) (\S+::\w+(?:\[.*?\])?)(?: - .*)?$", re.MULTILINE)
LAST_LINE: Final = re.compile(r"^=* ?((?:\d+ [a-z]+,? ?)+ in [\d.]+s.*?) ?=*$", re.MULTILINE)

BURNER: Final = "import os, sys\nparent = int(sys.argv[1])\nwhile os.getppid() == parent:\n    sum(range(100_000))\n"
"""Keeps a core busy until its parent has ended."""
TESTS_FAILED: Final = 1
"""The exit code of pytest for failed tests; each other one but 0 says that it could not run them."""


class Outcome(NamedTuple):
    """Says how one run of the tests ended.

    Attributes:
        failed: names of the tests that failed, in their order.
        line: the last line of pytest.
        code: its exit code.
        wall_s: how long it took, s.
        cpu_s: processor time of it and of the processes that it waited for, s.
    """

    failed: tuple[str, ...]
    line: str
    code: int
    wall_s: float
    cpu_s: float


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m tools.steady", description=__doc__.partition("\n")[0])
    parser.add_argument("tests", nargs="*", default=["tests"], help="files and folders, as pytest takes them")
    parser.add_argument("--times", type=int, default=10, help="runs beside busy processes (%(default)s)")
    parser.add_argument("--one-core", type=int, default=2, help="runs on one core (%(default)s)")
    parser.add_argument("-k", dest="chosen", help="which tests, as pytest takes it")
    options = parser.parse_args(arguments)
    call = [sys.executable, "-m", "pytest", "-q", "-rfE", "-p", "no:cacheprovider", *options.tests]
    if options.chosen:
        call += ["-k", options.chosen]
    shutil.rmtree(KEPT, ignore_errors=True)
    KEPT.mkdir(parents=True)

    outcomes = []
    with burners(len(cores())):
        for number in range(1, options.times + 1):
            outcomes.append(shown(f"beside busy cores, {number} of {options.times}", run(call, f"busy-{number}.log")))
    if options.one_core and not hasattr(os, "sched_setaffinity"):
        print("This system cannot hold a process to one core: not tried on one core.")
        options.one_core = 0
    for number in range(1, options.one_core + 1):
        outcomes.append(
            shown(f"on one core, {number} of {options.one_core}", run(on_one_core(call), f"one-{number}.log"))
        )
    print(summary(outcomes))
    return verdict(outcomes)


def run(call: Sequence[str], log: str) -> Outcome:
    """Run the tests once. Its output goes into the file `log` of build/steady/."""
    began_s, before = time.monotonic(), os.times()
    with (KEPT / log).open("w+") as output:
        ended = subprocess.run(call, cwd=ROOT, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT)
        output.seek(0)
        text = output.read()
    after = os.times()
    cpu_s = after.children_user + after.children_system - before.children_user - before.children_system
    return outcome_of(text, ended.returncode, time.monotonic() - began_s, cpu_s)


def outcome_of(text: str, code: int, wall_s: float, cpu_s: float) -> Outcome:
    """Read the output of pytest, which was called with `-rfE`."""
    lines = LAST_LINE.findall(text)
    return Outcome(tuple(FAILED.findall(text)), lines[-1] if lines else "no last line", code, wall_s, cpu_s)


def shown(name: str, outcome: Outcome) -> Outcome:
    print(f"{name}: {outcome.line}; {outcome.cpu_s:.0f} s of processor time", flush=True)
    for test in outcome.failed:
        print(f"    {test}", flush=True)
    return outcome


def summary(outcomes: Sequence[Outcome]) -> str:
    """List the tests that failed, the most frequent first."""
    counts = Counter(test for outcome in outcomes for test in dict.fromkeys(outcome.failed))
    if not counts:
        green = sum(outcome.code == 0 for outcome in outcomes)
        return f"{green} of {len(outcomes)} runs passed."
    rows = [f"{count:4} of {len(outcomes)}  {test}" for test, count in counts.most_common()]
    return "\n".join(["Failed in some runs (build/steady/ has what they printed):", *rows])


def verdict(outcomes: Sequence[Outcome]) -> int:
    if any(outcome.code not in (0, TESTS_FAILED) for outcome in outcomes) or not outcomes:
        return 2
    return 1 if any(outcome.code or outcome.failed for outcome in outcomes) else 0


def cores() -> list[int]:
    """The numbers of the cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return sorted(os.sched_getaffinity(0))
    return list(range(os.cpu_count() or 1))


def on_one_core(call: Sequence[str]) -> list[str]:
    """The call of a process that is held to one core, and so are all processes that it starts."""
    held = f"import os, sys\nos.sched_setaffinity(0, {{{cores()[0]}}})\nos.execv(sys.argv[1], sys.argv[1:])"
    return [sys.executable, "-S", "-c", held, *call]


@contextlib.contextmanager
def burners(count: int) -> Iterator[list[subprocess.Popen[bytes]]]:
    """Keep `count` cores busy meanwhile. Yields the processes."""
    busy = [subprocess.Popen([sys.executable, "-S", "-c", BURNER, str(os.getpid())]) for _ in range(count)]
    try:
        yield busy
    finally:
        for process in busy:
            process.kill()
            process.wait()


if __name__ == "__main__":
    sys.exit(main())
