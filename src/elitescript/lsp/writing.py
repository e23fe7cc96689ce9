"""Answers what changes texts: rename, layout, repairs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

from lsprotocol import types

from elitescript.assist import actions, formatting, renaming, typing_edits
from elitescript.assist.actions import ActionKind, CodeAction
from elitescript.assist.diagnostics import Problem
from elitescript.assist.document import Document
from elitescript.language.diagnostics import Edit
from elitescript.lsp.connection import RequestFailed
from elitescript.lsp.feature import Feature, refuse_generated
from elitescript.lsp.findings import shown
from elitescript.lsp.session import Session

# ---------------------------------------------------------------- rename


def _prepare_rename(
    session: Session, document: Document, params: types.PrepareRenameParams
) -> types.PrepareRenamePlaceholder | None:
    refuse_generated(document)
    positions = session.positions(document)
    found = renaming.prepare_rename(document, *positions.place(params.position))
    if found is None:
        return None
    if found.refusal:
        raise RequestFailed(found.refusal)
    return types.PrepareRenamePlaceholder(positions.range(found.span), found.name)


def _rename(session: Session, document: Document, params: types.RenameParams) -> types.WorkspaceEdit:
    refuse_generated(document)
    place = session.positions(document).place(params.position)
    found = renaming.rename(document, *place, params.new_name)
    if found.refusal:
        raise RequestFailed(found.refusal)
    return _workspace_edit(session, params.text_document.uri, document, found.edits)


def _workspace_edit(session: Session, uri: str, document: Document, edits: Iterable[Edit]) -> types.WorkspaceEdit:
    positions = session.positions(document)
    changes = [positions.text_edit(edit) for edit in edits]
    if not session.client.has("workspace.workspace_edit.document_changes"):
        return types.WorkspaceEdit(changes={uri: changes})
    version = types.OptionalVersionedTextDocumentIdentifier(uri, document.version)
    return types.WorkspaceEdit(document_changes=[types.TextDocumentEdit(version, changes)])


# ---------------------------------------------------------------- layout


def _formatting(session: Session, document: Document, params: types.DocumentFormattingParams) -> list[types.TextEdit]:
    refuse_generated(document)
    positions = session.positions(document)
    return [positions.text_edit(edit) for edit in formatting.format_edits(document)]


def _range_formatting(
    session: Session, document: Document, params: types.DocumentRangeFormattingParams
) -> list[types.TextEdit]:
    positions = session.positions(document)
    return [positions.text_edit(edit) for edit in formatting.format_edits(document, positions.span(params.range))]


def _on_type_formatting(
    session: Session, document: Document, params: types.DocumentOnTypeFormattingParams
) -> list[types.TextEdit]:
    positions = session.positions(document)
    found = typing_edits.typing_edits(document, *positions.place(params.position), params.ch)
    return [positions.text_edit(edit) for edit in found]


# ---------------------------------------------------------------- repairs


async def _code_actions(
    session: Session, document: Document, params: types.CodeActionParams
) -> Sequence[types.CodeAction]:
    uri, only = params.text_document.uri, params.context.only

    text = session.twin(document)

    def find() -> Sequence[types.CodeAction]:
        positions = session.positions(text)
        found: list[CodeAction] = []
        if _is_wanted(ActionKind.QUICK_FIX, only) or _is_wanted(ActionKind.REWRITE, only):
            found += actions.code_actions(text, positions.span(params.range))
        # Without a wish it would stand in the menu of every line.
        if only and _is_wanted(ActionKind.FIX_ALL, only) and (all_fixes := actions.fix_all(text)) is not None:
            found.append(all_fixes)
        return [
            types.CodeAction(
                action.title,
                kind=str(action.kind),
                diagnostics=[shown(Problem(problem, (), (), ""), positions, uri) for problem in action.problems]
                or None,
                is_preferred=action.is_preferred or None,
                edit=_workspace_edit(session, uri, text, action.edits),
            )
            for action in found
            if _is_wanted(action.kind, only)
        ]

    # They need the findings, which take longer than anything else that is asked.
    return await session.in_thread(find)


def _is_wanted(kind: str, only: Sequence[str] | None) -> bool:
    """Return whether a kind is one of those that are asked for, or below one."""
    return only is None or any(kind == wish or kind.startswith(f"{wish}.") or wish == "" for wish in only)


FEATURES: Final = {
    types.TEXT_DOCUMENT_RENAME: Feature(_rename, types.RenameOptions(prepare_provider=True)),
    types.TEXT_DOCUMENT_PREPARE_RENAME: Feature(_prepare_rename),
    types.TEXT_DOCUMENT_FORMATTING: Feature(_formatting),
    types.TEXT_DOCUMENT_RANGE_FORMATTING: Feature(_range_formatting),
    types.TEXT_DOCUMENT_ON_TYPE_FORMATTING: Feature(
        _on_type_formatting,
        types.DocumentOnTypeFormattingOptions(typing_edits.TRIGGERS[0], list(typing_edits.TRIGGERS[1:])),
    ),
    types.TEXT_DOCUMENT_CODE_ACTION: Feature(
        _code_actions, types.CodeActionOptions(code_action_kinds=[str(kind) for kind in ActionKind]), is_slow=True
    ),
}
