"""The parent's part in compiling: it starts the compiler of a text, and carries bytes between it and the robot.

Nothing of them is read here. One text of a robot is under way at a time; what does not keep to that, or to the bounds,
ends the process that sent it.
"""

from __future__ import annotations

import time
from collections import deque
from typing import Final

from elitescript.codec.json_text import to_text
from elitescript.codec.values import CodecError
from elitescript.kernel.options import RobotOptions
from elitescript.language.limits import MAX_UNIT_BYTES
from elitescript.messages.inputs import Compiled
from elitescript.services.child import frames
from elitescript.services.child.process import PYTHON, ChildProcess
from elitescript.services.child.supervision import COMPILE_HINT, SILENCE_MAX_S, compile_s
from elitescript.services.compiler.jobs import read_portion
from elitescript.services.options_data import options_data

ORIGIN: Final = "compiler"
"""Of the inputs that say that a text has come back."""
COMMAND: Final = (*PYTHON, "elitescript.services.compiler")
"""The command line of a compiler; then comes the number of its socket."""
MEMORY_MAX: Final = 2 << 30
"""Bytes of address space of a compiler: text of the greatest size that is read takes three quarters (*measured*)."""
JOB_MAX: Final = MAX_UNIT_BYTES + (1 << 20)
"""Bytes of a text with what belongs to it."""
CODE_MAX: Final = 160 << 20
"""Bytes of a program that has come back; ten times the text is about what there is of the densest."""
START_S: Final = 2.0
"""Processor time that a compiler may use besides that for the text."""


class CompilerDesk:
    """Has the texts of one robot compiled, one at a time.

    Args:
        options: of the robot.
        is_jailed: lock compilers in.
        memory_max: bytes of address space of a compiler.
    """

    __slots__ = ("_is_jailed", "_job", "_last", "_memory_max", "_options")

    def __init__(self, options: RobotOptions, *, is_jailed: bool, memory_max: int = MEMORY_MAX) -> None:
        self._options = options
        self._is_jailed = is_jailed
        self._memory_max = memory_max
        self._job: _Job | None = None
        self._last: ChildProcess | None = None
        """The compiler that was ended last."""

    @property
    def is_active(self) -> bool:
        """Whether a text is under way."""
        return self._job is not None

    @property
    def pid(self) -> int:
        """Number of the process that compiles now; 0 if there is none."""
        process = None if self._job is None else self._job.process
        return 0 if process is None else process.pid

    def take_text(self, content: bytes) -> None:
        """Take a part of a text from the robot's process.

        Raises:
            CodecError: it is not what is expected.
        """
        number, is_last, data = read_portion(content)
        if self._job is None:
            self._job = _Job(number, self._options, is_jailed=self._is_jailed, memory_max=self._memory_max)
        elif self._job.number != number or self._job.is_whole:
            raise CodecError("a text to compile before the one before has come back")
        self._job.take_text(content, len(data), is_last=is_last)

    def drop(self, content: bytes) -> None:
        """End what works on a text that is not wanted any more."""
        number, _ = frames.split_number(content)
        if self._job is not None and self._job.number == number:
            self.cancel()

    def cancel(self) -> None:
        """End what is under way."""
        if self._job is not None:
            self._last = self._job.process
            if self._last is not None:
                self._last.kill()
            self._job = None

    async def close(self) -> None:
        """End what is under way, and return when its process is gone."""
        self.cancel()
        if self._last is not None:
            await self._last.gone()

    def step(self) -> tuple[bytes | None, list[Compiled]]:
        """Return what goes to the robot in this tick: a part of a program, and that it is the last one."""
        job = self._job
        if job is None:
            return None, []
        failure = job.failure()
        if failure:
            self.cancel()
            return None, [Compiled(ORIGIN, job.number, failure)]
        content = frames.numbered(job.number, job.code.popleft()) if job.code else None
        if job.is_done and not job.code:
            self.cancel()
            return content, [Compiled(ORIGIN, job.number)]
        return content, []


class _Job:
    """A text that is under way, and its compiler."""

    __slots__ = (
        "_failure",
        "_since_s",
        "_size",
        "_size_of_code",
        "code",
        "is_done",
        "is_whole",
        "number",
        "process",
    )

    def __init__(self, number: int, options: RobotOptions, *, is_jailed: bool, memory_max: int) -> None:
        self.number = number
        self.code: deque[bytes] = deque()
        """What has come back and has not gone to the robot."""
        self.is_done = self.is_whole = False
        """Whether all of the program has come back, and whether all of the text was taken."""
        self._size = self._size_of_code = 0
        self._failure = ""
        self._since_s = time.monotonic()
        self.process: ChildProcess | None = None
        try:
            self.process = ChildProcess(self._message, self._ended, command=COMMAND)
        except (OSError, ValueError) as error:
            self._failure = f"no process can be started that compiles it: {error}"
            return
        self.process.send(frames.LOCK_IN, to_text([is_jailed, memory_max]))
        self.process.send(frames.BEGIN, to_text(options_data(options)))

    def take_text(self, content: bytes, size: int, *, is_last: bool) -> None:
        self._size += size
        self.is_whole = is_last
        if self._size > JOB_MAX:
            raise CodecError(f"a text of more than {JOB_MAX} bytes to compile")
        if self.process is not None:
            self.process.send(frames.TEXT, content)

    def failure(self) -> str:
        """Return why nothing will come; empty while something may."""
        if self._failure or self.is_done or self.process is None:
            return self._failure
        limit_s = START_S + compile_s(self._size)
        spent_s = time.monotonic() - self._since_s
        worked_s = self.process.worked_s()
        is_stuck = spent_s > SILENCE_MAX_S + limit_s and not self.process.is_runnable()
        if is_stuck or (spent_s if worked_s is None else worked_s) > limit_s:
            return f"a text of {self._size:,} bytes was not compiled within {spent_s:.1f} s; {COMPILE_HINT}"
        return ""

    def _message(self, letter: str, data: bytes) -> None:
        if letter == frames.CODE:
            self.code.append(data)
            self._size_of_code += len(data)
            if self._size_of_code > CODE_MAX:
                self._fail("it has sent more than a program is")
        elif letter == frames.COMPILED:
            self.is_done = True
        elif letter == frames.FAILED:
            self._fail(_reason(data))
        elif letter != frames.LOCKED_IN:
            self._fail(f"it has sent a message {letter!r}")

    def _ended(self, reason: str) -> None:
        if not self.is_done:
            self._fail(reason)

    def _fail(self, why: str) -> None:
        self._failure = self._failure or f"the process that compiles it has failed: {why}"


def _reason(data: bytes) -> str:
    """Return the reason that a compiler has given for its end; never more than a text."""
    if data == b"memory":
        return f"the text takes more than {MEMORY_MAX >> 20} MiB; {COMPILE_HINT}"
    return f"a mistake of ours, please report it:\n{data[: frames.FAILURE_MAX].decode('utf-8', 'replace')}"
