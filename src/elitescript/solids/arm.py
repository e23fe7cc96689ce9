"""Shapes arms: the parts that are drawn, from the lengths and the outline of a model.

The outline (`[outline]` of a model file) has the radii and ends of housings and tubes. Where two links meet, the second
one begins where the first one ends, so that an arm of other lengths has no gaps. An arm of one's own has the outline of
its base; a complete model without one has that of the CS66, in proportion to the reach. Small features of the castings
are left out: every part is within 5 mm of the vendor's meshes, as far as the outline tells.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.models.model import RobotModel, load_model
from elitescript.solids.shapes import ALONG_X, ALONG_Y, BASE, FLANGE, UPRIGHT, Part, placed

FLANGE_RADIUS_M: Final = 0.0315
"""As ISO 9409-1-50 has it (*assumed* for all models)."""
FLANGE_THICKNESS_M: Final = 0.006
CAP_THICKNESS_M: Final = 0.006
CAP_RADIUS: Final = 0.93
"""Of the radius of its housing."""
CAP_HEIGHT_M: Final = 0.003
"""How far a cap stands out of its housing."""
RING_LENGTH_M: Final = 0.003
RING_HEIGHT_M: Final = 0.0005
"""How far a ring stands out of the housings that meet there."""
CONNECTOR_WIDTH_M: Final = 0.024
"""Of the connector at wrist 3 (*assumed*)."""
SHORTEST_M: Final = 0.001
"""What would be shorter is left out: the lengths of an own arm leave no room for it."""

NEAREST_OUTLINE: Final = "CS66"
"""Model whose outline is scaled for an arm that has none."""


def outline_of(model: RobotModel) -> dict[str, dict[str, float]]:
    """Return the outline of a model, m; see `models.model.OUTLINE`.

    Raises:
        UsageError: a row of the model's file is wrong.
    """
    own = model.outline
    if own is not None:
        return own
    nearest = load_model(NEAREST_OUTLINE)
    scale = model.reach_m / nearest.reach_m
    outline = nearest.outline
    assert outline is not None
    return {row: {name: scale * number for name, number in numbers.items()} for row, numbers in outline.items()}


def arm_parts(model: RobotModel) -> tuple[Part, ...]:
    """Return the solids of an arm, base to flange.

    Raises:
        UsageError: a row of the outline in the model's file is wrong.
    """
    return tuple([part for part in _parts(model) if min(part.size) >= SHORTEST_M])


def _parts(model: RobotModel) -> Iterator[Part]:
    arm, outline = model.arm, outline_of(model)
    foot = outline["base"]["radius"]
    shoulder, elbow = outline["shoulder"], outline["elbow_housing"]
    upper, upper_tube = outline["upperarm_housing"], outline["upperarm_tube"]
    fore, fore_tube, end = outline["forearm_housing"], outline["forearm_tube"], outline["forearm_end"]
    wrist_1, wrist_2, wrist_3 = outline["wrist_1"], outline["wrist_2"], outline["wrist_3"]
    # Where a link begins that continues another one.
    base_to = arm.d1 + shoulder["z_from"]
    upper_from = -shoulder["y_to"]
    elbow_from = fore["z_to"]
    wrist_1_from = end["z_to"] - arm.d4
    wrist_2_from = -(arm.d5 + wrist_1["y_from"])
    wrist_3_from = wrist_2["y_to"] - arm.d6

    third = base_to / 3.0
    yield Part(BASE, "cylinder", (foot, third), placed((0.0, 0.0, 0.5 * third)), "base")
    yield Part(BASE, "cone", (foot, shoulder["radius"], 2.0 * third), placed((0.0, 0.0, 2.0 * third)), "base")

    radius = shoulder["radius"]
    yield _ring(1, shoulder["z_from"], radius)
    yield from _housing(1, radius, shoulder["z_from"], shoulder["z_to"], cap=1)
    yield _along_y(1, "housing", radius, shoulder["y_to"], 0.0)

    yield _ring(2, upper_from, max(radius, upper["radius"]))
    yield from _housing(2, upper["radius"], upper_from, upper["z_to"], cap=1)
    yield from _tube(2, upper_tube, -arm.a2, 1.0 / 3.0)
    yield from _housing(2, elbow["radius"], elbow_from, elbow["z_to"], cap=1, x=arm.a2)

    yield _ring(3, elbow_from, max(elbow["radius"], fore["radius"]))
    yield from _housing(3, fore["radius"], fore["z_from"], elbow_from, cap=-1)
    yield from _tube(3, fore_tube, -arm.a3, 1.0 / 4.0)
    yield from _housing(3, end["radius"], end["z_from"], end["z_to"], cap=-1, x=arm.a3)

    radius = wrist_1["radius"]
    yield _ring(4, wrist_1_from, max(end["radius"], radius))
    yield _along_z(4, "housing", radius, wrist_1_from, 0.0)
    yield _along_y(4, "housing", radius, wrist_1["y_from"], wrist_1["y_to"] - CAP_HEIGHT_M)
    yield _along_y(4, "cap", CAP_RADIUS * radius, wrist_1["y_to"] - CAP_THICKNESS_M, wrist_1["y_to"])

    yield _ring(5, wrist_2_from, max(radius, wrist_2["radius"]))
    radius = wrist_2["radius"]
    yield _along_z(5, "housing", radius, wrist_2_from, 0.0)
    yield _along_y(5, "housing", radius, wrist_2["y_from"] + CAP_HEIGHT_M, wrist_2["y_to"])
    yield _along_y(5, "cap", CAP_RADIUS * radius, wrist_2["y_from"], wrist_2["y_from"] + CAP_THICKNESS_M)

    yield _ring(6, wrist_3_from, max(radius, wrist_3["radius"]))
    radius = wrist_3["radius"]
    yield _along_z(6, "housing", radius, wrist_3_from, -FLANGE_THICKNESS_M)
    length = -wrist_3_from - FLANGE_THICKNESS_M
    for y in (wrist_3["y_from"], wrist_3["y_to"]):
        if abs(y) > radius + SHORTEST_M:
            size = (CONNECTOR_WIDTH_M, abs(y), 0.5 * length)
            center = (0.0, 0.5 * y, -FLANGE_THICKNESS_M - 0.5 * length)
            yield Part(6, "box", size, placed(center), "housing")

    yield _along_z(FLANGE, "flange", FLANGE_RADIUS_M, -FLANGE_THICKNESS_M, 0.0)
    # A notch, so that the turn of the flange is seen.
    notch = (0.25 * FLANGE_RADIUS_M, 0.2 * FLANGE_RADIUS_M, 1.1 * FLANGE_THICKNESS_M)
    center = (FLANGE_RADIUS_M - 0.5 * notch[0] + RING_HEIGHT_M, 0.0, -0.5 * FLANGE_THICKNESS_M)
    yield Part(FLANGE, "box", notch, placed(center), "ring")


def _along_z(link: int, role: str, radius: float, z_from: float, z_to: float, x: float = 0.0) -> Part:
    return Part(link, "cylinder", (radius, z_to - z_from), placed((x, 0.0, 0.5 * (z_from + z_to)), UPRIGHT), role)


def _along_y(link: int, role: str, radius: float, y_from: float, y_to: float) -> Part:
    return Part(link, "cylinder", (radius, y_to - y_from), placed((0.0, 0.5 * (y_from + y_to), 0.0), ALONG_Y), role)


def _ring(link: int, z: float, radius: float) -> Part:
    half = 0.5 * RING_LENGTH_M
    return _along_z(link, "ring", radius + RING_HEIGHT_M, z - half, z + half)


def _housing(link: int, radius: float, z_from: float, z_to: float, *, cap: int, x: float = 0.0) -> Iterator[Part]:
    """Yield a housing along z and the cap on its free end, the upper one (1) or the lower one (-1)."""
    if cap > 0:
        yield _along_z(link, "housing", radius, z_from, z_to - CAP_HEIGHT_M, x)
        yield _along_z(link, "cap", CAP_RADIUS * radius, z_to - CAP_THICKNESS_M, z_to, x)
    else:
        yield _along_z(link, "housing", radius, z_from + CAP_HEIGHT_M, z_to, x)
        yield _along_z(link, "cap", CAP_RADIUS * radius, z_from, z_from + CAP_THICKNESS_M, x)


def _tube(link: int, tube: dict[str, float], length: float, share: float) -> Iterator[Part]:
    """Yield a tube from the joint along -x, of which the first share is a cone."""
    first = share * length
    cone = (tube["radius"], tube["radius_first"], first)
    yield Part(link, "cone", cone, placed((-0.5 * first, 0.0, tube["z"]), ALONG_X), "tube")
    rest = (tube["radius"], length - first)
    yield Part(link, "cylinder", rest, placed((-0.5 * (first + length), 0.0, tube["z"]), ALONG_X), "tube")
