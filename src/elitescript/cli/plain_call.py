"""Reads ordinary calls without argparse, whose import and parsers take longer than checking a program.

`PlainCall` takes the place of a parser in the functions of `cli.arguments`, so that every argument is described once.
It reads words that can mean one thing only: options by their full names, each value in a word of its own or behind `=`,
and the other words beside each other. All else (help, mistakes, abbreviations, values that begin with `-`) is left to
argparse.
"""

from __future__ import annotations

from types import SimpleNamespace

TYPE_CHECKING = False
if TYPE_CHECKING:
    from argparse import Namespace
    from typing import Any, Final
else:

    class Namespace(SimpleNamespace):
        """The options of a call, as `argparse.Namespace` holds them."""

        def __contains__(self, name):
            return name in self.__dict__


OMITTED: Final[Any] = object()
"""As a default: the option is in the result only if it is given. As a help text: it is not shown."""


class PathArgument:
    """An argument whose value is a path, or may name one.

    Args:
        flag: as messages call it, `--world` or `FILE`.
        reads: what it reads, a key of `cli.call_paths.READS`; empty for nothing.
        writes: what it writes, a key of `cli.call_paths.WRITES`; empty for nothing.
    """

    __slots__ = ("flag", "reads", "writes")

    def __init__(self, flag: str, reads: str, writes: str) -> None:
        self.flag = flag
        self.reads = reads
        self.writes = writes


class PlainCall:
    """Collects the arguments of a command, then reads a call of it.

    Attributes:
        paths: the arguments that are paths, by their names in the options.
    """

    __slots__ = ("_options", "_positionals", "_settings", "description", "paths")

    def __init__(self) -> None:
        self.description: str | None = None
        self.paths: dict[str, PathArgument] = {}
        self._options: dict[str, dict[str, Any]] = {}
        self._positionals: list[dict[str, Any]] = []
        self._settings: list[dict[str, Any]] = []

    def add_argument(self, *flags: str, reads: str = "", writes: str = "", **settings: Any) -> None:
        """Take an argument, described as for `argparse`, with what it reads and writes if it is a path."""
        is_option = flags[0].startswith("-")
        name = next((flag for flag in flags if flag.startswith("--")), flags[0]).lstrip("-").replace("-", "_")
        settings.setdefault("dest", name)
        settings.setdefault("default", False if settings.get("action") == "store_true" else None)
        self._settings.append(settings)
        if reads or writes:
            shown = flags[0] if is_option else settings.get("metavar", flags[0])
            self.paths.setdefault(settings["dest"], PathArgument(shown, reads, writes))
        if is_option:
            self._options.update(dict.fromkeys(flags, settings))
        else:
            self._positionals.append(settings)

    def read(self, words: list[str]) -> Namespace | None:
        """Return the options of a call; None if argparse has to read it."""
        found: dict[str, Any] = {}
        for settings in self._settings:
            if settings["default"] is not OMITTED:
                found.setdefault(settings["dest"], settings["default"])
        rest: list[str] = []
        is_rest_complete = False
        left = iter(words)
        for word in left:
            if not word.startswith("-") or word == "-":
                if is_rest_complete:
                    return None
                rest.append(word)
                continue
            is_rest_complete = bool(rest)
            flag, has_value, value = word.partition("=")
            settings = self._options.get(flag, {})
            action = settings.get("action")
            if not settings or (has_value and not flag.startswith("--")):
                return None
            if action in ("store_true", "store_const"):
                if has_value:
                    return None
                found[settings["dest"]] = settings.get("const", True)
                continue
            if "nargs" in settings:
                return None
            if not has_value:
                value = next(left, "-")
                if value.startswith("-"):
                    return None
            try:
                read = settings.get("type", str)(value)
            except ValueError:
                return None
            if read not in settings.get("choices", (read,)):
                return None
            if action == "append":
                read = [*found[settings["dest"]], read]
            found[settings["dest"]] = read
        return Namespace(**found) if self._placed(rest, found) else None

    def _placed(self, rest: list[str], found: dict[str, Any]) -> bool:
        """Give the other words to the positional arguments; return whether that works out."""
        for settings in self._positionals:
            count = settings.get("nargs")
            if count == "*":
                found[settings["dest"]] = rest
                return settings is self._positionals[-1]
            if rest:
                found[settings["dest"]] = rest.pop(0)
            elif count != "?":
                return False
        return not rest
