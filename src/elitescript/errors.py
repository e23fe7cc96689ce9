"""The exception tree and the table of error codes.

Three families, by the source of the mistake: the script (`ScriptError`, `ProgramError`), the
network peer (`PeerError`), the caller of this library (`UsageError`). Anything else that escapes is
a bug of this library and is never swallowed.

`CODES` is the only table of codes, severities and titles. Codes E0xx and E1xx
stop a program from starting, E3xx are findings against the command catalogue, W2xx are
warnings, N2xx notes on what a sound program may have, R are alarms at run time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import wraps
from typing import Any, Final, ParamSpec, TypeVar

from elitescript.records import NamedTuple
from elitescript.said import Said, said
from elitescript.sealed import Sealed
from elitescript.shown import shown, shown_word

_Given = ParamSpec("_Given")
_Returned = TypeVar("_Returned")


class Code(NamedTuple):
    """One row of the error table."""

    code: str
    severity: str
    """`error`, `warning` or `note`; an alarm at run time is an error."""
    title: str
    is_tolerated: bool = False
    """A warning without `--strict` and an error with it, whatever `severity` is."""

    @property
    def default_severity(self) -> str:
        """Severity without `--strict`."""
        return "warning" if self.is_tolerated else self.severity

    @property
    def strict_severity(self) -> str:
        """With `--strict`."""
        return "error" if self.is_tolerated else self.severity


_ROWS: Final = (
    # What keeps a program from starting.
    Code("E001", "error", "Python syntax"),
    Code("E002", "error", "the text is not UTF-8"),
    Code("E003", "error", "the file cannot be read"),
    Code("E004", "error", "graphical program that cannot be generated"),
    Code("E101", "error", "`end` that closes nothing"),
    Code("E102", "error", "program unit without its closing `end`"),
    Code("E103", "error", "clause after the `end` of its statement"),
    Code("E104", "error", "empty block"),
    Code("E105", "error", "`sec` inside a block"),
    Code("E106", "error", "print statement of Python 2", is_tolerated=True),
    Code("E107", "error", "program parameter without a default"),
    Code("E108", "error", "`global` with an assignment"),
    Code("E109", "error", "`global` after the name was used", is_tolerated=True),
    Code("E110", "error", "long-integer suffix of Python 2", is_tolerated=True),
    Code("E111", "error", "`<>` or backquotes of Python 2"),
    Code("E112", "error", "statement form of Python 2"),
    Code("E113", "error", "operator of C"),
    Code("E114", "error", "statement of URScript"),
    Code("E115", "error", "name or attribute that scripts may not use"),
    # What suspects a mistake.
    Code("W201", "warning", "unknown name"),
    Code("W202", "warning", "assignment that hides a global; `global` missing?"),
    Code("W203", "warning", "name of a robot command used for something else"),
    Code("W204", "warning", "loop that never waits", is_tolerated=True),
    Code("W205", "warning", "call that a secondary program may not make", is_tolerated=True),
    Code("W206", "warning", "`global` that is never assigned"),
    Code("W207", "warning", "code that is never reached"),
    Code("W208", "warning", "use of the program's own name"),
    Code("W209", "warning", "name of Python 2", is_tolerated=True),
    Code("W210", "warning", "escape sequence that Python does not have"),
    Code("W211", "warning", "pose literal of URScript"),
    Code("W212", "warning", "syntax newer than the robot's Python"),
    Code("W213", "warning", "module that is not available"),
    Code("W214", "warning", "text in which nothing runs", is_tolerated=True),
    Code("W215", "warning", "call without its parentheses", is_tolerated=True),
    Code("W216", "warning", "block without the `end` that others have", is_tolerated=True),
    Code("W217", "warning", "function that is defined twice", is_tolerated=True),
    Code("W218", "warning", "statement that does nothing", is_tolerated=True),
    Code("W219", "warning", "result that is not used", is_tolerated=True),
    Code("W220", "warning", "`return` that is missing on one path", is_tolerated=True),
    Code("W221", "warning", "reading that a secondary program does not wait for", is_tolerated=True),
    Code("W222", "warning", "text in GBK that is UTF-8 by chance"),
    Code("W223", "warning", "variable that nothing reads, beside one of nearly the same name", is_tolerated=True),
    Code("W224", "warning", "list that stands in several places and is changed", is_tolerated=True),
    Code("W225", "warning", "list that is changed in the loop that goes through it", is_tolerated=True),
    # What is hardly meant in a graphical program; see `program_tree.checking`.
    Code("W226", "warning", "waypoint whose pose and joint positions disagree", is_tolerated=True),
    Code("W227", "warning", "variable of the installation without a value", is_tolerated=True),
    Code("W228", "warning", "script node whose text is not that of its file", is_tolerated=True),
    Code("W229", "warning", "graphical program that was made for another arm", is_tolerated=True),
    # What is legal, but hardly meant: units and targets; see `commands.definition.plausibility`.
    Code("W230", "warning", "angle that looks like degrees", is_tolerated=True),
    Code("W231", "warning", "length that looks like millimetres", is_tolerated=True),
    Code("W232", "warning", "speed or acceleration that looks like degrees or millimetres", is_tolerated=True),
    Code("W233", "warning", "payload above what the arm carries", is_tolerated=True),
    Code("W234", "warning", "analog level outside 0 to 1", is_tolerated=True),
    Code("W235", "warning", "blend radius longer than half of the move", is_tolerated=True),
    Code("W236", "warning", "target that the arm cannot reach", is_tolerated=True),
    Code("W237", "warning", "joint positions where a pose belongs, or the reverse", is_tolerated=True),
    Code("W238", "warning", "lock that stays acquired", is_tolerated=True),
    Code("W239", "warning", "number of another quantity", is_tolerated=True),
    Code("W240", "warning", "comparison that is never, or always, true", is_tolerated=True),
    Code("W241", "warning", "condition that is always true, or not what it seems", is_tolerated=True),
    Code("W242", "warning", "measured values compared exactly", is_tolerated=True),
    Code("W243", "warning", "lists joined where numbers were meant", is_tolerated=True),
    Code("W244", "warning", "time that looks like milliseconds", is_tolerated=True),
    Code("W245", "warning", "call of a value that is no function", is_tolerated=True),
    Code("W246", "warning", "channel that nothing opens", is_tolerated=True),
    Code("W247", "warning", "another server under the name of an open channel", is_tolerated=True),
    Code("W248", "warning", "line end as the mark in front of a text", is_tolerated=True),
    Code("W249", "warning", "MODBUS signal that cannot be used like this", is_tolerated=True),
    Code("W250", "warning", "negative blend radius", is_tolerated=True),
    Code("W251", "warning", "MODBUS signal added in the loop that reads it", is_tolerated=True),
    Code("W252", "warning", "address that no device has", is_tolerated=True),
    Code("W253", "warning", "serial port that is not set up for the command", is_tolerated=True),
    Code("W254", "warning", "thread handle used as a value", is_tolerated=True),
    Code("W255", "warning", "tool pin that is set and is no output", is_tolerated=True),
    Code("W256", "warning", "variable that has no value yet", is_tolerated=True),
    Code("W257", "warning", "variable that one branch alone gives a value", is_tolerated=True),
    Code("W258", "warning", "variable that hides that of the enclosing program", is_tolerated=True),
    Code("W259", "warning", "waiting loop that nothing ends", is_tolerated=True),
    Code("W260", "warning", "write to an address that mirrors the robot", is_tolerated=True),
    Code("W261", "warning", "loop that only swallows refusals", is_tolerated=True),
    Code("W262", "warning", "reading that may have failed and is used unasked", is_tolerated=True),
    Code("W263", "warning", "list that is changed under its other name", is_tolerated=True),
    Code("W264", "warning", "operation that Python does not have", is_tolerated=True),
    Code("W265", "warning", "element that a list does not have", is_tolerated=True),
    Code("W266", "warning", "arguments that have changed places", is_tolerated=True),
    Code("W267", "warning", "per cent where a fraction is meant", is_tolerated=True),
    Code("W268", "warning", "number that the receiver cannot hold", is_tolerated=True),
    Code("W269", "warning", "call that never ends, in place of a function for a thread", is_tolerated=True),
    # What a sound program may have, and what is worth knowing all the same.
    Code("N221", "note", "encoder that is tracked and not set up"),
    Code("N222", "note", "thread that the end of the program ends"),
    Code("N223", "note", "output behind a blended move"),
    Code("N224", "note", "path that stops at each of its points"),
    Code("N225", "note", "what is missing beside a graphical program"),
    Code("N226", "note", "sleep that is very long"),
    Code("N227", "note", "branch of a graphical program in which nothing stands"),
    Code("N228", "note", "function that nothing calls"),
    # What a run alone can find.
    Code("W270", "warning", "something that a program gave away and that did not arrive"),
    Code("W271", "warning", "write to an output that follows the state of the task"),
    Code("W272", "warning", "reading that begins with the line end of the one before"),
    Code("W273", "warning", "arm, tool or payload that touches something"),
    Code("W274", "warning", "connection that the options of the robot do not let through"),
    Code("W275", "warning", "text that a device sends in GBK"),
    # What the text shows, again.
    Code("W276", "warning", "text with places that nothing fills", is_tolerated=True),
    Code("W277", "warning", "result of a call that gives none", is_tolerated=True),
    Code("W278", "warning", "call that fails with these values", is_tolerated=True),
    Code("W279", "warning", "`^` where a power is meant", is_tolerated=True),
    # What observers of a run find.
    Code("N280", "note", "data that was left unread"),
    Code("W280", "warning", "end of a program while the arm is under way"),
    Code("W281", "warning", "answer that is not to the question"),
    Code("W282", "warning", "numbers that were dropped"),
    Code("W283", "warning", "reading that ended with data there"),
    Code("W285", "warning", "reading of a MODBUS signal before its first answer"),
    Code("W286", "warning", "value of a MODBUS signal that was never sent"),
    Code("W287", "warning", "value that a register does not hold"),
    Code("W288", "warning", "output that goes on and off in one tick"),
    Code("W289", "warning", "pulse of an input that a polling line has missed"),
    Code("W290", "warning", "targets of servoj that come too late"),
    Code("W291", "warning", "tracked encoder that has never counted"),
    Code("W292", "warning", "command that is refused again and again"),
    Code("W293", "warning", "setting of a device that is hardly meant"),
    Code("N281", "note", "connection that the peer has closed"),
    Code("N282", "note", "text beyond ASCII"),
    Code("N283", "note", "reading that ended with a part"),
    Code("N284", "note", "first readings of a MODBUS signal that had no value yet"),
    Code("N285", "note", "level of an output that was replaced in one tick"),
    Code("N286", "note", "stream of values that is faster than its MODBUS signal"),
    Code("N287", "note", "negative value in a register"),
    Code("N288", "note", "force mode that meets nothing"),
    Code("N290", "note", "time of a device that is very long"),
    # What contradicts the command catalogue; a program may catch it, so it starts unless it is strict.
    Code("E301", "error", "unknown command"),
    Code("E302", "error", "command of a newer firmware"),
    Code("E303", "error", "wrong number or names of arguments"),
    Code("E304", "error", "argument of the wrong type"),
    Code("E305", "error", "argument outside its range"),
    # Alarms while a program runs.
    Code("R100", "error", "uncaught Python exception"),
    Code("R101", "error", "argument of the wrong type"),
    Code("R102", "error", "argument outside its range"),
    Code("R103", "error", "wrong number or names of arguments"),
    Code("R104", "error", "invalid value"),
    Code("R105", "error", "command of a newer firmware"),
    Code("R106", "error", "command that is not simulated"),
    Code("R110", "error", "target outside the joint limits"),
    Code("R111", "error", "target out of reach"),
    Code("R112", "error", "path through a singularity"),
    Code("R113", "error", "arc without a plane"),
    Code("R114", "error", "two motions at once"),
    Code("R115", "error", "the arm is not ready to move"),
    Code("R116", "error", "the arm is not where the points begin"),
    Code("R117", "error", "points too far apart"),
    Code("R118", "error", "motion that a joint cannot follow"),
    Code("R120", "error", "call that a secondary program may not make"),
    Code("R121", "error", "too many threads"),
    Code("R122", "error", "I/O point in the wrong mode"),
    Code("R123", "error", "access that scripts do not have"),
    Code("R130", "error", "nothing can ever happen again"),
    Code("R131", "error", "the thread cannot be stopped"),
    Code("R132", "error", "the controller had to be restarted"),
    Code("R133", "error", "remote procedure call that failed"),
    Code("R134", "error", "MODBUS signal that does not work"),
    Code("R135", "error", "calls that hold up the robot"),
    Code("R140", "error", "protective stop"),
    Code("R141", "error", "emergency stop"),
    Code("R142", "error", "violation or fault of the safety system"),
    Code("R150", "error", "not enough memory"),
    Code("R151", "error", "the process that ran the program has crashed"),
)

CODES: Final[dict[str, Code]] = {row.code: row for row in _ROWS}


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return `; did you mean 'NAME'?` for the most similar name, or an empty text."""
    # Not at the top: few runs need it.
    from difflib import get_close_matches

    near = get_close_matches(word, sorted(known), n=1)
    return f"; did you mean {near[0]!r}?" if near else ""


