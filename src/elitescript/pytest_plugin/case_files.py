"""Cases of sweeps as tests: each passes once the property holds that failed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from elitescript.errors import ElitescriptError, ProgramError
from elitescript.shown import continued, shown_word
from elitescript.sweep.replay import Played, Replay


class CaseFile(pytest.File):
    """A case: a run that failed in a sweep."""

    def collect(self) -> Iterator[CaseTest]:
        yield CaseTest.from_parent(self, name="case")


class CaseTest(pytest.Item):
    """The run of a case."""

    def __init__(self, **more: Any) -> None:
        super().__init__(**more)
        self.funcargs: dict[str, Any] = {}
        """Of no fixture; plugins look for it."""
        self.shows_programs = True
        """Whether reports are texts of programs; the plugin looks for it."""

    def runtest(self) -> None:
        """Play the run again."""
        replay = Replay(self.path)
        played = replay.play()
        if played.row.failure is not None:
            raise CaseFailure(replay, played)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """Return what the report shows: the story of the run."""
        error = excinfo.value
        if isinstance(error, CaseFailure):
            return error.report()
        if isinstance(error, ProgramError):
            return "\n".join(continued(str(problem)) for problem in error.problems)
        if isinstance(error, ElitescriptError):
            return continued(str(error))
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Any, int, str]:
        return shown_word(str(self.path)), 0, f"case {shown_word(self.path.name)}"


class CaseFailure(Exception):
    """The property of a case does not hold.

    Args:
        replay: of the case.
        played: what came of it.
    """

    def __init__(self, replay: Replay, played: Played) -> None:
        super().__init__(played.words)
        self.replay = replay
        self.played = played

    def report(self) -> str:
        """Return the story, and whether the failure is the same."""
        lines = [] if self.played.story is None else list(self.played.story.lines)
        lines += [self.replay.note] if self.replay.note else []
        return "\n".join(map(continued, [*lines, f"E   {self.played.words}"]))
