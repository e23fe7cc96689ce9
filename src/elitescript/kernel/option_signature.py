"""Signature and docstring of a class that takes the options of a robot as keywords, from the options themselves."""

from __future__ import annotations

from typing import Any, TypeVar

from elitescript.kernel.options import DEFAULTS, IN_VIRTUAL_TIME, KEYWORDS, OPTIONS, RobotOptions

T = TypeVar("T")

_ENTRY = "**options: "


def takes_options(cls: type[T]) -> type[T]:
    """Name each option in signature and docstring of a class whose constructor takes `**options`; a decorator.

    Both are worked out when they are first read.
    """
    for name, value in (("__signature__", _Signature()), ("__doc__", _Docstring(cls.__doc__ or ""))):
        setattr(cls, name, value)
    return cls


def described(name: str) -> str:
    """Return what an option of a robot in virtual time means, with its default."""
    option = OPTIONS[name]
    return f"{option.text} (default: {option.default_text or repr(IN_VIRTUAL_TIME.get(name, DEFAULTS[name]))})"


class _Signature:
    __slots__ = ()

    def __get__(self, instance: object, owner: Any) -> Any:
        from inspect import Parameter, signature

        written = signature(owner.__init__)
        _, *own, _ = written.parameters.values()  # without `self` and `**options`
        defaults, types = {**DEFAULTS, **IN_VIRTUAL_TIME}, RobotOptions.__annotations__
        options = [
            Parameter(name, Parameter.KEYWORD_ONLY, default=defaults[name], annotation=types[name]) for name in KEYWORDS
        ]
        return written.replace(parameters=[*own, *options], return_annotation=Parameter.empty)


class _Docstring:
    __slots__ = ("_text",)

    def __init__(self, text: str) -> None:
        self._text = text

    def __get__(self, instance: object, owner: Any) -> str:
        from textwrap import fill

        head, _, rest = self._text.partition(_ENTRY)
        # From Python 3.13 on docstrings are less indented than their source.
        before = head.rpartition("\n")[2]
        lines = rest.splitlines(keepends=True)
        deeper = before + " "
        more = next((number for number, line in enumerate(lines[1:], 1) if not line.startswith(deeper)), len(lines))
        entries = [
            fill(f"{name}: {described(name)}.", 120, initial_indent=before, subsequent_indent=before + " " * 4)
            for name in KEYWORDS
        ]
        return head.removesuffix(before) + "".join(f"{entry}\n" for entry in entries) + "".join(lines[more:])
