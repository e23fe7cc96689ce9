"""Remote procedure calls of a program: XML-RPC over the channels of its environment (manual 2.10, chapter 5.2).

A handle connects when a procedure is called. Its connection is kept for the next call if the server keeps it. Values
are numbers, texts, bytes, lists and dicts; a date is received as text (*assumed*), and None is sent as `nil`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final
from urllib.parse import SplitResult, urlsplit
from xml.parsers.expat import ExpatError
from xmlrpc import client

from elitescript.errors import (
    ArgumentRangeError,
    ArgumentTypeError,
    InvalidValueError,
    PeerError,
    RpcError,
    ScriptStateError,
)
from elitescript.messages.timing import seconds
from elitescript.records import NamedTuple
from elitescript.runtime.connections.connection import Receiver, ScriptConnection
from elitescript.runtime.connections.http_answers import HttpAnswer, HttpReader
from elitescript.runtime.connections.rpc_texts import values_and_method
from elitescript.runtime.connections.sockets import CONNECT_TICKS, NO_NETWORK
from elitescript.runtime.connections.traffic import ChannelLog, Traffic, cut
from elitescript.runtime.environment import Channels, without_addresses
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import Stopped
from elitescript.said import said
from elitescript.sealed import Sealed, no_copy

CALLS_MAX: Final = 32
"""Most simultaneous calls of one program (*assumed*)."""
IDLE_MAX: Final = 8
"""Most idle connections; the least recently used one is closed for another (*assumed*)."""

_HTTP_PORT: Final = 80
_OK: Final = 200


class RpcServer(NamedTuple):
    """A server of procedures."""

    url: str
    address: str
    port: int
    path: str


class RpcCall(NamedTuple):
    """A call of a procedure."""

    method: str
    args: tuple[Any, ...]
    request: bytes
    """The HTTP request."""


class RemoteProcedures:
    """The calls of one program.

    Args:
        channels: carry the bytes.
        scheduler: runs the threads.
        connections: of every program of the host, by channel.
        traffic: records calls and responses.
        answer_s: timeout of a call, s; 0 and less waits for ever.
    """

    __slots__ = ("_answer_s", "_busy", "_channels", "_connections", "_idle", "_is_over", "_scheduler", "_traffic")

    def __init__(
        self,
        channels: Channels,
        scheduler: Scheduler,
        connections: dict[int, Receiver],
        traffic: Traffic,
        answer_s: float,
    ) -> None:
        self._channels = channels
        self._scheduler = scheduler
        self._connections = connections
        self._traffic = traffic
        self._answer_s = answer_s
        self._idle: dict[RpcServer, ScriptConnection] = {}
        self._busy: list[ScriptConnection] = []
        self._is_over = False

    def handle(self, url: str) -> object:
        """Return an object with the procedures of a server as its methods.

        Raises:
            InvalidValueError: an invalid URL.
        """
        server = server_of(url)
        return _handle(server.url, lambda method, args: self.call(server, method, args))

    def call(self, server: RpcServer, method: str, args: tuple[Any, ...]) -> Any:
        """Call a procedure and wait for its result.

        Raises:
            ScriptError: an argument that cannot be sent (`ArgumentTypeError`, `ArgumentRangeError`), a secondary
                program (code R120), or the call failed (`RpcError`).
            Stopped: the thread was stopped.
        """
        strand = self._scheduler.current
        if strand is None or strand.is_dying or self._is_over:
            raise Stopped
        if strand.is_secondary:
            raise ScriptStateError("a secondary program (sec) may not wait for remote procedures", code="R120")
        request = _request(server, method, args)
        try:
            answer = self._exchange(server, RpcCall(method, args, request))
            try:
                value = _result(answer)
            except PeerError as error:
                self._note(server, "received", str(error))
                raise
            self._note(server, "received", _brief(value))
            return value
        except client.Fault as fault:
            code, text = fault.faultCode, str(fault.faultString)
            self._note(server, "received", f"fault {code}: {text}")
            raise RpcError(
                said(
                    "{method}() on {url}: the server answered with fault {code}: {text}",
                    method=method,
                    url=server.url,
                    code=code,
                    text=text,
                ),
                fault=(code, text),
            ) from None
        except PeerError as error:
            raise RpcError(said("{method}() on {url}: {error}", method=method, url=server.url, error=error)) from None

    def _note(self, server: RpcServer, what: str, data: str) -> None:
        self._traffic.note_of_caller("rpc", server.url, what, cut(data))

    def close_all(self) -> None:
        """Close every connection: the program is over."""
        self._is_over = True
        for connection in (*self._idle.values(), *self._busy):
            self._close(connection)
        self._idle.clear()
        self._busy.clear()

    # ---------------------------------------------------------------- connections

    def _exchange(self, server: RpcServer, call: RpcCall) -> HttpAnswer:
        """Send a request and read its response; once more on a new connection if the kept one is closed."""
        kept = self._idle.pop(server, None)
        if kept is not None and kept.is_open and not kept.received:
            reader = HttpReader()
            try:
                return self._ask(server, kept, reader, call)
            except PeerError:
                if reader.has_begun or kept.is_open:
                    raise
        elif kept is not None:
            self._close(kept)
        return self._ask(server, self._open(server), HttpReader(), call)

    def _ask(self, server: RpcServer, connection: ScriptConnection, reader: HttpReader, call: RpcCall) -> HttpAnswer:
        self._busy.append(connection)
        is_kept = False
        try:
            connection.send(call.request)
            self._note(server, "sent", f"{call.method}({', '.join(map(_brief, call.args))})")
            reason = said("the answer of {method}() from {url}", method=call.method, url=server.url)
            answer = connection.read(reader, reason, self._answer_s)
            if answer is None:
                answer = reader.at_end()
            elif answer == "":
                raise PeerError(f"no answer within {self._answer_s:g} s")
            is_kept = answer.keeps_open and connection.is_open and not connection.received
            assert isinstance(answer, HttpAnswer)
            return answer
        finally:
            if connection in self._busy:
                self._busy.remove(connection)
            if is_kept and not self._is_over and server not in self._idle:
                self._idle[server] = connection
                if len(self._idle) > IDLE_MAX:
                    self._close(self._idle.pop(next(iter(self._idle))))
            else:
                self._close(connection)

    def _open(self, server: RpcServer) -> ScriptConnection:
        if len(self._busy) >= CALLS_MAX:
            raise PeerError(f"{CALLS_MAX} calls are under way already")
        log = ChannelLog(self._traffic, "rpc", server.url, f"{server.address}:{server.port}", has_bytes=False)
        channel = self._channels.open(server.address, server.port, seconds(CONNECT_TICKS))
        if not channel:
            log.failed(NO_NETWORK)
            raise PeerError(NO_NETWORK)
        connection = ScriptConnection(channel, self._channels, self._scheduler, log)
        self._connections[channel] = connection
        self._busy.append(connection)
        until = self._scheduler.now + CONNECT_TICKS
        try:
            while connection.is_opening:
                if not connection.wait(
                    said("{address}:{port} to accept a connection", address=server.address, port=server.port), until
                ):
                    connection.close(
                        said("no answer within {seconds:g} s", seconds=seconds(CONNECT_TICKS)), is_late=True
                    )
                    raise PeerError(f"no connection within {seconds(CONNECT_TICKS):g} s")
            if not connection.is_open:
                raise PeerError(connection.reason or "closed at once")
        except BaseException:
            self._close(connection)
            raise
        finally:
            if connection in self._busy:
                self._busy.remove(connection)
        return connection

    def _close(self, connection: ScriptConnection) -> None:
        connection.close()
        self._connections.pop(connection.channel, None)


def server_of(url: str) -> RpcServer:
    """Return the server for `<address>:<port>` or `http://<address>:<port>/<path>`; the default path is `/RPC2`.

    Raises:
        InvalidValueError: neither.
    """
    text = url.strip()
    try:
        parts = urlsplit(text if "://" in text else f"http://{text}")
        port = _HTTP_PORT if parts.port is None else parts.port
        problem = _problem(parts, port)
    except ValueError as error:
        raise _bad_url(url, str(error)) from None
    if problem:
        raise _bad_url(url, problem)
    assert parts.hostname is not None
    path = (parts.path or "/RPC2") + (f"?{parts.query}" if parts.query else "")
    host = f"[{parts.hostname}]" if ":" in parts.hostname else parts.hostname
    return RpcServer(f"http://{host}:{port}{path}", parts.hostname, port, path)


def _problem(parts: SplitResult, port: int) -> str:
    if parts.scheme.lower() != "http":
        return said("{scheme}:// is not supported", scheme=parts.scheme)
    if not parts.hostname:
        return "the address is missing"
    if "@" in parts.netloc:
        return "a user name is not supported"
    if not 1 <= port <= 65535:
        return "the port must be in [1, 65535]"
    if any(character <= " " or character > "~" for character in f"{parts.hostname}{parts.path}{parts.query}"):
        return "a URL has no blanks, control characters or letters beyond ASCII"
    return ""


def _bad_url(url: str, why: str) -> InvalidValueError:
    return InvalidValueError(
        said("url {url!r}: {why}", url=url, why=why),
        argument="url",
        value=url,
        limit="<address>:<port> or http://<address>:<port>/<path>",
    )


# ---------------------------------------------------------------- texts of requests and answers


def _request(server: RpcServer, method: str, args: tuple[Any, ...]) -> bytes:
    try:
        _check_arguments(args)
        text = without_addresses(client.dumps(args, method, allow_none=True))
        body = text.encode("utf-8", "xmlcharrefreplace")
    except OverflowError as error:
        raise ArgumentRangeError(
            said("{method}(): {error}: whole numbers have 32 bits", method=method, error=error),
            limit="[-2147483648, 2147483647]",
        ) from None
    except (TypeError, RecursionError) as error:
        raise ArgumentTypeError(
            said("{method}(): {problem}", method=method, problem=str(error) or "nested too deeply")
        ) from None
    host = server.url.partition("://")[2].partition("/")[0]
    head = (
        f"POST {server.path} HTTP/1.1\r\nHost: {host}\r\nUser-Agent: elitescript\r\n"
        f"Content-Type: text/xml\r\nContent-Length: {len(body)}\r\n\r\n"
    )
    return head.encode("ascii") + body


def _brief(value: Any) -> str:
    """Return a value as a short text."""
    from reprlib import Repr

    brief = Repr()
    brief.maxstring = brief.maxother = 100
    brief.maxlist = brief.maxtuple = brief.maxdict = 20
    return without_addresses(brief.repr(value))


def _check_arguments(values: Any) -> None:
    """Refuse functions, commands and classes, which the library would send as an empty structure."""
    for value in values.values() if isinstance(values, dict) else values:
        if callable(value):
            raise TypeError(f"cannot marshal {value!r}")
        if isinstance(value, list | tuple | dict):
            _check_arguments(value)


def _result(answer: HttpAnswer) -> Any:
    """Return the result of the procedure.

    Raises:
        PeerError: no result in the response.
        client.Fault: the procedure failed.
    """
    if answer.status != _OK:
        raise PeerError(f"the server answered {answer.status} {answer.reason}".rstrip())
    try:
        values, _ = values_and_method(answer.body)
        found = _plain(values)
    except ExpatError as error:
        raise PeerError(f"the answer is no XML: {error}") from None
    except client.Fault:
        raise
    except (client.ResponseError, ValueError, TypeError, LookupError, AttributeError, RecursionError) as error:
        raise PeerError(f"the answer is no XML-RPC: {str(error) or type(error).__name__}") from None
    return found[0] if len(found) == 1 else tuple(found)


def _plain(value: Any) -> Any:
    """Return a value without dates and decimals, which scripts do not have."""
    if isinstance(value, list | tuple):
        return [_plain(element) for element in value]
    if isinstance(value, dict):
        return {str(key): _plain(element) for key, element in value.items()}
    if value is None or isinstance(value, bool | int | float | str | bytes):
        return value
    return value.isoformat() if hasattr(value, "isoformat") else float(value)


# ---------------------------------------------------------------- handles of scripts


def _handle(url: str, call: Callable[[str, tuple[Any, ...]], Any]) -> object:
    """Return a handle: a script can name its procedures and call them, nothing else."""

    class Procedure(metaclass=Sealed):
        __slots__ = ("_name",)
        __module__ = "builtins"
        __reduce_ex__ = no_copy

        def __init__(self, name: str) -> None:
            set_name(self, name)

        def __getattr__(self, name: str) -> Procedure:
            return Procedure(f"{name_of(self)}.{_checked(name)}")

        def __call__(self, *args: Any) -> Any:
            return call(name_of(self), args)

        def __repr__(self) -> str:
            return f"<procedure {name_of(self)} of {url}>"

    slot = Procedure.__dict__["_name"]
    type.__delattr__(Procedure, "_name")
    name_of, set_name = slot.__get__, slot.__set__

    class RpcHandle(metaclass=Sealed):
        __slots__ = ()
        __module__ = "builtins"
        __reduce_ex__ = no_copy

        def __getattr__(self, name: str) -> Procedure:
            return Procedure(_checked(name))

        def __repr__(self) -> str:
            return f"<rpc handle of {url}>"

    return RpcHandle()


def _checked(name: str) -> str:
    """Return the name of a procedure; special names of Python are none."""
    if name.startswith("__"):
        raise AttributeError(name)
    return name
