"""What a debugger on a `ctl` connection hears between its answers, and its leave when the connection ends."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Iterable
from typing import Any, Final

from elitescript.codec.json_text import from_text
from elitescript.codec.values import CodecError
from elitescript.messages.inputs import Debug
from elitescript.messages.outcomes import Debugged, Outcome
from elitescript.messages.outputs import Output
from elitescript.services.robot_server import RobotServer

UNREAD_MAX: Final = 16 * 1024 * 1024
"""Bytes that may wait for a debugger that does not read; then it is hung up on."""
TEXT_MAX: Final = 2 * 1024 * 1024
"""Characters of an answer; a longer one would take the time of other clients."""
DETACH: Final = json.dumps({"do": "detach"})


class DebugEvents:
    """Sends the events of one debugger.

    Args:
        server: the robot.
        session: origin of the connection.
        writer: to the debugger.
    """

    __slots__ = ("_is_open", "_restarts", "_server", "_session", "_writer")

    def __init__(self, server: RobotServer, session: str, writer: asyncio.StreamWriter) -> None:
        self._server = server
        self._session = session
        self._writer = writer
        self._is_open = False
        self._restarts = 0

    def open(self) -> None:
        """Send what happens from now on."""
        if not self._is_open:
            self._is_open = True
            self._restarts = self._server.link.restarts
            self._server.observers.append(self._take)

    def close(self) -> None:
        """Send no more; the robot goes on without a debugger."""
        if self._is_open:
            self._is_open = False
            self._server.observers.remove(self._take)
            self._server.post([Debug(f"{self._session}/end", self._session, DETACH)])

    def _take(self, output: Output) -> None:
        for reply in output.replies:
            if reply.origin == self._session and isinstance(reply.outcome, Debugged):
                self._send(_object(reply.outcome.text))
        if self._server.link.restarts != self._restarts:
            self._restarts = self._server.link.restarts
            self._send({"event": "detached", "reason": "the robot's process was replaced"})

    def _send(self, event: dict[str, Any]) -> None:
        transport = self._writer.transport
        if transport.get_write_buffer_size() > UNREAD_MAX:
            transport.abort()
        elif "event" in event:
            self._writer.write(json.dumps(event).encode() + b"\n")


def debug_result(outcomes: Iterable[Outcome]) -> dict[str, Any]:
    """Return what an answer to a debugger adds: `result`; nothing for other answers."""
    texts = [outcome.text for outcome in outcomes if isinstance(outcome, Debugged)]
    return {"result": _object(texts[0])} if texts else {}


def _object(text: str) -> dict[str, Any]:
    """Return the object of a JSON text; an empty one if it is none: it may come from a process that is not trusted."""
    try:
        data = from_text(text, TEXT_MAX)
        json.dumps(data)
    except (CodecError, RecursionError):
        return {}
    return data if isinstance(data, dict) else {}