def suggests_keywords(function: Callable[_Given, _Returned]) -> Callable[_Given, _Returned]:
    """Let the refusal of a keyword that a function does not have name the nearest one; a decorator."""

    @wraps(function)
    def call(*args: _Given.args, **keywords: _Given.kwargs) -> _Returned:
        try:
            return function(*args, **keywords)
        except TypeError as error:
            known = function.__code__.co_varnames[: function.__code__.co_argcount + function.__code__.co_kwonlyargcount]
            unknown = [name for name in keywords if name not in known]
            # Of its own code, the traceback has more than this call.
            if not unknown or error.__traceback__ is None or error.__traceback__.tb_next is not None:
                raise
            near = did_you_mean(unknown[0], known)
            raise TypeError(f"{function.__qualname__}() has no argument {unknown[0]!r}{near}") from None

    return call


class ElitescriptError(Exception):
    """Root of the errors that this library raises to its Python callers."""


TEXT_MAX: Final = 4000
"""Characters of the message of a `UsageError`; of a longer one the middle is left out."""
_END: Final = 1000
"""Characters at its end, where most messages have the reason."""


class UsageError(ElitescriptError):
    """The caller of this library or of the command line passed an invalid value."""

    def __init__(self, text: str = "") -> None:
        # A message may quote a value of a file that others wrote.
        if len(text) > TEXT_MAX:
            mark = f" ... ({len(text)} characters) ... "
            text = text[: TEXT_MAX - _END - len(mark)] + mark + text[-_END:]
        super().__init__(text)


