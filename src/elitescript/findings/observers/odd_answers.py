"""Finds questions of `socket_get_var` whose answer came before them, behind a line of another form, or not at all."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import OddAnswer


class OddAnswers(Observer):
    """Tells of each channel once what came instead, what was passed over, and that answers are behind the questions."""

    __slots__ = ("_told",)

    def __init__(self) -> None:
        self._told: set[tuple[str, str]] = set()

    def see(self, seen: OddAnswer) -> Iterable[Finding]:
        """Tell what came."""
        question, form = repr(seen.question), f"'{seen.question.removeprefix('GET ')} <int>'"
        place = f"on {seen.kind} {seen.channel!r}"
        if seen.odd is not None and seen.is_late:
            what, text = "form", f"the answer to {question} was {seen.odd!r} {place}, not {form}: the value is 0"
            hint = "ask with socket_send_line and read with socket_read_string if the device answers in another form"
        elif seen.odd is not None:
            what, text = "passed", f"{seen.odd!r} came before the answer to {question} {place}, and is not {form}"
            text += ": it is passed over here; a controller may take it for the answer, and give 0"
            hint = 'read what answers socket_set_var before the question: socket_read_string with suffix="\\n"'
        elif seen.is_late:
            what, text = "late", f"no answer to {question} came in time {place}: the value is 0"
            hint = "0 may be an answer too; one that comes later is taken for that to the next question"
        else:
            what, text = "behind", f"the answer to {question} had come before it: {seen.earlier!r}; it belongs to an"
            text += f" earlier question, and so does every later answer {place}"
            hint = 'read late answers away before the next question: socket_read_string with suffix="\\n"'
        if (seen.channel, what) not in self._told:
            self._told.add((seen.channel, what))
            yield found("W281", text, line=seen.line, thread=seen.thread, hint=hint)
