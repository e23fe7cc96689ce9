"""Describes what Python's built-in functions, the methods of its types and the functions of `math` return."""

from __future__ import annotations

import builtins
import math
from collections.abc import Callable, Sequence
from math import inf
from typing import Final

from elitescript.values.description import (
    BOTTOM,
    BYTES,
    CHANNEL,
    COMPUTED,
    DICT,
    FLOAT,
    INT,
    LIST,
    MEASURED,
    NO_SITES,
    NONE,
    NOTHING,
    NUMBER,
    OBJECT,
    RANGE,
    ROW,
    SET,
    SOME_BOOL,
    SOME_BYTES,
    SOME_COUNT,
    SOME_FLOAT,
    SOME_INT,
    SOME_NUMBER,
    SOME_TEXT,
    TEXT,
    TUPLE,
    TYPES,
    UNKNOWN,
    WHOLE,
    Shape,
    Value,
    constant,
    join,
    join_all,
    row,
    shaped,
    unknown_of,
)
from elitescript.values.plain import Impossible, checked
from elitescript.values.references import Library
from elitescript.values.results import POSITION

READERS: Final = frozenset(
    """
    abs all any bin bool bytes callable chr complex enumerate float format hash hex id int isinstance issubclass len
    list long max min oct ord pow print range repr reversed round set sorted str sum tuple type unichr zip divmod dict
    frozenset bytearray iter next hasattr textmsg
    """.split()  # noqa: SIM905
)
"""Functions that change no argument and keep none, or keep it in a result that is described."""

_FOLDED: Final = frozenset(
    "abs bin bool chr divmod float hex int len max min oct ord pow repr round str sum".split()  # noqa: SIM905
)
"""Functions that are called if all arguments are constants."""

CONSTANT_RESULTS: Final[dict[str, Value]] = {
    "all": SOME_BOOL,
    "any": SOME_BOOL,
    "callable": SOME_BOOL,
    "hasattr": SOME_BOOL,
    "isinstance": SOME_BOOL,
    "issubclass": SOME_BOOL,
    "ascii": SOME_TEXT,
    "bin": SOME_TEXT,
    "chr": SOME_TEXT,
    "format": SOME_TEXT,
    "hex": SOME_TEXT,
    "oct": SOME_TEXT,
    "repr": SOME_TEXT,
    "str": SOME_TEXT,
    "unichr": SOME_TEXT,
    "hash": SOME_INT,
    "id": SOME_INT,
    "print": NOTHING,
    "bytes": SOME_BYTES,
    "ord": Value(INT, 0, 0x10FFFF),
    "bool": SOME_BOOL,
    "float": SOME_FLOAT,
    "int": SOME_INT,
    "long": SOME_INT,
}


def element_of(value: Value) -> Value:
    """Return what each element is that a loop over a value gives."""
    found = BOTTOM
    kinds = value.kinds
    if kinds & OBJECT and value.shape is None:
        return unknown_of(value)
    if kinds & TEXT:
        found = SOME_TEXT.but(may=value.may, must=value.must)
    if kinds & BYTES:
        found = join(found, Value(INT, 0, 255, None, "", value.may, value.must))
    if kinds & (DICT | SET):
        # Keys, and elements of sets, can be told apart from no list: lists cannot be among them.
        found = join(found, UNKNOWN)
    if kinds & (ROW | RANGE | OBJECT):
        found = join(found, unknown_of(value) if value.shape is None else value.shape.any)
    return found


def length_of(value: Value) -> tuple[float, float]:
    """Return the least and the greatest length."""
    if value.kinds & ~(ROW | RANGE | OBJECT) or value.shape is None:
        if value.kinds in (TEXT, BYTES) and value.constants:
            lengths = [len(known) for known in value.constants]
            return min(lengths), max(lengths)
        return 0, inf
    return value.shape.least, value.shape.most


