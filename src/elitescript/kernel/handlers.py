"""What each input does to a robot: one handler for each kind.

They hold what only clients use: programs that come from outside, tasks, interpreter mode and queries.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Final

from elitescript.controller.refusals import refusal_text
from elitescript.errors import ScriptError, UsageError
from elitescript.kernel.compiling import CompilesHere, Workshop
from elitescript.kernel.conversations import Conversations
from elitescript.kernel.interpreter_logs import InterpreterLogs
from elitescript.kernel.parts import RobotParts
from elitescript.kernel.programs import Programs
from elitescript.kernel.tasks import Tasks
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Event, Popup, TextMessage, Warned
from elitescript.messages.faults import ChannelFault
from elitescript.messages.inputs import (
    RESTART,
    WORLD,
    AddFault,
    AddLog,
    ChannelClosed,
    ChannelCredit,
    ChannelData,
    ChannelEvent,
    ChannelOpened,
    ClosePopup,
    Compiled,
    Debug,
    Do,
    EndFaults,
    GetVariable,
    Input,
    Interpret,
    InterpreterWord,
    Lag,
    LoadConfiguration,
    LoadTask,
    PlayTask,
    Query,
    Reboot,
    RunUnit,
    SetRemote,
    SetVariable,
    ShowPopup,
    VariablesArrived,
)
from elitescript.messages.machine import (
    AskSafety,
    DisturbInput,
    EndInputFaults,
    MachineRequest,
    PowerOff,
    StopTask,
    WritePortRegisters,
)
from elitescript.messages.outcomes import Done, Outcome, Refused, RegistersRead
from elitescript.messages.outputs import ChannelRequest, Reply, TickResult
from elitescript.messages.signals import SIGNALS
from elitescript.records import replace
from elitescript.runtime.connections.serial_line import close_lines
from elitescript.runtime.environment import ProgramEnvironment
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.devices.channels.faulty_channels import FaultyChannels
    from elitescript.kernel.debugging import Debugging

_CAUSES: Final = {RESTART: "schedule"} | {f"{WORLD}:{by}": by for by in ("device", "wire", "schedule", "fault")}


def cause_of(origin: str) -> str:
    """Return `SignalChanged.by` for what an input of an origin changes: what the origin names, else `client`."""
    return _CAUSES.get(origin, "client")


class InputHandlers:
    """Carries out the inputs of one robot.

    Args:
        parts: of the robot.
        environment: everything outside the programs that come from clients.
        faulty: its network, if faults can be added to it.
        has_logs: whether interpreter mode keeps its logs in the task folder.
        debugging: what lets a debugger attach; None if none can.
        workshop: where long texts are compiled, if the options want that elsewhere; here if None.

    Attributes:
        programs: compiles and starts programs of clients.
        tasks: what is loaded.
        conversations: interpreter mode and the query port.
        is_remote: whether clients may change the robot.
        replies: to clients, in the tick.
    """

    __slots__ = (
        "_controller",
        "_debugging",
        "_faulty",
        "_host",
        "_logs",
        "_popup",
        "_profile",
        "conversations",
        "is_remote",
        "programs",
        "replies",
        "tasks",
    )

    def __init__(
        self,
        parts: RobotParts,
        environment: ProgramEnvironment,
        faulty: FaultyChannels | None,
        *,
        has_logs: bool,
        debugging: Debugging | None = None,
        workshop: Workshop | None = None,
    ) -> None:
        options, model, self._profile, self._controller, self._host, self._popup, probe = parts
        self._faulty = faulty
        self._debugging = debugging
        self.is_remote = options.remote
        self.replies: list[Reply] = []
        self._logs = InterpreterLogs(environment.files) if has_logs else None
        self.conversations: Conversations = Conversations(self._host, self._reply, self._logs)
        workshop = workshop or CompilesHere(self._profile, model, options.ignored)
        self.programs: Programs = Programs(
            self._controller,
            self._host,
            self._profile,
            model,
            environment,
            is_strict=options.strict,
            ignored=options.ignored,
            probe=probe,
            workshop=workshop if options.compiles_elsewhere else None,
        )
        self.tasks: Tasks = Tasks(
            self._controller,
            self._host,
            self.programs,
            environment,
            options.configuration,
            reads_trees=options.reads_trees,
        )

    @property
    def is_waiting(self) -> bool:
        """Whether something waits for the next tick."""
        return (
            self.conversations.is_waiting
            or self.programs.is_waiting
            or self.tasks.is_waiting
            or (self._logs is not None and self._logs.is_waiting)
        )

    def run_tick(self, inputs: Sequence[Input]) -> None:
        """Run a tick of the robot in which these inputs are carried out."""
        tick, logs = self._controller.tick, self._logs
        if logs is not None:
            logs.begin_tick(tick)
        self._controller.run_tick(lambda: self._take(inputs))
        if logs is not None and (trouble := logs.end_tick()):
            self._controller.emit(Warned(tick, trouble))

    def result(self, events: Sequence[Event], requests: tuple[ChannelRequest, ...]) -> TickResult:
        """Return what has happened in the tick, with the replies to clients."""
        result = TickResult(self._controller.tick, tuple(events), requests, tuple(self.replies))
        self.replies.clear()
        return result

    def _take(self, inputs: Sequence[Input]) -> None:
        self.conversations.go_on()
        self.programs.go_on(self._do)
        if self._faulty is not None:
            for event in self._faulty.arrivals(self._controller.tick):
                self.channel_event(event)
        for item in inputs:
            HANDLERS[type(item)](self, item)
        for late in self.tasks.due():
            self._reply(*late)

    def _reply(self, origin: str, outcome: Outcome) -> None:
        self.replies.append(Reply(origin, outcome))

    # ---------------------------------------------------------------- the machine

    def _take_request(self, item: Do) -> None:
        """Do what is asked, unless its client has sent a line or a program before it that has not run."""
        if item.is_answered or not self.programs.has_queued(item):
            self._do(item)

    def _do(self, item: Do) -> None:
        why_not = self._attempt(item.request, cause_of(item.origin))
        if why_not:
            self._controller.emit(Warned(self._controller.tick, why_not))
        if item.is_answered:
            self._reply(item.origin, Refused(why_not) if why_not else self._outcome_of(item.request))

    def _attempt(self, request: MachineRequest, by: str) -> str:
        """Do what is asked; return why it cannot be done, empty if it is."""
        if isinstance(request, StopTask):
            self.tasks.stop()
            self.programs.drop("the task was stopped")
            if self._controller.task_state is TaskState.STOPPED:
                return ""
        try:
            _check_point(request)
            self._controller.request_from(request, by)
        except (ScriptError, UsageError) as error:
            return refusal_text(request, error)
        return ""

    def _outcome_of(self, request: MachineRequest) -> Outcome:
        """Return the outcome of a request that was carried out, with the registers that it asks to be read after it."""
        if not isinstance(request, WritePortRegisters) or not request.read_count:
            return Done()
        image = self._controller.port_image(self._profile.version)
        return RegistersRead(tuple(image.registers(request.read_first, request.read_count)))

    def _set_remote(self, item: SetRemote) -> None:
        self.is_remote = item.is_remote

    def _reboot(self, _item: Reboot) -> None:
        """Signals, TCP and payload stay, serial ports close; what the real controller forgets is *assumed*."""
        self._controller.request(PowerOff())
        self._controller.request(AskSafety("restart_safety", "the controller was started anew"))
        close_lines(self._host.background.lines, self._host.connections)
        self._popup.close()
        self.programs.drop("the controller was started anew")
        self.tasks.forget()
        self._host.background.close()

    # ---------------------------------------------------------------- programs and messages

    def _task_input(self, item: LoadTask | LoadConfiguration | PlayTask | SetVariable | GetVariable) -> None:
        if (outcome := self.tasks.answer(item)) is not None:
            self._reply(item.origin, outcome)

    def _arrived(self, item: VariablesArrived) -> None:
        self._host.watchdogs.arrived(item.names, self._controller.tick)

    def _lag(self, item: Lag) -> None:
        self._host.set_lag(item.ticks)

    def _show_popup(self, item: ShowPopup) -> None:
        self._controller.emit(Popup(self._controller.tick, item.text, "", "info", False, False, "", 0))

    def _close_popup(self, _item: ClosePopup) -> None:
        self._popup.close()
        self._host.confirm_popup()

    def _add_log(self, item: AddLog) -> None:
        tick = self._controller.tick
        self._controller.emit(Warned(tick, item.text) if item.is_warning else TextMessage(tick, item.text, "", 0))

    def _debug(self, item: Debug) -> None:
        if self._debugging is None:
            self._reply(item.origin, Refused("no debugger can attach to this robot"))
        else:
            self._debugging.take(item, self._controller, self._host, self._reply)

    # ---------------------------------------------------------------- channels

    def _add_fault(self, item: AddFault) -> None:
        try:
            self._disturb(item.fault)
        except UsageError as error:
            self._controller.emit(Warned(self._controller.tick, said("fault refused: {error}", error=error)))
            self._reply(item.origin, Refused(str(error)))
        else:
            self._reply(item.origin, Done())

    def _end_faults(self, item: EndFaults) -> None:
        if self._faulty is not None:
            self._faulty.clear()
        self._controller.request_from(EndInputFaults(), "fault")
        self._reply(item.origin, Done())

    def _disturb(self, fault: ChannelFault | DisturbInput) -> None:
        """Let a fault begin now, or at its tick if that is later.

        Raises:
            UsageError: there is no such input, or no network of its own.
        """
        if isinstance(fault, DisturbInput):
            _check_point(fault)
            begin_tick = max(fault.begin_tick, self._controller.tick)
            self._controller.request_from(replace(fault, begin_tick=begin_tick), "fault")
        elif self._faulty is None:
            raise UsageError("the network of this robot is not its own; add the fault to that network")
        else:
            self._faulty.add(fault)

    def _channel(self, item: ChannelEvent) -> None:
        events = (item,) if self._faulty is None else self._faulty.incoming(item)
        for event in events:
            self.channel_event(event)

    def channel_event(self, event: ChannelEvent) -> None:
        """Take what has happened on a channel, for the task or the program that has opened it."""
        if not self.tasks.channel_event(event):
            self._host.channel_event(event)


def _check_point(request: object) -> None:
    """Let a request pass that names no point of the signal table, or one that exists.

    Raises:
        UsageError: it names another one.
    """
    name, index = getattr(request, "name", None), getattr(request, "index", None)
    if name is None or index is None:
        return
    row = SIGNALS.get(name)
    if row is None or not 0 <= index < row.size:
        raise UsageError(f"there is no signal {name}[{index}]")


HANDLERS: Final[dict[type, Callable[[InputHandlers, Any], None]]] = {
    Do: InputHandlers._take_request,
    RunUnit: lambda handlers, item: handlers.programs.take(item),
    **dict.fromkeys((LoadTask, LoadConfiguration, PlayTask, SetVariable, GetVariable), InputHandlers._task_input),
    Compiled: lambda handlers, item: handlers.programs.come_back(item),
    Interpret: lambda handlers, item: handlers.conversations.interpret(item),
    InterpreterWord: lambda handlers, item: handlers.conversations.word(item),
    Query: lambda handlers, item: handlers.conversations.query(item),
    VariablesArrived: InputHandlers._arrived,
    Lag: InputHandlers._lag,
    ShowPopup: InputHandlers._show_popup,
    ClosePopup: InputHandlers._close_popup,
    AddFault: InputHandlers._add_fault,
    EndFaults: InputHandlers._end_faults,
    AddLog: InputHandlers._add_log,
    Debug: InputHandlers._debug,
    SetRemote: InputHandlers._set_remote,
    Reboot: InputHandlers._reboot,
    **dict.fromkeys((ChannelOpened, ChannelData, ChannelCredit, ChannelClosed), InputHandlers._channel),
}
"""Every kind of input and what handles it."""
