"""Texts for people that keep their template and the values in it, so that other languages and programs can use both.

    >>> text = said("{command}: {value:g} rad is more than {limit}", command="movej", value=4.0, limit=3)
    >>> text
    'movej: 4 rad is more than 3'
    >>> text.template
    '{command}: {value} rad is more than {limit}'
    >>> text.values
    {'command': 'movej', 'value': '4', 'limit': 3}

Every text and hint of a finding, an alarm and a warning is one, or a constant. It equals its text and is used like it.
What makes another text of it (`+`, slices, `strip`, `join`, an f-string) makes a plain `str`: correct, but without its
template. So a part of a longer text is a value (`said("{text}; {rest}", text=text, rest=rest)`), and `joined` puts
texts of any number together.

A hole may say how its value is shown (`{x:.3f}`, `{name!r}`); the template has the name alone, and `values` what stands
there: a text, a whole number, or another such text. So `template.format(**values)` is the text, in any language.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any, Final

Json = dict[str, Any]

_HOLE: Final = re.compile(r"\{\{|\}\}|\{([^\W\d]\w*)(?:!([rs]))?(?::([^{}]*))?\}|[{}]")
"""A brace that stands for itself, a hole, or a brace that is a mistake."""
_TEMPLATES_MAX: Final = 4096
"""Templates that are kept as they were read; the texts of the product are fewer."""
_EXACT: Final = 2**53
"""From here on a whole number is shown as a text: not every reader of JSON has it exactly."""


class Said(str):
    """A text with its template and values; made by `said` and `joined`."""

    # Frozen, since programs of users hold texts of exceptions in their hands.
    __slots__ = ("_parts",)

    _parts: tuple[str, tuple[tuple[str, str | int], ...]]

    def __new__(cls, text: str = "") -> Said:
        """Make the text of a constant."""
        return _made(str(text), escaped(str(text)), ())

    @property
    def template(self) -> str:
        """The text with `{name}` in place of each value; braces that stand for themselves are doubled."""
        return self._parts[0]

    @property
    def values(self) -> dict[str, str | int]:
        """What stands in the holes, by name: texts, whole numbers and, in joined texts, other `Said`."""
        return dict(self._parts[1])

    def __reduce__(self) -> tuple[Any, ...]:
        return _made, (str(self), *self._parts)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"cannot assign to {name!r} of a text")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"cannot delete {name!r} of a text")


def said(template: str, /, **values: object) -> str:
    """Return a text of a template and its values: a `Said`, used like any other text.

    Args:
        template: the text with `{name}`, `{name!r}` or `{name:format}` for values; `{{` and `}}` for braces.
        values: one for each name.

    Raises:
        ValueError: a brace that is neither doubled nor one of a hole.
        KeyError: a hole without value.
    """
    plain, holes, is_plain = _READ.get(template) or _read(template)
    if is_plain and len(values) == len(holes):
        for value in values.values():
            if type(value) is not str and type(value) is not Said:
                break
        else:
            # Most texts; refusals that programs catch are made in loops.
            return _made(plain.format_map(values), plain, tuple(values.items()))  # type: ignore[arg-type]
    shown: dict[str, str | int] = {}
    for name, conversion, form in holes:
        value = values[name]
        kind = type(value)
        if conversion:
            shown[name] = format(repr(value) if conversion == "r" else str(value), form or "")
        elif form:
            shown[name] = format(value, form)
        elif kind is str or kind is Said or (kind is int and -_EXACT < value < _EXACT):  # type: ignore[operator]
            shown[name] = value  # type: ignore[assignment]
        else:
            shown[name] = format(value, "")
    return _made(plain.format_map(shown), plain, tuple(shown.items()))


def counted(count: int, one: str, many: str) -> str:
    """Return a number with its noun.

    >>> counted(1, "byte", "bytes"), counted(2, "byte", "bytes")
    ('1 byte', '2 bytes')
    """
    return said("{count} " + (one if count == 1 else many), count=count)


def joined(separator: str, texts: Iterable[str]) -> str:
    """Return texts with a separator between them, of which each keeps its template."""
    parts = list(texts)
    if len(parts) < 2:
        return parts[0] if parts else ""
    names = [f"part_{number}" for number in range(1, len(parts) + 1)]
    template = escaped(separator).join(f"{{{name}}}" for name in names)
    return _made(separator.join(parts), template, tuple(zip(names, parts, strict=True)))


def replaced(text: str, words: str, other: str) -> str:
    """Return a text with other words, in it and in its values."""
    if words not in text:
        return text
    if not isinstance(text, Said):
        return text.replace(words, other)
    values = {
        name: replaced(value, words, other) if isinstance(value, str) else value for name, value in text.values.items()
    }
    template = text.template.replace(escaped(words), escaped(other))
    return _made(template.format_map(values), template, tuple(values.items()))


def escaped(text: str) -> str:
    """Return a text as the template that makes it."""
    return text.replace("{", "{{").replace("}", "}}") if "{" in text or "}" in text else text


def template_of(text: str) -> str:
    """Return the template of a text; a plain text is a constant."""
    return text.template if isinstance(text, Said) else escaped(text)


def values_of(text: str) -> Json:
    """Return the values of a text as JSON has them; a text in it is an object with `text`, `template` and `values`."""
    if not isinstance(text, Said):
        return {}
    return {
        name: {"text": str(value), **parts_of(value)} if isinstance(value, Said) else value
        for name, value in text.values.items()
    }


def parts_of(text: str, prefix: str = "") -> Json:
    """Return `template` and `values` of a text as JSON has them, with `hint_` in front for example."""
    return {f"{prefix}template": template_of(text), f"{prefix}values": values_of(text)}


def rebuilt(text: str, template: str, values: Mapping[str, str | int]) -> Said:
    """Return a text of parts that another process has sent.

    Raises:
        ValueError: the template and the values do not make the text.
    """
    plain, holes, _ = _READ.get(template) or _read(template, is_kept=False)
    names = {name for name, _, _ in holes}
    if plain == template and names == values.keys():
        # A short template may make a text that fills the memory.
        lengths = {name: len(str(value)) for name, value in values.items()}
        size = sum(lengths[hole[1]] for hole in _HOLE.finditer(template) if hole[1])
        if size <= len(text) and template.format_map(values) == text:
            return _made(text, template, tuple(values.items()))
    raise ValueError("a text that its template and values do not make")


_Holes = tuple[tuple[str, str | None, str | None], ...]
_READ: Final[dict[str, tuple[str, _Holes, bool]]] = {}


def _read(template: str, *, is_kept: bool = True) -> tuple[str, _Holes, bool]:
    """Return a template with names alone in its holes, each name with conversion and format, and whether none has any.

    Raises:
        ValueError: a brace that is neither doubled nor one of a hole.
    """
    holes: dict[str, tuple[str, str | None, str | None]] = {}

    def plain(found: re.Match[str]) -> str:
        name, conversion, form = found.groups()
        if name is None:
            if len(found[0]) == 1:
                raise ValueError(f"a single brace in the template {template!r}")
            return found[0]
        if holes.setdefault(name, (name, conversion, form)) != (name, conversion, form):
            raise ValueError(f"{name} is shown in two ways in the template {template!r}")
        return f"{{{name}}}"

    text = _HOLE.sub(plain, template)
    read = text, tuple(holes.values()), text == template
    if is_kept:
        if len(_READ) >= _TEMPLATES_MAX:
            _READ.clear()
        _READ[template] = read
    return read


def _made(text: str, template: str, values: tuple[tuple[str, str | int], ...]) -> Said:
    made = str.__new__(Said, text)
    _set_parts(made, (template, values))
    return made


_set_parts: Final = Said._parts.__set__  # type: ignore[attr-defined]
