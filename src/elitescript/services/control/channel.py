"""The local channel of `elitescript ctl`: JSON lines between two processes of one user on one computer.

Each served robot listens at an address that follows from its instance. On POSIX that is a socket in a folder which
only the user can enter; elsewhere a TCP port of this computer, whose number and secret lie in a file there.

A request is `{"verb": …, "arguments": […], "values": {…}}` (on TCP also `"token"`), its answer
`{"ok": true, "text": …, "result": {…}}` or `{"ok": false, "error": …}`. Requests of one connection are answered in
their order; an order is answered when the robot has done or refused it, `play` with `"wait": true` when the task has
ended. A connection that debugs also gets lines `{"event": …}`; see `control.debugging`. A web browser is not answered.
"""

from __future__ import annotations

import asyncio
import hmac
import json
import os
import secrets
import stat
import tempfile
import traceback
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from elitescript.errors import UsageError
from elitescript.findings.found import Tally
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Alarm, TaskStateChanged
from elitescript.messages.outcomes import Outcome
from elitescript.messages.outputs import Output
from elitescript.messages.timing import seconds
from elitescript.outputs.writing import write_file
from elitescript.protocol.browsers import is_web_request
from elitescript.services.clients.turns import Turns
from elitescript.services.control.debug_events import DebugEvents, debug_result
from elitescript.services.control.verbs import VERBS, Verb, VerbRequest, outcome_text
from elitescript.services.robot_server import RobotServer
from elitescript.untrusted.files import ADDRESS, read_bytes
from elitescript.untrusted.json_text import JsonError, json_object, json_value

LINE_MAX: Final = 64 * 1024
ANSWER_TIMEOUT_S: Final = 6.0
"""For a tick; in lockstep time may stand still."""
CLIENTS_MAX: Final = 64
"""Connections at once."""
REPLY_TICKS: Final = 1000
"""Within which the robot answers an order."""
DEBUG: Final = "debug"
"""The verb of debuggers, to which lines with events come between answers."""
PLAY: Final = "play"
"""The verb that can wait for what it has started."""
_PLACES: Final = ("XDG_RUNTIME_DIR", "LOCALAPPDATA")
"""Variables that name a folder for what a user's processes keep while they run; else it is a temporary one."""
_TEMPORARY: Final = "TMPDIR"
_HAS_UNIX: Final = hasattr(asyncio, "start_unix_server")
_ENDING: Final = "sock" if _HAS_UNIX else "json"


def runtime_folder() -> Path:
    """Return the folder of the addresses of this user's robots.

    Raises:
        UsageError: it cannot be made, belongs to another user, or others may write to it.
    """
    name = _variable()
    if name != _TEMPORARY:
        folder = Path(os.environ[name]) / "elitescript"
    else:
        user = os.getuid() if hasattr(os, "getuid") else os.environ.get("USERNAME", "")
        folder = Path(tempfile.gettempdir()) / f"elitescript-{user}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
    except OSError as error:
        is_there = isinstance(error, FileExistsError)
        raise _unusable(folder, "it is a file, not a folder" if is_there else error.strerror or str(error)) from error
    if hasattr(os, "getuid"):
        found = folder.lstat()
        if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid() or found.st_mode & 0o077:
            raise _unusable(folder, "it must be a folder that only you can use (mode 700); remove it")
    return folder


def _variable() -> str:
    """Return the variable that says where the folder is; one that names no folder says nothing."""
    names = (name for name in _PLACES if os.path.isabs(place := os.environ.get(name, "")) and os.path.isdir(place))  # noqa: PTH112, PTH117
    return next(names, _TEMPORARY)


def _unusable(path: Path, why: str) -> UsageError:
    return UsageError(
        f"{path}: {why}; addresses of served robots are there, and the variable {_variable()} says where that is"
    )


def address_of(instance: int) -> Path:
    """Return where the robot of an instance listens."""
    return runtime_folder() / f"serve-{instance}.{_ENDING}"


def addresses() -> list[Path]:
    """Return where robots listen, or did, on this computer."""
    return sorted(runtime_folder().glob(f"serve-*.{_ENDING}"))


