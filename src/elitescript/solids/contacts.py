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

from collections.abc import Callable, Hashable, Iterable, Sequence
from heapq import heapify, heappop, heappush
from math import hypot, inf
from typing import Final, Protocol

from elitescript.kinematics.rotations import Vector3
from elitescript.kinematics.transforms import Transform, compose
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX
from elitescript.messages.timing import seconds
from elitescript.models.model import RobotModel
from elitescript.records import NamedTuple
from elitescript.solids.arm import arm_parts
from elitescript.solids.bodies import Body, body_of
from elitescript.solids.cell import LINKS, Cell
from elitescript.solids.distance import Closest, ball_distance, closest, least_distance
from elitescript.solids.frames import Frames, frames_of, lever_arms
from elitescript.solids.shapes import BASE, FLANGE, Part

TOLERANCE_M: Final = 1e-5
TOLERANCE: Final = 0.01
"""By so much, or this share of it, the closest distance that is found may be above that of all control periods."""
DEPTH_TOLERANCE: Final = 0.1
"""Share of its depth by which a contact may get deeper than is found; exact at the ends of moves."""

NOT_WATCHED: Final = frozenset(((0, 2), (3, 5), (4, 6)))
"""Links that the joints between them do not bring together, though they are not neighbours: the upper arm passes the
base at the side, and the wrists turn within their lengths. The solids of forearm and wrist 2 of CS620 and CS625 meet by
11 mm where the edge of a cap, which is rounded on the real arm, passes; that they do not is *assumed*."""

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
        words = f"{self.first} touches {self.second}: {-1000.0 * self.distance_m:.1f} mm deep at {self.t:.3f} s"
        return words if self.t == self.start_s else f"{words}, from {self.start_s:.3f} s on"


class MovingArm(Protocol):
    """Lists what is asked of the machine that moves the arm."""

    @property
    def tick(self) -> int:
        """The present tick."""

    @property
    def line(self) -> int:
        """Line of the main thread; 0 without a program."""

    @property
    def is_resting(self) -> bool:
        """Whether nothing moves until something is due."""

    def turned(self, begin: int, end: int) -> Six | None:
        """Return how far each joint turns between two ticks, back and forth added up, at most, rad.

        Both are from the present tick to the next that is due. None if it is not known without sampling.
        """

    def tool_way(self, begin: int, end: int) -> tuple[float, float, Vector3] | None:
        """Return how far the TCP goes between two such ticks, m, how far the tool turns, rad, and the TCP.

        That is a point of the flange frame. None if it is not known.
        """

    def course(self, begin: int, end: int) -> Hashable | None:
        """Return what the target joints at all ticks between two such ticks follow from, but for rounding.

        None if that is not known, or hardly comes again.
        """

    def targets_at(self, ticks: range) -> list[tuple[Six, Six]]:
        """Return the target joints, rad, and their speeds at ticks from the present one to the next that is due."""


class _Group:
    """Solids that move together and have one name."""

    __slots__ = ("ball", "center", "levels", "link", "name", "solids")

    def __init__(self, name: str, parts: Sequence[Part], link: int | None = None) -> None:
        self.name = name
        self.link = min(parts[0].link, FLANGE - 1) if link is None else link
        self.solids = [body_of(part) for part in parts]
        low, high = [inf] * 3, [-inf] * 3
        for body, T in self.solids:
            for i in range(3):
                low[i], high[i] = min(low[i], T[9 + i] - body.bound), max(high[i], T[9 + i] + body.bound)
        x, y, z = [0.5 * (a + b) for a, b in zip(low, high, strict=True)]
        self.center = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, x, y, z)
        self.ball = Body(
            "sphere", (max(hypot(T[9] - x, T[10] - y, T[11] - z) + body.bound for body, T in self.solids),)
        )
        """Encloses all of it, about `center` of the frame of the link."""
        tops = [(T[11], body.reach(T, 0.0, 0.0, 1.0)) for body, T in self.solids]
        self.levels = min(z - reach for z, reach in tops), max(z + reach for z, reach in tops)
        """Lowest and highest point, in the frame of the link."""

    def farthest_from(self, point: Vector3) -> float:
        """Return the distance of its farthest point from a point of the link's frame, m, at most."""
        x, y, z = point
        T = self.center
        return hypot(T[9] - x, T[10] - y, T[11] - z) + self.ball.bound

    @property
    def reach(self) -> float:
        """Distance of its farthest point from the origin of the link's frame, m, at most."""
        return max(hypot(*T[9:]) + body.bound for body, T in self.solids)

    @property
    def across(self) -> float:
        """Distance of its farthest point from the z axis of the link's frame, m, at most."""
        return max(hypot(T[9], T[10]) + body.bound for body, T in self.solids)


