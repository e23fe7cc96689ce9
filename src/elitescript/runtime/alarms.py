"""Makes an alarm of an uncaught exception: text, place in the program, details.

The place is the innermost line of script text in the traceback; frames of the runtime are not shown.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from math import isnan
from types import CodeType, FrameType, TracebackType
from typing import TYPE_CHECKING, Any, Final

from elitescript.commands.definition.quantities import shown
from elitescript.commands.definition.registry import Catalogue
from elitescript.commands.definition.vocabulary import newer_firmware_hint, newer_firmware_text, vocabulary_of
from elitescript.errors import CODES, ProgramError, ScriptError
from elitescript.errors import text_of as text_of_error
from elitescript.language.compiler import column_of
from elitescript.language.diagnostics import line_kept
from elitescript.language.limits import LONG_TEXT
from elitescript.language.options import PROGRAM, Options
from elitescript.language.text.source import SourceFile
from elitescript.messages.events import Alarm
from elitescript.messages.profile import Profile, release_of
from elitescript.records import NamedTuple
from elitescript.runtime.environment import without_addresses
from elitescript.runtime.threads.strand import INNER_TEXTS, Strand
from elitescript.said import Said, joined, said

if TYPE_CHECKING:
    from elitescript.language.symbols import Symbols

UNCAUGHT: Final = "R100"
_MISCALLED: Final = ("R101", "R102", "R103")
TEXT_SHOWN: Final = 10_000
"""Characters of the text of an exception that an alarm repeats."""
OUT_OF_MEMORY: Final = "R150"
MEMORY_HINT: Final = (
    "make shorter lists and texts, or keep fewer of them; `run --memory-limit` sets what a run may have"
)


class Place(NamedTuple):
    """A place in a program's text."""

    line: int
    column: int
    """From 1, in characters; 0 if unknown."""
    source_line: str
    names: tuple[str, ...]
    """Names visible to the code there."""
    inner: str = ""
    """Place in a text of `eval` or `exec`, in words."""
    source: SourceFile | None = None
    """The text."""
    expression: str = ""
    """Source of the failing expression; empty if unknown."""
    frame: FrameType | None = None
    """Frame with the variables."""


NOWHERE: Final = Place(0, 0, "", ())


def alarm_of(
    error: BaseException,
    *,
    clock: Callable[[], int],
    thread: str,
    started_line: int = 0,
    builtins: dict[str, Any],
    known: Iterable[str],
    sources: Mapping[str, SourceFile],
    catalogue: Catalogue,
    profile: Profile,
    missing: str | None = None,
) -> Alarm:
    """Return the alarm for an uncaught exception.

    Args:
        error: the exception, with its traceback.
        clock: gives the present tick; read last, because program code that makes the text of an exception takes time.
        thread: name of the thread.
        started_line: line that has started it: the place of a call that failed before any line of it ran.
        builtins: the built-ins of the program, by which its frames are recognised.
        known: predefined names, to suggest one for an unknown name.
        sources: texts of the program, by name.
        catalogue: the commands; an unknown name may be one of a newer firmware.
        profile: the firmware.
        missing: where a value that is nan comes from, if a reading has given one.
    """
    place = place_of(error.__traceback__, builtins, sources)
    if place.line == 0 and started_line:
        source = next(iter(sources.values()))
        place = Place(started_line, 1, source.line(started_line), place.names)
    code, class_name, text = UNCAUGHT, class_name_of(error), text_of(error)
    details: dict[str, Any] = {}
    if isinstance(error, ScriptError):
        # A program can extend the class and set what it likes.
        code = error.code if type(error.code) is str and error.code in CODES else UNCAUGHT
        details = details_of(error)
        if missing is not None and type(error.value) is float and isnan(error.value):
            details["hint"] = missing
        command = catalogue.get(error.command) if type(error.command) is str else None
        if command is not None and code in _MISCALLED and "hint" not in details:
            details["hint"] = command.hint_about(error.value)
    elif type(error) is NameError and type(error.name) is str and text.endswith("is not defined"):
        code, class_name, text, details = _unknown_name(error.name, text, place, known, catalogue, profile)
    elif isinstance(error, MemoryError) and not text:
        code, text, details = OUT_OF_MEMORY, memory_text(), {"hint": MEMORY_HINT}
    elif type(error).__module__ == "builtins":
        text, details = _in_plain_words(class_name, text, place)
    if place.inner:
        text = said("{text} ({place})", text=text, place=place.inner)
    line = line_kept(place.source_line, place.column)
    return Alarm(clock(), code, class_name, text, place.line, place.column, thread, line, details)


