"""`--case`: plays a run again that failed in a sweep."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, Final

from elitescript.codec.json_text import to_text
from elitescript.errors import UsageError
from elitescript.kernel.options import OPTIONS
from elitescript.records import NamedTuple
from elitescript.shown import shown
from elitescript.sweep.failures.shrinking import is_same
from elitescript.sweep.replay import Played, Replay

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

_OF_CASES: Final = {
    "world": "--world",
    "task_dir": "--task-dir",
    "until": "--until",
    "set": "--set",
    "serial": "--serial",
    "state": "--state",
    "max_wall": "--max-wall",
    "realtime": "--realtime",
    "compare": "--compare",
    "compare_robot": "--compare-robot",
    "compare_world": "--compare-world",
}
"""Options that a case has itself, or that make no sense for it."""


def replay_of(options: argparse.Namespace) -> Replay:
    """Return the case of the command line.

    Raises:
        UsageError: it makes no sense, or an option is given that a case has itself.
        ProgramError: the program does not compile.
    """
    given = [OPTIONS[name].flag for name in OPTIONS if OPTIONS[name].flag and name in options]
    given += [flag for name, flag in _OF_CASES.items() if getattr(options, name, None) not in (None, [], False)]
    if given:
        raise UsageError(f"{given[0]} does not go with --case: what the case says holds; edit {options.case}")
    replay = Replay(Path(options.case), options.file)
    if replay.note:
        print(f"elitescript {options.command}: note: {shown(replay.note)}", file=sys.stderr)
    return replay


class CaseReport(NamedTuple):
    """Says whether the failure of a case came again."""

    replay: Replay
    played: Played

    def lines(self) -> list[str]:
        """Return it for people."""
        story = [] if self.played.story is None else list(self.played.story.lines)
        words = self.played.words
        return [*story, f"{words[:1].upper()}{words[1:]}."]

    def text(self) -> str:
        """Return it as a line of JSON."""
        expected, found = self.replay.case.failure, self.played.row.failure
        data: dict[str, Any] = {
            "type": "case",
            "property": expected.expression,
            "came_again": found is not None,
            "same": is_same(found, expected),
            "text": self.played.words,
            "changed": bool(self.replay.note),
            "story": None if self.played.story is None else self.played.story.data(),
        }
        return to_text(data)
