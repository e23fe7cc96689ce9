"""A stretch of time: joints and groups of solids at its ticks, how far they go in between, and distances at a tick."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from math import inf
from typing import Protocol

from elitescript.kinematics.rotations import Vector3
from elitescript.kinematics.transforms import Transform, compose
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX
from elitescript.solids.bodies import Body
from elitescript.solids.distance import Closest, ball_distance, closest, least_distance
from elitescript.solids.frames import Frames
from elitescript.solids.pairs import Gap, Group, Pair


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


class PlacedGroup:
    """A group where it is at a tick; what is asked of it is computed once for all pairs."""

    __slots__ = ("T_ball", "_T_link", "_levels", "_solids", "group")

    def __init__(self, group: Group, T_link: Transform) -> None:
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


class Span:
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
        self._placed_at: dict[tuple[int, Group], PlacedGroup] = {}
        self._turned_at: dict[int, Six] = {self.begin: ZERO_SIX}
        """How far each joint has turned since the begin, back and forth added up, rad."""
        self._tool: Vector3 | None = None
        """The TCP, if it is known how far it goes."""
        self._tool_at: dict[int, tuple[float, float]] = {self.begin: (0.0, 0.0)}
        """How far the TCP has gone since the begin, m, and how far the tool has turned, rad."""
        if targets:
            ticks = range(self.begin, end + 1)
            self._joints_at.update(zip(ticks, targets, strict=True))
            self._turned_at.update(zip(ticks, turning(targets), strict=True))
        elif end > self.begin and (tool := arm.tool_way(self.begin, end)) is not None:
            self._tool = tool[2]

    def joints(self, tick: int) -> Six:
        """Return the target joints at a tick, rad."""
        found = self._joints_at.get(tick)
        if found is None:
            found = self._joints_at[tick] = self._arm.targets_at(range(tick, tick + 1))[0][0]
        return found

    def placed(self, group: Group, tick: int) -> PlacedGroup:
        """Return a group at a tick."""
        found = self._placed_at.get((tick, group))
        if found is None:
            frames = self._frames_at.get(tick)
            if frames is None:
                frames = self._frames_at[tick] = self._frames(self.joints(tick))
            found = self._placed_at[tick, group] = PlacedGroup(group, frames[group.link])
        return found

    def travel(self, pair: Pair, begin: int, end: int) -> tuple[float, float]:
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
        turned = turned_since(self._turned_to(end), self._turned_to(begin))
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


def turning(targets: Sequence[Six]) -> list[Six]:
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


def turned_since(turned: Six, begin: Six) -> Six:
    """Return how far each joint has turned since it had turned by another sum, rad."""
    a, b, c, d, e, f = begin
    g, h, i, j, k, m = turned
    return g - a, h - b, i - c, j - d, k - e, m - f


def measured(pair: Pair, span: Span, tick: int, ample: float) -> tuple[Gap, Closest | None]:
    """Return the gap of a pair and where it is; or lower bounds of which one is at least `ample`, and None."""
    second = pair.second
    placed = span.placed(pair.first, tick)
    height = -inf
    if pair.is_thing:
        low, high = placed.levels()
        bottom, top = second.levels
        height = max(low - top, bottom - high)
        if height >= ample:
            return Gap(height, height), None
        others = second.solids
    else:
        other = span.placed(second, tick)
        least = least_distance(pair.first.ball, placed.T_ball, second.ball, other.T_ball)
        if least >= ample:
            return Gap(least, height), None
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
        return Gap(least, height), None
    return Gap(best.distance, height), best


def _bound(candidate: tuple[float, Body, Transform, Body, Transform]) -> float:
    return candidate[0]
