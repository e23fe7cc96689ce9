"""Shows texts that others wrote: programs, files, devices, clients, other computers.

In what is shown no character acts: none drives a terminal, none reverses the text, none is a command to the runner
of a CI job that reads the log; and no line of a text can pass for a line of the report in which it stands.

There are two layers. A report shows each text with `shown`, or `shown_word` where it is a name. The streams of the
command line pass what is printed through `printed`, which cannot tell texts from reports and so leaves line ends: they
are all that a text can do which was forgotten.

Runners: GitHub's trims a line, looks for `::` at its begin and for `##[` anywhere in it; that of Azure looks for
`##vso[`, that of TeamCity for `##teamcity[`. GitHub's and Azure's compare as .NET does: characters without a width
count for nothing.
"""

from __future__ import annotations

import re
from functools import cache
from typing import Final

HIDDEN: Final = r"\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u206f"
"""Control characters except line ends and tabs, separators of lines, and what changes the direction of text."""

HALVES: Final = r"\ud800-\udfff"
"""Halves of surrogate pairs, which are no characters: no encoding has them."""

OWN_COLORS: Final = ("0", "1;31", "33", "32", "36", "1", "2")
"""Colours that commands print on a terminal, as the terminal takes them."""

FURTHER: Final = "| "
"""Begin of the further lines of a text."""

_IGNORED: Final = (
    r"\xad\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u200b-\u200d\u2060-\u2065\u3164\ufe00-\ufe0f\ufeff\uffa0"
    r"\ufff0-\ufff8\U000e0000-\U000e0fff"
)
"""Characters without a width, which .NET leaves out when it compares (Unicode's `Default_Ignorable_Code_Point`)."""

_BLANK: Final = rf"\t\x0b-\r\x1c-\x20\x85\xa0\u1680\u2000-\u200a\u2028\u2029\u202f\u205f\u3000{_IGNORED}"
"""What a runner trims from the begin of a line; see `_IGNORED`."""

_LONE: Final = r"\r(?!\n)"
"""A carriage return that is no part of a line end."""

_WORD: Final = rf"[A-Za-z_.\-{_IGNORED}]*"

_ANYWHERE: Final = rf"(?P<anywhere>#[{_IGNORED}]*)#(?={_WORD}\[)"
"""Commands such as `##[error]`, `##vso[task.setvariable]` and `##teamcity[`."""

_BEGIN: Final = rf"(?P<begin>^(?:\| |E   )?[{_BLANK}]*:[{_IGNORED}]*):"
"""Commands such as `::error::`, also behind `FURTHER` and what pytest puts before the lines of an error."""

_LONE_HALF: Final = (
    r"\\u[dD][89abAB][0-9a-fA-F]{2}\\u[dD][c-fC-F][0-9a-fA-F]{2}|\\u(?P<half>[dD][89a-fA-F][0-9a-fA-F]{2})|\\."
)
"""Escapes in a string of JSON; `half` is that of half a surrogate pair alone."""


def shown(text: str) -> str:
    """Return a text of others as lines of a report; all but the first begin with `FURTHER`.

    Hidden characters are escapes such as `\\x1b` and `\\u202e`, line ends and tabs stay.
    """
    if _is_plain(text):
        return text
    return continued(_acting("\\r").sub(_escaped, text))


def continued(text: str) -> str:
    """Return a text as it is but for its further lines, which begin with `FURTHER`; see `printed` for the rest."""
    return text.replace("\n", f"\n{FURTHER}")


def shown_word(text: str) -> str:
    """Return a name that others gave (file, robot, thread): one line, whose line ends and tabs are escapes too."""
    if _is_plain(text):
        return text
    return _acting(r"[\t\n\r]").sub(_escaped, text)


def printed(text: str, *, has_colors: bool = False) -> str:
    """Return what a command prints, without what acts; line ends and tabs stay.

    Args:
        text: it.
        has_colors: whether colours of `OWN_COLORS` stay.
    """
    # Most lines end here; print() writes the line end alone.
    if text == "\n" or _is_plain(text.replace("\n", " ")):
        return text
    own = rf"(?P<own>\x1b\[(?:{'|'.join(OWN_COLORS)})m)|" if has_colors else ""
    return _acting(_LONE, own).sub(_escaped, text)


def printed_json(text: str) -> str:
    """Return JSON that a command prints with what acts as escapes of JSON; its values are the same."""
    if _is_plain(text.replace("\n", " ")):
        return text
    return _acting_in_json().sub(_json_escaped, text)


def visible(text: str) -> str:
    """Return a text with its hidden characters as escapes such as `\\u202e`; line ends and tabs stay."""
    return text if text.isprintable() else _hidden().sub(_escaped, text)


def encodable(text: str) -> str:
    """Return a text that has an encoding: halves of surrogate pairs are escapes such as `\\ud83d`."""
    return text if text.isascii() else text.encode("utf-8", "backslashreplace").decode()


def with_bytes(name: str) -> str:
    """Return the name of a file as the system has it, from what `encodable` has made of one."""
    if "\\udc" not in name:
        return name
    return re.sub(r"\\u(dc[89a-f][0-9a-f])", lambda found: chr(int(found[1], 16)), name)


def encodable_json(text: str) -> str:
    """Return JSON all of whose texts have an encoding: as by `encodable`, also where it has them as escapes of JSON."""
    text = encodable(text)
    if "\\ud" not in text and "\\uD" not in text:
        return text
    return re.sub(_LONE_HALF, lambda found: f"\\\\u{half}" if (half := found["half"]) else found[0], text)


def printable(text: str) -> str:
    """Return a text in one line as escapes of Python but for what Python calls printable, for forms without escapes."""
    if text.isprintable():
        return text
    return "".join(sign if sign.isprintable() else sign.encode("unicode_escape").decode() for sign in text)


def _is_plain(text: str) -> bool:
    """Return whether a text is certainly shown as it is: the way of nearly all, whose cost is that of every line."""
    if not text.isprintable():
        return False
    if text.isascii():
        return "##" not in text and "::" not in text
    # Between the two signs of a command there may be characters without a width.
    return text.count("#") < 2 and text.count(":") < 2


@cache
def _acting(more: str, own: str = "") -> re.Pattern[str]:
    """Return what is escaped: hidden characters, what `more` matches, and the begins of commands; `own` stays."""
    return re.compile(rf"{own}{_ANYWHERE}|{_BEGIN}|[{HIDDEN}{HALVES}]|{more}", re.MULTILINE)


@cache
def _acting_in_json() -> re.Pattern[str]:
    # No line of JSON begins with one of its texts.
    return re.compile(rf"{_ANYWHERE}|[{HIDDEN}{HALVES}]|{_LONE}")


@cache
def _hidden() -> re.Pattern[str]:
    return re.compile(rf"[{HIDDEN}{HALVES}]|{_LONE}")


def _escaped(found: re.Match[str]) -> str:
    kind = found.lastgroup
    if kind == "own":
        return found[0]
    return f"{visible(found[kind])}{_escape(found[0][-1])}" if kind else _escape(found[0])


def _json_escaped(found: re.Match[str]) -> str:
    return f"{found[0][:-1]}\\u{ord(found[0][-1]):04x}"


_NAMED: Final = {"\r": r"\r", "\n": r"\n", "\t": r"\t"}


def _escape(sign: str) -> str:
    code = ord(sign)
    return _NAMED.get(sign) or (f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}")
