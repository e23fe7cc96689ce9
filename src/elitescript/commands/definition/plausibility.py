"""Detects values that are legal but hardly meant: degrees for radians, millimetres for metres, and their like.

`JUDGES` has a row for each `meaning` of a quantity: a pure function from a value to doubts. The checker applies it to
values that are certain before the run, and to ranges of numbers (`Range`): a doubt is then one about each of them.
`Command.call` applies it to the values of the run, so both report the same.

The bounds lie so far above what any arm does that no legal value meets them (*assumed*: a bound is a factor above
the largest number that an arm of this family has, and below what the same quantity usually is in the other unit).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import hypot, inf, isinf, pi, radians
from typing import Any, Final, Protocol

from elitescript.kinematics.arm import Arm
from elitescript.records import NamedTuple
from elitescript.said import said

FULL_TURN: Final = 2.0 * pi + 0.01
"""Joints of all arms end at a full turn to either side, rad; with room for rounded numbers."""

SURELY_DEGREES: Final = 10.0
"""An angle beyond it was meant in degrees, rad. Poses of programs that add up turns come beyond one full turn."""

ROUND_DEGREES: Final = 0.5
"""Between a full turn and `SURELY_DEGREES` multiples of this are taken for degrees: radians are hardly ever round."""

POSE_MOST_M: Final = 6.0
"""Coordinate of a pose: the largest arm reaches 1.8 m; twice that, and a tool of the same length again."""

TCP_MOST_M: Final = 3.0
"""Coordinate of a TCP: tools of a metre exist, none is much longer than the largest arm reaches."""

COG_MOST_M: Final = 1.8
"""Distance of a centre of gravity from the flange while the arm is not known: the reach of the largest one."""

JOINT_SPEED_MOST: Final = 10.0
"""rad/s; the fastest joint of all arms turns with 6.28."""

JOINT_ACCELERATION_MOST: Final = 50.0
"""rad/s^2; the vendor's driver streams with 40, and all arms are limited to it."""

TOOL_SPEED_MOST: Final = 5.0
"""m/s; the stretched CS620 would reach 3.8."""

TOOL_ACCELERATION_MOST: Final = 50.0
"""m/s^2; the vendor's driver streams with 40, and all arms are limited to it."""

BLEND_MOST_M: Final = 2.0
"""A radius beyond it holds the whole workspace of the largest arm."""

PAYLOAD_MOST_KG: Final = 25.0
"""Payload of the strongest arm."""

_NEAR_M: Final = 1.5
"""Coordinates below are lengths beyond doubt: less than a quarter of a turn."""
QUARTER_ROOM: Final = 2e-3
"""Joint positions are often quarters of a turn, written as 1.57 or 3.14, rad."""

_POSE: Final = ("x", "y", "z", "Rx", "Ry", "Rz")


class Range(float):
    """A number of which only a range is known, without 0 in it: its end that is nearest to 0.

    Args:
        near: that end.
        far: the other end; may be infinite.
    """

    __slots__ = ("far",)

    def __new__(cls, near: float, far: float) -> Range:
        made = super().__new__(cls, near)
        made.far = far
        return made

    far: float


class Doubt(NamedTuple):
    """A doubt about a value.

    Attributes:
        code: row of `errors.CODES`.
        text: what it is, with value and unit; follows command and parameter.
        hint: what to do about it.
        element: index of the doubtful element; None for the whole value.
    """

    code: str
    text: str
    hint: str
    element: int | None = None


class ArmFacts(Protocol):
    """Facts of the arm on which doubts depend."""

    @property
    def name(self) -> str: ...

    @property
    def arm(self) -> Arm: ...

    @property
    def joint_ranges(self) -> tuple[tuple[float, float], ...]: ...

    @property
    def payload_max_kg(self) -> float: ...


Judge = Callable[[Any, ArmFacts | None], Iterator[Doubt]]


def _numbers(value: Any) -> Iterator[tuple[int, float]]:
    """Yield the elements of a list that are certain; a bool is none."""
    if isinstance(value, (list, tuple)):
        for index, number in enumerate(value):
            if isinstance(number, (int, float)) and not isinstance(number, bool):
                yield index, number


def _is_within(value: Any, most: float) -> bool:
    """Return whether all elements are certain and beyond doubt; the fast path for streams."""
    try:
        return bool(-most <= min(value) and max(value) <= most)
    except (TypeError, ValueError):
        return False


def number_text(number: float) -> str:
    """Return a number, or a range, for a text."""
    if not isinstance(number, Range):
        return f"{number:g}"
    if isinf(number.far):
        return said("{number:g} or more", number=number) if number > 0 else said("{number:g} or less", number=number)
    return said("{least:g} to {most:g}", least=min(number, number.far), most=max(number, number.far))


def _degrees(number: float) -> str:
    return said(
        "{number:g} looks like degrees: d2r({number:g}) is {radians:.5g}", number=number, radians=radians(number)
    )


