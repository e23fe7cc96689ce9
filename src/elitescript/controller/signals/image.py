"""Holds the signal image: inputs, outputs, registers and flags, and outputs tied to the program.

An output has the value that was last commanded, unless its run-state choice says otherwise
(manual, `set_runstate_..._to_value`); a paused program counts as running (*assumed*). Analog channels
start in the voltage domain, tool pins 0 and 1 as outputs and 2 and 3 as inputs (*assumed*: what the
manual says of the ES series).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import inf
from typing import TYPE_CHECKING, Any, Final

from elitescript.errors import ArgumentRangeError, ScriptStateError
from elitescript.messages.enums import AnalogDomain, RunstateChoice, ToolPinMode
from elitescript.messages.machine import (
    ResetInputActions,
    SetAnalogDomain,
    SetAnalogFraction,
    SetInputAction,
    SetRunstateChoice,
    SetToolAnalogMode,
    SetToolPin,
)
from elitescript.messages.signals import (
    ANALOG_CURRENT_A,
    ANALOG_VOLTAGE_V,
    SIGNALS,
    Value,
    signal_name,
)
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.controller.signals.input_faults import InputFaults

_START: Final[Mapping[str, tuple[Value, ...]]] = {row.name: (row.default,) * row.size for row in SIGNALS.values()}
"""Levels at the start; robots share them until one changes."""
TOOL_PIN_OUT: Final = "tool_digital_out"
TOOL_PIN_IN: Final = "tool_digital_in"
_ANALOG: Final = tuple(name for name, row in SIGNALS.items() if row.has_domain)
_RANGE: Final = {
    name: (row.low, row.high) for name, row in SIGNALS.items() if row.low is not None and row.high is not None
}
_RANGE_NOW: Final = frozenset((TOOL_PIN_OUT, *_ANALOG))
"""Families for which it depends on a setting what they take."""
_FLOATS: Final = frozenset(name for name, row in SIGNALS.items() if row.kind == "float")
_DEFAULT_TOOL_PINS: Final = tuple(
    SetToolPin(index, ToolPinMode.PNP, is_enabled=True, is_output=index < 2) for index in range(4)
)
_DEFAULT_TOOL_ANALOG_MODE: Final = 3
_ENDLESS: Final = (-inf, inf)
_RANGES: Final = {AnalogDomain.CURRENT: ANALOG_CURRENT_A, AnalogDomain.VOLTAGE: ANALOG_VOLTAGE_V}
_UNITS: Final = {AnalogDomain.CURRENT: "A", AnalogDomain.VOLTAGE: "V"}
_PULLED_LOW: Final = (RunstateChoice.LOW_WHEN_STOPPED, RunstateChoice.FOLLOW)


class SignalImage:
    """All points of `messages.signals` and their settings.

    Args:
        on_change: called with family, index, value of every point that changes, and its value before.
        on_override: called with family, index and level of an output that was written to without effect, as it is tied
            to the state of the program; once for each output and program.

    Attributes:
        faults: of inputs; None before the first one.
        freedrive_inputs: inputs that are bound to hand guiding, by family and index.
        tool_pins: configuration of the digital pins of the tool.
        tool_analog_mode: function of the shared pins of the tool.
    """

    __slots__ = (
        "_domain_image",
        "_domains",
        "_image",
        "_is_running",
        "_on_change",
        "_on_override",
        "_overridden",
        "_runstate",
        "_stale",
        "_values",
        "faults",
        "freedrive_inputs",
        "tool_analog_mode",
        "tool_pins",
    )

    def __init__(
        self,
        on_change: Callable[[str, int, Value, Value], None],
        on_override: Callable[[str, int, Value], None] = lambda name, index, level: None,
    ) -> None:
        self._on_change = on_change
        self._on_override = on_override
        self._overridden: set[tuple[str, int]] = set()
        """Tied outputs for which `on_override` was called since a program started."""
        self._values: dict[str, Sequence[Value]] = dict(_START)
        self._domains: dict[tuple[str, int], AnalogDomain] = {}
        self._domain_image: dict[str, tuple[AnalogDomain, ...]] | None = None
        self._runstate: dict[tuple[str, int], RunstateChoice] = {}
        self.freedrive_inputs: set[tuple[str, int]] = set()
        self._is_running = False
        self._image = _START
        self._stale: set[str] = set()
        self.faults: InputFaults | None = None
        self.tool_pins: list[SetToolPin] = list(_DEFAULT_TOOL_PINS)
        self.tool_analog_mode = _DEFAULT_TOOL_ANALOG_MODE

    def read(self, name: str, index: int = 0) -> Value:
        """Return the level of one point."""
        return self._values[name][index]

    def physical(self, name: str, index: int) -> Value:
        """Return the level applied to an input, which a fault may hide from the robot; of other points as `read`."""
        applied = None if self.faults is None else self.faults.physical(name, index)
        return self._values[name][index] if applied is None else applied

    def highest(self, name: str, index: int) -> float:
        """Return the highest level that an analog channel can have in its domain, V or A; 1 of a digital one."""
        return _RANGES[self.domain(name, index)][1] if name in _ANALOG else 1.0

    def levels(self, name: str) -> Sequence[Value]:
        """Return the levels of one family."""
        return self._values[name]

    @property
    def image(self) -> Mapping[str, tuple[Value, ...]]:
        """Every family by name; a returned image does not change."""
        if self._stale:
            # Unchanged families stay the identical tuples, so that two images are compared quickly.
            self._image = {**self._image, **{name: tuple(self._values[name]) for name in self._stale}}
            self._stale.clear()
        return self._image

    def domain(self, name: str, index: int) -> AnalogDomain:
        """Return the domain of an analog channel."""
        return self._domains.get((name, index), AnalogDomain.VOLTAGE)

    @property
    def domain_image(self) -> Mapping[str, tuple[AnalogDomain, ...]]:
        """Domains of the channels of every analog family by name; a returned image does not change."""
        if self._domain_image is None:
            self._domain_image = {
                name: tuple([self.domain(name, index) for index in range(SIGNALS[name].size)]) for name in _ANALOG
            }
        return self._domain_image

    def is_tool_output(self, index: int) -> bool:
        """Return whether a tool pin can be driven."""
        pin = self.tool_pins[index]
        return pin.is_enabled and pin.is_output

    def tool_pin(self, index: int) -> bool:
        """Return the level of a tool pin: the driven one of an output, the applied one of an input."""
        name = TOOL_PIN_OUT if self.tool_pins[index].is_output else TOOL_PIN_IN
        return bool(self._values[name][index])

    def non_defaults(self) -> dict[str, Value]:
        """Return every point that is not at its default, under the name that `--set` takes."""
        return {
            signal_name(SIGNALS[name], index): value
            for name, levels in self.image.items()
            if levels is not _START[name]
            for index, value in enumerate(levels)
            if value != _START[name][index]
        }

    def write(self, name: str, index: int, value: Value) -> None:
        """Set one point.

        Raises:
            ScriptError: out of range, or a tool pin that is no output; nothing has changed.
        """
        low, high = _RANGE.get(name, _ENDLESS)
        if not low <= value <= high or name in _RANGE_NOW:
            self.check(name, index, value)
        if name in _FLOATS:
            value = float(value)
        if self._runstate or self.faults is not None:
            self._command(name, index, value)
        elif self._values[name][index] != value:
            self._change(name, index, value)

    def check(self, name: str, index: int, value: Value, domain: AnalogDomain | None = None) -> None:
        """Check that a point can take a value.

        Args:
            name: of the family.
            index: of the point.
            value: the new one.
            domain: of an analog channel; its present one if None.

        Raises:
            ScriptError: out of range, or a tool pin that is no output.
        """
        row = SIGNALS[name]
        if name in _ANALOG:
            _check_analog(name, index, float(value), self.domain(name, index) if domain is None else domain)
        elif name in _RANGE and not _RANGE[name][0] <= value <= _RANGE[name][1]:
            low, high = _RANGE[name]
            raise ArgumentRangeError(
                said(
                    "{signal} must be in {range}, got {value}",
                    signal=signal_name(row, index),
                    range=f"[{low:g}, {high:g}] {row.unit}".rstrip(),
                    value=value,
                ),
                value=value,
                limit=f"[{low:g}, {high:g}]",
                unit=row.unit,
            )
        if name == TOOL_PIN_OUT:
            self._check_pin(index)

    def set_analog_fraction(self, request: SetAnalogFraction) -> None:
        """Drive an analog output to a fraction of its range, clamped to [0, 1] (manual)."""
        low, high = _RANGES[self.domain(request.name, request.index)]
        fraction = min(1.0, max(0.0, request.fraction))
        self._command(request.name, request.index, low + (high - low) * fraction)

    def set_analog_domain(self, request: SetAnalogDomain) -> None:
        """Change the domain of a channel, which keeps its fraction of the range (*assumed*).

        An input whose level lies within the new range keeps the level.
        """
        key = (request.name, request.index)
        old_low, old_high = _RANGES[self.domain(*key)]
        low, high = _RANGES[request.domain]
        if request.domain is self.domain(*key):
            return
        self._domains[key] = request.domain
        self._domain_image = None
        is_input = SIGNALS[request.name].is_input
        level = float(self.physical(*key) if is_input else self._values[request.name][request.index])
        if is_input and low <= level <= high:
            return
        fraction = min(1.0, max(0.0, (level - old_low) / (old_high - old_low)))
        forced = self._forced(*key)
        self._store(*key, low + (high - low) * fraction if forced is None else forced)

    def set_runstate(self, request: SetRunstateChoice) -> None:
        """Tie an output to whether a program runs; takes effect at once."""
        key = (request.name, request.index)
        self._runstate[key] = request.choice
        self._follow(*key)

    def set_input_action(self, request: SetInputAction) -> None:
        """Bind hand guiding to an input, or unbind it."""
        key = (request.name, request.index)
        if request.is_freedrive:
            self.freedrive_inputs.add(key)
        else:
            self.freedrive_inputs.discard(key)

    def reset_input_actions(self, _request: ResetInputActions) -> None:
        """Unbind every input."""
        self.freedrive_inputs.clear()

    @property
    def freedrive_point(self) -> str | None:
        """Name of an input that is high and bound to hand guiding; None without one."""
        for name, index in sorted(self.freedrive_inputs):
            if self.read(name, index):
                return signal_name(SIGNALS[name], index)
        return None

    def set_tool_pin(self, request: SetToolPin) -> None:
        """Configure one digital pin of the tool."""
        self.tool_pins[request.index] = request

    def set_tool_analog_mode(self, request: SetToolAnalogMode) -> None:
        """Set the function of the tool's shared pins."""
        self.tool_analog_mode = request.mode

    def set_running(self, is_running: bool) -> None:
        """Set whether a program runs; outputs that are tied to it follow."""
        self._is_running = is_running
        if is_running:
            self._overridden.clear()
        for key in self._runstate:
            self._follow(*key)

    def _check_pin(self, index: int) -> None:
        if self.is_tool_output(index):
            return
        pin = self.tool_pins[index]
        what = "is an input" if pin.is_enabled else "is disabled"
        raise ScriptStateError(
            said("I/O type error: tool pin {index} {what}", index=index, what=what),
            code="R122",
            value=index,
            hint=said(
                "set_tool_digital_io_config({index}, {mode}, True, True) makes it an output",
                index=index,
                mode=int(pin.mode),
            ),
        )

    def _command(self, name: str, index: int, value: Value) -> None:
        forced = self._forced(name, index)
        if forced is None:
            self._store(name, index, value)
        elif forced != value and (name, index) not in self._overridden:
            self._overridden.add((name, index))
            self._on_override(name, index, forced)

    def _follow(self, name: str, index: int) -> None:
        forced = self._forced(name, index)
        if forced is not None:
            self._store(name, index, forced)

    def _forced(self, name: str, index: int) -> Value | None:
        """Return the level of an output tied to the state of the program; None if it can be written now."""
        choice = self._runstate.get((name, index), RunstateChoice.KEEP)
        if choice is RunstateChoice.KEEP or (self._is_running and choice is not RunstateChoice.FOLLOW):
            return None
        return self._extreme(name, index, int(self._is_running or choice not in _PULLED_LOW))

    def _extreme(self, name: str, index: int, side: int) -> Value:
        if SIGNALS[name].kind == "bool":
            return bool(side)
        return _RANGES[self.domain(name, index)][side]

    def _store(self, name: str, index: int, value: Value) -> None:
        if self.faults is None or not self.faults.take(name, index, value):
            self.show(name, index, value)

    def show(self, name: str, index: int, value: Value) -> None:
        """Set the level that a point reads, whatever is applied to it."""
        if self._values[name][index] != value:
            self._change(name, index, value)

    def _change(self, name: str, index: int, value: Value) -> None:
        values = self._values[name]
        if not isinstance(values, list):
            values = self._values[name] = list(values)
        before = values[index]
        values[index] = value
        self._stale.add(name)
        self._on_change(name, index, value, before)


def _check_analog(name: str, index: int, value: float, domain: AnalogDomain) -> None:
    _, high = _RANGES[domain]
    if not 0.0 <= value <= high:
        raise ArgumentRangeError(
            said(
                "{signal} must be in [0, {high:g}] {units} ({domain} domain), got {value:g}",
                signal=signal_name(SIGNALS[name], index),
                high=high,
                units=_UNITS[domain],
                domain=domain.name.lower(),
                value=value,
            ),
            value=value,
            limit=f"[0, {high:g}]",
            unit=_UNITS[domain],
        )


SIGNAL_SETTINGS: Final[dict[type, Callable[[SignalImage, Any], None]]] = {
    SetAnalogDomain: SignalImage.set_analog_domain,
    SetAnalogFraction: SignalImage.set_analog_fraction,
    SetRunstateChoice: SignalImage.set_runstate,
    SetInputAction: SignalImage.set_input_action,
    ResetInputActions: SignalImage.reset_input_actions,
    SetToolAnalogMode: SignalImage.set_tool_analog_mode,
    SetToolPin: SignalImage.set_tool_pin,
}
"""Handlers of the requests that set how signals behave."""