class ControlChannel:
    """Answers requests about one served robot.

    Args:
        server: the robot.
        instance: which one this is on this computer.
    """

    __slots__ = ("_count", "_expected", "_listener", "_path", "_server", "_token", "_writers")

    def __init__(self, server: RobotServer, instance: int) -> None:
        self._server = server
        self._path = address_of(instance)
        self._listener: asyncio.Server | None = None
        self._token = ""
        self._count = 0
        self._expected: set[asyncio.Future[Any]] = set()
        self._writers: set[asyncio.StreamWriter] = set()

    @property
    def address(self) -> str:
        """Path of the socket, or of the file with port and secret."""
        return str(self._path)

    @property
    def port(self) -> int:
        """Number of the TCP port; 0 if it is a socket in a folder."""
        return 0 if _HAS_UNIX or self._listener is None else int(self._listener.sockets[0].getsockname()[1])

    async def open(self) -> None:
        """Listen. If another living robot has the address, take one of our own beside it.

        Raises:
            UsageError: the address cannot be made.
        """
        if await _is_alive(self._path):
            self._path = self._path.with_stem(f"{self._path.stem}-{os.getpid()}")
        try:
            self._path.unlink(missing_ok=True)
            await self._listen()
        except OSError as error:
            # That the path is too long for a socket has no number.
            raise _unusable(self._path, error.strerror or str(error)) from error

    async def _listen(self) -> None:
        if _HAS_UNIX:
            # No other user may connect, not even in the moment before the mode is set.
            mask = os.umask(0o177)
            try:
                self._listener = await asyncio.start_unix_server(self._serve, str(self._path), limit=LINE_MAX)
            finally:
                os.umask(mask)
            return
        self._listener = await asyncio.start_server(self._serve, "127.0.0.1", 0, limit=LINE_MAX)
        self._token = secrets.token_hex(16)
        port = self._listener.sockets[0].getsockname()[1]
        write_file(self._path, json.dumps({"port": port, "token": self._token}), mode=0o600)

    async def close(self) -> None:
        """Listen no more."""
        if self._listener is not None:
            self._listener.close()
            for expected in self._expected:
                expected.cancel()
            for writer in self._writers:
                writer.transport.abort()
            self._path.unlink(missing_ok=True)
            await asyncio.sleep(0)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._count += 1
        origin = f"ctl#{self._count}"
        if len(self._writers) >= CLIENTS_MAX:
            writer.write(_line(_refusal(f"{CLIENTS_MAX} connections to ctl are open")))
            writer.close()
            return
        self._writers.add(writer)
        events = DebugEvents(self._server, origin, writer)
        turns = Turns(self._server.shares, self._server.make_due)
        try:
            await turns.measured(self._answer_all(origin, reader, writer, events, turns))
        except (ConnectionError, asyncio.CancelledError):
            # The client has gone: there is no answer to give.
            pass
        finally:
            events.close()
            self._writers.discard(writer)
            writer.close()

    async def _answer_all(
        self, origin: str, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, events: DebugEvents, turns: Turns
    ) -> None:
        """Answer the requests of a connection, one after the other, as its share of the time allows."""
        number = 0
        while True:
            await turns.next()
            try:
                line = await reader.readline()
            except ValueError:
                writer.write(_line(_refusal(f"a request has {LINE_MAX} bytes at most")))
                return
            number += 1
            if not line or (number == 1 and is_web_request(line)):
                return
            writer.write(_line(await self._answer(f"{origin}/{number}", line, events)))
            await writer.drain()

    async def _answer(self, origin: str, line: bytes, events: DebugEvents) -> dict[str, Any]:
        try:
            asked = json_object(line)
            if self._token and not hmac.compare_digest(str(asked.get("token", "")), self._token):
                raise UsageError("the token is wrong")
            verb = VERBS.get(str(asked.get("verb")))
            if verb is None:
                raise UsageError(f"there is no verb {asked.get('verb')!r}; there are {', '.join(VERBS)}")
            arguments, values = asked.get("arguments", []), asked.get("values", {})
            if not isinstance(arguments, list) or not isinstance(values, dict):
                raise UsageError("arguments are a list, values an object")
            if any(isinstance(argument, list | dict) for argument in arguments):
                raise UsageError("arguments are texts and numbers")
            server = self._server
            snapshot, description = server.output.snapshot, server.link.description
            request = VerbRequest(origin, tuple(map(str, arguments)), values, snapshot, description, server.devices)
            if verb.name == DEBUG:
                events.open()
            if asked.get("wait") is True and verb.name == PLAY:
                return await self._play_to_the_end(verb, request)
            return await self._carry_out(verb, request)
        except (UsageError, JsonError) as error:
            return _refusal(str(error))
        except Exception:
            # A defect of this program ends no connection.
            text = f"{origin}: internal error, please report it:\n{traceback.format_exc()}"
            self._server.note("bug", text, is_problem=True, origin=origin)
            return _refusal("internal error; the log of serve has it")

    async def _play_to_the_end(self, verb: Verb, request: VerbRequest) -> dict[str, Any]:
        ending = Ending()
        self._server.follow(ending.take)
        self._expected.add(ending.finished)
        try:
            answer = await self._carry_out(verb, request)
            if not answer["ok"]:
                return answer
            return await ending.finished
        finally:
            ending.finished.cancel()
            self._expected.discard(ending.finished)

    async def _carry_out(self, verb: Verb, request: VerbRequest) -> dict[str, Any]:
        server = self._server
        if verb.name == "ports":
            return {"ok": True, "result": _clients(server)}
        if verb.order is None:
            assert verb.read is not None
            output = server.output
            if verb.parts and not output.has(verb.parts) and not server.waits_for:
                # Nothing has read where the arm is; the next tick shows it.
                output = await server.next_output()
            result = verb.read(request, output)
            if verb.name == "state":
                result |= {
                    "overruns": server.overruns,
                    "left_out": server.left_out,
                    "waits_for": server.waits_for,
                }
            return {"ok": True, "result": result}
        order, awaited = verb.order(request).answered(request.origin)
        if not order.inputs:
            return {"ok": True, "text": order.text}
        answers = OutputCollector(awaited)
        server.post(list(order.inputs))
        server.follow(answers.take)
        self._expected.add(answers.finished)
        try:
            await asyncio.wait_for(answers.finished, ANSWER_TIMEOUT_S)
            return {"ok": True, "text": outcome_text(order, answers.outcomes), **debug_result(answers.outcomes)}
        except TimeoutError:
            text = f"{order.text}: asked for, and not answered yet{_why_late(server)}; the robot may do it later"
            return {"ok": False, "error": text}
        finally:
            self._expected.discard(answers.finished)


