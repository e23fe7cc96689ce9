"""Wires and clockwork of a cell: signals that depend on other signals, or on time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from elitescript.controller.signals.by_name import signal_write
from elitescript.devices.device import Device, check_number, check_text
from elitescript.devices.expressions import Expression
from elitescript.errors import UsageError
from elitescript.messages.signals import Value, parse_signal_name
from elitescript.messages.timing import ticks_for

EDGES: Final = ("both", "rising", "falling")
TIME_MAX_S: Final = 1e6


class Wire(Device):
    """A signal that follows others.

    `when` is a signal, or an expression over several: `standard_digital_out[0] and not tool_digital_in[1]`,
    `standard_analog_out[0] > 2.5`. What it comes to is known after the tick in which it changed, and reaches `then`
    `after_s` later, one control period at least. A change that comes back before it has arrived arrives all the same,
    as on a wire.

    Attributes:
        when: signal or expression.
        then: the signal that is set.
        after_s: how long it takes.
        edge: `both` follows the level; `rising` and `falling` act only when `when` becomes true, or false, and leave
            `then` as it is at the other edge.
        inverted: `then` gets the opposite.
        pulse_s: at an edge, `then` is active for so long, instead of following; 0 for no pulse.
        value: what `then` gets when it is active, if it is no digital signal: `value` or, when it is not active,
            `otherwise`. Without a value, a number that `when` comes to is passed on.
        otherwise: see there; 0 if None.

    Raises:
        UsageError: no such signal, no such expression, or settings that do not go together.

    Example:
        >>> from elitescript.testing.world import Wire, World
        >>> world = World(wires=[
        ...     Wire(when="standard_digital_out[0]", then="standard_digital_in[1]", after_s=0.3),
        ...     Wire(when="standard_digital_out[0]", then="standard_digital_in[2]", inverted=True),
        ...     Wire(when="standard_analog_out[0] > 5", then="standard_digital_in[3]", edge="rising", pulse_s=0.1),
        ...     Wire(when="standard_analog_out[0] * 0.5 + 1", then="standard_analog_in[0]"),
        ... ])
    """

    acts_as = "wire"
    when: str = ""
    then: str = ""
    after_s: float = 0.0
    edge: str = "both"
    inverted: bool = False
    pulse_s: float = 0.0
    value: Value | None = None
    otherwise: Value | None = None

    _last: Any = None

    @property
    def title(self) -> str:
        return self.name or f"wire to {self.then}"

    @property
    def driven_inputs(self) -> list[str]:
        return [self.then]

    def sets(self, name: str) -> str:
        if name != self.then:
            return ""
        state = "true" if bool(self._level()) is not self.inverted else "false"
        when = f"not ({self.when})" if self.inverted else self.when
        return f"{self.title} sets it when `{when}`, which is {state} now"

    @property
    def held_signal(self) -> str:
        return self.then if self.edge == "both" and not self.pulse_s else ""

    def check(self) -> None:
        _check_given("then", self.then)
        try:
            self._expression = Expression(self.when)
        except UsageError as error:
            raise UsageError(f"when: {error}") from None
        if not self._expression.signals:
            raise UsageError(f"when: {self.when!r} names no signal, so it never changes")
        check_text("then", self.then)
        try:
            row, _ = parse_signal_name(self.then)
        except UsageError as error:
            raise UsageError(f"then: {error}") from None
        check_number("after_s", self.after_s, 0.0, TIME_MAX_S, "s")
        check_number("pulse_s", self.pulse_s, 0.0, TIME_MAX_S, "s")
        if self.edge not in EDGES:
            raise UsageError(f"edge: must be one of {', '.join(EDGES)}, got {self.edge!r}")
        for key in ("value", "otherwise"):
            given = getattr(self, key)
            if given is not None:
                try:
                    signal_write(self.then, given)
                except UsageError as error:
                    raise UsageError(f"{key}: {error}") from None
        if self.otherwise is not None and self.value is None:
            raise UsageError("otherwise: goes with value")
        if row.kind != "bool" and self.value is None and (self.pulse_s or self.inverted):
            key = "pulse_s" if self.pulse_s else "inverted"
            raise UsageError(f"{key}: needs a value, since {self.then} is no digital signal")

    def started(self) -> None:
        for name in self._expression.signals:
            self.cell.watch(name, self._look)
        self._last = self._level()
        if self.edge == "both" and not self.pulse_s:
            # The cell was at rest before the robot's time began.
            self.cell.apply(self.then, self._given(self._last))

    def _level(self) -> Any:
        return self._expression.value(self.cell.read)

    def _look(self, _value: Value) -> None:
        level = self._level()
        if level == self._last:
            return
        has_risen = bool(level) and not bool(self._last)
        has_fallen = bool(self._last) and not bool(level)
        self._last = level
        if {"both": True, "rising": has_risen, "falling": has_fallen}[self.edge]:
            if not self.pulse_s:
                self._put(level, self.after_s)
            elif has_risen or has_fallen:
                self._put(True, self.after_s)
                self._put(False, self.after_s + self.pulse_s)

    def _put(self, level: Any, after_s: float) -> None:
        self.cell.set(self.then, self._given(level), after_s)

    def _given(self, level: Any) -> Value:
        """Return what `then` gets for a level of `when`."""
        row, _ = parse_signal_name(self.then)
        is_active = bool(level) is not self.inverted
        if self.value is not None:
            return self.value if is_active else row.default if self.otherwise is None else self.otherwise
        if row.kind == "bool":
            return is_active
        return level if isinstance(level, int | float) else 0


class Schedule(Device):
    """A signal that changes by the clock.

    Attributes:
        signal: its name.
        at: rows of time and value: at 2.0 s this value, at 5.0 s that one.
        every_s: period after which the rows begin anew; 0 if they happen once. All times are less than it.

    Raises:
        UsageError: no such signal, a value of another kind, or times that make no sense.

    Example:
        A door that opens once, and a button that is pressed every ten seconds.

        >>> from elitescript.testing.world import Schedule, World
        >>> world = World(devices=[
        ...     Schedule(signal="safeguard_stop", at=[(5.0, True), (6.5, False)]),
        ...     Schedule(signal="standard_digital_in[0]", at=[(0.0, True), (0.2, False)], every_s=10.0),
        ... ])
    """

    acts_as = "schedule"
    signal: str = ""
    at: Sequence[Sequence[Any]] = ()
    every_s: float = 0.0

    @property
    def title(self) -> str:
        return self.name or f"schedule of {self.signal}"

    def sets(self, name: str) -> str:
        if name != self.signal:
            return ""
        now_s = self._in_world().agenda.time_s
        times = [time_s for time_s, _ in self.at]
        if self.every_s:
            times = [time_s + (now_s // self.every_s + late) * self.every_s for time_s in times for late in (0, 1)]
        due = min((time_s for time_s in times if time_s > now_s), default=None)
        return f"{self.title} sets it " + ("no more" if due is None else f"next at {due:g} s")

    def check(self) -> None:
        _check_given("signal", self.signal)
        check_text("signal", self.signal)
        try:
            parse_signal_name(self.signal)
        except UsageError as error:
            raise UsageError(f"signal: {error}") from None
        check_number("every_s", self.every_s, 0.0, TIME_MAX_S, "s")
        if self.every_s and ticks_for(self.every_s) < 1:
            raise UsageError(f"every_s: must be one control period at least, got {self.every_s!r}")
        rows: Any = self.at
        if isinstance(rows, str) or not isinstance(rows, Sequence) or not rows:
            raise UsageError(f"at: write rows of time and value, such as [[2.0, true], [5.0, false]], not {rows!r}")
        before = 0.0
        for number, row in enumerate(rows, 1):
            try:
                self._check_row(row, before)
            except UsageError as error:
                raise UsageError(f"at: {error} (row {number})") from None
            before = row[0]

    def _check_row(self, row: Any, before: float) -> None:
        if isinstance(row, str) or not isinstance(row, Sequence) or len(row) != 2:
            raise UsageError(f"a row is a time and a value, such as [2.0, true], not {row!r}")
        time_s, limit = row[0], self.every_s or TIME_MAX_S
        if isinstance(time_s, bool) or not isinstance(time_s, int | float) or not 0.0 <= time_s <= limit:
            raise UsageError(f"must be in [0, {limit:g}] s, got {time_s!r}")
        if self.every_s and row[0] >= self.every_s:
            raise UsageError(f"a time must be less than every_s, {self.every_s:g} s, got {row[0]:g} s")
        if row[0] < before:
            raise UsageError(f"{row[0]:g} s is before {before:g} s of the row above; write the rows in order of time")
        signal_write(self.signal, row[1])

    def started(self) -> None:
        for time_s, value in self.at:
            if self.every_s:
                self._again(time_s, value, 0)
            else:
                self.cell.set(self.signal, value, time_s)

    def _again(self, time_s: float, value: Value, count: int) -> None:
        """Set the signal now or later, and see to the time after that."""
        agenda = self._in_world().agenda
        due = ticks_for(time_s + count * self.every_s)

        def act() -> None:
            self.cell.set(self.signal, value)
            self._again(time_s, value, count + 1)

        agenda.put(max(0, due - agenda.tick), act, self)


def _check_given(key: str, name: object) -> None:
    if name == "":
        raise UsageError(f"{key}: is missing; name a signal, such as standard_digital_in[1]")
