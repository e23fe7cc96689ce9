"""Writes the page of a run: the recorded mode of the front end, or the plain page where that is not built."""

from __future__ import annotations

import html
from base64 import b64encode
from typing import Final

from elitescript import page as built
from elitescript.plotting.conversation import packed
from elitescript.plotting.packing import shown_text
from elitescript.plotting.plain_page import plain_page
from elitescript.plotting.recording import Recording
from elitescript.records import NamedTuple

BYTES_MAX: Final = 1_000_000
"""Largest page of two minutes of robot time; those of longer runs grow with them."""
BYTES_OF_S: Final = 120.0

_TITLE: Final = b"@@title@@"
_RECORDING: Final = b"@@recording@@"


class Page(NamedTuple):
    """A page of a run.

    Attributes:
        text: of the HTML file.
        step_s: largest time between two rows, s, if rows were left out so that the page stays small; else 0.
    """

    text: str
    step_s: float


def page(recording: Recording, compared: Recording | None = None) -> str:
    """Return the text of the HTML file; see `page_of`."""
    return page_of(recording, compared).text


def page_of(recording: Recording, compared: Recording | None = None) -> Page:
    """Return the page of a run.

    Args:
        recording: that is shown.
        compared: another run over which it is laid; the plain page shows none.
    """
    if not built.is_built():
        return Page(plain_page(recording), 0.0)
    begin, end = built.built(built.RECORDED).split(_RECORDING)
    recordings = [recording] if compared is None else [recording, compared]
    longest_s = max(found.rows[-1].t - found.rows[0].t for found in recordings)
    room = round(BYTES_MAX * max(1.0, longest_s / BYTES_OF_S)) - len(begin) - len(end)
    data, step_s = packed(recordings, room * 3 // 4 - 100)
    title = html.escape(shown_text(" | ".join(found.title for found in recordings)))
    # The title may hold half a surrogate pair, so it is put into text.
    head = begin.decode().replace(_TITLE.decode(), title, 1)
    return Page(head + b64encode(data).decode() + end.decode(), step_s)
