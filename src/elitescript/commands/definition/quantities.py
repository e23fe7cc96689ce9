"""Quantities: type, shape, unit and range of a value, in one object for each kind.

A command's parameter is annotated with one of these. The same object coerces the value at run time,
checks literals before the run, and prints the reference page, so that every message has one form:
command, parameter, value, bound, unit.

Coercion: bool and int stand for each other; an int stands for a float; a float never stands for an int
(*assumed*). NaN and infinity, wrong lengths and text for a number are refused everywhere (*assumed*).
"""

from __future__ import annotations

from math import isfinite
from types import BuiltinFunctionType, FunctionType, MethodType
from typing import Annotated, Any, Final

from elitescript.errors import ArgumentRangeError, ArgumentTypeError, ScriptError
from elitescript.messages.motion import Six
from elitescript.messages.signals import SIGNALS
from elitescript.said import said

_LONGEST_SHOWN: Final = 80
"""Characters of a wrong value that a message repeats."""


_FUNCTIONS: Final = (FunctionType, BuiltinFunctionType, MethodType)
_MODULE: Final = "<module '"
_SIX: Final = 6
"""Elements of a pose and of joint positions."""
JOINED: Final = (
    "`+` and `*` join and repeat lists: add poses with pose_add or pose_trans, joint positions element by element"
)
"""Hint for a list with several times the elements that are wanted."""


def shown(value: Any) -> str:
    """Return a value as a message repeats it: short, and never raising."""
    if type(value) in _FUNCTIONS:
        return f"function {value.__name__}"
    try:
        text = repr(value)
    except Exception:
        text = f"<{type(value).__name__}>"
    return text if len(text) <= _LONGEST_SHOWN else text[: _LONGEST_SHOWN - 3] + "..."


def _described(value: Any) -> str:
    """Return type and value for a message; of functions and modules their name."""
    kind = type(value)
    if value is None:
        return "None"
    if kind in _FUNCTIONS:
        return f"function {value.__name__}"
    text = shown(value)
    if text.startswith(_MODULE):
        return f"module {text.removeprefix(_MODULE).partition(chr(39))[0]}"
    return f"{kind.__name__} {text}"


class Quantity:
    """A kind of value that scripts pass to commands.

    Attributes:
        type_name: as signatures print it.
        unit: its unit; empty for a plain number.
        meaning: row of `plausibility.JUDGES`, which finds values that are legal but hardly meant; empty for none.
    """

    __slots__ = ("meaning", "type_name", "unit")

    def __init__(self, type_name: str, unit: str = "", meaning: str = "") -> None:
        self.type_name = type_name
        self.unit = unit
        self.meaning = meaning

    @property
    def limit(self) -> str:
        """The allowed range as text; empty when anything goes."""
        return ""

    def coerce(self, value: Any) -> Any:
        """Return the value in the type that the command works with.

        Raises:
            ScriptError: with text, value, limit and unit; the caller adds command and argument.
        """
        return value

    def wrong_type(self, value: Any, wanted: str = "") -> ScriptError:
        """Return the error for a value of another type."""
        wanted = wanted or self.type_name
        given = _described(value)
        text = said("must be {wanted}, not {given}", wanted=wanted, given=given)
        return ArgumentTypeError(text, value=value, limit=wanted, unit=self.unit)

    def out_of_range(self, value: Any, limit: str = "") -> ScriptError:
        """Return the error for a value outside its range, or outside `limit` when that says it better."""
        allowed = limit or f"{self.limit} {self.unit}".rstrip()
        return ArgumentRangeError(
            said("must be {allowed}, got {value}", allowed=allowed, value=shown(value)),
            value=value,
            limit=limit or self.limit,
            unit=self.unit,
        )


def _range_text(low: float | None, high: float | None, is_low_open: bool) -> str:
    if low is None:
        return "" if high is None else f"<= {high:g}"
    if high is None:
        return f"{'>' if is_low_open else '>='} {low:g}"
    return f"in {'(' if is_low_open else '['}{low:g}, {high:g}]"


class Number(Quantity):
    """A finite float."""

    __slots__ = ("allows_non_finite", "high", "is_low_open", "low")

    def __init__(
        self,
        unit: str = "",
        low: float | None = None,
        high: float | None = None,
        *,
        is_low_open: bool = False,
        allows_non_finite: bool = False,
        meaning: str = "",
    ) -> None:
        super().__init__("float", unit, meaning)
        self.low = low
        self.high = high
        self.is_low_open = is_low_open
        self.allows_non_finite = allows_non_finite

    @property
    def limit(self) -> str:
        return _range_text(self.low, self.high, self.is_low_open)

    def coerce(self, value: Any) -> float:
        number = value if type(value) is float else self._as_float(value)
        if not isfinite(number) and not self.allows_non_finite:
            raise self.out_of_range(value, "a finite number")
        low = self.low
        if (low is not None and (number < low or (self.is_low_open and number == low))) or (
            self.high is not None and number > self.high
        ):
            raise self.out_of_range(value)
        return number

    def _as_float(self, value: Any) -> float:
        if not isinstance(value, (int, float)):
            raise self.wrong_type(value, "a number")
        try:
            return float(value)
        except OverflowError:
            raise self.out_of_range(value, "a number that fits a float") from None


