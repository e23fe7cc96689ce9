"""Groups of solids that move together, and the pairs of them whose distance is watched."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import hypot, inf
from typing import Final

from elitescript.kinematics.rotations import Vector3
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX
from elitescript.models.model import RobotModel
from elitescript.records import NamedTuple
from elitescript.solids.arm import arm_parts
from elitescript.solids.bodies import Body, body_of
from elitescript.solids.cell import LINKS, Cell
from elitescript.solids.distance import Closest
from elitescript.solids.frames import lever_arms
from elitescript.solids.shapes import BASE, FLANGE, Part

NOT_WATCHED: Final = frozenset(((0, 2), (3, 5), (4, 6)))
"""Links that the joints between them do not bring together, though they are not neighbours: the upper arm passes the
base at the side, and the wrists turn within their lengths. The solids of forearm and wrist 2 of CS620 and CS625 meet by
11 mm where the edge of a cap, which is rounded on the real arm, passes; that they do not is *assumed*."""


class Group:
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


class Gap(NamedTuple):
    """How far two groups are apart at a tick, m."""

    distance: float
    """Or a lower bound that is well above what matters."""
    height: float
    """Vertical gap, or a lower bound; -inf between links."""


class OpenContact:
    """A contact that goes on."""

    __slots__ = ("deepest", "line", "start_tick", "tick")

    def __init__(self, tick: int, line: int, deepest: Closest) -> None:
        self.start_tick = self.tick = tick
        self.line = line
        self.deepest = deepest


class Pair:
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

    def __init__(self, first: Group, second: Group, levers: tuple[float, ...], is_thing: bool) -> None:
        self.first = first
        self.second = second
        self.is_thing = is_thing
        self.levers = levers
        self.is_carried = is_thing and first.link == FLANGE - 1
        """Whether it is what the flange carries against a thing."""
        self.gap = Gap(inf, inf)
        """As it was when the joints had turned by `turned`, or a lower bound."""
        self.turned = ZERO_SIX
        self.contact: OpenContact | None = None

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


def watched_pairs(cell: Cell, model: RobotModel) -> Iterable[Pair]:
    """Yield the pairs that are watched: those of things in the order of the file, then those of the arm itself."""
    links: dict[str, list[Part]] = {name: [] for name in LINKS}
    for part in arm_parts(model):
        if part.role != "ring":
            links[LINKS[min(part.link, FLANGE - 1)]].append(part)
    held: dict[str, list[Part]] = {}
    things: dict[str, list[Part]] = {}
    for part in cell.parts:
        (things if part.link == BASE else held).setdefault(part.name, []).append(part)
    arm = [Group(name, parts) for name, parts in links.items() if parts]
    tools = [Group(name, parts) for name, parts in held.items()]

    # The base is round about the axis of the first joint: as a part of the next link it is where it is.
    base = [
        part._replace(pose=(*part.pose[:2], part.pose[2] - model.arm.d1, *part.pose[3:])) for part in links[LINKS[0]]
    ]
    static = [Group(LINKS[0], base, 1), *arm[1:]]

    def pair(first: Group, second: Group, is_thing: bool) -> Iterable[Pair]:
        if frozenset((first.name, second.name)) not in cell.ignored:
            levers = lever_arms(model.arm, second.link, first.link, first.reach, first.across)
            yield Pair(first, second, levers, is_thing)

    for name, parts in things.items():
        thing = Group(name, parts)
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
