"""Runs a command again whenever one of its files has changed, for `--watch`.

Files are looked at again and again: that works on every file system, and needs no package. A file is what its path
leads to, so an editor that saves by renaming a new file over the old one has changed it, as one that writes into it.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Final, Protocol

from elitescript.shown import shown_word

POLL_S: Final = 0.2
"""Time between two looks."""
POLL_SHARE: Final = 10.0
"""It is at least so many times as long as a look takes, so that a large folder costs a tenth of a core at most."""
QUIET_S: Final = 0.1
"""A change is over when nothing has changed for so long: editors write in several steps, and save several files."""
MISSING_S: Final = 2.0
"""A file that has gone is waited for so long before its absence is a change."""
STOP_S: Final = 5.0
"""Time of a command to end before it is killed."""
PATIENCE_S: Final = 1.0
"""After Ctrl-C, which the command has got as well: the time before it is asked to end."""
NAMES_SHOWN: Final = 3
ROUNDS_MAX: Final = 3
"""A file that changes in so many rounds one after the other, while the command runs, is written by the command."""

ENDED_WITH_READER: Final = (141, -13)
"""Exit codes of a command whose standard output is no longer read."""

State = tuple[int, int, int] | None
"""Time of the last change, size and number of a file; None if there is none."""


class Process(Protocol):
    """A command that runs."""

    def poll(self) -> int | None:
        """Return its exit code; None while it runs."""

    def wait(self, timeout: float | None = None) -> int:
        """Wait for its end; return its exit code."""

    def terminate(self) -> None:
        """Ask it to end."""

    def kill(self) -> None:
        """End it."""


def state_of(path: Path) -> State:
    """Return the state of a file."""
    try:
        found = path.stat()
    except (OSError, ValueError):
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino


class Rounds:
    """Runs a command, waits for a change of its files, and runs it again, until a signal or its reader ends it.

    Args:
        start: starts the command.
        files: returns the files that it reads, each with whether the command may write it too: such a file counts
            when the command has ended, any other one also while it runs. Called before each round and look.
        name: of the command, for messages.
        is_ended_by_change: end a command that runs when a file has changed; else it goes on to its end.
        pause: waits for so many seconds.
    """

    __slots__ = ("_files", "_is_ended_by_change", "_meanwhile", "_name", "_pause", "_start")

    def __init__(
        self,
        start: Callable[[], Process],
        files: Callable[[], Mapping[Path, bool]],
        name: str,
        *,
        is_ended_by_change: bool = True,
        pause: Callable[[float], None] = time.sleep,
    ) -> None:
        self._start = start
        self._files = files
        self._name = name
        self._is_ended_by_change = is_ended_by_change
        self._pause = pause
        self._meanwhile: dict[Path, int] = {}
        """Files that have changed while the command ran, and in how many rounds one after the other."""

    def run(self) -> int:
        """Run the rounds; return the exit code of a command whose reader has gone.

        Raises:
            KeyboardInterrupt: a signal to stop has come; the command has ended.
        """
        while True:
            before = self._look()
            process = self._start()
            try:
                code = self._wait(process, before)
            except KeyboardInterrupt:
                _end(process, PATIENCE_S)
                raise
            if code in ENDED_WITH_READER:
                return ENDED_WITH_READER[0]
            after = self._look()
            if code is None:
                _end(process)
                changed = _changed(before, after)
            elif not (changed := self._changed_meanwhile(before, after)):
                count = len(after)
                files = "1 file" if count == 1 else f"{count} files"
                self._say(f"exit code {code}; a change of {files} runs it again, Ctrl-C ends it")
                changed = self._wait_for_change(after)
            names = [shown_word(path.name) for path in changed[:NAMES_SHOWN]]
            more = f" and {len(changed) - NAMES_SHOWN} more" if len(changed) > NAMES_SHOWN else ""
            clear()
            self._say(f"{', '.join(names)}{more} changed")

    def _wait(self, process: Process, before: Mapping[Path, State]) -> int | None:
        """Wait for the end of the command; None if a file that it only reads has changed, and that is over."""
        while True:
            code = process.poll()
            if code is not None:
                return code
            self._pause(POLL_S)
            if self._is_ended_by_change and process.poll() is None:
                files = self._files()
                if any(
                    path in before and state_of(path) != before[path]
                    for path, is_written in files.items()
                    if not is_written
                ):
                    self._settle(before)
                    return None

    def _changed_meanwhile(self, before: Mapping[Path, State], after: Mapping[Path, State]) -> list[Path]:
        """Return what has changed while the command ran, but for what it writes itself."""
        files = self._files()
        found = [path for path in _changed(before, after) if not files.get(path, False)]
        self._meanwhile = {path: self._meanwhile.get(path, 0) + 1 for path in found}
        own = [path for path in found if self._meanwhile[path] >= ROUNDS_MAX]
        if own:
            self._say(f"{', '.join(shown_word(path.name) for path in own)}: the command itself changes it")
        return [path for path in found if path not in own]

    def _wait_for_change(self, after: Mapping[Path, State]) -> list[Path]:
        """Wait until files are others than they were, and the change is over; return which."""
        while True:
            begin_s = time.monotonic()
            now = self._look()
            if now != after:
                changed = _changed(after, self._settle(after))
                if changed:
                    self._meanwhile = {}
                    return changed
                continue
            self._pause(max(POLL_S, POLL_SHARE * (time.monotonic() - begin_s)))

    def _settle(self, before: Mapping[Path, State]) -> Mapping[Path, State]:
        """Wait until nothing changes any more, and what was there is there again; return the states."""
        now, waited_s = self._look(), 0.0
        while True:
            self._pause(QUIET_S)
            waited_s += QUIET_S
            last, now = now, self._look()
            is_missing = any(state is not None and now.get(path) is None for path, state in before.items())
            if now == last and (not is_missing or waited_s >= MISSING_S):
                return now

    def _look(self) -> dict[Path, State]:
        return {path: state_of(path) for path in self._files()}

    def _say(self, text: str) -> None:
        with suppress(OSError):
            print(f"{self._name}: {text}", file=sys.stderr, flush=True)


def _changed(before: Mapping[Path, State], after: Mapping[Path, State]) -> list[Path]:
    """Return the files that are others, have come or have gone."""
    return [path for path in {**before, **after} if before.get(path) != after.get(path)]


def _end(process: Process, patience_s: float = 0.0) -> None:
    """End a command: it may end alone first, then it is asked to, then it is killed."""
    # Only a subprocess has a time-out of this type.
    from subprocess import TimeoutExpired

    for ask, wait_s in ((None, patience_s), (process.terminate, STOP_S), (process.kill, STOP_S)):
        if process.poll() is not None:
            return
        if ask is not None:
            ask()
        with suppress(TimeoutExpired):
            process.wait(wait_s)


def clear() -> None:
    """Clear the screen, if standard output and standard error are a terminal that can."""
    if sys.stdout.isatty() and sys.stderr.isatty() and os.environ.get("TERM", "dumb") != "dumb":
        print("\x1b[H\x1b[2J", end="", flush=True)


def files_below(
    folders: Iterable[Path], is_wanted: Callable[[str], bool], is_left_out: Callable[[str], bool]
) -> Iterator[Path]:
    """Yield the files below folders, links to folders left out.

    Args:
        folders: where to look.
        is_wanted: whether a file of this name counts.
        is_left_out: whether a folder of this name is not looked into; one that begins with `.` never is.
    """
    for folder in folders:
        for home, inner, names in os.walk(folder):
            inner[:] = [name for name in inner if not name.startswith(".") and not is_left_out(name)]
            yield from (Path(home, name) for name in names if is_wanted(name))
