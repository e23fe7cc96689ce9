"""Shows the signature of the call around a place, and which argument stands there."""

from __future__ import annotations

from elitescript.assist.document import Document
from elitescript.records import NamedTuple, record


class ShownParameter(NamedTuple):
    """One parameter of a signature.

    Attributes:
        start, end: where it stands in the label; offsets in characters from 0, the end exclusive.
        markdown: text about it.
    """

    start: int
    end: int
    markdown: str


@record
class SignatureHelp:
    """The signature of one call.

    Attributes:
        label: the signature as text.
        markdown: what the function does.
        parameters: its parameters, in order.
        active: index of the parameter that stands at the place; None if it has none for it.
    """

    label: str
    markdown: str
    parameters: tuple[ShownParameter, ...]
    active: int | None


TRIGGERS = ("(", ",", "=")
"""Characters after which an editor should ask by itself."""


def signature_help(document: Document, line: int, column: int) -> SignatureHelp | None:
    """Return the signature of the innermost call around a place; None if there is no known one. Never raises."""
    return None
