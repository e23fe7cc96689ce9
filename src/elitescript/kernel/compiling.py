"""Long texts of clients: compiled elsewhere, and begun in the tick in which they come back.

Compiling takes some 2 ms for each 1,000 bytes, all of it between two ticks. So a robot with
`RobotOptions.compiles_elsewhere` gives a text of `LONG_TEXT` characters or more away, to its `Workshop`, and goes on.
That the text has come back is an input, `Compiled`: the robot does the same whenever it gets the same inputs, wherever
and how fast the text was compiled. A replay compiles it here (`CompilesHere`).

Texts come back in the order in which they were given away. What ends or replaces a program that runs ends one that is
still being compiled, too.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from itertools import accumulate
from typing import Final, Protocol

from elitescript.commands.definition.plausibility import ArmFacts
from elitescript.errors import ProgramError
from elitescript.language.compiler import compile_unit
from elitescript.language.diagnostics import Diagnostic
from elitescript.language.limits import SymbolCount
from elitescript.language.options import LINE, SECONDARY, Options
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import CheckResult, compile_checked
from elitescript.lint.suppression import without_suppressed
from elitescript.messages.profile import Profile
from elitescript.messages.timing import TICKS_PER_S
from elitescript.records import NamedTuple, replace
from elitescript.said import said

TEXTS_MAX: Final = 4
"""Texts that may wait to come back."""
PROGRESS_TICKS: Final = 2 * TICKS_PER_S
"""After so long a line of the log says that a text is being compiled."""


class Job(NamedTuple):
    """A text to compile, with everything that the result depends on besides the options of the robot."""

    number: int
    name: str
    """Of the text, as places show it."""
    text: str
    kind: str | None
    """What the text must be, one of `language.options.KINDS`; None to determine it."""
    is_strict: bool
    probes: str
    first_probe: int
    """See `language.options.Options`."""
    presets: tuple[str, ...]
    """Names of globals that have a value before the program begins."""
    is_tree: bool = False
    """Whether the text is that of a graphical program with what stands beside it, as `tree_text` has it."""


def compiled_job(job: Job, profile: Profile, arm: ArmFacts, ignored: frozenset[str]) -> CheckResult:
    """Check and compile a text; a line is only compiled.

    Args:
        job: the text.
        profile: the firmware.
        arm: for which it is checked.
        ignored: codes of findings that are left out.
    """
    source = SourceFile(job.name, "" if job.is_tree else job.text)
    if job.is_tree:
        source, errors = source_of_tree(job.name, job.text)
        if errors:
            return CheckResult(None, errors, job.is_strict)
    options = Options(
        strict=job.is_strict, kind=job.kind, probes=job.probes, first_probe=job.first_probe, ignored=ignored
    )
    if job.kind != LINE:
        return compile_checked(source, profile, options, presets=job.presets, arm=arm)
    try:
        unit = compile_unit(source, options)
    except ProgramError as error:
        return CheckResult(None, error.problems, job.is_strict)
    return CheckResult(unit, tuple(without_suppressed(unit.diagnostics, source, ignored)), False)


def tree_text(files: Mapping[str, bytes]) -> str:
    """Return a graphical program and what stands beside it as one text.

    For each file it has a line with the numbers of characters of its name and of its text, then these. Bytes that are
    not UTF-8 are lone surrogates.
    """
    texts = {name: data.decode("utf-8", "surrogateescape") for name, data in files.items()}
    return "".join(f"{len(name)} {len(text)}\n{name}{text}" for name, text in texts.items())


def source_of_tree(name: str, text: str) -> tuple[SourceFile, tuple[Diagnostic, ...]]:
    """Return the script of a graphical program, and what keeps it from running, each with its node.

    Args:
        name: of the task.
        text: as `tree_text` has returned it.
    """
    # Imported late: few programs are graphical.
    from elitescript.environment.task_files import script_of_data

    files: dict[str, bytes] = {}
    at = 0
    while at < len(text):
        start = text.index("\n", at) + 1
        _, middle, end = accumulate(map(int, text[at:start].split()), initial=start)
        files[text[start:middle]] = text[middle:end].encode("utf-8", "surrogateescape")
        at = end
    source, errors = script_of_data(name, files.get)
    if not source.places:
        return source, errors
    return source, tuple(
        replace(error, text=said("{node}: {text}", node=source.line_words(error.line), text=error.text))
        for error in errors
    )


class Workshop(Protocol):
    """Where texts are compiled."""

    def begin(self, job: Job) -> None:
        """Take a text. `Compiled` with its number is an input of the robot later on."""

    def result(self, number: int) -> CheckResult | None:
        """Return what has come of a text, once; None if what came back was no result."""

    def drop(self, number: int) -> None:
        """Forget a text: its result is not wanted any more."""


class CompilesHere:
    """Compiles a text when it is asked for. Implements `Workshop`, for replays.

    Args:
        profile: the firmware.
        arm: for which programs are checked.
        ignored: codes of findings that are left out.
    """

    __slots__ = ("_arm", "_ignored", "_jobs", "_profile")

    def __init__(self, profile: Profile, arm: ArmFacts, ignored: frozenset[str]) -> None:
        self._profile = profile
        self._arm = arm
        self._ignored = ignored
        self._jobs: dict[int, Job] = {}

    def begin(self, job: Job) -> None:
        """Keep a text."""
        self._jobs[job.number] = job

    def result(self, number: int) -> CheckResult | None:
        """Compile a text."""
        return compiled_job(self._jobs.pop(number), self._profile, self._arm, self._ignored)

    def drop(self, number: int) -> None:
        """Forget a text."""
        self._jobs.pop(number, None)


class Waiting(NamedTuple):
    """A text that was given away and has not come back."""

    job: Job
    label: str
    """What messages call it."""
    tick: int
    """At which it was given away."""
    may_start: bool
    """Whether a program could start then."""
    take: Callable[[CheckResult | str], None]
    """Gets the result, or why there is none."""
    abandon: Callable[[str], None]
    """Called instead if the text is given up, with the reason."""
    symbols: SymbolCount
    """Of the text: one that has too many is refused before a compiler has started."""


class LongTexts:
    """Keeps account of the texts of one robot that are being compiled.

    Args:
        workshop: where that is done.
        tell: puts a line into the log of the robot; as a warning if its second argument is true.
    """

    __slots__ = ("_has_told", "_tell", "_waiting", "_workshop")

    def __init__(self, workshop: Workshop, tell: Callable[[str, bool], None]) -> None:
        self._workshop = workshop
        self._tell = tell
        self._waiting: deque[Waiting] = deque()
        self._has_told = -1
        """Number of the last text of whose progress the log has a line."""

    @property
    def is_waiting(self) -> bool:
        """Whether a text is being compiled."""
        return bool(self._waiting)

    @property
    def is_full(self) -> bool:
        """Whether no further text can be taken."""
        return len(self._waiting) >= TEXTS_MAX

    def put(self, waiting: Waiting) -> None:
        """Give a text away; there must be room."""
        self._waiting.append(waiting)
        self._workshop.begin(waiting.job)

    def come_back(self, number: int, failure: str) -> None:
        """Take a text that has come back; one that was given up meanwhile is passed over."""
        waiting = next((item for item in self._waiting if item.job.number == number), None)
        if waiting is None:
            return
        self._waiting.remove(waiting)
        if failure:
            self._workshop.drop(number)
            waiting.take(failure)
            return
        result = self._workshop.result(number)
        waiting.take("the process that compiles programs has given no program back" if result is None else result)

    def go_on(self, tick: int, may_start: bool) -> None:
        """Begin a tick: say that a text takes long, and give up what could start and may not any more."""
        if self._waiting and not may_start:
            self.give_up("the safety system has stopped the robot", lambda item: item.may_start)
        self._count()
        for item in self._waiting:
            if tick - item.tick >= PROGRESS_TICKS and item.job.number > self._has_told:
                self._has_told = item.job.number
                lines = item.job.text.count("\n") + (not item.job.is_tree)
                self._tell(f"{item.label} is being compiled: {lines:,} lines, {len(item.job.text):,} characters", False)

    def _count(self) -> None:
        """Count symbols for a part of a tick; refuse what has too many."""
        for item in self._waiting:
            if not item.symbols.is_over:
                item.symbols.go_on()
                if (problem := item.symbols.problem) is not None:
                    self._waiting.remove(item)
                    self._workshop.drop(item.job.number)
                    item.take(CheckResult(None, (problem,), item.job.is_strict))
                return

    def give_up(self, why: str, affects: Callable[[Waiting], bool] = lambda _: True) -> None:
        """Give up programs that are being compiled; secondary programs are left alone, as by what replaces one."""
        for item in tuple(self._waiting):
            if item.job.kind != SECONDARY and affects(item):
                self._forget(item, why)

    def give_up_all(self, why: str) -> None:
        """Give up everything that is being compiled."""
        for item in tuple(self._waiting):
            self._forget(item, why)

    def _forget(self, item: Waiting, why: str) -> None:
        self._waiting.remove(item)
        self._workshop.drop(item.job.number)
        self._tell(f"{item.label} does not begin: {why} while it was being compiled", True)
        item.abandon(why)
