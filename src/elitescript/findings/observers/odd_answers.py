"""Finds questions of `socket_get_var` whose answer came before them, behind a line of another form, or not at all."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import OddAnswer
from elitescript.said import said


class OddAnswers(Observer):
    """Tells of each channel once what came instead, what was passed over, and that answers are behind the questions."""

    __slots__ = ("_told",)

    def __init__(self) -> None:
        self._told: set[tuple[str, str]] = set()

    def see(self, seen: OddAnswer) -> Iterable[Finding]:
        """Tell what came."""
        name, question = seen.question.removeprefix("GET "), seen.question
        place = said("on {kind} {channel!r}", kind=seen.kind, channel=seen.channel)
        if seen.odd is not None and seen.is_late:
            what = "form"
            text = said(
                "the answer to {question!r} was {odd!r} {place}, not '{name} <int>': the value is 0",
                question=question,
                odd=seen.odd,
                place=place,
                name=name,
            )
            hint = "ask with socket_send_line and read with socket_read_string if the device answers in another form"
        elif seen.odd is not None:
            what = "passed"
            text = said(
                "{odd!r} came before the answer to {question!r} {place}, and is not '{name} <int>': it is passed over "
                "here; a controller may take it for the answer, and give 0",
                odd=seen.odd,
                question=question,
                place=place,
                name=name,
            )
            hint = 'read what answers socket_set_var before the question: socket_read_string with suffix="\\n"'
        elif seen.is_late:
            what = "late"
            text = said(
                "no answer to {question!r} came in time {place}: the value is 0", question=question, place=place
            )
            hint = "0 may be an answer too; one that comes later is taken for that to the next question"
        else:
            what = "behind"
            text = said(
                "the answer to {question!r} had come before it: {earlier!r}; it belongs to an earlier question, and so "
                "does every later answer {place}",
                question=question,
                earlier=seen.earlier,
                place=place,
            )
            hint = 'read late answers away before the next question: socket_read_string with suffix="\\n"'
        if (seen.channel, what) not in self._told:
            self._told.add((seen.channel, what))
            yield found("W281", text, line=seen.line, thread=seen.thread, hint=hint)
