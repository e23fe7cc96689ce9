"""Gives users the signals of a controller by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from elitescript.controller.controller import Controller
from elitescript.controller.signals.by_name import signal_write
from elitescript.errors import ScriptError, UsageError
from elitescript.messages.signals import SIGNALS, Value, parse_signal_name, signal_name


class Signals(Mapping[str, Value]):
    """Maps the names of the robot's signals to their values: `robot.signals["standard_digital_in[3]"] = True`.

    Setting takes effect at once, between two ticks.

    Args:
        controller: has the signals.
        by: origin of the changes; see `events.SignalChanged.by`.
    """

    __slots__ = ("_by", "_controller")

    def __init__(self, controller: Controller, by: str = "client") -> None:
        self._controller = controller
        self._by = by

    def __getitem__(self, name: str) -> Value:
        signal, index = parse_signal_name(name)
        return self._controller.read(signal.name, index)

    def __setitem__(self, name: str, value: Value) -> None:
        try:
            self._controller.request_from(signal_write(name, value), self._by)
        except ScriptError as error:
            raise UsageError(str(error)) from error

    def __iter__(self) -> Iterator[str]:
        return (signal_name(row, index) for row in SIGNALS.values() for index in range(row.size))

    def __len__(self) -> int:
        return sum(row.size for row in SIGNALS.values())