class InternalError(ElitescriptError):
    """A broken invariant of our own; please report it."""


class PeerError(ElitescriptError):
    """A network peer sent something that its protocol does not allow."""


class ProgramError(ElitescriptError):
    """The text is not a program; `problems` holds one diagnostic for each reason, `file` its file if it is known."""

    def __init__(self, problems: tuple[Any, ...], file: str = "") -> None:
        self.problems = problems
        self.file = file
        super().__init__("\n".join(shown(str(problem)) for problem in problems))


class AlarmError(ElitescriptError):
    """A program ended with an alarm; raised by `Run.check`, which holds the alarm itself."""

    def __init__(self, alarm: Any, place: str) -> None:
        self.alarm = alarm
        lines = [f"{place}: {shown_word(alarm.class_name)}: {shown(alarm.text)}"]
        if alarm.source_line:
            lines.append(f"    {shown(alarm.source_line.strip())}")
        if alarm.details.get("hint"):
            lines.append(f"hint: {shown(str(alarm.details['hint']))}")
        lines += [f"try: {shown(str(hint))}" for hint in alarm.details.get("hints", ())]
        super().__init__("\n".join(lines))


class DebugError(Exception):
    """A look into a program, or an expression over its values, that cannot be met; the text says why, for people."""


class _Shown(Sealed):
    """Metaclass of errors that programs catch; they are written as those of Python are, without a module."""

    def __repr__(cls) -> str:
        return f"<class '{cls.__qualname__}'>"


