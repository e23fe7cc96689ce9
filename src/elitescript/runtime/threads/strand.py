"""Runs one script thread as a greenlet.

A strand keeps its whole stack while it waits, so a wait can happen anywhere, also inside `sorted(key=...)`, a property
or a `with` statement. Strands of one scheduler belong to one thread of the operating system and are suspended only by
their own calls.
"""

from __future__ import annotations

import sys
from bisect import bisect_right
from collections.abc import Callable, Iterator
from types import CodeType, FrameType
from typing import Any, Final

from greenlet import GreenletExit, getcurrent, greenlet  # type: ignore[import-untyped]

from elitescript.language.modules import COPIED
from elitescript.messages.timing import seconds
from elitescript.records import NamedTuple
from elitescript.said import Said, said

READY: Final = "ready"
WAITING: Final = "waiting"
ENDED: Final = "ended"

CLEANUP_WORK: Final = 1000
"""Most checkpoints in the `finally` blocks of a stopped thread."""

SCRIPT_DEPTH: Final = 1000
"""Most nested calls of a script thread, a few of the runtime included; CPython's default."""

REFUSALS_MAX: Final = 10_000
"""How often a thread may swallow its stop before it is given up; a deep recursion swallows it once per level."""

SITES_MAX: Final = 1000
"""Most places of a thread whose lines are kept."""

SHORT_TABLE: Final = 500
"""Bytes of the line table of a code that Python searches at once: some hundred lines."""
TABLES_MAX: Final = 64
"""Most codes of which a table is kept."""

_CONTEXTS_MAX: Final = 64
"""Most chained exceptions that are searched for a stop."""

TIME_TO_GO_BY: Final = "time to go by"
"""Reason of the wait in `sleep` and similar commands."""

STOP: Final = GreenletExit
"""Base of `Stopped`; a forgotten strand gets it when it is collected."""

UNCATCHABLE: Final = (GreenletExit, KeyboardInterrupt)
"""Exceptions that no `try` of a script catches: the end of a strand, and the user's interrupt."""

INNER_TEXTS: Final = ("<eval", "<exec", "<interpreter")
"""Prefixes of file names of texts that a program makes while it runs; places refer to its own text."""


class Stopped(GreenletExit):  # type: ignore[misc]
    """Ends a script thread from where it stands; a `BaseException`, so that `except Exception` lets it pass."""


class LineTables:
    """Finds the lines of frames.

    `frame.f_lineno` goes through the line table of a code from its begin, so each line of a straight program would
    cost what all lines before it cost. Of a long code the table is read once.
    """

    __slots__ = ("_tables",)

    def __init__(self) -> None:
        self._tables: dict[int, tuple[CodeType, list[int], list[int]]] = {}
        """By `id` of the code: the code, so that no other one can have that, first instructions, and their lines."""

    def line_of(self, frame: FrameType) -> int:
        """Return the line that a frame is in; 0 if it has none."""
        code, instruction = frame.f_code, frame.f_lasti
        if len(code.co_linetable) <= SHORT_TABLE or instruction < 0:
            return frame.f_lineno or 0
        table = self._tables.get(id(code))
        if table is None:
            if len(self._tables) >= TABLES_MAX:
                self._tables.clear()
            table = self._tables[id(code)] = code, *_table_of(code)
        _, starts, lines = table
        return lines[bisect_right(starts, instruction) - 1]


def _table_of(code: CodeType) -> tuple[list[int], list[int]]:
    """Return where the instructions of each line begin, and the lines; 0 for those of none."""
    starts, lines = [0], [0]
    for start, _, line in code.co_lines():
        if line != lines[-1]:
            starts.append(start)
            lines.append(line or 0)
    return starts, lines


