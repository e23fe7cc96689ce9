"""Functions of numbers and vectors (manual 2.10 sections 2.2.8 to 2.2.23 and 2.2.33). Angles are radians."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any

from elitescript.commands.definition.quantities import AsGiven, Either, Integer, Number, Radians, Real, Vector, Whole
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import STATE
from elitescript.errors import InvalidValueError
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot
    from elitescript.messages.profile import Profile

_Degrees = Annotated[float, Number("deg")]
_SineOrCosine = Annotated[float, Number("", -1.0, 1.0)]
_NotNegative = Annotated[float, Number("", 0.0)]
_Positive = Annotated[float, Number("", 0.0, is_low_open=True)]
_Numbers = Annotated[tuple[float, ...], Vector(Number(), None)]
_RealAsGiven = Annotated[float, AsGiven()]
_WholeOrReal = Annotated[float, Either(Integer(), Number())]


@command(family="math", manual="2.2.8")
def acos(f: _SineOrCosine) -> Radians:
    """Return the arc cosine.

    Args:
        f: the cosine.

    Returns:
        The angle, 0 to pi.
    """
    return math.acos(f)


@command(family="math", manual="2.2.9")
def asin(f: _SineOrCosine) -> Radians:
    """Return the arc sine.

    Args:
        f: the sine.

    Returns:
        The angle, -pi/2 to pi/2.
    """
    return math.asin(f)


@command(family="math", manual="2.2.10")
def atan(f: Real) -> Radians:
    """Return the arc tangent.

    Args:
        f: the tangent.

    Returns:
        The angle, -pi/2 to pi/2.
    """
    return math.atan(f)


@command(family="math", manual="2.2.11")
def atan2(x: Real, y: Real) -> Radians:
    """Return the angle whose tangent is x/y, in the right quadrant; arguments as in Python's `math.atan2`.

    Args:
        x: numerator, the sine times some length.
        y: denominator, the cosine times the same length.

    Returns:
        The angle, -pi to pi.
    """
    return math.atan2(x, y)


@command(family="math", manual="2.2.12")
def cos(f: Radians) -> _SineOrCosine:
    """Return the cosine.

    Args:
        f: the angle.

    Returns:
        The cosine.
    """
    return math.cos(f)


@command(family="math", manual="2.2.13")
def sin(f: Radians) -> _SineOrCosine:
    """Return the sine.

    Args:
        f: the angle.

    Returns:
        The sine.
    """
    return math.sin(f)


@command(family="math", manual="2.2.14")
def tan(f: Radians) -> Real:
    """Return the tangent.

    Args:
        f: the angle.

    Returns:
        The tangent.
    """
    return math.tan(f)


@command(family="math", manual="2.2.15")
def d2r(d: _Degrees) -> Radians:
    """Convert degrees to radians.

    Args:
        d: angle in degrees.

    Returns:
        The angle in radians.
    """
    return math.radians(d)


@command(family="math", manual="2.2.16")
def r2d(r: Radians) -> _Degrees:
    """Convert radians to degrees.

    Args:
        r: angle in radians.

    Returns:
        The angle in degrees.

    Raises:
        InvalidValueError: the result is too large for a float.
    """
    return _finite(math.degrees(r), "the angle in degrees")


@command(family="math", manual="2.2.17")
def ceil(f: Real) -> Whole:
    """Return the smallest whole number that is not below a number.

    Args:
        f: the number.

    Returns:
        The whole number.
    """
    return math.ceil(f)


@command(family="math", manual="2.2.18")
def floor(f: Real) -> Whole:
    """Return the largest whole number that is not above a number.

    Args:
        f: the number.

    Returns:
        The whole number.
    """
    return math.floor(f)


@command(family="math", manual="2.2.19")
def log(b: _Positive, f: _Positive) -> Real:
    """Return the logarithm of `f` to the base `b`. The base comes first, unlike in Python.

    Args:
        b: base.
        f: number.

    Returns:
        The logarithm.

    Raises:
        ArgumentRangeError: a negative number or 0.
        InvalidValueError: base 1.
    """
    if b == 1.0:
        raise InvalidValueError("b is 1, which is the base of no logarithm", argument="b", value=b, limit="not 1")
    return math.log(f, b)


@command(family="math", manual="2.2.20")
def sqrt(f: _NotNegative) -> _NotNegative:
    """Return the square root.

    Args:
        f: the number.

    Returns:
        The root.

    Raises:
        ArgumentRangeError: a negative number.
    """
    return math.sqrt(f)


@command(family="math", manual="2.2.21")
def pow(profile: Profile, base: _RealAsGiven, exponent: _RealAsGiven) -> _WholeOrReal:
    """Return `base` to the power of `exponent`.

    Args:
        base: base.
        exponent: exponent.

    Returns:
        The power: whole if base and exponent are whole and the exponent is not negative (2 to the power of 3 is 8),
        else a float.

    Raises:
        InvalidValueError: the result is not a real number or too large for a float.
    """
    try:
        power = math.pow(base, exponent)
    except OverflowError:
        reason = "is too large for a float"
    except ValueError:
        reason = "is not a real number"
    else:
        is_whole = profile.are_powers_whole and isinstance(base, int) and isinstance(exponent, int) and exponent >= 0
        return base**exponent if is_whole else power
    raise InvalidValueError(
        said("{base:g} to the power of {exponent:g} {reason}", base=base, exponent=exponent, reason=reason),
        value=[base, exponent],
    )


@command(family="math", manual="2.2.22")
def norm(a: Annotated[Any, Either(Number(), Vector(Number(), None))]) -> _NotNegative:
    """Return the absolute value of a number, or the Euclidean length of a list or pose.

    Of a pose all six numbers count, m and rad mixed.

    Args:
        a: the number, list or pose.

    Returns:
        The norm.
    """
    return abs(a) if isinstance(a, float) else _length(a)


@command(family="math", manual="2.2.23")
def normalize(v: _Numbers) -> _Numbers:
    """Scale a vector to length 1.

    Args:
        v: vector with any number of elements.

    Returns:
        The vector divided by its Euclidean length.

    Raises:
        InvalidValueError: all elements are 0.
    """
    if not any(v):
        raise InvalidValueError(
            said("v is {v}, and a vector of length 0 has no direction", v=list(v)),
            argument="v",
            value=list(v),
            limit="length > 0",
        )
    length = _length(v)
    return tuple(element / length for element in v)


@command(family="math", manual="2.2.33")
def random(robot: Robot) -> Annotated[float, Number("", 0.0, 1.0), STATE]:
    """Return a pseudo-random number; the seed of the run decides the sequence.

    Returns:
        A number from 0 to 1, without 1.
    """
    return robot.random()


def _length(v: tuple[float, ...]) -> float:
    return _finite(math.hypot(*v), "the length")


def _finite(result: float, what: str) -> float:
    if math.isinf(result):
        raise InvalidValueError(said("{what} is too large for a float", what=what))
    return result
