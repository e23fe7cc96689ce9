"""Gives the long texts of a robot away to its parent, and takes the programs that come back."""

from __future__ import annotations

from collections import deque

from elitescript.kernel.compiling import Job
from elitescript.language.garbage import without_collection
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import CheckResult
from elitescript.services.child import frames
from elitescript.services.compiler.jobs import PORTION_BYTES, job_bytes, portion
from elitescript.services.compiler.loading import Loading


class RemoteWorkshop:
    """Has texts compiled in another process. Implements `kernel.compiling.Workshop`.

    Args:
        line: to the parent.
    """

    __slots__ = ("_at", "_bytes", "_dropped", "_is_loading", "_jobs", "_line", "_loading")

    def __init__(self, line: frames.BlockingLine) -> None:
        self._line = line
        self._jobs: deque[Job] = deque()
        """Those that have not come back, in order; the first is the one that is under way."""
        self._bytes = b""
        """What of the first one has not been sent."""
        self._at = 0
        self._loading: Loading | None = None
        self._is_loading = False
        """Whether something of the first one has come back."""
        self._dropped: list[int] = []

    def begin(self, job: Job) -> None:
        """Take a text; it leaves in portions, from the end of this tick on."""
        self._jobs.append(job)
        if len(self._jobs) == 1:
            self._begin_first()

    def _begin_first(self) -> None:
        job = self._jobs[0]
        self._bytes, self._at = job_bytes(job), 0
        self._loading, self._is_loading = None, False

    def result(self, number: int) -> CheckResult | None:
        """Return what has come of a text; None if it was no program."""
        if not self._jobs or self._jobs[0].number != number:
            return None
        result = None if self._loading is None else self._loading.result
        self._go_on()
        return result

    def drop(self, number: int) -> None:
        """Forget a text; the parent stops what works on it."""
        if self._jobs and self._jobs[0].number == number:
            self._dropped.append(number)
            self._go_on()
        else:
            self._jobs = deque(job for job in self._jobs if job.number != number)

    def _go_on(self) -> None:
        self._jobs.popleft()
        self._bytes, self._loading = b"", None
        if self._jobs:
            self._begin_first()

    def pump(self) -> None:
        """Send what is to leave in this tick."""
        for number in self._dropped:
            self._line.send(frames.DROP_TEXT, frames.numbered(number, b""))
        self._dropped.clear()
        if self._bytes:
            data = self._bytes[self._at : self._at + PORTION_BYTES]
            self._at += len(data)
            is_last = self._at >= len(self._bytes)
            self._line.send(frames.TEXT, portion(self._jobs[0].number, data, is_last))
            if is_last:
                self._bytes = b""

    @without_collection
    def code(self, content: bytes) -> None:
        """Take a part of a program that has come back."""
        number, data = frames.split_number(content)
        if not self._jobs or (job := self._jobs[0]).number != number:
            return
        if not self._is_loading:
            self._is_loading, self._loading = True, Loading(SourceFile(job.name, "" if job.is_tree else job.text))
        if self._loading is None:
            return
        try:
            self._loading.feed(data)
        except Exception:
            # Whatever it is, it is no program: then there is no result.
            self._loading = None