class OutputCollector:
    """Collects the replies to several requests; outputs may come in a row, before the event loop goes on.

    Args:
        origins: of the requests; without any, the next output is all that counts.

    Attributes:
        finished: done when all of them are answered.
    """

    __slots__ = ("_origins", "_outcomes", "_ticks_left", "finished")

    def __init__(self, origins: tuple[str, ...]) -> None:
        self._origins = origins
        self._outcomes: dict[str, Outcome] = {}
        self._ticks_left = REPLY_TICKS
        self.finished: asyncio.Future[None] = asyncio.get_running_loop().create_future()

    @property
    def outcomes(self) -> list[Outcome]:
        """What became of the requests, in the order of the origins."""
        return [self._outcomes[origin] for origin in self._origins]

    def take(self, output: Output) -> bool:
        """Take an output; return whether the next one is wanted too."""
        if self.finished.done():
            return False
        self._outcomes |= {reply.origin: reply.outcome for reply in output.replies if reply.origin in self._origins}
        self._ticks_left -= 1
        if len(self._outcomes) == len(self._origins):
            self.finished.set_result(None)
        elif not self._ticks_left:
            self.finished.set_exception(TimeoutError())
        return not self.finished.done()


class Ending:
    """Waits for the end of the task that runs next, or goes on next.

    Attributes:
        finished: done at that end, with the answer to `play`.
    """

    __slots__ = ("_alarm", "_has_begun", "_tally", "finished")

    def __init__(self) -> None:
        self._tally = Tally()
        self._has_begun = False
        self._alarm = ""
        self.finished: asyncio.Future[dict[str, Any]] = asyncio.get_running_loop().create_future()

    def take(self, output: Output) -> bool:
        """Take an output; return whether the next one is wanted too."""
        for event in output.events:
            if self.finished.done():
                break
            self._tally.take(event)
            if isinstance(event, Alarm):
                self._alarm = f"{event.code} in line {event.line}: {event.class_name}: {event.text}"
            elif isinstance(event, TaskStateChanged):
                self._task_changed(event)
        return not self.finished.done()

    def _task_changed(self, event: TaskStateChanged) -> None:
        if event.state is not TaskState.STOPPED:
            self._has_begun = True
        elif self._has_begun:
            found = self._tally.findings
            words = f", {found.words}" if found else ""
            text = f"task {event.name} ended at {seconds(event.tick):.3f} s: {event.ending}{words}"
            counts = {"findings": found.counts()}
            if event.ending == "alarm":
                self.finished.set_result(
                    {"ok": False, "error": f"{text} {self._alarm}".strip(), "ending": "alarm", **counts}
                )
            else:
                self.finished.set_result({"ok": True, "text": text, "ending": event.ending, **counts})