class Strand:
    """A script thread.

    Args:
        order: place in the order of start, from 0.
        name: for messages.
        body: runs in the thread; must not raise, except to reach the caller of `resume`.
        builtins: built-ins of its script code; a frame with others is not script code.
        is_secondary: whether it is a secondary program.
        tables: tables of lines, which the strands of a scheduler share.
        until_tick: when a secondary program is ended; None of others.

    Attributes:
        line_of: returns the line that a frame of any code is in; 0 if it has none.
        handle: positive number for scripts, unique for each strand.
        resume: runs it until it suspends itself or ends. Not called inside a strand of the same scheduler.
        suspend: returns to the caller of `resume` until it is resumed. Called inside the strand only.
        state: `READY`, `WAITING` or `ENDED`.
        work: checkpoints counted in the tick `work_tick`.
        waits_for: reason of its wait; empty while it does not wait.
        until: tick of the timeout of its wait; None without one.
        ticket: number of its present wait; a timer with another number is stale.
        was_woken: whether the last wait ended by a wake-up and not by its timeout.
        is_dying: whether it was stopped, and unwinds or will.
        is_abandoned: whether it could not be stopped and never runs again.
        cancel: cancels what it waits for when it is stopped (brakes a move).
        loops: tick in which it has come to each loop in which it may wait, by line.
        started_line: line of the call that started it; 0 for a program.
        portion: checkpoints that it is paid out at a time where a meter looks in between.
        ran_tick: the last in which it came past a checkpoint, or a call where a meter looks.
        owed: locks that it has pretended to take while dying, and how often.
        at_end: called once when it has ended.
        recursion_limit: the interpreter's limit while it runs; 0 before it has begun.
    """

    __slots__ = (
        "_body",
        "_builtins",
        "_greenlet",
        "_line",
        "_line_activation",
        "_sites",
        "activations",
        "at_end",
        "cancel",
        "cleanup_left",
        "handle",
        "is_abandoned",
        "is_dying",
        "is_secondary",
        "line_of",
        "loops",
        "name",
        "order",
        "owed",
        "portion",
        "ran_tick",
        "recursion_limit",
        "refusals",
        "resume",
        "started_line",
        "state",
        "suspend",
        "ticket",
        "until",
        "until_tick",
        "waits_for",
        "was_woken",
        "work",
        "work_tick",
    )

    def __init__(
        self,
        order: int,
        name: str,
        body: Callable[[], None],
        builtins: dict[str, Any],
        *,
        is_secondary: bool = False,
        tables: LineTables | None = None,
    ) -> None:
        self.line_of = (tables or LineTables()).line_of
        self.order = order
        self.handle = ((order + 1) * 2_654_435_761) & 0x7FFF_FFFF
        self.name = name
        self.is_secondary = is_secondary
        self.until_tick: int | None = None
        self._body = body
        self._builtins = builtins
        self._greenlet: greenlet | None = None
        self.resume: Callable[[], Any] = self._begin
        self.suspend: Callable[[], Any] = _not_begun
        self.state = READY
        self.work = 0
        self.portion = 1
        self.ran_tick = -1
        self.work_tick = -1
        self.waits_for = ""
        self.until: int | None = None
        self.ticket = 0
        self.was_woken = False
        self.is_dying = False
        self.is_abandoned = False
        self.cleanup_left = CLEANUP_WORK
        self.refusals = 0
        self.cancel: Callable[[], None] | None = None
        self.owed: dict[object, int] = {}
        self.at_end: list[Callable[[], None]] = []
        self.activations = 0
        self.loops: dict[int, int] = {}
        self.started_line = 0
        self.recursion_limit = 0
        self._line = 0
        self._line_activation = -1
        self._sites: dict[tuple[int, int], tuple[CodeType, int]] = {}
        """Line of each place from which `line_behind` was called: by code, as its `id`, and instruction."""

    def _begin(self) -> None:
        # A stack begins to count its depth where it is begun from, and that differs from process to process.
        self.recursion_limit = _depth() + SCRIPT_DEPTH
        sys.setrecursionlimit(self.recursion_limit)
        self._greenlet = greenlet(self._body)
        self.resume = self._greenlet.switch
        # Not a method of ours: a call in Python could fail at the recursion limit, half way into a wait.
        self.suspend = self._greenlet.parent.switch
        self.resume()

    @property
    def is_started(self) -> bool:
        """Whether it has run at all."""
        return self._greenlet is not None

    @property
    def is_finished(self) -> bool:
        """Whether its body has returned."""
        return self._greenlet is not None and self._greenlet.dead

    @property
    def is_running(self) -> bool:
        """Whether the caller runs in this strand."""
        return self._greenlet is getcurrent()

    def abandon(self) -> None:
        """Give it up: it can neither run nor be stopped, and its stack is kept."""
        self.is_abandoned = True
        _abandoned.append(self._greenlet)

    def forget(self) -> None:
        """Drop its stack; what its `finally` blocks ask for is refused, and it never runs again."""
        self.resume = self.suspend = _not_begun
        self._greenlet = None

    def spend_cleanup(self) -> None:
        """Count the work of `finally` blocks of a stopped thread; stop it again if it has swallowed the stop.

        Never returns after too many swallowed stops.

        Raises:
            Stopped: again.
        """
        if self.cleanup_left > 0 and is_unwinding():
            self.cleanup_left -= 1
            return
        self.refusals += 1
        if self.refusals > REFUSALS_MAX:
            self.give_up()
        raise Stopped

    def give_up(self) -> None:
        """Leave it where it stands, called inside it; never returns."""
        self.abandon()
        self.suspend()

    # ---------------------------------------------------------------- place

    @property
    def line(self) -> int:
        """Its innermost line of script text; 0 before it has begun and after its end."""
        if self._greenlet is None or self.state == ENDED:
            return 0
        if self._greenlet is getcurrent():
            return self.line_behind(1)
        if self._line_activation != self.activations:
            frame = self.script_frame()
            self._line = self.line_of(frame) if frame is not None else 0
            self._line_activation = self.activations
        return self._line

    def forget_line(self) -> None:
        """Find the line out again when it is next read: the thread was looked at in the middle of its turn."""
        self._line_activation = -1

    def line_behind(self, frames: int) -> int:
        """Return its innermost line of script text, called inside it.

        Args:
            frames: of the caller of this function and of its callers, that are known to be no script text.
        """
        caller = sys._getframe(frames + 1)
        site = self._sites.get((id(caller.f_code), caller.f_lasti))
        if site is not None and caller.f_builtins is self._builtins:
            return site[1]
        frame = self._script_frame(caller)
        line = self.line_of(frame) if frame is not None else 0
        if frame is caller and not caller.f_code.co_filename.startswith(INNER_TEXTS):
            if len(self._sites) >= SITES_MAX:
                self._sites.clear()
            # With its code, so that no other code can have its `id`.
            self._sites[id(caller.f_code), caller.f_lasti] = caller.f_code, line
        return line

    def script_frame(self) -> FrameType | None:
        """Return the innermost frame of the program's own text, or else of a text of `eval`."""
        return self._script_frame(self.top_frame())

    def _script_frame(self, frame: FrameType | None) -> FrameType | None:
        builtins = self._builtins
        inner = None
        while frame is not None:
            if frame.f_builtins is builtins:
                if not frame.f_code.co_filename.startswith(INNER_TEXTS):
                    return frame
                inner = inner or frame
            frame = frame.f_back
        return inner

    def script_frames(self) -> Iterator[FrameType]:
        """Yield its frames of script text, the innermost one first; also while it waits or is frozen."""
        frame, builtins = self.top_frame(), self._builtins
        while frame is not None:
            if frame.f_builtins is builtins:
                yield frame
            frame = frame.f_back

    def is_script_frame(self, frame: FrameType) -> bool:
        """Return whether a frame belongs to script text that it runs."""
        return frame.f_builtins is self._builtins

    def called_from_script(self) -> FrameType | None:
        """Return the frame that the innermost script frame has called; None if there is none."""
        called = None
        frame = self.top_frame()
        while frame is not None and frame.f_builtins is not self._builtins:
            called, frame = frame, frame.f_back
        return called

    def top_frame(self) -> FrameType | None:
        """Return its innermost frame of any code; None before it has begun and when it has ended."""
        if self._greenlet is None:
            return None
        return sys._getframe(1) if self._greenlet is getcurrent() else self._greenlet.gr_frame

    def __repr__(self) -> str:
        return f"<Strand {self.name} {self.state}>"


