"""What a robot and the devices beside it ask of each other; `devices.world` is made of this."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from elitescript.messages.events import Event
    from elitescript.messages.faults import Passing
    from elitescript.messages.inputs import Input
    from elitescript.messages.machine import DisturbInput, EndInputFaults, WriteSignal
    from elitescript.messages.outputs import Output
    from elitescript.messages.signals import Value
    from elitescript.protocol.connection import Connection
    from elitescript.runtime.environment import Channels
    from elitescript.solids.cell import Cell


VIRTUAL: Final = "virtual"
REAL: Final = "real"
"""Where connections lead that no device takes: nowhere, or where the option `network` of the robot lets them."""


class RobotAccess(Protocol):
    """Lists what surroundings ask of the robot."""

    @property
    def present_tick(self) -> int:
        """The tick that runs; between two ticks the one that runs next, of a served robot the one that has run."""

    def read(self, name: str, index: int) -> Value:
        """Return a point of the signal image."""

    def write(self, request: WriteSignal, by: str) -> None:
        """Set a point; it takes effect in the tick that is about to run.

        Args:
            request: the point and its level.
            by: `device`, `wire` or `schedule`; see `events.SignalChanged.by`.
        """

    def disturb(self, request: DisturbInput | EndInputFaults) -> None:
        """Let an input read something else than what is applied to it, from the tick on that is about to run."""

    def emit(self, event: Event) -> None:
        """Add to the record of what happens."""

    def connect(self, service: str, origin: str) -> Connection:
        """Return a connection to a port of the robot, as its server sees it.

        Raises:
            UsageError: there is no such port.
        """

    @property
    def has_news(self) -> bool:
        """Whether something has happened that clients of ports have not got yet."""

    def output(self) -> Output:
        """Return what ports give to their clients: of the present tick once it has run, before of the one before it."""

    def post(self, inputs: Sequence[Input]) -> None:
        """Take what clients of ports ask for, in the tick that runs next."""


class RobotSettings:
    """What a world file has about the robot itself.

    Attributes:
        options: of the robot, by name; those that are not in the file are missing.
        signals: levels at the start.
        cell: solids beside the robot and on its flange; None if there are none.
    """

    __slots__ = ("cell", "options", "signals")

    def __init__(self) -> None:
        self.cell: Cell | None = None
        self.options: dict[str, Any] = {}
        self.signals: dict[str, Value] = {}


class Surroundings:
    """Devices and wires around one robot; the base class has none, and no network.

    Attributes:
        channels: the network that programs see.
        settings: what a world file has about the robot; None without one.
    """

    channels: Channels
    settings: RobotSettings | None = None

    @property
    def is_closed(self) -> bool:
        """Whether programs reach nothing else, whatever the options of the robot are."""
        return False

    def begin(self, robot: RobotAccess) -> None:
        """Join a robot, from now on."""

    def fault(self, kind: str, on: int | str, **settings: Any) -> None:
        """Let something go wrong on channels or at inputs from now on."""

    @property
    def input_faults(self) -> Sequence[DisturbInput]:
        """Faults of inputs that the robot has from its start."""
        return ()

    def fault_places(self) -> Sequence[tuple[str, str, str]]:
        """Return what can have faults: each place, its kind in the table of faults, and the device there."""
        return ()

    def check_fault(self, fault: Any) -> Any:
        """Refuse a fault that makes no sense here, else return it with the place that it means.

        Raises:
            UsageError: it makes no sense.
        """
        return fault

    def has_server(self, address: str, port: int) -> bool:
        """Return whether a device is at an address and port."""
        return False

    def has_line(self, device: str) -> bool:
        """Return whether a device is on a serial line."""
        return False

    def hear(self, listener: Callable[[Passing], Any]) -> None:
        """Have a function called with each message that passes between programs and devices, from now on."""

    def faults_so_far(self) -> Sequence[tuple[str, str]]:
        """Return place and kind of every fault that has been asked for."""
        return ()

    def lead_outside(self, channels: Channels) -> None:
        """Let what is not declared here be reached through other channels."""

    def signal_changed(self, name: str, value: Value) -> None:
        """Note that a signal of the robot has changed in the tick that runs."""

    def setters(self, name: str) -> list[str] | None:
        """Return which devices set a signal, as sentences without subject; None if one may that does not say so."""
        return []

    def title_at(self, kind: str, where: str) -> str:
        """Return how the device at the other end of a channel is called; empty if there is none.

        Args:
            kind: of the channel.
            where: address and port, or the serial line.
        """
        return ""

    def next_tick(self, tick: int) -> int | None:
        """Return the next tick after `tick` at which a device does something."""
        return None

    def settle(self) -> None:
        """Act on the signals that have changed in the tick that has run."""

    def run_ended(self) -> None:
        """Report what is incomplete after a run whose bytes have all arrived."""
