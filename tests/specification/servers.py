"""Servers and serial devices of specification pages."""

from __future__ import annotations

from ast import literal_eval
from collections.abc import Callable, Iterable

from elitescript.devices.channels.network import DeviceLink, Peer, VirtualNetwork
from elitescript.errors import UsageError

Act = Callable[[DeviceLink], None]


class PageServer:
    """A server or a serial device as a page describes it, one action a row.

    `after 0.5 send "text"` and `after 0.5 close` count from the moment when the connection or line is open; `on
    "question" send "answer"` answers each question. Texts are written as in Python.

    Args:
        line: of its block in the page.
        text: the lines.

    Attributes:
        received: all that programs have sent to it.

    Raises:
        UsageError: a line that cannot be read.
    """

    def __init__(self, line: int, text: str) -> None:
        self.received = bytearray()
        self.plan: list[tuple[float, Act]] = []
        self.answers: list[tuple[bytes, bytes]] = []
        for number, row in enumerate(text.splitlines(), line):
            try:
                self._read(row.strip())
            except (SyntaxError, ValueError):
                forms = 'after 0.5 send "text", after 0.5 close, on "question" send "answer"'
                raise UsageError(f"line {number}: {row!r} is nothing that a server does; write {forms}") from None

    def _read(self, row: str) -> None:
        word, _, rest = row.partition(" ")
        if word == "on":
            question, _, answer = rest.partition(" send ")
            self.answers.append((_bytes(question), _bytes(answer)))
        elif word == "after":
            time_s, _, action = rest.partition(" ")
            verb, _, data = action.partition(" ")
            if verb == "send":
                sent = _bytes(data)
                self.plan.append((float(time_s), lambda link: link.send(sent)))
            elif action == "close":
                self.plan.append((float(time_s), DeviceLink.close))
            else:
                raise ValueError(action)
        elif row:
            raise ValueError(row)

    def accept(self, link: DeviceLink) -> Peer:
        """Return a connection."""
        return _PagePeer(link, self)


class _PagePeer(Peer):
    def __init__(self, link: DeviceLink, server: PageServer) -> None:
        super().__init__(link)
        self._server = server
        self._unanswered = b""

    def opened(self) -> None:
        for time_s, act in self._server.plan:
            if time_s:
                self.link.later(time_s, lambda act=act: act(self.link))  # type: ignore[misc]
            else:
                act(self.link)

    def received(self, data: bytes) -> None:
        self._server.received += data
        self._unanswered += data
        for question, answer in self._server.answers:
            while question in self._unanswered:
                self._unanswered = self._unanswered.partition(question)[2]
                self.link.send(answer)


def _bytes(literal: str) -> bytes:
    value = literal_eval("b" + literal.strip())
    if not isinstance(value, bytes) or not value:
        raise ValueError(literal)
    return value


def network(servers: Iterable[PageServer], ends: Iterable[int | str]) -> VirtualNetwork:
    """Return a network with servers on ports, and devices on serial lines."""
    found = VirtualNetwork()
    for end, server in zip(ends, servers, strict=True):
        if isinstance(end, int):
            found.servers[end] = server.accept
        else:
            found.lines[end] = server.accept
    return found


def written(data: bytes | bytearray) -> str:
    """Return bytes as a page writes them."""
    return repr(bytes(data))[2:-1]
