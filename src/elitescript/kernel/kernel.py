"""One robot: the machine, the host of its programs, and what clients ask of them.

`Kernel.tick` runs one tick and returns what happened in it. The machine as ports show it is a call of its own,
`Kernel.snapshot`: it takes most of the time of a tick of an arm that moves, and changes nothing; so it makes only the
parts that are read.

`VirtualRobot`, `serve` and its child hold a `Kernel`. Nothing here uses a clock, a socket or a file of this computer:
a kernel does the same whenever it is made with the same options and given the same inputs at the same ticks.

A plain run needs neither ports nor inputs. They are imported by the first that is used.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Final

from elitescript.controller.controller import Controller
from elitescript.controller.views.signals import Signals
from elitescript.controller.views.warning_limit import WarningLimit
from elitescript.errors import UsageError, did_you_mean
from elitescript.kernel.arm import model_of
from elitescript.kernel.options import RobotOptions
from elitescript.kernel.parts import PopupWindow, RobotParts
from elitescript.messages.enums import TaskState
from elitescript.messages.events import (
    OBSERVED,
    Alarm,
    Change,
    DeviceNoted,
    Event,
    Popup,
    TaskStateChanged,
    Warned,
    event_of,
)
from elitescript.messages.machine import DisturbInput
from elitescript.messages.motion import Six
from elitescript.messages.profile import profile
from elitescript.messages.signals import Value
from elitescript.messages.snapshot_parts import ALL_PARTS
from elitescript.messages.timing import seconds
from elitescript.models.model import RobotModel
from elitescript.records import replace
from elitescript.runtime.environment import ProgramEnvironment
from elitescript.runtime.host import ScriptHost
from elitescript.runtime.probe import default_probe, witness
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.controller.views.snapshots import SnapshotBuilder
    from elitescript.devices.channels.faulty_channels import FaultyChannels
    from elitescript.environment.request_channels import RequestChannels
    from elitescript.findings.observing import Observers
    from elitescript.kernel.compiling import Workshop
    from elitescript.kernel.debugging import Debugging
    from elitescript.kernel.handlers import InputHandlers
    from elitescript.messages.cut import Cut
    from elitescript.messages.findings import Finding
    from elitescript.messages.inputs import ChannelEvent, Input
    from elitescript.messages.machine import EndInputFaults, WriteSignal
    from elitescript.messages.observations import Observation
    from elitescript.messages.outputs import Output, TickResult
    from elitescript.messages.snapshot import RobotDescription, Snapshot
    from elitescript.protocol.connection import Connection
    from elitescript.protocol.ports import Connect
    from elitescript.runtime.probe import Probe
    from elitescript.runtime.threads.meter import Meter


class Kernel:
    """One robot. Implements `devices.surroundings.RobotAccess`.

    Args:
        options: what it is made with.
        environment: everything outside its programs; without one they have no files.
        model: the arm, if it is loaded already.
        has_network: whether programs reach the network of `environment`. If not, what they ask of a network is in the
            outputs, and what comes of it is among the inputs; faults of channels are possible then.
        on_event: receives every event when it happens, and calls `publish_event` for those that clients get. By default
            clients get all of them, but for warnings beyond their limit.
        on_end: called with `finished`, `alarm` or `stopped` when a program is over.
        probe: counts the statements of its programs.
        debugging: lets a debugger attach to its programs; then it is their probe.
        meter: ends the program phase of ticks, where a wall clock rules; work alone counts without.
        workshop: where long texts of clients are compiled, with the option `compiles_elsewhere`; here if None.

    Attributes:
        options: see above.
        model: the arm.
        profile: the firmware.
        controller: the machine.
        host: runs programs.
        on_change: receives the changes of signals instead of `on_event`, while that needs none of their events.
        popup: the message window.
        probe: see above.

    Raises:
        UsageError: an option that makes no sense.
    """

    __slots__ = (
        "_debugging",
        "_description",
        "_discrete_state",
        "_environment",
        "_events",
        "_faulty",
        "_handlers",
        "_has_happened",
        "_has_run",
        "_ignored",
        "_left",
        "_limit",
        "_observers",
        "_on_end",
        "_on_event",
        "_output",
        "_ports",
        "_posted",
        "_requests",
        "_seen",
        "_snapshots",
        "_witness",
        "_workshop",
        "controller",
        "host",
        "model",
        "on_change",
        "options",
        "popup",
        "probe",
        "profile",
    )

    def __init__(
        self,
        options: RobotOptions,
        environment: ProgramEnvironment | None = None,
        *,
        model: RobotModel | None = None,
        has_network: bool = False,
        on_event: Callable[[Event], None] | None = None,
        on_end: Callable[[str], None] | None = None,
        probe: Probe | None = None,
        debugging: Debugging | None = None,
        meter: Meter | None = None,
        workshop: Workshop | None = None,
    ) -> None:
        self.options = options
        self.probe = debugging or (default_probe() if probe is None else probe)
        self._debugging = debugging
        self._workshop = workshop
        self.model = model_of(options) if model is None else model
        self.profile = profile(options.firmware, options.controller_version)
        self.popup = PopupWindow(options.confirms_popups)
        self._witness = witness(self.probe)
        self._on_event = self._record if on_event is None else on_event
        self.on_change: Callable[[Change], None] | None = None
        self._on_end = on_end
        self._limit = WarningLimit()
        self._ignored = options.ignored
        self._observers: Observers | None = None
        """Of the program that runs, from the first thing on that one takes."""
        self._events: list[Event] = []
        self._posted: list[Input] = []
        self._output: Output | None = None
        self._has_run = False
        self._has_happened = True
        """Whether the discrete state may be another one than `_discrete_state`; see there."""
        self._seen = 0, False
        self._discrete_state: tuple[object, ...] = ()
        self._left = 0
        """Events that came after the clients had got the tick before: they get them with the next one."""
        self._description: RobotDescription | None = None
        self._ports: dict[str, Connect] = {}
        self._handlers: InputHandlers | None = None
        self._snapshots: SnapshotBuilder | None = None
        self._requests: RequestChannels | None = None
        self._faulty: FaultyChannels | None = None
        self.controller = Controller(
            self.model,
            epoch_s=options.epoch_s,
            on_event=self._event,
            on_change=self._change,
            on_observation=self._observe,
            home=None if options.joints is None else _checked_joints(self.model, options.joints),
            speed_scale=options.speed,
            contact=options.contact,
            safety=options.safety,
            plant=options.plant or self.model.plant,
            is_powered=options.power_on,
            power_times=options.power_times,
        )
        self._environment: ProgramEnvironment
        if has_network and environment is not None:
            self._environment = environment
        else:
            self._environment = self._asking_environment(environment)
        self.host = ScriptHost(
            self.controller,
            profile=self.profile,
            world=self._environment,
            seed=options.seed,
            on_end=self._program_ended,
            confirms_popups=options.confirms_popups,
            work_per_tick=options.work_per_tick,
            held_up_max_s=options.held_up_max_s,
            rpc_timeout_s=options.rpc_timeout_s,
            is_rtsi_input=_is_rtsi_input,
            probe=self.probe,
            meter=meter,
        )
        self.controller.attach(self.host)
        if not has_network:
            self._handlers = self._made_handlers(environment is not None)
        if options.first_tick:
            self.controller.leap(options.first_tick)
        start = Signals(self.controller, "schedule")
        for name, value in options.signals:
            start[name] = value
        for fault in options.faults:
            if isinstance(fault, DisturbInput):
                self.disturb(fault)
            elif has_network:
                raise UsageError(f"faults: {fault.on} is on the network, which this robot does not hold")

    def _asking_environment(self, environment: ProgramEnvironment | None) -> ProgramEnvironment:
        """Return an environment whose network is requests in the outputs, around which faults act."""
        from elitescript.devices.channels.faulty_channels import FaultyChannels
        from elitescript.environment.request_channels import RequestChannels, RequestEnvironment
        from elitescript.runtime.environment import FilesRefused

        faults = [fault for fault in self.options.faults if not isinstance(fault, DisturbInput)]
        self._requests = RequestChannels()
        self._faulty = FaultyChannels(self._requests, faults, seed=self.options.seed, say=self._note_fault)
        return RequestEnvironment(FilesRefused() if environment is None else environment.files, self._faulty)

    def _made_handlers(self, has_logs: bool) -> InputHandlers:
        from elitescript.kernel.handlers import InputHandlers

        parts = RobotParts(self.options, self.model, self.profile, self.controller, self.host, self.popup, self.probe)
        return InputHandlers(
            parts,
            self._environment,
            self._faulty,
            has_logs=has_logs,
            debugging=self._debugging,
            workshop=self._workshop,
        )

    @property
    def handlers(self) -> InputHandlers:
        """What handles inputs: programs, tasks and conversations of clients."""
        if self._handlers is None:
            self._handlers = self._made_handlers(has_logs=True)
        return self._handlers

    @property
    def description(self) -> RobotDescription:
        """What never changes about the robot."""
        if self._description is None:
            from elitescript.kernel.description import describe

            self._description = describe(self.options, self.model, self.profile)
        return self._description

    # ---------------------------------------------------------------- time

    @property
    def present_tick(self) -> int:
        """The tick that runs, or the one that runs next."""
        return self.controller.tick

    @property
    def next_tick(self) -> int:
        """Number of the tick that `tick` runs next."""
        return self.controller.tick + self._has_run

    def tick(self, inputs: Sequence[Input] = (), number: int | None = None) -> TickResult:
        """Run one tick, the next one if the present one has run.

        Args:
            inputs: what has come in since the last one, in order.
            number: of the tick, not later than `due_tick`; the next one if None.
        """
        if self._has_run:
            self.controller.leap(self.controller.tick + 1 if number is None else number)
        self.run_tick(inputs)
        return self._result()

    def tick_and_snapshot(self, inputs: Sequence[Input] = ()) -> Output:
        """Run one tick, and return what happened in it with the machine as it is then."""
        return self.tick(inputs).with_snapshot(self.snapshot())

    def run_tick(self, inputs: Sequence[Input] = ()) -> None:
        """Run all phases of the present tick; `leap` goes on from it.

        Args:
            inputs: what has come in since the last one, in order; they follow what was posted.
        """
        if self._posted:
            inputs, self._posted = [*self._posted, *inputs], []
        if inputs:
            self._has_happened = True
        self._output = None
        self._has_run = True
        if self._handlers is None and not inputs:
            self.controller.run_tick()
        else:
            self.handlers.run_tick(inputs)
        if self._debugging is not None and self._debugging.debugger is not None:
            self._debugging.debugger.after_tick()

    def due_tick(self) -> int | None:
        """Return the next tick at which anything is due; None when nothing will ever happen by itself."""
        tick, faulty = self.controller.tick, self._faulty
        if self._posted or (self._handlers is not None and self._handlers.is_waiting):
            return tick + 1
        due, arrives = self.controller.next_tick(), None if faulty is None else faulty.next_tick(tick)
        if self._debugging is not None and self._debugging.debugger is not None:
            looks = self._debugging.debugger.next_tick(tick)
            due = looks if due is None else due if looks is None else min(due, looks)
        return due if arrives is None else arrives if due is None else min(due, arrives)

    def leap(self, tick: int) -> None:
        """Go to a tick that is not later than the next one at which anything is due."""
        is_next = not self._events or tick <= self.controller.tick + 1
        self.controller.leap(tick)
        if self._has_run:
            self._has_run = False
            if self._output is None:
                # No client has taken them in the tick that has run; what happened in it may still be taken in the next.
                del self._events[: self._left if is_next else None]
            self._left = len(self._events)
            self._output = None

    @property
    def has_run(self) -> bool:
        """Whether the present tick has run, and time has not gone on from it."""
        return self._has_run

    # ---------------------------------------------------------------- ports

    def connect(self, service: str, origin: str) -> Connection:
        """Open a connection to a port of the robot, as its server sees it.

        Args:
            service: name of the port, as in `protocol.ports`.
            origin: names the client; no two clients of a port have the same.

        Raises:
            UsageError: there is no such port.
        """
        if service not in self._ports:
            from elitescript.protocol.ports import services_of

            rows = {row.name: row for row in services_of(self.description.firmware)}
            if service not in rows:
                near = did_you_mean(service, rows)
                raise UsageError(f"the robot has the ports {', '.join(rows)}, not {service!r}{near}")
            self._ports[service] = rows[service].open(self.description)
        return self._ports[service](origin)

    def post(self, inputs: Sequence[Input]) -> None:
        """Take inputs of clients for the tick that runs next."""
        self._posted += inputs

    @property
    def has_news(self) -> bool:
        """Whether there are events or replies that are in no output yet."""
        return bool(self._events or (self._handlers is not None and self._handlers.replies))

    def output(self) -> Output:
        """Return what ports give to clients.

        Once the present tick has run: its events and replies, and the machine as it is then. Before: the machine as it
        is, dated with the tick before, and nothing that happens.
        """
        if self._output is not None:
            return self._output
        snapshot = self.snapshot()
        if self._has_run:
            self._output = self._result().with_snapshot(snapshot)
            return self._output
        from elitescript.messages.outputs import Output

        before = max(self.controller.tick - 1, 0)
        robot = replace(snapshot.robot, tick=before, time_s=seconds(before))
        return Output(before, (), (), (), replace(snapshot, robot=robot))

    def _result(self) -> TickResult:
        requests = () if self._requests is None else self._requests.take()
        result = self.handlers.result(self._events, requests)
        self._events.clear()
        self._left = 0
        return result

    def snapshot(self, parts: int = ALL_PARTS) -> Snapshot:
        """Return the machine at the present tick, as ports show it.

        Args:
            parts: that are computed, as bits of `messages.snapshot_parts`. The others are those of the last snapshot
                that had them; the discrete state and `TIME` are always of the present tick.
        """
        handlers = self.handlers
        return self._snapshot_builder().picture(
            handlers.tasks.shown, self.popup.text, is_remote=handlers.is_remote, parts=parts
        )

    def ticks_ahead(self, due: int, count: int) -> range:
        """Return the ticks after the present one, `count` at most, of which `rows` knows what they will show.

        Args:
            due: the next tick at which anything is due.
            count: not negative.
        """
        controller, tick = self.controller, self.controller.tick
        if not controller.is_plant_ideal:
            # What is kept of an arm at rest has the noise of the tick in which it was computed.
            count = 0
        return range(tick + 1, min(due - 1, tick + count, controller.loads.known_until) + 1)

    def rows(self, ticks: range, parts: int) -> Iterator[Output]:
        """Yield what ticks of `ticks_ahead` give if nothing is given to the robot by then; it stays at its tick.

        Args:
            ticks: in rising order.
            parts: of their snapshots that are computed; the others are those of the last snapshot that had them.
        """
        from elitescript.messages.outputs import Output

        controller, handlers, present = self.controller, self.handlers, self.controller.tick
        # What the snapshots of ticks that run keep of the ones before must not come from later ticks.
        builder = self._snapshot_builder().copy()
        shown, popup, is_remote = handlers.tasks.shown, self.popup.text, handlers.is_remote
        try:
            for tick in ticks:
                controller.leap(tick)
                snapshot = builder.picture(shown, popup, is_remote=is_remote, parts=parts)
                yield Output(tick, (), (), (), snapshot, parts)
        finally:
            controller.leap(present)

    def discrete_state(self) -> tuple[object, ...]:
        """Return all that a snapshot shows and that does not change with time alone; see `SnapshotBuilder`.

        It is the same object while nothing happens: no event, request or input, and no end of hand guiding.
        """
        controller = self.controller
        seen = controller.requests, controller.yielding.is_guiding
        if self._has_happened or seen != self._seen:
            self._has_happened, self._seen = False, seen
            handlers = self.handlers
            state = self._snapshot_builder().discrete_state()
            self._discrete_state = (*state, handlers.tasks.shown, self.popup.text, handlers.is_remote)
        return self._discrete_state

    def _snapshot_builder(self) -> SnapshotBuilder:
        if self._snapshots is None:
            from elitescript.controller.views.snapshots import SnapshotBuilder

            self._snapshots = SnapshotBuilder(self.controller)
        return self._snapshots

    @property
    def cut(self) -> Cut:
        """How far programs came in the last tick; `WHOLE` without a meter."""
        from elitescript.messages.cut import WHOLE

        meter = self.host.scheduler.meter
        return WHOLE if meter is None else meter.cut

    @property
    def line(self) -> int:
        """Script line of the main thread; 0 while no program runs."""
        return self.controller.task.program.line

    # ---------------------------------------------------------------- `RobotAccess`

    def read(self, name: str, index: int) -> Value:
        return self.controller.read(name, index)

    def write(self, request: WriteSignal, by: str) -> None:
        self.controller.put(self.controller.tick, request, by)

    def disturb(self, request: DisturbInput | EndInputFaults) -> None:
        self.controller.put(self.controller.tick, request, "fault")

    def emit(self, event: Event) -> None:
        self.controller.emit(event)

    def channel_event(self, event: ChannelEvent) -> None:
        """Take what has happened on a channel, for the task or the program that has opened it."""
        if self._handlers is None:
            self.host.channel_event(event)
        else:
            self._handlers.channel_event(event)

    # ---------------------------------------------------------------- events

    def _program_ended(self, state: str) -> None:
        if self._on_end is not None:
            self._on_end(state)
        self.controller.task_ended(state)

    def publish_event(self, event: Event) -> None:
        """Have the clients get an event, if there are any."""
        if self._ports:
            self._events.append(event)

    def _event(self, event: Event) -> None:
        if type(event) is Warned and self._is_ignored(event):
            return
        if isinstance(event, Alarm | Warned) and event.line:
            event = self._with_node(event)
        self._has_happened = True
        if type(event) in _IN_WINDOW:
            self.popup.take(event)
            if self._observers is not None and isinstance(event, TaskStateChanged):
                self._end_observers(event)
        if type(event) in OBSERVED:
            self._observe(event)
        self.host.spend_event()
        if self._witness is not None:
            self._witness.event(event)
        self._on_event(event)
        if self._debugging is not None and self._debugging.debugger is not None:
            self._debugging.debugger.event(event)

    def _with_node(self, event: Alarm | Warned) -> Event:
        """Return an event with the node of the graphical program that runs, to which its line belongs."""
        source = self.host.source
        if source is None or not source.places or not event.thread or event.thread.startswith(SECONDARY_THREAD):
            return event
        if "#" in event.thread:
            return event  # of a text of a client, which does not run
        node = source.place(event.line)
        if not node:
            return event
        if isinstance(event, Alarm):
            return event if "node" in event.details else replace(event, details={"node": node, **event.details})
        # Reports of a run have its text, and name the node themselves.
        if self._on_event != self._record:
            return event
        return replace(event, text=said("{node}: {text}", node=node, text=event.text))

    def _change(self, change: Change) -> None:
        self._has_happened = True
        self.host.spend_event()
        if self._debugging is not None and self._debugging.debugger is not None:
            self._debugging.debugger.event(event_of(change))
        if self.on_change is not None:
            self.on_change(change)
        else:
            self._on_event(event_of(change))

    def _is_ignored(self, event: Warned) -> bool:
        """Return whether the option `ignore`, or a comment in its line, leaves a warning out."""
        if event.code and event.code in self._ignored:
            return True
        program = self.host.program
        if not event.line or program is None or event.thread.startswith(SECONDARY_THREAD):
            return False
        source = program.source
        # The whole text would take its length for each warning.
        if source is None or CHECK_MARK not in source.line(event.line):
            return False
        # Imported late: few programs have such a comment.
        from elitescript.lint.suppression import hides

        return hides(source, event.line, event.code)

    def _observe(self, seen: Event | Observation) -> None:
        """Warn of what observers find by an event or an observation."""
        if self._observers is None:
            # Imported late: in few programs anything happens that they take.
            from elitescript.findings.observing import Observers

            self._observers = Observers()
        self._tell_found(self._observers.see(seen))

    def _end_observers(self, event: TaskStateChanged) -> None:
        """Warn of what observers find at the end of the program, and forget them."""
        if event.state is TaskState.STOPPED and self._observers is not None:
            observers, self._observers = self._observers, None
            self._tell_found(observers.end(event.ending))

    def _tell_found(self, findings: list[Finding]) -> None:
        for found in findings:
            self.emit(
                Warned(
                    self.controller.tick,
                    found.text,
                    found.thread,
                    found.line,
                    found.code,
                    found.hint,
                    found.column,
                    found.severity,
                )
            )

    def _record(self, event: Event) -> None:
        """Have the clients get an event, unless it is a warning of which the program has made many."""
        if isinstance(event, Warned) and event.thread and (event.code, event.line) in self.handlers.programs.reported:
            return  # reported when the program was checked
        if isinstance(event, TaskStateChanged) and event.state is TaskState.STOPPED:
            self._events += self._limit.rest(event.tick)
        elif self._is_of_program(event) and not self._limit.takes(event):
            return
        self._events.append(event)

    def _is_of_program(self, event: Event) -> bool:
        """Return whether the running program causes an event. What clients are refused has its own limits."""
        if not isinstance(event, Warned) or not (event.line or event.thread):
            return False
        return self.controller.task_state is not TaskState.STOPPED

    def _note_fault(self, text: str) -> None:
        self.emit(DeviceNoted(self.controller.tick, "fault", text))


CHECK_MARK: Final = "check:"
"""In every text with a comment that hides findings."""
SECONDARY_THREAD: Final = "sec"
"""Begin of the name of a thread whose lines are not those of the program."""
_IN_WINDOW: Final = frozenset({Popup, TaskStateChanged})
"""Events that open or close the message window."""


def _is_rtsi_input(name: str) -> bool:
    # Few programs watch one; the others need not pay for the import.
    from elitescript.protocol.rtsi.inputs import INPUTS

    return name in INPUTS


def _checked_joints(model: RobotModel, joints: Six) -> Six:
    for value, limit in zip(joints, model.joints, strict=True):
        if not limit.q_min <= value <= limit.q_max:
            raise UsageError(f"joint {limit.name} must be in [{limit.q_min:.4f}, {limit.q_max:.4f}] rad, got {value:g}")
    return joints