class AsGiven(Number):
    """A finite number that fits a float; an int stays one."""

    __slots__ = ()

    def coerce(self, value: Any) -> float:
        number = super().coerce(value)
        return int(value) if isinstance(value, int) else number


class Integer(Quantity):
    """An int."""

    __slots__ = ("high", "low")

    def __init__(self, low: int | None = None, high: int | None = None, unit: str = "") -> None:
        super().__init__("int", unit)
        self.low = low
        self.high = high

    @property
    def limit(self) -> str:
        if self.low is None or self.high is None:
            return _range_text(self.low, self.high, False)
        return f"in [{self.low}, {self.high}]"

    def coerce(self, value: Any) -> int:
        number: int = value
        if type(value) is not int:
            if not isinstance(value, int):
                raise self.wrong_type(value, "an int")
            number = int(value)
        if (self.low is not None and number < self.low) or (self.high is not None and number > self.high):
            raise self.out_of_range(value)
        return number


class Choice(Quantity):
    """One of a few ints or strings."""

    __slots__ = ("choices",)

    def __init__(self, *choices: Any, unit: str = "") -> None:
        super().__init__(type(choices[0]).__name__, unit)
        self.choices = choices

    @property
    def limit(self) -> str:
        return "one of " + ", ".join(repr(choice) for choice in self.choices)

    def coerce(self, value: Any) -> Any:
        kind = type(self.choices[0])
        if not isinstance(value, kind):
            raise self.wrong_type(value)
        if value not in self.choices:
            raise self.out_of_range(value)
        return kind(value)


class Boolean(Quantity):
    """A bool; an int stands for whether it is not 0."""

    __slots__ = ()

    def __init__(self) -> None:
        super().__init__("bool")

    def coerce(self, value: Any) -> bool:
        if not isinstance(value, int):
            raise self.wrong_type(value, "True or False")
        return bool(value)


class Text(Quantity):
    """A str."""

    __slots__ = ()

    def __init__(self) -> None:
        super().__init__("str")

    def coerce(self, value: Any) -> str:
        if not isinstance(value, str):
            raise self.wrong_type(value, "a str")
        return value


class Octets(Quantity):
    """A bytes or bytearray object."""

    __slots__ = ()

    def __init__(self) -> None:
        super().__init__("bytes")

    def coerce(self, value: Any) -> bytes:
        if not isinstance(value, (bytes, bytearray)):
            raise self.wrong_type(value, "bytes or a bytearray")
        return bytes(value)


class Anything(Quantity):
    """Any value; the command decides."""

    __slots__ = ()

    def __init__(self, type_name: str = "any", unit: str = "") -> None:
        super().__init__(type_name, unit)


_FLOAT: Final = frozenset({float})
_FLOAT_OR_INT: Final = frozenset({float, int})
_LARGE: Final = 1e300
_PLURALS: Final = {"float": "numbers", "int": "ints", "bool": "bools"}


class Vector(Quantity):
    """A list or tuple of a fixed number of values of one kind (any number when `count` is None)."""

    __slots__ = ("_takes_any_finite", "count", "element", "names")

    def __init__(
        self, element: Quantity, count: int | None, unit: str = "", names: str = "", *, meaning: str = ""
    ) -> None:
        size = said(" of {count}", count=count) if count else ""
        super().__init__(f"list[{element.type_name}]{size}", unit or element.unit, meaning)
        self.element = element
        self._takes_any_finite = isinstance(element, Number) and not element.limit and not element.allows_non_finite
        self.count = count
        self.names = names

    @property
    def limit(self) -> str:
        each = f"each {self.element.limit}" if self.element.limit else ""
        size = f"{self.count} elements" if self.count is not None else ""
        return ", ".join(part for part in (size, each) if part)

    def coerce(self, value: Any) -> tuple[Any, ...]:
        if not isinstance(value, (list, tuple)):
            count = "" if self.count is None else f"{self.count} "
            raise self.wrong_type(
                value,
                said("a list of {count}{plurals}", count=count, plurals=_PLURALS.get(self.element.type_name, "values")),
            )
        if self.count is not None and len(value) != self.count:
            names = f" {self.names}" if self.names else ""
            raise ArgumentTypeError(
                said(
                    "must have {count} elements{names}, got {given}: {value}",
                    count=self.count,
                    names=names,
                    given=len(value),
                    value=shown(value),
                ),
                value=value,
                limit=f"{self.count} elements",
                unit=self.unit,
                hint=JOINED if self.count == _SIX and len(value) > _SIX and len(value) % _SIX == 0 else None,
            )
        items = tuple(value)
        if self._takes_any_finite:
            if _FLOAT.issuperset(map(type, items)) and all(map(isfinite, items)):
                return items
            if _FLOAT_OR_INT.issuperset(map(type, items)) and all(-_LARGE < item < _LARGE for item in items):
                return tuple(map(float, items))
        coerce = self.element.coerce
        result = []
        for index, item in enumerate(items):
            try:
                result.append(coerce(item))
            except ScriptError as error:
                error.set_text(said("element {index} {mistake}", index=index, mistake=error.said))
                error.unit = error.unit or self.unit
                raise
        return tuple(result)


