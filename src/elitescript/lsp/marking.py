"""Answers what is shown in and between the lines: colours of names, hints, lenses."""

from __future__ import annotations

from itertools import count
from typing import TYPE_CHECKING, Final

from lsprotocol import types

from elitescript.assist.document import Document
from elitescript.assist.hints import HintKind, inlay_hints
from elitescript.assist.lenses import code_lenses
from elitescript.assist.tokens import TOKEN_MODIFIERS, TOKEN_TYPES, semantic_tokens
from elitescript.lint.program import Span
from elitescript.lsp.feature import Feature, markup
from elitescript.records import NamedTuple

if TYPE_CHECKING:
    from elitescript.lsp.server import Server

_TYPE_NUMBERS: Final = {kind: number for number, kind in enumerate(TOKEN_TYPES)}
_MODIFIER_BITS: Final = {modifier: 1 << number for number, modifier in enumerate(TOKEN_MODIFIERS)}
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


def _data(server: Server, document: Document, span: Span | None = None) -> list[int]:
    """Return the tokens of a text as the protocol counts them: each from the one before."""
    positions = server.positions(document)
    data: list[int] = []
    line = start = 0
    for token in semantic_tokens(document, span):
        place = positions.position(token.line, token.column)
        length = positions.length(token.line, token.column, token.length)
        bits = sum(_MODIFIER_BITS[modifier] for modifier in token.modifiers)
        along = place.character - start if place.line == line else place.character
        data += (place.line - line, along, length, _TYPE_NUMBERS[token.type], bits)
        line, start = place.line, place.character
    return data


def _tokens(server: Server, document: Document, params: types.SemanticTokensParams) -> types.SemanticTokens:
    return server.tokens.full(params.text_document.uri, _data(server, document))


def _tokens_delta(
    server: Server, document: Document, params: types.SemanticTokensDeltaParams
) -> types.SemanticTokens | types.SemanticTokensDelta:
    return server.tokens.delta(params.text_document.uri, params.previous_result_id, _data(server, document))


def _tokens_of_range(
    server: Server, document: Document, params: types.SemanticTokensRangeParams
) -> types.SemanticTokens:
    return types.SemanticTokens(_data(server, document, server.positions(document).span(params.range)))


def _inlay_hints(server: Server, document: Document, params: types.InlayHintParams) -> list[types.InlayHint]:
    positions = server.positions(document)
    found = inlay_hints(document, positions.span(params.range), server.last_run(params.text_document.uri))
    return [
        types.InlayHint(
            positions.position(hint.line, hint.column),
            hint.label,
            kind=types.InlayHintKind.Parameter if hint.kind is HintKind.ARGUMENT else None,
            tooltip=markup(hint.tooltip) if hint.tooltip else None,
            padding_left=hint.pads_left or None,
            padding_right=hint.pads_right or None,
        )
        for hint in found
    ]


def _code_lenses(server: Server, document: Document, params: types.CodeLensParams) -> list[types.CodeLens]:
    positions = server.positions(document)
    uri = params.text_document.uri
    return [
        types.CodeLens(positions.range(lens.span), types.Command(lens.title, lens.command, None, [uri]))
        for lens in code_lenses(document, server.last_run(uri))
    ]


FEATURES: Final = {
    types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL: Feature(
        _tokens,
        types.SemanticTokensLegend([str(kind) for kind in TOKEN_TYPES], [str(one) for one in TOKEN_MODIFIERS]),
    ),
    types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL_DELTA: Feature(_tokens_delta),
    types.TEXT_DOCUMENT_SEMANTIC_TOKENS_RANGE: Feature(_tokens_of_range),
    types.TEXT_DOCUMENT_INLAY_HINT: Feature(_inlay_hints),
    types.TEXT_DOCUMENT_CODE_LENS: Feature(_code_lenses),
}
