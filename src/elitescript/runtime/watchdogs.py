"""Watchdogs on RTSI inputs: what happens when a client sends one less often than a program wants.

Evidence: frequency and the three actions are *documented* (manual, `rtsi_set_watchdog`), and that all watches end with
the program. That one tick of delay is forgiven, and that the time of a pause does not count, is *assumed*.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import ceil
from typing import NamedTuple

from elitescript.commands.definition.context import Machine
from elitescript.errors import InvalidValueError
from elitescript.messages.events import Warned
from elitescript.messages.machine import PauseTask, StopTask
from elitescript.messages.timing import TICKS_PER_S, seconds


class Watch(NamedTuple):
    """One watched input."""

    period_ticks: int
    action: str
    """`pause` or `stop`."""


class Watchdogs:
    """The watches of one program.

    Args:
        machine: pauses or stops the program.
        is_input: whether clients can send an input of that name.
    """

    __slots__ = ("_is_input", "_last", "_machine", "_watches")

    def __init__(self, machine: Machine, is_input: Callable[[str], bool]) -> None:
        self._machine = machine
        self._is_input = is_input
        self._watches: dict[str, Watch] = {}
        self._last: dict[str, int] = {}

    def set(self, variable: str, frequency_hz: float, action: str) -> None:
        """Watch an input from now on; the action `ignore` watches it no more.

        Raises:
            InvalidValueError: there is no such input.
        """
        if not self._is_input(variable):
            raise InvalidValueError(f"no RTSI input is called {variable!r}", argument="variable", value=variable)
        self._watches.pop(variable, None)
        if action != "ignore":
            self._watches[variable] = Watch(ceil(TICKS_PER_S / frequency_hz - 1e-9) + 1, action)
            self._last[variable] = self._machine.tick

    def clear(self) -> None:
        """The program is over."""
        self._watches.clear()

    def arrived(self, variables: Iterable[str], tick: int) -> None:
        """A client has sent these."""
        if self._watches:
            for variable in self._watches.keys() & frozenset(variables):
                self._last[variable] = tick

    def restart(self, tick: int) -> None:
        """What went by until now does not count."""
        for variable in self._watches:
            self._last[variable] = tick

    def next_tick(self) -> int | None:
        """Tick of the next expiry if nothing comes."""
        return min((self._last[name] + watch.period_ticks for name, watch in self._watches.items()), default=None)

    def look(self, tick: int) -> None:
        """Pause or stop the program if an input has not come in time; it is watched anew from this tick on."""
        for name, watch in self._watches.items():
            silent_ticks = tick - self._last[name]
            if silent_ticks < watch.period_ticks:
                continue
            self.restart(tick)
            is_paused = watch.action == "pause"
            text = f"RTSI input {name} has not come for {seconds(silent_ticks):g} s: the program is "
            text += f"{'paused' if is_paused else 'stopped'} (rtsi_set_watchdog)"
            self._machine.emit(Warned(tick, text))
            self._machine.request(PauseTask() if is_paused else StopTask())
            return
