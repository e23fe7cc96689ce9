"""Watches for levels of signals that nothing can have seen: outputs within one tick, inputs between two looks."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from elitescript.controller.tasks import ProgramPort
from elitescript.messages.signals import SIGNALS, Value, signal_name
from elitescript.messages.timing import TICKS_PER_S

if TYPE_CHECKING:
    from elitescript.messages.observations import Observation

POLLING_TICKS: Final = TICKS_PER_S
"""Longest time between two looks of a line that polls an input (*assumed*)."""
LOOKS_MAX: Final = 100
"""Looks at other inputs after which the program is taken not to look at the watched ones."""

_Key = tuple[str, int]


class _Missed:
    """An input of which changes were missed: the look before and its line."""

    __slots__ = ("changes", "line", "tick")

    def __init__(self, changes: int, tick: int, line: int) -> None:
        self.changes = changes
        self.tick = tick
        self.line = line


class SignalWatch:
    """Hands what it finds to observers.

    Args:
        observe: receives the observations.
        inputs: digital inputs that have changed since the program last looked at them; while it is empty, looks need
            not be reported.
        program: returns the host of scripts.
    """

    __slots__ = ("_looks", "_missed", "_observe", "_program", "inputs")

    def __init__(
        self, observe: Callable[[Observation], None], inputs: dict[_Key, int], program: Callable[[], ProgramPort]
    ) -> None:
        self._observe = observe
        self.inputs = inputs
        self._program = program
        self._missed: dict[_Key, _Missed] = {}
        self._looks = 0

    def begin_program(self) -> None:
        """Forget what was before a program."""
        self.inputs.clear()
        self._missed.clear()

    def output_changed(self, key: _Key, known: tuple[Value, Value, int], value: Value, tick: int, line: int) -> None:
        """Take one more change of an output by the program in one tick.

        Args:
            key: family and index.
            known: level before the tick, level before this change, line that set that.
            value: the new level.
            tick: the present one.
            line: of the change.
        """
        from elitescript.messages.observations import SignalPulsed

        first, unseen, first_line = known
        program = self._program()
        self._observe(
            SignalPulsed(
                tick,
                _point(key),
                line,
                program.caller[0],
                first_line,
                unseen,
                value,
                value == first,
                program.is_cleanup(line),
            )
        )

    def input_changed(self, key: _Key) -> None:
        """Take a change of a digital input."""
        self.inputs[key] = self.inputs.get(key, 0) + 1
        self._looks = 0

    def looked(self, key: _Key, tick: int) -> None:
        """Take a look of the program at a signal, while any input is watched.

        A missed pulse counts if the same line looks again soon: it polls the input.
        """
        changes = self.inputs.pop(key, None)
        if changes is None:
            self._looks += 1
            if self._looks > LOOKS_MAX:
                self.inputs.clear()
                self._missed.clear()
            return
        missed = self._missed.pop(key, None)
        if missed is None and changes < 2:
            return
        thread, line = self._program().caller
        if missed is not None and line == missed.line and 0 < tick - missed.tick <= POLLING_TICKS:
            from elitescript.messages.observations import InputMissed

            self._observe(InputMissed(tick, _point(key), line, thread, missed.changes, tick - missed.tick))
        if changes > 1:
            self._missed[key] = _Missed(changes, tick, line)
            # The next look is wanted too, for the time between both.
            self.inputs[key] = 0


def _point(key: _Key) -> str:
    return signal_name(SIGNALS[key[0]], key[1])