def _millimetres(number: float) -> str:
    return said(
        "{number:g} looks like millimetres: {number:g} mm are {meant:g} m", number=number, meant=number / 1000.0
    )


def _joints(value: Any, arm: ArmFacts | None) -> Iterator[Doubt]:
    if _is_within(value, FULL_TURN):
        return
    for index, number in _numbers(value):
        if _is_degrees(number):
            yield Doubt(
                "W230",
                said("[{index}] is {number} rad, more than a full turn", index=index, number=number_text(number)),
                _degrees(number),
                index,
            )
            return


def _pose(value: Any, arm: ArmFacts | None) -> Iterator[Doubt]:
    if _is_within(value, FULL_TURN) and _is_within(value[:3], _NEAR_M):
        return
    quarters = [index for index, number in _numbers(value) if index < 3 and _is_quarter(number)]
    if len(quarters) > 1:
        # A place with two of these coordinates is 2.2 m away: out of the reach of all arms.
        text = " looks like joint positions: two of x, y and z are quarters of a turn"
        yield Doubt("W237", text, "movej goes to joint positions, get_forward_kin turns them into a pose")
    else:
        yield from _transform(value, POSE_MOST_M)


def _is_quarter(number: float) -> bool:
    return not isinstance(number, Range) and abs(number) > QUARTER_ROOM and is_quarter_turns(abs(number))


def is_quarter_turns(number: float) -> bool:
    """Return whether an angle, rad, is a rounded multiple of a quarter of a turn, from 0 to a full one."""
    turns = round(number / (0.5 * pi))
    return 0 <= turns <= 4 and abs(number - turns * 0.5 * pi) <= QUARTER_ROOM


def _transform(value: Any, most_m: float) -> Iterator[Doubt]:
    has_length = has_angle = False
    for index, number in _numbers(value):
        if index < 3 and not has_length and abs(number) > most_m:
            has_length = True
            yield Doubt(
                "W231",
                said(
                    "[{index}], {element}, is {number} m", index=index, element=_POSE[index], number=number_text(number)
                ),
                _millimetres(number),
                index,
            )
        elif index >= 3 and not has_angle and _is_degrees(number):
            has_angle = True
            text = said(
                "[{index}], {element}, is {number} rad, more than a full turn",
                index=index,
                element=_POSE[index],
                number=number_text(number),
            )
            yield Doubt("W230", text, _degrees(number), index)


def _is_degrees(number: float) -> bool:
    angle = abs(number)
    is_round = angle % ROUND_DEGREES == 0.0 and not isinstance(number, Range)
    return angle > SURELY_DEGREES or (angle > FULL_TURN and is_round)


def _tcp(value: Any, arm: ArmFacts | None) -> Iterator[Doubt]:
    return _transform(value, TCP_MOST_M)


def _centre_of_gravity(value: Any, arm: ArmFacts | None) -> Iterator[Doubt]:
    numbers = dict(_numbers(value))
    if not numbers:
        return
    distance = hypot(*numbers.values())
    index = max(numbers, key=lambda place: abs(numbers[place]))
    reach = COG_MOST_M if arm is None else abs(arm.arm.a2) + abs(arm.arm.a3) + arm.arm.d5
    if distance > reach:
        limit = (
            said("and no arm reaches further than {reach:g} m", reach=reach)
            if arm is None
            else said("the arm reaches {reach:.3g} m", reach=reach)
        )
        if any(isinstance(number, Range) for number in numbers.values()):
            distance = Range(distance, inf)
        text = said(" is {distance} m from the flange, {limit}", distance=number_text(distance), limit=limit)
        yield Doubt("W231", text, _millimetres(numbers[index]), index)


def _scalar(limit: float, unit: str, in_degrees: bool) -> Judge:
    """Return the judge of a speed or an acceleration."""

    def judge(value: Any, arm: ArmFacts | None) -> Iterator[Doubt]:
        if isinstance(value, (int, float)) and value > limit:
            yield _too_fast("", value, unit, in_degrees, None)

    return judge


def _too_fast(place: str, value: float, unit: str, in_degrees: bool, index: int | None) -> Doubt:
    text = said("{place} is {value} {unit}, more than any arm does", place=place, value=number_text(value), unit=unit)
    if in_degrees:
        other = unit.replace("rad", "deg")
        hint = said(
            "{value:g} looks like {other}: d2r({value:g}) is {radians:.5g} {unit}",
            value=value,
            other=other,
            radians=radians(value),
            unit=unit,
        )
    else:
        other = unit.replace("m/", "mm/", 1)
        hint = said(
            "{value:g} looks like {other}: that is {meant:g} {unit}",
            value=value,
            other=other,
            meant=value / 1000.0,
            unit=unit,
        )
    return Doubt("W232", text, hint, index)


