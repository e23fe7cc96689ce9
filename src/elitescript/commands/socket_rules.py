"""Rules by which the reading commands of a socket parse received bytes.

A rule takes the unread bytes and whether no more will come; it returns the result, or None as long as more is needed,
and how many bytes are used up. See `context.Rule`.
"""

from __future__ import annotations

import codecs
from typing import Any, Final

from elitescript.messages.signals import INT32_HIGH, INT32_LOW
from elitescript.said import said

TEXT_MAX: Final = 2047
"""Bytes that `socket_read_string` returns at once."""

_INT_SIZE: Final = 4
_SEARCHED_MAX: Final = 16_384
"""Bytes that are searched for a mark before the first ones are dropped."""


class Counted:
    """So many values of some bytes each: a rule; after the timeout, the complete ones that have arrived."""

    __slots__ = ("_number", "_size")

    def __init__(self, number: int, size: int) -> None:
        self._number = number
        self._size = size

    def __call__(self, data: bytearray, is_last: bool) -> tuple[Any, int]:
        size = self._size
        count = min(self._number, len(data) // size)
        if count < self._number and not is_last:
            return None, 0
        if size == 1:
            return list(data[:count]), count
        ends = range(size, size * count + 1, size)
        return [int.from_bytes(data[end - size : end], "big", signed=True) for end in ends], size * count

    def lacks(self, data: bytes) -> tuple[str, str]:
        """Return how much of it has come; see `messages.observations.ReadingEnded`."""
        return "count", said("{count} of {number} bytes", count=len(data), number=self._number * self._size)


def integers(number: int) -> Counted:
    """Return the rule for signed 32-bit integers in network byte order."""
    return Counted(number, _INT_SIZE)


def octets(number: int) -> Counted:
    """Return the rule for bytes."""
    return Counted(number, 1)


class Floats:
    """Numbers as text in parentheses, between commas and blanks: a rule. What follows the parenthesis is left.

    What stands before the parenthesis is skipped. A list that is shorter than `number` is all that comes, of a longer
    one the rest is dropped, and one ends in front of what is no number (*assumed*). When time is up, the numbers of
    an unfinished list count that have something behind them (*assumed*).
    """

    __slots__ = ("_number", "dropped")

    def __init__(self, number: int) -> None:
        self._number = number
        self.dropped: tuple[str, int, int, int] | None = None
        """Of a list of which something was dropped: its text, how many were asked for, came, and were read."""

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
        text = data[begin + 1 : end].decode("latin-1")
        words = text.replace(",", " ").split()
        values = _numbers(words)[: self._number]
        if is_complete and len(values) < len(words):
            self.dropped = text, self._number, len(words), len(values)
        return values, end + is_complete

    def lacks(self, data: bytes) -> tuple[str, str]:
        """Return what is missing in data that gave no list; see `messages.observations.ReadingEnded`."""
        return "parenthesis", ")" if b"(" in data else "("


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

    def lacks(self, data: bytes) -> tuple[str, str]:
        """Return the mark that is missing in data that gave no text; see `messages.observations.ReadingEnded`."""
        what, mark = "suffix", self.suffix
        if self.prefix and self.prefix not in data:
            what, mark = "prefix", self.prefix
        return what, mark.decode("utf-8", "backslashreplace")


def _surplus(data: bytearray, mark: bytes) -> int:
    """Return how many bytes at the begin are dropped, as the mark is not in them."""
    return 0 if len(data) <= _SEARCHED_MAX else len(data) - len(mark) + 1


class Variable(Texts):
    """The number of a line `<name> <int>`, brought into 32 bits: a rule; 0 when time is up.

    Lines of another form are passed over (*assumed*), so that an acknowledgement that was not read does not shift every
    later answer by one question.
    """

    __slots__ = ("_name", "is_late", "odd")

    def __init__(self, name: str) -> None:
        super().__init__(b"", b"\n")
        self._name = name
        self.odd: str | None = None
        """The first line with another form, if one came; a blank one is none."""
        self.is_late = False
        """Whether no line of the form came in time."""

    def __call__(self, data: bytearray, is_last: bool) -> tuple[Any, int]:
        used = 0
        while True:
            line, size = super().__call__(data[used:], is_last)
            if not size:
                self.is_late = is_last
                return (0 if is_last else None), used
            used += size
            value = _value_of(line, self._name)
            if value is not None:
                return value, used
            if self.odd is None and line.strip():
                self.odd = line


def _value_of(answer: str, name: str) -> int | None:
    words = answer.split()
    if len(words) != 2 or words[0] != name:
        return None
    digits = words[1].lstrip("+-")
    if not (digits.isascii() and digits.isdigit()) or len(words[1]) - len(digits) > 1:
        return None
    return max(INT32_LOW, min(INT32_HIGH, int(words[1])))
