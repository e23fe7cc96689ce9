"""Answers what helps while reading and typing: hover, completion, signatures."""

from __future__ import annotations

from typing import Any, Final

from lsprotocol import types

from elitescript.assist import completion, signatures
from elitescript.assist.completion import Completion, ItemKind
from elitescript.assist.document import Document
from elitescript.assist.hover import hover
from elitescript.lint.program import Span
from elitescript.lsp.feature import Feature, markup
from elitescript.lsp.positions import UTF16, units
from elitescript.lsp.session import Session

_KINDS: Final = {
    ItemKind.COMMAND: types.CompletionItemKind.Function,
    ItemKind.FUNCTION: types.CompletionItemKind.Function,
    ItemKind.CLASS: types.CompletionItemKind.Class,
    ItemKind.FIELD: types.CompletionItemKind.Field,
    ItemKind.VARIABLE: types.CompletionItemKind.Variable,
    ItemKind.CONSTANT: types.CompletionItemKind.Constant,
    ItemKind.ARGUMENT: types.CompletionItemKind.Property,
    ItemKind.KEYWORD: types.CompletionItemKind.Keyword,
    ItemKind.SNIPPET: types.CompletionItemKind.Snippet,
    ItemKind.MODULE: types.CompletionItemKind.Module,
    ItemKind.METHOD: types.CompletionItemKind.Method,
    ItemKind.VALUE: types.CompletionItemKind.EnumMember,
    ItemKind.NAME: types.CompletionItemKind.Value,
    ItemKind.FILE: types.CompletionItemKind.File,
}

_NOWHERE: Final = Span(1, 1, 1, 1)


def _hover(session: Session, document: Document, params: types.HoverParams) -> types.Hover | None:
    positions = session.positions(document)
    found = hover(document, *positions.place(params.position), session.last_run(params.text_document.uri))
    return None if found is None else types.Hover(markup(found.markdown), positions.range(found.span))


def _completion(session: Session, document: Document, params: types.CompletionParams) -> types.CompletionList:
    positions = session.positions(document)
    offers, is_all = completion.fitting_completions(document, *positions.place(params.position))
    ranges = {offer.span: positions.range(offer.span) for offer in offers}
    has_snippets = session.client.has("text_document.completion.completion_item.snippet_support")
    return types.CompletionList(not is_all, [_item(offer, ranges[offer.span], has_snippets) for offer in offers])


def _item(offer: Completion, place: types.Range, has_snippets: bool) -> types.CompletionItem:
    is_snippet = has_snippets and offer.snippet != ""
    is_struck = offer.is_missing or offer.is_deprecated
    return types.CompletionItem(
        offer.label,
        kind=_KINDS[offer.kind],
        detail=offer.detail or None,
        documentation=markup(offer.documentation) if offer.documentation else None,
        tags=[types.CompletionItemTag.Deprecated] if is_struck else None,
        sort_text=offer.sort or None,
        insert_text_format=types.InsertTextFormat.Snippet if is_snippet else types.InsertTextFormat.PlainText,
        text_edit=types.TextEdit(place, offer.snippet if is_snippet else offer.text),
        data={"kind": str(offer.kind), "source": offer.source} if offer.source else None,
    )


def _resolve(session: Session, document: None, item: types.CompletionItem) -> types.CompletionItem:
    data: Any = item.data
    if isinstance(data, dict) and isinstance(data.get("source"), str) and data.get("kind") in set(ItemKind):
        # The item carries all that is needed, so no text has to be the one that it was offered for.
        offer = Completion(item.label, ItemKind(data["kind"]), _NOWHERE, item.label, source=data["source"])
        documentation = completion.resolved(offer).documentation
        if documentation:
            item.documentation = markup(documentation)
    return item


def _signature_help(
    session: Session, document: Document, params: types.SignatureHelpParams
) -> types.SignatureHelp | None:
    found = signatures.signature_help(document, *session.positions(document).place(params.position))
    if found is None:
        return None
    parameters = [
        types.ParameterInformation(
            # The protocol counts in labels in UTF-16, whatever it counts in texts.
            (units(found.label[: shown.start], UTF16), units(found.label[: shown.end], UTF16)),
            markup(shown.markdown) if shown.markdown else None,
        )
        for shown in found.parameters
    ]
    # A number outside the list is how to say that no parameter is active.
    active = len(parameters) if found.active is None else found.active
    one = types.SignatureInformation(found.label, markup(found.markdown), parameters, active)
    return types.SignatureHelp([one], 0, active)


FEATURES: Final = {
    types.TEXT_DOCUMENT_HOVER: Feature(_hover),
    types.TEXT_DOCUMENT_COMPLETION: Feature(
        _completion, types.CompletionOptions(trigger_characters=list(completion.TRIGGERS), resolve_provider=True)
    ),
    types.COMPLETION_ITEM_RESOLVE: Feature(_resolve),
    types.TEXT_DOCUMENT_SIGNATURE_HELP: Feature(
        _signature_help, types.SignatureHelpOptions(trigger_characters=list(signatures.TRIGGERS))
    ),
}