class _Pair:
    """Two groups, and what is known of their distance."""

    __slots__ = (
        "contact",
        "first",
        "gap",
        "is_carried",
        "is_thing",
        "levers",
        "second",
        "turned",
    )

    def __init__(self, first: _Group, second: _Group, levers: tuple[float, ...], is_thing: bool) -> None:
        self.first = first
        self.second = second
        self.is_thing = is_thing
        self.levers = levers
        self.is_carried = is_thing and first.link == FLANGE - 1
        """Whether it is what the flange carries against a thing."""
        self.gap = _Gap(inf, inf)
        """As it was when the joints had turned by `turned`, or a lower bound."""
        self.turned = ZERO_SIX
        self.contact: _Open | None = None

    def travel(self, turned: Six) -> tuple[float, float]:
        """Return how far its groups move against each other, and how far in the vertical, m, at most.

        The base joint turns about the vertical and adds nothing to the latter.

        Args:
            turned: how far each joint turns, rad.
        """
        a, b, c, d, e, f = turned
        i, j, k, m, n, o = self.levers
        rise = j * b + k * c + m * d + n * e + o * f
        return i * a + rise, rise


class _Gap(NamedTuple):
    """How far two groups are apart at a tick, m."""

    distance: float
    """Or a lower bound that is well above what matters."""
    height: float
    """Vertical gap, or a lower bound; -inf between links."""


class _Open:
    """A contact that goes on."""

    __slots__ = ("deepest", "line", "start_tick", "tick")

    def __init__(self, tick: int, line: int, deepest: Closest) -> None:
        self.start_tick = self.tick = tick
        self.line = line
        self.deepest = deepest


class _Move(NamedTuple):
    """A move that was watched."""

    turned: Six
    """How far each joint turns, rad, at most."""
    touched: tuple[int, ...]
    """Numbers of the pairs that touch on it, or nearly."""


class _Placed:
    """A group where it is at a tick; what is asked of it is computed once for all pairs."""

    __slots__ = ("T_ball", "_T_link", "_levels", "_solids", "group")

    def __init__(self, group: _Group, T_link: Transform) -> None:
        self.group = group
        self._T_link = T_link
        self.T_ball = compose(T_link, group.center)
        self._solids: list[tuple[Body, Transform]] | None = None
        self._levels: tuple[float, float] | None = None

    def solids(self) -> list[tuple[Body, Transform]]:
        """Return the solids, in the base frame."""
        if self._solids is None:
            self._solids = [(body, compose(self._T_link, T)) for body, T in self.group.solids]
        return self._solids

    def levels(self) -> tuple[float, float]:
        """Return the heights of its lowest and highest point, m."""
        if self._levels is None:
            _, _, _, _, _, _, r31, r32, r33, _, _, z = self._T_link
            low, high = inf, -inf
            for body, T in self.group.solids:
                center = r31 * T[9] + r32 * T[10] + r33 * T[11] + z
                # The vertical in the frame of the link is the third row of its rotation.
                reach = body.reach(T, r31, r32, r33)
                low, high = min(low, center - reach), max(high, center + reach)
            self._levels = low, high
        return self._levels


