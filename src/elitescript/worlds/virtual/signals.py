"""The robot's signals as devices see them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from elitescript.controller.signal_view import signal_write
from elitescript.errors import UsageError
from elitescript.messages.signals import SIGNALS, Value, parse_signal_name, signal_name
from elitescript.messages.timing import ticks_for
from elitescript.worlds.surroundings import RobotPort
from elitescript.worlds.virtual.agenda import Agenda


class RobotSignals:
    """The robot's inputs, outputs and registers, by the names of `--set`.

    A signal that a program has changed is known here when the tick has run. What is set here takes effect in the tick
    that is about to run, as inputs from outside do.

    Example:
        >>> from elitescript.testing.world import Device, World
        >>> class Lamp(Device):
        ...     def started(self):
        ...         self.cell.watch("standard_digital_out[0]", lambda level: self.log(f"lamp {level}"))
        ...         self.cell.set("standard_digital_in[1]", True, after_s=0.5)
        >>> world = World(devices=[Lamp()])
    """

    __slots__ = ("_agenda", "_changes", "_listeners", "_robot", "_watchers")

    def __init__(self, agenda: Agenda) -> None:
        self._agenda = agenda
        self._robot: RobotPort | None = None
        self._watchers: dict[str, list[tuple[Callable[[Value], Any], object]]] = {}
        self._listeners: list[tuple[Callable[[str, Value], Any], object]] = []
        self._changes: list[tuple[str, Value]] = []

    @property
    def time_s(self) -> float:
        """The robot's time, in seconds since its start."""
        return self._agenda.time_s

    def read(self, name: str) -> Value:
        """The level of a signal, such as `standard_digital_out[0]`.

        Raises:
            UsageError: no such signal.
        """
        row, index = parse_signal_name(name)
        return row.default if self._robot is None else self._robot.read(row.name, index)

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
        request = signal_write(name, value)
        self._agenda.put(ticks_for(after_s), lambda: None if self._robot is None else self._robot.write(request))

    def pulse(self, name: str, duration_s: float, after_s: float = 0.0) -> None:
        """Set a digital signal, and clear it again when it has been high for so long."""
        self.set(name, True, after_s)
        self.set(name, False, after_s + duration_s)

    def watch(self, name: str, call: Callable[[Value], Any], owner: object = None) -> None:
        """Have something called with the new value whenever a signal has changed.

        Args:
            name: of the signal.
            call: takes the value.
            owner: whose code it is.

        Raises:
            UsageError: no such signal.
        """
        row, index = parse_signal_name(name)
        self._watchers.setdefault(signal_name(SIGNALS[row.name], index), []).append((call, owner))

    def listen(self, call: Callable[[str, Value], Any], owner: object = None) -> None:
        """Have something called with name and value of every signal that changes."""
        self._listeners.append((call, owner))

    # ---------------------------------------------------------------- the world's side

    def begin(self, robot: RobotPort) -> None:
        """Belong to a robot."""
        self._robot = robot

    def changed(self, name: str, value: Value) -> None:
        """A signal has changed in the tick that runs."""
        if name in self._watchers or self._listeners:
            self._changes.append((name, value))

    def settle(self) -> None:
        """Tell whoever watches what has changed, in the order in which it happened."""
        if not self._changes:
            return
        changes, self._changes = self._changes, []
        for name, value in changes:
            for call, owner in self._watchers.get(name, ()):
                self._agenda.attempt(lambda call=call, value=value: call(value), owner)  # type: ignore[misc]
            for listener, owner in self._listeners:
                self._agenda.attempt(lambda call=listener, name=name, value=value: call(name, value), owner)  # type: ignore[misc]
