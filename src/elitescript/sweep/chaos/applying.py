"""Lets disturbances happen to a robot in virtual time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

from elitescript.controller.signals.by_name import signal_write
from elitescript.devices.channels.faults import DIGITAL, Fault, fault_from, is_of_input, place_of
from elitescript.errors import UsageError, did_you_mean
from elitescript.messages.machine import AskSafety, MachineRequest, PauseTask, ResumeTask, SetSpeedScale
from elitescript.messages.timing import ticks_for
from elitescript.sweep.chaos.kinds import KINDS, PLACED, is_fault
from elitescript.sweep.plans.plan import Disturbance

if TYPE_CHECKING:
    from elitescript.robot import VirtualRobot

BY: Final = "client"
"""`SignalChanged.by` of what stops and people do."""

TIME_MAX_S: Final = 1e9

STOP_REASON: Final = "chaos: a protective stop"

_LIMITS: Final = {"fraction": (0.0, 1.0), "force_n": (-1000.0, 1000.0), "axis": (0, 2)}
_TAKES: Final[dict[str, tuple[str, ...]]] = {"slider": ("fraction",), "push": ("force_n", "axis")}
"""Settings of stops and people besides place and times."""


def apply(robot: VirtualRobot, disturbances: Iterable[Disturbance]) -> None:
    """Let disturbances happen in the next run of a robot whose time has not begun.

    Raises:
        UsageError: one makes no sense there; the text begins with its number, from 1.
    """
    ordered = in_order(disturbances)
    for number, disturbance in enumerate(ordered, 1):
        try:
            _apply(robot, check(disturbance), ordered)
        except UsageError as error:
            raise UsageError(f"disturbance {number}: {error}") from None


def in_order(disturbances: Iterable[Disturbance]) -> tuple[Disturbance, ...]:
    """Return disturbances in the order of time; what faults draw depends on their order."""
    return tuple(sorted(disturbances, key=lambda item: (item.at_s, item.kind, str(item.on))))


def check(disturbance: Disturbance) -> Disturbance:
    """Refuse a disturbance that makes no sense anywhere, else return it.

    Raises:
        UsageError: it makes no sense; the text begins with the setting.
    """
    if disturbance.kind not in KINDS and not is_fault(disturbance.kind):
        near = did_you_mean(disturbance.kind, KINDS)
        raise UsageError(f"kind: there is no {disturbance.kind!r}; there are {', '.join(KINDS)}{near}")
    if is_fault(disturbance.kind):
        fault_of(disturbance)
        return disturbance
    kind = disturbance.kind
    times: dict[str, Any] = {"at_s": disturbance.at_s, "for_s": disturbance.for_s or 0.0}
    for name, time_s in times.items():
        if isinstance(time_s, bool) or not isinstance(time_s, int | float) or not 0.0 <= time_s <= TIME_MAX_S:
            raise UsageError(f"{name}: must be a number in [0, {TIME_MAX_S:g}] s, got {time_s!r}")
    if kind == "protective_stop" and disturbance.for_s is not None:
        raise UsageError("for_s: a protective stop ends the program, so it has no duration")
    if (disturbance.on != "") is not (kind in PLACED):
        raise UsageError("on: is missing; name an input" if kind in PLACED else f"on: {kind} has no place")
    if kind in PLACED and place_of(disturbance.on)[0] != DIGITAL:
        raise UsageError(f"on: {kind} is at a digital input, not at {disturbance.on!r}")
    takes = _TAKES.get(kind, ())
    for name, value in disturbance.settings.items():
        if name not in takes:
            there = f"; it has {', '.join(takes)}" if takes else ""
            raise UsageError(f"{name}: {kind} has no such setting{there}")
        low, high = _LIMITS[name]
        is_whole = isinstance(low, int)
        if (
            isinstance(value, bool)
            or not isinstance(value, int if is_whole else int | float)
            or not low <= value <= high
        ):
            raise UsageError(f"{name}: must be in [{low:g}, {high:g}], got {value!r}")
    for name in takes:
        if name not in disturbance.settings:
            raise UsageError(f"{name}: is missing")
    return disturbance


def fault_of(disturbance: Disturbance) -> Fault:
    """Return a disturbance that is a fault as the world takes it.

    Raises:
        UsageError: it makes no sense.
    """
    return fault_from(settings_of(disturbance))


def settings_of(disturbance: Disturbance) -> dict[str, Any]:
    """Return a disturbance as a row of a TOML file."""
    row: dict[str, Any] = {"kind": disturbance.kind}
    if disturbance.on != "":
        row["on"] = disturbance.on
    row["at_s"] = disturbance.at_s
    if disturbance.for_s is not None:
        row["for_s"] = disturbance.for_s
    return row | dict(disturbance.settings)


def disturbance_of(row: Mapping[str, Any]) -> Disturbance:
    """Return the disturbance of a row of a TOML file; `check` looks at it."""
    settings = {name: value for name, value in row.items() if name not in ("kind", "on", "at_s", "for_s")}
    return Disturbance(row.get("kind", ""), row.get("on", ""), row.get("at_s", 0.0), row.get("for_s"), settings)


def _apply(robot: VirtualRobot, disturbance: Disturbance, others: Sequence[Disturbance]) -> None:
    if is_fault(disturbance.kind):
        _add_fault(robot, fault_of(disturbance))
        return
    if disturbance.kind in PLACED:
        value = disturbance.kind == "early_press"
        _add_fault(robot, Fault("stuck", disturbance.on, disturbance.at_s, disturbance.for_s, value=value))
        return
    begin, end = _REQUESTS[disturbance.kind](robot, disturbance.settings)
    at = ticks_for(disturbance.at_s)
    robot.controller.put(at, begin, BY)
    if end is not None and disturbance.for_s is not None:
        end_tick = _end_tick(disturbance)
        robot.controller.put(_resume_tick(end_tick, others) if disturbance.kind == "pause" else end_tick, end, BY)


def _end_tick(disturbance: Disturbance) -> int:
    return ticks_for(disturbance.at_s) + max(1, ticks_for(disturbance.for_s or 0.0))


def _resume_tick(tick: int, others: Sequence[Disturbance]) -> int:
    """Return when the task can be resumed that is to be resumed at a tick: not while the safeguard is open."""
    for other in others:
        # They are in the order of time, so one that is open later cannot have been passed.
        if other.kind == "safeguard_stop" and ticks_for(other.at_s) <= tick <= _end_tick(other):
            tick = _end_tick(other) + 1
    return tick


def _add_fault(robot: VirtualRobot, fault: Fault) -> None:
    from elitescript.records import fields_of

    plain = {name: row.default for name, row in fields_of(Fault).items()}
    settings = {name: getattr(fault, name) for name in plain if name not in ("kind", "on")}
    if is_of_input(fault) and robot.surroundings is None:
        # There is no world whose seed would be taken.
        settings["seed"] = robot.options.seed if fault.seed is None and fault.kind in ("bouncing", "noisy") else None
    robot.fault(fault.kind, fault.on, **{name: value for name, value in settings.items() if value != plain[name]})


_Requests = tuple[MachineRequest, MachineRequest | None]


def _pause(_robot: VirtualRobot, _settings: Mapping[str, Any]) -> _Requests:
    return PauseTask(), ResumeTask()


def _safeguard(_robot: VirtualRobot, _settings: Mapping[str, Any]) -> _Requests:
    return signal_write("safeguard_stop", True), signal_write("safeguard_stop", False)


def _reduced(_robot: VirtualRobot, _settings: Mapping[str, Any]) -> _Requests:
    return signal_write("reduced_mode", True), signal_write("reduced_mode", False)


def _stop(_robot: VirtualRobot, _settings: Mapping[str, Any]) -> _Requests:
    return AskSafety("stop_protectively", STOP_REASON), None


def _slider(robot: VirtualRobot, settings: Mapping[str, Any]) -> _Requests:
    return SetSpeedScale(float(settings["fraction"])), SetSpeedScale(robot.options.speed)


def _push(_robot: VirtualRobot, settings: Mapping[str, Any]) -> _Requests:
    name = f"external_wrench[{settings['axis']}]"
    return signal_write(name, float(settings["force_n"])), signal_write(name, 0.0)


_REQUESTS: Final = {
    "pause": _pause,
    "safeguard_stop": _safeguard,
    "reduced_mode": _reduced,
    "protective_stop": _stop,
    "slider": _slider,
    "push": _push,
}
