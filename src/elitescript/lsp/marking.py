"""Answers what is shown in and between the lines: colours of names, hints, lenses."""

from __future__ import annotations

from typing import Final

from lsprotocol import types

from elitescript.assist.document import Document
from elitescript.assist.hints import HintKind, inlay_hints
from elitescript.assist.lenses import code_lenses
from elitescript.assist.tokens import TOKEN_MODIFIERS, TOKEN_TYPES, semantic_tokens
from elitescript.lint.program import Span
from elitescript.lsp.feature import Feature, markup
from elitescript.lsp.session import Session

_TYPE_NUMBERS: Final = {kind: number for number, kind in enumerate(TOKEN_TYPES)}
_MODIFIER_BITS: Final = {modifier: 1 << number for number, modifier in enumerate(TOKEN_MODIFIERS)}


def _data(session: Session, document: Document, span: Span | None = None) -> list[int]:
    """Return the tokens of a text as the protocol counts them: each from the one before."""
    positions = session.positions(document)
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


def _tokens(session: Session, document: Document, params: types.SemanticTokensParams) -> types.SemanticTokens:
    return session.tokens.full(params.text_document.uri, _data(session, document))


def _tokens_delta(
    session: Session, document: Document, params: types.SemanticTokensDeltaParams
) -> types.SemanticTokens | types.SemanticTokensDelta:
    return session.tokens.delta(params.text_document.uri, params.previous_result_id, _data(session, document))


def _tokens_of_range(
    session: Session, document: Document, params: types.SemanticTokensRangeParams
) -> types.SemanticTokens:
    return types.SemanticTokens(_data(session, document, session.positions(document).span(params.range)))


def _inlay_hints(session: Session, document: Document, params: types.InlayHintParams) -> list[types.InlayHint]:
    positions = session.positions(document)
    found = inlay_hints(document, positions.span(params.range), session.last_run(params.text_document.uri))
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


def _code_lenses(session: Session, document: Document, params: types.CodeLensParams) -> list[types.CodeLens]:
    positions = session.positions(document)
    uri = params.text_document.uri
    return [
        types.CodeLens(positions.range(lens.span), types.Command(lens.title, lens.command, None, [uri]))
        for lens in code_lenses(document, session.last_run(uri))
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
