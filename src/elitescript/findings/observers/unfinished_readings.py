"""Finds readings that ended by their timeout although data was there, which lacked the mark that would end it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import ReadingEnded, ReadingResumed
from elitescript.said import Said, said

PATIENT_S: Final = 0.5
"""A reading that has waited so long has not merely looked whether a text is complete."""


class UnfinishedReadings(Observer):
    """Tells of each channel once what is there and what is missing.

    A shorter reading may only look whether more has come: it is told at the end of the program, unless a later one has
    brought the data.
    """

    __slots__ = ("_pending", "_told")

    def __init__(self) -> None:
        self._pending: dict[str, ReadingEnded] = {}
        self._told: set[tuple[str, bool]] = set()

    def see(self, seen: ReadingEnded | ReadingResumed) -> Iterable[Finding]:
        """Tell of a long reading, and keep a short one."""
        if isinstance(seen, ReadingResumed):
            self._pending.pop(seen.channel, None)
        elif seen.lacks == "count":
            yield from self._tell(seen)
        elif seen.data.strip(b"\r\n\0 ") and not _is_encoded(seen.data):
            if seen.waited_s >= PATIENT_S:
                yield from self._tell(seen)
            else:
                self._pending.setdefault(seen.channel, seen)

    def end(self, ending: str) -> Iterable[Finding]:
        """Tell of what no later reading has brought."""
        for seen in self._pending.values():
            yield from self._tell(seen)

    def _tell(self, seen: ReadingEnded) -> Iterable[Finding]:
        key = seen.channel, seen.lacks == "count"
        if key in self._told:
            return
        self._told.add(key)
        place = said("{kind} {channel!r}", kind=seen.kind, channel=seen.channel)
        there = repr(seen.data.decode("utf-8", "backslashreplace"))
        if seen.lacks == "count":
            text = said(
                "a reading on {place} ended by its timeout with {wanted}: {there}",
                place=place,
                wanted=seen.wanted,
                there=there,
            )
            yield found("N283", text, line=seen.line, thread=seen.thread, hint=_COUNT)
            return
        missing = said("{part} {mark!r}", part=Said(seen.lacks), mark=seen.wanted)
        text = said(
            "a reading on {place} ended by its timeout although {there} is there: its {missing} has not come",
            place=place,
            there=there,
            missing=missing,
        )
        yield found("W283", text, line=seen.line, thread=seen.thread, hint=_advice(seen))


_COUNT: Final = "ask for as many bytes as the sender sends, or look at the number that the reading gives"


def _is_encoded(data: bytes) -> bool:
    """Return whether data is a text in GBK, which has a warning of its own."""
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        return bool(data.decode("gbk", "ignore").strip())
    return False


def _advice(seen: ReadingEnded) -> str:
    if seen.lacks == "parenthesis":
        return "numbers are read between parentheses: the sender must write (1.5, 2.5)"
    if seen.lacks == "prefix":
        is_line_end = not seen.wanted.strip("\r\n")
        return (
            "the argument behind the name is the prefix: write suffix=" if is_line_end else "does the sender send it?"
        )
    for end in ("\r\n", "\n", "\r"):
        if seen.data.endswith(end.encode()):
            return said("the sender ends its texts with {end!r}: read with that suffix", end=end)
    return "the sender has not ended its text, or ends it in another way"
