"""Finds contacts and closest distances over a whole run, in every control period, without looking at every one.

Each *pair* is two groups of solids of which one moves against the other: a link, tool or payload and a thing, or two
links that are not neighbours. The *travel* of a pair in a stretch of time is a bound of how far any point of one group
moves against the other: the sum over the joints between them of lever arm times angle turned. If the distance at one
time exceeds what matters by more than the travel since, it need not be computed; if that does not say enough, it is
computed at the end of the stretch, and, where the distances at both ends and the travel between them leave room for a
nearer place, in the middle, down to single control periods (Piyavskii's method; Shubert 1972). What matters is contact
and, for things, the closest distance so far.

Most pairs need not be looked at for long: the way of the arm bounds the travel of every pair, so that each is due when
the arm has gone so far, and only what is due is looked at. A move that was watched before, over the same joints in the
same periods, is not watched again but for the pairs that touched in it: a program repeats its moves.

So the result is that of computing every pair in every control period, to the tolerances below; begin and end of
contacts are exact.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from heapq import heapify, heappop, heappush
from math import inf
from typing import Final

from elitescript.kinematics.rotations import Vector3
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX
from elitescript.messages.timing import seconds
from elitescript.models.model import RobotModel
from elitescript.records import NamedTuple
from elitescript.said import said
from elitescript.solids.cell import Cell
from elitescript.solids.distance import Closest
from elitescript.solids.frames import frames_of
from elitescript.solids.pairs import Gap, OpenContact, Pair, watched_pairs
from elitescript.solids.spans import MovingArm, Span, measured, turned_since, turning

TOLERANCE_M: Final = 1e-5
TOLERANCE: Final = 0.01
"""By so much, or this share of it, the closest distance that is found may be above that of all control periods."""
DEPTH_TOLERANCE: Final = 0.1
"""Share of its depth by which a contact may get deeper than is found; exact at the ends of moves."""

_AMPLE_M: Final = 0.05
"""A lower bound that exceeds what matters by so much is taken instead of the distance."""

_TOUCH_M: Final = 1e-7
"""Distances up to this are not certain to be apart: moves of one course differ by rounding."""

_DEEPER_M: Final = 0.001
"""A contact that gets deeper by so much than was reported for its line is reported once more."""

_MOVES: Final = 1000
"""Moves that are remembered."""
_WORTHWHILE_TICKS: Final = 8
"""Shorter stretches of a move are not."""

_FARTHEST_RAD: Final = 1000.0
"""From then on sums begin anew, so that rounding stays below `_TOUCH_M`."""


class Contact(NamedTuple):
    """Two things that touch for a while, or the closest that they come in a run."""

    start_s: float
    """First control period in which they touch, in the time of the robot."""
    end_s: float
    """First one in which they do not any more, or the end of the run."""
    line: int
    """Line of the main thread at `start_s`, or at `t`."""
    first: str
    """Name of the link, tool or payload that moves."""
    second: str
    """Name of the thing or link that it touches."""
    distance_m: float
    """Distance at `t`, m; how deep they are in each other if it is negative."""
    t: float
    """When they are deepest in each other, or closest, s."""
    is_contact: bool
    points: tuple[Vector3, Vector3]
    """Where, a point of each, base frame, m."""

    @property
    def text(self) -> str:
        """What touches what, how deep and when, in words."""
        words = said(
            "{first} touches {second}: {depth_mm:.1f} mm deep at {t:.3f} s",
            first=self.first,
            second=self.second,
            depth_mm=-1000.0 * self.distance_m,
            t=self.t,
        )
        return (
            words
            if self.t == self.start_s
            else said("{words}, from {start_s:.3f} s on", words=words, start_s=self.start_s)
        )


class _Move(NamedTuple):
    """A move that was watched."""

    turned: Six
    """How far each joint turns, rad, at most."""
    touched: tuple[int, ...]
    """Numbers of the pairs that touch on it, or nearly."""


class _Queue:
    """Pairs in the order in which they are due, by the way of the arm, of which a pair travels a share at most."""

    __slots__ = ("_heap", "_levers", "_shares", "_way")

    def __init__(self, levers: Sequence[Sequence[float]]) -> None:
        """Take the lever arms of the pairs, m."""
        self._levers = [max([its[joint] for its in levers], default=0.0) for joint in range(6)]
        self._shares = [
            max([a / b for a, b in zip(its, self._levers, strict=True) if b > 0.0], default=0.0) for its in levers
        ]
        self._way = 0.0
        """Sum of the longest lever arm times angle turned, m."""
        self._heap: list[tuple[float, int]] = []

    def turn(self, turned: Six) -> bool:
        """Add angles that the joints turn, rad; return whether a pair is due."""
        i, j, k, m, n, o = self._levers
        a, b, c, d, e, f = turned
        self._way += i * a + j * b + k * c + m * d + n * e + o * f
        return bool(self._heap) and self._heap[0][0] <= self._way

    def put(self, number: int, slack: float) -> None:
        """Have a pair due when it has travelled so far, m."""
        share = self._shares[number]
        way = self._way + slack / share if share > 0.0 else inf if slack > 0.0 else self._way
        heappush(self._heap, (way, number))

    def take(self) -> list[int]:
        """Take out the numbers of the pairs that are due."""
        numbers = []
        while self._heap and self._heap[0][0] <= self._way:
            numbers.append(heappop(self._heap)[1])
        return numbers

    def begin(self) -> None:
        """Begin the way anew."""
        self._heap = [(due - self._way, number) for due, number in self._heap]
        heapify(self._heap)
        self._way = 0.0


class ContactWatch:
    """Watches one run for contacts.

    Args:
        cell: solids beside the robot and on its flange.
        model: of the arm.
        report: called for a contact that has begun, when it is known how deep it gets until the next thing happens,
            once for each line and names; and at its end, if it got deeper. Has the contact so far, and the tick.

    Attributes:
        contacts: those that are over, in the order of their ends.
    """

    __slots__ = (
        "_begin_tick",
        "_best",
        "_by_climb",
        "_by_way",
        "_frames",
        "_joints",
        "_line",
        "_moves",
        "_news",
        "_pairs",
        "_report",
        "_said",
        "_touched",
        "_turned",
        "contacts",
    )

    def __init__(self, cell: Cell, model: RobotModel, report: Callable[[Contact, int], None]) -> None:
        self._frames = frames_of(model.arm)
        self._report = report
        self._pairs = list(watched_pairs(cell, model))
        levers = [pair.levers for pair in self._pairs]
        self._by_way = _Queue(levers)
        """Pairs that are due by their travel."""
        self._by_climb = _Queue([(0.0, b, c, d, e, f) for _, b, c, d, e, f in levers])
        """Pairs that are due by their vertical travel."""
        self._turned = ZERO_SIX
        """How far each joint has turned, back and forth added up, at most, rad."""
        self._joints: tuple[int, Six] = (-1, ZERO_SIX)
        """The latest tick whose target was read, and the target."""
        self._touched: set[int] = set()
        """Numbers of the pairs that touch anywhere in the present span, or nearly."""
        self._moves: dict[Hashable, _Move] = {}
        """What is known of moves that were watched, by their courses."""
        self._best: dict[str, tuple[Closest, int, int, str]] = {}
        """Closest distance by thing: where, tick, line and what came so close."""
        self._begin_tick: int | None = None
        self._line = 0
        self._news: list[Pair] = []
        """Pairs whose contact has begun in the present span."""
        self.contacts: list[Contact] = []
        self._said: dict[tuple[int, str, str], float] = {}
        """Distances that were reported, by line and names."""

    # ---------------------------------------------------------------- watching

    def record(self, arm: MovingArm, until_tick: int) -> None:
        """Watch from the present tick to a later one, before which nothing is due."""
        self._line = arm.line or self._line
        if self._begin_tick is None:
            self._begin(arm)
        if arm.is_resting:
            return
        begin = arm.tick
        course = arm.course(begin, until_tick) if until_tick - begin >= _WORTHWHILE_TICKS else None
        known = None if course is None else self._moves.get(course)
        targets: Sequence[Six] = ()
        turned = arm.turned(begin, until_tick) if known is None else known.turned
        if turned is None:
            targets = self._targets(arm, until_tick)
            turned = turning(targets)[-1]
        if not any(turned):
            return
        before = self._turned
        a, b, c, d, e, f = before
        g, h, i, j, k, m = turned
        self._turned = (a + g, b + h, c + i, d + j, e + k, f + m)
        is_due = self._by_way.turn(turned)
        is_due = self._by_climb.turn(turned) or is_due
        if known is not None:
            # The others did not touch, and came no nearer than is known; what is due stays due.
            if known.touched:
                span = Span(arm, until_tick, self._frames)
                for number in known.touched:
                    self._watch(number, span, before)
        elif is_due or course is not None:
            self._touched.clear()
            if is_due:
                span = Span(arm, until_tick, self._frames, targets)
                for number in sorted([*self._by_way.take(), *self._by_climb.take()]):
                    self._watch(number, span, before)
                    self._put(number)
            if course is not None and len(self._moves) < _MOVES:
                self._moves[course] = _Move(turned, tuple(sorted(self._touched)))
        if self._news:
            self._tell_news()
        if sum(self._turned) > _FARTHEST_RAD:
            self._begin_sums()

    def _targets(self, arm: MovingArm, until_tick: int) -> list[Six]:
        """Return the target joints at every tick from the present one on."""
        begin = arm.tick
        tick, q = self._joints
        if tick == begin:
            targets = [q, *[q for q, _ in arm.targets_at(range(begin + 1, until_tick + 1))]]
        else:
            targets = [q for q, _ in arm.targets_at(range(begin, until_tick + 1))]
        self._joints = until_tick, targets[-1]
        return targets

    def _begin_sums(self) -> None:
        """Begin the sums of turns and ways anew."""
        for pair in self._pairs:
            travel, rise = pair.travel(turned_since(self._turned, pair.turned))
            pair.gap = Gap(pair.gap.distance - travel, pair.gap.height - rise) if pair.contact is None else pair.gap
            pair.turned = ZERO_SIX
        self._by_way.begin()
        self._by_climb.begin()
        self._turned = ZERO_SIX

    def finish(self, arm: MovingArm, *, has_run: bool = True) -> None:
        """End the watch: the run is over.

        Args:
            arm: the arm.
            has_run: whether its present tick has run; if not, the one before is the last.
        """
        end = arm.tick + has_run
        if has_run:
            # The last row of a trace shows the arm after the motion of the last tick.
            self.record(arm, end)
        for pair in self._pairs:
            if pair.contact is not None:
                self._end(pair, end)

    @property
    def now(self) -> list[Contact]:
        """Contacts that are over and those that go on, in the order of their starts."""
        going_on = [_contact(pair, pair.contact, -1) for pair in self._pairs if pair.contact is not None]
        return sorted([*self.contacts, *going_on], key=lambda its: its.start_s)

    @property
    def clearances(self) -> list[Contact]:
        """The closest that anything came to each thing, in the order of the world file."""
        return [
            Contact(seconds(tick), seconds(tick), line, first, second, near.distance, seconds(tick), False, near[1:])
            for second, (near, tick, line, first) in self._best.items()
        ]

    def _begin(self, arm: MovingArm) -> None:
        self._begin_tick = arm.tick
        span = Span(arm, arm.tick, self._frames)
        # Things in their own order, whatever comes closest.
        for number, pair in enumerate(self._pairs):
            pair.gap = self._gap(pair, span, arm.tick)
            self._visit(pair, span, arm.tick, pair.gap.distance)
            self._put(number)
        if self._news:
            self._tell_news()

    def _watch(self, number: int, span: Span, turned: Six) -> None:
        """Watch a pair in a span.

        Args:
            number: of the pair.
            span: the joints.
            turned: how far each joint had turned at its begin, as in `_turned`.
        """
        pair = self._pairs[number]
        travel, rise = span.travel(pair, span.begin, span.end)
        before = pair.gap
        if pair.turned != turned and pair.contact is None:
            way, climb = pair.travel(turned_since(turned, pair.turned))
            before = Gap(before.distance - way, before.height - climb)
        pair.turned = self._turned
        if pair.contact is None:
            matters = self._matters(pair)
            if before.distance - travel >= matters or before.height - rise >= matters:
                pair.gap = Gap(before.distance - travel, before.height - rise)
                return
            if before.distance <= matters and before.height <= matters:
                before = self._gap(pair, span, span.begin)
        else:
            self._touched.add(number)
        pair.gap = self._gap(pair, span, span.end)
        if self._refine(pair, span, span.begin, before, span.end, pair.gap, travel, rise) <= _TOUCH_M:
            self._touched.add(number)

    def _put(self, number: int) -> None:
        """Have a pair due when something that matters can have happened to it."""
        pair = self._pairs[number]
        if pair.contact is not None:
            self._by_way.put(number, 0.0)
            return
        matters = self._matters(pair)
        slack, climb = pair.gap.distance - matters, pair.gap.height - matters
        if slack > climb:
            self._by_way.put(number, slack)
        else:
            self._by_climb.put(number, climb)

    def _matters(self, pair: Pair) -> float:
        """Return the distance above which nothing matters, for a pair that does not touch."""
        best = self._best.get(pair.second.name) if pair.is_thing else None
        if best is None:
            return _TOUCH_M
        distance = best[0].distance
        return max(distance - max(TOLERANCE_M, TOLERANCE * distance), _TOUCH_M)

    def _refine(
        self,
        pair: Pair,
        span: Span,
        begin: int,
        before: Gap,
        end: int,
        after: Gap,
        travel: float,
        rise: float,
    ) -> float:
        """Find what happens from one tick, which was visited, to another, and visit that.

        Returns the least distance that was visited.

        Args:
            pair: the pair.
            span: the joints.
            begin: the first tick.
            before: gap there, or a lower bound of it if the pair does not touch.
            end: the last tick.
            after: gap there.
            travel: of the pair in between, m.
            rise: its vertical travel in between, m.
        """
        least = after.distance
        while end - begin > 1:
            first, last = before.distance, after.distance
            nearest = 0.5 * max(first + last - travel, before.height + after.height - rise)
            if pair.contact is None:
                is_clear = last > 0.0 and nearest >= self._matters(pair)
            else:
                deepest = min(first, last, pair.contact.deepest.distance)
                is_clear = first + last + travel <= 0.0 and nearest >= deepest - max(
                    TOLERANCE_M, -DEPTH_TOLERANCE * deepest
                )
            if is_clear:
                break
            middle = (begin + end) // 2
            gap = self._gap(pair, span, middle)
            least = min(least, self._refine(pair, span, begin, before, middle, gap, *span.travel(pair, begin, middle)))
            begin, before = middle, gap
            travel, rise = span.travel(pair, middle, end)
        self._visit(pair, span, end, after.distance)
        return least

    def _visit(self, pair: Pair, span: Span, tick: int, value: float) -> None:
        """Note a contact that begins, goes on or ends at a tick."""
        contact = pair.contact
        if value > 0.0:
            if contact is not None:
                self._end(pair, tick)
            return
        if contact is not None and value >= contact.deepest.distance:
            return
        _, found = measured(pair, span, tick, _AMPLE_M)
        assert found is not None
        if contact is None:
            pair.contact = OpenContact(self._row(tick), self._line, found)
            self._news.append(pair)
        else:
            contact.deepest, contact.tick = found, self._row(tick)

    def _gap(self, pair: Pair, span: Span, tick: int) -> Gap:
        """Return the gap of a pair at a tick."""
        best = self._best.get(pair.second.name)
        is_first = pair.is_thing and best is None
        ample = inf if is_first else self._matters(pair) + _AMPLE_M
        gap, found = measured(pair, span, tick, ample)
        if found is not None and pair.is_thing and (best is None or found.distance < best[0].distance):
            self._best[pair.second.name] = (found, self._row(tick), self._line, pair.first.name)
        return gap

    def _row(self, tick: int) -> int:
        """Return the tick whose row of a trace has the joints of a tick: it shows the arm after the tick's motion."""
        return max(tick - 1, self._begin_tick or 0)

    # ---------------------------------------------------------------- reporting

    def _tell_news(self) -> None:
        """Report the contacts that have begun."""
        news, self._news = self._news, []
        begun = [(pair.contact, pair) for pair in news if pair.contact is not None]
        for contact, pair in sorted(begun, key=lambda its: its[0].start_tick):
            self._tell(_contact(pair, contact, -1), contact.start_tick)

    def _end(self, pair: Pair, tick: int) -> None:
        tick = self._row(tick)
        contact, pair.contact = pair.contact, None
        assert contact is not None
        found = _contact(pair, contact, tick)
        self.contacts.append(found)
        # One that has begun in the present span is reported as of its begin.
        self._tell(found, contact.start_tick if pair in self._news else tick)

    def _tell(self, contact: Contact, tick: int) -> None:
        """Report a contact, unless that was done before: then only if it is deeper."""
        key = (contact.line, contact.first, contact.second)
        said = self._said.get(key)
        if said is None or contact.distance_m < said - _DEEPER_M:
            self._said[key] = contact.distance_m
            self._report(contact, tick)


def _contact(pair: Pair, contact: OpenContact, end_tick: int) -> Contact:
    return Contact(
        seconds(contact.start_tick),
        seconds(end_tick if end_tick >= 0 else contact.tick),
        contact.line,
        pair.first.name,
        pair.second.name,
        contact.deepest.distance,
        seconds(contact.tick),
        True,
        contact.deepest[1:],
    )
