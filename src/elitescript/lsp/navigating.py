"""Answers where names are, what a text is made of, and what calls what."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from lsprotocol import types
from pygls.uris import from_fs_path

from elitescript.assist import calls, folding, links, outline, references, selection
from elitescript.assist.calls import Call, CallItem
from elitescript.assist.document import Document
from elitescript.assist.folding import FoldKind
from elitescript.assist.links import FileKind
from elitescript.assist.names import Access
from elitescript.assist.outline import Symbol, SymbolKind
from elitescript.lint.program import Span
from elitescript.lsp.feature import Feature, refuse_generated
from elitescript.lsp.positions import Positions
from elitescript.lsp.session import Session
from elitescript.lsp.texts import path_of

_SYMBOLS: Final = {
    SymbolKind.PROGRAM: types.SymbolKind.Module,
    SymbolKind.SECONDARY: types.SymbolKind.Module,
    SymbolKind.FUNCTION: types.SymbolKind.Function,
    SymbolKind.THREAD: types.SymbolKind.Event,
    SymbolKind.CLASS: types.SymbolKind.Class,
    SymbolKind.METHOD: types.SymbolKind.Method,
    SymbolKind.NODE: types.SymbolKind.Key,
}
_ACCESS: Final = {
    Access.READ: types.DocumentHighlightKind.Read,
    Access.WRITE: types.DocumentHighlightKind.Write,
    Access.TEXT: types.DocumentHighlightKind.Text,
}
_FOLDS: Final = {
    FoldKind.COMMENT: types.FoldingRangeKind.Comment,
    FoldKind.IMPORTS: types.FoldingRangeKind.Imports,
    FoldKind.REGION: types.FoldingRangeKind.Region,
}


def _definition(
    session: Session, document: Document, params: types.DefinitionParams | types.DeclarationParams
) -> list[types.Location]:
    positions = session.positions(document)
    found = references.definition(document, *positions.place(params.position))
    return [types.Location(params.text_document.uri, positions.range(span)) for span in found]


def _references(session: Session, document: Document, params: types.ReferenceParams) -> list[types.Location]:
    refuse_generated(document)
    positions = session.positions(document)
    found = references.references(document, *positions.place(params.position), params.context.include_declaration)
    return [types.Location(params.text_document.uri, positions.range(reference.span)) for reference in found]


def _highlights(
    session: Session, document: Document, params: types.DocumentHighlightParams
) -> list[types.DocumentHighlight]:
    positions = session.positions(document)
    found = references.highlights(document, *positions.place(params.position))
    return [types.DocumentHighlight(positions.range(one.span), _ACCESS[one.access]) for one in found]


# ---------------------------------------------------------------- symbols


def _document_symbols(
    session: Session, document: Document, params: types.DocumentSymbolParams
) -> Sequence[types.DocumentSymbol] | Sequence[types.SymbolInformation]:
    positions = session.positions(document)
    symbols = outline.document_symbols(document)
    if session.client.has("text_document.document_symbol.hierarchical_document_symbol_support"):
        return [_tree(symbol, positions) for symbol in symbols]
    flat: list[types.SymbolInformation] = []
    _flatten(symbols, "", params.text_document.uri, positions, flat)
    return flat


def _tree(symbol: Symbol, positions: Positions) -> types.DocumentSymbol:
    return types.DocumentSymbol(
        # Editors refuse an empty name.
        name=symbol.name or symbol.kind,
        kind=_SYMBOLS[symbol.kind],
        range=positions.range(symbol.span),
        selection_range=positions.range(symbol.name_span),
        detail=symbol.detail or None,
        children=[_tree(child, positions) for child in symbol.children],
    )


def _flatten(
    symbols: Sequence[Symbol], container: str, uri: str, positions: Positions, found: list[types.SymbolInformation]
) -> None:
    for symbol in symbols:
        found.append(_information(symbol, container, uri, positions))
        _flatten(symbol.children, symbol.name, uri, positions, found)


def _information(symbol: Symbol, container: str, uri: str, positions: Positions) -> types.SymbolInformation:
    place = types.Location(uri, positions.range(symbol.span))
    return types.SymbolInformation(
        place, symbol.name or symbol.kind, _SYMBOLS[symbol.kind], container_name=container or None
    )


async def _workspace_symbols(
    session: Session, document: None, params: types.WorkspaceSymbolParams
) -> list[types.SymbolInformation]:
    def search() -> list[types.SymbolInformation]:
        texts = {text.name: (uri, text) for uri, text in session.all_texts(opened)}
        found = []
        for symbol in outline.workspace_symbols([text for _, text in texts.values()], params.query):
            uri, text = texts[symbol.document]
            found.append(_information(symbol.symbol, symbol.container, uri, session.positions(text)))
        return found

    opened = session.twins()
    return await session.in_thread(search)


# ---------------------------------------------------------------- structure


def _folding_ranges(session: Session, document: Document, params: types.FoldingRangeParams) -> list[types.FoldingRange]:
    return [
        types.FoldingRange(fold.line - 1, fold.end_line - 1, kind=_FOLDS.get(fold.kind))
        for fold in folding.folding_ranges(document)
    ]


def _selection_ranges(
    session: Session, document: Document, params: types.SelectionRangeParams
) -> list[types.SelectionRange]:
    positions = session.positions(document)
    places = [positions.place(position) for position in params.positions]
    return [_nested(spans, positions) for spans in selection.selection_ranges(document, places)]


def _nested(spans: Sequence[Span], positions: Positions) -> types.SelectionRange:
    outer: types.SelectionRange | None = None
    for span in reversed(spans):
        outer = types.SelectionRange(positions.range(span), outer)
    return outer or types.SelectionRange(positions.range(Span(1, 1, 1, 1)))


def _links(session: Session, document: Document, params: types.DocumentLinkParams) -> list[types.DocumentLink]:
    positions = session.positions(document)
    path = path_of(params.text_document.uri)
    if path is None:
        return []
    folder = session.texts.folder_of(params.text_document.uri)
    found = []
    for link in links.document_links(document):
        homes = [path.parent]
        if link.kind is FileKind.NAMED and folder is not None:
            homes.append(session.texts.folders[folder])
        target = next((home / link.path for home in homes if _is_file(home / link.path)), None)
        if target is not None:
            found.append(types.DocumentLink(positions.range(link.span), from_fs_path(str(target.resolve()))))
    return found


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        # What stands in a text need not be a possible name.
        return False


# ---------------------------------------------------------------- calls


def _prepare_calls(
    session: Session, document: Document, params: types.CallHierarchyPrepareParams
) -> list[types.CallHierarchyItem]:
    positions = session.positions(document)
    found = calls.prepare(document, *positions.place(params.position))
    return [_call_item(item, params.text_document.uri, positions) for item in found]


def _incoming(
    session: Session, document: Document, params: types.CallHierarchyIncomingCallsParams
) -> list[types.CallHierarchyIncomingCall]:
    positions = session.positions(document)
    return [
        types.CallHierarchyIncomingCall(
            _call_item(call.item, params.item.uri, positions), [positions.range(span) for span in call.spans]
        )
        for call in _calls(document, params.item, positions, is_incoming=True)
    ]


def _outgoing(
    session: Session, document: Document, params: types.CallHierarchyOutgoingCallsParams
) -> list[types.CallHierarchyOutgoingCall]:
    positions = session.positions(document)
    return [
        types.CallHierarchyOutgoingCall(
            _call_item(call.item, params.item.uri, positions), [positions.range(span) for span in call.spans]
        )
        for call in _calls(document, params.item, positions, is_incoming=False)
    ]


def _calls(
    document: Document, shown: types.CallHierarchyItem, positions: Positions, *, is_incoming: bool
) -> Sequence[Call]:
    """Return the calls of an item that a client sends back; it is identified by the place of its name."""
    span = positions.span(shown.selection_range)
    kind = next((kind for kind, number in _SYMBOLS.items() if number == shown.kind), SymbolKind.FUNCTION)
    usual = CallItem(shown.name, kind, shown.detail or "", positions.span(shown.range), span)
    found = calls.prepare(document, span.line, span.column)
    item = next((item for item in found if item.name_span == span), usual)
    return calls.incoming(document, item) if is_incoming else calls.outgoing(document, item)


def _call_item(item: CallItem, uri: str, positions: Positions) -> types.CallHierarchyItem:
    return types.CallHierarchyItem(
        name=item.name,
        kind=_SYMBOLS[item.kind],
        uri=uri,
        range=positions.range(item.span),
        selection_range=positions.range(item.name_span),
        detail=item.detail or None,
    )


FEATURES: Final = {
    types.TEXT_DOCUMENT_DEFINITION: Feature(_definition),
    types.TEXT_DOCUMENT_DECLARATION: Feature(_definition),
    types.TEXT_DOCUMENT_REFERENCES: Feature(_references),
    types.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT: Feature(_highlights),
    types.TEXT_DOCUMENT_DOCUMENT_SYMBOL: Feature(_document_symbols),
    types.WORKSPACE_SYMBOL: Feature(_workspace_symbols, is_slow=True),
    types.TEXT_DOCUMENT_FOLDING_RANGE: Feature(_folding_ranges),
    types.TEXT_DOCUMENT_SELECTION_RANGE: Feature(_selection_ranges),
    types.TEXT_DOCUMENT_DOCUMENT_LINK: Feature(_links),
    types.TEXT_DOCUMENT_PREPARE_CALL_HIERARCHY: Feature(_prepare_calls),
    types.CALL_HIERARCHY_INCOMING_CALLS: Feature(_incoming),
    types.CALL_HIERARCHY_OUTGOING_CALLS: Feature(_outgoing),
}
