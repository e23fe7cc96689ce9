"""A robot that lives: the arguments of `attach`, and its programs over the `ctl` socket of a `serve`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final

from elitescript.dap.messages import Arguments
from elitescript.dap.sources import Sources, path_of
from elitescript.dap.tasks import DebuggedTask
from elitescript.debugger.api import BreakpointState, LineBreakpoint, Output, Place
from elitescript.debugger.living_breakpoints import digest_of
from elitescript.language.text.source import SourceFile
from elitescript.paths import is_task_name
from elitescript.services.control.debugging import ServedSession
from elitescript.untrusted.files import PROGRAM, UnreadableError, read_bytes

NOT_POSSIBLE: Final = (
    "supportsStepBack",
    "supportsGotoTargetsRequest",
    "supportsRestartRequest",
    "supportsStepInTargetsRequest",
)
"""Capabilities that a living robot does not have."""


class Attached:
    """A robot that lives, with the programs that run there.

    Implements `Debuggee`.

    Args:
        arguments: of `attach`.
        sources: takes note of its texts.
        on_output: receives what the programs say, in another thread.
        on_event: receives what else happens, in another thread.

    Raises:
        RequestError: an argument that makes no sense.
        UsageError: no controller is served there.

    Attributes:
        name: the address.
        session: speaks to the robot.
        start_method: `attach`.
        stop_on_entry: pause what runs, or what runs next.
        stops_on_end: False: a robot lives on.
    """

    __slots__ = ("_sources", "name", "session", "start_method", "stop_on_entry", "stops_on_end")

    def __init__(
        self,
        arguments: Arguments,
        sources: Sources,
        on_output: Callable[[Output], None],
        on_event: Callable[[str, dict[str, Any]], None],
    ) -> None:
        self.name = arguments.text("socket")
        self.start_method = "attach"
        self.stop_on_entry = arguments.flag("stopOnEntry")
        self.stops_on_end = False
        self._sources = sources
        self.session = ServedSession(self.name, on_output, on_event)

    def texts(self) -> list[str]:
        """Return the names of the texts that run or ran last."""
        return [info.name for info in self.session.sources()]

    def text_of(self, name: str) -> str:
        """Return a text by its name."""
        return self.session.source_text(name)

    def set_lines(self, source: Arguments, requests: Sequence[LineBreakpoint]) -> tuple[BreakpointState, ...] | None:
        """Replace the breakpoints of a file: of the programs that have its name or its text, also those that come."""
        if (task := self._task(source)) is not None:
            given = {"path": task.path, "text": task.task.source.text}
            return task.set_lines(requests, lambda moved: self.session.set_breakpoints(moved, **given))
        return self.session.set_breakpoints(requests, **self._file(source))

    def node(self, name: str, line: int) -> str:
        """See `Debuggee.node`; a robot that lives says its lines alone."""
        return ""

    def located(self, source: Arguments, line: int) -> tuple[str, int] | None:
        """See `Debuggee.located`."""
        name = self._sources.named(source)
        return None if name is None else (name, line)

    def places(self, source: Arguments, line: int, end_line: int) -> tuple[Place, ...]:
        """Return the statements that begin in lines of a text that runs or ran last, the last line included."""
        if (task := self._task(source)) is not None:
            return task.locations(line, end_line)
        return self.session.breakpoint_locations(line, end_line, **self._file(source))

    @staticmethod
    def _task(source: Arguments) -> DebuggedTask | None:
        """Return the graphical program that a file is; None for another one."""
        path = path_of(source.text("path", ""))
        if source.number("sourceReference", 0) or not is_task_name(path) or not Path(path).is_file():
            return None
        return DebuggedTask(path)

    def _file(self, source: Arguments) -> dict[str, str]:
        """Return path and text of a file; name and text of what has none."""
        if source.number("sourceReference", 0) and (name := self._sources.named(source)):
            return {"path": name, "text": self.text_of(name)}
        path = Path(path_of(source.text("path", "")))
        try:
            text = SourceFile.to_show(str(path), read_bytes(path, PROGRAM)).text
        except UnreadableError:
            text = ""
        if text:
            digest = digest_of(text)
            for info in self.session.sources():
                if info.digest == digest:
                    self._sources.found(info.name, str(path))
        return {"path": str(path), "text": text}