def _why_late(server: RobotServer) -> str:
    """Return what keeps a robot from answering; empty if that is not known."""
    if server.waits_for:
        return f": time waits for {server.waits_for}"
    line = server.link.busy_line
    return f": the program keeps it in line {line}" if line else ""


def _refusal(why: str) -> dict[str, Any]:
    return {"ok": False, "error": why}


def _line(answer: dict[str, Any]) -> bytes:
    return json.dumps(answer).encode() + b"\n"


def _clients(server: RobotServer) -> dict[str, Any]:
    return {
        name: {
            "host": listener.host,
            "port": listener.number,
            "clients": [
                {"origin": client.origin, "peer": client.peer, "missed_packages": client.dropped}
                for client in listener.clients.values()
            ],
        }
        for name, listener in server.listeners.items()
    } | {"script_sockets": {"clients": server.broker.count}}


def ask(path: Path, verb: str, arguments: list[str], values: dict[str, Any], *, waits: bool = False) -> dict[str, Any]:
    """Ask a served robot; for processes that have no event loop.

    Args:
        path: its address.
        verb: a row of `VERBS`.
        arguments: of the verb.
        values: of `set`, by name.
        waits: for the end of the task that `play` starts.

    Raises:
        UsageError: no controller is served there.
    """

    return asyncio.run(exchange(path, verb, arguments, values, waits=waits))


async def exchange(
    path: Path,
    verb: str,
    arguments: Sequence[str] = (),
    values: Mapping[str, Any] | None = None,
    *,
    waits: bool = False,
) -> dict[str, Any]:
    """Ask a served robot, see `ask`; for processes that have an event loop."""
    reader, writer, token = await _connect(path)
    try:
        record = {"verb": verb, "arguments": list(arguments), "values": dict(values or {}), "wait": waits}
        writer.write(json.dumps({**record, "token": token} if token else record).encode() + b"\n")
        while line := await reader.readline():
            answer: dict[str, Any] = json_value(line)
            # What the program prints meanwhile comes in between.
            if "event" not in answer:
                return answer
            # Lines that have arrived come without a pause, also those of a flood.
            await asyncio.sleep(0)
    finally:
        writer.close()
    raise UsageError("the controller has gone before it answered")


async def _connect(path: Path) -> tuple[asyncio.StreamReader, asyncio.StreamWriter, str]:
    try:
        if _HAS_UNIX:
            return (*await asyncio.open_unix_connection(str(path), limit=LINE_MAX * 16), "")
        address = json_value(read_bytes(path, ADDRESS))
        return (*await asyncio.open_connection("127.0.0.1", address["port"], limit=LINE_MAX * 16), address["token"])
    except (OSError, ValueError, KeyError):
        raise UsageError(f"no controller is served here ({path}); start one with `elitescript serve`") from None


async def _is_alive(path: Path) -> bool:
    if not path.exists():
        return False
    try:
        _, writer, _ = await _connect(path)
    except UsageError:
        return False
    writer.close()
    return True
