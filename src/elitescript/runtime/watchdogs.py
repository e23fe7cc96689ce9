"""Watchdogs on RTSI inputs: pause or stop the program when a client sends one too rarely.

Evidence: frequency, the three actions, and the end with the program are *documented* (manual, `rtsi_set_watchdog`).
*Assumed*: one tick of delay is tolerated, and the time of a pause does not count.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import ceil

from elitescript.commands.definition.context import Machine
from elitescript.errors import InvalidValueError
from elitescript.messages.events import Warned
from elitescript.messages.machine import PauseTask, StopTask
from elitescript.messages.timing import TICKS_PER_S, seconds
from elitescript.records import NamedTuple
from elitescript.said import Said, said


class Watch(NamedTuple):
    """One watched input."""

    period_ticks: int
    action: str
    """`pause` or `stop`."""


class Watchdogs:
    """The watchdogs of one program.

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
        """Watch an input from now on; the action `ignore` ends that.

        Raises:
            InvalidValueError: there is no such input.
        """
        if not self._is_input(variable):
            raise InvalidValueError(
                said("no RTSI input is called {variable!r}", variable=variable), argument="variable", value=variable
            )
        self._watches.pop(variable, None)
        if action != "ignore":
            self._watches[variable] = Watch(ceil(TICKS_PER_S / frequency_hz - 1e-9) + 1, action)
            self._last[variable] = self._machine.tick

    def clear(self) -> None:
        """End all watchdogs."""
        self._watches.clear()

    def arrived(self, variables: Iterable[str], tick: int) -> None:
        """Note inputs that a client has sent."""
        if self._watches:
            for variable in self._watches.keys() & frozenset(variables):
                self._last[variable] = tick

    def restart(self, tick: int) -> None:
        """Restart all watchdogs at a tick."""
        for variable in self._watches:
            self._last[variable] = tick

    def next_tick(self) -> int | None:
        """Return the tick of the next expiry if no input arrives; None without a watchdog."""
        if not self._watches:
            return None
        return min(self._last[name] + watch.period_ticks for name, watch in self._watches.items())

    def look(self, tick: int) -> None:
        """Pause or stop the program if an input is late, and restart the watchdogs."""
        for name, watch in self._watches.items():
            silent_ticks = tick - self._last[name]
            if silent_ticks < watch.period_ticks:
                continue
            self.restart(tick)
            is_paused = watch.action == "pause"
            what = Said("the program is paused" if is_paused else "the program is stopped")
            text = said(
                "RTSI input {name} has not come for {silent_s:g} s: {what} (rtsi_set_watchdog)",
                name=name,
                silent_s=seconds(silent_ticks),
                what=what,
            )
            self._machine.emit(Warned(tick, text))
            self._machine.request(PauseTask() if is_paused else StopTask())
            return