class Either(Quantity):
    """A value of one of several kinds: a list goes to the vector among them, anything else to the first that fits."""

    __slots__ = ("kinds",)

    def __init__(self, *kinds: Quantity) -> None:
        units = {kind.unit: None for kind in kinds if kind.unit}
        super().__init__(" or ".join(kind.type_name for kind in kinds), " or ".join(units))
        self.kinds = kinds

    @property
    def limit(self) -> str:
        return ", ".join({kind.limit: None for kind in self.kinds if kind.limit})

    def coerce(self, value: Any) -> Any:
        is_list = isinstance(value, (list, tuple))
        for kind in self.kinds:
            if isinstance(kind, Vector) is is_list:
                try:
                    return kind.coerce(value)
                except ArgumentTypeError:
                    if is_list:
                        raise
        raise self.wrong_type(value)


class Optionally(Quantity):
    """A value that may be left out: omitted, None, `''` and the manual's placeholder mean the same.

    The function below has the default None; the placeholder is what the signature prints.
    """

    __slots__ = ("inner", "placeholder")

    def __init__(self, inner: Quantity, placeholder: str | None = "") -> None:
        super().__init__(inner.type_name, inner.unit, inner.meaning)
        self.inner = inner
        self.placeholder = placeholder

    @property
    def limit(self) -> str:
        return self.inner.limit

    def coerce(self, value: Any) -> Any:
        if value is None or (isinstance(value, str) and value in ("", self.placeholder)):
            return None
        return self.inner.coerce(value)


def signal_index(name: str) -> Integer:
    """Return the index of one point of a family of signals; see `messages.signals`."""
    return Integer(0, SIGNALS[name].size - 1)


_POSE_NAMES: Final = "[x, y, z, Rx, Ry, Rz]"
_JOINT_NAMES: Final = "[base, shoulder, elbow, wrist1, wrist2, wrist3]"
POSE: Final = Vector(Number(), 6, "m, rad", _POSE_NAMES, meaning="pose")
JOINTS: Final = Vector(Number(), 6, "rad", _JOINT_NAMES, meaning="joints")
TCP: Final = Vector(Number(), 6, "m, rad", _POSE_NAMES, meaning="tcp")

JointPositions = Annotated[Six, JOINTS]
JointSpeeds = Annotated[Six, Vector(Number(), 6, "rad/s", _JOINT_NAMES, meaning="joint speeds")]
Pose = Annotated[Six, POSE]
"""A pose of the arm, m and rad: a target or a reading."""
Frame = Annotated[Six, Vector(Number(), 6, "m, rad", _POSE_NAMES)]
"""Any transform; programs also compute with such lists in other units, or with other lists of six numbers."""
TcpOffset = Annotated[Six, TCP]
TcpSpeed = Annotated[Six, Vector(Number(), 6, "m/s, rad/s", "[Vx, Vy, Vz, RVx, RVy, RVz]", meaning="tool velocity")]
OptionalJoints = Annotated[Six | None, Optionally(JOINTS)]
OptionalTcp = Annotated[Six | None, Optionally(TCP, "active tcp")]

JointAcceleration = Annotated[float, Number("rad/s^2", 0.0, meaning="joint acceleration")]
JointSpeed = Annotated[float, Number("rad/s", 0.0, meaning="joint speed")]
JointDeceleration = Annotated[float, Number("rad/s^2", 0.0, is_low_open=True, meaning="joint acceleration")]
ToolAcceleration = Annotated[float, Number("m/s^2", 0.0, meaning="tool acceleration")]
ToolSpeed = Annotated[float, Number("m/s", 0.0, meaning="tool speed")]
ToolDeceleration = Annotated[float, Number("m/s^2", 0.0, is_low_open=True, meaning="tool acceleration")]
Seconds = Annotated[float, Number("s", 0.0)]
TimeOut = Annotated[float, Number("s")]


class UsualTimeOut(int):
    """The default of a time-out: the call has none. No value of a program is one."""

    __slots__ = ()


class _RequestTimeOut(Number):
    """The time-out of a request, which tells whether the call has one."""

    def coerce(self, value: Any) -> float:
        return value if type(value) is UsualTimeOut else super().coerce(value)


RequestTimeOut = Annotated[float, _RequestTimeOut("s")]
BlendRadius = Annotated[float, Number("m", -0.001, meaning="blend radius")]
Radians = Annotated[float, Number("rad")]
Real = Annotated[float, Number()]
Whole = Annotated[int, Integer()]
Count = Annotated[int, Integer(0)]
Bool = Annotated[bool, Boolean()]
Str = Annotated[str, Text()]
Any_ = Annotated[Any, Anything()]
