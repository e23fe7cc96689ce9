"""Answers `workspace/executeCommand`: runs a program, or draws its run, without waiting for the background."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from typing import Any, Final

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams
from pygls.uris import from_fs_path

from elitescript.lsp.connection import RequestFailed
from elitescript.lsp.feature import Feature
from elitescript.lsp.session import Session
from elitescript.lsp.texts import path_of

RUN: Final = "elitescript.server.run"
PLOT: Final = "elitescript.server.plot"


async def _run(session: Session, uri: str) -> dict[str, Any]:
    """Run an open text; return how that ended."""
    outcome = await session.runs.run_now(uri)
    return outcome.report


async def _plot(session: Session, uri: str) -> dict[str, Any]:
    """Run an open text; return how that ended, and as `page` the URI of the page that shows it."""
    outcome = await session.runs.run_now(uri, with_page=True)
    if not outcome.page:
        return outcome.report
    path = await session.in_thread(session.runs.write_page, path_of(uri), outcome.page)
    return outcome.report | {"page": from_fs_path(str(path))}


COMMANDS: Final[dict[str, Callable[[Session, str], Coroutine[Any, Any, dict[str, Any]]]]] = {RUN: _run, PLOT: _plot}


async def _execute(session: Session, document: None, params: types.ExecuteCommandParams) -> dict[str, Any]:
    command = COMMANDS.get(params.command)
    if command is None:
        raise JsonRpcInvalidParams(f"{params.command!r} is no command; there are {', '.join(COMMANDS)}")
    arguments = params.arguments or []
    if len(arguments) != 1 or not isinstance(arguments[0], str):
        raise JsonRpcInvalidParams(f"{params.command} takes one argument: the URI of an open text")
    uri = arguments[0]
    if uri not in session.texts.open:
        raise RequestFailed(f"{uri} is not open")
    return await command(session, uri)


FEATURES: Final = {types.WORKSPACE_EXECUTE_COMMAND: Feature(_execute, is_slow=True)}
