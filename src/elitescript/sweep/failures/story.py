"""Says in plain words what happened in a run that failed: what went wrong, when, and what came of it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

from elitescript.devices.channels.faults import LINE, TABLE, is_of_input, place_of
from elitescript.messages.events import DeviceNoted, Warned
from elitescript.messages.faults import Passing
from elitescript.messages.timing import seconds
from elitescript.records import NamedTuple, record
from elitescript.sweep.chaos.applying import fault_of, in_order
from elitescript.sweep.chaos.ground import Ground
from elitescript.sweep.chaos.kinds import is_fault
from elitescript.sweep.chaos.properties import (
    NEVER_STUCK,
    STUCK,
    causes_of,
    has_limit,
    is_built_in,
    place_of_thread,
)
from elitescript.sweep.plans.plan import Choices, Disturbance, Failure

if TYPE_CHECKING:
    from elitescript.run import Run

MESSAGES_SHOWN: Final = 3
DATA_SHOWN: Final = 40
"""Bytes of a message."""

_BECAME: Final[Mapping[str, str]] = {
    "silence": "was lost",
    "drop": "was lost",
    "disconnect": "was lost: the connection was broken",
    "duplicate": "came twice",
    "corrupt": "was corrupted",
    "trickle": "came in parts of {chunk} bytes",
    "delay": "came {delay_s:g} s late",
    "wrong_reply": "was replaced by a wrong reply",
}
"""What became of a message that a fault met."""

_READ: Final[Mapping[str, str]] = {
    "inverted": "read the opposite",
    "bouncing": "bounced after each edge",
    "drifting": "drifted by {per_s:g} V/s",
    "noisy": "was noisy",
    "late": "was read {delay_s:g} s late",
}


class Moment(NamedTuple):
    """One thing that happened.

    Attributes:
        t: s since the start of the run.
        text: in words, with a small letter and without a full stop.
        line: of the program; 0 if none is concerned.
    """

    t: float
    text: str
    line: int = 0


@record
class Story:
    """What happened.

    Attributes:
        text: all of it in one sentence.
        moments: what happened, in the order of time.
        lines: for people: the sentence, then each moment with its time and the text of its line.
    """

    text: str
    moments: tuple[Moment, ...]
    lines: tuple[str, ...]

    def data(self) -> dict[str, Any]:
        """Return the story as JSON has it."""
        events = [{"t": moment.t, "line": moment.line, "text": moment.text} for moment in self.moments]
        return {"text": self.text, "moments": events}


def tell(
    choices: Choices,
    failure: Failure,
    run: Run,
    heard: Iterable[Passing] = (),
    ground: Ground | None = None,
    ends_s: float | None = None,
) -> Story:
    """Return the story of a run that failed.

    Args:
        choices: of the run.
        failure: what did not hold.
        run: its record.
        heard: what passed over its channels.
        ground: what there was to disturb, for the names of devices.
        ends_s: when the run ends if it is not cut off, s; None if it goes on for much longer.
    """
    devices = {}
    for chance in () if ground is None else ground.chances:
        if chance.place is not None and chance.place.device:
            devices[str(chance.place.on)] = chance.place.device
    messages = list(heard)
    moments: list[Moment] = []
    causes: list[str] = []
    for disturbance in in_order(choices.disturbances):
        found = _of_disturbance(disturbance, run, messages, devices)
        moments += found
        causes.append(f"at {found[0].t:.3f} s {found[0].text}")
    end = _end(failure, run, choices.disturbances, ends_s)
    moments.append(end)
    moments.sort(key=lambda moment: moment.t)
    values = ", ".join(f"{name} = {_shown(value)}" for name, value in choices.values.items())
    with_values = bool(values) and not causes
    if with_values:
        causes.append(f"with {values}")
    text = "; ".join([*causes, end.text])
    source = run.unit.source
    lines = [text[:1].upper() + text[1:] + "."]
    if values and not with_values:
        lines.append(f"Varied: {values}.")
    for moment in moments:
        lines.append(f"{moment.t:9.3f} s  {moment.text}")
        if moment.line and (words := source.line(moment.line).strip()):
            lines.append(f"{'':13}{moment.line:4}  {words}")
    return Story(text, tuple(moments), tuple(lines))


def _shown(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


# ---------------------------------------------------------------- what went wrong


def _of_disturbance(
    disturbance: Disturbance, run: Run, heard: Sequence[Passing], devices: Mapping[str, str]
) -> list[Moment]:
    """Return what a disturbance did; that it did nothing, if so."""
    start_s = seconds(run.start_tick)
    if not is_fault(disturbance.kind):
        return [Moment(disturbance.at_s - start_s, _of_stop(disturbance))]
    place = _place(disturbance.on, devices)
    if is_of_input(fault_of(disturbance)):
        return [Moment(disturbance.at_s - start_s, f"{place} {_reading(disturbance)}{_for(disturbance)}")]
    name, on = disturbance.kind, disturbance.on
    met = [one for one in heard if any(kind == name and str(its) == str(on) for kind, its in one.faults)]
    if met and name in _BECAME:
        became = _BECAME[name].format(**disturbance.settings) if name in ("delay", "trickle") else _BECAME[name]
        moments = [
            Moment(seconds(one.tick) - start_s, f"{_message(one, place)} {became}") for one in met[:MESSAGES_SHOWN]
        ]
        if len(met) > MESSAGES_SHOWN:
            more = f"{len(met) - MESSAGES_SHOWN} more messages met the same fault ({name} on {place})"
            moments.append(Moment(seconds(met[MESSAGES_SHOWN].tick) - start_s, more))
        return moments
    for event in run.events:
        if isinstance(event, DeviceNoted) and event.device == "fault" and event.text.startswith(f"{name} on "):
            return [Moment(seconds(event.tick) - start_s, f"{place}: {_effect(disturbance)}{_for(disturbance)}")]
    return [Moment(disturbance.at_s - start_s, f"{name} on {place} began, and met nothing")]


def _effect(disturbance: Disturbance) -> str:
    kind, _, _ = place_of(disturbance.on)
    return TABLE[disturbance.kind].effect(kind).text.partition(";")[0]


def _message(message: Passing, place: str) -> str:
    """Return a message in words: what it holds, and who has sent it."""
    data = message.data[:DATA_SHOWN]
    text = data.decode("ascii", "replace")
    words = repr(text) if text.isascii() and text.strip("\r\n\t").isprintable() else data.hex(" ")
    words += " ..." if len(message.data) > DATA_SHOWN else ""
    return f"what {place} sent ({words})" if message.direction == "to_robot" else f"what was sent to {place} ({words})"


def _place(on: int | str, devices: Mapping[str, str]) -> str:
    """Return a place as people call it: the device first."""
    kind, address, port = place_of(on)
    words = (
        f"port {port}" if kind == "tcp" and not address else f"the serial line {address}" if kind == LINE else str(on)
    )
    words = words if kind != LINE or isinstance(on, int) else f"the serial line {on}"
    device = devices.get(str(on), "")
    return f"{device} ({words})" if device else words


def _reading(disturbance: Disturbance) -> str:
    settings = disturbance.settings
    if disturbance.kind in ("stuck", "open_wire"):
        value = settings.get("value")
        level = "" if value is None else f" at {_level(value)}"
        return (
            f"was stuck{level}"
            if disturbance.kind == "stuck"
            else f"had an open wire{level and f', read {_level(value)}'}"
        )
    return _READ[disturbance.kind].format(**settings)


def _level(value: object) -> str:
    return {True: "high", False: "low"}.get(value, str(value)) if isinstance(value, bool) else str(value)


def _for(disturbance: Disturbance) -> str:
    return " from then on" if disturbance.for_s is None else f" for {disturbance.for_s:g} s"


def _of_stop(disturbance: Disturbance) -> str:
    for_s, settings = _for(disturbance), disturbance.settings
    words = {
        "pause": f"the task was paused{for_s}",
        "safeguard_stop": f"the safeguard was open{for_s}",
        "protective_stop": "the safety system stopped the arm",
        "reduced_mode": f"reduced mode was asked for{for_s}",
        "slider": f"the speed slider was moved to {100 * settings.get('fraction', 1.0):g} %{for_s}",
        "push": f"somebody pushed the tool with {settings.get('force_n', 0.0):g} N{for_s}",
        "early_press": f"{disturbance.on} was pressed{for_s}, before it was expected",
        "no_part": f"{disturbance.on} saw no part{for_s}",
    }
    return words[disturbance.kind]


# ---------------------------------------------------------------- what came of it


def _end(failure: Failure, run: Run, disturbances: Sequence[Disturbance], ends_s: float | None) -> Moment:
    """Return what did not hold, in words."""
    if failure.state in ("stuck", "time_limit") and run.threads and failure.expression == NEVER_STUCK:
        waits = [
            f"{'the program' if row.name == 'main' else f'thread {row.name}'} {place_of_thread(row)}"
            for row in run.threads
        ]
        end = " for ever" if ends_s is None else f" when the run was cut off; with more time it ends at {ends_s:.3f} s"
        return Moment(run.time_s, f"{' and '.join(waits)}{end}", run.threads[0].line)
    alarms = [alarm for alarm in causes_of(run, disturbances) if alarm.code != STUCK]
    if alarms and failure.code == alarms[-1].code:
        alarm = alarms[-1]
        where = f"in {run.unit.source.line_words(alarm.line)} " if alarm.line else ""
        t = seconds(alarm.tick - run.start_tick)
        text = alarm.text.partition("\n")[0]
        words = f"{where}the program ended with {alarm.code} {alarm.class_name}: {text}"
        if failure.text and failure.expression != "no_alarm" and text not in failure.text:
            words += f"; {failure.text}"
        return Moment(t, words, alarm.line)
    words = failure.text or f"{failure.expression} does not hold"
    if failure.text and not is_built_in(failure.expression):
        words = f"`{failure.expression}` does not hold: {words}"
    if failure.margin is not None and has_limit(failure.expression):
        words += f" (by {abs(failure.margin):.4g})"
    contacts = [event for event in run.events if isinstance(event, Warned) and event.code == "W273"]
    line = contacts[0].line if contacts and failure.expression == "no_contact" else failure.line
    return Moment(run.time_s if failure.t is None else failure.t, words, line)
