"""Properties that need no writing: they have names, which `--ensure` takes; `--chaos` asks for some by itself.

A name of a limit takes the margin that is asked for, as in `joint_range(0.05)`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from math import cos, inf, sqrt
from typing import TYPE_CHECKING, Any, Final

from elitescript.errors import UsageError, did_you_mean
from elitescript.messages.enums import SafetyMode
from elitescript.messages.events import Alarm, SignalChanged
from elitescript.messages.signals import SIGNALS
from elitescript.messages.timing import seconds, ticks_for
from elitescript.motion.limits import JOINT_NAMES
from elitescript.properties.verdicts import NOTHING, Moment, Needs, Verdict, Watch
from elitescript.records import NamedTuple
from elitescript.runtime.threads.strand import TIME_TO_GO_BY
from elitescript.sweep.chaos.drawing import is_over
from elitescript.sweep.chaos.ground import End, end_of
from elitescript.sweep.plans.plan import Disturbance, Failure, Plan

if TYPE_CHECKING:
    from elitescript.controller.safety.limits import SafetyLimits
    from elitescript.models.model import RobotModel
    from elitescript.run import Run

SAME_JOINT_RAD: Final = 1e-3
"""Joints that differ by less are the same at the end of a run, *assumed*."""

_ROUNDING: Final = 1e-9
"""What a planned motion at its limit may be beyond it."""

STUCK: Final = "R130"
_STOPPED: Final = "protective_stop"
_PUSHED: Final = "push"
NEVER_STUCK: Final = "never_stuck"
_LEFT_ON: Final = "no_output_left_on"

_FORM: Final = re.compile(r"\s*([a-z_]+)\s*(?:\(\s*([^()]*?)\s*\))?\s*")


class Situation:
    """What properties know of the run that is judged besides its record. One serves all runs of a worker.

    Args:
        model: the arm.
        safety: limits of the safety system; None without.
        plain: returns the end of the plain run of the program; None if there is none.
        plain_of: returns the end of the run that is judged, made without its disturbances.

    Attributes:
        disturbances: of the run that is judged.
    """

    __slots__ = ("_plain", "_plain_of", "disturbances", "model", "safety")

    def __init__(
        self,
        model: RobotModel,
        safety: SafetyLimits | None = None,
        plain: Callable[[], End] | None = None,
        plain_of: Callable[[], End] | None = None,
    ) -> None:
        self.model = model
        self.safety = safety
        self._plain = plain
        self._plain_of = plain_of
        self.disturbances: Sequence[Disturbance] = ()

    @property
    def plain(self) -> End | None:
        """End of the plain run of the program; None if there is none."""
        return None if self._plain is None else self._plain()

    def plain_end(self) -> End | None:
        """Return how the run that is judged ends without its disturbances; None if that is not known."""
        return self.plain if self._plain_of is None else self._plain_of()


class BuiltIn(NamedTuple):
    """One row: a property.

    Attributes:
        name: that `--ensure` takes.
        text: what holds, for people.
        unit: of its margin; empty without one.
        judge: returns the verdict on a run that is over; None for a limit.
        limit: returns what watches a run for a limit, given the margin that is asked for; None for the others.
    """

    name: str
    text: str
    unit: str = ""
    judge: Callable[[Situation, Run], Verdict] | None = None
    limit: Callable[[Situation], _Limit] | None = None


class _Limit(NamedTuple):
    """A limit: what a watch needs to see, and how far a moment is within it, with words for what is nearest to it."""

    needs: Needs
    margin: Callable[[Moment], tuple[float, str]]


class BuiltInProperty:
    """Implements `properties.verdicts.Property` for one of `BUILT_INS`."""

    __slots__ = ("_least", "_limit", "_row", "_situation", "needs", "text")

    def __init__(self, text: str, row: BuiltIn, least: float, situation: Situation) -> None:
        self.text = text
        self._row = row
        self._least = least
        self._situation = situation
        self._limit = None if row.limit is None else row.limit(situation)
        self.needs = NOTHING if self._limit is None else self._limit.needs

    def watch(self) -> Watch:
        """Return what watches one run."""
        if self._limit is not None:
            return _LimitWatch(self._limit, self._least, self._row.unit)
        assert self._row.judge is not None
        return _EndWatch(self._row.judge, self._situation, self._least)


class _EndWatch:
    """Watches nothing: the record at the end is enough."""

    __slots__ = ("_judge", "_least", "_situation")

    def __init__(self, judge: Callable[[Situation, Run], Verdict], situation: Situation, least: float) -> None:
        self._judge = judge
        self._situation = situation
        self._least = least

    def see(self, moment: Moment) -> None:
        """Take in nothing."""

    def verdict(self, run: Run, _end_tick: int) -> Verdict:
        """Return what came of it."""
        found = self._judge(self._situation, run)
        if not self._least or found.margin is None:
            return found
        margin = found.margin - self._least
        return Verdict(margin >= 0.0, margin, found.unit, found.t, found.words)


class _LimitWatch:
    """Keeps the moment that is nearest to a limit, or farthest beyond it."""

    __slots__ = ("_least", "_limit", "_margin", "_t", "_unit", "_words")

    def __init__(self, limit: _Limit, least: float, unit: str) -> None:
        self._limit = limit
        self._least = least
        self._unit = unit
        self._margin = inf
        self._t = 0.0
        self._words = ""

    def see(self, moment: Moment) -> None:
        """Take in a moment."""
        margin, words = self._limit.margin(moment)
        if margin < self._margin:
            self._margin, self._t, self._words = margin, moment.t, words

    def verdict(self, _run: Run, _end_tick: int) -> Verdict:
        """Return what came of it."""
        if self._margin == inf:
            return Verdict(True, words="there is no such limit")
        margin = self._margin - self._least
        return Verdict(margin >= -_ROUNDING, margin, self._unit, self._t, self._words)


# ---------------------------------------------------------------- ends


def _never_stuck(situation: Situation, run: Run) -> Verdict:
    plain = situation.plain
    if run.state == "stuck":
        return Verdict(False, t=run.time_s, words=f"nothing can ever happen again: {waits_of(run)}")
    if run.state != "time_limit" or plain is None or plain.state == "time_limit":
        return Verdict(True)
    words = f"it is not over after {run.time_s:g} s; without disturbances it ends after {plain.time_s:g} s"
    return Verdict(False, t=run.time_s, words=f"{words}: {waits_of(run)}")


def failure_of(text: str, verdict: Verdict, run: Run, situation: Situation | None = None) -> Failure:
    """Return why a run failed.

    Line and code are those of the alarm, or where the first thread waited; of an output that is left on, the line that
    has switched it on. The stop of a disturbance is no cause, so its code and line do not count.

    Args:
        text: the property.
        verdict: on it.
        run: the record.
        situation: what is known of the run besides; None if there were no disturbances.
    """
    disturbances = () if situation is None else situation.disturbances
    begun = [item for item in disturbances if item.at_s <= run.time_s + seconds(run.start_tick)]
    last = max(begun, key=lambda item: item.at_s).kind if begun else ""
    alarms = causes_of(run, disturbances)
    code, line = (alarms[-1].code, alarms[-1].line) if alarms else ("", 0)
    if not alarms and run.threads:
        line = run.threads[0].line
    if text == _LEFT_ON and situation is not None and (left := outputs_left_on(situation, run)):
        line = left[0].line
    return Failure(text, run.state, code, line, last, verdict.words, verdict.t, verdict.margin)


def waits_of(run: Run) -> str:
    """Return where each thread of a run that did not end by itself was, in words."""
    return "; ".join(f"{row.name} {place_of_thread(row)}" for row in run.threads)


def place_of_thread(row: Any) -> str:
    """Return where a thread was, and what it waited for but time, in words; not when it would have looked again."""
    if not row.waits_for:
        return f"was in line {row.line}"
    reason = row.waits_for.partition(", until ")[0]
    return f"waited in line {row.line}" + (f" for {reason}" if reason != TIME_TO_GO_BY else "")


def _no_alarm(situation: Situation, run: Run) -> Verdict:
    for alarm in causes_of(run, situation.disturbances):
        if alarm.code != STUCK:
            return Verdict(False, t=_time(run, alarm.tick), words=f"{alarm.class_name}: {alarm.text}")
    return Verdict(True)


def is_asked_for(alarm: Alarm, disturbances: Sequence[Disturbance]) -> bool:
    """Return whether an alarm is the stop of a disturbance, which no program can prevent.

    A protective stop lasts to the end of the run, whatever text the alarm has by then: that of an open safeguard, or of
    a program that does not begin any more.
    """
    if alarm.code != "R140":
        return False
    at_s = seconds(alarm.tick)
    return any(
        ticks_for(item.at_s) <= alarm.tick
        and (
            item.kind == _STOPPED
            or (item.kind == _PUSHED and (item.for_s is None or at_s <= item.at_s + item.for_s + 0.1))
        )
        for item in disturbances
    )


def causes_of(run: Run, disturbances: Sequence[Disturbance]) -> list[Alarm]:
    """Return the alarms of a run but for the stops of its disturbances."""
    return [alarm for alarm in run.alarms if not is_asked_for(alarm, disturbances)]


_SWITCHED: Final = frozenset(
    name for name, row in SIGNALS.items() if not row.is_input and name.endswith(("_digital_out", "_analog_out"))
)


def _no_output_left_on(situation: Situation, run: Run) -> Verdict:
    left = outputs_left_on(situation, run)
    if not left:
        return Verdict(True)
    event = left[0]
    line = f"{event.name}, switched on in line {event.line} at {_time(run, event.tick):.3f} s"
    more = f", and {len(left) - 1} more" if len(left) > 1 else ""
    return Verdict(False, t=run.time_s, words=f"{line}{more}, is on after the program has ended ({run.state})")


def outputs_left_on(situation: Situation, run: Run) -> list[SignalChanged]:
    """Return for each output that is left on after a stop the event that switched it on."""
    if run.state not in ("alarm", "stopped", "stuck"):
        return []
    usual = {} if situation.plain is None else situation.plain.outputs
    on: dict[str, SignalChanged] = {}
    for event in run.events:
        if isinstance(event, SignalChanged) and event.by == "program" and event.name.partition("[")[0] in _SWITCHED:
            if not event.value:
                on.pop(event.name, None)
            elif event.line:
                on.setdefault(event.name, event)
    return [event for name, event in on.items() if run.signals.get(name) and not usual.get(name)]


def _no_contact(_situation: Situation, run: Run) -> Verdict:
    nearest = min(run.clearances, key=lambda one: one.distance_m, default=None)
    if run.contacts:
        first = run.contacts[0]
        return Verdict(False, min(first.distance_m, -0.0), "m", first.start_s, first.text)
    if nearest is None:
        return Verdict(True, words="the world has no solids")
    words = f"{nearest.first} comes closest to {nearest.second}"
    return Verdict(True, nearest.distance_m, "m", nearest.t, words)


def _same_end(situation: Situation, run: Run) -> Verdict:
    """Compare the end with that of the plain run, if everything that went wrong is over before."""
    if situation.plain is None or not situation.disturbances:
        return Verdict(True)
    if not all(is_over(item, run.time_s) for item in situation.disturbances):
        return Verdict(True, words="not everything that went wrong was over before the end")
    found = end_of(run)
    if not differences(found, situation.plain):
        return Verdict(True)
    plain = situation.plain_end() or situation.plain
    differ = differences(found, plain)
    if not differ:
        return Verdict(True)
    return Verdict(False, t=run.time_s, words=f"it ends otherwise than without disturbances: {'; '.join(differ)}")


def differences(found: End, plain: End) -> list[str]:
    """Return how two ends differ, in words. Of a run that was cut off at its limit of time only the state counts."""
    if found.state != plain.state:
        return [f"{found.state}, not {plain.state}"]
    if found.state == "time_limit":
        return []
    words = [
        f"{name} is {found.outputs.get(name, False)}, not {plain.outputs.get(name, False)}"
        for name in sorted({*found.outputs, *plain.outputs})
        if found.outputs.get(name) != plain.outputs.get(name)
    ]
    rows = list(zip(JOINT_NAMES, found.joints, plain.joints, strict=False))
    name, joint, other = max(rows, key=lambda row: abs(row[1] - row[2]), default=("", 0.0, 0.0))
    if abs(joint - other) > SAME_JOINT_RAD:
        words.append(f"joint {name} is at {joint:.4f} rad, not at {other:.4f} rad")
    return words


def _time(run: Run, tick: int) -> float:
    return seconds(tick - run.start_tick)


# ---------------------------------------------------------------- limits


def _joint_range(situation: Situation) -> _Limit:
    ranges = list(situation.model.joint_ranges)
    bounds = None if situation.safety is None else situation.safety.normal
    if bounds is not None and bounds.q_min is not None and bounds.q_max is not None:
        own = zip(ranges, bounds.q_min, bounds.q_max, strict=True)
        ranges = [(max(low, lowest), min(high, highest)) for (low, high), lowest, highest in own]

    def margin(moment: Moment) -> tuple[float, str]:
        margins = [min(q - low, high - q) for q, (low, high) in zip(moment.q, ranges, strict=True)]
        least = min(margins)
        return least, f"joint {JOINT_NAMES[margins.index(least)]} is nearest to the end of its range"

    return _Limit(Needs(joints=True), margin)


def _joint_speed(situation: Situation) -> _Limit:
    most = [joint.qd_max for joint in situation.model.joints]
    bounds = None if situation.safety is None else situation.safety.bounds(SafetyMode.NORMAL)
    if bounds is not None and bounds.qd_max is not None:
        most = [min(pair) for pair in zip(most, bounds.qd_max, strict=True)]

    def margin(moment: Moment) -> tuple[float, str]:
        margins = [limit - abs(speed) for speed, limit in zip(moment.qd, most, strict=True)]
        least = min(margins)
        return least, f"joint {JOINT_NAMES[margins.index(least)]} is nearest to its largest speed"

    return _Limit(Needs(speeds=True), margin)


def _tcp_speed(situation: Situation) -> _Limit:
    bounds = None if situation.safety is None else situation.safety.bounds(SafetyMode.NORMAL)
    most = None if bounds is None else bounds.tcp_speed_max
    most = situation.model.max_tool_speed if most is None else most
    return _Limit(Needs(tcp_speed=True), lambda moment: (most - moment.tcp_speed, "the TCP is fastest"))


def _reach(situation: Situation) -> _Limit:
    arm = situation.model.arm
    upper, fore = abs(arm.a2), abs(arm.a3)

    def margin(moment: Moment) -> tuple[float, str]:
        # The distance from the shoulder to wrist joint 1 follows from the elbow alone.
        elbow = moment.q[2]
        stretched = sqrt(max(0.0, upper * upper + fore * fore + 2.0 * upper * fore * cos(elbow)))
        return upper + fore - stretched, "the arm is stretched most"

    return _Limit(Needs(joints=True), margin)


_ROWS: Final = (
    BuiltIn(NEVER_STUCK, "the program ends; it does not wait for ever for what does not come", judge=_never_stuck),
    BuiltIn("no_alarm", "no alarm, but that of a protective stop that was part of the disturbances", judge=_no_alarm),
    BuiltIn(
        _LEFT_ON,
        "when the program has ended by a stop or an alarm, no output is on that it has switched on, but those that are "
        "on at the end of the plain run",
        judge=_no_output_left_on,
    ),
    BuiltIn("no_contact", "nothing touches anything, where the world has solids", "m", judge=_no_contact),
    BuiltIn(
        "same_end",
        "once everything that went wrong is over, the run ends as without: state, outputs and joints",
        judge=_same_end,
    ),
    BuiltIn("joint_range", "no joint leaves its range: of the arm, and of [safety]", "rad", limit=_joint_range),
    BuiltIn("joint_speed", "no joint is faster than the arm, and [safety], allow", "rad/s", limit=_joint_speed),
    BuiltIn("tcp_speed_limit", "the TCP is not faster than [safety], or the arm, allows", "m/s", limit=_tcp_speed),
    BuiltIn("reach", "how far the arm is from being stretched", "m", limit=_reach),
)

BUILT_INS: Final[dict[str, BuiltIn]] = {row.name: row for row in _ROWS}
"""All of them by name."""

USUAL: Final = (NEVER_STUCK, "no_alarm")
"""Properties of a sweep that names none and has no chaos."""

USUAL_OF_CHAOS: Final = (*USUAL, _LEFT_ON, "no_contact", "same_end")
"""Those that chaos asks for, unless a sweep names built-in properties itself."""


def is_built_in(text: str) -> bool:
    """Return whether a text of `--ensure` is the name of a built-in property, with a margin or without."""
    found = _FORM.fullmatch(text)
    return found is not None and found[1] in BUILT_INS


def has_limit(text: str) -> bool:
    """Return whether a text of `--ensure` names a built-in property that keeps a limit, as `joint_range` does."""
    found = _FORM.fullmatch(text)
    return found is not None and found[1] in BUILT_INS and BUILT_INS[found[1]].limit is not None


def properties_of(plan: Plan) -> tuple[str, ...]:
    """Return the properties that hold or do not in each run, in their order: those of `Row.margins`.

    Those that are written, behind the usual ones if there is chaos and none of the built-in ones is written; the usual
    ones if none is.
    """
    if plan.chaos and not any(map(is_built_in, plan.ensure)):
        return (*USUAL_OF_CHAOS, *plan.ensure)
    return plan.ensure or USUAL


def built_in(text: str, situation: Situation) -> BuiltInProperty:
    """Return a built-in property.

    Args:
        text: its name; of one with a margin also that which it must have, as in `joint_range(0.05)`.
        situation: what it knows of the run.

    Raises:
        UsageError: there is no such property, or it takes no margin.
    """
    found = _FORM.fullmatch(text)
    name = "" if found is None else found[1]
    if found is None or name not in BUILT_INS:
        raise UsageError(
            f"{text}: there is no such property; there are {', '.join(BUILT_INS)}{did_you_mean(name, BUILT_INS)}"
        )
    row, least = BUILT_INS[name], 0.0
    if found[2] is not None:
        if not row.unit:
            raise UsageError(f"{text}: {name} has no margin; write {name} alone")
        try:
            least = float(found[2])
        except ValueError:
            least = inf
        if not 0.0 <= least < inf:
            raise UsageError(f"{text}: write the margin as a number in {row.unit}, as in {name}(0.05)")
    return BuiltInProperty(text, row, least, situation)