class _Span:
    """Joints from one tick to another, how far they turn in between, and groups where they are; all computed once."""

    __slots__ = (
        "_arm",
        "_between",
        "_frames",
        "_frames_at",
        "_joints_at",
        "_placed_at",
        "_tool",
        "_tool_at",
        "_turned_at",
        "begin",
        "end",
    )

    def __init__(
        self,
        arm: MovingArm,
        end: int,
        frames: Callable[[Sequence[float]], Frames],
        targets: Sequence[Six] = (),
    ) -> None:
        """Take the arm at the present tick, the last tick, and the targets at all ticks where they had to be read."""
        self._arm = arm
        self.begin, self.end = arm.tick, end
        self._frames = frames
        self._frames_at: dict[int, Frames] = {}
        self._joints_at: dict[int, Six] = {}
        self._between: dict[tuple[int, int], tuple[Six, float, float]] = {}
        self._placed_at: dict[tuple[int, _Group], _Placed] = {}
        self._turned_at: dict[int, Six] = {self.begin: ZERO_SIX}
        """How far each joint has turned since the begin, back and forth added up, rad."""
        self._tool: Vector3 | None = None
        """The TCP, if it is known how far it goes."""
        self._tool_at: dict[int, tuple[float, float]] = {self.begin: (0.0, 0.0)}
        """How far the TCP has gone since the begin, m, and how far the tool has turned, rad."""
        if targets:
            ticks = range(self.begin, end + 1)
            self._joints_at.update(zip(ticks, targets, strict=True))
            self._turned_at.update(zip(ticks, _turned(targets), strict=True))
        elif end > self.begin and (tool := arm.tool_way(self.begin, end)) is not None:
            self._tool = tool[2]

    def joints(self, tick: int) -> Six:
        """Return the target joints at a tick, rad."""
        found = self._joints_at.get(tick)
        if found is None:
            found = self._joints_at[tick] = self._arm.targets_at(range(tick, tick + 1))[0][0]
        return found

    def placed(self, group: _Group, tick: int) -> _Placed:
        """Return a group at a tick."""
        found = self._placed_at.get((tick, group))
        if found is None:
            frames = self._frames_at.get(tick)
            if frames is None:
                frames = self._frames_at[tick] = self._frames(self.joints(tick))
            found = self._placed_at[tick, group] = _Placed(group, frames[group.link])
        return found

    def travel(self, pair: _Pair, begin: int, end: int) -> tuple[float, float]:
        """Return travel and vertical travel of a pair between two ticks, m, at most."""
        between = self._between.get((begin, end))
        if between is None:
            between = self._between[begin, end] = self._turned(begin, end)
        turned, way, turn = between
        travel, rise = pair.travel(turned)
        if self._tool is not None and pair.is_carried:
            carried = way + turn * pair.first.farthest_from(self._tool)
            return min(travel, carried), min(rise, carried)
        return travel, rise

    def _turned(self, begin: int, end: int) -> tuple[Six, float, float]:
        """Return how far each joint turns, and how far the TCP goes and the tool turns where that is known."""
        turned = _less(self._turned_to(end), self._turned_to(begin))
        if self._tool is None:
            return turned, 0.0, 0.0
        way_a, turn_a = self._tool_to(begin)
        way_b, turn_b = self._tool_to(end)
        return turned, way_b - way_a, turn_b - turn_a

    def _tool_to(self, tick: int) -> tuple[float, float]:
        found = self._tool_at.get(tick)
        if found is None:
            tool = self._arm.tool_way(self.begin, tick)
            assert tool is not None, "what is known up to the end is known up to any tick before"
            found = self._tool_at[tick] = tool[:2]
        return found

    def _turned_to(self, tick: int) -> Six:
        found = self._turned_at.get(tick)
        if found is None:
            found = self._arm.turned(self.begin, tick)
            assert found is not None, "what is known up to the end is known up to any tick before"
            self._turned_at[tick] = found
        return found