class ScriptError(Exception, metaclass=_Shown):
    """A robot command refused a call; scripts may catch it.

    Raised on the script's own line. The subclasses are also the built-in exceptions that
    a Python programmer expects (`TypeError`, `ValueError`, `RuntimeError`).

    Args:
        text: what was wrong, with the value and the unit; made by `said`.
        code: row of `CODES`.
        command: the command that refused.
        argument: the parameter that was wrong, if it was one.
        value: what was passed.
        limit: what is allowed, as text (`"> 0"`, `"[0, 15]"`).
        unit: unit of value and limit.
        hint: what to do about it.
    """

    default_code = "R104"

    def __init__(
        self,
        text: str,
        *,
        code: str | None = None,
        command: str | None = None,
        argument: str | None = None,
        value: Any = None,
        limit: str | None = None,
        unit: str | None = None,
        hint: str | None = None,
    ) -> None:
        self.set_text(text)
        self.code = code or self.default_code
        self.command = command
        self.argument = argument
        self.value = value
        self.limit = limit
        self.unit = unit
        self.hint = hint

    def set_text(self, text: str) -> None:
        """Set what was wrong; programs see it as a plain text."""
        self.args = (str(text),)
        self._text = text
        self._around: tuple[tuple[str, dict[str, str]], ...] = ()

    def put_into(self, text: str, template: str, **values: str) -> None:
        """Make the text part of a longer one.

        Programs catch refusals in loops: what `said` gives is not made until an alarm needs it.

        Args:
            text: the longer one, as programs see it.
            template: of it, with `{mistake}` for the text until now.
            values: of the other holes.
        """
        self.args = (text,)
        self._around += ((template, values),)

    @property
    def said(self) -> str:
        """What was wrong, with its template."""
        text = self._text
        for template, values in self._around:
            text = said(template, mistake=text, **values)
        return text