class Freezer:
    """Runs a function, with all strands that begin in it, that can be frozen from inside and goes on from outside.

    Nothing in it changes while it is frozen, also in the middle of a tick, and every stack can be read.

    Args:
        function: takes nothing.

    Attributes:
        freeze: `(value) -> answer`: freezes, from inside: `go_on` returns the value. What the next `go_on` is given is
            the answer. A function in C: it needs no more stack than any call.
        is_over: whether the function has returned.
    """

    __slots__ = ("_inner", "_limit", "freeze", "is_over")

    def __init__(self, function: Callable[[], Any]) -> None:
        self.freeze: Callable[[Any], Any] = getcurrent().switch
        self._inner = greenlet(function)
        self._limit = 0
        self.is_over = False

    def go_on(self, strand: Strand | None, answer: Any = None) -> Any:
        """Let it go on until it is frozen or over; return the value that it was frozen with, or the result.

        Args:
            strand: that was frozen; None for code that no strand runs, and for the first call.
            answer: what `freeze` returns inside.
        """
        outer = sys.getrecursionlimit()
        frozen = self._inner if strand is None else strand._greenlet
        assert frozen is not None
        if strand is not None:
            strand.forget_line()
        if self._limit:
            sys.setrecursionlimit(self._limit)
        try:
            value = frozen.switch(answer) if self._limit else frozen.switch()
        finally:
            self._limit = sys.getrecursionlimit()
            sys.setrecursionlimit(outer)
            self.is_over = self._inner.dead
        return value

    def drop(self) -> None:
        """Leave the function where it stands; strands that began in it are dropped by `Scheduler.forget`."""
        if self._limit and not self._inner.dead:
            self._inner.throw()


