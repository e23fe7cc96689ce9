"""`Adapter`: answers the requests of one debug session. One thread; messages in, messages out.

A request that lets the program go on is answered first and carried out then. What arrives meanwhile comes through
`interrupt`, which may be called by a signal handler: it answers what needs no look at the program, and has the run
stop between two statements for the rest, which the client does not notice.
"""

from __future__ import annotations

import os
import sys
from collections import deque
from collections.abc import Callable
from typing import Any, Final, Protocol

from elitescript.dap.breakpoints import Breakpoints
from elitescript.dap.capabilities import CAPABILITIES
from elitescript.dap.client import ClientSettings
from elitescript.dap.goals import Goal
from elitescript.dap.handler import LATER, Handler, State, WhileRunning
from elitescript.dap.launch import Launch
from elitescript.dap.messages import (
    FAULT,
    IS_RUNNING,
    OUT_OF_ORDER,
    REFUSED,
    UNKNOWN_REQUEST,
    Arguments,
    Body,
    Message,
    RequestError,
    error_response,
    event,
    response,
)
from elitescript.dap.sources import Sources
from elitescript.debugger.api import END, EXCEPTION, PAUSE, DebugError, Frame, Output, Stop
from elitescript.debugger.session import DebugSession
from elitescript.errors import ElitescriptError, did_you_mean
from elitescript.run import EXIT_CODES

STOPPED_EXIT: Final = EXIT_CODES["stopped"]

MAIN_THREAD: Final = 1
"""Number of the thread that every program begins with."""

ENDING: Final = ("terminate", "disconnect", "restart")
"""Requests that do not wait until a way back in history is done."""


class Requests(Protocol):
    """Where requests come from."""

    def next(self) -> Message:
        """Return the next request when it has arrived; raises EOFError when the client is gone."""

    def has_next(self) -> bool:
        """Return whether `next` returns at once."""


