"""Writes docs/explanation/as-python-is.md: what came of CPython's own tests and of other programs."""

from __future__ import annotations

import platform
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from tests.foreign.comparing import IS_DIFFERENT, Cause, Verdict
from tests.foreign.known import Known
from tests.foreign.programs import Timed, summary
from tests.foreign.slicing import Case
from tests.foreign.sources import GROUPS

PAGE: Final = Path(__file__).resolve().parents[2] / "docs" / "explanation" / "as-python-is.md"

_MEANT: Final = {
    Cause.SAME: "all operands of all assertions are the same, and the test passes on both sides",
    Cause.ALIKE: "both sides skip, fail or raise alike, mostly because a stand-in is less than what it stands for",
    Cause.UNSLICED: "the method needs something that cannot be cut out, such as `unittest.mock` or a second Python",
    Cause.REFUSED: "the checker refuses what the test names, such as `__dict__`, `async` or `__new__` (E115)",
    Cause.POLICY: "a module or name that the robot does not have, or an attribute that programs may not read",
    Cause.TEXTS: "the test hands texts to `compile`, or dictionaries to `exec`",
    Cause.VARIES: "CPython gives something else in another process: addresses, clocks, the order of sets of texts",
    Cause.WORDING: "the same error with another text",
    Cause.VALUE: "another operand, another error, or an error on one side only",
    Cause.SYNTAX: "a text that CPython compiles and that is no program, or the reverse",
    Cause.STUCK: "the program does not end on the robot",
    Cause.OURS: "a crash or an error of elitescript itself",
}

_HEAD: Final = """\
# As Python is

<!-- Written by `make foreign`; do not edit. -->

A program that CPython accepts and the language policy allows does what CPython does. `make foreign` holds that against
the tests that CPython has of itself: it cuts the methods of the installed package `test` into programs, each with what
it needs of its class and its module and a small `unittest` of our own
([tests/foreign](../../tests/foreign/stand_ins.py)), runs each on a virtual robot and as the body of a function of
CPython beside it, and compares the operands of every assertion, not only the verdict. Each program has a process of its
own with bounded time and memory. Where two runs differ, CPython runs once more in a fresh process, and what it gives
otherwise there is left out. Nothing of the package is part of this repository. With `--only test_list` it takes a part,
with `--show NAME` it prints one program and what comes of it.

This page is of CPython {version} on {system}.{missing} With another version the tests are others, and so are the
numbers; the table of known differences says for which versions a row holds.

**{same} of {total} tests pass with the same operands**, {refused} are refused, before the run or in it, by a rule that
names what is refused. {different} differ; those that are known stand below with their reason{unknown}.

"""

_DIFFERENT: Final = """
## What differs

`tests/foreign/known.toml` has a row with a reason for each difference; `make foreign` tells what it does not have, and
rows that do not hold any more. *Meant* says that the language, the manual or the policy wants it so.

| what | tests | meant | reason |
|---|---:|---|---|
"""

_PROGRAMS: Final = """
## Other programs, and how much slower they are

Programs of [pyperformance](https://github.com/python/pyperformance) 1.14 run as they are, but for what they measure
with: {same} of {total} give CPython's output. The others are refused by name. Their loops take {mean:.2f} times the
processor time of CPython in the geometric mean of {timed} (worst {worst:.2f}, best of {rounds}); that is what
checkpoints cost.

| program | CPython, s | elitescript, s | times | remark |
|---|---:|---:|---:|---|
"""


