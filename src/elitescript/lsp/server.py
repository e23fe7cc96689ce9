"""The language server: what happens between `initialize` and `exit`, and which function answers which request."""

from __future__ import annotations

import asyncio
from functools import partial
from typing import Any, Final

from lsprotocol import types
from pygls.capabilities import ServerCapabilitiesBuilder
from pygls.exceptions import JsonRpcContentModified, JsonRpcInvalidParams
from pygls.uris import from_fs_path

from elitescript import __version__
from elitescript.assist.document import Document
from elitescript.lsp import commands, explaining, findings, marking, navigating, writing
from elitescript.lsp.background import BackgroundRuns
from elitescript.lsp.client import Client
from elitescript.lsp.feature import Feature
from elitescript.lsp.findings import Findings
from elitescript.lsp.session import Session
from elitescript.lsp.settings import SECTION
from elitescript.lsp.texts import is_tree
from elitescript.paths import PROGRAM_SUFFIX, is_program_name

FEATURES: Final[dict[str, Feature]] = {
    **explaining.FEATURES,
    **navigating.FEATURES,
    **marking.FEATURES,
    **writing.FEATURES,
    **findings.FEATURES,
    **commands.FEATURES,
}
"""Every request about texts, by its method."""

_WATCHED: Final = (f"**/*{PROGRAM_SUFFIX}", f"**/*{PROGRAM_SUFFIX.upper()}", "**/*.toml")
"""Programs, and world files and files of arms."""

REGISTERED_AFTER_S: Final = 1.0
"""Time after the start before files are watched, s: the first text and its findings go before."""


