"""What differs between a recorded run and the simulated one: pieces between marks, motion, times, signals.

The two runs are cut at their marks, and the marks that belong together are found (`alignment`). A piece lies between
two such marks. Where one run has marks that the other does not have, they took different ways; unless the recording has
no rows there.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise, takewhile
from typing import Final, Literal

from elitescript.audit.alignment import Match, matched
from elitescript.audit.inputs import Arrival
from elitescript.audit.motion import (
    Motion,
    Profile,
    Tolerance,
    compare_motion,
    profile_of,
    root_mean_square,
)
from elitescript.audit.series import Mark, Series
from elitescript.audit.settings import Numbers, SettingPair, difference_at, setter_line
from elitescript.messages.machine import WriteSignal
from elitescript.messages.signals import Value, parse_signal_name
from elitescript.messages.timing import PERIOD_S
from elitescript.records import NamedTuple, field, record

SHARE_SAME = 0.02
"""Share by which speeds and accelerations may differ and are the same."""

_SLOWEST = 0.05
"""Speed slider below which a change that comes late is not made up for any more."""
_ROUNDING_S = 1e-9
SHIFT_MARKS = 300
"""Marks behind the first difference among which a shift of all lines is looked for."""
_SHIFT_LINES = 8
"""Lines there of which one gives the shift."""

GoesOn = Literal["", "recorded", "simulated", "both"]
"""Runs in which a piece goes on behind its last row."""
BOTH: Final = "both"

LONG_GAP_S = 0.1
"""A stretch without rows that is named; in it nothing is compared."""


class Finding(NamedTuple):
    """One difference.

    Attributes:
        t: s since the program's begin, in the recording.
        line: of the recorded program.
        what: in words.
        cause: `slider`, `speed scaling`, `acceleration`, `speed`, `blend`, `target`, `waiting`, `program`, `signal`,
            `payload`, `payload centre`, `tcp`, or empty if it is not known.
    """

    t: float
    line: int
    what: str
    cause: str


class Largest(NamedTuple):
    """Root mean square and largest of an error, and where that is."""

    rms: float
    largest: float
    t: float
    line: int


class LineTime(NamedTuple):
    """Time of one line in both runs."""

    line: int
    recorded_s: float
    simulated_s: float
    recorded_passes: int
    simulated_passes: int
    slowed_s: float
    """What the slider, or another speed scaling, took of the recorded time."""
    cause: str


class SignalDifference(NamedTuple):
    """An edge that only one run has."""

    t: float
    line: int
    name: str
    value: Value
    is_recorded: bool
    """Whether the recording has it, not the simulated run."""


@record
class Comparison:
    """Everything that was found in one run; times are s since the program's begin, in the recording.

    Attributes:
        findings: differences beyond the tolerance, by time.
        joints: error of target joints along the path, rad; None if nothing could be compared.
        path: error of the target TCP along the path, m; None if the recording has no TCP.
        measured: measured joints against those of the simulated drives at the same time, rad; None unless targets agree
            and both are known.
        lines: time by line, the largest difference first.
        signals: edges that only one run has.
        compared_signals: how many signals changed in either run, or were the same all the time in both.
        notes: what could not be compared, and what explains itself.
        simulated_s: duration of the simulated run, as far as the recording goes.
    """

    findings: tuple[Finding, ...]
    joints: Largest | None
    path: Largest | None
    measured: Largest | None
    lines: tuple[LineTime, ...]
    signals: tuple[SignalDifference, ...]
    compared_signals: int
    notes: tuple[str, ...] = field(default=())
    simulated_s: float = 0.0

    @property
    def divergence(self) -> Finding | None:
        """The first difference."""
        return self.findings[0] if self.findings else None


class _Stretch(NamedTuple):
    """What lies between two pairs of marks; indices of marks, of rows where named so."""

    begin: Match
    end: Match | None
    """None behind the last pair."""
    only_recorded: list[int]
    only_simulated: list[int]


class Comparer:
    """Compares one recorded run with a simulated one.

    Args:
        recorded: the run.
        simulated: the other.
        recorded_marks, simulated_marks: their marks.
        arrivals: inputs of the recorded run.
        tolerance: what does not count.
        ending: how the simulated run ended, in words; empty if its program came to its end.
        recorded_ending: the exception that ended the recorded program, in words; empty if none is known.
        settings: payload and TCP offset in both.
        setters: lines of the program that set them, by command.
        is_live: whether both runs go on; then a piece that only one has behind it is one that takes longer in the
            other.
    """

    __slots__ = (
        "_arrivals",
        "_causes",
        "_compared",
        "_ending",
        "_findings",
        "_is_live",
        "_is_over",
        "_marks",
        "_motions",
        "_notes",
        "_other",
        "_other_marks",
        "_recorded",
        "_recorded_ending",
        "_setters",
        "_settings",
        "_signals",
        "_tolerance",
    )

    def __init__(
        self,
        recorded: Series,
        simulated: Series,
        recorded_marks: Sequence[Mark],
        simulated_marks: Sequence[Mark],
        *,
        arrivals: Sequence[Arrival] = (),
        tolerance: Tolerance | None = None,
        ending: str = "",
        recorded_ending: str = "",
        settings: Sequence[SettingPair] = (),
        setters: Mapping[str, Sequence[int]] | None = None,
        is_live: bool = False,
    ) -> None:
        self._recorded = recorded
        self._other = simulated
        self._marks = recorded_marks
        # A run that was given up has no end that could be one of the recording.
        is_given_up = simulated.is_open and bool(simulated_marks) and simulated_marks[-1].key == ("line", 0)
        self._other_marks = simulated_marks[:-1] if is_given_up else simulated_marks
        self._arrivals = arrivals
        self._tolerance = tolerance or Tolerance()
        self._ending = ending
        self._recorded_ending = recorded_ending
        self._settings = settings
        self._setters = setters or {}
        self._is_live = is_live
        self._findings: list[Finding] = []
        self._signals: list[SignalDifference] = []
        self._notes: list[str] = []
        self._motions: list[Motion] = []
        self._causes: dict[int, dict[str, float]] = {}
        self._is_over = False
        self._compared = -1

    def compare(self, signals: Sequence[str]) -> Comparison:
        """Return everything that differs.

        Args:
            signals: that both runs have.
        """
        keys, other_keys = ([mark.key for mark in marks] for marks in (self._marks, self._other_marks))
        has_begin = self._recorded.is_open or not self._recorded.is_headless
        pairs = matched(keys, other_keys, has_begin=has_begin, has_end=not self._is_live)
        if not pairs:
            self._nothing_in_common()
        for stretch in self._stretches(pairs):
            if self._is_over or (stretch.end is None and self._is_end(stretch.begin.first)):
                # Behind the end of the program the arm only comes to rest.
                break
            self._compare_stretch(stretch)
            self._compared = stretch.begin.first
        self._compare_numbers(pairs, signals)
        self._compare_settings(pairs)
        self._name_gaps()
        self._findings.sort(key=lambda finding: finding.t)
        if self._findings and self._findings[0].cause == "program" and (shift := self._shift_of_lines(pairs)):
            higher = "higher" if shift > 0 else "lower"
            self._notes.insert(
                0, f"lines of the recording are {abs(shift)} {higher} than those of the program: one of both was edited"
            )
        since, until = self._row_of_begin(pairs), self._rows_until_end(pairs)
        changed = {change.name for series in (self._recorded, self._other) for change in series.changes}
        return Comparison(
            tuple(self._findings),
            self._joints(),
            self._path(),
            None if self._findings else self._measured(pairs),
            self._lines(since, until),
            tuple(self._signals),
            len(changed & set(signals)),
            tuple(self._notes),
            self._other.t[until - 1] - self._other.t[since],
        )

    # ---------------------------------------------------------------- alignment

    def _nothing_in_common(self) -> None:
        line = self._marks[0].line if self._marks else 0
        self._find(0.0, line, "no line of the recording is one of the simulated run: it is another program", "program")

    def _stretches(self, pairs: Sequence[Match]) -> Iterator[_Stretch]:
        if pairs and not self._recorded.is_headless and pairs[0] != (0, 0):
            yield _Stretch(Match(-1, -1), pairs[0], [*range(pairs[0].first)], [*range(pairs[0].second)])
        for begin, end in pairwise([*pairs, None]):
            assert begin is not None
            first_end = len(self._marks) if end is None else end.first
            second_end = len(self._other_marks) if end is None else end.second
            yield _Stretch(begin, end, [*range(begin.first + 1, first_end)], [*range(begin.second + 1, second_end)])

    def _is_end(self, mark: int) -> bool:
        return mark >= 0 and self._marks[mark].key == ("line", 0)

    def _row(self, mark: int) -> int:
        return self._marks[mark].row if mark >= 0 else 0

    def _its_row(self, mark: int) -> int:
        return self._other_marks[mark].row if mark >= 0 else 0

    # ---------------------------------------------------------------- one stretch

    def _compare_stretch(self, stretch: _Stretch) -> None:
        recorded, other = self._recorded, self._other
        begin, its_begin = self._row(stretch.begin.first), self._its_row(stretch.begin.second)
        is_last = stretch.end is None
        end = len(recorded) - 1 if stretch.end is None else self._row(stretch.end.first)
        its_end = len(other) - 1 if stretch.end is None else self._its_row(stretch.end.second)
        only_recorded, only_simulated = self._without_moved_edges(stretch)
        if is_last and self._is_live:
            self._compare_open(stretch, only_recorded, only_simulated)
            return
        if is_last and recorded.is_open:
            overdue = [] if only_recorded else self._overdue(begin, end, its_begin, only_simulated)
            if overdue:
                self._still_waits(stretch, overdue)
                return
            only_simulated = []  # what comes after the recording
        if only_simulated and not only_recorded and self._is_in_gap(begin, end, only_simulated, its_end):
            only_simulated = []
        if not only_recorded and not only_simulated:
            is_cut = is_last and (recorded.is_open or other.is_open)
            self._compare_piece(begin, end, its_begin, its_end, goes_on=BOTH if is_cut else "")
        elif not self._is_stopped_from_outside(stretch, only_recorded, only_simulated):
            self._part_ways(stretch, only_recorded, only_simulated)

    def _without_moved_edges(self, stretch: _Stretch) -> tuple[list[int], list[int]]:
        """Return marks of each run without the edges that both have in this stretch at about the same time."""
        only_recorded, only_simulated = list(stretch.only_recorded), list(stretch.only_simulated)
        t0, its_t0 = (
            self._recorded.t[self._row(stretch.begin.first)],
            self._other.t[self._its_row(stretch.begin.second)],
        )
        for mark in stretch.only_recorded:
            key = self._marks[mark].key
            for its in only_simulated:
                if self._other_marks[its].key == key:
                    row = self._marks[mark].row
                    elapsed_s = self._recorded.t[row] - t0
                    apart_s = abs(elapsed_s - (self._other.t[self._other_marks[its].row] - its_t0))
                    if apart_s <= self._tolerance.of(elapsed_s) + self._recorded.waited_s(row):
                        only_recorded.remove(mark)
                        only_simulated.remove(its)
                    break
        return only_recorded, only_simulated

    def _overdue(self, begin: int, end: int, its_begin: int, only_simulated: Sequence[int]) -> list[int]:
        """Return the marks of the simulated run that a recording, which ends while its arm waits, should have by then.

        None if the arm is not yet where it waits: then it is the motion that differs.
        """
        recorded, other = self._recorded, self._other
        lasted_s = recorded.t[end] - recorded.t[begin] - recorded.waited_s(end)
        found = []
        for mark in only_simulated:
            its_s = other.t[self._other_marks[mark].row] - other.t[its_begin]
            if its_s + self._tolerance.of(lasted_s) < lasted_s:
                found.append(mark)
        if not found:
            return []
        its_row = self._other_marks[found[0]].row
        since_s = recorded.t[begin] + other.t[its_row] - other.t[its_begin]
        stands = all(recorded.stands(row) for row in range(begin, end + 1) if recorded.t[row] >= since_s)
        apart = max(abs(a - b) for a, b in zip(recorded.joints(end), other.joints(its_row), strict=True))
        return found if stands and apart <= self._tolerance.joints else []

    def _still_waits(self, stretch: _Stretch, overdue: list[int]) -> None:
        """Note that a recording ends while its arm waits longer than the simulated one."""
        first = self._other_marks[overdue[0]]
        if first.key[0] not in ("line", "moves"):
            edges = takewhile(lambda mark: self._other_marks[mark].key[0] not in ("line", "moves"), overdue)
            self._part_ways(stretch, [], [*edges])
            return
        begin = self._row(stretch.begin.first)
        lasts_s = self._recorded.t[-1] - self._recorded.t[begin]
        its_s = self._other.t[first.row] - self._other.t[self._its_row(stretch.begin.second)]
        line = self._recorded.lines[begin]
        self._causes.setdefault(line, {})["waiting"] = lasts_s - its_s
        what = f"it waits still after {lasts_s:.3f} s, when the recording ends, simulated {its_s:.3f} s"
        self._find(self._recorded.t[begin] + its_s, line, what, "waiting")

    def _is_in_gap(self, begin: int, end: int, only_simulated: Sequence[int], its_end: int) -> bool:
        """Return whether marks of the simulated run can be in a gap of the recording."""
        widest_s = max((self._recorded.waited_s(row) for row in range(begin, end + 1)), default=0.0)
        if widest_s == 0.0:
            return False
        shortest = round(widest_s / PERIOD_S) + 1
        by_name: dict[str, list[int]] = {}
        for mark in only_simulated:
            by_name.setdefault(self._other_marks[mark].key[0], []).append(mark)
        return all(self._is_brief(marks, shortest, its_end) for marks in by_name.values())

    def _is_brief(self, marks: Sequence[int], rows: int, its_end: int) -> bool:
        """Return whether what these marks of one signal, or of lines, begin is over after so many rows each."""
        its = self._other_marks
        name = its[marks[0]].key[0]
        for mark in marks:
            begin, value = its[mark].row, its[mark].key[1]
            ends = (later.row for later in its[mark + 1 :] if later.key[0] == name)
            if next(ends, its_end) - begin <= rows:
                continue
            is_back = isinstance(value, bool) and mark == marks[-1] and len(marks) % 2 == 0
            if not is_back:
                return False
        return True

    def _is_stopped_from_outside(
        self, stretch: _Stretch, only_recorded: Sequence[int], only_simulated: Sequence[int]
    ) -> bool:
        """Return whether the recorded program ends in the middle of a line; compare what there is of that line."""
        if only_recorded or stretch.end is None or not self._is_end(stretch.end.first) or self._recorded_ending:
            return False
        begin, its_begin = self._row(stretch.begin.first), self._its_row(stretch.begin.second)
        end, its_end = self._row(stretch.end.first), self._other_marks[only_simulated[0]].row
        lasts_s = self._recorded.t[end] - self._recorded.t[begin]
        its_s = self._other.t[its_end] - self._other.t[its_begin]
        if lasts_s >= its_s - self._tolerance.of(its_s):
            return False
        line = self._marks[stretch.begin.first].line
        self._notes.append(
            f"the recorded program was ended at {self._recorded.t[end]:.3f} s in line {line}, by a stop or an alarm; "
            "what follows in the simulated run is not compared"
        )
        self._compare_piece(begin, end, its_begin, its_end, goes_on=BOTH)
        self._is_over = True
        return True

    def _compare_open(self, stretch: _Stretch, only_recorded: Sequence[int], only_simulated: Sequence[int]) -> None:
        """Compare what there is of a stretch that has no end yet."""
        if only_recorded and only_simulated:
            self._part_ways(stretch, only_recorded, only_simulated)
            return
        begin, its_begin = self._row(stretch.begin.first), self._its_row(stretch.begin.second)
        end = self._row(only_recorded[0]) if only_recorded else len(self._recorded) - 1
        its_end = self._its_row(only_simulated[0]) if only_simulated else len(self._other) - 1
        goes_on: GoesOn = "recorded" if only_simulated else "simulated" if only_recorded else BOTH
        self._compare_piece(begin, end, its_begin, its_end, goes_on=goes_on)

    def _part_ways(self, stretch: _Stretch, only_recorded: Sequence[int], only_simulated: Sequence[int]) -> None:
        marks, its_marks = self._marks, self._other_marks
        for mark in only_recorded:
            found = marks[mark]
            if found.key[0] not in ("line", "moves"):
                t = self._recorded.t[found.row]
                self._signals.append(SignalDifference(t, found.line, *found.key, is_recorded=True))
        for mark in only_simulated:
            found = its_marks[mark]
            if found.key[0] not in ("line", "moves"):
                t = self._recorded_time(stretch, found.row)
                self._signals.append(SignalDifference(t, found.line, *found.key, is_recorded=False))
        begin = stretch.begin
        line = marks[begin.first].line if begin.first >= 0 else 0
        first = only_recorded[0] if only_recorded else None
        second = only_simulated[0] if only_simulated else None
        if first is not None:
            t = self._recorded.t[marks[first].row]
        elif stretch.end is None and not self._recorded.is_open:
            t = self._recorded.t[-1]
        else:
            t = self._recorded_time(stretch, its_marks[second].row) if second is not None else 0.0
        for mark in (*only_recorded, *only_simulated):
            self._causes.setdefault((marks[mark] if mark in only_recorded else its_marks[mark]).line, {}).setdefault(
                "program", 0.0
            )
        self._find(
            t, marks[first].line if first is not None else line, *self._in_words(stretch, only_recorded, only_simulated)
        )

    def _shift_of_lines(self, pairs: Sequence[Match]) -> int:
        """Return how much higher the recorded lines are than those of the program; 0 if they are not, all alike."""
        together = next((place for place, pair in enumerate(pairs) if pair != (place, place)), len(pairs))
        first = [mark.key for mark in self._marks[together : together + SHIFT_MARKS]]
        second = [mark.key for mark in self._other_marks[together : together + SHIFT_MARKS]]
        lines, its_lines = ([int(value) for name, value in keys if name == "line"] for keys in (first, second))
        shifts = Counter(
            line - its for line in lines[:_SHIFT_LINES] for its in its_lines[:_SHIFT_LINES] if line and its != line
        )
        least = max(0.8 * min(len(first), len(second)), 2.0 + len(matched(first, second)))
        for shift, _ in shifts.most_common(_SHIFT_LINES):
            moved = [(name, int(value) - shift) if name == "line" and value else (name, value) for name, value in first]
            if len(matched(moved, second)) >= least:
                return shift
        return 0

    @staticmethod
    def _once_more(lines: Sequence[int], others: Sequence[Mark]) -> str:
        """Return how much oftener one run goes through lines that the other has as well; empty if it has not."""
        if not {*lines} <= {mark.line for mark in others} or 0 in lines:
            return ""
        times = lines.count(lines[0])
        return " once more" if times == 1 else f" {times} times more"

    def _recorded_time(self, stretch: _Stretch, its_row: int) -> float:
        """Return when a row of the simulated run would be in the recording."""
        begin, end = self._row(stretch.begin.first), len(self._recorded) - 1
        if stretch.end is not None:
            end = self._row(stretch.end.first)
        t = self._recorded.t[begin] + self._other.t[its_row] - self._other.t[self._its_row(stretch.begin.second)]
        return min(t, self._recorded.t[end])

    def _in_words(
        self, stretch: _Stretch, only_recorded: Sequence[int], only_simulated: Sequence[int]
    ) -> tuple[str, str]:
        """Return what parts the ways, and the cause."""
        recorded = [self._marks[mark] for mark in only_recorded]
        simulated = [self._other_marks[mark] for mark in only_simulated]
        edges = [mark for mark in (*recorded, *simulated) if mark.key[0] not in ("line", "moves")]
        lines, its_lines = _lines_of(recorded), _lines_of(simulated)
        if edges and not lines and not its_lines:
            mark = edges[0]
            text = f"{mark.key[0]} becomes {_level(mark.key[1])}"
            its = next((its for its in simulated if its.key[0] == mark.key[0]), None)
            if not recorded or its is None:
                return f"{text} in the {'recording' if recorded else 'simulated run'} only", "signal"
            if its.key == mark.key:
                return f"{text} at another time", "signal"
            text += f", simulated {_level(its.key[1])}"
            return text, "signal"
        if not lines and not its_lines:
            return "the arm stands and moves at other times", "waiting"
        if its_lines and not lines and stretch.end is not None and self._is_end(stretch.end.first):
            line = self._marks[stretch.begin.first].line if stretch.begin.first >= 0 else 0
            why = f" ({self._recorded_ending})" if self._recorded_ending else ""
            goes_on = f"the simulated one goes on with {_named(its_lines)}"
            return f"the recorded program ends behind line {line}{why}, {goes_on}", "program"
        if its_lines and not lines:
            if its_lines == [0]:
                return f"the simulated program ends here{self._ending}", "program"
            more = self._once_more(its_lines, self._marks)
            return f"the simulated run goes through {_named(its_lines)}{more}, the recording does not", "program"
        if lines and not its_lines:
            if lines[0] == 0:
                return "the recorded program ends here, the simulated one does not", "program"
            why = f": it {self._ending}" if self._ending and stretch.end is None else ""
            more = self._once_more(lines, self._other_marks)
            return f"the recording goes through {_named(lines)}{more}, the simulated run does not{why}", "program"
        ends = f" (it {self._ending})" if its_lines[0] == 0 and self._ending else ""
        return (
            f"the recording goes on with {_named(lines)}, the simulated run with {_named(its_lines)}{ends}",
            "program",
        )

    # ---------------------------------------------------------------- one piece

    def _compare_piece(self, begin: int, end: int, its_begin: int, its_end: int, *, goes_on: GoesOn) -> None:
        """Compare motion and duration; of a piece that goes on in a run behind its last row only what both have."""
        recorded, other, tolerance = self._recorded, self._other, self._tolerance
        is_disturbed = any(
            begin <= arrival.row <= end and not isinstance(arrival.request, WriteSignal) for arrival in self._arrivals
        )
        motion = compare_motion(recorded, begin, end, other, its_begin, its_end, tolerance, is_disturbed=is_disturbed)
        self._motions.append(motion)
        lasts_s = recorded.t[end] - recorded.t[begin]
        its_s = other.t[its_end] - other.t[its_begin]
        allowed_s = tolerance.of(max(lasts_s, its_s)) + recorded.waited_s(begin) + recorded.waited_s(end)
        if is_disturbed:
            # A speed that changes a control period later takes so much longer as it is slower.
            slowest = 1.0 if recorded.slider is None else min(recorded.slider[begin : end + 1])
            allowed_s += tolerance.time_s / max(slowest, _SLOWEST)
        allowed_s += _ROUNDING_S
        excess_s = lasts_s - its_s
        if goes_on == BOTH:
            excess_s = 0.0
        elif goes_on:
            # How much longer it will take is not known.
            excess_s = max(excess_s, 0.0) if goes_on == "recorded" else min(excess_s, 0.0)
        line = recorded.lines[begin]
        off = motion.off_time
        if goes_on and off is not None and recorded.t[off] - recorded.t[begin] > its_s:
            off = None
        is_off_path = motion.off_path is not None and (off is not None or abs(excess_s) > allowed_s)
        if abs(excess_s) <= allowed_s and off is None:
            return
        cause, why = self._cause(motion, begin, end, its_begin, its_end, is_off_path=is_off_path)
        t = recorded.t[end]
        if excess_s > allowed_s:
            t = recorded.t[begin] + its_s
        if off is not None:
            t = min(t, recorded.t[off])
        causes = self._causes.setdefault(line, {})
        causes[cause] = causes.get(cause, 0.0) + abs(excess_s)
        if is_off_path:
            what = f"joint {motion.joint} is up to {motion.largest:.4f} rad off the simulated path"
        elif abs(excess_s) > allowed_s:
            still = {"recorded": ("over ", ""), "simulated": ("", "over ")}.get(goes_on, ("", ""))
            what = f"{still[0]}{lasts_s:.3f} s, simulated {still[1]}{its_s:.3f} s"
        else:
            what = "the arm is elsewhere at this time, on the same path"
        self._find(t, line, what + why, cause)

    def _cause(
        self, motion: Motion, begin: int, end: int, its_begin: int, its_end: int, *, is_off_path: bool
    ) -> tuple[str, str]:
        """Return the cause of a difference within a piece, and what is said of it."""
        recorded, other = self._recorded, self._other
        ends_moving = not (recorded.stands(end) and other.stands(its_end))
        begins_moving = not (recorded.stands(begin) and other.stands(its_begin))
        begins_apart = max(abs(a - b) for a, b in zip(recorded.joints(begin), other.joints(its_begin), strict=True))
        if motion.ends_apart > 10.0 * self._tolerance.joints and ends_moving and not is_off_path:
            return "blend", ": the blend into the next move begins elsewhere"
        if is_off_path and motion.is_beyond and ends_moving:
            return "blend", ": the blend into the next move begins elsewhere"
        if is_off_path and not begins_moving and begins_apart > self._tolerance.joints:
            return "target", ": the move begins elsewhere"
        if is_off_path:
            if begins_moving and begins_apart > self._tolerance.joints and motion.ends_apart <= begins_apart:
                return "blend", ": the blend with the move before has another radius"
            return "target", ": the move goes elsewhere"
        here, there = profile_of(recorded, begin, end), profile_of(other, its_begin, its_end)
        moves_s, stands_s = here.moving_s - there.moving_s, here.standing_s - there.standing_s
        if abs(stands_s) > abs(moves_s):
            name = self._input_at(end)
            return "waiting", f": it waits {'longer' if stands_s > 0.0 else 'less'}{f' for {name}' if name else ''}"
        return self._cause_of_speed(here, there, begin, end)

    def _cause_of_speed(self, here: Profile, there: Profile, begin: int, end: int) -> tuple[str, str]:
        scaling, slider = self._recorded.scaling, self._recorded.slider
        if scaling is not None:
            moving = [row for row in range(begin, end + 1) if not self._recorded.stands(row)] or [begin]
            scaled = sum(scaling[row] for row in moving) / len(moving)
            set_to = 1.0 if slider is None else sum(slider[row] for row in moving) / len(moving)
            if scaled < (1.0 - SHARE_SAME) * set_to:
                return "speed scaling", f": speed scaling {scaled:.0%} at a slider of {set_to:.0%}"
        faster = here.speed / there.speed if there.speed else 1.0
        harder = here.acceleration / there.acceleration if there.acceleration else 1.0
        is_other_speed, is_other_acceleration = abs(faster - 1.0) > SHARE_SAME, abs(harder - 1.0) > SHARE_SAME
        accelerations = f"{here.acceleration:.3g} instead of {there.acceleration:.3g} rad/s^2"
        speeds = f"{here.speed:.3g} instead of {there.speed:.3g} rad/s"
        if is_other_acceleration and harder and abs(faster * faster / harder - 1.0) < 2.0 * SHARE_SAME:
            # A move without cruise is as much slower by its acceleration as by its time.
            or_scaling = "" if scaling is not None else ", or the speed scaling, which is not recorded"
            return "acceleration", f": acceleration {accelerations}{or_scaling}"
        if is_other_acceleration:
            more = f", speed {speeds}" if is_other_speed else ""
            return "acceleration", f": acceleration {accelerations}{more}"
        if is_other_speed:
            return "speed", f": speed {speeds}"
        if there.usual_speed and abs(here.usual_speed / there.usual_speed - 1.0) > SHARE_SAME:
            # A blend can bring more speed into a move than it has itself.
            return "speed", f": speed {here.usual_speed:.3g} instead of {there.usual_speed:.3g} rad/s"
        return "", ""

    def _input_at(self, row: int) -> str:
        """Return the input that arrives in a row, or just before it; empty if none does."""
        names = [arrival.text for arrival in self._arrivals if row - 2 <= arrival.row <= row]
        return names[-1] if names else ""

    # ---------------------------------------------------------------- the rest

    def _compare_numbers(self, pairs: Sequence[Match], signals: Sequence[str]) -> None:
        """Compare outputs with numbers where marks belong together."""
        names = {name for name in signals if _is_number(name)}
        runs = [
            {name: levels.get(name, 0.0) for name in names} for levels in (self._recorded.levels, self._other.levels)
        ]
        changes = [[change for change in its.changes if change.name in names] for its in (self._recorded, self._other)]
        places, differing = [0, 0], set[str]()
        for first, second in pairs:
            if self._is_over and first > self._compared:
                break
            for which, row in enumerate((self._row(first), self._its_row(second))):
                found = changes[which]
                while places[which] < len(found) and found[places[which]].row <= row:
                    change = found[places[which]]
                    runs[which][change.name] = change.value
                    places[which] += 1
            for name in names - differing:
                here, there = runs[0][name], runs[1][name]
                if abs(here - there) > 1e-6 + 1e-3 * abs(there):
                    differing.add(name)
                    mark = self._marks[first]
                    t = self._recorded.t[mark.row]
                    self._find(t, mark.line, f"{name} is {here:g}, simulated {there:g}", "signal")

    def _compare_settings(self, pairs: Sequence[Match]) -> None:
        """Compare payload and TCP offset where marks belong together; each pair of values is one difference."""
        recorded, other = self._recorded, self._other
        known: dict[str, tuple[Numbers, Numbers] | None] = {}
        for first, second in pairs:
            if self._is_over and first > self._compared:
                break
            row, its_row = self._row(first), self._its_row(second)
            slack_s = 2.0 * PERIOD_S + recorded.waited_s(row) + recorded.waited_s(min(row + 1, len(recorded) - 1))
            for pair in self._settings:
                found = difference_at(pair, recorded.t[row], other.t[its_row], slack_s, recorded.t[-1])
                values = None if found is None else found.values
                if found is not None and values != known.get(pair.kind.name):
                    at = max(bisect_right(recorded.t, found.t + _ROUNDING_S) - 1, 0)
                    before = recorded.lines[at - 1] if at else 0
                    line = setter_line(self._setters.get(pair.kind.command, ()), before, recorded.lines[at])
                    self._find(found.t, line, found.what, pair.kind.cause)
                known[pair.kind.name] = values

    def _name_gaps(self) -> None:
        t = self._recorded.t
        for row in range(1, len(t)):
            gap_s = t[row] - t[row - 1] - PERIOD_S
            if gap_s > LONG_GAP_S:
                lines = f"lines {self._recorded.lines[row - 1]} to {self._recorded.lines[row]}"
                self._notes.append(f"{t[row - 1]:.3f} to {t[row]:.3f} s ({lines}): the recording has no rows")

    def _joints(self) -> Largest | None:
        if not self._motions:
            return None
        count = sum(motion.rows for motion in self._motions)
        squares = sum(motion.sum_of_squares for motion in self._motions)
        worst = max(self._motions, key=lambda motion: motion.largest)
        return self._largest(root_mean_square(squares, count), worst.largest, worst.row)

    def _path(self) -> Largest | None:
        places = [place for motion in self._motions for place in motion.places]
        if not places:
            return None
        row, largest = max(places, key=lambda place: place[1])
        return self._largest(root_mean_square(sum(d * d for _, d in places), len(places)), largest, row)

    def _measured(self, pairs: Sequence[Match]) -> Largest | None:
        recorded, other = self._recorded, self._other
        theirs = other.actual or other.q
        if recorded.actual is None:
            return None
        squares, count, largest, worst, shift = 0.0, 0, 0.0, 0, 0.0
        for begin, end in pairwise(pairs):
            row0, its0 = self._row(begin.first), self._its_row(begin.second)
            if not recorded.waited_s(row0):
                shift = other.t[its0] - recorded.t[row0]
            last = self._its_row(end.second)
            for row in range(row0, self._row(end.first)):
                its = min(round((recorded.t[row] + shift) / PERIOD_S), last)
                apart = max(abs(a[row] - b[its]) for a, b in zip(recorded.actual, theirs, strict=True))
                squares += apart * apart
                count += 1
                if apart > largest:
                    largest, worst = apart, row
        return self._largest(root_mean_square(squares, count), largest, worst)

    def _largest(self, rms: float, largest: float, row: int) -> Largest:
        return Largest(rms, largest, self._recorded.t[row], self._recorded.lines[row])

    def _row_of_begin(self, pairs: Sequence[Match]) -> int:
        """Return the row of the simulated run at which the recording begins; 0 if it shows the begin of the run."""
        if not self._recorded.is_headless or not pairs:
            return 0
        first = pairs[0]
        before_s = self._recorded.t[self._row(first.first)] - self._recorded.t[0]
        its_begin = self._its_row(first.second)
        return min(its_begin, bisect_left(self._other.t, self._other.t[its_begin] - before_s - 0.5 * PERIOD_S))

    def _rows_until_end(self, pairs: Sequence[Match]) -> int:
        """Return how many rows of the simulated run are not behind the end of the recording."""
        if not self._recorded.is_open or not pairs:
            return len(self._other)
        last = pairs[-1]
        rest_s = self._recorded.t[-1] - self._recorded.t[self._row(last.first)]
        its_begin = self._its_row(last.second)
        return max(its_begin + 1, bisect_right(self._other.t, self._other.t[its_begin] + rest_s + 0.5 * PERIOD_S))

    def _lines(self, since: int, until: int) -> tuple[LineTime, ...]:
        """Return the times of lines.

        Args:
            since: first row of the simulated run that counts.
            until: the row behind the last one.
        """
        times, passes, slowed = _line_times(self._recorded, 0, len(self._recorded))
        its_times, its_passes, _ = _line_times(self._other, since, until)
        found = []
        for line in sorted({*times, *its_times} - {0}):
            causes = self._causes.get(line, {})
            cause = max(causes, key=lambda name: causes[name]) if causes else ""
            slow_s = slowed.get(line, 0.0)
            if not causes and slow_s > self._tolerance.of(times.get(line, 0.0)):
                cause = "speed scaling" if self._recorded.slider is None else "slider"
            found.append(
                LineTime(
                    line,
                    times.get(line, 0.0),
                    its_times.get(line, 0.0),
                    passes.get(line, 0),
                    its_passes.get(line, 0),
                    slow_s,
                    cause,
                )
            )
        found.sort(key=lambda time: (-abs(time.recorded_s - time.simulated_s), time.line))
        return tuple(found)

    def _find(self, t: float, line: int, what: str, cause: str) -> None:
        self._findings.append(Finding(t, line, what, cause))


def _is_number(name: str) -> bool:
    row, _ = parse_signal_name(name)
    return row.kind == "float" and not row.is_input


def _level(value: Value) -> str:
    return ("off", "on")[value] if isinstance(value, bool) else f"{value:g}"


def _lines_of(marks: Sequence[Mark]) -> list[int]:
    return [mark.line for mark in marks if mark.key[0] == "line"]


def _named(lines: Sequence[int]) -> str:
    """Return lines in words: one, or the first and the last of several."""
    if len(set(lines)) == 1:
        return f"line {lines[0]}" if lines[0] else "the end of the program"
    shown = [line for line in lines if line]
    if len(shown) <= 3:
        return f"lines {', '.join(map(str, shown))}" if len(shown) > 1 else f"line {shown[0]}"
    return f"{len(shown)} lines from {shown[0]} to {shown[-1]}"


def _line_times(series: Series, since: int, until: int) -> tuple[dict[int, float], dict[int, int], dict[int, float]]:
    """Return for each line its time, how often it was reached, and what the speed scaling took of its time.

    Args:
        series: of the run.
        since: first row that is looked at.
        until: the row behind the last one.
    """
    times: dict[int, float] = {}
    passes: dict[int, int] = {}
    slowed: dict[int, float] = {}
    lines, t, scaling = series.lines, series.t, series.scaling
    begin = since
    for row in range(since + 1, until + 1):
        if row == until or lines[row] != lines[begin]:
            line = lines[begin]
            times[line] = times.get(line, 0.0) + t[min(row, until - 1)] - t[begin]
            passes[line] = passes.get(line, 0) + 1
            begin = row
    if scaling is not None and any(value < 1.0 for value in scaling):
        for row in range(since, until - 1):
            if scaling[row] < 1.0 and not series.stands(row):
                line = lines[row]
                slowed[line] = slowed.get(line, 0.0) + (1.0 - scaling[row]) * (t[row + 1] - t[row])
    return times, passes, slowed
