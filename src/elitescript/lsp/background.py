"""Runs programs beside the server, for hints and on request: each in a process of its own, which can be killed.

A text is run when nobody has typed in it for a while. One run is under way at a time; it ends when its text changes.
"""

from __future__ import annotations

import asyncio
import json
import logging
from collections.abc import Callable
from contextlib import suppress
from datetime import datetime
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

from lsprotocol import types

from elitescript.assist.document import Document
from elitescript.assist.last_run import LastRun
from elitescript.environment.process import Life, module_command, module_environment
from elitescript.lsp.connection import RequestFailed
from elitescript.lsp.run_data import Outcome, decoded
from elitescript.lsp.session import Session
from elitescript.lsp.settings import ClientSettings
from elitescript.lsp.texts import is_tree, path_of
from elitescript.outputs.writing import write_file
from elitescript.paths import is_program_name, is_task_name
from elitescript.records import replace
from elitescript.untrusted.json_text import json_value

QUIET_S: Final = 1.0
"""Time without a change before a text is run, s."""
WALL_S: Final = 10.0
"""Most wall time of a run in the background, s."""
WALL_ON_REQUEST_S: Final = 60.0
"""Most wall time of a run that somebody has asked for, s."""
WALL_SHARE: Final = 0.5
"""Share of it after which the process cuts its run short."""
SHOWN_AFTER_S: Final = 0.5
"""Wall time after which the progress of a run is shown, s."""
OUTCOME_BYTES_MAX: Final = 64 << 20

_log = logging.getLogger(__name__)

_REFRESHED: Final = {
    types.WORKSPACE_INLAY_HINT_REFRESH: "workspace.inlay_hint.refresh_support",
    types.WORKSPACE_CODE_LENS_REFRESH: "workspace.code_lens.refresh_support",
}
"""What is asked for again after a run, and the capability for it."""


class BackgroundRuns:
    """Decides when which text is run; what came of it is in `Session.last_runs`.

    Args:
        session: of the client.
        on_end: is called with the URI of a text whose run has ended.
    """

    def __init__(self, session: Session, on_end: Callable[[str], None]) -> None:
        self._session = session
        self._on_end = on_end
        self._timers: dict[str, asyncio.TimerHandle] = {}
        self._running: dict[str, asyncio.Task[Any]] = {}
        self._one_at_a_time = asyncio.Semaphore(1)
        self._tokens: dict[str | int, asyncio.Task[Any]] = {}
        self._under_way: dict[asyncio.Task[Any], str] = {}
        """Every run, with the URI of its text."""
        self._numbers = count(1)
        self._pages: TemporaryDirectory[str] | None = None

    # ---------------------------------------------------------------- when

    def text_changed(self, uri: str) -> None:
        """End the run of an older text, and run the new one when it is quiet."""
        self._stop(uri)
        if self._session.texts.settings(uri).client.runs_programs and not is_task_name(uri):
            self._timers[uri] = asyncio.get_running_loop().call_later(QUIET_S, self._begin, uri)

    def settings_changed(self) -> None:
        """Run the open texts again, or no more."""
        for uri in self._session.texts.open:
            self.text_changed(uri)

    def forget(self, uri: str) -> None:
        """Forget a text that was closed, and end its runs, also one on request: its progress would stay in sight."""
        self._stop(uri)
        for run, other in self._under_way.items():
            if other == uri:
                run.cancel()
        self._session.last_runs.pop(uri, None)

    def cancel(self, token: str | int) -> None:
        """End the run whose progress has a token."""
        if (task := self._tokens.get(token)) is not None:
            task.cancel()

    def close(self) -> None:
        """End all runs, and remove the pages."""
        for uri in {*self._timers, *self._running}:
            self._stop(uri)
        if self._pages is not None:
            self._pages.cleanup()
            self._pages = None

    def _stop(self, uri: str) -> None:
        if (timer := self._timers.pop(uri, None)) is not None:
            timer.cancel()
        if (task := self._running.pop(uri, None)) is not None:
            task.cancel()

    def _begin(self, uri: str) -> None:
        self._timers.pop(uri, None)
        document = self._session.texts.open.get(uri)
        if document is not None:
            task = self._running[uri] = self._session.begin(self._run_for_hints(uri, document))
            task.add_done_callback(lambda done: self._done(uri, done))

    def _done(self, uri: str, task: asyncio.Task[Any]) -> None:
        if self._running.get(uri) is task:
            del self._running[uri]

    async def _run_for_hints(self, uri: str, document: Document) -> None:
        async with self._one_at_a_time:
            try:
                outcome = await self._shown(uri, document, WALL_S)
            except RequestFailed as error:
                # There are no hints then, and nobody has asked for the run.
                _log.info("%s: %s", document.name, error)
                return
        if outcome.last is not None and uri in self._session.texts.open:
            self._keep(uri, outcome.last)

    def _keep(self, uri: str, last: LastRun) -> None:
        ended = datetime.now().astimezone().strftime("%Y-%m-%d %H:%M:%S")
        self._session.last_runs[uri] = replace(last, ended=ended)
        for method, capability in _REFRESHED.items():
            if self._session.client.has(capability):
                self._session.refresh(method)
        self._on_end(uri)

    # ---------------------------------------------------------------- on request

    async def run_now(self, uri: str, *, with_page: bool = False) -> Outcome:
        """Run an open text; return what came of it."""
        document = self._session.texts.open[uri]
        outcome = await self._shown(uri, document, WALL_ON_REQUEST_S, with_page=with_page)
        if outcome.last is not None and self._session.texts.open.get(uri) is document:
            self._keep(uri, outcome.last)
        return outcome

    def write_page(self, program: Path | None, text: str) -> Path:
        """Write a page into a folder that the server removes at its end; return its path."""
        if self._pages is None:
            self._pages = TemporaryDirectory(prefix="elitescript-")
        name = "program" if program is None else program.stem
        path = Path(self._pages.name, f"{name}.plot.html")
        write_file(path, text)
        return path

    # ---------------------------------------------------------------- progress

    async def _shown(self, uri: str, document: Document, wall_s: float, *, with_page: bool = False) -> Outcome:
        """Run a text, and show that it runs if that takes a while."""
        settings = self._session.texts.settings(uri).client
        if is_tree(document):
            from elitescript.lsp import trees

            document = trees.script_of(document)
        request = request_for(uri, document, settings, with_page=with_page)
        run: asyncio.Task[Outcome] = self._session.begin(run_in_process(request, wall_s))
        self._under_way[run] = uri
        token = f"elitescript/{next(self._numbers)}"
        title = f"Run {Path(document.name).name}"
        progress = self._session.begin(self._progress(token, title, run))
        try:
            return await run
        except asyncio.CancelledError:
            if run.cancelled() and not _is_cancelled_itself():
                raise RequestFailed("the run was cancelled") from None
            run.cancel()
            raise
        finally:
            del self._under_way[run]
            progress.cancel()
            if self._tokens.pop(token, None) is not None:
                end = types.WorkDoneProgressEnd()
                self._session.protocol.notify(types.PROGRESS, types.ProgressParams(token, end))

    async def _progress(self, token: str, title: str, run: asyncio.Task[Any]) -> None:
        if not self._session.client.has("window.work_done_progress"):
            return
        await asyncio.sleep(SHOWN_AFTER_S)
        created = self._session.protocol.send_request_async(
            types.WINDOW_WORK_DONE_PROGRESS_CREATE, types.WorkDoneProgressCreateParams(token)
        )
        await created
        self._tokens[token] = run
        begin = types.WorkDoneProgressBegin(title, cancellable=True)
        self._session.protocol.notify(types.PROGRESS, types.ProgressParams(token, begin))


