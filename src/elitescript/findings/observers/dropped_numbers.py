"""Finds lists of numbers of which a reading has dropped a part."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import NumbersDropped
from elitescript.said import said


class DroppedNumbers(Observer):
    """Tells of each channel once that more numbers came than were asked for, and once what is no number."""

    __slots__ = ("_told",)

    def __init__(self) -> None:
        self._told: set[tuple[str, bool]] = set()

    def see(self, seen: NumbersDropped) -> Iterable[Finding]:
        """Tell what was dropped."""
        is_surplus = seen.read == seen.asked
        if (seen.channel, is_surplus) in self._told:
            return
        self._told.add((seen.channel, is_surplus))
        place = said("on {kind} {channel!r}", kind=seen.kind, channel=seen.channel)
        if is_surplus:
            text = said(
                "{came} numbers came {place}, {asked} were asked for: '({text})'; the others are gone",
                came=seen.came,
                place=place,
                asked=seen.asked,
                text=seen.text,
            )
            is_comma = seen.came == 2 * seen.asked and seen.text.count(",") >= seen.asked
            hint = (
                "decimal commas? the sender must write decimal points, since a comma separates numbers"
                if is_comma
                else "ask for as many numbers as the sender writes"
            )
        else:
            text = said(
                "{read} of {asked} numbers were read {place} from '({text})': what follows is no number",
                read=seen.read,
                asked=seen.asked,
                place=place,
                text=seen.text,
            )
            hint = "commas and blanks separate numbers, and each has a decimal point: (1.5, 2.5)"
        yield found("W282", text, line=seen.line, thread=seen.thread, hint=hint)