class Adapter:
    """One debug session, from `initialize` to its end.

    Args:
        send: sends a message to the client.
        requests: where those come from that arrive while the program runs.
        handlers: by the name of the request.

    Attributes:
        state: what the session is doing.
        client: what the client understands.
        launch: what it has launched; None before.
        sources: texts without a file.
        breakpoints: what it has set.
        references: what it can point to by a number until the program goes on: targets of `goto` and `stepIn`.
    """

    __slots__ = (
        "_deferred",
        "_goal",
        "_handlers",
        "_is_interrupted",
        "_is_pause_wanted",
        "_is_sending",
        "_opening",
        "_outgoing",
        "_requests",
        "_running",
        "_send",
        "_session",
        "_threads",
        "breakpoints",
        "client",
        "launch",
        "references",
        "sources",
        "state",
    )

    def __init__(
        self,
        send: Callable[[Message], None],
        requests: Requests,
        handlers: dict[str, Handler],
    ) -> None:
        self._send = send
        self._requests = requests
        self._handlers = handlers
        self._session: DebugSession | None = None
        self._goal: Goal | None = None
        """What the program is to do next."""
        self._running: Goal | None = None
        """What it is doing."""
        self._opening: Message | None = None
        """The `launch` that is not answered yet."""
        self._deferred: deque[Message] = deque()
        """Requests that came while the program ran."""
        self._is_interrupted = False
        self._is_pause_wanted = False
        self._outgoing: deque[Message] = deque()
        self._is_sending = False
        self._threads: dict[int, str] = {}
        """Threads that the client knows, by number."""
        self.state = State.NEW
        self.client = ClientSettings()
        self.launch: Launch | None = None
        self.sources = Sources()
        self.breakpoints = Breakpoints()
        self.references: dict[int, Any] = {}

    # ---------------------------------------------------------------- requests

    def handle(self, request: Message) -> None:
        """Answer a request, and let the program go on if it says so; returns when the program stands."""
        self._respond(request)
        while self._goal is not None:
            self._go(self._goal)

    def interrupt(self) -> None:
        """Look for requests that have come while the program runs; called between any two instructions of Python.

        Raises:
            EOFError: the client is gone.
        """
        while self.state is State.RUNNING and not self._is_interrupted and self._requests.has_next():
            # What comes now calls this function again, in the middle of this one: it is seen in the next pass.
            self._is_interrupted = True
            try:
                self._take_in(self._requests.next())
            finally:
                self._is_interrupted = False

    def _take_in(self, request: Message) -> None:
        """Take a request that has come while the program runs."""
        handler = self._handlers.get(request["command"])
        if handler is None or handler.while_running is not WhileRunning.INTERRUPT:
            self._respond(request)
            return
        self._deferred.append(request)
        assert self._running is not None
        if self._running.is_interruptible or request["command"] in ENDING:
            self.session.pause()

    def _respond(self, request: Message) -> None:
        seq, command = request["seq"], request["command"]
        try:
            body = self._answer(command, request.get("arguments"))
        except RequestError as error:
            self.send(error_response(seq, command, error))
        except (DebugError, ElitescriptError) as error:
            self.send(error_response(seq, command, RequestError(REFUSED, str(error))))
        except Exception as error:
            # A mistake in here must not end the session, nor go unseen.
            sys.excepthook(type(error), error, error.__traceback__)
            text = f"{command}: a mistake in elitescript: {type(error).__name__}: {error}"
            self.send(error_response(seq, command, RequestError(FAULT, text)))
        else:
            if body is LATER:
                self._opening = request
            else:
                self.send(response(seq, command, body))

    def _answer(self, command: str, arguments: Any) -> Body | None:
        handler = self._handlers.get(command)
        if handler is None:
            near = did_you_mean(command, self._handlers)
            raise RequestError(UNKNOWN_REQUEST, f"there is no request {command!r}{near}")
        if self.state not in handler.states:
            raise RequestError(OUT_OF_ORDER, f"{command} is not possible {self.state.value}")
        if self.state is State.RUNNING and handler.while_running is WhileRunning.REFUSE:
            raise RequestError(IS_RUNNING, f"{command}: the program runs; pause it first")
        return handler.answer(self, Arguments(arguments, command))

    # ---------------------------------------------------------------- the session

    @property
    def session(self) -> DebugSession:
        """The debugged run."""
        if self._session is None:
            raise RequestError(OUT_OF_ORDER, "nothing has been launched")
        return self._session

    def open(self, launch: Launch, *, is_restart: bool = False) -> None:
        """Begin to debug what a client launches; the run begins with `begin`.

        Raises:
            ProgramError: the program does not compile; nothing has changed then.
            ElitescriptError: something else is wrong; likewise.
        """
        session = launch.session(self._report_output)
        if self._session is not None:
            self._session.close()
        self._session, self.launch = session, launch
        session.set_exception_filters(self.breakpoints.filters)
        if is_restart:
            for body in self.breakpoints.renew(session, self.client):
                self.event("breakpoint", {"reason": "changed", "breakpoint": body})
        self._show_findings(launch)
        if not is_restart:
            self.state = State.CONFIGURING
            self.event("initialized")

    def begin(self) -> None:
        """Begin the run, after the response to what was asked."""
        assert self.launch is not None
        if self._opening is not None:
            opening, self._opening = self._opening, None
            self.send(response(opening["seq"], opening["command"]))
        process = {"name": self.launch.program, "systemProcessId": os.getpid(), "isLocalProcess": True}
        self.event("process", {**process, "startMethod": "launch"})
        # A client can pause what it knows; the others are reported with the first stop.
        self._report_threads({MAIN_THREAD: "main"})
        self.go(Goal.start(stop_on_entry=self.launch.stop_on_entry, no_debug=self.launch.no_debug))

    @property
    def program(self) -> str:
        """Path of the program that is debugged."""
        if self.launch is None:
            raise RequestError(OUT_OF_ORDER, "nothing has been launched")
        return self.launch.program

    def programs(self) -> list[str]:
        """Return the names of the texts that are debugged."""
        return [self.program]

    def text_of(self, name: str) -> str:
        """Return a text by its name."""
        assert self.launch is not None
        return self.launch.text

    def frame(self, number: int) -> Frame:
        """Return a call by its number.

        Raises:
            RequestError: it is none of the stopped program.
        """
        for thread in self._threads:
            for frame in self.session.stack(thread):
                if frame.id == number:
                    return frame
        raise RequestError(REFUSED, f"there is no frame {number} any more")

    def refer_to(self, target: object) -> int:
        """Return a number for something that a later request names, until the program goes on."""
        self.references[len(self.references) + 1] = target
        return len(self.references)

    def go(self, goal: Goal) -> None:
        """Let the program go on once the present request is answered."""
        self._goal = goal

    def pause(self) -> None:
        """Have the run that goes on stop, and report that."""
        self._is_pause_wanted = True
        self.session.pause()

    def close(self, exit_code: int | None) -> None:
        """End the session.

        Args:
            exit_code: reported to the client with the end, unless that was reported before; None for no report.
        """
        self._goal = None
        if self._session is not None:
            self._session.close()
        if exit_code is not None and self.state is not State.ENDED:
            self.event("exited", {"exitCode": exit_code})
            self.event("terminated")
        self.state = State.ENDED

    # ---------------------------------------------------------------- the run

    def _go(self, goal: Goal) -> None:
        """Let the program go on to a stop, and report it."""
        self._goal, self._running = None, goal
        self.references.clear()
        self.state = State.RUNNING
        # Their signals came before there was a run to interrupt.
        self.interrupt()
        try:
            stop = goal.run(self.session)
        except (DebugError, ElitescriptError) as error:
            self.event("output", {"category": "important", "output": f"{error}\n"})
            stop = self.session.stop
        self.state = State.STOPPED
        if stop.reason == PAUSE and not self._is_pause_wanted:
            # It stopped for the requests alone.
            self._answer_deferred()
            if self._goal is None and self.state is State.STOPPED:
                self._goal = goal.rest()
            return
        self._is_pause_wanted = False
        self._report_stop(stop)
        self._answer_deferred()

    def _answer_deferred(self) -> None:
        while self._deferred and self._goal is None:
            self._respond(self._deferred.popleft())

    def _report_stop(self, stop: Stop) -> None:
        assert self.launch is not None
        if stop.reason == END and not self.launch.stops_on_end:
            self.event("output", {"category": "console", "output": f"{stop.text}\n"})
            self._report_threads({})
            self.close(EXIT_CODES.get(stop.result, 1))
            return
        threads = {thread.id: thread.name for thread in self.session.threads()}
        self._report_threads(threads)
        body: Body = {"reason": stop.reason, "description": stop.text, "allThreadsStopped": True}
        if thread := stop.thread or next(iter(threads), 0):
            body["threadId"] = thread
        if stop.reason == EXCEPTION and stop.exception is not None:
            body["text"] = stop.exception.text
        if hits := self.breakpoints.numbers(stop.hits):
            body["hitBreakpointIds"] = hits
        self.event("stopped", body)

    def _report_threads(self, threads: dict[int, str]) -> None:
        for number in self._threads.keys() - threads.keys():
            self.event("thread", {"reason": "exited", "threadId": number})
        for number in threads.keys() - self._threads.keys():
            self.event("thread", {"reason": "started", "threadId": number})
        self._threads = threads

    def known_threads(self) -> dict[int, str]:
        """Return the threads of the last stop; can be asked while the program runs."""
        return self._threads

    # ---------------------------------------------------------------- messages

    def event(self, name: str, body: Body | None = None) -> None:
        """Send an event."""
        self.send(event(name, body))

    def changed(self, *areas: str) -> None:
        """Say that what the client shows is no longer so, if it understands that."""
        if self.client.has_invalidated:
            self.event("invalidated", {"areas": list(areas)})

    def send(self, message: Message) -> None:
        """Send a message behind those that are being sent: `interrupt` may come in the middle of one."""
        self._outgoing.append(message)
        if self._is_sending:
            return
        self._is_sending = True
        try:
            while self._outgoing:
                self._send(self._outgoing.popleft())
        finally:
            self._is_sending = False

    def capabilities(self) -> Body:
        """Return what this adapter can do."""
        return dict(CAPABILITIES)

    def _report_output(self, output: Output) -> None:
        assert self.launch is not None
        body: Body = {"category": output.category, "output": f"{output.text}\n"}
        if output.line:
            body["source"] = self.sources.shown(self.launch.program)
            body.update(self.client.place(output.line, 0))
        self.event("output", body)

    def _show_findings(self, launch: Launch) -> None:
        for problem in launch.problems:
            self.event("output", self.finding(launch.program, problem))

    def finding(self, program: str, problem: Any) -> Body:
        """Return a finding of `check` as an `output` event that the editor can jump to."""
        hint = f"\n    hint: {problem.hint}" if problem.hint else ""
        return {
            "category": "stderr" if problem.is_error else "console",
            "output": f"{problem}{hint}\n",
            "source": self.sources.shown(program),
            **self.client.place(problem.line, problem.column),
        }
