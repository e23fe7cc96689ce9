"""A client in memory: what it sends is received by a server at once, what the server sends is kept."""

from __future__ import annotations

import asyncio
import json
from typing import Any

from elitescript.lsp.frames import Frames
from elitescript.lsp.server import Server

URI = "file:///cells/one/a.script"


class MemoryClient:
    """Speaks to a server in the same event loop."""

    def __init__(self) -> None:
        self.loop = asyncio.new_event_loop()
        self.server = Server()
        self.exit_code: int | None = None
        self.server.connection.ended = self._ended
        self.server.protocol.set_writer(self)
        self._frames = Frames()
        self._next = 0
        self.received: list[dict[str, Any]] = []

    def _ended(self, code: int) -> None:
        self.exit_code = code

    def write(self, data: bytes) -> None:
        self.received += [json.loads(body) for body in self._frames.feed(data)]

    # ---------------------------------------------------------------- messages

    def raw(self, *bodies: bytes) -> None:
        """Send messages as they are, all before the server does anything else."""

        async def send() -> None:
            for body in bodies:
                self.server.connection.receive(body)
            await asyncio.sleep(0)

        self.loop.run_until_complete(send())

    def send(self, *messages: dict[str, Any]) -> None:
        self.raw(*[json.dumps({"jsonrpc": "2.0", **message}).encode() for message in messages])

    def notify(self, method: str, params: Any = None) -> None:
        self.send({"method": method} if params is None else {"method": method, "params": params})

    def request_message(self, method: str, params: Any = None) -> dict[str, Any]:
        """Return a request with a new id."""
        self._next += 1
        return {"id": self._next, "method": method} | ({} if params is None else {"params": params})

    def ask(self, method: str, params: Any = None) -> dict[str, Any]:
        """Return the whole answer to a request."""
        message = self.request_message(method, params)
        self.send(message)
        return self.answer(message["id"])

    def answer(self, number: Any) -> dict[str, Any]:
        return self.until(lambda message: "method" not in message and message.get("id") == number)

    def result(self, method: str, params: Any = None) -> Any:
        """Return the result of a request, which must not fail."""
        answer = self.ask(method, params)
        assert "error" not in answer, answer["error"]
        return answer["result"]

    def until(self, wanted: Any) -> dict[str, Any]:
        """Return the first message that is wanted; it is taken out of those that were received."""

        async def wait() -> dict[str, Any]:
            while True:
                for index, message in enumerate(self.received):
                    if wanted(message):
                        return self.received.pop(index)
                await asyncio.sleep(0.001)

        return self.loop.run_until_complete(asyncio.wait_for(wait(), 20))

    def notification(self, method: str) -> Any:
        """Return the parameters of the next message of the server with this method."""
        return self.until(lambda message: message.get("method") == method)["params"]

    def reply(self, message: dict[str, Any], result: Any) -> None:
        """Answer a request of the server."""
        self.send({"id": message["id"], "result": result})

    # ---------------------------------------------------------------- what most tests do

    def initialize(self, capabilities: dict[str, Any] | None = None, **more: Any) -> dict[str, Any]:
        params = {"processId": None, "rootUri": None, "capabilities": capabilities or {}, **more}
        result = self.result("initialize", params)
        self.notify("initialized", {})
        return result

    def open(self, text: str, uri: str = URI, version: int = 1) -> None:
        item = {"uri": uri, "languageId": "elitescript", "version": version, "text": text}
        self.notify("textDocument/didOpen", {"textDocument": item})

    def change(self, *changes: dict[str, Any], uri: str = URI, version: int = 2) -> None:
        self.notify("textDocument/didChange", change_params(*changes, uri=uri, version=version))

    def text(self, uri: str = URI) -> str:
        return self.server.texts.open[uri].text

    def close(self) -> None:
        async def end() -> None:
            self.server.close()
            left = asyncio.all_tasks() - {asyncio.current_task()}
            for task in left:
                task.cancel()
            await asyncio.gather(*left, return_exceptions=True)

        self.loop.run_until_complete(end())
        self.loop.close()


def change_params(*changes: dict[str, Any], uri: str = URI, version: int = 2) -> dict[str, Any]:
    return {"textDocument": {"uri": uri, "version": version}, "contentChanges": list(changes)}


def position(line: int, character: int) -> dict[str, int]:
    return {"line": line, "character": character}


def at(line: int, character: int, uri: str = URI) -> dict[str, Any]:
    return {"textDocument": {"uri": uri}, "position": position(line, character)}


def span(line: int, character: int, end_line: int, end_character: int) -> dict[str, Any]:
    return {"start": position(line, character), "end": position(end_line, end_character)}
