"""Runs a program beside one that runs on a controller, and compares both as far as they are known.

The simulated robot stays behind the controller: it runs a tick when everything that came from outside until then is
known. Where it makes a mark, a line or an edge of an output, that the other program has not made yet, it waits there;
so inputs come to it where they belong in the program, however late the controller is. Both are compared from the last
mark on that they have in common, and nothing before it is kept.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any, Final

from elitescript.audit.alignment import Follower, Match, matched
from elitescript.audit.differences import Comparer, Finding
from elitescript.audit.inputs import Arrival
from elitescript.audit.live_inputs import LiveInputs, Values
from elitescript.audit.live_series import Window
from elitescript.audit.motion import Tolerance
from elitescript.audit.series import LINE, SCALING, SLIDER, STANDS_RAD_S, STATE, Mark, edges_of
from elitescript.audit.simulation import Cell, started_robot
from elitescript.client.rtsi_signals import POINTS, levels_of
from elitescript.controller.views.trace import Trace, TraceRow
from elitescript.controller.views.trace_signals import NO_SIGNALS, TraceSignals
from elitescript.messages.enums import TaskState
from elitescript.messages.machine import SetPayload
from elitescript.messages.motion import Six
from elitescript.messages.signals import Value
from elitescript.messages.state import Payload
from elitescript.messages.timing import PERIOD_S, TICKS_PER_S
from elitescript.protocol.binary import WireValue
from elitescript.records import record, replace

SETTLE_S: Final = 0.4
"""So long a difference has lasted before it is said, so that its cause shows (*assumed*)."""
GIVEN_UP_S: Final = 10.0
"""After so long without a mark in common the program is begun anew beside the other one (*assumed*)."""
_MARGIN_S: Final = 4 * PERIOD_S
"""So far the simulated robot stays behind at least: what an input comes from may show so much later."""
_YOUNG_S: Final = 0.1
"""So long a mark of the controller may be the first of several that belong together."""
_WINDOW_S: Final = 2.0
_KEPT_S: Final = 1.0
"""A piece longer than the first is cut so that the second is left."""
_MOTION: Final = frozenset({"target", "speed", "acceleration", "blend", "speed scaling", "slider", "waiting", ""})
"""Causes that may follow from an arm that began elsewhere."""
_MARKS: Final = frozenset({"waiting", "program", "signal"})
"""Causes that are seen by marks alone."""
_LIVE_WORDS: Final = (("the recording", "the controller"), ("the recorded program", "the controller's program"))
"""Words of comparisons with a recording, and those for a run that goes on."""
_PAYLOAD_SAME: Final = 1e-6
_SLEEPS: Final = "sleep"


@record
class Expected:
    """What a controller should be like.

    Attributes:
        cell: program, arm and world.
        tolerance: what does not count.
        speed: slider, 0 to 1.
        payload: at the begin of a run; None for what the controller has then.
        wait_s: so long a program may wait in one place.
    """

    cell: Cell
    tolerance: Tolerance
    speed: float = 1.0
    payload: Payload | None = None
    wait_s: float = 30.0


class LiveRun:
    """One run of a program on a controller, with the simulated one beside it.

    Args:
        expected: what is simulated.
        t: time of the controller at the first row, s.
        values: of that row.
        facts: of the controller.
        is_joined: whether the program ran already; then nothing is compared before a mark in common, and what is found
            may come from values of its variables.
        late_s: so much before the first row the program may have begun.

    Attributes:
        is_doubtful: whether the simulated program may have other values than the controller's, without a difference
            that was seen.
        begin_s: time of the controller at the begin.
        is_together: whether both have a mark in common.
        is_lost: whether they have had none for so long that the program should be begun anew.
        is_done: whether the program is over, and everything is compared.
        notes: what is not a difference; whoever reads them takes them out.
        exception: that ended the program on the controller, in words; empty if none did.
    """

    def __init__(
        self,
        expected: Expected,
        t: float,
        values: Values,
        facts: Mapping[str, Any],
        *,
        is_joined: bool,
        late_s: float = 0.0,
    ) -> None:
        cell = expected.cell
        self._expected = expected
        self._is_joined = self.is_doubtful = is_joined
        self.begin_s = t
        self.notes: list[str] = []
        self.exception = ""
        self.is_lost = self.is_done = False
        self.is_together = not is_joined
        signals = [name for variable, points in POINTS.items() if variable in values for name in points if name]
        driven = cell.driven() & set(signals)
        self._live_inputs = LiveInputs(driven, facts)
        inputs = self._live_inputs.begin(t, values)
        if expected.payload is not None:
            own = expected.payload
            requests = [request for request in inputs.requests if not isinstance(request, SetPayload)]
            inputs = replace(inputs, requests=(*requests, SetPayload(own.mass_kg, own.cog, own.inertia)))
        self._robot, refused = started_robot(cell, inputs)
        self.notes += [*inputs.unknown, *refused]
        self._signals = signals
        edges = edges_of(signals, driven)
        self._by_lines = LINE in values
        speeds = (SLIDER in values, SCALING in values)
        self._rec = Window(edges, by_lines=self._by_lines, has_speeds=speeds, late_s=late_s)
        self._sim = Window(edges, by_lines=self._by_lines, has_speeds=(False, False))
        self._numbers: dict[str, float] = {}
        self._others: Mapping[str, WireValue] = {}
        self._keys: list[tuple[str, Value]] = []
        """Marks of the controller behind the anchor."""
        self._key_times: list[float] = []
        self._follower = Follower(self._keys)
        self._pending: deque[Mark] = deque()
        """Marks of the simulated robot at which it is."""
        self._arrivals: deque[Arrival] = deque()
        """Not given to it yet."""
        self._given: list[Arrival] = []
        """Those in the window."""
        self._start_tick = self._anchor_tick = self._robot.tick
        self._anchor_t = 0.0
        self._shift_s = 0.0
        """Time of the simulated run less that of the controller's, at the same place of the present piece."""
        self._elapsed_s = 0.0
        """Of the present piece before the window."""
        self._is_said = False
        """Whether what goes on since the last mark in common was found to differ."""
        self._said: set[tuple[int, str, str]] = set()
        self.counts = [0, 0]
        """Differences that were said, and those that were said before."""
        self._ended_t: float | None = None
        self._known_s = 0.0
        self._targets: tuple[Six, Six] = (inputs.joints, (0.0,) * 6)
        self._levels: Mapping[str, Value] = NO_SIGNALS
        self._unsure: list[Finding] = []
        self._payload_since: float | None = None
        self._payload_said: object = None
        self._tick_of_last_row = 0
        self._still_t = 0.0
        self._still_lines: set[int] = set()
        unit = self._robot.compile(cell.source)
        trace = Trace(self._row, signals=TraceSignals(signals))
        self._run = self._robot.start(unit, presets=cell.presets, trace=trace)
        self._last_line = len(cell.source.text.splitlines())
        self._values = values
        self._put(t, values, is_first=True)

    @property
    def line(self) -> int:
        """Line of the controller's program."""
        return self._rec.lines[-1]

    @property
    def t(self) -> float:
        """Time since the begin of the newest row, s."""
        return self._known_s

    @property
    def rows_kept(self) -> int:
        """Rows of both runs that are kept."""
        return len(self._rec) + len(self._sim)

    @property
    def has_ended(self) -> bool:
        """Whether the program is over on the controller."""
        return self._ended_t is not None

    # ---------------------------------------------------------------- the controller

    def take(self, t: float, values: Values) -> None:
        """Take a row of the controller, in its time."""
        if self._ended_t is not None:
            self._known_s = t - self.begin_s
            return
        self._put(t, values, is_first=False)

    def doubt(self) -> None:
        """Note that inputs may have come that were not seen: what goes on is not compared up to the next mark."""
        self.is_doubtful = self._is_said = True

    def _put(self, t: float, values: Values, *, is_first: bool) -> None:
        elapsed_s = t - self.begin_s
        self._known_s, self._values = elapsed_s, values
        if not is_first:
            self._arrivals.extend(self._live_inputs.take(t, values))
        row = values.maps[0]
        line = int(values.get(LINE, 0))  # type: ignore[arg-type]
        q, qd = row["target_joint_positions"], row["target_joint_speeds"]
        changed = self._changed(values)
        found = self._rec.put(
            elapsed_s,
            line,
            q,  # type: ignore[arg-type]
            qd,  # type: ignore[arg-type]
            changed,
            slider=float(row.get(SLIDER, 1.0)),  # type: ignore[arg-type]
            scaling=float(row.get(SCALING, 1.0)),  # type: ignore[arg-type]
        )
        if is_first:
            self._rec.marks.insert(0, Mark(0, _BEGIN, line))
        self._keys += [mark.key for mark in found]
        self._key_times += [elapsed_s] * len(found)
        moves = max(map(abs, qd)) > STANDS_RAD_S  # type: ignore[arg-type]
        is_new = any(mark.key[0] != "line" or mark.line not in self._still_lines for mark in found)
        if moves or is_new or row.get(STATE) == TaskState.PAUSED:
            self._still_t, self._still_lines = elapsed_s, {line}
        else:
            self._still_lines.add(line)
        if row.get(STATE) == TaskState.STOPPED:
            self._ended_t = elapsed_s
            self._rec.is_open = False
            self._arrivals.extend(self._live_inputs.end())

    def _changed(self, values: Values) -> dict[str, Value]:
        """Return the signals whose variables have other values than in the row before."""
        changed: dict[str, Value] = {}
        parts = [values.maps[0]]
        if values.maps[1] is not self._others:
            self._others = values.maps[1]
            parts.append(self._others)
        for part in parts:
            for variable, number in part.items():
                if variable in POINTS and self._numbers.get(variable) != number:
                    self._numbers[variable] = number  # type: ignore[assignment]
                    changed |= levels_of(variable, number)  # type: ignore[arg-type]
        return changed

    # ---------------------------------------------------------------- the simulated robot

    def follow(self) -> None:
        """Run the simulated robot as far as everything is known."""
        robot = self._robot
        known_s = self._known_s - _MARGIN_S
        if self._ended_t is not None:
            # Nothing comes any more.
            known_s = self._ended_t + SETTLE_S
        while self._pass_marks():
            if self._run.is_over:
                self._sim.is_open = self._run.state in ("time_limit", "stuck")
                return
            t = self._anchor_t + (robot.tick - self._anchor_tick) * PERIOD_S
            if t > known_s + 0.5 * PERIOD_S:
                return
            while self._arrivals and self._arrivals[0].t <= t + 0.5 * PERIOD_S:
                arrival = self._arrivals.popleft()
                self._given.append(arrival)
                robot.controller.put(robot.tick, arrival.request, "schedule")
            robot.advance(PERIOD_S)

    def _pass_marks(self) -> bool:
        """Pass the marks at which the simulated robot is; return whether it may go on."""
        while self._pending:
            mark = self._pending[0]
            if not self._is_joined or self.is_together:
                keys = self._keys
                is_near = mark.key in keys[:2]
                is_young = not keys or self._known_s - self._key_times[0] < _YOUNG_S
                if not is_near and is_young and self._ended_t is None:
                    return False
            self._pending.popleft()
            if self._follower.take(mark.key):
                self._anchor(mark)
        return True

    def _anchor(self, mark: Mark) -> None:
        place = self._follower.place
        self._anchor_t = self._key_times[place]
        self._anchor_tick = self._tick_of_last_row
        if not self.is_together:
            self._meet(place, mark)
        # The follower has the same list.
        del self._keys[: place + 1], self._key_times[: place + 1]
        self._follower = Follower(self._keys)

    def _meet(self, place: int, mark: Mark) -> None:
        """Begin to compare at the first mark in common."""
        behind = len(self._keys) - place
        self._rec.begin_at(len(self._rec.marks) - behind)
        self._sim.begin_at(next(index for index, its in enumerate(self._sim.marks) if its is mark))
        self._begin_piece()
        self.is_together = True

    def _row(self, row: TraceRow) -> None:
        """Take a row of the simulated robot; its joints are those at the end of the tick, shown with the next one."""
        sim = self._sim
        is_first = not len(sim)
        self._tick_of_last_row = round(row.t * TICKS_PER_S)
        t = (self._tick_of_last_row - self._start_tick) * PERIOD_S
        q, qd = self._targets
        self._targets = row.q, row.qd
        changed: Mapping[str, Value] = {}
        if row.signals is not self._levels:
            self._levels = changed = row.signals
        found = sim.put(t, row.line, q, qd, changed)
        if is_first:
            sim.marks.insert(0, Mark(0, _BEGIN, row.line))
        self._pending.extend(found)

    # ---------------------------------------------------------------- comparing

    def compare(self) -> list[tuple[Finding, bool]]:
        """Return what was found to differ since the last call, times since the begin, and whether that is sure."""
        found = [*self._payload(), *self._waits()]
        if self.is_together and len(self._sim):
            found += self._compare_windows()
        elif self._known_s > GIVEN_UP_S:
            self.is_lost = True
        self._trim_unmatched()
        if self._ended_t is not None and self._known_s >= self._ended_t + SETTLE_S:
            self.is_done = True
        unsure, self._unsure = self._unsure, []
        return [(finding, not self.is_doubtful and finding not in unsure) for finding in found if self._is_new(finding)]

    def finish(self) -> list[tuple[Finding, bool]]:
        """Compare what is left, of a run of which no more is known; return what differs."""
        if self._ended_t is not None:
            self._known_s = max(self._known_s, self._ended_t + SETTLE_S)
        self.follow()
        return self.compare()

    def _is_new(self, finding: Finding) -> bool:
        subject = {"signal": finding.what.split(" ", 1)[0], "payload": finding.what}.get(finding.cause, "")
        key = (finding.line, finding.cause, subject)
        is_new = key not in self._said
        self._said.add(key)
        self.counts[0 if is_new else 1] += 1
        return is_new

    def _compare_windows(self) -> list[Finding]:
        rec, sim = self._rec, self._sim
        is_final = self._ended_t is not None and self._known_s >= self._ended_t + SETTLE_S
        keys, its_keys = ([mark.key for mark in window.marks] for window in (rec, sim))
        pairs = matched(keys, its_keys, has_end=is_final)
        if self._is_said:
            # The piece that was found to differ is left out.
            if len(pairs) < 2:
                return self._stay_apart()
            self._begin_at(pairs[1])
            pairs = [Match(first - pairs[1].first, second - pairs[1].second) for first, second in pairs[1:]]
            self._is_said = False
        if is_final and (ending := self._is_cut_off(pairs)) is not None:
            return ending
        tolerance = self._expected.tolerance
        tolerance = replace(tolerance, time_s=max(tolerance.time_s, tolerance.share * self._elapsed_s))
        comparer = Comparer(
            rec,
            sim,
            rec.marks,
            sim.marks,
            arrivals=[arrival._replace(row=bisect_left(rec.t, arrival.t - 1e-6)) for arrival in self._given],
            tolerance=tolerance,
            ending=self._ending(),
            recorded_ending=self.exception,
            is_live=not is_final,
        )
        closed_t = rec.t[rec.marks[pairs[-1].first].row]
        found: list[Finding] = []
        is_waiting = False
        for finding in comparer.compare(self._signals).findings:
            is_open = finding.t >= closed_t and not is_final
            if self._is_consequence(finding, pairs):
                self._is_said |= is_open
            elif is_open and rec.t[-1] - finding.t < SETTLE_S:
                is_waiting = True
            else:
                named = self._named(finding, pairs)
                found.append(named)
                self._is_said |= is_open
                if not is_open and finding.cause in _MARKS and any(map(rec.waited_s, range(len(rec)))):
                    # Both met again, and a mark may be among the rows that are missing.
                    self._unsure.append(named)
        if not found and not is_waiting and not self._is_joined and len(pairs) > 1:
            self.is_doubtful = False
        if not is_waiting and not is_final:
            if pairs[-1] != (0, 0):
                is_said, self._is_said = self._is_said, False
                self._begin_at(pairs[-1])
                self._is_said = is_said
            else:
                self._shorten()
        return found

    def _named(self, finding: Finding, pairs: Sequence[Match]) -> Finding:
        """Return a difference in words for a run that goes on.

        Of a program that has nothing in common with the given one so far they say that it is another.
        """
        rec, what = self._rec, finding.what
        for recorded, live in _LIVE_WORDS:
            what = what.replace(recorded, live)
        finding = finding._replace(what=what)
        is_begin = rec.marks[0].key == _BEGIN and len(pairs) == 1
        strange = max(rec.lines) > self._last_line
        if finding.cause == "program" and (is_begin or strange):
            lines = f"it is in line {max(rec.lines)}" if strange else finding.what
            return finding._replace(what=f"another program runs: {lines}")
        return finding

    def _is_consequence(self, finding: Finding, pairs: Sequence[Match]) -> bool:
        """Return whether a difference is one of motion in a piece that begins apart, which was said before."""
        if finding.cause not in _MOTION:
            return False
        rec, sim = self._rec, self._sim
        begin = pairs[0]
        for pair in pairs:
            if rec.t[rec.marks[pair.first].row] < finding.t:
                begin = pair
        row, its = rec.marks[begin.first].row, sim.marks[begin.second].row
        tolerance = self._expected.tolerance
        fastest = max(abs(column[row]) for column in rec.qd)
        allowed = tolerance.joints + (2.0 * tolerance.time_s + rec.waited_s(row)) * fastest
        is_apart = max(abs(a - b) for a, b in zip(rec.joints(row), sim.joints(its), strict=True)) > allowed
        return is_apart and bool(self._said or self.is_doubtful)

    def _is_cut_off(self, pairs: Sequence[Match]) -> list[Finding] | None:
        """Return what is to be said of a program that was ended in the middle of a line; None if it was not."""
        rec, sim = self._rec, self._sim
        more, its_more = rec.marks[pairs[-1].first + 1 :], sim.marks[pairs[-1].second + 1 :]
        if [mark.key for mark in more] != [("line", 0)] or its_more or not sim.is_open:
            return None
        line, t = rec.lines[more[0].row - 1], rec.t[more[0].row]
        if self.exception:
            return [
                Finding(t, line, f"the program ends here ({self.exception}), the simulated one does not", "program")
            ]
        self.notes.append(f"the program was ended in line {line} from outside")
        return []

    def _ending(self) -> str:
        run = self._run
        if run.alarms:
            return f"ends with an alarm in line {run.alarms[-1].line}: {run.alarms[-1].text}"
        return ""

    def _begin_at(self, pair: Match) -> None:
        self._rec.begin_at(pair.first)
        self._sim.begin_at(pair.second)
        self._begin_piece()

    def _begin_piece(self) -> None:
        self._shift_s = self._sim.t[0] - self._rec.t[0]
        self._elapsed_s = 0.0
        self._forget_given()

    def _forget_given(self) -> None:
        first = self._rec.t[0]
        self._given = [arrival for arrival in self._given if arrival.t >= first]

    def _shorten(self) -> None:
        """Cut a long piece in which nothing differs."""
        rec, sim = self._rec, self._sim
        if rec.t[-1] - rec.t[0] < _WINDOW_S or len(rec.marks) > 1 or len(sim.marks) > 1:
            return
        row = bisect_left(rec.t, rec.t[-1] - _KEPT_S)
        its = round((rec.t[row] + self._shift_s - sim.t[0]) * TICKS_PER_S)
        if 0 < its < len(sim):
            self._elapsed_s += rec.t[row] - rec.t[0]
            rec.drop(row)
            sim.drop(its)
            self._forget_given()

    def _stay_apart(self) -> list[Finding]:
        """Keep what is needed to meet again; without a mark in common for long, give up."""
        rec, sim = self._rec, self._sim
        if len(rec.marks) > 1 and rec.t[-1] - rec.t[rec.marks[1].row] > GIVEN_UP_S:
            self.is_lost = True
        if self._run.is_over and rec.is_open and len(rec.marks) > 1:
            self.is_lost = True
        for window in (rec, sim):
            first = window.marks[1].row if len(window.marks) > 1 else bisect_left(window.t, window.t[-1] - _KEPT_S)
            window.drop(first)
        self._forget_given()
        return []

    def _trim_unmatched(self) -> None:
        """Keep no more of a run that has nothing in common yet than of one that is given up."""
        if self.is_together:
            return
        first = bisect_left(self._sim.t, self._sim.t[-1] - GIVEN_UP_S) if len(self._sim) else 0
        self._sim.drop(first)

    # ---------------------------------------------------------------- other differences

    def _payload(self) -> list[Finding]:
        values = self._values
        if "payload_mass" not in values or self._ended_t is not None:
            return []
        own = self._robot.controller.payload
        mass, cog = values["payload_mass"], values.get("payload_cog", own.cog)
        numbers = (mass, *cog)  # type: ignore[misc]
        if all(abs(a - b) <= _PAYLOAD_SAME for a, b in zip(numbers, (own.mass_kg, *own.cog), strict=True)):
            self._payload_since = None
            return []
        since = self._payload_since
        if since is None:
            self._payload_since = self._known_s
            return []
        if self._known_s - since < SETTLE_S:
            return []
        if (numbers, own) == self._payload_said:
            return []
        self._payload_said = numbers, own
        what = f"the payload is {_load(numbers)}, simulated {_load((own.mass_kg, *own.cog))}"
        return [Finding(since, self.line, what, "payload")]

    def _waits(self) -> list[Finding]:
        waits_s = self._known_s - self._still_t
        if waits_s < self._expected.wait_s or self._ended_t is not None:
            return []
        if any(_SLEEPS in thread.waits_for for thread in self._robot.threads()):
            return []
        lines = sorted(self._still_lines)
        where = f"line {lines[0]}" if len(lines) == 1 else f"lines {lines[0]} to {lines[-1]}"
        self._still_t = self._known_s
        what = f"waits in {where} for {waits_s:.1f} s, and the simulated program with it"
        if self._pending:
            what = f"waits in {where} for {waits_s:.1f} s, the simulated program goes on"
        return [Finding(self._known_s, self.line, what, "waiting")]


_BEGIN: Final = ("line", -1)


def _load(numbers: Sequence[float]) -> str:
    mass, *cog = numbers
    at = ", ".join(f"{value:g}" for value in cog)
    return f"{mass:g} kg at ({at}) m"
