"""One robot as a function: `Kernel.tick` applies inputs, runs one tick and returns what happened in it.

The machine as ports show it is a call of its own, `Kernel.snapshot`: it takes most of the time of a tick of an arm that
moves, and changes nothing.

Nothing here knows a clock, a socket or a file of this computer. A kernel does the same whenever it is made with the
same configuration and given the same inputs at the same ticks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Final

from elitescript.controller.refusals import refusal_text
from elitescript.controller.views.signals import Signals
from elitescript.controller.views.snapshots import SnapshotBuilder
from elitescript.controller.views.warning_limit import WarningLimit
from elitescript.devices.channels.faulty_channels import FaultyChannels
from elitescript.environment.request_channels import FaultyEnvironment, RequestEnvironment
from elitescript.errors import ScriptError, UsageError
from elitescript.kernel.answers import outcome_of
from elitescript.kernel.causes import cause_of
from elitescript.kernel.config import KernelConfig, configured_model, describe
from elitescript.kernel.conversations import Conversations
from elitescript.kernel.interpreter_logs import InterpreterLogs
from elitescript.kernel.programs import Programs
from elitescript.kernel.tasks import Tasks
from elitescript.messages.enums import TaskState
from elitescript.messages.events import DeviceNoted, Event, Popup, TaskStateChanged, TextMessage, Warned
from elitescript.messages.faults import ChannelFault
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
from elitescript.messages.machine import AskSafety, DisturbInput, EndInputFaults, MachineRequest, PowerOff, StopTask
from elitescript.messages.outcomes import Done, Outcome, Refused
from elitescript.messages.outputs import Output, Reply, TickResult
from elitescript.messages.profile import profile
from elitescript.messages.signals import SIGNALS
from elitescript.messages.snapshot import Snapshot
from elitescript.runtime.connections.serial_line import close_lines
from elitescript.runtime.environment import FilesRefused, ProgramEnvironment
from elitescript.wiring import RobotOptions, assemble


class Kernel:
    """One robot.

    Args:
        config: what it is.
        world: everything outside its programs, with the logs of interpreter mode in its task folder. Its network is
            not used: what programs ask of one is in the output.

    Attributes:
        description: what never changes about it.
        overruns: ticks that began late, for the snapshots; counted by what keeps time.

    Raises:
        UsageError: a configuration that makes no sense.
    """

    __slots__ = (
        "_channels",
        "_controller",
        "_conversations",
        "_events",
        "_faulty",
        "_has_run",
        "_host",
        "_is_popup_blocking",
        "_is_remote",
        "_limit",
        "_logs",
        "_popup",
        "_programs",
        "_replies",
        "_snapshots",
        "_tasks",
        "description",
        "overruns",
    )

    def __init__(self, config: KernelConfig, world: ProgramEnvironment | None = None) -> None:
        model, firmware = configured_model(config), profile(config.firmware)
        requests = RequestEnvironment(FilesRefused() if world is None else world.files)
        of_channels = [fault for fault in config.faults if isinstance(fault, ChannelFault)]
        self._faulty = FaultyChannels(requests.channels, of_channels, seed=config.seed, say=self._note_fault)
        outside = FaultyEnvironment(requests.files, self._faulty)
        self.description = describe(config, model, firmware)
        self.overruns = 0
        self._events: list[Event] = []
        self._has_run = False
        """Whether the tick of the controller is over; the next call of `tick` goes on to the next one."""
        self._limit = WarningLimit()
        self._replies: list[Reply] = []
        self._popup = ""
        self._is_popup_blocking = False
        self._is_remote = config.remote
        self._channels = requests.channels
        fittings = RobotOptions(
            epoch_s=config.epoch_s,
            seed=config.seed,
            joints=config.joints,
            speed=config.speed,
            work_per_tick=config.work_per_tick,
            rpc_timeout_s=config.rpc_timeout_s,
            contact=config.contact,
            safety=config.safety,
            plant=config.plant or model.plant,
            is_powered=config.power_on,
            power_times=config.power_times,
            confirms_popups=False,
        )
        self._controller, self._host = assemble(model, firmware, fittings, on_event=self._event, world=outside)
        self._logs = None if world is None else InterpreterLogs(world.files)
        self._conversations = Conversations(self._host, self._reply, self._logs)
        self._snapshots = SnapshotBuilder(self._controller)
        self._programs = Programs(self._controller, self._host, firmware, model, is_strict=config.strict)
        self._tasks = Tasks(
            self._controller, self._host, self._programs, outside.files, outside.channels, config.configuration
        )
        if config.first_tick:
            self._controller.leap(config.first_tick)
        start = Signals(self._controller, "schedule")
        for name, value in config.signals:
            start[name] = value
        for fault in config.faults:
            if isinstance(fault, DisturbInput):
                self._controller.put(self._controller.tick, fault, "fault")

    @property
    def next_tick(self) -> int:
        """Number of the tick that `tick` runs next."""
        return self._controller.tick + self._has_run

    def tick(self, inputs: Sequence[Input] = ()) -> TickResult:
        """Run one tick.

        Args:
            inputs: what has come in since the last one, in order.
        """
        controller = self._controller
        if self._has_run:
            controller.leap(controller.tick + 1)
            self._has_run = False
        tick, logs = controller.tick, self._logs
        if logs is not None:
            logs.begin_tick(tick)
        controller.run_tick(lambda: self._take(inputs))
        if logs is not None and (trouble := logs.end_tick()):
            self._emit(Warned(tick, trouble))
        result = TickResult(tick, tuple(self._events), self._channels.take(), tuple(self._replies))
        self._events.clear()
        self._replies.clear()
        self._has_run = True
        return result

    def snapshot(self) -> Snapshot:
        """Return the machine as its ports show it after the last tick."""
        return self._snapshots.picture(
            self._tasks.picture, self._popup, is_remote=self._is_remote, overruns=self.overruns
        )

    def discrete_state(self) -> tuple[object, ...]:
        """Return all that a snapshot shows and that does not change with time alone; see `SnapshotBuilder`."""
        return (*self._snapshots.discrete_state(), self._tasks.picture, self._popup, self._is_remote)

    @property
    def line(self) -> int:
        """Script line of the main thread; 0 while no program runs."""
        return self._controller.task.program.line

    def tick_and_snapshot(self, inputs: Sequence[Input] = ()) -> Output:
        """Run one tick, and return what happened in it with the machine as it is then."""
        return self.tick(inputs).with_snapshot(self.snapshot())

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
            self._reply(item.origin, outcome_of(self._controller, self.description.firmware, item.request, why_not))

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
        if (outcome := self._tasks.answer(item)) is not None:
            self._reply(item.origin, outcome)

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
            self._disturb(item.fault)
        except UsageError as error:
            self._emit(Warned(self._controller.tick, f"fault refused: {error}"))
            self._reply(item.origin, Refused(str(error)))
        else:
            self._reply(item.origin, Done())

    def _disturb(self, fault: ChannelFault | DisturbInput) -> None:
        """Let a fault begin now, or at its tick if that is later.

        Raises:
            UsageError: there is no such input, or nothing to end.
        """
        if isinstance(fault, ChannelFault):
            self._faulty.add(fault)
        else:
            _check_point(fault)
            begin_tick = max(fault.begin_tick, self._controller.tick)
            self._controller.request_from(replace(fault, begin_tick=begin_tick), "fault")

    def _end_faults(self, item: EndFaults) -> None:
        self._faulty.clear()
        self._controller.request_from(EndInputFaults(), "fault")
        self._reply(item.origin, Done())

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

    def _reply(self, origin: str, outcome: Outcome) -> None:
        self._replies.append(Reply(origin, outcome))


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
    EndFaults: Kernel._end_faults,
    AddLog: Kernel._add_log,
    SetRemote: Kernel._set_remote,
    Reboot: Kernel._reboot,
    **dict.fromkeys((ChannelOpened, ChannelData, ChannelCredit, ChannelClosed), Kernel._channel),
}
"""Every kind of input and what handles it."""
