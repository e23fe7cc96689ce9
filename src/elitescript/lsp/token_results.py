"""Remembers the semantic tokens that were sent, so that only what is different is sent next time."""

from __future__ import annotations

from itertools import count
from typing import Final

from lsprotocol import types

from elitescript.records import NamedTuple

_NUMBERS_OF_TOKEN: Final = 5


class _Sent(NamedTuple):
    """The tokens that a client has of a text."""

    result_id: str
    data: list[int]


class TokenResults:
    """Remembers the tokens that were sent, so that only what is different is sent next time."""

    __slots__ = ("_next", "_sent")

    def __init__(self) -> None:
        self._sent: dict[str, _Sent] = {}
        self._next = count(1)

    def full(self, uri: str, data: list[int]) -> types.SemanticTokens:
        """Return all tokens of a text."""
        sent = self._sent[uri] = _Sent(str(next(self._next)), data)
        return types.SemanticTokens(data, sent.result_id)

    def delta(self, uri: str, previous: str, data: list[int]) -> types.SemanticTokens | types.SemanticTokensDelta:
        """Return the difference from what the client has; all tokens if that is not known."""
        old = self._sent.get(uri)
        if old is None or old.result_id != previous:
            return self.full(uri, data)
        sent = self._sent[uri] = _Sent(str(next(self._next)), data)
        start, removed, added = difference(old.data, data)
        edits = [types.SemanticTokensEdit(start, removed, added)] if removed or added else []
        return types.SemanticTokensDelta(edits, sent.result_id)

    def forget(self, uri: str) -> None:
        """Forget a text that was closed."""
        self._sent.pop(uri, None)


def difference(old: list[int], new: list[int]) -> tuple[int, int, list[int]]:
    """Return where two lists of tokens differ: first number, how many go, and what comes in their place."""
    most = min(len(old), len(new)) // _NUMBERS_OF_TOKEN * _NUMBERS_OF_TOKEN
    start = 0
    while start < most and old[start : start + _NUMBERS_OF_TOKEN] == new[start : start + _NUMBERS_OF_TOKEN]:
        start += _NUMBERS_OF_TOKEN
    end = 0
    while (
        end < most - start
        and old[len(old) - end - _NUMBERS_OF_TOKEN : len(old) - end]
        == (new[len(new) - end - _NUMBERS_OF_TOKEN : len(new) - end])
    ):
        end += _NUMBERS_OF_TOKEN
    return start, len(old) - start - end, new[start : len(new) - end]
