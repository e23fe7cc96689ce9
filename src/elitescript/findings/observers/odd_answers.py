"""Finds questions of `socket_get_var` whose answer belongs to another question, has another form, or is missing."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import OddAnswer
from elitescript.said import said


class OddAnswers(Observer):
    """Tells of each channel once what came instead, and once that its answers are behind the questions."""

    __slots__ = ("_told",)

    def __init__(self) -> None:
        self._told: set[tuple[str, str]] = set()

    def see(self, seen: OddAnswer) -> Iterable[Finding]:
        """Tell what came."""
        place = said("on {kind} {channel!r}", kind=seen.kind, channel=seen.channel)
        if seen.answer is None:
            odd = said(
                "the answer to {question!r} had come before it: {earlier!r}",
                question=seen.question,
                earlier=seen.earlier,
            )
        else:
            odd = said(
                "the answer to {question!r} was {answer!r}, not '{name} <int>': the value is 0",
                question=seen.question,
                answer=seen.answer,
                name=seen.question.removeprefix("GET "),
            )
        if seen.earlier.strip():
            what = "behind"
            text = said(
                "{odd}; it belongs to what was sent before, and so does every later answer {place}",
                odd=odd,
                place=place,
            )
            hint = 'read every answer before the next question, those to socket_set_var too, with suffix="\\n"'
        elif seen.is_late:
            what = "late"
            text = said(
                "no answer to {question!r} came in time {place}: the value is 0", question=seen.question, place=place
            )
            hint = "0 may be an answer too; one that comes later is taken for that to the next question"
        else:
            what, text = "form", odd
            hint = "ask with socket_send_line and read with socket_read_string if the device answers in another form"
        if (seen.channel, what) not in self._told:
            self._told.add((seen.channel, what))
            yield found("W281", text, line=seen.line, thread=seen.thread, hint=hint)
