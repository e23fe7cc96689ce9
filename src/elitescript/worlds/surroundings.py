"""What a robot asks of the surroundings that live in its time; `worlds.virtual` is made of this."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from elitescript.messages.events import Event
    from elitescript.messages.machine import WriteSignal
    from elitescript.messages.signals import Value
    from elitescript.runtime.world import Channels


class RobotPort(Protocol):
    """The robot as its surroundings see it."""

    def read(self, name: str, index: int) -> Value:
        """A point of the signal image."""

    def write(self, request: WriteSignal) -> None:
        """Set a point; it takes effect in the tick that is about to run."""

    def emit(self, event: Event) -> None:
        """Add to the record of what happens."""


class Surroundings:
    """Devices and wires around one robot; the base class is an empty cell without a network.

    Attributes:
        channels: the network that programs see.
    """

    channels: Channels

    def begin(self, robot: RobotPort) -> None:
        """Belong to a robot from now on."""

    def signal_changed(self, name: str, value: Value) -> None:
        """A signal of the robot has changed in the tick that runs."""

    def settle(self) -> None:
        """The tick has run: act on the signals that have changed in it."""