def call_builtin(name: str, args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    """Return what a built-in function returns.

    Args:
        name: of the function.
        args: what it gets by position.
        has_keywords: it gets more by keyword.
        site: of a list that it makes.
    """
    if any(not value.kinds for value in args):
        return BOTTOM
    if name in _FOLDED and not has_keywords and args and all(value.has_constant for value in args):
        try:
            result = checked(getattr(builtins, name)(*(value.constant for value in args)))
        except (Impossible, ArithmeticError, TypeError, ValueError):
            return UNKNOWN
        may = must = 0
        for value in args:
            may, must = may | value.may, must | value.must
        return constant(result, may, must)
    make = _MAKERS.get(name)
    if make is not None:
        try:
            return make(args, has_keywords, site)
        except ArithmeticError:
            return unknown_of(*args)
    found = CONSTANT_RESULTS.get(name)
    if found is not None:
        return _from(found, args)
    kind = getattr(builtins, name, None)
    if isinstance(kind, type) and name != "type":
        return Value(TYPES.get(kind, OBJECT), constants=(), sites=unknown_of(*args).sites, refs=(Library(kind),))
    return unknown_of(*args)


def _from(found: Value, args: Sequence[Value]) -> Value:
    """Return a result with the origin of what it was made of, if that is a peer."""
    if len(args) == 1 and args[0].must & CHANNEL and not found.kinds & NONE:
        return found.but(may=args[0].may, must=args[0].must)
    return found


def _abs(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    (value,) = args if len(args) == 1 else (UNKNOWN,)
    if value.kinds & ~NUMBER:
        return UNKNOWN
    kinds = value.kinds & FLOAT | (INT if value.kinds & WHOLE else 0)
    if value.low == -inf and value.high == inf and kinds & FLOAT:
        return Value(kinds, -inf, inf, None, value.role, value.may, value.must)
    ends = (abs(value.low), abs(value.high))
    low = 0 if value.low <= 0 <= value.high else min(ends)
    return Value(kinds, low, max(ends), None, value.role, value.may | COMPUTED, value.must)


def _len(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    if len(args) != 1:
        return SOME_COUNT
    low, high = length_of(args[0])
    constants = (int(low),) if low == high else None
    return Value(INT, low, high, constants, "", args[0].may, COMPUTED)


def _round(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    if len(args) == 1 and not args[0].kinds & ~NUMBER:
        value = args[0]
        low = value.low if value.low == -inf else math.floor(value.low)
        high = value.high if value.high == inf else math.ceil(value.high)
        return Value(INT, low, high, None, value.role)
    if len(args) == 2 and args[0].kinds == FLOAT and args[1].kinds == INT:
        return Value(FLOAT, -inf, inf, None, args[0].role)
    return SOME_NUMBER if all(not value.kinds & ~(NUMBER | NONE) for value in args) else UNKNOWN


def _least_or_greatest(is_least: bool) -> Callable[[Sequence[Value], bool, frozenset[int]], Value]:
    def find(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
        if has_keywords:
            return unknown_of(*args)
        values = list(args)
        if len(values) == 1:
            shape = values[0].shape
            values = list(shape.items) if shape is not None and shape.items else [element_of(values[0])]
        found = join_all(values)
        if found.kinds & ~NUMBER or any(_may_be_nan(value) for value in values):
            return found
        pick = min if is_least else max
        low, high = pick(value.low for value in values), pick(value.high for value in values)
        constants = found.constants
        if constants is not None:
            constants = tuple(known for known in constants if low <= known <= high)
        return found.but(low=low, high=high, constants=constants)

    return find


def _may_be_nan(value: Value) -> bool:
    return bool(value.kinds & FLOAT) and value.low == -inf and value.high == inf


def _sum(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    if len(args) != 1 or has_keywords:
        return unknown_of(*args)
    element = element_of(args[0])
    if element.kinds & ~NUMBER:
        return unknown_of(*args)
    kinds = INT | element.kinds & FLOAT
    return Value(kinds, 0 if element.low >= 0 else -inf, inf if element.high > 0 else 0) if element.kinds else SOME_INT


def _int(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    if len(args) == 1 and not args[0].kinds & ~NUMBER:
        value = args[0]
        low = value.low if value.low in (inf, -inf) else math.trunc(value.low)
        high = value.high if value.high in (inf, -inf) else math.trunc(value.high)
        may = value.may if value.must & MEASURED else value.may | COMPUTED
        return Value(INT, low, high, None, value.role, may, value.must)
    return _from(SOME_INT, args)


def _float(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    if len(args) == 1 and not args[0].kinds & ~NUMBER:
        value = args[0]
        return Value(FLOAT, value.low, value.high, None, value.role, value.may, value.must)
    return _from(SOME_FLOAT, args)


def _range(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    if not 1 <= len(args) <= 3 or any(value.kinds & ~WHOLE for value in args):
        return Value(RANGE, constants=(), shape=Shape(None, SOME_INT))
    if all(value.has_constant for value in args):
        try:
            numbers = range(*(value.constant for value in args))
        except ValueError:
            return Value(RANGE, constants=(), shape=Shape(None, SOME_INT))
        if numbers and numbers[-1] - numbers[0] > 10**15:
            return Value(RANGE, constants=(), shape=Shape(None, SOME_INT))
        if len(numbers) <= 8:
            return Value(RANGE, constants=(), shape=Shape(tuple(map(constant, numbers))))
        ends = (numbers[0], numbers[-1])
        element = Value(INT, min(ends), max(ends))
        return Value(RANGE, constants=(), shape=Shape(None, element, len(numbers), len(numbers)))
    start = args[0] if len(args) > 1 else constant(0)
    stop = args[0] if len(args) == 1 else args[1]
    if len(args) == 3 and not args[2].low > 0:
        element = Value(INT, min(start.low, stop.low), max(start.high, stop.high))
    else:
        element = Value(INT, start.low, max(start.low, stop.high - 1))
    if len(args) < 3:
        shape = Shape(None, element, max(0, stop.low - start.high), max(0, stop.high - start.low))
        return Value(RANGE, constants=(), shape=shape)
    return Value(RANGE, constants=(), shape=Shape(None, element))


def _copied(kind: int) -> Callable[[Sequence[Value], bool, frozenset[int]], Value]:
    """Return the maker of a list or tuple of what can be gone through."""

    def make(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
        site = site if kind == LIST else NO_SITES
        if not args:
            return row(kind, (), site)
        value = args[0]
        shape = value.shape
        if shape is None or value.kinds & ~(ROW | RANGE | OBJECT):
            low, high = length_of(value)
            return shaped(kind, Shape(None, element_of(value), low, high), site, value.may, value.must & ~1 or COMPUTED)
        made = shaped(kind, shape, site, value.may, value.must)
        return made.but(role=value.role) if value.kinds & ROW else made

    return make


def _sorted(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    if not args:
        return UNKNOWN
    low, high = length_of(args[0])
    return shaped(LIST, Shape(None, element_of(args[0]), low, high), site)


def _reversed(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    if len(args) != 1:
        return UNKNOWN
    shape = args[0].shape
    if shape is not None and shape.items is not None and not args[0].kinds & ~(ROW | RANGE):
        return Value(OBJECT, constants=(), shape=Shape(shape.items[::-1]), refs=(Library(reversed),))
    return Value(OBJECT, constants=(), shape=Shape(None, element_of(args[0])), refs=(Library(reversed),))


def _enumerate(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    first = args[1] if len(args) > 1 else constant(0)
    if not args or has_keywords or first.kinds & ~WHOLE:
        return Value(OBJECT, constants=(), sites=unknown_of(*args).sites, refs=(Library(enumerate),))
    shape = args[0].shape
    if (
        shape is not None
        and shape.items is not None
        and len(shape.items) <= 8
        and first.has_constant
        and not args[0].kinds & ~ROW
    ):
        pairs = tuple(row(TUPLE, (constant(first.constant + n), item)) for n, item in enumerate(shape.items))
        return Value(OBJECT, constants=(), shape=Shape(pairs), refs=(Library(enumerate),))
    _, most = length_of(args[0])
    number = Value(INT, first.low, inf if most == inf else first.high + max(0, most - 1))
    pair = row(TUPLE, (number, element_of(args[0])))
    return Value(OBJECT, constants=(), shape=Shape(None, pair, 0, most), refs=(Library(enumerate),))


def _zip(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    pair = row(TUPLE, map(element_of, args))
    return Value(OBJECT, constants=(), shape=Shape(None, pair), refs=(Library(zip),))


def _dict(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    return Value(DICT, constants=(), sites=unknown_of(*args).sites | site)


def _set(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    return Value(SET, constants=())


def _next(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    return unknown_of(*args)


def _getattr(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    return unknown_of(*args)


def _divmod(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    if len(args) == 2 and not (args[0].kinds | args[1].kinds) & ~NUMBER:
        number = SOME_NUMBER if (args[0].kinds | args[1].kinds) & FLOAT else SOME_INT
        return row(TUPLE, (number, number))
    return UNKNOWN


def _super(args: Sequence[Value], has_keywords: bool, site: frozenset[int]) -> Value:
    return Value(OBJECT, constants=(), refs=(Library(super),))


_MAKERS: Final[dict[str, Callable[[Sequence[Value], bool, frozenset[int]], Value]]] = {
    "abs": _abs,
    "len": _len,
    "round": _round,
    "min": _least_or_greatest(True),
    "max": _least_or_greatest(False),
    "sum": _sum,
    "int": _int,
    "long": _int,
    "float": _float,
    "range": _range,
    "list": _copied(LIST),
    "tuple": _copied(TUPLE),
    "sorted": _sorted,
    "reversed": _reversed,
    "enumerate": _enumerate,
    "zip": _zip,
    "dict": _dict,
    "set": _set,
    "next": _next,
    "iter": _next,
    "getattr": _getattr,
    "divmod": _divmod,
    "super": _super,
}


# Methods

_TEXT_LIST: Final = Shape(None, SOME_TEXT)
_BYTES_LIST: Final = Shape(None, SOME_BYTES)

_TEXT_METHODS: Final[dict[str, Value]] = {
    **dict.fromkeys(
        (
            *("capitalize", "casefold", "center", "expandtabs", "format", "join", "ljust", "lower", "lstrip"),
            *("removeprefix", "removesuffix", "replace", "rjust", "rstrip", "strip", "swapcase", "title"),
            *("translate", "upper", "zfill", "format_map"),
        ),
        SOME_TEXT,
    ),
    **dict.fromkeys(("find", "rfind"), Value(INT, -1, inf, None, POSITION)),
    **dict.fromkeys(("count", "index", "rindex"), SOME_COUNT),
    **dict.fromkeys(
        (
            *("startswith", "endswith", "isalnum", "isalpha", "isascii", "isdecimal", "isdigit", "isidentifier"),
            *("islower", "isnumeric", "isprintable", "isspace", "istitle", "isupper"),
        ),
        SOME_BOOL,
    ),
    "encode": SOME_BYTES,
}
_BYTES_METHODS: Final[dict[str, Value]] = {
    **{name: SOME_BYTES if value is SOME_TEXT else value for name, value in _TEXT_METHODS.items() if name != "encode"},
    "decode": SOME_TEXT,
    "hex": SOME_TEXT,
}
_SPLITTING: Final = ("split", "rsplit", "splitlines")
_FLOAT_METHODS: Final[dict[str, Value]] = {"is_integer": SOME_BOOL, "hex": SOME_TEXT, "bit_length": SOME_COUNT}


def text_method(value: Value, name: str, site: frozenset[int]) -> Value:
    """Return what a method of a text or of bytes returns."""
    is_text = value.kinds == TEXT
    if name in _SPLITTING:
        shape = _TEXT_LIST if is_text else _BYTES_LIST
        origin = shape.element.but(may=value.may, must=value.must)
        return Value(LIST, constants=(), may=value.may, must=value.must, shape=Shape(None, origin), sites=site)
    if name in ("partition", "rpartition"):
        part = (SOME_TEXT if is_text else SOME_BYTES).but(may=value.may, must=value.must)
        return Value(TUPLE, constants=(), may=value.may, must=value.must, shape=Shape((part, part, part)))
    found = (_TEXT_METHODS if is_text else _BYTES_METHODS).get(name)
    if found is None:
        return UNKNOWN
    return found.but(may=value.may, must=value.must) if value.must & CHANNEL and found.kinds & (TEXT | BYTES) else found


def number_method(name: str) -> Value:
    """Return what a method of a number returns."""
    return _FLOAT_METHODS.get(name, UNKNOWN)


# math

MATH_CONSTANTS: Final = {"pi": math.pi, "tau": math.tau, "e": math.e, "inf": math.inf, "nan": math.nan}
_MATH: Final[dict[str, Value]] = {
    **dict.fromkeys(("sin", "cos"), Value(FLOAT, -1, 1)),
    **dict.fromkeys(("sqrt", "hypot", "dist", "fabs"), Value(FLOAT, 0, inf)),
    **dict.fromkeys(("floor", "ceil", "trunc", "gcd", "factorial", "comb", "perm", "isqrt", "lcm"), SOME_INT),
    **dict.fromkeys(("isnan", "isinf", "isfinite", "isclose"), SOME_BOOL),
    **dict.fromkeys(
        (
            *("acos", "asin", "atan", "atan2", "tan", "degrees", "radians", "log", "log10", "log2", "pow", "exp"),
            *("fmod", "copysign", "sinh", "cosh", "tanh", "fsum", "remainder", "cbrt", "expm1", "log1p"),
        ),
        SOME_FLOAT,
    ),
}
_MATH_ROLES: Final = {"radians": "rad", "degrees": "deg", "acos": "rad", "asin": "rad", "atan": "rad", "atan2": "rad"}
_MATH_FOLDED: Final = frozenset(
    "acos asin atan atan2 ceil cos degrees fabs floor hypot radians sin sqrt tan trunc".split()  # noqa: SIM905
)


def call_math(name: str, args: Sequence[Value]) -> Value:
    """Return what a function of `math` returns."""
    if any(not value.kinds for value in args):
        return BOTTOM
    role = _MATH_ROLES.get(name, "")
    if name in _MATH_FOLDED and args and all(value.has_constant and not value.kinds & ~NUMBER for value in args):
        try:
            result = getattr(math, name)(*(value.constant for value in args))
        except (ArithmeticError, TypeError, ValueError):
            return UNKNOWN
        return constant(result).but(role=role)
    found = _MATH.get(name, UNKNOWN)
    if name in ("sin", "cos", "sqrt", "hypot", "fabs") and any(
        _may_be_nan(value) or value.kinds & OBJECT for value in args
    ):
        # Of NaN they are NaN.
        found = SOME_FLOAT
    return found.but(role=role) if role else found
