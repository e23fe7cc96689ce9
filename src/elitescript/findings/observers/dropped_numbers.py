"""Finds lists of numbers of which a reading has dropped a part."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import NumbersDropped


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
        place = f"on {seen.kind} {seen.channel!r}"
        if is_surplus:
            text = (
                f"{seen.came} numbers came {place}, {seen.asked} were asked for: '({seen.text})'; the others are gone"
            )
            is_comma = seen.came == 2 * seen.asked and seen.text.count(",") >= seen.asked
            hint = (
                "decimal commas? the sender must write decimal points, since a comma separates numbers"
                if is_comma
                else "ask for as many numbers as the sender writes"
            )
        else:
            text = (
                f"{seen.read} of {seen.asked} numbers were read {place} from '({seen.text})': what follows is no number"
            )
            hint = "commas and blanks separate numbers, and each has a decimal point: (1.5, 2.5)"
        yield found("W282", text, line=seen.line, thread=seen.thread, hint=hint)
