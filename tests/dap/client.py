"""A client of the debug adapter: a method for each request, over anything that takes and gives messages."""

from __future__ import annotations

import json
import os
import queue
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from elitescript.dap.adapter import Adapter
from elitescript.dap.framing import Decoder, Malformed, framed
from elitescript.dap.requests.catalogue import HANDLERS

WAIT_S = 30.0


class Failed(Exception):
    """A request that was answered with an error; holds the response."""

    def __init__(self, response: dict[str, Any]) -> None:
        super().__init__(response["message"])
        self.response = response

    @property
    def number(self) -> int:
        return int(self.response["body"]["error"]["id"])

    @property
    def text(self) -> str:
        return str(self.response["body"]["error"]["format"])


class Client:
    """Sends requests and keeps what comes back. `answers` has every response, by the number of its request."""

    def __init__(self, send: Callable[[bytes], object]) -> None:
        self._send = send
        self._decoder = Decoder()
        self._inbox: queue.Queue[dict[str, Any] | None] = queue.Queue()
        self.seq = 0
        self.events: list[dict[str, Any]] = []
        self.answers: dict[int, list[dict[str, Any]]] = {}
        self.commands: dict[int, str] = {}
        self.is_closed = False
        self.launched = 0
        self.launch_outputs = ""
        self.all_events: list[dict[str, Any]] = []

    def receive(self, data: bytes) -> None:
        """Take bytes of the adapter; an empty text is their end."""
        for message in self._decoder.feed(data):
            assert not isinstance(message, Malformed), message
            self._inbox.put(message)
        if not data:
            self._inbox.put(None)

    # ---------------------------------------------------------------- messages

    def send(self, command: str, **arguments: Any) -> int:
        """Send a request; return its number."""
        self.seq += 1
        message: dict[str, Any] = {"seq": self.seq, "type": "request", "command": command}
        if arguments:
            message["arguments"] = arguments
        self.commands[self.seq] = command
        self._send(framed(message))
        return self.seq

    def send_bytes(self, data: bytes) -> None:
        self._send(data)

    def pump(self) -> bool:
        """Take one message; return whether there was one."""
        if self.is_closed:
            return False
        message = self._inbox.get(timeout=WAIT_S)
        if message is None:
            self.is_closed = True
            return False
        if message["type"] == "event":
            self.events.append(message)
            self.all_events.append(message)
        else:
            self.answers.setdefault(message["request_seq"], []).append(message)
        return True

    def answer(self, seq: int) -> dict[str, Any]:
        """Wait for the response to a request; return its body."""
        while seq not in self.answers:
            assert self.pump(), f"the adapter ended without an answer to {self.commands.get(seq)}"
        found = self.answers[seq][0]
        if not found["success"]:
            raise Failed(found)
        body: dict[str, Any] = found.get("body", {})
        return body

    def request(self, command: str, **arguments: Any) -> dict[str, Any]:
        """Send a request and wait for its response."""
        return self.answer(self.send(command, **arguments))

    def event(self, *names: str) -> dict[str, Any]:
        """Wait for the next event of these names, and take it away with those before it."""
        while True:
            for at, message in enumerate(self.events):
                if message["event"] in names:
                    del self.events[: at + 1]
                    return message
            assert self.pump(), f"the adapter ended without {names}"

    def bodies(self, name: str) -> list[dict[str, Any]]:
        """Return the bodies of all events of a name that have come since the begin."""
        return [one["body"] for one in self.all_events if one["event"] == name]

    def texts(self) -> list[str]:
        """Return the texts of all output events that have come since the begin."""
        return [body["output"] for body in self.bodies("output")]

    def outputs(self) -> str:
        """Return the texts of output events that have come and were not taken."""
        return "".join(one["body"]["output"] for one in self.events if one["event"] == "output")

    # ---------------------------------------------------------------- a session

    def initialize(self, **settings: Any) -> dict[str, Any]:
        return self.request("initialize", adapterID="elitescript", **settings)

    def launch(self, program: Path | str, **settings: Any) -> int:
        """Send `launch`, and wait until breakpoints can be set; return the number of the request."""
        seq = self.send("launch", program=str(program), **settings)
        while seq not in self.answers and not any(one["event"] == "initialized" for one in self.events):
            assert self.pump()
        if seq in self.answers:
            self.answer(seq)
        self.launched, self.launch_outputs = seq, self.outputs()
        self.event("initialized")
        return seq

    def stop_of(self, seq: int) -> dict[str, Any]:
        """Let the program that was launched begin; return the event of its first stop or its end."""
        self.request("configurationDone")
        self.answer(seq)
        return self.stop()

    def stop(self) -> dict[str, Any]:
        """Wait for a stop or the end; return the event."""
        return self.event("stopped", "terminated")

    def start(
        self, program: Path | str, *lines: int | dict[str, Any], filters: tuple[str, ...] = (), **settings: Any
    ) -> dict[str, Any]:
        """Begin a session with breakpoints; return the event of the first stop or of the end."""
        self.initialize()
        seq = self.launch(program, **settings)
        if lines:
            self.set_breakpoints(program, *lines)
        if filters:
            self.request("setExceptionBreakpoints", filters=list(filters))
        return self.stop_of(seq)

    def set_breakpoints(self, program: Path | str, *lines: int | dict[str, Any]) -> list[dict[str, Any]]:
        breakpoints = [{"line": line} if isinstance(line, int) else line for line in lines]
        body = self.request("setBreakpoints", source={"path": str(program)}, breakpoints=breakpoints)
        found: list[dict[str, Any]] = body["breakpoints"]
        return found

    def go(self, command: str, thread: int = 1, **arguments: Any) -> dict[str, Any]:
        """Send a request that lets the program go on; return the event of its stop or its end."""
        self.events.clear()
        self.request(command, threadId=thread, **arguments)
        return self.stop()

    def stack(self, thread: int = 1) -> list[dict[str, Any]]:
        frames: list[dict[str, Any]] = self.request("stackTrace", threadId=thread)["stackFrames"]
        return frames

    def line(self, thread: int = 1) -> int:
        return int(self.stack(thread)[0]["line"])

    def scopes(self, thread: int = 1) -> dict[str, int]:
        """Return the references of the scopes of the innermost call."""
        body = self.request("scopes", frameId=self.stack(thread)[0]["id"])
        return {scope["name"]: scope["variablesReference"] for scope in body["scopes"]}

    def variables(self, reference: int) -> dict[str, str]:
        body = self.request("variables", variablesReference=reference)
        return {one["name"]: one["value"] for one in body["variables"]}

    def evaluate(self, expression: str, context: str = "watch", thread: int = 1) -> str:
        frame = self.stack(thread)[0]["id"]
        return str(self.request("evaluate", expression=expression, context=context, frameId=frame)["result"])

    def moment(self, thread: int = 1) -> str:
        """Return everything that the present moment shows, for comparisons."""
        shown: list[Any] = [self.request("elitescript/state")]
        for one in self.request("threads")["threads"]:
            frames = self.stack(one["id"])
            shown.append([one["name"], [(frame["name"], frame["line"]) for frame in frames]])
        if self.stack(thread):
            shown += [self.variables(reference) for reference in self.scopes(thread).values()]
        return json.dumps(shown, sort_keys=True)

    def disconnect(self) -> None:
        """End the session, and check that every request got one answer."""
        self.request("disconnect")
        self.check_answers()

    def disconnect_among_others(self) -> None:
        """End the session while requests wait for their answers, and check that each got one."""
        seq = self.send("disconnect")
        while seq not in self.answers:
            assert self.pump()
        self.answers.pop(0, None)
        for number, command in self.commands.items():
            assert number in self.answers, f"{command} got no answer"

    def check_answers(self) -> None:
        for seq, command in self.commands.items():
            assert len(self.answers.get(seq, ())) == 1, f"{command} got {len(self.answers.get(seq, ()))} answers"