def _speeds(first_turn: int) -> Judge:
    """Return the judge of a list of speeds: m/s up to an element, rad/s from it on."""

    def judge(value: Any, arm: ArmFacts | None) -> Iterator[Doubt]:
        if _is_within(value, TOOL_SPEED_MOST if first_turn else JOINT_SPEED_MOST):
            return
        for index, number in _numbers(value):
            is_turn = index >= first_turn
            if abs(number) > (JOINT_SPEED_MOST if is_turn else TOOL_SPEED_MOST):
                yield _too_fast(f"[{index}]", number, "rad/s" if is_turn else "m/s", is_turn, index)
                return

    return judge


def _blend_radius(value: Any, arm: ArmFacts | None) -> Iterator[Doubt]:
    if isinstance(value, (int, float)) and value > BLEND_MOST_M:
        yield Doubt("W231", said(" is {value} m", value=number_text(value)), _millimetres(value))


def _payload(value: Any, arm: ArmFacts | None) -> Iterator[Doubt]:
    most = PAYLOAD_MOST_KG if arm is None else arm.payload_max_kg
    if isinstance(value, (int, float)) and value > most:
        carrier = "any arm carries" if arm is None else "this arm carries"
        hint = "the mass of gripper and part together, in kg"
        if value >= 2.0 * PAYLOAD_MOST_KG:
            hint = said("{value:g} looks like grams: {value:g} g are {meant:g} kg", value=value, meant=value / 1000.0)
        yield Doubt(
            "W233",
            said(" is {value} kg; {carrier} at most {most:g} kg", value=number_text(value), carrier=carrier, most=most),
            hint,
        )


def _fraction(value: Any, arm: ArmFacts | None) -> Iterator[Doubt]:
    if isinstance(value, (int, float)) and not 0.0 <= value <= 1.0:
        hint = "it is a fraction of the range: 0 is 0 V or 4 mA, 1 is 10 V or 20 mA"
        if 1.0 < value <= 10.0:
            hint = said("{hint}; {value:g} V are {meant:g}", hint=hint, value=value, meant=value / 10.0)
        text = said(" is {value}, limited to {limit}", value=number_text(value), limit=0 if value < 0.0 else 1)
        yield Doubt("W234", text, hint)


JUDGES: Final[dict[str, Judge]] = {
    "joints": _joints,
    "roll, pitch, yaw": _joints,
    "pose": _pose,
    "tcp": _tcp,
    "centre of gravity": _centre_of_gravity,
    "joint speed": _scalar(JOINT_SPEED_MOST, "rad/s", True),
    "joint speeds": _speeds(0),
    "joint acceleration": _scalar(JOINT_ACCELERATION_MOST, "rad/s^2", True),
    "tool speed": _scalar(TOOL_SPEED_MOST, "m/s", False),
    "tool velocity": _speeds(3),
    "tool acceleration": _scalar(TOOL_ACCELERATION_MOST, "m/s^2", False),
    "blend radius": _blend_radius,
    "payload": _payload,
    "fraction": _fraction,
}
"""Functions that judge values, by meaning of the quantity."""

COMPARED: Final = frozenset(
    ("m", "rad", "deg", "m/s", "rad/s", "m/s^2", "rad/s^2", "s", "N", "kg", "m, rad", "m/s, rad/s")
)
"""Units of parameters whose values are compared with what they are."""
OF_ANGLES: Final = frozenset(("sin", "cos", "tan"))
"""Commands whose argument may be any angle in a run, but hardly one that is written in degrees."""

KINDS: Final = ("joints", "pose")
"""Meanings that are lists of six numbers, and taken for each other."""

_SIX: Final = {
    "joints": "joint positions",
    "pose": "a pose",
    "joint speeds": "joint speeds",
    "tool velocity": "a velocity of the tool",
}
"""Meanings of lists of six numbers, and their words."""

TAKEN_FOR_EACH_OTHER: Final = (*_SIX, "tcp")
"""Meanings of parameters that get a list of another kind by mistake."""


def mistaken(meaning: str, kind: str) -> Doubt | None:
    """Return the doubt about a value that is of one kind where another belongs; None if it fits.

    Args:
        meaning: of the parameter.
        kind: of the value: a meaning of a list, or empty if unknown.
    """
    if meaning == "tcp" and kind == "joints":
        return Doubt("W237", " are joint positions, where the pose of a tool belongs", "set_tcp([0, 0, 0.1, 0, 0, 0])")
    if meaning == kind or meaning not in _SIX or kind not in _SIX:
        return None
    words = _SIX[kind]
    verb, belongs = (
        ("is" if words.startswith("a ") else "are"),
        "belongs" if _SIX[meaning].startswith("a ") else "belong",
    )
    hint = ""
    if meaning in KINDS and kind in KINDS:
        hint = "get_inverse_kin turns a pose into them" if kind == "pose" else "get_forward_kin turns them into a pose"
    text = said(" {verb} {kind}, where {meant} {belongs}", verb=verb, kind=words, meant=_SIX[meaning], belongs=belongs)
    return Doubt("W237", text, hint)
