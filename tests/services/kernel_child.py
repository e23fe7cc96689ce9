"""A child in this process, without a socket: it answers ticks as the process does, at once or when the test lets it."""

from __future__ import annotations

from collections.abc import Callable

from elitescript.codec.json_text import from_text, to_text
from elitescript.codec.messages import shape_of
from elitescript.environment.memory import MemoryFiles
from elitescript.environment.request_channels import RequestEnvironment
from elitescript.kernel import Kernel
from elitescript.messages.snapshot import RobotDescription
from elitescript.services.child import frames
from elitescript.services.child.answers import TickAnswers
from elitescript.services.child.frames import FrameReader
from elitescript.services.options_data import options_from_data


class KernelChild:
    """Stands in for `ChildProcess`."""

    made: list[KernelChild]
    says_later: bool = False
    """Whether what it says when it comes up is not there yet when it is watched."""

    def __init__(self, on_message: Callable[[str, bytes], None], on_end: Callable[[str], None]) -> None:
        self._on_message, self.end = on_message, on_end
        self.pid, self.log = 4711, ""
        self.sent: list[int] = []
        """Ticks that it was sent."""
        self.asked_ahead: list[int] = []
        """Those with which rows were asked for."""
        self.unread: list[tuple[str, bytes]] = []
        self._is_watched = True
        self._reader = FrameReader()
        type(self).made.append(self)

    def watch(self, is_watched: bool) -> None:
        self._is_watched = is_watched
        if is_watched:
            self.read()

    def read(self) -> None:
        while self.unread:
            self._on_message(*self.unread.pop(0))

    def send(self, letter: str, content: str | bytes) -> None:
        data = content.encode() if isinstance(content, str) else content
        if letter == frames.LOCK_IN and self.says_later:
            self._is_watched = False
            self.say(frames.LOCKED_IN, b"[]")
            self._is_watched = True
        elif letter == frames.LOCK_IN:
            self.say(frames.LOCKED_IN, b"[]")
        elif letter == frames.BEGIN:
            kernel = Kernel(options_from_data(from_text(data)), RequestEnvironment(MemoryFiles({})))
            self._ticks = TickAnswers(kernel)
            self.say(frames.DESCRIBED, to_text(shape_of(RobotDescription).encode(kernel.description)).encode())
        elif letter == frames.TICK:
            number, _, _, ahead, *_ = frames.read_tick(data)
            self.sent.append(number)
            if ahead:
                self.asked_ahead.append(number)
            for message in self._reader.feed(b"".join(self._ticks.answers(data))):
                self.say(*message)

    def say(self, letter: str, content: bytes) -> None:
        self.unread.append((letter, content))
        if self._is_watched:
            self.read()

    def worked_s(self) -> float | None:
        return None

    def where(self) -> tuple[str, int] | None:
        return None

    def kill(self) -> None:
        self.unread.clear()

    async def gone(self) -> None:
        """It is."""