def _is_cancelled_itself() -> bool:
    """Return whether the present task is the one that is to end, and not only what it waits for."""
    task = asyncio.current_task()
    return task is not None and task.cancelling() > 0


def request_for(uri: str, document: Document, settings: ClientSettings, *, with_page: bool) -> dict[str, Any]:
    """Return what the process of a run is asked; see `run_worker`."""
    path = path_of(uri)
    options = {"model": settings.robot, "firmware": settings.firmware, "strict": settings.strict}
    return {
        "text": document.text,
        # The name is that of code objects, so it must not be that of a file of Python.
        "name": document.name if is_program_name(document.name) else f"{document.name}.script",
        "folder": None if path is None else str(path.parent),
        "world": settings.world,
        "options": {name: value for name, value in options.items() if value is not None},
        "with_page": with_page,
    }


async def run_in_process(request: dict[str, Any], wall_s: float) -> Outcome:
    """Run a program in a process of its own; it is killed when it takes too long or nobody waits for it any more.

    Raises:
        RequestFailed: it took too long, or ended without an outcome.
    """
    life = Life()
    try:
        return await _run_with(life, request, wall_s)
    finally:
        life.close()


async def _run_with(life: Life, request: dict[str, Any], wall_s: float) -> Outcome:
    process = await asyncio.create_subprocess_exec(
        *module_command("elitescript.lsp.run_worker", [life.descriptor]),
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.DEVNULL,
        limit=OUTCOME_BYTES_MAX,
        env=module_environment(),
        **life.options,
    )
    life.started()
    try:
        # It ends by itself, with what it has so far, unless it hangs.
        asked = json.dumps({"wall_s": WALL_SHARE * wall_s, **request}).encode()
        found, _ = await asyncio.wait_for(process.communicate(asked), wall_s)
        outcome: dict[str, Any] = json_value(found, depth_max=None)
    except TimeoutError:
        raise RequestFailed(f"the run took more than {wall_s:g} s") from None
    except ValueError:
        raise RequestFailed(f"the process of the run ended with code {process.returncode}") from None
    finally:
        if process.returncode is None:
            with suppress(ProcessLookupError):
                process.kill()
            await process.wait()
    last = outcome.get("last")
    return Outcome(outcome["report"], None if last is None else decoded(last), outcome.get("page", ""))
