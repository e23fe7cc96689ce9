"""A page without a browser: starts the studio, connects as the page does, sends messages and collects what comes.

with studio(path) as address, Page(address) as page:
    hello = page.wait("hello")
    page.send("program", version=1, text=TEXT)
    ended = page.wait("run_ended")
    page.ask("seek", run=ended["run"], t=1.0)
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from itertools import count
from pathlib import Path
from time import monotonic
from typing import Any
from urllib.parse import urlsplit

from websockets.sync.client import connect
from websockets.typing import Origin

ROOT = Path(__file__).resolve().parents[2]
WAIT_S = 20.0

Message = dict[str, Any]


@contextmanager
def studio(*words: str | Path, state: Path | None = None, **environment: str) -> Iterator[str]:
    """Start `elitescript studio`; yield the address of its page, and end it.

    Args:
        words: of the command line.
        state: folder for drafts and settings; that of the user if None.
        environment: further variables.
    """
    with process(*words, state=state, **environment) as (started, address):
        yield address
        started.send_signal(signal.SIGTERM)
        assert started.wait(WAIT_S) == 0


@contextmanager
def process(
    *words: str | Path, state: Path | None = None, **environment: str
) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Start `elitescript studio`; yield its process and the address of its page. It is killed in the end."""
    own = {"PYTHONPATH": str(ROOT / "src"), **({} if state is None else {"XDG_STATE_HOME": str(state)})}
    started = subprocess.Popen(
        [sys.executable, "-m", "elitescript", "studio", "--no-browser", *map(str, words)],
        env={**os.environ, **own, **environment},
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert started.stdout is not None
        word, _, address = started.stdout.readline().rstrip().partition(" ")
        assert word == "ready"
        yield started, address
    finally:
        started.kill()
        started.wait()
        assert started.stdout is not None
        started.stdout.close()


class Page:
    """A connected page.

    Args:
        address: that the studio has printed.

    Attributes:
        messages: that have come, the oldest first; rows are bytes.
    """

    def __init__(self, address: str) -> None:
        self.messages: list[Message | bytes] = []
        self._address = urlsplit(address)
        self._asks = count(1)
        self._seen = 0
        self._opened = ExitStack()

    def __enter__(self) -> Page:
        at = self._address
        opening = connect(
            f"ws://{at.netloc}/socket?{at.query}",
            origin=Origin(f"http://{at.netloc}"),
            compression=None,
            max_size=None,
            proxy=None,
        )
        self._socket = self._opened.enter_context(opening)
        return self

    def __exit__(self, *_: object) -> None:
        self._opened.close()

    def send(self, type_: str, **fields: Any) -> None:
        """Send a message."""
        self._socket.send(json.dumps({"type": type_, **fields}))

    def send_text(self, text: str | bytes) -> None:
        """Send what need not be a message."""
        self._socket.send(text)

    def wait(
        self, type_: str, test: Callable[[Message], bool] = lambda message: True, within_s: float = WAIT_S
    ) -> Message:
        """Return the next message of a type that passes a test; those before it are left out."""
        end = monotonic() + within_s
        while True:
            while self._seen < len(self.messages):
                message = self.messages[self._seen]
                self._seen += 1
                if isinstance(message, dict) and message["type"] == type_ and test(message):
                    return message
            self._receive(end - monotonic())

    def ask(self, type_: str, within_s: float = WAIT_S, **fields: Any) -> Message:
        """Send a message, and return the answer to it."""
        number = next(self._asks)
        self.send(type_, ask=number, **fields)
        end = monotonic() + within_s
        first = len(self.messages)
        while True:
            for message in self.messages[first:]:
                first += 1
                if isinstance(message, dict) and message.get("ask") == number:
                    return message
            self._receive(end - monotonic())

    def service(self, service: str, version: int = 0, **arguments: Any) -> Any:
        """Return the result of an editor service."""
        answer = self.ask("service", service=service, version=version, **arguments)
        assert answer["type"] == "answer", answer
        return answer["result"]

    def _receive(self, left_s: float) -> None:
        data = self._socket.recv(timeout=max(left_s, 0.0))
        self.messages.append(data if isinstance(data, bytes) else json.loads(data))
