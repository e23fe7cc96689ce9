"""One robot as a function: `Kernel.tick` applies what has come in, runs one tick and returns what there is to say.

Nothing here knows a clock, a socket or a file of this computer. A kernel does the same whenever it is made with the
same options and given the same inputs at the same ticks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final

from elitescript.controller.refusals import refusal_text
from elitescript.controller.signals.by_name import Signals
from elitescript.controller.views.snapshots import SnapshotBuilder
from elitescript.controller.views.warning_limit import WarningLimit
from elitescript.devices.channels.faults import Fault, fault_of, input_request, is_of_input
from elitescript.devices.channels.faulty_channels import FaultyChannels
from elitescript.environment.request_channels import FaultyEnvironment, RequestEnvironment
from elitescript.errors import ScriptError, UsageError
from elitescript.kernel.answers import shown_after
from elitescript.kernel.arm import model_of
from elitescript.kernel.causes import cause_of
from elitescript.kernel.conversations import Conversations
from elitescript.kernel.description import describe
from elitescript.kernel.interpreter_logs import InterpreterLogs
from elitescript.kernel.options import RobotOptions
from elitescript.kernel.programs import Programs
from elitescript.kernel.tasks import Tasks
from elitescript.messages.enums import TaskState
from elitescript.messages.events import DeviceNoted, Event, Popup, TaskStateChanged, TextMessage, Warned
from elitescript.messages.inputs import (
    AddFault,
    AddLog,
    ChannelClosed,
    ChannelCredit,
    ChannelData,
    ChannelEvent,
    ChannelOpened,
    ClosePopup,
    Do,
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
from elitescript.messages.machine import AskSafety, EndInputFaults, MachineRequest, PowerOff, StopTask
from elitescript.messages.outputs import Output, Reply
from elitescript.messages.profile import profile
from elitescript.messages.signals import SIGNALS
from elitescript.messages.snapshot import TaskPicture
from elitescript.protocol.outcomes import done, refused
from elitescript.runtime.connections.serial_line import close_lines
from elitescript.runtime.environment import FilesRefused, ProgramEnvironment
from elitescript.wiring import assemble


class Kernel:
    """One robot.

    Args:
        options: what it is made with.
        world: everything outside its programs, with the logs of interpreter mode in its task folder. Its network is
            not used: what programs ask of one is in the output.

    Attributes:
        description: what never changes about it.
        overruns: ticks that began late, for the snapshots; whoever keeps time counts them.

    Raises:
        UsageError: options that make no sense.
    """

    __slots__ = (
        "_channels",
        "_controller",
        "_conversations",
        "_events",
        "_faulty",
        "_host",
        "_is_popup_blocking",
        "_is_remote",
        "_limit",
        "_logs",
        "_pictures",
        "_popup",
        "_programs",
        "_replies",
        "_tasks",
        "description",
        "overruns",
    )

    def __init__(self, options: RobotOptions, world: ProgramEnvironment | None = None) -> None:
        model, firmware = model_of(options), profile(options.firmware)
        requests = RequestEnvironment(FilesRefused() if world is None else world.files)
        faults = [fault_of(text) for text in options.faults]
        of_channels = [fault for fault in faults if not is_of_input(fault)]
        self._faulty = FaultyChannels(requests.channels, of_channels, seed=options.seed, say=self._note_fault)
        outside = FaultyEnvironment(requests.files, self._faulty)
        self.description = describe(options, model, firmware)
        self.overruns = 0
        self._events: list[Event] = []
        self._limit = WarningLimit()
        self._replies: list[Reply] = []
        self._popup = ""
        self._is_popup_blocking = False
        self._is_remote = options.remote
        self._channels = requests.channels
        self._controller, self._host = assemble(model, firmware, options, on_event=self._event, world=outside)
        self._logs = None if world is None else InterpreterLogs(world.files)
        self._conversations = Conversations(self._host, self._reply, self._logs)
        self._pictures = SnapshotBuilder(self._controller)
        self._programs = Programs(self._controller, self._host, firmware, model, is_strict=options.strict)
        self._tasks = Tasks(
            self._controller, self._host, self._programs, outside.files, outside.channels, options.configuration
        )
        if options.first_tick:
            self._controller.leap(options.first_tick)
        start = Signals(self._controller, "schedule")
        for name, value in options.signals:
            start[name] = value
        for fault in faults:
            if is_of_input(fault):
                self._controller.put(self._controller.tick, input_request(fault), "fault")

    @property
    def next_tick(self) -> int:
        """Number of the tick that `tick` runs next."""
        return self._controller.tick

    def tick(self, inputs: Sequence[Input] = ()) -> Output:
        """Run one tick.

        Args:
            inputs: what has come in since the last one, in order.

        Returns:
            What happened in it, and the machine as it is then.
        """
        controller = self._controller
        tick, logs = controller.tick, self._logs
        if logs is not None:
            logs.begin_tick(tick)
        controller.run_tick(lambda: self._take(inputs))
        if logs is not None and (trouble := logs.end_tick()):
            self._emit(Warned(tick, trouble))
        snapshot = self._pictures.picture(
            self._task_picture(), self._popup, is_remote=self._is_remote, overruns=self.overruns
        )
        requests = self._channels.take()
        output = Output(tick, tuple(self._events), requests, tuple(self._replies), snapshot)
        self._events.clear()
        self._replies.clear()
        controller.leap(tick + 1)
        return output

    # ---------------------------------------------------------------- inputs

    def _take(self, inputs: Sequence[Input]) -> None:
        self._conversations.go_on()
        self._programs.go_on()
        for event in self._faulty.arrivals(self._controller.tick):
            self._hand(event)
        for item in inputs:
            HANDLERS[type(item)](self, item)
        if (late := self._tasks.due()) is not None:
            self._reply(*late)

    def _do(self, item: Do) -> None:
        why_not = self._attempt(item.request, cause_of(item.origin))
        if why_not:
            self._emit(Warned(self._controller.tick, why_not))
        if item.is_answered:
            shown = shown_after(self._controller, self.description.firmware, item.request)
            self._reply(item.origin, refused(why_not) if why_not else done(shown))

    def _attempt(self, request: MachineRequest, by: str) -> str:
        """Do what is asked; return why it cannot be done, empty if it is."""
        if isinstance(request, StopTask):
            self._tasks.stop()
            if self._controller.task_state is TaskState.STOPPED:
                return ""
        try:
            _check_point(request)
            self._controller.request_from(request, by)
        except (ScriptError, UsageError) as error:
            return refusal_text(request, error)
        return ""

    def _run_unit(self, item: RunUnit) -> None:
        self._programs.run(item)

    def _task_input(self, item: LoadTask | LoadConfiguration | PlayTask | SetVariable | GetVariable) -> None:
        if text := self._tasks.answer(item):
            self._reply(item.origin, text)

    def _show_popup(self, item: ShowPopup) -> None:
        self._emit(Popup(self._controller.tick, item.text, "", "info", False, False, "", 0))

    def _close_popup(self, _item: ClosePopup) -> None:
        self._popup = ""
        self._is_popup_blocking = False
        self._host.confirm_popup()

    def _add_log(self, item: AddLog) -> None:
        tick = self._controller.tick
        self._emit(Warned(tick, item.text) if item.is_warning else TextMessage(tick, item.text, "", 0))

    def _set_remote(self, item: SetRemote) -> None:
        self._is_remote = item.is_remote

    def _reboot(self, _item: Reboot) -> None:
        """Signals, TCP and payload stay, serial ports close; what the real controller forgets is *assumed*."""
        controller = self._controller
        controller.request(PowerOff())
        controller.request(AskSafety("restart_safety", "the controller was started anew"))
        close_lines(self._host.background.lines, self._host.connections)
        self._popup = ""
        self._tasks.forget()
        self._host.background.close()

    def _arrived(self, item: VariablesArrived) -> None:
        self._host.watchdogs.arrived(item.names, self._controller.tick)

    def _lag(self, item: Lag) -> None:
        self._host.set_lag(item.ticks)

    def _add_fault(self, item: AddFault) -> None:
        try:
            if item.text:
                self._disturb(fault_of(item.text))
            else:
                self._faulty.clear()
                self._controller.request_from(EndInputFaults(), "fault")
        except UsageError as error:
            self._emit(Warned(self._controller.tick, f"fault refused: {error}"))
            self._reply(item.origin, refused(str(error)))
        else:
            self._reply(item.origin, done())

    def _disturb(self, fault: Fault) -> None:
        if is_of_input(fault):
            self._controller.request_from(input_request(fault, self._controller.tick), "fault")
        else:
            self._faulty.add(fault)

    def _note_fault(self, text: str) -> None:
        self._emit(DeviceNoted(self._controller.tick, "fault", text))

    def _channel(self, item: ChannelEvent) -> None:
        for event in self._faulty.incoming(item):
            self._hand(event)

    def _hand(self, item: ChannelEvent) -> None:
        if not self._tasks.channel_event(item):
            self._host.channel_event(item)

    # ---------------------------------------------------------------- outputs

    def _event(self, event: Event) -> None:
        if isinstance(event, Warned) and event.thread and (event.code, event.line) in self._programs.told:
            return  # said when the program was checked
        if isinstance(event, TaskStateChanged) and event.state is TaskState.STOPPED:
            self._events += self._limit.rest(event.tick)
        elif self._is_of_program(event) and not self._limit.takes(event):
            return
        self._events.append(event)
        if isinstance(event, Popup):
            self._popup, self._is_popup_blocking = event.text, event.is_blocking
        elif isinstance(event, TaskStateChanged) and event.state is TaskState.STOPPED and self._is_popup_blocking:
            # Nobody waits for it any more.
            self._popup, self._is_popup_blocking = "", False

    def _is_of_program(self, event: Event) -> bool:
        """Whether the running program causes an event. What clients are refused has its own limits."""
        if not isinstance(event, Warned) or not (event.line or event.thread):
            return False
        return self._controller.task_state is not TaskState.STOPPED

    def _emit(self, event: Event) -> None:
        self._controller.emit(event)

    def _reply(self, origin: str, text: str) -> None:
        self._replies.append(Reply(origin, text))

    def _task_picture(self) -> TaskPicture:
        return self._tasks.picture


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


HANDLERS: Final[dict[type, Callable[[Kernel, Any], None]]] = {
    Do: Kernel._do,
    RunUnit: Kernel._run_unit,
    **dict.fromkeys((LoadTask, LoadConfiguration, PlayTask, SetVariable, GetVariable), Kernel._task_input),
    Interpret: lambda kernel, item: kernel._conversations.interpret(item),
    InterpreterWord: lambda kernel, item: kernel._conversations.word(item),
    Query: lambda kernel, item: kernel._conversations.query(item),
    VariablesArrived: Kernel._arrived,
    Lag: Kernel._lag,
    ShowPopup: Kernel._show_popup,
    ClosePopup: Kernel._close_popup,
    AddFault: Kernel._add_fault,
    AddLog: Kernel._add_log,
    SetRemote: Kernel._set_remote,
    Reboot: Kernel._reboot,
    **dict.fromkeys((ChannelOpened, ChannelData, ChannelCredit, ChannelClosed), Kernel._channel),
}
"""Every kind of input and what handles it."""
