"""Waiting without a turn of the event loop."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextvars import Context
from typing import Any


class PromptFuture(asyncio.Future[None]):
    """A future whose task goes on at once, when a callback of the event loop sets the result.

    With any other future a task goes on in the next turn of its loop. A turn costs as much as a third of what a served
    tick does, and a tick waits three times. One task waits for it.
    """

    _go_on: Callable[[PromptFuture], object] | None = None

    def add_done_callback(self, fn: Callable[[Any], object], *, context: Context | None = None) -> None:
        """Take the call that lets the waiting task go on."""
        self._go_on = fn

    def set_result(self, result: None) -> None:
        """Let the task go on: now, or in the next turn of the loop while another task runs."""
        super().set_result(result)
        self._wake()

    def cancel(self, msg: Any | None = None) -> bool:
        """Cancel it, as any other future."""
        is_cancelled = super().cancel(msg)
        self._wake()
        return is_cancelled

    def _wake(self) -> None:
        go_on, self._go_on = self._go_on, None
        if go_on is None:
            return
        if asyncio.current_task() is None:
            go_on(self)
        else:
            self.get_loop().call_soon(go_on, self)
