"""The far end of the way to a child, without a process: the test says when it answers, and in how many pieces."""

from __future__ import annotations

import asyncio
import os
import socket
from collections import deque
from typing import Any

import pytest

from elitescript.codec.json_text import to_text
from elitescript.codec.messages import shape_of
from elitescript.messages.outputs import Output, TickResult
from elitescript.messages.snapshot import RobotDescription
from elitescript.services.child import frames
from elitescript.services.child import process as child_process
from tests.protocol.snapshots import description, output


class FarChild:
    """Stands in for `subprocess.Popen`: what is sent to the child, the test answers.

    Attributes:
        is_prompt: whether it answers each tick as soon as the event loop has brought it.
        waiting: ticks that it has read and not answered, with the parts of the snapshot that are asked for.
    """

    made: list[FarChild]
    pid = 4711
    returncode = None

    def __init__(self, command: list[str], *, pass_fds: list[int], **_options: Any) -> None:
        self._socket = socket.socket(fileno=os.dup(pass_fds[0]))
        self._socket.setblocking(False)
        self._reader = frames.FrameReader()
        log, self._log = os.pipe()
        self.stdout = os.fdopen(log, "rb", buffering=0)
        self.is_prompt = True
        self.waiting: deque[tuple[int, int]] = deque()
        self.is_killed = False
        asyncio.get_running_loop().add_reader(self._socket, self.read)
        FarChild.made.append(self)

    def read(self) -> None:
        """Take what was sent."""
        try:
            data = self._socket.recv(1 << 16)
        except BlockingIOError:
            return
        if not data:
            self.kill()
            return
        for letter, text in self._reader.feed(data):
            if letter == frames.LOCK_IN:
                self._socket.sendall(frames.frame(frames.LOCKED_IN, "[]"))
            elif letter == frames.BEGIN:
                told = to_text(shape_of(RobotDescription).encode(description()))
                self._socket.sendall(frames.frame(frames.DESCRIBED, told))
            elif letter == frames.TICK:
                self.waiting.append(frames.read_tick(text)[:2])
        if self.is_prompt:
            self.answer(len(self.waiting))

    def answer(self, count: int) -> None:
        """Answer the oldest ticks that wait, in one piece."""
        self._socket.sendall(b"".join(self._message(*self.waiting.popleft()) for _ in range(count)))

    def _message(self, tick: int, parts: int) -> bytes:
        if not parts:
            data = to_text([0, shape_of(TickResult).encode(TickResult(tick, (), (), ()))])
            return frames.frame(frames.RESULT, frames.answer_content(tick + 1, data))
        data = to_text(shape_of(Output).encode(output(tick)))
        return frames.frame(frames.OUTPUT, frames.answer_content(tick + 1, data))

    def kill(self) -> None:
        if not self.is_killed:
            self.is_killed = True
            asyncio.get_running_loop().remove_reader(self._socket)
            self._socket.close()
            os.close(self._log)

    def poll(self) -> int | None:
        return -9 if self.is_killed else None

    def wait(self, _timeout_s: float) -> int | None:
        return self.poll()

    def send_signal(self, _number: int) -> None:
        """It does not say where it is."""


@pytest.fixture
def far_children(monkeypatch: pytest.MonkeyPatch) -> list[FarChild]:
    """Children that are made from now on are these."""
    FarChild.made = []
    monkeypatch.setattr(child_process.subprocess, "Popen", FarChild)
    return FarChild.made