@dataclass(frozen=True, slots=True)
class Result:
    """What came of all tests.

    Attributes:
        counts: tests by group and cause.
        known: rows, and how many of their tests differ.
        new: tests that differ and stand in no row, with what shows it.
        stale: tests of rows that do not differ in that way any more.
    """

    counts: dict[str, Counter[Cause]]
    known: tuple[tuple[Known, int], ...]
    new: tuple[tuple[str, Verdict], ...]
    stale: tuple[str, ...]

    @classmethod
    def of(cls, judged: list[tuple[Case, Verdict]], known: tuple[Known, ...], *, is_whole: bool = True) -> Result:
        """Count what was judged; rows of tests that were not run are no matter unless all were."""
        rows = {test: row for row in known for test in row.tests}
        counts: dict[str, Counter[Cause]] = {group: Counter() for group in GROUPS}
        new: list[tuple[str, Verdict]] = []
        matched: set[str] = set()
        for case, verdict in judged:
            counts[case.group][verdict.cause] += 1
            if verdict.cause in IS_DIFFERENT:
                if case.name in rows and rows[case.name].kind == verdict.cause:
                    matched.add(case.name)
                else:
                    new.append((case.name, verdict))
        ran = {case.name for case, _ in judged}
        stale = [test for test in rows if test not in matched and (is_whole or test in ran)]
        held = tuple((row, sum(test in matched for test in row.tests)) for row in known)
        return cls(counts, held, tuple(sorted(new)), tuple(sorted(stale)))

    @property
    def is_known(self) -> bool:
        """Whether the table of known differences is exactly what differs."""
        return not self.new and not self.stale

    @property
    def total(self) -> Counter[Cause]:
        """Tests of all groups by cause."""
        return sum(self.counts.values(), Counter())

    @property
    def different(self) -> int:
        """How many tests differ."""
        return sum(self.total[cause] for cause in IS_DIFFERENT)

    @property
    def summary(self) -> str:
        """One line."""
        return (
            f"{self.total.total()} tests: {self.total[Cause.SAME]} passed with the same operands, {self.different}"
            f" differ, of which {sum(count for _, count in self.known)} are known."
        )

    def lines(self) -> Iterator[str]:
        """Yield what is not known, and what is known and not so."""
        for test, verdict in self.new:
            yield f"{verdict.cause}: {test}: {verdict.text}"
        for test in self.stale:
            yield f"known.toml has {test}, which does not differ in that way"


def table(result: Result) -> str:
    """Return the counts as a table in Markdown."""
    causes = [cause for cause in Cause if result.total[cause]]
    lines = [f"| group | tests | {' | '.join(causes)} |", f"|---|{'---:|' * (len(causes) + 1)}"]
    for group, counts in (*result.counts.items(), ("**all**", result.total)):
        if counts.total():
            lines.append(f"| {group} | {counts.total()} | {' | '.join(str(counts[cause]) for cause in causes)} |")
    return "\n".join(lines)


def page(result: Result, programs: Sequence[Timed], rounds: int) -> str:
    """Return the whole page."""
    total = result.total
    left_out = [group for group, counts in result.counts.items() if not counts.total()]
    head = _HEAD.format(
        missing=f" The groups {', '.join(left_out)} were not run." if left_out else "",
        version=platform.python_version(),
        system=platform.system(),
        same=total[Cause.SAME],
        total=total.total(),
        refused=total[Cause.REFUSED] + total[Cause.POLICY] + total[Cause.TEXTS],
        different=result.different,
        unknown=f", {len(result.new)} are not" if result.new else "",
    )
    meanings = "\n".join(f"- *{cause}*: {_MEANT[cause]}." for cause in Cause if total[cause])
    rows = [
        f"| {row.kind} | {count} | {'yes' if row.decided else ''} | {row.reason} |"
        for row, count in result.known
        if count
    ]
    text = f"{head}{table(result)}\n\n{meanings}\n{_DIFFERENT}{chr(10).join(rows)}\n"
    return text + programs_section(programs, rounds) if programs else text


def programs_section(programs: Sequence[Timed], rounds: int) -> str:
    """Return the section on programs of others."""
    same, mean, worst = summary(programs)
    timed = sum(row.ratio is not None for row in programs)
    head = _PROGRAMS.format(same=same, total=len(programs), mean=mean, timed=timed, worst=worst, rounds=rounds)
    return head + "".join(f"{program_row(row)}\n" for row in programs)


def program_row(row: Timed) -> str:
    """Return the row of a program."""
    if row.why:
        return f"| {row.name} | | | | {row.why.partition(chr(10))[0]} |"
    ratio = "" if row.ratio is None else f"{row.ratio:.2f}"
    return f"| {row.name} | {row.python_s:.2f} | {row.robot_s:.2f} | {ratio} | {'' if ratio else 'too short'} |"
