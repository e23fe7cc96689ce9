"""Gives the bodies of commands the machine, and the program as the calling thread sees it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Final, NoReturn, Protocol

from elitescript.commands.definition.context import Machine
from elitescript.errors import ArmNotReadyError, InvalidValueError, ScriptError, ScriptStateError
from elitescript.messages.events import Popup, Printed, TextMessage, Warned
from elitescript.messages.machine import MachineRequest, PauseTask, SetLineMark
from elitescript.messages.motion import (
    DriveRequest,
    MicroLine,
    MotionRequest,
    MoveJ,
    MoveL,
    MoveRequest,
    ServoJ,
    Six,
    SpeedJ,
    SpeedL,
    TrackRequest,
)
from elitescript.messages.path_offset import PathOffsetRequest
from elitescript.messages.profile import Profile
from elitescript.messages.timing import ticks_for
from elitescript.messages.yielding import YieldRequest
from elitescript.runtime.environment import TASK_PATH, Files, ProgramEnvironment, without_addresses
from elitescript.runtime.files import content_of
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import TIME_TO_GO_BY, Stopped, Strand
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.commands.definition.plausibility import Doubt
    from elitescript.runtime.connections.background import Background
    from elitescript.runtime.connections.connection import Receiver
    from elitescript.runtime.connections.modbus_signals import ModbusSignals
    from elitescript.runtime.connections.rpc import RemoteProcedures
    from elitescript.runtime.connections.serial_lines import SerialLines
    from elitescript.runtime.connections.sockets import Sockets
    from elitescript.runtime.interpreter import Interpreter
    from elitescript.runtime.move_waits import MoveWaits
    from elitescript.runtime.watchdogs import Watchdogs

RESUME: Final = "somebody to resume the program"
"""Reason of the wait in `pause()`."""

POPUP: Final = "somebody to confirm a popup"
"""Reason of the wait for a blocking popup."""

ROOM_FOR_TEXT: Final = "its texts to leave"
"""Reason of the wait of a thread that says more than clients take."""

MOVE_END: Final = "the end of its move"
"""Reason of the wait in `movej` and similar commands."""

LABEL_MAX: Final = 1000
"""Characters of the label of a node that are kept."""

KINDS_MAX: Final = 200
"""Most poses and joint positions of commands that are remembered, to detect their mix-up."""

ZEROS_MAX: Final = 3
"""Six numbers with more zeros can be equal by chance."""


class ProgramControl(Protocol):
    """Lists the members of the host that a context uses."""

    moves: MoveWaits
    """Threads that wait for moves."""
    connections: dict[int, Receiver]
    """What receives from each open channel."""

    def spawn_thread(self, function: Callable[..., Any], args: tuple[Any, ...], name: str) -> Strand:
        """Start a thread of the program."""

    def thread_count(self) -> int:
        """Return living threads of the program besides its main one."""

    def halt(self) -> None:
        """Have the program stopped as soon as the calling strand gives way."""

    def thread_failed(self, error: BaseException) -> None:
        """End the program: an exception left a thread."""

    background: Background
    """Signals and connections that go on whether a program runs or not."""

    interpreter: Interpreter
    """Interpreter mode."""

    rpc_timeout_s: float
    """How long a remote procedure call waits for its answer."""

    watchdogs: Watchdogs
    """RTSI inputs that the program watches."""

    def wait_for_confirmation(self) -> bool:
        """Return whether a blocking popup is confirmed at once; otherwise wait for a confirmation."""


class Context:
    """Implements `commands.definition.context.Robot` for every thread of one program; the running one is the caller.

    Args:
        machine: the controller.
        scheduler: runs the threads.
        profile: the firmware.
        generator: draws random numbers, seeded.
        world: environment.
        port: the host.

    Attributes:
        is_look: whether it belongs to what only looks at the program.
        missing: what the last reading with missing values says of them; None before.
    """

    __slots__ = (
        "_doubts",
        "_generator",
        "_kinds",
        "_lines",
        "_partial_line",
        "_port",
        "_procedures",
        "_sockets",
        "_warned",
        "_world",
        "is_look",
        "machine",
        "micro_lines",
        "missing",
        "profile",
        "scheduler",
        "task_path",
    )

    def __init__(
        self,
        machine: Machine,
        scheduler: Scheduler,
        profile: Profile,
        generator: Any,
        world: ProgramEnvironment,
        port: ProgramControl,
    ) -> None:
        self.machine = machine
        self.scheduler = scheduler
        self.profile = profile
        self.task_path = TASK_PATH
        self._generator = generator
        self._world = world
        self._port = port
        self._warned: set[str] = set()
        self._doubts: Sequence[Doubt] = ()
        self._kinds: dict[Six, str] = {}
        self._partial_line = ""
        self._procedures: RemoteProcedures | None = None
        self._sockets: Sockets | None = None
        self._lines: SerialLines | None = None
        self.micro_lines: list[MicroLine] = []
        self.is_look = False
        self.missing: str | None = None

    def forget_copies(self) -> None:
        """Hold what it remembers apart from the context that it is a copy of."""
        self._kinds, self._warned = dict(self._kinds), set(self._warned)

    # ---------------------------------------------------------------- the caller

    @property
    def strand(self) -> Strand:
        """The calling thread.

        Raises:
            Stopped: the caller is no thread, but left-over code of one.
        """
        return self.scheduler.caller

    @property
    def is_secondary(self) -> bool:
        """Whether the caller is a secondary program."""
        strand = self.scheduler.current
        return strand is not None and strand.is_secondary

    @property
    def now(self) -> int:
        """The present tick."""
        return self.scheduler.now

    @property
    def task_files(self) -> Files:
        """The task folder."""
        return self._world.files

    @property
    def modbus(self) -> ModbusSignals:
        """The MODBUS TCP signals of the controller."""
        found = self._port.background.modbus(self._world.channels)
        return found.for_look() if self.is_look else found

    @property
    def sockets(self) -> Sockets:
        """The program's TCP connections."""
        if self._sockets is None:
            from elitescript.runtime.connections.sockets import Sockets

            port = self._port
            self._sockets = Sockets(
                self._world.channels, self.scheduler, port.connections, port.background.traffic, self.warn_once
            )
        return self._sockets

    @property
    def lines(self) -> SerialLines:
        """The serial ports of the robot."""
        if self._lines is None:
            from elitescript.runtime.connections.serial_lines import SerialLines

            port = self._port
            self._lines = SerialLines(
                self._world.channels, self.scheduler, port.connections, port.background, self.warn_once
            )
        return self._lines

    def remote_procedures(self, url: str) -> object:
        """See `commands.definition.context.Robot.remote_procedures`."""
        if self._procedures is None:
            from elitescript.runtime.connections.rpc import RemoteProcedures

            port = self._port
            self._procedures = RemoteProcedures(
                self._world.channels, self.scheduler, port.connections, port.background.traffic, port.rpc_timeout_s
            )
        return self._procedures.handle(url)

    def close_connections(self) -> None:
        """Close every connection; the program is over."""
        if self._sockets is not None:
            self._sockets.close_all()
        if self._lines is not None:
            self._lines.tell_left()
        if self._procedures is not None:
            self._procedures.close_all()

    def read_task_file(self, path: str, size_max: int) -> bytes:
        """See `commands.definition.context.Robot.read_task_file`."""
        return content_of(self._world.files, path, size_max)

    def timestamp_s(self) -> float:
        """Return the controller's clock, seconds since 1970."""
        return self.machine.timestamp_s()

    def random(self) -> float:
        """Return the next number in [0, 1) of the program's generator."""
        return float(self._generator.random())

    # ---------------------------------------------------------------- the machine

    def move(self, request: MoveRequest | DriveRequest | YieldRequest) -> None:
        """Request a motion and wait until its call is over."""
        if isinstance(request, ServoJ):
            reason = "the time of its target"
        elif isinstance(request, SpeedJ | SpeedL):
            reason = "its speed" if request.t_s is None else "the time of its speed"
        else:
            reason = MOVE_END
        try:
            self._wait_for_move(request, reason)
        except ArmNotReadyError as error:
            if not isinstance(request, ServoJ | SpeedJ | SpeedL):
                raise
            self._pass_over(request, error)

    def _pass_over(self, request: DriveRequest, error: ArmNotReadyError) -> None:
        """Let the time of a streamed target go by while the arm is not ready; nothing moves.

        *Assumed*: drivers send their control program before the arm has power, and it streams from then on.
        """
        text = said(
            "{error}; servoj, speedj and speedl return after their time and move nothing until it is ready", error=error
        )
        self.warn_once("arm not ready", text, hint=error.hint or "")
        self.wait_ticks(max(1, ticks_for(request.t_s or 0.0)))

    def track(self, request: TrackRequest) -> None:
        """Begin to track a conveyor, or end that and wait for standstill."""
        self._wait_for_move(request, "standstill")

    def shift(self, request: PathOffsetRequest) -> None:
        """Set a path offset or one of its parameters; returns at once."""
        strand = self.strand
        if strand.is_dying:
            raise Stopped
        self.machine.request_path_offset(request, strand.line, strand.name)

    def stop_motion(self, request: MotionRequest | YieldRequest) -> None:
        """Request a stop and wait for standstill."""
        self._wait_for_move(request, "standstill")

    def _wait_for_move(self, request: MotionRequest | TrackRequest | YieldRequest, reason: str) -> None:
        strand = self.strand
        if strand.is_dying:
            raise Stopped
        move = self.machine.request_motion(request, strand.line, strand.name)
        if self._doubts:
            # Before this thread waits: the warning belongs to the begin of the move, and other threads have their own.
            self.tell_doubts()
        self._port.moves.wait(move, strand, reason, is_abortable=isinstance(request, MoveJ | MoveL))

    def request(self, request: MachineRequest) -> None:
        """Change the machine without moving it."""
        self.machine.request(request)

    def mark(self, number: int, label: str) -> None:
        """Note the node of the program tree that was reached."""
        self.machine.request(SetLineMark(number, label[:LABEL_MAX]))

    # ---------------------------------------------------------------- time and threads

    def wait_ticks(self, count: int) -> None:
        """Let `count` ticks go by; 0 returns at once."""
        if count > 0:
            scheduler = self.scheduler
            scheduler.wait(TIME_TO_GO_BY, scheduler.now + count)

    def start_thread(self, function: Callable[..., Any], args: tuple[Any, ...], name: str) -> int:
        """Start a script thread in this tick, after the threads that run already; return its handle.

        Raises:
            ScriptStateError: too many threads (code R121), or called by a secondary program (R120).
        """
        if self.strand.is_dying:
            raise Stopped
        if self.is_secondary:
            raise ScriptStateError("a secondary program (sec) may not start threads", code="R120")
        limit = self.profile.thread_limit
        if self._port.thread_count() >= limit:
            raise ScriptStateError(
                said(
                    "too many threads: firmware {profile} runs at most {limit} at a time",
                    profile=self.profile.name,
                    limit=limit,
                ),
                code="R121",
                value=limit + 1,
                limit=f"<= {limit}",
                hint="join or stop a thread before starting another one",
            )
        return self._port.spawn_thread(function, args, name).handle

    def join_thread(self, handle: int) -> None:
        """Wait for a thread; returns at once for 0, an unknown or a finished one.

        Raises:
            ScriptStateError: a thread cannot wait for itself.
        """
        target = self._find(handle)
        if target is None:
            return
        if target is self.scheduler.current:
            raise ScriptStateError("a thread cannot wait for its own end", value=handle)
        self.scheduler.join(target)

    def stop_thread(self, handle: int) -> None:
        """End a thread where it stands; no effect on 0, an unknown or a finished one."""
        target = self._find(handle)
        if target is not None:
            self.scheduler.kill(target)

    def _find(self, handle: int) -> Strand | None:
        target = self.scheduler.find(handle)
        return None if target is None or target.is_secondary else target

    # ---------------------------------------------------------------- messages

    def message(self, text: str) -> None:
        """Write an entry to the robot's log."""
        self._say(len(text))
        strand = self.strand
        self.machine.emit(TextMessage(self.machine.tick, without_addresses(text), strand.name, strand.line))

    def write(self, text: str) -> None:
        """Write to the standard output; one event for each `print`, or for each line."""
        text = self._partial_line + text
        self._say(len(text), is_whole=text.endswith("\n"))
        if not text.endswith("\n"):
            self._partial_line = text
            return
        self._partial_line = ""
        strand = self.strand
        self.machine.emit(Printed(self.machine.tick, without_addresses(text[:-1]), strand.name, strand.line))

    def _say(self, size: int, *, is_whole: bool = True) -> None:
        """Let the calling thread wait until there is room for a text, and count it.

        Args:
            size: of the text.
            is_whole: whether it leaves now.

        Raises:
            InvalidValueError: it is too long.
        """
        # The first text loads it: many programs say nothing.
        from elitescript.runtime.threads.said import TEXT_MAX, SaidText

        if size > TEXT_MAX:
            raise InvalidValueError(
                said("a text of {size} characters; at most {limit} are said at once", size=size, limit=TEXT_MAX),
                value=size,
                limit=f"<= {TEXT_MAX}",
                unit="characters",
                hint="say it in parts, or write it to a file",
            )
        if is_whole:
            scheduler = self.scheduler
            texts = scheduler.said
            if texts is None:
                texts = scheduler.said = SaidText()
            while (ticks := texts.wait_ticks(scheduler.now)) and not self.strand.is_dying:
                scheduler.wait(ROOM_FOR_TEXT, scheduler.now + ticks)
            texts.add(size, scheduler.now)

    def flush(self) -> None:
        """Emit a last line without its end: the program is over."""
        text, self._partial_line = self._partial_line, ""
        if text:
            self.machine.emit(Printed(self.machine.tick, without_addresses(text), "main", 0))

    def popup(self, text: str, title: str, level: str, *, is_blocking: bool) -> None:
        """Show a message window; wait for its confirmation when it blocks.

        A secondary program never waits, and neither does a thread where popups are confirmed at once.
        """
        self._say(len(text) + len(title))
        strand = self.strand
        is_blocking = is_blocking and not strand.is_secondary
        is_confirmed = is_blocking and self._port.wait_for_confirmation()
        self.machine.emit(
            Popup(
                self.machine.tick,
                without_addresses(text),
                without_addresses(title),
                level,
                is_blocking,
                is_confirmed,
                strand.name,
                strand.line,
            )
        )
        if is_blocking and not is_confirmed:
            self.scheduler.wait(POPUP)

    def warn(self, text: str, *, code: str = "", hint: str = "") -> None:
        """Record a warning; `code` and `hint` are those of `check`, if it knows the same finding."""
        strand = self.scheduler.current
        name, line = ("", 0) if strand is None else (strand.name, strand.line)
        self.machine.emit(Warned(self.machine.tick, text, name, line, code, hint))

    def tell_refused(self, command: str, family: str, error: ScriptError) -> None:
        """Charge the thread for a call that a command has refused, and let observers see it."""
        from elitescript.messages.observations import CommandRefused

        moves = family == "motion"
        self.scheduler.spend_refusal(moves=moves)
        strand = self.scheduler.current
        line, thread = (0, "") if strand is None else (strand.line, strand.name)
        self.machine.observe(CommandRefused(self.machine.tick, line, thread, command, str(error), moves))

    def warn_once(self, key: str, text: str, *, code: str = "", hint: str = "") -> None:
        """Record a warning, once in this program for each `key`."""
        if key not in self._warned:
            self._warned.add(key)
            self.warn(text, code=code, hint=hint)

    # ---------------------------------------------------------------- doubts about values

    def mistaken(self, meaning: str, value: Six) -> Doubt | None:
        """See `commands.definition.context.Robot.mistaken`."""
        kind = self._kinds.get(value)
        if kind is None or kind == meaning:
            return None
        from elitescript.commands.definition.plausibility import mistaken

        return mistaken(meaning, kind)

    def note_missing(self, command: str, came: int, number: int) -> None:
        """See `commands.definition.context.Robot.note_missing`."""
        self.missing = said(
            "nan comes from {command} in line {line}, which has read {came} of {number} numbers: look at its first "
            "element before you use the others",
            command=command,
            line=self.strand.line,
            came=came,
            number=number,
        )

    def remember(self, kind: str, value: Six) -> None:
        """Remember the result of a command; only the newest results are kept."""
        if value.count(0.0) > ZEROS_MAX:
            return
        kinds = self._kinds
        known = kinds.setdefault(value, kind)
        if known != kind:
            kinds[value] = ""
        elif len(kinds) > KINDS_MAX:
            del kinds[next(iter(kinds))]

    def hold_doubts(self, doubts: Sequence[Doubt]) -> None:
        """See `commands.definition.context.Robot.hold_doubts`."""
        self._doubts = doubts

    def tell_doubts(self) -> None:
        """Record the doubts that are held, each code once for a line."""
        doubts, self._doubts = self._doubts, ()
        strand = self.strand
        for doubt in doubts:
            key = f"{doubt.code} {strand.line} {doubt.text.partition('[')[0].partition(' is ')[0]}"
            if key not in self._warned:
                self._warned.add(key)
                tick = self.machine.tick
                self.machine.emit(Warned(tick, doubt.text, strand.name, strand.line, doubt.code, doubt.hint))

    # ---------------------------------------------------------------- the task

    def pause(self) -> None:
        """Pause the task until it is resumed from outside."""
        if self.strand.is_dying:
            raise Stopped
        self.machine.request(PauseTask())
        self.scheduler.give_way(RESUME)

    def halt(self) -> NoReturn:
        """Stop the task; does not return."""
        self._port.halt()
        self.scheduler.kill(self.strand)
        raise Stopped

    def enter_interpreter(self, *, clears_queue: bool, clears_at_end: bool) -> None:
        """Run statements of clients until the session ends; see `runtime.interpreter`."""
        self._port.interpreter.run(clears_queue=clears_queue, clears_at_end=clears_at_end)

    def end_interpreter(self) -> None:
        """End the session of interpreter mode, if one runs."""
        self._port.interpreter.end()

    def clear_interpreter(self) -> None:
        """Discard the waiting statements, and delete the names that statements have defined."""
        self._port.interpreter.clear()

    def watch(self, variable: str, frequency_hz: float, action: str) -> None:
        """Watch an RTSI input until the program ends."""
        self._port.watchdogs.set(variable, frequency_hz, action)

    def leave(self, name: str) -> NoReturn:
        """End the program like `halt()`, with a warning: `exit()` and similar functions."""
        self.warn(said("{name}() ends the program like halt()", name=name))
        self.halt()

    def thread_failed(self, error: BaseException) -> NoReturn:
        """Report an exception that has left the function of a `threading.Thread`.

        Raises:
            Stopped: always; the thread is over.
        """
        self._port.thread_failed(error)
        raise Stopped
