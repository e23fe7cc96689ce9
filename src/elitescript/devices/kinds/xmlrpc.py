"""XML-RPC servers beside the robot."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

from elitescript.devices.channels.faults import XML_RPC
from elitescript.devices.channels.network import DeviceLink
from elitescript.devices.device import check_number
from elitescript.devices.kinds.tcp import LATENCY_MAX_S, TcpConnection, TcpServer
from elitescript.records import NamedTuple
from elitescript.said import said

if TYPE_CHECKING:
    from collections.abc import Iterable

HEAD_MAX: Final = 32 * 1024
BODY_MAX: Final = 4 * 1024 * 1024

WRONG_CALL: Final = 1
"""Code of the fault for a procedure that is not there, or is called with other arguments."""


class RpcFault(Exception):
    """Raised by a procedure to answer with a fault.

    Args:
        code: any number.
        text: of the program's alarm.
    """

    def __init__(self, code: int, text: str) -> None:
        super().__init__(text)
        self.code = code
        self.text = text


class Delayed(NamedTuple):
    """A result that is ready later; see `XmlRpcServer.delayed`."""

    delay_s: float
    result: Any


class XmlRpcServer(TcpServer):
    """A device whose methods programs call with `rpc_factory`.

    Every public method of a subclass is a procedure. It returns what XML-RPC can carry: numbers, texts, bools, lists,
    dictionaries with texts as keys. `RpcFault` answers with a fault; a procedure that is not there, or is called with
    other arguments, is answered with a fault as well.

    Attributes:
        duration_s: time that every call takes.
        functions: procedures by name besides the methods, such as `{"camera.trigger": function}`.

    Example:
        >>> from elitescript import VirtualRobot
        >>> from elitescript.testing.world import RpcFault, World, XmlRpcServer
        >>> class Planner(XmlRpcServer):
        ...     port = 8000
        ...     def next_pose(self, n):
        ...         if n > 2:
        ...             raise RpcFault(7, "no part is left")
        ...         return [0.4 + 0.1 * n, -0.2, 0.1]
        >>> robot = VirtualRobot("CS66", world=World(devices=[Planner()]))
        >>> run = robot.run('''
        ... def main():
        ...   planner = rpc_factory("xmlrpc", "http://10.0.0.2:8000/RPC2")
        ...   textmsg(planner.next_pose(1))
        ... end
        ... ''')
        >>> run.log
        ['[0.5, -0.2, 0.1]']
    """

    protocol = XML_RPC
    duration_s: float = 0.0
    functions: Mapping[str, Callable[..., Any]] = {}

    def check(self) -> None:
        super().check()
        check_number("duration_s", self.duration_s, 0.0, LATENCY_MAX_S, "s")

    def procedure(self, name: str) -> Callable[..., Any] | None:
        """Return what programs call by a name; None if there is nothing."""
        if name in self.functions:
            return self.functions[name]
        if name.startswith("_") or hasattr(XmlRpcServer, name):
            return None
        found = getattr(self, name, None)
        return found if callable(found) else None

    def delayed(self, delay_s: float, result: Any) -> Delayed:
        """Return this to have a call answered so much later."""
        return Delayed(delay_s, result)

    # ---------------------------------------------------------------- the world's side

    def connect(self, link: DeviceLink, number: int) -> TcpConnection:
        return _HttpConnection(self, link, number)

    def call(self, name: str, arguments: Iterable[Any]) -> Any:
        """Call a procedure.

        Raises:
            RpcFault: it answers with one.
        """
        procedure = self.procedure(name)
        if procedure is None:
            self.warn(said("was asked for {name}, which it does not have", name=name))
            raise RpcFault(WRONG_CALL, said("method {name!r} is not supported", name=name))
        given = tuple(arguments)
        try:
            signature = inspect.signature(procedure)
        except ValueError:
            return procedure(*given)  # a function of the interpreter, which has no signature
        try:
            signature.bind(*given)
        except TypeError as error:
            self.warn(
                said("{name} was called with {count} arguments: {error}", name=name, count=len(given), error=error)
            )
            raise RpcFault(WRONG_CALL, f"{name}: {error}") from None
        return procedure(*given)


class _HttpConnection(TcpConnection):
    """Requests of HTTP on one connection, one after the other."""

    def __init__(self, server: XmlRpcServer, link: DeviceLink, number: int) -> None:
        super().__init__(server, link, number)
        self._rpc = server
        self._buffer = b""
        self._is_busy = False

    def received(self, data: bytes) -> None:
        self._buffer += data
        if not self._is_busy:
            self._look()

    def _look(self) -> None:
        """Answer the request that has arrived, if one is complete."""
        head, end, rest = self._buffer.partition(b"\r\n\r\n")
        if not end:
            if len(self._buffer) > HEAD_MAX:
                self._refuse(431, "Request Header Fields Too Large")
            return
        first, *lines = head.decode("latin-1").split("\r\n")
        fields = {name.strip().lower(): value.strip() for name, _, value in (line.partition(":") for line in lines)}
        length = fields.get("content-length", "0")
        if not length.isdecimal() or len(length) > len(str(BODY_MAX)) or int(length) > BODY_MAX:
            self._refuse(413, "Content Too Large")
            return
        if len(rest) < int(length):
            return
        body, self._buffer = rest[: int(length)], rest[int(length) :]
        if not first.startswith("POST "):
            self._refuse(405, "Method Not Allowed")
            return
        is_last = fields.get("connection", "").lower() == "close" or first.endswith("HTTP/1.0")
        self._answer(body, is_last)

    def _answer(self, body: bytes, is_last: bool) -> None:
        from xmlrpc.client import Fault, dumps

        from elitescript.runtime.connections.rpc_texts import values_and_method

        delay_s = self._rpc.duration_s
        result: Any
        try:
            arguments, name = values_and_method(body)
        except Exception:
            # Bytes from outside may be anything.
            self._refuse(400, "Bad Request")
            return
        try:
            result = self._rpc.call(str(name), arguments)
            if isinstance(result, Delayed):
                delay_s, result = delay_s + result.delay_s, result.result
            try:
                text = dumps((result,), methodresponse=True, allow_none=True)
            except (TypeError, OverflowError) as error:
                raise TypeError(f"{name} returned {result!r}, which XML-RPC cannot carry: {error}") from None
        except RpcFault as fault:
            text = dumps(Fault(fault.code, str(fault.text)), methodresponse=True)
        if delay_s > 0.0:
            self._is_busy = True
            self.after(delay_s, self._respond, 200, "OK", text.encode(), is_last)
        else:
            self._respond(200, "OK", text.encode(), is_last)

    def _refuse(self, status: int, reason: str) -> None:
        self._rpc.warn(
            said("got a request that it cannot read, and answers {status} {reason}", status=status, reason=reason)
        )
        self._buffer = b""
        self._respond(status, reason, b"", True)

    def _respond(self, status: int, reason: str, body: bytes, is_last: bool) -> None:
        self._is_busy = False
        head = f"HTTP/1.1 {status} {reason}\r\nContent-Type: text/xml\r\nContent-Length: {len(body)}\r\n"
        self.send((head + ("Connection: close\r\n" if is_last else "") + "\r\n").encode("latin-1") + body)
        if is_last:
            self.close()
        elif self._buffer:
            self._look()
