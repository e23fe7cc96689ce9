"""One connection to a client: what it sends is checked, put in order and answered.

pygls has the types of the protocol, their JSON, and the requests that a server makes. What decides which message is
answered when, and with which error, is here:

- Messages take effect in the order in which they arrive. A notification takes effect at once; a request takes the text
  as it is at its place in that order, and waits.
- Waiting requests are answered one after the other, when no message is left to be read. So what was cancelled, or asked
  about a text that has changed since, is dropped before any work is done for it; or after it, if that message is late.
- Slow requests (findings of texts) are answered in a thread, and do not hold the others up.
- Each message gets at most one answer, whatever it is: an exception in the server is an answer too.
"""

from __future__ import annotations

import asyncio
import json
import logging
from collections import deque
from collections.abc import Awaitable, Callable
from typing import Any, Final

from lsprotocol import types
from pygls.exceptions import (
    JsonRpcContentModified,
    JsonRpcException,
    JsonRpcInternalError,
    JsonRpcInvalidParams,
    JsonRpcInvalidRequest,
    JsonRpcMethodNotFound,
    JsonRpcParseError,
    JsonRpcRequestCancelled,
    JsonRpcServerNotInitialized,
)
from pygls.protocol import LanguageServerProtocol

from elitescript.language.diagnostics import Outdated
from elitescript.records import record
from elitescript.shown import encodable_json
from elitescript.untrusted.json_text import JsonError, json_value

Id = int | str | None
Handler = Callable[..., Any]

_OPTIONAL: Final = "$/"
"""Begin of the methods that a server may leave unanswered if they are notifications."""

_log = logging.getLogger(__name__)


class RequestFailed(JsonRpcException):
    """The request makes sense, but cannot be done; the message says why."""

    CODE = types.LSPErrorCodes.RequestFailed.value


@record
class Request:
    """A request that waits.

    Attributes:
        id: of the client.
        method: what is asked.
        params: with the types of the protocol.
        uri: the text that it is about; empty if it is about no open one.
        document: that text when the request came; None without one.
    """

    id: Id
    method: str
    params: Any
    uri: str
    document: Any


