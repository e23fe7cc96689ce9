"""The robot's signals as devices see them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from elitescript.controller.signals.by_name import signal_write
from elitescript.devices.agenda import Agenda
from elitescript.devices.surroundings import RobotAccess
from elitescript.errors import UsageError
from elitescript.messages.signals import SIGNALS, Value, parse_signal_name, signal_name
from elitescript.messages.timing import ticks_for


class RobotSignals:
    """The robot's inputs, outputs and registers, by the names of `--set`.

    A signal that a program has changed is known here when the tick has run. What is set here takes effect in the tick
    that is about to run, as inputs from outside do.

    Args:
        hub: what all devices share.
        owner: the device that sees them so.

    Example:
        >>> from elitescript.testing.world import Device, World
        >>> class Lamp(Device):
        ...     def started(self):
        ...         self.cell.watch("standard_digital_out[0]", lambda level: self.log(f"lamp {level}"))
        ...         self.cell.set("standard_digital_in[1]", True, after_s=0.5)
        >>> world = World(devices=[Lamp()])
    """

    __slots__ = ("_hub", "_owner")

    def __init__(self, hub: SignalHub, owner: object = None) -> None:
        self._hub = hub
        self._owner = owner

    @property
    def time_s(self) -> float:
        """The robot's time, in seconds since its start."""
        return self._hub.agenda.time_s

    def read(self, name: str) -> Value:
        """Return the level of a signal, such as `standard_digital_out[0]`.

        Raises:
            UsageError: no such signal.
        """
        row, index = parse_signal_name(name)
        robot = self._hub.robot
        return row.default if robot is None else robot.read(row.name, index)

    def set(self, name: str, value: Value, after_s: float = 0.0) -> None:
        """Set a signal, an input above all.

        Args:
            name: of the signal.
            value: of its kind.
            after_s: from now on.

        Raises:
            UsageError: no such signal, a value of another kind, or a negative time.
        """
        if after_s < 0.0:
            raise UsageError(f"after_s must be >= 0 s, got {after_s:g}")
        request, hub = signal_write(name, value), self._hub
        by = getattr(self._owner, "acts_as", "device")
        hub.agenda.put(
            ticks_for(after_s), lambda: None if hub.robot is None else hub.robot.write(request, by), self._owner
        )

    def apply(self, name: str, value: Value) -> None:
        """Set a signal, before whatever else is to happen in the tick that is about to run."""
        robot = self._hub.robot
        if robot is not None:
            robot.write(signal_write(name, value), getattr(self._owner, "acts_as", "device"))

    def pulse(self, name: str, duration_s: float, after_s: float = 0.0) -> None:
        """Set a digital signal, and clear it again when it has been high for so long."""
        self.set(name, True, after_s)
        self.set(name, False, after_s + duration_s)

    def watch(self, name: str, call: Callable[[Value], Any]) -> None:
        """Have something called with the new value whenever a signal has changed.

        Raises:
            UsageError: no such signal.
        """
        row, index = parse_signal_name(name)
        watchers = self._hub.watchers.setdefault(signal_name(SIGNALS[row.name], index), [])
        watchers.append((call, self._owner))

    def listen(self, call: Callable[[str, Value], Any]) -> None:
        """Have something called with name and value of every signal that changes."""
        self._hub.listeners.append((call, self._owner))


class SignalHub:
    """What the signals of all devices of a world share.

    Args:
        agenda: of the world.

    Attributes:
        agenda: see above.
        robot: that has the signals; None before there is one.
        watchers: by name of the signal, calls and the devices that they belong to.
        listeners: calls for every signal.
    """

    __slots__ = ("_changes", "agenda", "listeners", "robot", "watchers")

    def __init__(self, agenda: Agenda) -> None:
        self.agenda = agenda
        self.robot: RobotAccess | None = None
        self.watchers: dict[str, list[tuple[Callable[[Value], Any], object]]] = {}
        self.listeners: list[tuple[Callable[[str, Value], Any], object]] = []
        self._changes: list[tuple[str, Value]] = []

    def changed(self, name: str, value: Value) -> None:
        """Note that a signal has changed in the tick that runs."""
        if name in self.watchers or self.listeners:
            self._changes.append((name, value))

    def settle(self) -> None:
        """Call the watchers of what has changed, in the order in which it happened."""
        if not self._changes:
            return
        changes, self._changes = self._changes, []
        for name, value in changes:
            for call, owner in self.watchers.get(name, ()):
                self.agenda.attempt(partial(call, value), owner)
            for listener, owner in self.listeners:
                self.agenda.attempt(partial(listener, name, value), owner)
