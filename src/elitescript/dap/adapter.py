"""`Adapter`: answers the requests of one debug session. One thread; messages in, messages out.

A request that lets the program go on is answered first and carried out then. What arrives meanwhile comes through
`interrupt`, which may be called by a signal handler: it answers what needs no look at the program, and has the run
stop between two statements for the rest, which the client does not notice.
"""

from __future__ import annotations

import os
import re
import sys
from collections import Counter, deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final, Protocol

from elitescript.dap.breakpoints import Breakpoints
from elitescript.dap.client import ClientSettings
from elitescript.dap.debuggee import Debuggee, Session
from elitescript.dap.goals import Goal
from elitescript.dap.messages import (
    ENDED,
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
from elitescript.dap.states import State, WhileRunning
from elitescript.debugger.api import END, PAUSE, BreakpointState, Frame, Output, Stop, ThreadInfo
from elitescript.debugger.session import DebugSession
from elitescript.debugger.wire import read
from elitescript.errors import DebugError, ElitescriptError, did_you_mean
from elitescript.records import NamedTuple
from elitescript.run import EXIT_CODES
from elitescript.shown import shown

if TYPE_CHECKING:
    from elitescript.services.control.debugging import ServedSession

_NUMBERS: Final = re.compile(r"\d+")
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

    def post(self, call: Callable[[], None]) -> None:
        """Have something called in the thread of `next`, while it waits. May be called from any thread."""


LATER: Final[Body] = {}
"""Result of a handler whose response is sent later."""


class Handler(NamedTuple):
    """One request.

    Attributes:
        answer: checks the arguments, carries it out, returns the body of the response; `LATER` if that comes later.
        states: in which it may come.
        while_running: what is done with it then, if `states` has that.
    """

    answer: Callable[[Adapter, Arguments], Body | None]
    states: frozenset[State]
    while_running: WhileRunning = WhileRunning.REFUSE


class Adapter:
    """One debug session, from `initialize` to its end.

    Args:
        send: sends a message to the client.
        requests: where those come from that arrive while the program runs.
        handlers: by the name of the request.
        forks: whether this process may be copied.

    Attributes:
        state: what the session is doing.
        client: what the client understands.
        sources: texts without a file.
        breakpoints: what it has set.
        forks: see above.
        frames: the calls that it was shown since the program stopped, by their numbers.
        references: what it can point to by a number until the program goes on: targets of `goto` and `stepIn`.
    """

    __slots__ = (
        "_debuggee",
        "_deferred",
        "_early",
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
        "_stopped_thread",
        "_threads",
        "_told",
        "breakpoints",
        "client",
        "forks",
        "frames",
        "references",
        "sources",
        "state",
    )

    def __init__(
        self,
        send: Callable[[Message], None],
        requests: Requests,
        handlers: dict[str, Handler],
        *,
        forks: bool = False,
    ) -> None:
        self.forks = forks
        self._send = send
        self._requests = requests
        self._handlers = handlers
        self._goal: Goal | None = None
        """What the program is to do next."""
        self._running: Goal | None = None
        """What it is doing, while it is run here."""
        self._opening: Message | None = None
        """The `launch` that is not answered yet."""
        self._deferred: deque[Message] = deque()
        """Requests that came while the program ran."""
        self._early: list[tuple[str, dict[str, Any]]] = []
        """What a living robot has said before `configurationDone`."""
        self._is_interrupted = False
        self._is_pause_wanted = False
        self._outgoing: deque[Message] = deque()
        self._is_sending = False
        self._threads: dict[int, str] = {}
        """Threads that the client knows, by number."""
        self._told: set[tuple[str, int, str]] = set()
        """Findings that the client was told: severity, line and text without its numbers."""
        self._stopped_thread = 0
        """With which the client shows why the program has stopped; 0 for none."""
        self.state = State.NEW
        self.client = ClientSettings()
        self._debuggee: Debuggee | None = None
        self.sources = Sources()
        self.breakpoints = Breakpoints()
        self.frames: dict[int, Frame] = {}
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
        while self._running is not None and not self._is_interrupted and self._requests.has_next():
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
        if self._running is None or self._running.is_interruptible or request["command"] in ENDING:
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
    def debuggee(self) -> Debuggee:
        """What is debugged."""
        if self._debuggee is None:
            raise RequestError(OUT_OF_ORDER, "nothing has been launched")
        return self._debuggee

    @property
    def session(self) -> Session:
        """The run, or what speaks to it."""
        return self.debuggee.session

    @property
    def run(self) -> DebugSession:
        """The run, if it can go back.

        Raises:
            RequestError: it is that of a living robot.
        """
        session = self.session
        if not isinstance(session, DebugSession):
            raise RequestError(REFUSED, "a robot that lives cannot go back in time; launch its journal for that")
        return session

    @property
    def stop(self) -> Stop:
        """The present stop."""
        stop = self.session.stop
        if stop is None:
            raise RequestError(IS_RUNNING, "the program runs again")
        return stop

    def open(self, debuggee: Debuggee, *, is_restart: bool = False) -> None:
        """Begin to debug something; it goes on with `begin`."""
        if self._debuggee is not None:
            self._debuggee.session.close()
        self._debuggee = debuggee
        debuggee.session.set_exception_filters(self.breakpoints.filters)
        if is_restart:
            for body in self.breakpoints.renew(debuggee, self.client):
                self.event("breakpoint", {"reason": "changed", "breakpoint": body})
        else:
            self.state = State.CONFIGURING
            self.event("initialized")

    def begin(self, goal: Goal) -> None:
        """Let it begin, after the response to what was asked."""
        if self._opening is not None:
            opening, self._opening = self._opening, None
            self.send(response(opening["seq"], opening["command"]))
        process: Body = {"name": self.debuggee.name, "startMethod": self.debuggee.start_method, "isLocalProcess": True}
        if self.debuggee.start_method == "launch":
            process["systemProcessId"] = os.getpid()
            # A client can pause what it knows; the others are reported with the first stop.
            self._report_threads({MAIN_THREAD: "main"})
        self.event("process", process)
        self.go(goal)

    def go(self, goal: Goal) -> None:
        """Let the program go on once the present request is answered."""
        self._goal = goal

    def travel(self, run: Callable[[DebugSession], Stop], thread: int = 0) -> None:
        """Go back in history, or to a moment, once the present request is answered.

        Args:
            run: carries it out.
            thread: that the request has named; 0 for none.
        """
        # Refused now if there is no history.
        assert self.run is not None
        self.go(Goal.travel(run, thread))

    def pause(self) -> None:
        """Have the run that goes on stop, and report that."""
        self._is_pause_wanted = True
        self.session.pause()

    def close(self, exit_code: int | None, *, terminates: bool = False, leaves_paused: bool = False) -> None:
        """End the session.

        Args:
            exit_code: reported to the client with the end, unless that was reported before; None for no report.
            terminates: stop the task of a robot that lives.
            leaves_paused: let it stay paused.
        """
        self._goal = None
        if self._opening is not None:
            opening, self._opening = self._opening, None
            error = RequestError(ENDED, "the session was ended before configurationDone")
            self.send(error_response(opening["seq"], opening["command"], error))
        if self.state is State.ENDED or self._debuggee is None:
            self.state = State.ENDED
            return
        self.state = State.ENDED
        session = self.session
        if isinstance(session, DebugSession):
            session.close()
        else:
            session.close(terminates=terminates, leaves_paused=leaves_paused)
        if exit_code is not None:
            if self.debuggee.start_method == "launch":
                self.event("exited", {"exitCode": exit_code})
            self.event("terminated")

    def refer_to(self, target: object) -> int:
        """Return a number for something that a later request names, until the program goes on."""
        self.references[len(self.references) + 1] = target
        return len(self.references)

    # ---------------------------------------------------------------- the run

    def _go(self, goal: Goal) -> None:
        """Let the program go on; to a stop, which is reported, if it is run here."""
        self._goal = None
        self.references.clear()
        self.frames.clear()
        thread, self._stopped_thread = self._stopped_thread, 0
        if thread and goal.how != "resume" and goal.thread != thread:
            # A client takes a step for one of its thread alone, and would go on to show why the other had stopped.
            self.event("continued", {"threadId": thread, "allThreadsContinued": True})
        session = self.session
        if not isinstance(session, DebugSession):
            self._go_on_elsewhere(session, goal)
            return
        self.state, self._running = State.RUNNING, goal
        before = session.stop.position
        # Their signals came before there was a run to interrupt.
        self.interrupt()
        try:
            stop = goal.run(session)
        except (DebugError, ElitescriptError) as error:
            self.note(str(error), "important")
            stop, self._is_pause_wanted = session.stop, True
        self.state, self._running = State.STOPPED, None
        has_gone_on = bool(self._deferred) or stop.position != before
        if stop.reason == PAUSE and not self._is_pause_wanted and has_gone_on:
            # It stopped for the requests alone.
            if self._answer_deferred() and self.state is State.STOPPED:
                self._goal = goal.rest()
            return
        self._is_pause_wanted = False
        self._report_stop(stop)
        self._answer_deferred()

    def _go_on_elsewhere(self, session: ServedSession, goal: Goal) -> None:
        self.state = State.RUNNING
        try:
            if goal.how == "pause":
                session.pause()
            elif goal.how:
                session.proceed(goal.how, goal.thread)
        except DebugError as error:
            self.state = State.STOPPED
            self.note(str(error), "important")
            self._report_stop(self.stop)
        early, self._early = self._early, []
        for kind, content in early:
            self._take_news_or_say(kind, content)

    def _answer_deferred(self) -> bool:
        """Answer what came while the program ran; return whether nothing of that lets it go on."""
        while self._deferred and self._goal is None:
            self._respond(self._deferred.popleft())
        return self._goal is None

    def _report_stop(self, stop: Stop) -> None:
        if stop.reason == END and not self.debuggee.stops_on_end:
            self.note(f"{stop.text}{self._verdict()}", "console")
            self._report_threads({})
            self.close(EXIT_CODES.get(stop.result, 1))
            return
        found = self.session.threads()
        threads = {thread.id: thread.name for thread in found}
        if stop.reason == END:
            # What a client goes back from.
            threads = {MAIN_THREAD: "main"}
        self._report_threads(threads)
        # Clients show the description beside the name of the thread, where little room is.
        body: Body = {"reason": stop.reason, "description": _brief(stop), "allThreadsStopped": True}
        if thread := stop.thread or next(iter(threads), 0):
            body["threadId"] = self._stopped_thread = thread
        if body["description"] != stop.text:
            body["text"] = stop.text
        if stop.reason == PAUSE and (why := "; ".join(_why(thread) for thread in found if thread.because)):
            body["text"] = why
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

    # ---------------------------------------------------------------- a robot that lives

    def heard(self, kind: str, content: dict[str, Any]) -> None:
        """Take what has happened to a living robot, in its own thread; see `services.control.debugging`."""
        self._requests.post(lambda: self._take_news_or_say(kind, content))

    def heard_output(self, output: Output) -> None:
        """Take what a living robot's programs say, in its own thread."""
        self._requests.post(lambda: self.report_output(output))

    def _take_news_or_say(self, kind: str, content: dict[str, Any]) -> None:
        """As `_take_news`; a robot that has gone meanwhile, or lies, does not end this process."""
        try:
            self._take_news(kind, content)
        except DebugError as error:
            self.note(f"the robot: {error}", "important")

    def _take_news(self, kind: str, content: dict[str, Any]) -> None:
        if self.state is State.CONFIGURING:
            # Breakpoints count from when they are set; the client hears of it when it is ready.
            self._early.append((kind, content))
            return
        if self.state is State.ENDED:
            return
        if kind == "stopped" and self.session.stop is not None:
            self.state = State.STOPPED
            self._report_stop(self.session.stop)
        elif kind == "continued":
            self.state = State.RUNNING
            self.event("continued", {"threadId": MAIN_THREAD, "allThreadsContinued": True})
        elif kind == "ended":
            self.state = State.RUNNING
            self._report_threads({})
            self.note(f"the program has ended: {content.get('result', '')}{self._verdict()}", "console")
            self._told.clear()
        elif kind == "breakpoint":
            for body in self.breakpoints.changed(read(BreakpointState, content.get("state")), self.client):
                self.event("breakpoint", {"reason": "changed", "breakpoint": body})
        elif kind == "detached":
            self.note(f"nothing is debugged any more: {content.get('reason', '')}", "important")
            self._report_threads({})
            self.close(STOPPED_EXIT)

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
        while self._outgoing and not self._is_sending:
            # What comes now is sent in here; what comes behind the last look at the queue, in the next pass.
            self._is_sending = True
            try:
                while self._outgoing:
                    self._send(self._outgoing.popleft())
            finally:
                self._is_sending = False

    def note(self, text: str, category: str) -> None:
        """Write a line to the client's console."""
        self.event("output", {"category": category, "output": f"{shown(text)}\n"})

    def _verdict(self) -> str:
        """Return how many findings the program had, as the end of a sentence."""
        counts = Counter(severity for severity, _, _ in self._told)
        return "".join(
            f", {count} {word}{'' if count == 1 else 's'}" for word, count in sorted(counts.items(), reverse=True)
        )

    def report_output(self, output: Output) -> None:
        """Write what a program says to the client's console."""
        if output.severity:
            self._told.add((output.severity, output.line, _NUMBERS.sub("#", output.text)))
        body: Body = {"category": output.category, "output": f"{shown(output.text)}\n"}
        texts = [] if self._debuggee is None else self._debuggee.texts()
        source = output.source if output.source in texts else next(iter(texts), "") if len(texts) == 1 else ""
        if output.line and source:
            body["source"] = self.sources.shown(source)
            body.update(self.client.place(output.line, 0))
        self.event("output", body)


def _why(thread: ThreadInfo) -> str:
    """Return why a thread does not go on."""
    wait = f" waits for {thread.waits_for}" if thread.waits_for else ""
    return f"{thread.name} in line {thread.line}{wait}: {thread.because}"


def _brief(stop: Stop) -> str:
    """Return in a few words why a run has stopped."""
    if stop.unevaluated:
        return "a condition that cannot be evaluated"
    if stop.exception is not None:
        return f"{stop.exception.filter} {stop.exception.code}".rstrip()
    if stop.changes:
        return "; ".join(
            f"{change.name}: {change.old or 'not there'} -> {change.new or 'not there'}" for change in stop.changes
        )
    return stop.text