def memory_text() -> str:
    """Return the text for missing memory, with the limit of the process if it has one."""
    text = "there is not enough memory for what this line asks for"
    try:
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    except ImportError:  # not on this system
        return text
    return (
        text
        if limit == resource.RLIM_INFINITY
        else said("{text}: a run may have {limit} MiB", text=text, limit=limit >> 20)
    )


def abandoned(strand: Strand, tick: int) -> Alarm:
    """Return the alarm for a thread that does not end when it is stopped."""
    text = said("thread {strand!r} does not let itself be stopped; it is given up where it stands", strand=strand.name)
    return Alarm(tick, "R131", "RuntimeError", text, strand.line, 0, strand.name)


def held_up(strand: Strand, tick: int, line: int, late_ms: int, limit_ms: float, hint: str) -> Alarm:
    """Return the alarm for a program whose calls hold up a served robot again and again.

    Args:
        strand: the thread of the last such call.
        line: of that call.
        late_ms: by how much it was too long.
        limit_ms: for how long all of them may hold up the robot.
    """
    text = said(
        "single calls have held up robot time and streams for more than {limit_ms:g} ms beyond 1 "
        "% of the time; the last took {late_ms} ms too long",
        limit_ms=limit_ms,
        late_ms=late_ms,
    )
    details = {"value": late_ms / 1000.0, "limit": limit_ms / 1000.0, "unit": "s", "hint": hint}
    return Alarm(tick, "R135", "HeldUp", text, line, 0, strand.name, "", details)


def summary_of(error: BaseException) -> str:
    """Return the class and text in one line, as `[SEC] Exception:` shows them; functions have their own names."""
    from elitescript.runtime.plain_words import without_locals

    return f"{class_name_of(error)}: {without_locals(text_of(error))}"


def class_name_of(error: BaseException) -> str:
    """Return the class name of an exception; for errors of commands, the built-in class that they extend."""
    if isinstance(error, ScriptError):
        for kind in type(error).__mro__:
            if kind.__module__ == "builtins" and kind is not Exception:
                return kind.__name__
            if kind is Exception:
                break
    return type(error).__name__


def text_of(error: BaseException) -> str:
    """Return the text of an exception without addresses, which differ from run to run; never raises."""
    try:
        if isinstance(error, ProgramError):
            return joined("; ", (getattr(problem, "text", "") or str(problem) for problem in error.problems))
        text = str(error.msg) if isinstance(error, SyntaxError) else text_of_error(error)
        return without_addresses(_shortened(text))
    except Exception:
        return f"<text of {type(error).__name__} not available>"


def _shortened(text: str) -> str:
    """Return a text, or its begin if no client could take it."""
    return (
        text
        if len(text) <= TEXT_SHOWN
        else said("{text}... ({count} characters)", text=text[:TEXT_SHOWN], count=len(text))
    )


def details_of(error: ScriptError) -> dict[str, Any]:
    """Return the fields of a command's error that are set, as plain values."""
    names = ("command", "argument", "value", "limit", "unit", "hint")
    fields = {name: _plain(getattr(error, name, None)) for name in names}
    return {name: value for name, value in fields.items() if value not in (None, "")}


def _plain(value: Any) -> Any:
    """Return a number or text as it is, another value as its text."""
    if type(value) in (str, Said):
        return _shortened(value)
    if value is None or type(value) in (bool, int, float):
        return value
    return without_addresses(shown(value))


def place_of(trace: TracebackType | None, builtins: dict[str, Any], sources: Mapping[str, SourceFile]) -> Place:
    """Return the innermost place of a traceback in the program's own text, or else in a text of `eval`."""
    found = inner = None
    while trace is not None:
        if trace.tb_frame.f_builtins is builtins:
            inner = trace
            if not trace.tb_frame.f_code.co_filename.startswith(INNER_TEXTS):
                found = trace
        trace = trace.tb_next
    found = found or inner
    if found is None:
        return NOWHERE
    frame, code = found.tb_frame, found.tb_frame.f_code
    span = _position(code, found.tb_lasti, found.tb_lineno or 0)
    line = span[0]
    source = sources.get(code.co_filename)
    names = (*code.co_varnames, *code.co_freevars, *code.co_cellvars, *frame.f_globals)
    where = "" if inner is found or inner is None else _inner_place(inner)
    if source is None:
        return Place(line, 0, "", names, where)
    column, expression = 0, ""
    if None not in span:
        column = column_of(source, line, span[2])
        expression = _between(source, line, column, span[1], column_of(source, span[1], span[3]))
    is_made = inner is not found
    return Place(line, column, source.line(line), names, where, source, "" if is_made else expression, frame)


