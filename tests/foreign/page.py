"""Writes docs/explanation/as-python-is.md: what came of CPython's own tests, by group and cause."""

from __future__ import annotations

import platform
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from tests.foreign.comparing import IS_DIFFERENT, Cause, Verdict
from tests.foreign.known import Known
from tests.foreign.slicing import Case
from tests.foreign.sources import GROUPS

PAGE: Final = Path(__file__).resolve().parents[2] / "docs" / "explanation" / "as-python-is.md"


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
    def summary(self) -> str:
        """One line."""
        total = self.total
        different = sum(total[cause] for cause in IS_DIFFERENT)
        return (
            f"{total.total()} tests: {total[Cause.SAME]} passed with the same operands, {different} differ, of which"
            f" {sum(count for _, count in self.known)} are known."
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
    rows = [*result.counts.items(), ("**all**", result.total)]
    for group, counts in rows:
        if counts.total():
            lines.append(f"| {group} | {counts.total()} | {' | '.join(str(counts[cause]) for cause in causes)} |")
    return "\n".join(lines)


def page(result: Result) -> str:
    return table(result) + platform.python_version()
