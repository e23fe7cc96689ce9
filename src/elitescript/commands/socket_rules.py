"""Rules by which the reading commands of a socket parse received bytes.

A rule takes the unread bytes and whether no more will come; it returns the result, or None as long as more is needed,
and how many bytes are used up. See `context.Rule`.
"""

from __future__ import annotations

import codecs
from typing import Any, Final

from elitescript.commands.definition.context import Rule
from elitescript.messages.signals import INT32_HIGH, INT32_LOW

TEXT_MAX: Final = 2047
"""Bytes that `socket_read_string` returns at once."""

_INT_SIZE: Final = 4
_SEARCHED_MAX: Final = 16_384
"""Bytes that are searched for a mark before the first ones are dropped."""


def integers(number: int) -> Rule:
    """Return the rule for signed 32-bit integers in network byte order; after the timeout, the complete ones."""

    def rule(data: bytearray, is_last: bool) -> tuple[Any, int]:
        count = min(number, len(data) // _INT_SIZE)
        if count < number and not is_last:
            return None, 0
        ends = range(_INT_SIZE, _INT_SIZE * count + 1, _INT_SIZE)
        values = [int.from_bytes(data[end - _INT_SIZE : end], "big", signed=True) for end in ends]
        return values, _INT_SIZE * count

    return rule


def octets(number: int) -> Rule:
    """Return the rule for bytes; after the timeout, those that have arrived."""

    def rule(data: bytearray, is_last: bool) -> tuple[Any, int]:
        if len(data) < number and not is_last:
            return None, 0
        return list(data[:number]), min(number, len(data))

    return rule


class Floats:
    """Numbers as text in parentheses, between commas and blanks: a rule. What follows the parenthesis is left.

    What stands before the parenthesis is skipped. A list that is shorter than `number` is all that comes, of a longer
    one the rest is dropped, and one ends in front of what is no number (*assumed*). When time is up, the numbers of
    an unfinished list count that have something behind them (*assumed*).
    """

    __slots__ = ("_number",)

    def __init__(self, number: int) -> None:
        self._number = number

    def __call__(self, data: bytearray, is_last: bool) -> tuple[Any, int]:
        begin = data.find(b"(")
        if begin < 0:
            return ([], 0) if is_last else (None, len(data) if len(data) > TEXT_MAX else 0)
        end = data.find(b")", begin)
        is_complete = end >= 0
        if not is_complete:
            if not is_last and len(data) - begin <= TEXT_MAX:
                return None, begin
            end = 1 + max(data.rfind(separator, begin) for separator in (b",", b" ", b"("))
        words = data[begin + 1 : end].decode("latin-1").replace(",", " ").split()
        return _numbers(words)[: self._number], end + is_complete


def _numbers(words: list[str]) -> list[float]:
    values = []
    for word in words:
        try:
            # Python also accepts digits in groups, which the protocol does not have.
            values.append(float(word.replace("_", "x")))
        except ValueError:
            break
    return values


class Texts:
    """Text behind, in front of or between marks, or all there is without them: a rule; empty when time is up.

    What stands before the prefix is skipped. A text that is too long comes in parts. Bytes that are not UTF-8 are
    replaced; a character of which the last bytes have not arrived stays for the next time (*assumed*).
    """

    __slots__ = ("prefix", "suffix")

    def __init__(self, prefix: bytes, suffix: bytes) -> None:
        self.prefix = prefix
        self.suffix = suffix

    def __call__(self, data: bytearray, is_last: bool) -> tuple[Any, int]:
        prefix, suffix = self.prefix, self.suffix
        begin = 0
        if prefix:
            begin = data.find(prefix)
            if begin < 0:
                return ("", 0) if is_last else (None, _surplus(data, prefix))
            begin += len(prefix)
        if suffix:
            end = data.find(suffix, begin)
            if 0 <= end <= begin + TEXT_MAX:
                return data[begin:end].decode("utf-8", "replace"), end + len(suffix)
            if end < 0 and len(data) < begin + TEXT_MAX + len(suffix):
                return ("" if is_last else None), 0
        found = data[begin : begin + TEXT_MAX]
        part, used = codecs.utf_8_decode(found, "replace", False)
        if is_last and not part:
            part, used = codecs.utf_8_decode(found, "replace", True)
        if part or is_last:
            return part, begin + used if part else 0
        return None, 0


def _surplus(data: bytearray, mark: bytes) -> int:
    """Return how many bytes at the begin are dropped, as the mark is not in them."""
    return 0 if len(data) <= _SEARCHED_MAX else len(data) - len(mark) + 1


class Variable(Texts):
    """The number of a line `<name> <int>`, brought into 32 bits: a rule; 0 for any other line and when time is up."""

    __slots__ = ("_name",)

    def __init__(self, name: str) -> None:
        super().__init__(b"", b"\n")
        self._name = name

    def __call__(self, data: bytearray, is_last: bool) -> tuple[Any, int]:
        answer, used = super().__call__(data, is_last)
        return (None if answer is None else _value_of(answer, self._name)), used


def _value_of(answer: str, name: str) -> int:
    words = answer.split()
    if len(words) != 2 or words[0] != name:
        return 0
    digits = words[1].lstrip("+-")
    if not (digits.isascii() and digits.isdigit()) or len(words[1]) - len(digits) > 1:
        return 0
    return max(INT32_LOW, min(INT32_HIGH, int(words[1])))
