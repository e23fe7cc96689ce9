"""Describes commands, parameters, signals and words of the language as Markdown, and writes example calls."""

from __future__ import annotations

from typing import Final

from elitescript.assist.units import element_names
from elitescript.commands.definition.page import kind_of, notes
from elitescript.commands.definition.quantities import (
    Boolean,
    Choice,
    Either,
    Integer,
    Number,
    Octets,
    Optionally,
    Quantity,
    Text,
    Vector,
)
from elitescript.commands.definition.registry import Command, Param
from elitescript.commands.definition.vocabulary import newer_firmware_text
from elitescript.messages.profile import Profile, release_of
from elitescript.messages.signals import Signal
from elitescript.untrusted.escaping import code_block

LANGUAGE: Final = "elitescript"
"""Name of the language behind the fences of code."""

KEYWORDS: Final[dict[str, str]] = {
    "and": "True if both sides are true; the right one is evaluated only then.",
    "as": "Gives what an `import`, `with` or `except` finds a name.",
    "assert": "Raises `AssertionError` unless the condition is true; `assert condition, text`.",
    "break": "Leaves the innermost loop.",
    "case": "One pattern of a `match`.",
    "class": "Defines a class; `end` in its column closes it.",
    "continue": "Goes on with the next pass of the innermost loop.",
    "def": "Defines a function, or the program itself when everything else stands inside it. `end` in its column "
    "closes it. Names that it assigns are its own unless it declares them `global`.",
    "del": "Removes a name or an element.",
    "elif": "Another condition of an `if`; before the `end`.",
    "else": "What runs if no condition was true, a loop was not left by `break`, or a `try` raised nothing.",
    "end": "Closes the block whose header begins in the same column.",
    "except": "What runs after an error of the `try`: `except ScriptError as e:`.",
    "False": "The truth value that is not true.",
    "finally": "What runs behind a `try` in any case.",
    "for": "Runs its block for each element: `for i in range(3):`; `end` in its column closes it.",
    "from": "Takes names out of a module: `from math import pi`.",
    "global": "Makes names of the function those of all functions and of the variable monitor. It stands before their "
    "first use in the function.",
    "if": "Runs its block if the condition is true; `end` behind the last clause closes it.",
    "import": "Makes a module of Python's library available: `import math`.",
    "in": "True if an element is in a list, or a text in a text.",
    "is": "True if both are the same object; for `None`, `True` and `False`.",
    "lambda": "A function without a name: `lambda x: 2 * x`.",
    "match": "Compares a value with patterns, `case` by `case`; `end` in its column closes it.",
    "None": "The value that stands for nothing; what functions without `return` give.",
    "nonlocal": "Makes names of the function those of the function around it.",
    "not": "True if the other value is false.",
    "or": "True if one side is true; the right one is evaluated only if the left one is not.",
    "pass": "Does nothing; for blocks in which nothing is to be done.",
    "raise": "Raises an error; in an `except` without a value the one that is handled.",
    "return": "Ends the function, with a result or with None.",
    "sec": "Makes a secondary program: it runs beside the program, within one tick, and may not move or wait.",
    "True": "The truth value that is true.",
    "try": "Runs its block; errors in it go to `except`. `end` behind the last clause closes it.",
    "while": "Runs its block as long as the condition is true; `end` in its column closes it. A loop without a call "
    "that waits, such as `sync()`, uses up the work of its tick.",
    "with": "Runs its block with a lock or a file, which it releases at the end.",
    "yield": "Gives a value to whatever iterates over the function.",
}
"""Words of the language, and what they do."""

_POSE: Final = "[0.4, 0.2, 0.3, d2r(180), 0, 0]"
_SAMPLES: Final = {
    "joints": "[0, d2r(-90), d2r(90), d2r(-90), d2r(-90), 0]",
    "pose": _POSE,
    "tcp": "[0, 0, 0.1, 0, 0, 0]",
    "joint speeds": "[0.1, 0, 0, 0, 0, 0]",
    "tool velocity": "[0, 0, 0.05, 0, 0, 0]",
    "centre of gravity": "[0, 0, 0.05]",
    "payload": "1.5",
    "fraction": "0.5",
    "joint acceleration": "1.4",
    "joint speed": "1.0",
    "tool acceleration": "1.2",
    "tool speed": "0.25",
}
"""Example of a value for each `Quantity.meaning`."""

_TEXTS: Final = {
    "address": "192.168.1.10",
    "IP": "192.168.1.10",
    "connection_id": "192.168.1.10",
    "file_name": "points.txt",
    "prefix": "<",
    "signal_name": "valve",
    "socket_name": "camera",
    "url": "192.168.1.10:8080",
    "variable": "input_int_register0",
}
"""Example of a text for parameters of these names."""

_NUMERALS: Final = frozenset(("to_num",))
"""Commands that take a number as a text."""
_OF_POINTS: Final = ("cal_rpy_frame",)
"""Commands that take points which make a frame: they must not coincide."""
_POINTS: Final = {"origin": "[0.4, 0.0, 0.2]", "x_axis": "[0.5, 0.0, 0.2]", "y_axis": "[0.4, 0.1, 0.2]"}

_FREE_ADDRESSES: Final = {"write_port_bit": "60", "write_port_register": "256"}
"""Addresses of the controller's own server that programs may write."""


