"""A child that waits, locked in, to take the place of one that is ended: Python need not be started then.

One serves all robots of a process. It is started when a program has run for a while, not before: a robot without a
program has no call that does not come back. It has run a small program itself, so that nothing is loaded any more.
"""

from __future__ import annotations

import asyncio
from typing import Final

from elitescript.codec.values import CodecError
from elitescript.errors import UsageError
from elitescript.kernel import RobotOptions
from elitescript.records import replace
from elitescript.runtime.environment import FilesRefused
from elitescript.services.child.jail import MEMORY_MAX
from elitescript.services.child.remote_files import FileDesk
from elitescript.services.child.transport import ChildTransport

DELAY_S: Final = 0.5
"""How long a program has run when it is started: most of its processor time is not in the way of the first ticks."""


class _NoCompilers:
    """Stands for the compilers of a child that has no robot yet."""

    __slots__ = ()

    def take_text(self, content: bytes) -> None:
        raise CodecError("a text to compile, and there is no robot")

    def drop(self, content: bytes) -> None:
        raise CodecError("a text that is dropped, and there is no robot")


class Spares:
    """Keeps one child ready while programs run.

    Args:
        is_jailed: lock it in.
        memory_max: bytes of its address space.
    """

    __slots__ = ("_is_closed", "_is_jailed", "_memory_max", "_spare", "_timer")

    def __init__(self, *, is_jailed: bool = True, memory_max: int = MEMORY_MAX) -> None:
        self._is_jailed = is_jailed
        self._memory_max = memory_max
        self._spare: ChildTransport | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._is_closed = False

    def want(self, options: RobotOptions) -> None:
        """Have a child started soon if there is none; it tries itself with these options."""
        if self._spare is None and self._timer is None and not self._is_closed:
            self._timer = asyncio.get_running_loop().call_later(DELAY_S, self._start, options)

    def take(self) -> ChildTransport | None:
        """Return the child, which is the caller's from now on; None if there is none, or it is not locked in yet."""
        spare = self._spare
        if spare is None or not spare.is_ready:
            return None
        self._spare = None
        return spare

    def close(self) -> None:
        """End it; none is started any more."""
        self._is_closed = True
        if self._timer is not None:
            self._timer.cancel()
        if self._spare is not None:
            self._spare.process.kill()
            self._spare = None

    def _start(self, options: RobotOptions) -> None:
        self._timer = None
        try:
            spare = self._spare = ChildTransport(
                FileDesk(FilesRefused()),
                lambda sent, output, due: None,
                lambda sent: None,
                self._look,
                _NoCompilers(),
                is_jailed=self._is_jailed,
                memory_max=self._memory_max,
            )
        except UsageError:
            # There is no process to be had; the next program asks again.
            return
        spare.prepare(replace(options, first_tick=0, joints=None))

    def _look(self) -> None:
        """Let go of one that has ended."""
        spare = self._spare
        if spare is not None and spare.end_reason:
            self._spare = None
            spare.process.kill()
