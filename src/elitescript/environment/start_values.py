"""Signals and program globals that have a value before the program begins: `--set NAME=VALUE`."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping
from typing import Any, Final

from elitescript.errors import UsageError, did_you_mean
from elitescript.messages.signals import SIGNALS, Value

_WORDS: Final = {"true": True, "on": True, "high": True, "false": False, "off": False, "low": False}


def parse_settings(texts: list[str], option: str = "--set") -> tuple[dict[str, Value], dict[str, Any]]:
    """Split `NAME=VALUE` settings into signals and program globals.

    A name of the signal table (with an index in brackets, where the family has several) is a signal; any other
    identifier is a global of the program. `option` is the option or verb before them, for messages.

    Raises:
        UsageError: not of this form, or a value that is no literal.
    """
    signals: dict[str, Value] = {}
    presets: dict[str, Any] = {}
    for text in texts:
        name, equals, value_text = text.partition("=")
        name = name.strip()
        if not equals:
            raise UsageError(f"{option} {text}: write NAME=VALUE")
        value = literal_of(value_text.strip(), f"{option} {text}")
        if name.partition("[")[0] in SIGNALS or "[" in name:
            signals[name] = value
        elif name.isidentifier():
            presets[name] = value
        else:
            raise UsageError(f"{option} {text}: {name!r} is neither a signal nor a name")
    return signals, presets


def sorted_settings(values: Mapping[str, Any], option: str) -> tuple[dict[str, Value], dict[str, Any]]:
    """Split values by name into signals and program globals; see `parse_settings`.

    Raises:
        UsageError: a name that is neither.
    """
    signals: dict[str, Value] = {}
    presets: dict[str, Any] = {}
    for name, value in values.items():
        if name.partition("[")[0] in SIGNALS or "[" in name:
            signals[name] = value
        elif name.isidentifier():
            presets[name] = value
        else:
            raise UsageError(f"{option} {name}: {name!r} is neither a signal nor a name")
    return signals, presets


def check_presets(presets: Iterable[str], program: str, option: str = "--set") -> None:
    """Refuse a global that looks like a misspelt signal and is in no line of the program.

    Raises:
        UsageError: there is one; the text names the signal.
    """
    for name in presets:
        near = did_you_mean(name, SIGNALS)
        if near and name not in program:
            raise UsageError(f"{option} {name}: there is no such signal, and the program has no such global{near}")


def literal_of(text: str, setting: str, *, has_words: bool = False) -> Any:
    """Return the value that a setting is written with.

    Args:
        text: of the value.
        setting: all of it, for messages.
        has_words: whether a single word without quotes is a text.

    Raises:
        UsageError: it is no literal.
    """
    if text.lower() in _WORDS:
        return _WORDS[text.lower()]
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError):
        if has_words and text.isidentifier():
            return text
        raise UsageError(f"{setting}: {text!r} is no literal; write true, 3, 0.5, 'text' or [1, 2]") from None
