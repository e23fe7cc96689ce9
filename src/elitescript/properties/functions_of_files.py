"""Functions of Python files as properties and measures: `checks.py:is_stacked`, which is given the finished run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from inspect import isfunction, signature
from math import isfinite
from traceback import extract_tb
from typing import Any, Final

from elitescript.errors import UsageError, did_you_mean
from elitescript.messages.signals import Value
from elitescript.properties.pieces import shown
from elitescript.properties.verdicts import NOTHING, Moment, Needs, Verdict
from elitescript.run import Run

Load = Callable[[str], Mapping[str, Any]]
"""Returns the names of a Python file, loaded anew; raises UsageError, with file and line, if it cannot."""


class _OfFile:
    """A function of a file, which is loaded anew for each run, so that a run knows nothing of those before.

    Args:
        text: as written: `checks.py:is_stacked`.
        path: of the file.
        name: of the function.
        load: loads the file.

    Raises:
        UsageError: the file cannot be loaded, or has no such function of one argument.
    """

    __slots__ = ("_load", "_name", "_path", "text")

    def __init__(self, text: str, path: str, name: str, load: Load) -> None:
        self.text = text
        self._path = path
        self._name = name
        self._load = load
        names = load(path)
        call = names.get(name)
        if not callable(call):
            functions = [key for key, value in names.items() if isfunction(value) and not key.startswith("_")]
            near = did_you_mean(name, functions) or (f"; it has {', '.join(functions)}" if functions else "")
            raise UsageError(f"{path} has no function {name!r}{near}")
        try:
            signature(call).bind(None)
        except (TypeError, ValueError):
            raise UsageError(f"{text}: the function must take one argument, the run") from None

    @property
    def needs(self) -> Needs:
        """What its watches are shown: nothing besides the record."""
        return NOTHING

    def called(self, run: Run) -> tuple[Any, str]:
        """Return what the function returns, and an empty text; or None and why it failed."""
        try:
            return self._load(self._path)[self._name](run), ""
        except (Exception, SystemExit) as error:
            return None, f"{self._place(error)}: {_words(error)}"

    def _place(self, error: BaseException) -> str:
        """Return file and line of an exception: the innermost place in the file."""
        lines = [frame.lineno for frame in extract_tb(error.__traceback__) if frame.filename == self._path]
        return f"{self._path}, line {lines[-1]}" if lines else self._path


class FunctionProperty(_OfFile):
    """A function that returns whether something holds. Implements `Property`."""

    __slots__ = ()

    def watch(self) -> _FunctionWatch:
        """Return what watches one run."""
        return _FunctionWatch(self)


class FunctionMeasure(_OfFile):
    """A function that returns a number. Implements `Measure`."""

    __slots__ = ()

    def watch(self) -> _FunctionWatch:
        """Return what watches one run."""
        return _FunctionWatch(self)


class _FunctionWatch:
    """Calls a function at the end of one run. Implements `Watch` and `MeasureWatch`."""

    __slots__ = ("_function", "reason")

    def __init__(self, function: _OfFile) -> None:
        self._function = function
        self.reason = ""

    def see(self, moment: Moment) -> None:
        """Take in a moment: none is needed."""

    def verdict(self, run: Run, end_tick: int) -> Verdict:
        """Return what the function says; one that raises an exception, or says neither, does not hold."""
        value, reason = self._function.called(run)
        if reason or type(value) is not bool:
            return Verdict(False, words=reason or f"{self._function.text} returned {_kind(value)}, not True or False")
        return Verdict(value, words="" if value else f"{self._function.text} returned False")

    def value(self, run: Run, end_tick: int) -> Value | None:
        """Return the number; None if there is none."""
        value, self.reason = self._function.called(run)
        if not self.reason and (type(value) not in _NUMBERS or (type(value) is float and not isfinite(value))):
            self.reason = f"{self._function.text} returned {_kind(value)}, which is no number"
        return None if self.reason else value


_NUMBERS: Final = frozenset({bool, int, float})


def _kind(value: Any) -> str:
    """Return a value for people; of a foreign class its name alone."""
    return shown(value) if type(value) in (*_NUMBERS, str, type(None)) else f"an object of class {type(value).__name__}"


def _words(error: BaseException) -> str:
    """Return an exception in one line; one whose text cannot be made has its name alone."""
    try:
        text = " ".join(str(error).split())
    except Exception:
        text = ""
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
