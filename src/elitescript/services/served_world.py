"""The virtual devices beside a served robot, in the robot's own time.

They live in the serving process. Before each tick they are asked what happens in it, after each tick they are shown its
signals. What programs ask of connections goes to them if they have the port or the line, else to the broker. Faults of
channels are not here: the robot itself has them, so that a session can be replayed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final, TypeVar

from elitescript.errors import UsageError
from elitescript.messages.events import DeviceNoted, Event, SignalChanged
from elitescript.messages.inputs import ChannelClosed, ChannelEvent, ChannelOpened, Do, Input
from elitescript.messages.machine import WriteSignal
from elitescript.messages.outputs import (
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
from elitescript.worlds.virtual.agenda import DeviceError
from elitescript.worlds.virtual.faults import Fault
from elitescript.worlds.virtual.world import World

if TYPE_CHECKING:
    from elitescript.services.station import Station

ORIGIN: Final = "world"

T = TypeVar("T")

Say = Callable[[str, bool], None]
"""Takes a text, and whether it is a problem."""

Connect = Callable[[str, str], Connection]
"""Makes a connection from the name of a port and its origin."""


def beside(station: Station, world: World) -> ServedWorld:
    """A world beside the robot of a station."""
    from elitescript.services.station import DEVICE

    def connect(service: str, origin: str) -> Connection:
        listener = station.listeners.get(service)
        if listener is None:
            raise UsageError(f"service: the robot has the ports {', '.join(station.listeners)}, not {service!r}")
        return listener.connect(origin)

    return ServedWorld(world, lambda text, is_problem: station.note(DEVICE, text, is_problem=is_problem), connect)


class ServedWorld:
    """A world beside a served robot.

    Args:
        world: its devices.
        say: takes what they have to say.
        connect: makes connections to ports of the robot.
    """

    __slots__ = ("_channels", "_connect", "_inputs", "_output", "_say", "_world")

    def __init__(self, world: World, say: Say, connect: Connect) -> None:
        self._world = world
        self._connect = connect
        self._say = say
        self._inputs: list[Input] = []
        self._output: Output | None = None
        self._channels: dict[int, int] = {}
        """Channels that lead to devices: number here, number of the robot."""
        world.on_device_failure = self._failed

    # ---------------------------------------------------------------- what the world asks

    @property
    def tick(self) -> int:
        """The last tick."""
        return 0 if self._output is None else self._output.tick

    def read(self, name: str, index: int) -> Value:
        """A point of the last picture."""
        assert self._output is not None
        return self._output.snapshot.signals[name][index]

    def write(self, request: WriteSignal) -> None:
        """Set a point in the next tick."""
        self._inputs.append(Do(ORIGIN, request))

    def connect(self, service: str, origin: str) -> Connection:
        """A connection to a port of the robot."""
        return self._connect(service, origin)

    def output(self) -> Output:
        """The last tick."""
        assert self._output is not None
        return self._output

    def post(self, inputs: Sequence[Input]) -> None:
        """Inputs for the next tick."""
        self._inputs += inputs

    def emit(self, event: Event) -> None:
        """Put what a device says into the log."""
        if isinstance(event, DeviceNoted):
            self._say(f"{event.device}: {event.text}", event.is_warning)

    def _failed(self, error: DeviceError) -> None:
        self._say(f"{error}; the device is disconnected", True)

    # ---------------------------------------------------------------- what the station asks

    def check_fault(self, fault: Fault) -> None:
        """See `World.check_fault`."""
        self._world.check_fault(fault)

    def begin(self, output: Output) -> None:
        """The robot is up."""
        self._output = output
        self._world.begin(self)

    def inputs(self, tick: int) -> list[Input]:
        """What happens in the tick that is about to run."""
        events: list[Input] = []
        nothing: Sequence[ChannelEvent] = ()
        for event in self._guarded(lambda: self._world.network.arrivals(tick), nothing):
            number = self._channels.get(event.channel)
            if number is not None:
                events.append(replace(event, channel=number))
                if isinstance(event, ChannelClosed) or (isinstance(event, ChannelOpened) and not event.is_open):
                    del self._channels[event.channel]
        inputs, self._inputs = self._inputs, []
        return inputs + events

    def take(self, output: Output) -> list[ChannelRequest]:
        """A tick has run: do what it asks of devices; return what it asks of others."""
        others = [request for request in output.requests if not self._guarded(partial(self._take, request), True)]
        self._output = output
        for event in output.events:
            if isinstance(event, SignalChanged):
                self._world.signal_changed(event.name, event.value)
        self._guarded(self._world.settle, None)
        return others

    def close_all(self) -> None:
        """The robot has gone."""
        for inner in self._channels:
            self._world.network.close(inner)
        self._channels.clear()

    def _take(self, request: ChannelRequest) -> bool:
        """Whether a request is about a device; if so it is done."""
        network = self._world.network
        match request:
            case OpenChannel(number, _, address, port):
                if network.outside is not None and network.server(address, port) is None:
                    return False
                self._channels[network.open(address, port, request.timeout_s)] = number
                return True
            case OpenLine(number, device, settings):
                if device not in network.lines:
                    return False
                self._channels[network.open_line(device, settings)] = number
                return True
        inner = next((inner for inner, number in self._channels.items() if number == request.channel), None)
        if inner is None:
            return False
        match request:
            case SendChannel(_, data):
                network.send(inner, data)
            case CreditChannel(_, size):
                network.credit(inner, size)
            case CloseChannel():
                del self._channels[inner]
                network.close(inner)
        return True

    def _guarded(self, call: Callable[[], T], otherwise: T) -> T:
        """Make a call that must not end the service."""
        try:
            return call()
        except DeviceError as error:
            self._say(str(error), True)
            return otherwise
