"""What the requests of one client have in common: its texts, what it can do, and what was sent to it."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Coroutine, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any, Protocol, TypeVar
from weakref import WeakKeyDictionary

from lsprotocol import types
from pygls.exceptions import JsonRpcException
from pygls.lsp.server import LanguageServer
from pygls.protocol import default_converter

from elitescript import __version__
from elitescript.assist.document import Document
from elitescript.assist.last_run import LastRun
from elitescript.language.diagnostics import Diagnostic
from elitescript.lsp.client import Client
from elitescript.lsp.connection import Connection
from elitescript.lsp.files import WorkspaceFiles
from elitescript.lsp.positions import Positions
from elitescript.lsp.run_data import Outcome
from elitescript.lsp.settings import SECTION
from elitescript.lsp.texts import Texts, path_of
from elitescript.lsp.token_results import TokenResults
from elitescript.records import NamedTuple
from elitescript.shown import shown

_Result = TypeVar("_Result")

_log = logging.getLogger(__name__)


@cache
def _converter() -> Any:
    """Return what turns messages into objects and back; it writes its functions when they are first used."""
    return default_converter()  # type: ignore[no-untyped-call]


class Runs(Protocol):
    """Runs programs when somebody asks for it; see `background`."""

    async def run_now(self, uri: str, *, with_page: bool = False) -> Outcome:
        """Run an open text; return what came of it."""

    def write_page(self, program: Path | None, text: str) -> Path:
        """Write a page that lasts as long as the session; return its path."""


class LastFindings(NamedTuple):
    """What was found in a version of a text.

    Attributes:
        rows: its lines.
        problems: the findings.
    """

    rows: Sequence[str]
    problems: tuple[Diagnostic, ...]


class Session(LanguageServer):
    """Holds it.

    All of it is used in the thread of the event loop. What is called in the thread of slow requests gets all that it
    needs handed over, texts from `twin`, and reads nothing here that changes.

    Attributes:
        client: what the client can do.
        texts: the open texts, folders and settings.
        files: programs of the workspace that are not open.
        tokens: what was sent of semantic tokens.
        last_runs: the last run of each open text that has run, by URI.
        last_findings: what was found in the last version of an open text in which all was found, by URI.
        runs: runs programs.
    """

    runs: Runs

    def __init__(self) -> None:
        super().__init__(SECTION, __version__, protocol_cls=Connection, converter_factory=_converter)
        self.client = Client()
        self.texts = Texts()
        self.files = WorkspaceFiles()
        self.tokens = TokenResults()
        self.last_runs: dict[str, LastRun] = {}
        self.last_findings: dict[str, LastFindings] = {}
        self.texts.replaced = self._replaced
        self._twins: WeakKeyDictionary[Document, Document] = WeakKeyDictionary()
        self._thread = ThreadPoolExecutor(1, "findings")
        self._tasks: set[asyncio.Task[Any]] = set()

    @property
    def connection(self) -> Connection:
        """The connection to the client."""
        assert isinstance(self.protocol, Connection)
        return self.protocol

    def positions(self, document: Document) -> Positions:
        """Return what converts places of a text."""
        return Positions(document, self.client.encoding)

    def last_run(self, uri: str) -> LastRun | None:
        """Return what is known of the last run of a text; None if it did not run."""
        return self.last_runs.get(uri)

    def all_texts(self, opened: Mapping[str, Document]) -> Iterator[tuple[str, Document]]:
        """Yield the open texts, and the programs of the workspace that are not open; slow.

        Args:
            opened: the open texts when the request came, from `twins`.
        """
        yield from opened.items()
        paths = {path_of(uri) for uri in opened}
        folders = {path: self.texts.settings(uri).texts for uri, path in list(self.texts.folders.items())}
        for uri, document in self.files.documents(folders):
            if path_of(uri) not in paths:
                yield uri, document

    # ---------------------------------------------------------------- work

    def twin(self, document: Document) -> Document:
        """Return the same version of a text for the thread of slow requests.

        What is known of a text is found when it is first asked for, without locks, so each thread has its own copy.
        """
        found = self._twins.get(document)
        if found is None:
            found = self._twins[document] = document.twin()
        return found

    def _replaced(self, document: Document) -> None:
        """Give up what the thread of slow requests finds in a version of a text that is open no more."""
        if (twin := self._twins.get(document)) is not None:
            twin.is_outdated = True
            # Behind what the thread does with it by now.
            self._thread.submit(twin.release)

    def twins(self) -> dict[str, Document]:
        """Return the open texts for the thread of slow requests, by URI."""
        return {uri: self.twin(document) for uri, document in self.texts.open.items()}

    async def in_thread(self, function: Callable[..., _Result], *arguments: Any) -> _Result:
        """Call a function in the thread of slow requests, after those that wait there already."""
        return await asyncio.get_running_loop().run_in_executor(self._thread, function, *arguments)

    def begin(self, work: Coroutine[Any, Any, _Result]) -> asyncio.Task[_Result]:
        """Begin some work of the server itself; an error of it is logged."""
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._ended)
        return task

    def _ended(self, task: asyncio.Task[Any]) -> None:
        self._tasks.discard(task)
        if not task.cancelled() and (error := task.exception()) is not None:
            _log.error("work in the background failed", exc_info=error)

    def close(self) -> None:
        """End what is under way."""
        self.connection.close()
        for task in self._tasks:
            task.cancel()
        self._thread.shutdown(wait=False, cancel_futures=True)

    # ---------------------------------------------------------------- to the client

    def refresh(self, method: str) -> None:
        """Ask the client to ask again, as `workspace/inlayHint/refresh` does."""
        self.begin(self.request(method, None))

    async def request(self, method: str, params: Any) -> Any:
        """Return the client's answer to a request; None if it is an error."""
        try:
            return await self.protocol.send_request_async(method, params)
        except JsonRpcException as error:
            _log.warning("the client refuses %s: %s", method, error)
            return None

    def say(self, texts: list[str]) -> None:
        """Show messages about what the user has to change."""
        for text in texts:
            self.window_show_message(types.ShowMessageParams(types.MessageType.Warning, shown(text)))
