"""The virtual devices beside a served robot, in the robot's own time.

They live in the serving process. Before each tick they give its inputs, after each tick they get its signals. What
programs ask of connections goes to them if they have the port or the line, else to the broker. Faults of channels and
inputs are not here: the robot itself has them, so that a session can be replayed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Final, TypeVar

from elitescript.devices.agenda import DeviceError
from elitescript.devices.channels.faults import Fault
from elitescript.devices.world import World
from elitescript.messages.enums import ChannelError
from elitescript.messages.events import DeviceNoted, Event, SignalChanged
from elitescript.messages.inputs import WORLD, ChannelClosed, ChannelCredit, ChannelEvent, ChannelOpened, Do, Input
from elitescript.messages.machine import DisturbInput, EndInputFaults, WriteSignal
from elitescript.messages.outputs import (
    CHANNEL_WINDOW,
    ChannelRequest,
    CloseChannel,
    CreditChannel,
    OpenChannel,
    OpenLine,
    Output,
    SendChannel,
)
from elitescript.messages.signals import Value
from elitescript.protocol.connection import Connection
from elitescript.records import replace
from elitescript.runtime.probe import default_probe, witness
from elitescript.services.log import DEVICE, ServerLog

CHANNELS_MAX: Final = 64
"""Channels that may lead to devices at a time."""
UNSENT_MAX: Final = 4 * CHANNEL_WINDOW
"""Bytes that may be on their way to a device; within the window of a channel there are fewer."""

T = TypeVar("T")

Connect = Callable[[str, str], Connection]
"""Makes a connection from the name of a port and its origin."""


class _Lead:
    """A channel between the robot and a device."""

    __slots__ = ("inner", "number", "unsent")

    def __init__(self, number: int, inner: int) -> None:
        self.number = number
        """Of the robot."""
        self.inner = inner
        """Of the virtual network."""
        self.unsent = 0
        """Bytes that the device does not have yet."""


class ServedDevices:
    """Connects a served robot with virtual devices.

    Requests of the robot are not trusted: it has a bounded number of channels, and of bytes on their way.

    Args:
        world: its devices.
        log: takes what they write.
    """

    __slots__ = ("_by_inner", "_connect", "_inputs", "_leads", "_log", "_output", "_refusals", "_world")

    def __init__(self, world: World, log: ServerLog) -> None:
        self._world = world
        self._log = log
        self._connect: Connect
        self._inputs: list[Input] = []
        self._output: Output | None = None
        self._leads: dict[int, _Lead] = {}
        """By the number of the robot."""
        self._by_inner: dict[int, _Lead] = {}
        """The same by the number of the network."""
        self._refusals: list[Input] = []
        world.on_device_failure = self._failed

    # ---------------------------------------------------------------- called by devices

    @property
    def present_tick(self) -> int:
        """The last tick."""
        return 0 if self._output is None else self._output.tick

    def read(self, name: str, index: int) -> Value:
        """Return a point of the signal table, after the last tick."""
        assert self._output is not None
        return self._output.snapshot.signals[name][index]

    def write(self, request: WriteSignal, by: str) -> None:
        """Set a point in the next tick."""
        self._inputs.append(Do(f"{WORLD}:{by}", request))

    def disturb(self, request: DisturbInput | EndInputFaults) -> None:
        """Let an input read something else from the next tick on."""
        self._inputs.append(Do(f"{WORLD}:fault", request))

    def connect(self, service: str, origin: str) -> Connection:
        """Make a connection to a port of the robot."""
        return self._connect(service, origin)

    @property
    def has_news(self) -> bool:
        """Whether something has happened in the last tick."""
        return bool(self.output().events or self.output().replies)

    def output(self) -> Output:
        """Return the output of the last tick."""
        assert self._output is not None
        return self._output

    def post(self, inputs: Sequence[Input]) -> None:
        """Take inputs for the next tick."""
        self._inputs += inputs

    def emit(self, event: Event) -> None:
        """Write a note of a device into the log."""
        if isinstance(event, DeviceNoted):
            self._say(f"{event.device}: {event.text}", event.is_warning)

    def _failed(self, error: DeviceError) -> None:
        self._say(f"{error}; the device is disconnected", True)

    # ---------------------------------------------------------------- called by the robot server

    def check_fault(self, fault: Fault) -> Fault:
        """See `World.check_fault`; take note that the robot gets this fault."""
        checked = self._world.check_fault(fault)
        if (observing := witness(default_probe())) is not None:
            observing.faults((), [(str(checked.on), checked.kind)])
        return checked

    def begin(self, output: Output, connect: Connect) -> None:
        """Begin beside a robot that is up.

        Args:
            output: of its first tick.
            connect: makes connections to its ports.
        """
        self._output = output
        self._connect = connect
        self._world.begin(self)
        if (observing := witness(default_probe())) is not None:
            observing.faults(self._world.fault_places(), self._world.faults_so_far())

    def reads(self, tick: int) -> int:
        """Return the parts of the snapshot of a tick that devices read at ports of the robot, as bits."""
        return self._world.reads(tick)

    def next_tick(self, tick: int) -> int | None:
        """Return the next tick after `tick` that must run for a device; None if none must."""
        if self._inputs or self._refusals or self._world.reads(tick + 1):
            return tick + 1
        return self._world.network.next_tick(tick)

    def pass_over(self, output: Output) -> None:
        """Take the output of a tick in which nothing has happened."""
        self._output = output

    def inputs(self, tick: int) -> list[Input]:
        """Return what happens in the tick that is about to run."""
        events, self._refusals = self._refusals, []
        nothing: Sequence[ChannelEvent] = ()
        for event in self._guarded(lambda: self._world.network.arrivals(tick), nothing):
            lead = self._by_inner.get(event.channel)
            if lead is None:
                continue
            if isinstance(event, ChannelCredit):
                lead.unsent -= event.size
            elif isinstance(event, ChannelClosed) or (isinstance(event, ChannelOpened) and not event.is_open):
                self._forget(lead)
            events.append(replace(event, channel=lead.number))
        inputs, self._inputs = self._inputs, []
        return inputs + events

    def take(self, output: Output) -> list[ChannelRequest]:
        """Carry out what a tick asks of devices; return what it asks of others."""
        others = [request for request in output.requests if not self._guarded(partial(self._take, request), True)]
        self._output = output
        for event in output.events:
            if isinstance(event, SignalChanged):
                self._world.signal_changed(event.name, event.value)
        self._guarded(self._world.settle, None)
        return others

    def close_all(self) -> None:
        """Close every channel: the robot has gone."""
        for lead in list(self._leads.values()):
            self._close(lead)

    def _say(self, text: str, is_problem: bool) -> None:
        self._log.note(DEVICE, text, is_problem=is_problem)

    def _take(self, request: ChannelRequest) -> bool:
        """Carry a request out if it is about a device; return whether it is."""
        network = self._world.network
        match request:
            case OpenChannel(number, _, address, port):
                if not self._world.is_closed and network.server(address, port) is None:
                    return False
                if self._has_room(number):
                    self._lead(number, network.open(address, port, request.timeout_s))
                return True
            case OpenLine(number, device, settings):
                if device not in network.lines:
                    return False
                if self._has_room(number):
                    self._lead(number, network.open_line(device, settings))
                return True
        lead = self._leads.get(request.channel)
        if lead is None:
            return False
        match request:
            case SendChannel(_, data):
                self._send(lead, data)
            case CreditChannel(_, size):
                network.credit(lead.inner, min(max(size, 0), CHANNEL_WINDOW))
            case CloseChannel():
                self._close(lead)
        return True

    def _has_room(self, number: int) -> bool:
        """Return whether a channel may be opened; if not, the robot gets the reason."""
        if number not in self._leads and len(self._leads) < CHANNELS_MAX:
            return True
        why = f"channel {number} is in use" if number in self._leads else f"{CHANNELS_MAX} connections are open"
        self._refusals.append(ChannelOpened(number, False, why))
        return False

    def _lead(self, number: int, inner: int) -> None:
        self._leads[number] = self._by_inner[inner] = _Lead(number, inner)

    def _send(self, lead: _Lead, data: bytes) -> None:
        lead.unsent += len(data)
        if lead.unsent <= UNSENT_MAX:
            self._world.network.send(lead.inner, data)
            return
        self._close(lead)
        why = f"{UNSENT_MAX} bytes wait for a device that is not so quick"
        self._refusals.append(ChannelClosed(lead.number, why, ChannelError.OTHER))

    def _close(self, lead: _Lead) -> None:
        self._forget(lead)
        self._world.network.close(lead.inner)

    def _forget(self, lead: _Lead) -> None:
        del self._leads[lead.number], self._by_inner[lead.inner]

    def _guarded(self, call: Callable[[], T], otherwise: T) -> T:
        """Make a call that must not end the service."""
        try:
            return call()
        except DeviceError as error:
            self._say(str(error), True)
            return otherwise