def _turned(targets: Sequence[Six]) -> list[Six]:
    """Return how far each joint has turned since the first of many positions, back and forth added up, rad."""
    a = b = c = d = e = f = 0.0
    p1, p2, p3, p4, p5, p6 = targets[0]
    sums: list[Six] = []
    for q1, q2, q3, q4, q5, q6 in targets:
        a, b, c = a + abs(q1 - p1), b + abs(q2 - p2), c + abs(q3 - p3)
        d, e, f = d + abs(q4 - p4), e + abs(q5 - p5), f + abs(q6 - p6)
        p1, p2, p3, p4, p5, p6 = q1, q2, q3, q4, q5, q6
        sums.append((a, b, c, d, e, f))
    return sums


def _less(turned: Six, begin: Six) -> Six:
    """Return how far each joint has turned since it had turned by another sum, rad."""
    a, b, c, d, e, f = begin
    g, h, i, j, k, m = turned
    return g - a, h - b, i - c, j - d, k - e, m - f


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
        self._pairs = list(_pairs(cell, model))
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
        self._news: list[_Pair] = []
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
            turned = _turned(targets)[-1]
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
                span = _Span(arm, until_tick, self._frames)
                for number in known.touched:
                    self._watch(number, span, before)
        elif is_due or course is not None:
            self._touched.clear()
            if is_due:
                span = _Span(arm, until_tick, self._frames, targets)
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
            travel, rise = pair.travel(_less(self._turned, pair.turned))
            pair.gap = _Gap(pair.gap.distance - travel, pair.gap.height - rise) if pair.contact is None else pair.gap
            pair.turned = ZERO_SIX
        self._by_way.begin()
        self._by_climb.begin()
        self._turned = ZERO_SIX

    def finish(self, arm: MovingArm) -> None:
        """End the watch: the run is over."""
        # The last row of a trace shows the arm after the motion of the last tick.
        self.record(arm, arm.tick + 1)
        for pair in self._pairs:
            if pair.contact is not None:
                self._end(pair, arm.tick + 1)

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
        span = _Span(arm, arm.tick, self._frames)
        # Things in their own order, whatever comes closest.
        for number, pair in enumerate(self._pairs):
            pair.gap = self._gap(pair, span, arm.tick)
            self._visit(pair, span, arm.tick, pair.gap.distance)
            self._put(number)
        if self._news:
            self._tell_news()

    def _watch(self, number: int, span: _Span, turned: Six) -> None:
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
            way, climb = pair.travel(_less(turned, pair.turned))
            before = _Gap(before.distance - way, before.height - climb)
        pair.turned = self._turned
        if pair.contact is None:
            matters = self._matters(pair)
            if before.distance - travel >= matters or before.height - rise >= matters:
                pair.gap = _Gap(before.distance - travel, before.height - rise)
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

    def _matters(self, pair: _Pair) -> float:
        """Return the distance above which nothing matters, for a pair that does not touch."""
        best = self._best.get(pair.second.name) if pair.is_thing else None
        if best is None:
            return _TOUCH_M
        distance = best[0].distance
        return max(distance - max(TOLERANCE_M, TOLERANCE * distance), _TOUCH_M)

    def _refine(
        self,
        pair: _Pair,
        span: _Span,
        begin: int,
        before: _Gap,
        end: int,
        after: _Gap,
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

    def _visit(self, pair: _Pair, span: _Span, tick: int, value: float) -> None:
        """Note a contact that begins, goes on or ends at a tick."""
        contact = pair.contact
        if value > 0.0:
            if contact is not None:
                self._end(pair, tick)
            return
        if contact is not None and value >= contact.deepest.distance:
            return
        _, found = _measured(pair, span, tick, _AMPLE_M)
        assert found is not None
        if contact is None:
            pair.contact = _Open(self._row(tick), self._line, found)
            self._news.append(pair)
        else:
            contact.deepest, contact.tick = found, self._row(tick)

    def _gap(self, pair: _Pair, span: _Span, tick: int) -> _Gap:
        """Return the gap of a pair at a tick."""
        best = self._best.get(pair.second.name)
        is_first = pair.is_thing and best is None
        ample = inf if is_first else self._matters(pair) + _AMPLE_M
        gap, found = _measured(pair, span, tick, ample)
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

    def _end(self, pair: _Pair, tick: int) -> None:
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


def _contact(pair: _Pair, contact: _Open, end_tick: int) -> Contact:
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


def _measured(pair: _Pair, span: _Span, tick: int, ample: float) -> tuple[_Gap, Closest | None]:
    """Return the gap of a pair and where it is; or lower bounds of which one is at least `ample`, and None."""
    second = pair.second
    placed = span.placed(pair.first, tick)
    height = -inf
    if pair.is_thing:
        low, high = placed.levels()
        bottom, top = second.levels
        height = max(low - top, bottom - high)
        if height >= ample:
            return _Gap(height, height), None
        others = second.solids
    else:
        other = span.placed(second, tick)
        least = least_distance(pair.first.ball, placed.T_ball, second.ball, other.T_ball)
        if least >= ample:
            return _Gap(least, height), None
        others = other.solids()
    least = inf
    near = []
    T_ball, radius = placed.T_ball, pair.first.ball.margin
    for body, T in others:
        bound = ball_distance(T_ball, radius, body, T)
        if bound < ample:
            near.append((body, T))
        elif bound < least:
            least = bound
    candidates = []
    if near:
        for own, T_own in placed.solids():
            for body, T in near:
                bound = ball_distance(T_own, own.bound, body, T)
                if bound < ample:
                    bound = max(bound, least_distance(own, T_own, body, T))
                if bound < ample:
                    candidates.append((bound, own, T_own, body, T))
                elif bound < least:
                    least = bound
    candidates.sort(key=_bound)
    best: Closest | None = None
    for bound, own, T_own, body, T in candidates:
        if best is not None and bound >= best.distance:
            break
        found = closest(own, T_own, body, T)
        if best is None or found.distance < best.distance:
            best = found
    if best is None or least < best.distance:
        return _Gap(least, height), None
    return _Gap(best.distance, height), best


def _bound(candidate: tuple[float, Body, Transform, Body, Transform]) -> float:
    return candidate[0]


def _pairs(cell: Cell, model: RobotModel) -> Iterable[_Pair]:
    """Yield the pairs that are watched: those of things in the order of the file, then those of the arm itself."""
    links: dict[str, list[Part]] = {name: [] for name in LINKS}
    for part in arm_parts(model):
        if part.role != "ring":
            links[LINKS[min(part.link, FLANGE - 1)]].append(part)
    held: dict[str, list[Part]] = {}
    things: dict[str, list[Part]] = {}
    for part in cell.parts:
        (things if part.link == BASE else held).setdefault(part.name, []).append(part)
    arm = [_Group(name, parts) for name, parts in links.items() if parts]
    tools = [_Group(name, parts) for name, parts in held.items()]

    # The base is round about the axis of the first joint: as a part of the next link it is where it is.
    base = [
        part._replace(pose=(*part.pose[:2], part.pose[2] - model.arm.d1, *part.pose[3:])) for part in links[LINKS[0]]
    ]
    static = [_Group(LINKS[0], base, 1), *arm[1:]]

    def pair(first: _Group, second: _Group, is_thing: bool) -> Iterable[_Pair]:
        if frozenset((first.name, second.name)) not in cell.ignored:
            levers = lever_arms(model.arm, second.link, first.link, first.reach, first.across)
            yield _Pair(first, second, levers, is_thing)

    for name, parts in things.items():
        thing = _Group(name, parts)
        for group in [*reversed(tools), *reversed(arm)]:
            if group.link != BASE:
                yield from pair(group, thing, True)
    for number, second in enumerate(static):
        for first in arm[number + 2 :]:
            if (number, first.link) not in NOT_WATCHED:
                yield from pair(first, second, False)
        for tool in tools:
            if number < FLANGE - 2:
                yield from pair(tool, second, False)
