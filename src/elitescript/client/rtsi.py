"""A client of the RTSI port: negotiates, sets recipes up, and reads packages."""

from __future__ import annotations

import asyncio
import contextlib
from collections import deque
from collections.abc import AsyncIterator, Mapping, Sequence
from typing import Final

from elitescript.client.connecting import CommandError, Inflow, LinkError, connected, read_some
from elitescript.client.rtsi_messages import (
    TYPES,
    Frame,
    FrameReader,
    InputLayout,
    OutputLayout,
    accepted,
    controller_version,
    input_request,
    known,
    message,
    output_request,
    set_up_of,
    text_of,
    version_request,
)
from elitescript.errors import PeerError
from elitescript.protocol.binary import WireValue
from elitescript.protocol.rtsi.connection import IN_USE
from elitescript.protocol.rtsi.recipes import DATA_PACKAGE

ANSWER_S: Final = 2.0
"""Longest time for an answer; the vendor's client waits 1 s."""
SILENCE_S: Final = 2.0
"""Longest time without a package."""
MESSAGES_PER_S: Final = 10_000.0
BYTES_PER_S: Final = 8e6
"""What a controller may send; 250 packages a second of 2 kB have 0.5 MB."""
_TEXT: Final = ord("M")
_TEXTS_KEPT: Final = 100


class RtsiClient:
    """One connection; `rtsi_client` opens it.

    Args:
        reader: from the controller.
        writer: to it.
        may_command: whether inputs may be written.

    Attributes:
        texts: the newest text messages of the controller, level and words.
        strange: packages of recipes that were never set up, which are left out.
    """

    __slots__ = ("_frames", "_inflow", "_layouts", "_may_command", "_reader", "_waiting", "_writer", "strange", "texts")

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, *, may_command: bool) -> None:
        self._reader = reader
        self._writer = writer
        self._may_command = may_command
        self._frames = FrameReader()
        self._inflow = Inflow("RTSI", MESSAGES_PER_S, BYTES_PER_S)
        self._waiting: deque[Frame] = deque()
        self._layouts: dict[int, OutputLayout] = {}
        self.texts: deque[tuple[str, str]] = deque(maxlen=_TEXTS_KEPT)
        self.strange = 0

    async def negotiate(self) -> tuple[int, int, int, int]:
        """Agree on the protocol; return the controller's version.

        Raises:
            PeerError: the controller does not speak it.
        """
        if not accepted(await self._ask(version_request(), "V"), "V (protocol version)"):
            raise PeerError("RTSI: the controller refuses version 1 of the protocol")
        return controller_version(await self._ask(message("v"), "v"))

    async def set_up_outputs(self, names: Sequence[str], frequency_hz: float) -> OutputLayout:
        """Ask for packages of variables; those that the controller does not have are left out.

        Returns:
            The layout; its `names` are the variables that will come.

        Raises:
            PeerError: it has none of them, or does not answer to the point.
        """
        wanted = tuple(names)
        for _ in range(2):
            answer = set_up_of(await self._ask(output_request(wanted, frequency_hz), "O"), wanted, "output")
            if answer.is_complete:
                layout = OutputLayout(answer.ident, wanted, answer.words, frequency_hz)
                self._layouts[answer.ident] = layout
                return layout
            wanted = known(wanted, answer.words)
            if not wanted:
                raise PeerError(f"RTSI: the controller has none of {', '.join(names)}")
        raise PeerError(f"RTSI: the controller refuses an output recipe of {', '.join(wanted)}")

    async def set_up_inputs(self, names: Sequence[str]) -> InputLayout:
        """Ask to write variables.

        Raises:
            CommandError: this connection only reads.
            PeerError: the controller does not have one, or another client writes it; names it.
        """
        if not self._may_command:
            raise CommandError("this connection only reads: it may not set up RTSI inputs")
        answer = set_up_of(await self._ask(input_request(names), "I"), names, "input")
        if not answer.is_complete:
            missing = {name: word for name, word in zip(names, answer.words, strict=True) if word not in TYPES}
            reasons = ", ".join(
                f"{name} {'belongs to another client' if word == IN_USE else 'is not there'}"
                for name, word in missing.items()
            )
            raise PeerError(f"RTSI: the controller refuses inputs: {reasons or 'it does not say why'}")
        return InputLayout(answer.ident, names, answer.words)

    async def start(self) -> None:
        """Let packages flow.

        Raises:
            PeerError: the controller refuses.
        """
        if not accepted(await self._ask(message("S"), "S"), "S (start)"):
            raise PeerError("RTSI: the controller does not start to send packages")

    async def pause(self) -> None:
        """Stop the packages.

        Raises:
            PeerError: the controller refuses.
        """
        if not accepted(await self._ask(message("P"), "P"), "P (pause)"):
            raise PeerError("RTSI: the controller does not stop to send packages")

    async def packages(self, timeout_s: float = SILENCE_S) -> list[tuple[OutputLayout, bytes]]:
        """Return the packages that have arrived, at least one: the layout of each, and its payload for `flat`.

        Raises:
            LinkError: none came within the time, or the connection has ended.
        """
        found: list[tuple[OutputLayout, bytes]] = []
        end = asyncio.get_running_loop().time() + timeout_s
        while not found:
            if not self._waiting:
                await self._read(end, "packages")
            while self._waiting:
                command, payload = self._waiting.popleft()
                if command == DATA_PACKAGE and payload:
                    layout = self._layouts.get(payload[0])
                    if layout is None:
                        self.strange += 1
                    else:
                        found.append((layout, payload))
                elif command == _TEXT:
                    self.texts.append(text_of(payload))
        return found

    def write(self, layout: InputLayout, values: Mapping[str, WireValue]) -> None:
        """Write the variables of an input recipe; returns at once.

        Raises:
            CommandError: this connection only reads.
            LinkError: the connection has ended.
        """
        if not self._may_command:
            raise CommandError("this connection only reads: it may not write RTSI inputs")
        if self._writer.transport.is_closing():
            raise LinkError("RTSI: the connection has ended")
        self._writer.write(layout.package(values))

    async def _ask(self, request: bytes, letter: str) -> bytes:
        """Send a request; return the payload of its answer. Packages and texts in between are kept."""
        self._writer.write(request)
        passed: list[Frame] = []
        end = asyncio.get_running_loop().time() + ANSWER_S
        try:
            while True:
                while self._waiting:
                    frame = self._waiting.popleft()
                    if frame.command == ord(letter):
                        return frame.payload
                    if frame.command == _TEXT:
                        self.texts.append(text_of(frame.payload))
                    else:
                        passed.append(frame)
                await self._read(end, f"answer to {letter}")
        finally:
            self._waiting.extendleft(reversed(passed))

    async def _read(self, end: float, what: str) -> None:
        """Read once, up to a time of the loop."""
        # Raises if no message can follow those that were taken.
        self._frames.feed(b"")
        loop = asyncio.get_running_loop()
        data = await read_some(self._reader, end - loop.time(), f"RTSI, {what}")
        frames = self._frames.feed(data)
        self._inflow.take(len(frames), len(data), loop.time())
        self._waiting.extend(frames)


@contextlib.asynccontextmanager
async def rtsi_client(host: str, port: int, *, may_command: bool = False) -> AsyncIterator[RtsiClient]:
    """Connect to the RTSI port; hang up at the end of the block.

    Raises:
        LinkError: there is no connection, it has ended, or the controller does not keep the protocol.
    """
    async with connected(host, port, "RTSI") as (reader, writer):
        yield RtsiClient(reader, writer, may_command=may_command)
