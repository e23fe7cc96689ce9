"""How the robot answers a request whose result it alone knows: the text of a `Reply`.

`done` or `refused`, each with a detail if there is one. The port puts it into the words of its protocol. The reply
goes to the origin of the request as it came, exactly one for each request.
"""

from __future__ import annotations

from typing import Final, NamedTuple

DONE: Final = "done"
REFUSED: Final = "refused"


class Outcome(NamedTuple):
    """What became of a request."""

    is_done: bool
    detail: str
    """A value, or the reason of a refusal."""


def done(detail: str = "") -> str:
    """Return the text of a reply: it is done; the detail is a value that was asked for."""
    return f"{DONE}: {detail}" if detail else DONE


def refused(reason: str) -> str:
    """Return the text of a reply: it was not done, and why."""
    return f"{REFUSED}: {reason}"


def read_outcome(text: str) -> Outcome:
    """Read such a text; anything else counts as a refusal that says it."""
    word, _, detail = text.partition(": ")
    if word == DONE:
        return Outcome(True, detail)
    return Outcome(False, detail if word == REFUSED and detail else text)