_LONGEST_EXPRESSION: Final = 20
"""Most lines of an expression that is shown."""


def _between(source: SourceFile, line: int, column: int, end_line: int, end_column: int) -> str:
    """Return the text from one place to another."""
    if end_line - line > _LONGEST_EXPRESSION:
        return ""
    rows = [source.line(number) for number in range(line, end_line + 1)]
    rows[-1] = rows[-1][: end_column - 1]
    rows[0] = rows[0][column - 1 :]
    return "\n".join(rows)


def _inner_place(trace: TracebackType) -> str:
    file = trace.tb_frame.f_code.co_filename
    if file.startswith("<interpreter"):
        return "in a statement of interpreter mode"
    return said("line {line} of the text that {function} ran", line=trace.tb_lineno, function=file[1:5])


def _position(code: CodeType, instruction: int, line: int) -> tuple[Any, Any, Any, Any]:
    """Return the line, end line, UTF-8 column and end column, from 0, of an instruction; None if unknown."""
    index = instruction // 2
    for number, (start, end, column, end_column) in enumerate(code.co_positions()):
        if number == index:
            return start or line, end, column, end_column
    return line, None, None, None


def _unknown_name(
    name: str, text: str, place: Place, known: Iterable[str], catalogue: Catalogue, profile: Profile
) -> tuple[str, str, str, dict[str, Any]]:
    """Return the code, class, text and details for an unknown name."""
    command = catalogue.get(name)
    if command is not None and release_of(command.since) > profile.release:
        text = newer_firmware_text(name, command.since, profile)
        return "R105", "NameError", text, {"command": name, "hint": newer_firmware_hint(command.since)}
    hint = _advice(name, place, known, profile)
    if text == f"name {name!r} is not defined":
        text = said("name {name!r} is not defined", name=name)
    return UNCAUGHT, "NameError", text, {"hint": hint} if hint else {}


def _advice(name: str, place: Place, known: Iterable[str], profile: Profile) -> str:
    """Return the hint of `check` for the name in this place; in a text of `eval` a similar name."""
    from elitescript.language.advice.unknown_names import advice, nearest

    symbols = _symbols_of(place)
    if symbols is not None:
        for scope in symbols.scopes:
            for node in scope.reads.get(name, ()):
                if symbols.place(node) == (place.line, place.column):
                    return advice(node, scope, symbols, vocabulary_of(profile))[1]
    meant = nearest(name, (item for item in (*place.names, *known) if item.isidentifier() and item[:2] != "__"))
    return said("is `{meant}` meant?", meant=meant) if meant else ""


def _symbols_of(place: Place) -> Symbols | None:
    """Return the names of the text of a place; None for a long one, which takes too long between two ticks."""
    if place.source is None or place.inner or len(place.source.text) >= LONG_TEXT:
        return None
    from elitescript.language.kinds import is_sent_program
    from elitescript.language.parser import parse
    from elitescript.language.symbols import Symbols

    kind = PROGRAM if is_sent_program(place.source) else None
    return Symbols(parse(place.source, Options(kind=kind)))


def _in_plain_words(class_name: str, text: str, place: Place) -> tuple[str, dict[str, Any]]:
    """Return the text and details for a built-in exception."""
    from elitescript.runtime.plain_words import Scene, plain_words

    frame = place.frame
    names = {} if frame is None else {**frame.f_globals, **frame.f_locals}
    words = plain_words(class_name, text, Scene(place.expression, "" if place.inner else place.source_line, names))
    hint = words.hint
    if class_name == "UnboundLocalError" and "`global " in hint:
        hint = _nonlocal_hint(place) or hint
    return words.text, {"hint": hint} if hint else {}


def _nonlocal_hint(place: Place) -> str:
    """Return the hint for a variable without a value if the enclosing program has one of that name; else nothing."""
    symbols, name = _symbols_of(place), place.expression
    if symbols is None:
        return ""
    for scope in symbols.scopes:
        places = [symbols.place(node) for node in scope.reads.get(name, ())]
        if (place.line, place.column) not in places or not scope.has_local(name) or scope.parent is None:
            continue
        if scope.parent.home(name) is not None:
            where = said("`nonlocal {name}` at the start of `{scope}`", name=name, scope=scope.name)
            return said("assign it before, or write {where} if that of the enclosing program is meant", where=where)
    return ""
