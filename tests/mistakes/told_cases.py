"""Programs with mistakes that people make: the pages in `cases`, read and run."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from elitescript import VirtualRobot
from elitescript.language.text.source import SourceFile
from tests.mistakes.judging import TICKS_MAX

PAGES: Final = Path(__file__).resolve().parent / "cases"
UNTIL_S: Final = 10.0
_HEADING = re.compile(r"^## (.*)$", re.MULTILINE)
_BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_CODE = re.compile(r"[EWNR]\d{3}")
NO_CODE: Final = "text"
"""Mark of a warning that has no code."""

Found = tuple[tuple[int, str], ...]
"""Lines and codes, in order."""


@dataclass(frozen=True, slots=True)
class Case:
    """A program with a mistake.

    Attributes:
        page, title: where it stands.
        text: the program.
        world: text of its world file; empty for none.
        check, run: what must be found, by `check`, and by the run alone.
        end: how the run must end.
        why: texts that the reason must have.
        is_silent: nothing is told.
        is_sound: it has no mistake, the right sibling of the one before.
    """

    page: str
    title: str
    text: str
    world: str
    check: Found
    run: Found
    end: str
    why: tuple[str, ...]
    is_silent: bool
    is_sound: bool


@dataclass(frozen=True, slots=True)
class Outcome:
    """What was told of a case."""

    check: Found
    run: Found
    state: str
    why: str


def read(path: Path) -> list[Case]:
    """Return the cases of a page."""
    parts = _HEADING.split(path.read_text(encoding="utf-8"))[1:]
    cases = []
    for title, body in zip(parts[::2], parts[1::2], strict=True):
        blocks = dict(_BLOCK.findall(body))
        text = blocks["elite"]
        marks = [
            (number, mark.strip())
            for number, line in enumerate(text.splitlines(), 1)
            for mark in line.partition("#:")[2].split(", ")
            if mark.strip()
        ]
        check = tuple(sorted((number, mark) for number, mark in marks if _CODE.fullmatch(mark)))
        run = [(number, mark.removeprefix("run ")) for number, mark in marks if mark.startswith("run ")]
        ends = [mark.removeprefix("end ") for _, mark in marks if mark.startswith("end ")]
        why = tuple(line.partition("#: why ")[2].strip() for line in text.splitlines() if "#: why " in line)
        is_silent = any(mark == "nothing" for _, mark in marks)
        is_sound = any(mark == "sound" for _, mark in marks)
        world = blocks.get("world", "")
        cases.append(
            Case(
                path.stem,
                title,
                text,
                world,
                check,
                tuple(sorted(run)),
                (*ends, "finished")[0],
                why,
                is_silent,
                is_sound,
            )
        )
    return cases


CASES: Final = tuple(case for path in sorted(PAGES.glob("*.md")) if path.stem != "README" for case in read(path))


def outcome(case: Case, folder: Path) -> Outcome:
    """Check and run a case; its world file is written into a folder."""
    world = None
    if case.world:
        world = folder / "world.toml"
        world.write_text(case.world, encoding="utf-8")
    robot = VirtualRobot(None if world else "CS66", world=world, task_dir={})
    ticks = 0

    def watch(tick: int) -> None:
        nonlocal ticks
        ticks += 1
        if ticks > TICKS_MAX:
            robot.interrupt("time_limit")

    run = robot.run(robot.compile(SourceFile("<case>", case.text)), until_s=UNTIL_S, watch=watch)
    check = {(row.line or 1, row.code) for row in run.findings if row.source == "check"}
    found = {(row.line or 1, row.code or NO_CODE) for row in run.findings.of_run} - check
    return Outcome(tuple(sorted(check)), tuple(sorted(found)), run.state, run.why or "")