# ---------------------------------------------------------------- ways to an adapter


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2] / "src")}


@contextmanager
def process_client() -> Iterator[Client]:
    """A client of `elitescript dap` in a process, over its standard input and output."""
    process = subprocess.Popen(
        [sys.executable, "-m", "elitescript", "dap"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=environment(),
    )
    assert process.stdin is not None
    assert process.stdout is not None
    stdin, stdout = process.stdin, process.stdout

    def send(data: bytes) -> None:
        stdin.write(data)
        stdin.flush()

    client = Client(send)

    def read() -> None:
        while data := os.read(stdout.fileno(), 1 << 16):
            client.receive(data)
        client.receive(b"")

    reader = threading.Thread(target=read, daemon=True)
    reader.start()
    try:
        yield client
    finally:
        stdin.close()
        try:
            assert process.wait(10) == 0
        finally:
            process.kill()
            process.wait()
            reader.join(5)
            stdout.close()


@contextmanager
def socket_client(port: int) -> Iterator[Client]:
    """A client of `elitescript dap --tcp PORT`."""
    with socket.create_connection(("127.0.0.1", port)) as connection:
        client = Client(connection.sendall)

        def read() -> None:
            try:
                while data := connection.recv(1 << 16):
                    client.receive(data)
            except OSError:
                pass
            client.receive(b"")

        reader = threading.Thread(target=read, daemon=True)
        reader.start()
        yield client
        with suppress(OSError):
            connection.shutdown(socket.SHUT_RDWR)
        reader.join(5)


class MemoryRequests:
    """Requests that a test lets arrive while the program runs; implements `adapter.Requests`."""

    def __init__(self) -> None:
        self.waiting: list[dict[str, Any]] = []

    def next(self) -> dict[str, Any]:
        return self.waiting.pop(0)

    def has_next(self) -> bool:
        return bool(self.waiting)

    def post(self, call: Callable[[], None]) -> None:
        raise AssertionError("nothing here has a thread of its own")


class MemoryClient(Client):
    """A client whose adapter is an object of this process: each request is carried out before `send` returns.

    What is sent inside `meanwhile` arrives when the next request has let the program go on.
    """

    def __init__(self) -> None:
        super().__init__(self._deliver)
        self.requests = MemoryRequests()
        self.adapter = Adapter(self._inbox.put, self.requests, HANDLERS)
        self._is_meanwhile = False

    @contextmanager
    def meanwhile(self) -> Iterator[None]:
        self._is_meanwhile = True
        yield
        self._is_meanwhile = False

    def _deliver(self, data: bytes) -> None:
        (message,) = Decoder().feed(data)
        assert isinstance(message, dict)
        if self._is_meanwhile:
            self.requests.waiting.append(message)
        else:
            self.adapter.handle(message)

    def pump(self) -> bool:
        assert not self._inbox.empty(), "no message comes any more"
        return super().pump()