class Connection(LanguageServerProtocol):
    """Answers the messages of one client; all of it in the thread of the event loop.

    Attributes:
        lifecycle: requests that are answered at once, by method.
        notices: what is done on a notification, by method.
        slow: coroutines of slow requests, by method; the other requests are the features of pygls.
        text_of: returns the open text of a URI; None if there is none.
        ended: called with the exit code when the client has said `exit`.
        is_initialized: whether `initialize` was answered.
        is_shut_down: whether `shutdown` was answered.
    """

    def __init__(self, server: Any, converter: Any) -> None:
        super().__init__(server, converter)
        self.lifecycle: dict[str, Callable[[Any], Any]] = {}
        self.notices: dict[str, Callable[[Any], None]] = {}
        self.slow: dict[str, Callable[[Any, Any], Awaitable[Any]]] = {}
        self.text_of: Callable[[str], object | None] = lambda uri: None
        self._waiting: deque[Request] = deque()
        self._active: dict[Id, Request] = {}
        """Requests that are not answered yet, by id."""
        self._tasks: dict[Id, asyncio.Future[Any]] = {}
        """Those of them that a thread works at."""
        self._is_woken = False
        self.is_initialized = False
        self.is_shut_down = False
        self.ended: Callable[[int], None] = lambda code: None

    def _register_builtin_features(self) -> None:
        """Leave out the text buffers of pygls: the texts of this server are `Document`s."""

    # ---------------------------------------------------------------- what comes in

    def receive(self, body: bytes) -> None:
        """Take one message; never raises."""
        try:
            data = json_value(body)
        except JsonError as error:
            self._fail(None, JsonRpcParseError(f"no JSON: {error}"))
            return
        try:
            self._take(data)
        except JsonRpcException as error:
            self._fail(_id_of(data), error)
        except Exception as error:
            _log.exception("a message could not be handled: %.500r", data)
            if _id_of(data) is not None:
                self._fail(_id_of(data), JsonRpcInternalError(f"{type(error).__name__}: {error}"))

    def _take(self, data: Any) -> None:
        if not isinstance(data, dict) or data.get("jsonrpc") != self.VERSION:
            raise JsonRpcInvalidRequest('a message is an object with "jsonrpc": "2.0"; batches are not part of LSP')
        method = data.get("method")
        if method is None and ("result" in data or "error" in data):
            self._take_answer(data)
            return
        if not isinstance(method, str):
            raise JsonRpcInvalidRequest("a message has a method, which is a text")
        if "id" in data:
            if not isinstance(data["id"], int | str) or isinstance(data["id"], bool):
                raise JsonRpcInvalidRequest("an id is a whole number or a text")
            self._take_request(data["id"], method, data)
        else:
            self._take_notification(method, data)

    def _take_answer(self, data: dict[str, Any]) -> None:
        """Hand the answer to a request of this server to what waits for it."""
        if data.get("id") not in self._request_futures:
            _log.warning("an answer to nothing: %.200r", data)
            return
        if self._request_futures[data["id"]].cancelled():
            # Nothing waits for it any more.
            del self._request_futures[data["id"]]
            self._result_types.pop(data["id"], None)
            return
        try:
            message = self.structure_message(data)
        except JsonRpcException:
            self._request_futures.pop(data["id"]).set_exception(JsonRpcInvalidParams("the answer has another type"))
            return
        if isinstance(message, types.ResponseErrorMessage):
            self._handle_response(data["id"], None, message.error)
        else:
            self._handle_response(data["id"], message.result)

    def _take_request(self, number: Id, method: str, data: dict[str, Any]) -> None:
        if self.is_shut_down:
            raise JsonRpcInvalidRequest("the server was shut down")
        if not self.is_initialized and method != types.INITIALIZE:
            raise JsonRpcServerNotInitialized("the first request is `initialize`")
        if self.is_initialized and method == types.INITIALIZE:
            raise JsonRpcInvalidRequest("`initialize` came before")
        if number in self._active:
            raise JsonRpcInvalidRequest(f"the request {number!r} is not answered yet")
        handler = self.lifecycle.get(method)
        if handler is not None:
            self._answer(number, handler(self._params(method, data)))
            return
        if method not in self.fm.features:
            raise JsonRpcMethodNotFound.of(method)
        params = self._params(method, data)
        uri = _uri_of(params)
        request = Request(number, method, params, uri, self.text_of(uri))
        self._active[number] = request
        slow = self.slow.get(method)
        if slow is not None:
            task: asyncio.Future[Any] = asyncio.ensure_future(slow(request.document, params))
            task.add_done_callback(lambda done: self._answer_slow(request, done))
            self._tasks[number] = task
            return
        self._waiting.append(request)
        self._wake()

    def _take_notification(self, method: str, data: dict[str, Any]) -> None:
        if method == types.EXIT:
            self.ended(0 if self.is_shut_down else 1)
            return
        if not self.is_initialized or self.is_shut_down:
            _log.warning("%s is left out: the server is not initialized, or was shut down", method)
            return
        handler = self.notices.get(method)
        if handler is None:
            if not method.startswith(_OPTIONAL):
                _log.warning("%s is not known", method)
            return
        try:
            handler(self._params(method, data))
        except JsonRpcException as error:
            _log.warning("%s is left out: %s", method, error)

    def _params(self, method: str, data: dict[str, Any]) -> Any:
        """Return the parameters of a message with the types of the protocol.

        Raises:
            JsonRpcInvalidParams: they have other types.
        """
        kind = self.get_message_type(method)
        assert kind is not None
        given = {name: value for name, value in data.items() if name in ("id", "method", "params", "jsonrpc")}
        if given.get("params") in (None, {}, []) and "params" in given and method in _WITHOUT_PARAMS:
            del given["params"]
        try:
            message = self._converter.structure(given, kind)
        except Exception as error:
            raise JsonRpcInvalidParams(f"{method}: {_reasons(error)}") from None
        return getattr(message, "params", None)

    # ---------------------------------------------------------------- what goes out

    def _wake(self) -> None:
        """Have the next waiting request answered once the messages are read that have already come."""
        if not self._is_woken and self._waiting:
            self._is_woken = True
            asyncio.get_running_loop().call_soon(self._work)

    def _work(self) -> None:
        self._is_woken = False
        while self._waiting:
            request = self._waiting.popleft()
            if self._active.get(request.id) is not request:
                continue
            if self._is_overtaken(request):
                self._finish(request, None, _overtaken())
                continue
            result, error = self._result(request)
            # What came in meanwhile is read first: it may have cancelled this.
            asyncio.get_running_loop().call_soon(self._finish, request, result, error)
            break
        self._wake()

    def _result(self, request: Request) -> tuple[Any, JsonRpcException | None]:
        try:
            return self.fm.features[request.method](request.document, request.params), None
        except JsonRpcException as error:
            return None, error
        except Exception as error:
            _log.exception("%s failed", request.method)
            return None, JsonRpcInternalError(f"{request.method}: {type(error).__name__}: {error}")

    def _answer_slow(self, request: Request, done: asyncio.Future[Any]) -> None:
        self._tasks.pop(request.id, None)
        if done.cancelled():
            return
        error = done.exception()
        if error is None:
            self._finish(request, done.result(), None)
        elif isinstance(error, Outdated):
            self._finish(request, None, _overtaken())
        elif isinstance(error, JsonRpcException):
            self._finish(request, None, error)
        else:
            _log.error("%s failed", request.method, exc_info=error)
            self._finish(request, None, JsonRpcInternalError(f"{request.method}: {type(error).__name__}: {error}"))

    def _finish(self, request: Request, result: Any, error: JsonRpcException | None) -> None:
        """Send the answer to a request, unless it was cancelled or its text has changed."""
        if self._active.get(request.id) is not request:
            return
        del self._active[request.id]
        if error is None and self._is_overtaken(request):
            error = _overtaken()
        if error is not None:
            self._fail(request.id, error)
        else:
            self._answer(request.id, result)

    def _is_overtaken(self, request: Request) -> bool:
        return request.document is not None and self.text_of(request.uri) is not request.document

    def cancel(self, number: Id) -> None:
        """Answer a request with the error of a cancelled one; nothing happens if it was answered."""
        if self._active.pop(number, None) is not None:
            if (task := self._tasks.pop(number, None)) is not None:
                task.cancel()
            self._fail(number, JsonRpcRequestCancelled("cancelled"))

    def _answer(self, number: Id, result: Any) -> None:
        self._send_data({"jsonrpc": self.VERSION, "id": number, "result": result})

    def _fail(self, number: Id, error: JsonRpcException) -> None:
        said = {"code": error.code, "message": error.message}
        self._send_data({"jsonrpc": self.VERSION, "id": number, "error": said})

    def _send_data(self, data: Any) -> None:
        """Write one message; in place of that of pygls, which loses an answer that cannot be written as JSON."""
        text = json.dumps(data, default=self._serialize_message, separators=(",", ":"))
        body = encodable_json(text).encode()
        if self.writer is not None:
            self.writer.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))

    def close(self) -> None:
        """End everything that is under way; nobody waits for it any more."""
        self._waiting.clear()
        self._active.clear()
        for task in self._tasks.values():
            task.cancel()


_WITHOUT_PARAMS: Final = frozenset((types.SHUTDOWN, types.EXIT))
"""Methods without parameters; some clients send empty ones."""


def _overtaken() -> JsonRpcContentModified:
    return JsonRpcContentModified("the text has changed since")


def _id_of(data: Any) -> Id:
    number = data.get("id") if isinstance(data, dict) else None
    return number if isinstance(number, int | str) and not isinstance(number, bool) else None


def _uri_of(params: Any) -> str:
    """Return the text that a request is about; empty if there is none."""
    named = getattr(params, "text_document", None) or getattr(params, "item", None)
    uri = getattr(named, "uri", "")
    return uri if isinstance(uri, str) else ""


def _reasons(error: Exception) -> str:
    """Return what is wrong with parameters, in one line."""
    from cattrs import transform_error

    try:
        return "; ".join(transform_error(error, path="params"))[:500]
    except Exception:
        return str(error)