# ---------------------------------------------------------------- commands


def command_markdown(command: Command, profile: Profile) -> str:
    """Return all that is known of a command: signature, arguments, result, errors, example, evidence."""
    details = command.details
    parts = [fenced(command.signature)]
    if release_of(command.since) > profile.release:
        parts.append(f"**{newer_firmware_text(command.name, command.since, profile)}.**")
    parts += [details.summary, details.behaviour]
    if command.params:
        parts.append("**Arguments**\n\n" + "\n".join(f"- {parameter_markdown(param)}" for param in command.params))
    if details.returns_text:
        parts.append(f"**Returns** {kind_of(details.returns)}: {details.returns_text}")
    if details.raises:
        rows = "\n".join(f"- `{name}`: {text}" for name, text in details.raises.items())
        parts.append(f"**Errors**\n\n{rows}")
    parts.append("**Example**\n\n" + fenced(example(command)))
    parts.append("*" + " ".join(notes(command)).replace("*", "") + "*")
    return "\n\n".join(part for part in parts if part)


def parameter_markdown(param: Param) -> str:
    """Return name, type, range, unit, default and text of a parameter."""
    default = "" if param.is_required else f", default `{param.default_text}`"
    names = element_names(param.quantity)
    elements = f" `[{', '.join(names)}]`" if names else ""
    unit = f" **[{param.quantity.unit}]**" if param.quantity.unit else ""
    kind = kind_of(param.quantity).removesuffix(f" [{param.quantity.unit}]")
    return f"`{param.name}`: **{_plain(kind)}**{unit}{elements}{default}. {param.text[:1].upper()}{param.text[1:]}"


def parameter_label(param: Param) -> str:
    """Return type, range and unit of a parameter in one line, for lists."""
    default = "" if param.is_required else f" = {param.default_text}"
    return kind_of(param.quantity) + default


def fenced(code: str) -> str:
    """Return code as a block of Markdown."""
    return code_block(code, LANGUAGE)


def _plain(text: str) -> str:
    """Return a text without characters that Markdown reads as marks."""
    return text.replace("*", r"\*").replace("<", r"\<")


# ---------------------------------------------------------------- examples


def example(command: Command) -> str:
    """Return a call that parses and that `check` finds nothing in, given what it names.

    Required arguments get a plausible value, accelerations and speeds of moves their defaults.
    """
    given = [sample(command, param) for param in command.params if param.is_required]
    for param in command.params:
        if not param.is_required and param.quantity.unit.startswith(("rad/", "m/")) and param.default:
            given.append(f"{param.name}={param.default_text}")
    call = f"{command.name}({', '.join(given)})"
    if command.name == "start_thread":
        return f"def work():\n  sleep(1)\nend\nhandle = {call}"
    return f"value = {call}" if command.details.returns_text else call


def sample(command: Command, param: Param) -> str:
    """Return a plausible value of a parameter as source text."""
    if param.name == "address" and command.name in _FREE_ADDRESSES:
        return _FREE_ADDRESSES[command.name]
    if command.name in _NUMERALS:
        return '"1.5"'
    if command.name in _OF_POINTS:
        return _POINTS[param.name]
    if isinstance(_plain_quantity(param.quantity), Text):
        return f'"{_TEXTS.get(param.name, "text")}"'
    return _sample(param.quantity)


def _plain_quantity(quantity: Quantity) -> Quantity:
    if isinstance(quantity, Optionally):
        return _plain_quantity(quantity.inner)
    return _plain_quantity(quantity.kinds[0]) if isinstance(quantity, Either) else quantity


def _sample(quantity: Quantity) -> str:
    quantity = _plain_quantity(quantity)
    if quantity.meaning in _SAMPLES:
        return _SAMPLES[quantity.meaning]
    if isinstance(quantity, Vector):
        return f"[{', '.join([_sample(quantity.element)] * (quantity.count or 2))}]"
    if isinstance(quantity, Choice):
        return repr(quantity.choices[0]).replace("'", '"')
    if isinstance(quantity, Boolean):
        return "True"
    if isinstance(quantity, Integer):
        return str(quantity.low or 0 if quantity.low is None or quantity.low >= 0 else 0)
    if isinstance(quantity, Number):
        return "0.1" if quantity.high is None or quantity.high >= 0.1 else f"{quantity.high:g}"
    if isinstance(quantity, Octets):
        return 'b"text"'
    return {"function": "work", "tuple": "()", "list[any]": "[1, 2]"}.get(quantity.type_name, '"text"')


# ---------------------------------------------------------------- signals


def signal_markdown(signal: Signal, name: str) -> str:
    """Return meaning, type and range of a signal."""
    limits = []
    if signal.low is not None or signal.high is not None:
        limits.append(f"{signal.low:g} to {signal.high:g}" if signal.low is not None else f"at most {signal.high:g}")
    limits.append(signal.unit)
    points = f"; points 0 to {signal.size - 1}" if signal.size > 1 else ""
    way = "input, set from outside" if signal.is_input else "output, set by programs"
    kept = "; kept when the controller is switched off" if signal.is_kept else ""
    kind = " ".join([signal.kind, *(part for part in limits if part)])
    return f"{fenced(name)}\n\n{signal.summary[:1].upper()}{signal.summary[1:]}.\n\n**{kind}**, {way}{points}{kept}."