def _not_begun() -> None:
    raise RuntimeError("a strand that has not begun cannot be suspended")


def _depth() -> int:
    """Return the call depth of the calling function, as the interpreter counts."""
    try:
        sys.setrecursionlimit(1)
    except RecursionError as refusal:
        depth = [word for word in str(refusal).replace(":", " ").split() if word.isdigit()]
        return int(depth[-1])
    raise AssertionError("the recursion limit cannot be 1 inside a function")


def is_stop(error: BaseException | None) -> bool:
    """Return whether an exception ends a strand."""
    return isinstance(error, GreenletExit)


def is_unwinding() -> bool:
    """Return whether the caller runs in a `finally` block or an `__exit__` that a stop passes through."""
    error = sys.exception()
    for _ in range(_CONTEXTS_MAX):
        if error is None or isinstance(error, GreenletExit):
            return error is not None
        error = error.__context__
    return False


_abandoned: Final[list[greenlet | None]] = []
"""Stacks that swallow every stop; kept, because collecting one would run its code again."""


class ThreadState(NamedTuple):
    """Place and wait of a script thread."""

    name: str
    line: int
    waits_for: str
    """Reason of its wait; empty while it runs."""
    because: str = ""
    """Why it does not go on; empty if that was not asked for, or is not known."""

    @property
    def held(self) -> str:
        """What holds it, in words behind its name."""
        if self.because and (not self.waits_for or self.waits_for.startswith(TIME_TO_GO_BY)):
            return said("is held: {because}", because=self.because)
        words = said("waits for {waits_for}", waits_for=self.waits_for) if self.waits_for else Said("is held")
        return said("{words}: {because}", words=words, because=self.because) if self.because else words

    @property
    def doing(self) -> str:
        """State in words."""
        words = said("waiting for {waits_for}", waits_for=self.waits_for) if self.waits_for else "running"
        if not self.because:
            return words
        # That time goes by says nothing of why.
        is_time = not self.waits_for or self.waits_for.startswith(TIME_TO_GO_BY)
        return self.because if is_time else said("{words}: {because}", words=words, because=self.because)


def state_of(strand: Strand) -> ThreadState:
    """Return where a strand is and what it waits for."""
    return ThreadState(strand.name, strand.line, _wait_of(strand))


def _wait_of(strand: Strand) -> str:
    """Return what a strand waits for, with the call of the standard library in which it does."""
    reason = strand.waits_for
    if not reason:
        return ""
    if strand.until is not None:
        reason = said("{reason}, until {seconds:.3f} s", reason=reason, seconds=seconds(strand.until))
    frame = strand.called_from_script()
    if frame is not None and frame.f_globals.get("__name__") in COPIED:
        return said(
            "{reason} in {module}.{function}()",
            reason=reason,
            module=frame.f_globals["__name__"],
            function=frame.f_code.co_qualname,
        )
    return reason
