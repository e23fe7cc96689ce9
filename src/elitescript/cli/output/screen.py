"""Output for terminals: colours, and a status line that every printed line replaces.

Reports print as into a file. On a terminal the standard streams are wrapped while a command runs: the wrapper erases
the status line before anything is printed, and has the palette of reports.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from typing import Any, Final, TextIO

from elitescript.shown import printed, printed_json, shown, visible

TYPE_CHECKING = False
if TYPE_CHECKING:
    from elitescript.cli.output.writable import Writable
    from elitescript.language.diagnostics import Diagnostic
    from elitescript.language.text.source import SourceFile

COLORS: Final = ("auto", "always", "never")
"""Values of `--color`."""

FIRST_AFTER_S: Final = 1.0
"""Wall time after which a command has a status line."""

INTERVAL_S: Final = 0.1
"""Least wall time between two status lines."""

CALLS: Final = 8
"""Calls of `Progress` for each reading of the clock, so that most ticks cost a subtraction."""

ERASE: Final = "\r\x1b[2K"

_CODES: Final = {
    "alarm": "1;31",
    "error": "1;31",
    "warning": "33",
    "note": "36",
    "finished": "32",
    "caret": "1;31",
    "hint": "36",
    "place": "1",
    "status": "2",
}


class Palette:
    """Paints texts by their role.

    Args:
        is_colored: whether there are colours; without, texts stay as they are.
    """

    __slots__ = ("is_colored",)

    def __init__(self, is_colored: bool) -> None:
        self.is_colored = is_colored

    def paint(self, role: str, text: str) -> str:
        """Colour a text by its role: `alarm`, `error`, `warning`, `finished`, `caret`, `hint`, `place`."""
        return f"\x1b[{_CODES[role]}m{text}\x1b[0m" if self.is_colored and text else text


PLAIN: Final = Palette(False)

TEXT: Final = "text"
JSON: Final = "json"
GITHUB: Final = "github"
"""What a command writes to standard output: text, JSON, workflow commands of GitHub."""

_MADE: Final[Mapping[str, Callable[[str], str]]] = {JSON: printed_json, GITHUB: visible}


def palette_of(stream: object) -> Palette:
    """Return the palette of a stream; without colours unless `on_screen` has wrapped it."""
    return stream.palette if isinstance(stream, ScreenStream) else PLAIN


def rendered(problem: Diagnostic, source: SourceFile | None, palette: Palette) -> str:
    """Return a finding as text: severity, code, caret and hint in colours."""
    # Imported late: every command has this module, and few have findings.
    from elitescript.language.diagnostics import render

    if source is None:
        text = shown(str(problem))
    else:
        text = render(problem, source.where(problem.line, problem.column), source.line(problem.line))
    if not palette.is_colored:
        return text
    rows = text.split("\n")
    role = str(problem.severity)
    label = f"{problem.severity} {problem.code}"
    place, found, rest = rows[0].partition(label)
    rows[0] = palette.paint("place", place) + palette.paint(role, found) + rest if found else rows[0]
    for index, row in enumerate(rows[1:], 1):
        if row.strip() and not row.strip("^ "):
            rows[index] = palette.paint("caret", row)
        elif row.startswith("hint: "):
            rows[index] = palette.paint("hint", row)
    return "\n".join(rows)


def shown_line_writer(stream: Writable) -> Callable[[str], object]:
    """Return what writes lines of a stream whose texts have been shown already: nothing looks at them once more."""
    return stream.write_shown if isinstance(stream, ScreenStream) else stream.write


class StatusLine:
    """The last line of a terminal, which shows the progress of a command until something is printed.

    Args:
        err: standard error, a terminal.
        palette: its colours.
    """

    __slots__ = ("_err", "_palette", "_shown", "is_at_line_start")

    def __init__(self, err: TextIO, palette: Palette) -> None:
        self._err = err
        self._palette = palette
        self._shown = ""
        self.is_at_line_start = True
        """Whether the last printed text ended with a line end; otherwise nothing is shown."""

    def show(self, text: str) -> None:
        """Replace the shown line."""
        if not self.is_at_line_start:
            return
        try:
            columns = os.get_terminal_size(self._err.fileno()).columns or 80
        except OSError:
            columns = 80
        # Some terminals wrap after a character in the last column.
        shown = "".join(letter if letter.isprintable() else "?" for letter in text)[: columns - 1]
        self._err.write(ERASE + self._palette.paint("status", shown))
        self._err.flush()
        self._shown = shown

    def erase(self) -> None:
        """Erase the shown line."""
        if self._shown:
            self._shown = ""
            self._err.write(ERASE)
            self._err.flush()


class ScreenStream:
    """A standard stream with a palette, which erases the status line before it writes.

    Args:
        target: the stream.
        palette: of reports.
        status: the line on the same terminal; None if there is none.
        made: makes of a text what is written.

    Attributes:
        write_shown: writes a line whose texts have been shown already.
    """

    def __init__(
        self,
        target: TextIO,
        palette: Palette,
        status: StatusLine | None,
        made: Callable[[str], str] = str,
    ) -> None:
        self._target = target
        self._made = made
        self.palette = palette
        self.status = status
        # Without a status line there is nothing to do before.
        self.write_shown: Callable[[str], int] = target.write if status is None else self._write

    def write(self, text: str) -> int:
        """Erase the status line, then write a text."""
        self._write(self._made(text))
        return len(text)

    def _write(self, text: str) -> int:
        if self.status is not None and text:
            self.status.erase()
            self.status.is_at_line_start = text.endswith("\n")
        return self._target.write(text)

    def flush(self) -> None:
        """Flush the stream."""
        self._target.flush()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._target, name)


@contextmanager
def on_screen(color: str, data: str = TEXT) -> Iterator[None]:
    """Wrap the standard streams while the body runs: nothing in what is printed acts; see `elitescript.shown`.

    Terminals get colours and a status line too.

    Args:
        color: of `COLORS`; `auto` means colours on a terminal that has them, unless `NO_COLOR` is set.
        data: what standard output gets: `TEXT`, `JSON` or `GITHUB`.
    """
    out, err = sys.stdout, sys.stderr
    palettes = [Palette(is_colored(color, stream, os.environ, os.name)) for stream in (out, err)]
    has_status = err.isatty() and understands_escapes(os.environ, os.name)
    status = StatusLine(err, palettes[1]) if has_status else None
    made = _MADE.get(data) or _printed_on(palettes[0])
    # A line printed into a file or a pipe does not touch the terminal.
    wrapped = (
        ScreenStream(out, palettes[0], status if out.isatty() else None, made),
        ScreenStream(err, palettes[1], status, _printed_on(palettes[1])),
    )
    sys.stdout, sys.stderr = wrapped
    try:
        yield
    finally:
        try:
            if status is not None:
                status.erase()
        finally:
            if (sys.stdout, sys.stderr) == wrapped:
                sys.stdout, sys.stderr = out, err


def _printed_on(palette: Palette) -> Callable[[str], str]:
    return partial(printed, has_colors=True) if palette.is_colored else printed


def is_colored(color: str, stream: TextIO, environment: Mapping[str, str], system: str) -> bool:
    """Return whether texts on a stream have colours.

    Args:
        color: of `COLORS`.
        stream: the target.
        environment: variables of the process.
        system: as `os.name`.
    """
    if color != "auto":
        return color == "always"
    return not environment.get("NO_COLOR") and stream.isatty() and understands_escapes(environment, system)


def understands_escapes(environment: Mapping[str, str], system: str) -> bool:
    """Return whether the terminal is known to support escape codes; an old Windows console would print them."""
    terminal = environment.get("TERM", "")
    if terminal == "dumb":
        return False
    if system == "nt":
        return bool(terminal or environment.get("WT_SESSION") or environment.get("ConEmuANSI") == "ON")
    return bool(terminal)


class Progress:
    """Shows robot time, line and speed of a long run in the status line.

    Args:
        status: the status line.
        start_s: robot time at the start, s.
    """

    __slots__ = ("_calls", "_next_s", "_robot_s", "_status", "_wall_s")

    def __init__(self, status: StatusLine, start_s: float = 0.0) -> None:
        self._status = status
        self._calls = CALLS
        self._wall_s = time.monotonic()
        self._next_s = self._wall_s + FIRST_AFTER_S
        self._robot_s = start_s

    def update(self, time_s: float, line: int) -> None:
        """Show the progress of a run, at most once per `INTERVAL_S`; cheap enough for every tick."""
        self._calls -= 1
        if self._calls > 0:
            return
        self._calls = CALLS
        now_s = time.monotonic()
        if now_s >= self._next_s:
            self._show(now_s, time_s, line)

    def _show(self, now_s: float, time_s: float, line: int) -> None:
        speed = (time_s - self._robot_s) / max(now_s - self._wall_s, 1e-9)
        if now_s - self._wall_s >= _WINDOW_S:
            # Half of the past counts on, so that the speed follows the recent one.
            self._wall_s += 0.5 * (now_s - self._wall_s)
            self._robot_s += 0.5 * (time_s - self._robot_s)
        where = f"line {line}" if line else "no program line"
        self._status.show(f"{time_s:10.3f} s  {where}  {_times(speed)} real time  (Ctrl-C ends it)")
        self._next_s = now_s + INTERVAL_S

    def note(self, text: str) -> None:
        """Show a text instead, at most once per `INTERVAL_S`."""
        now_s = time.monotonic()
        if now_s >= self._next_s:
            self._status.show(text)
            self._next_s = now_s + INTERVAL_S


_WINDOW_S: Final = 4.0
"""The speed is a mean over half of this at least, once a run has lasted so long."""


def status_of(stream: Writable) -> StatusLine | None:
    """Return the status line of a stream; None if it has none: no terminal, or a command that shows nothing."""
    return stream.status if isinstance(stream, ScreenStream) else None


def progress_on(stream: Writable, start_s: float = 0.0) -> Progress | None:
    """Return the progress display of a stream; None without a status line."""
    status = status_of(stream)
    return None if status is None else Progress(status, start_s)


def _times(speed: float) -> str:
    digits = f"{speed:,.0f}" if speed >= 10.0 else f"{speed:.2f}"
    return f"{digits} \N{MULTIPLICATION SIGN}"