def text_of(error: BaseException) -> str:
    """Return the text of an error, with its template if it was made by `said`.

    An error of a program may have a text that raises something else.
    """
    text = str(error)
    kept = getattr(error, "said", None) or (error.args[0] if error.args else None)
    return kept if type(kept) is Said and kept == text else text


class ArgumentTypeError(ScriptError, TypeError):
    """An argument has the wrong type or shape."""

    default_code = "R101"


class ArgumentRangeError(ScriptError, ValueError):
    """An argument is outside its range."""

    default_code = "R102"


class ArgumentCountError(ScriptError, TypeError):
    """A command was called with the wrong number or names of arguments."""

    default_code = "R103"


class InvalidValueError(ScriptError, ValueError):
    """The value cannot be used, though its type and range are right."""

    default_code = "R104"


class MirroredAddressError(InvalidValueError):
    """The address shows a state of the robot, or nothing; it cannot be written."""


class FirmwareError(ScriptError, NameError):
    """The command exists only in a newer firmware than the chosen one."""

    default_code = "R105"


class NotSimulatedError(ScriptError, NotImplementedError):
    """The command is known but not simulated."""

    default_code = "R106"


class MotionError(ScriptError, RuntimeError):
    """The arm cannot do this move."""

    default_code = "R111"


class ScriptStateError(ScriptError, RuntimeError):
    """The command is not possible in the present state of program or machine."""

    default_code = "R115"


class ArmNotReadyError(ScriptStateError):
    """The arm has no power, or its brakes are engaged."""


class ScriptPermissionError(ScriptError, PermissionError):
    """The script requested access that scripts do not have."""

    default_code = "R123"


class RpcError(ScriptError, RuntimeError):
    """A remote procedure call failed: no connection, no answer in time, or a fault as the answer.

    Attributes:
        faultCode: number of the server's fault; 0 if it was none.
        faultString: its text.
    """

    default_code = "R133"

    def __init__(self, text: str, *, fault: tuple[int, str] = (0, ""), **details: Any) -> None:
        super().__init__(text, **details)
        self.faultCode, self.faultString = fault