class Server(Session):
    """Answers one client from `initialize` to `exit`."""

    runs: BackgroundRuns

    def __init__(self) -> None:
        super().__init__()
        self._findings = Findings(self)
        self.runs = BackgroundRuns(self, self._findings.renew_of)
        self._wrong: list[str] = []
        """What is wrong with the settings of `initialize`."""
        connection = self.connection
        connection.text_of = self.texts.open.get
        connection.lifecycle = {types.INITIALIZE: self._initialize, types.SHUTDOWN: self._shut_down}
        connection.notices = {
            types.INITIALIZED: self._initialized,
            types.SET_TRACE: self._set_trace,
            types.CANCEL_REQUEST: self._cancelled,
            types.TEXT_DOCUMENT_DID_OPEN: self._opened,
            types.TEXT_DOCUMENT_DID_CHANGE: self._changed,
            types.TEXT_DOCUMENT_DID_SAVE: self._saved,
            types.TEXT_DOCUMENT_DID_CLOSE: self._closed,
            types.WORKSPACE_DID_CHANGE_CONFIGURATION: self._configuration_changed,
            types.WORKSPACE_DID_CHANGE_WORKSPACE_FOLDERS: self._folders_changed,
            types.WORKSPACE_DID_CHANGE_WATCHED_FILES: self._files_changed,
            types.WINDOW_WORK_DONE_PROGRESS_CANCEL: self._progress_cancelled,
        }
        for method, feature in FEATURES.items():
            answer = partial(_answer, self, method, feature)
            if feature.is_slow:
                connection.slow[method] = answer
            connection.fm.feature(method, feature.options)(answer)

    def close(self) -> None:
        """End what is under way."""
        self._findings.close()
        self.runs.close()
        super().close()

    # ---------------------------------------------------------------- begin and end

    def _initialize(self, params: types.InitializeParams) -> types.InitializeResult:
        self.client = Client(params.capabilities)
        self.process_id = params.process_id
        if params.workspace_folders:
            roots = [folder.uri for folder in params.workspace_folders]
        elif params.root_uri:
            roots = [params.root_uri]
        else:
            roots = [from_fs_path(params.root_path) or ""] if params.root_path else []
        for uri in roots:
            self.texts.add_folder(uri)
        self._wrong = self.texts.set_settings(params.initialization_options)
        builder = ServerCapabilitiesBuilder(
            self.client.capabilities,
            {*FEATURES, *self.connection.notices},
            self.connection.fm.feature_options,
            list(commands.COMMANDS),
            types.TextDocumentSyncKind.Incremental,
            None,
            self.client.encoding,
        )
        self.connection.is_initialized = True
        capabilities: types.ServerCapabilities = builder.build()  # type: ignore[no-untyped-call]
        return types.InitializeResult(capabilities, types.ServerInfo(SECTION, __version__))

    def _initialized(self, params: types.InitializedParams) -> None:
        self.say(self._wrong)
        if self.client.has("workspace.configuration"):
            self.begin(self._pull_settings())
        asyncio.get_running_loop().call_later(REGISTERED_AFTER_S, self._register)

    def _register(self) -> None:
        """Ask the client to watch files, and to tell when settings change."""
        if self.connection.is_shut_down:
            return
        registrations = []
        if self.client.has("workspace.did_change_watched_files.dynamic_registration"):
            watchers = [types.FileSystemWatcher(pattern) for pattern in _WATCHED]
            options: Any = types.DidChangeWatchedFilesRegistrationOptions(watchers)
            registrations.append(types.Registration("files", types.WORKSPACE_DID_CHANGE_WATCHED_FILES, options))
        if self.client.has("workspace.did_change_configuration.dynamic_registration"):
            options = types.DidChangeConfigurationRegistrationOptions(SECTION)
            registrations.append(types.Registration("settings", types.WORKSPACE_DID_CHANGE_CONFIGURATION, options))
        if registrations:
            self.begin(self.request(types.CLIENT_REGISTER_CAPABILITY, types.RegistrationParams(registrations)))

    def _shut_down(self, params: None) -> None:
        self.connection.is_shut_down = True
        self.connection.close()
        self._findings.close()
        self.runs.close()

    def _set_trace(self, params: types.SetTraceParams) -> None:
        self.connection.trace = params.value

    def _cancelled(self, params: types.CancelParams) -> None:
        self.connection.cancel(params.id)

    def _progress_cancelled(self, params: types.WorkDoneProgressCancelParams) -> None:
        self.runs.cancel(params.token)

    # ---------------------------------------------------------------- texts

    def _opened(self, params: types.DidOpenTextDocumentParams) -> None:
        uri = params.text_document.uri
        self.texts.put(params.text_document)
        self._findings.text_changed(uri, is_new=True)
        self.runs.text_changed(uri)

    def _changed(self, params: types.DidChangeTextDocumentParams) -> None:
        uri, version = params.text_document.uri, params.text_document.version
        if self.texts.change(uri, version, params.content_changes, self.client.encoding) is None:
            raise JsonRpcInvalidParams(f"{uri} is not open")
        self._findings.text_changed(uri, is_new=False)
        self.runs.text_changed(uri)

    def _saved(self, params: types.DidSaveTextDocumentParams) -> None:
        """Do nothing: the text is the one that was sent before."""

    def _closed(self, params: types.DidCloseTextDocumentParams) -> None:
        uri = params.text_document.uri
        self.texts.close(uri)
        self.tokens.forget(uri)
        self.runs.forget(uri)
        self.last_findings.pop(uri, None)
        self._findings.closed(uri)

    # ---------------------------------------------------------------- folders and settings

    def _folders_changed(self, params: types.DidChangeWorkspaceFoldersParams) -> None:
        for folder in params.event.removed:
            self.texts.remove_folder(folder.uri)
        for folder in params.event.added:
            self.texts.add_folder(folder.uri)
        self._settings_changed(self.texts.read_settings())
        if self.client.has("workspace.configuration"):
            self.begin(self._pull_settings())

    def _files_changed(self, params: types.DidChangeWatchedFilesParams) -> None:
        if any(is_program_name(change.uri) for change in params.changes):
            self.begin(self.in_thread(self.files.forget))
        if any(change.uri.endswith(".toml") for change in params.changes):
            # One of them may be the world file, or describe the arm, of some folder.
            self._settings_changed(self.texts.read_settings())

    def _configuration_changed(self, params: types.DidChangeConfigurationParams) -> None:
        if self.client.has("workspace.configuration"):
            self.begin(self._pull_settings())
        elif params.settings is not None:
            self._settings_changed(self.texts.set_settings(params.settings))

    async def _pull_settings(self) -> None:
        """Ask the client for the settings of each folder."""
        folders = list(self.texts.folders)
        items = [types.ConfigurationItem(uri, SECTION) for uri in folders] or [types.ConfigurationItem(None, SECTION)]
        answer = await self.request(types.WORKSPACE_CONFIGURATION, types.ConfigurationParams(items))
        if not isinstance(answer, list | tuple) or len(answer) != len(items):
            return
        wrong: list[str] = []
        if folders:
            for uri, given in zip(folders, answer, strict=True):
                if given is not None and uri in self.texts.folders:
                    wrong += self.texts.set_settings(given, uri)
        elif answer[0] is not None:
            wrong += self.texts.set_settings(answer[0])
        self._settings_changed(wrong)

    def _settings_changed(self, wrong: list[str]) -> None:
        """Show what is wrong with new settings, and look at the texts again if it matters to them."""
        self.say(list(dict.fromkeys(wrong)))
        if self.texts.renew():
            self.last_findings.clear()
            self._findings.renew()
        self.runs.settings_changed()


def _answer(session: Session, method: str, feature: Feature, document: Document | None, params: Any) -> Any:
    """Answer a request.

    Raises:
        JsonRpcContentModified: it may be about a text that was closed, and is.
        JsonRpcInvalidParams: another one is about a text that is not open.
    """
    named = getattr(params, "text_document", None) or getattr(params, "item", None)
    if document is None and named is not None:
        error = JsonRpcContentModified if feature.may_be_late else JsonRpcInvalidParams
        raise error(f"{named.uri} is not open")
    if document is not None and is_tree(document):
        # Few texts are trees, and what reads one takes time to import.
        from elitescript.lsp import trees

        return trees.answer(session, method, feature, document, params)
    return feature.answer(session, document, params)
