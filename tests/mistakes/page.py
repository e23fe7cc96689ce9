"""Writes docs/explanation/mistakes.md: which kinds of mistakes are told by `check`, by a run, or not at all."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from elitescript.errors import CODES
from tests.mistakes.judging import ARRIVES, AT, Told
from tests.mistakes.kinds import arguments, names, order, units, values  # noqa: F401  (registers the kinds)
from tests.mistakes.planting import KINDS, Mistake
from tests.mistakes.told_cases import CASES, Case

PAGE: Final = Path(__file__).resolve().parents[2] / "docs" / "explanation" / "mistakes.md"
COUNT: Final = 500
SEED: Final = 1
_ROW = re.compile(r"^\| (.+) \| (\d+) \| (\d+) \| (\d+) \| (\d+) \| (\d+) \|$", re.MULTILINE)

_HEAD: Final = """\
# Which mistakes are told

<!-- Written by `make mistakes`; do not edit. -->

Two measurements say which mistakes in programs are told: a tool plants mistakes into sound programs, and there are
programs that hold what people report. `make mistakes` makes both and writes this page; `make test`
plants fewer, and runs all the programs.

## Planted mistakes

{planted} single mistakes were planted into {programs} sound programs: the examples, those of the specification, and
some with devices that were written for it ([tests/mistakes](../../tests/mistakes/planting.py)). Places are drawn by
a seed, kinds take turns, and only lines that the program really runs get one. Each program is checked, and run in
its world for the time that the sound one takes and {further} s more.

**{told} of {planted} are told ({percent:.1f} %)**: {by_check} by `check`, {by_run_alone} by the run alone. {silent}
are not told. Of {wrong}, all that is said is about another line. Of those that are not told, {silent_same} made no
difference in their run: the same events, moves, times and values. {left_out} changes were left out before anything
was run, because the text that they gave means the same to the language.

What counts: an error, a warning or a note that the sound program does not have, an alarm, or the sentence that says
why the program does not go on where that says more than that time goes by. It is told at the right place if it
stands in the line of the mistake (of a step that is missing, also in the head of the loop that misses it), names
that line, names what was changed (the variable, channel, signal or function), or stands in a line that has that
name: {at}. It also counts where the planted value arrives through variables, arguments and results: {arrives}.
Anything else is another line.

| kind | planted | `check` | run alone | not told | another line |
|---|---|---|---|---|---|
"""

_CASES: Final = """
## Programs that hold what people report

The pages in `tests/mistakes/cases` are {count} programs with mistakes from
forums and issues, written anew, and some of the same kinds. What `check` and the run say, with code and line, is in
the programs, and must be that and nothing else. {sound} right ones stand beside them, in which nothing is found.

| program | `check` | run |
|---|---|---|
"""


@dataclass(frozen=True, slots=True)
class Result:
    """What came of the planted mistakes.

    Attributes:
        rows: planted, by check, by the run alone, not told and told elsewhere, by kind.
        programs: sound programs.
        left_out: changes that make no difference to the language.
        silent_same: mistakes that are not told and made no difference in their run.
        at, arrives: mistakes that are told at their place, and where their value arrives.
    """

    rows: dict[str, tuple[int, int, int, int, int]]
    programs: int
    left_out: int
    silent_same: int
    at: int
    arrives: int

    @classmethod
    def of(cls, judged: list[tuple[Mistake, Told]], programs: int, left_out: int) -> Result:
        """Count what was judged."""
        rows: dict[str, Counter[str]] = {}
        best: Counter[str] = Counter()
        silent_same = 0
        for mistake, told in judged:
            count = rows.setdefault(mistake.kind, Counter())
            is_by_check = told.by_check in (AT, ARRIVES)
            count["planted"] += 1
            count["check"] += is_by_check
            count["run"] += told.is_told and not is_by_check
            count["silent"] += not told.is_told and not told.is_wrong
            count["wrong"] += told.is_wrong
            if told.is_told:
                best[AT if AT in (told.by_check, told.by_run) else ARRIVES] += 1
            silent_same += not told.is_told and told.is_same
        columns = ("planted", "check", "run", "silent", "wrong")
        table = {kind.name: tuple(rows[kind.name][column] for column in columns) for kind in KINDS if kind.name in rows}
        return cls(table, programs, left_out, silent_same, best[AT], best[ARRIVES])  # type: ignore[arg-type]

    def total(self, column: int) -> int:
        """Return the sum of a column."""
        return sum(row[column] for row in self.rows.values())

    @property
    def told(self) -> int:
        """How many are told at the right place."""
        return self.total(1) + self.total(2)

    @property
    def summary(self) -> str:
        """The sums in a line."""
        planted, check, run, silent, wrong = (self.total(column) for column in range(5))
        share = 100 * self.told / max(1, planted)
        return (
            f"{self.told} of {planted} told ({share:.1f} %): {check} by check, {run} by the run alone; "
            f"{silent} not told, {wrong} at another line; of these {self.silent_same} ran as the sound one"
        )


def page(result: Result) -> str:
    """Return the page."""
    from tests.mistakes.judging import FURTHER_S

    planted = result.total(0)
    text = _HEAD.format(
        planted=planted,
        programs=result.programs,
        further=f"{FURTHER_S:g}",
        told=result.told,
        percent=100 * result.told / planted,
        by_check=result.total(1),
        by_run_alone=result.total(2),
        silent=result.total(3),
        wrong=result.total(4),
        silent_same=result.silent_same,
        left_out=result.left_out,
        at=result.at,
        arrives=result.arrives,
    )
    groups: dict[str, list[str]] = {}
    for kind in KINDS:
        groups.setdefault(kind.group, []).append(kind.name)
    for group, kinds in groups.items():
        text += f"| **{group}** | | | | | |\n"
        for name in kinds:
            if name in result.rows:
                text += f"| {name} | {' | '.join(map(str, result.rows[name]))} |\n"
    return text + cases_table()


def cases_table() -> str:
    """Return the table of programs that hold what people report."""
    wrong = [case for case in CASES if not case.is_sound]
    text = _CASES.format(count=len(wrong), sound=len(CASES) - len(wrong))
    for case in wrong:
        text += f"| {case.page}: {case.title} | {_found(case.check)} | {_by_run(case)} |\n"
    return text


def _found(rows: tuple[tuple[int, str], ...]) -> str:
    codes = Counter(code for _, code in rows)
    shown = [f"[{code}](../reference/rules.md)" if code in CODES else "a warning" for code in codes]
    return ", ".join(
        f"{code}" if codes[raw] == 1 else f"{code} {codes[raw]} times" for code, raw in zip(shown, codes, strict=True)
    )


def _by_run(case: Case) -> str:
    words = [_found(case.run)] if case.run else []
    if case.why:
        words.append("why it does not go on")
    return ", ".join(words)


def rows_of(text: str) -> dict[str, tuple[int, ...]]:
    """Return the rows of kinds of a page."""
    return {name: tuple(map(int, numbers)) for name, *numbers in _ROW.findall(text)}
