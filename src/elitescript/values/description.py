"""Describes what a value of a program can be: kinds, range, constants, elements, role and origin.

A description holds for every run: what is not known is `UNKNOWN`, never a guess. Descriptions do not change; `join`
gives the one that holds wherever one of two does.
"""

from __future__ import annotations

import types
from collections.abc import Iterable
from math import inf
from typing import Any, Final, NewType

Kinds = int
"""Bits of the types that a value can have."""

BOOL: Final = 1
INT: Final = 2
FLOAT: Final = 4
TEXT: Final = 8
BYTES: Final = 16
NONE: Final = 32
LIST: Final = 64
TUPLE: Final = 128
DICT: Final = 256
SET: Final = 512
RANGE: Final = 1024
FUNCTION: Final = 2048
OBJECT: Final = 4096
"""Anything else: modules, objects of classes, iterators."""

WHOLE: Final = BOOL | INT
NUMBER: Final = BOOL | INT | FLOAT
SCALAR: Final = NUMBER | TEXT | BYTES | NONE
ROW: Final = LIST | TUPLE
MUTABLE: Final = LIST | DICT | SET | OBJECT
ANY: Final = 2 * OBJECT - 1

TYPES: Final[dict[type, Kinds]] = {
    bool: BOOL,
    int: INT,
    float: FLOAT,
    str: TEXT,
    bytes: BYTES,
    type(None): NONE,
    list: LIST,
    tuple: TUPLE,
    dict: DICT,
    set: SET,
    range: RANGE,
    types.FunctionType: FUNCTION,
    types.BuiltinFunctionType: FUNCTION,
    types.MethodType: FUNCTION,
    type: FUNCTION,
}
"""Kind of the objects of a type; of all others it is `OBJECT`."""

May = NewType("May", int)
"""Origins of which any may be that of a value. A join adds to them."""
Must = NewType("Must", int)
"""Origins that a value has in every evaluation. A join keeps what both have."""

LITERAL: Final = 1
"""Written in the text, or computed of what is."""
COMPUTED: Final = 2
"""Computed of anything."""
MEASURED: Final = 4
"""A sensor's reading, which is never exactly a number that was planned."""
COMMANDED: Final = 8
"""Target of the controller, or what the program has set."""
CHANNEL: Final = 16
"""What a peer has sent."""
SIGNAL: Final = 32
"""An input, a register, a flag, a fieldbus signal."""
LATE: Final = 64
"""A signal that may have no value yet."""
JOINED: Final = 128
"""A list that was joined of others, or repeated."""
IN_BASE: Final = 256
"""A pose in the base frame; beside the other origins."""
_CARRIED: Final = MEASURED | CHANNEL | SIGNAL
"""Origins that a computed number keeps."""
OUTSIDE: Final = MEASURED | CHANNEL | SIGNAL
NOWHERE: Final = May(511)

CONSTANTS_MAX: Final = 8
"""Constants that a description lists."""
SIZE_MAX: Final = 1_000
"""Elements of a list, and those of lists in it, that are described one by one."""
REFERENCES_MAX: Final = 8
"""Functions, classes and modules that a value may stand for."""
DEPTH_MAX: Final = 6
"""Nesting of lists that is described."""
SITES_MAX: Final = 32
EVERYWHERE: Final = frozenset((-1,))
"""Sites of a value that may be any list of the program."""
NO_SITES: Final[frozenset[int]] = frozenset()


_new: Final = object.__new__


class Shape:
    """Describes the elements of a list, tuple, range, dict (its values) or iterator.

    Attributes:
        items: its elements, one by one; None if that is not known.
        element: what every element is, where `items` is None.
        least, most: how many it has.
        depth: nesting of lists; 1 for a list of numbers.
        size: number of descriptions in it.
        is_plain: no element has elements itself or is made anywhere, and each is computed.
        is_counted: the first element is the number of those behind it that hold a value.
    """

    __slots__ = ("depth", "element", "is_counted", "is_plain", "items", "least", "most", "size")

    def __init__(
        self,
        items: tuple[Value, ...] | None,
        element: Value | None = None,
        least: float = 0,
        most: float = inf,
        is_counted: bool = False,
    ) -> None:
        self.is_counted = is_counted
        if items is not None:
            least = most = len(items)
            depth, size, is_plain = 0, len(items), True
            for item in items:
                inner = item.shape
                if inner is not None:
                    size += inner.size
                    depth = max(depth, inner.depth)
                    is_plain = False
                elif item.sites or not item.kinds:
                    is_plain = False
            if size <= SIZE_MAX:
                self.items: tuple[Value, ...] | None = items
                self.element: Value = BOTTOM
                self.least: float = least
                self.most: float = most
                self.depth: int = 1 + depth
                self.size: int = size
                self.is_plain: bool = is_plain
                return
            element = join_all(items)
        self.items = None
        self.element = element = UNKNOWN if element is None else element
        self.least, self.most = least, most
        self.depth = 1 + (0 if element.shape is None else element.shape.depth)
        self.size = 1 + (0 if element.shape is None else element.shape.size)
        self.is_plain = element.shape is None and not element.sites and bool(element.kinds)

    @property
    def any(self) -> Value:
        """Return what every element is."""
        return self.element if self.items is None else join_all(self.items)


class Value:
    """Describes what a value can be.

    Attributes:
        kinds: bits of the types it can have; 0 for none at all: not computed yet, or never.
        low, high: least and greatest number; `inf`, `-inf` if it is none. NaN belongs to (-inf, inf) alone.
        constants: all numbers, texts and None that it can be; None if they are not known.
        role: what it means: `meaning` of a quantity, else its unit; empty if unknown.
        may, must: origins that it may have, and that it has in any case.
        shape: its elements; None if nothing is known of them.
        sites: where the lists and dicts are made that it can be; with an unknown shape, also those inside them.
        refs: the functions, classes and modules that it can be; None if not known.
        node: the expression that gives it, where it is the same for all.
    """

    __slots__ = ("constants", "high", "kinds", "low", "may", "must", "node", "refs", "role", "shape", "sites")

    def __init__(
        self,
        kinds: Kinds,
        low: float = inf,
        high: float = -inf,
        constants: tuple[Any, ...] | None = None,
        role: str = "",
        may: int = COMPUTED,
        must: int = COMPUTED,
        shape: Shape | None = None,
        sites: frozenset[int] = NO_SITES,
        refs: tuple[Any, ...] | None = (),
        node: Any = None,
    ) -> None:
        self.kinds = kinds
        self.low = low
        self.high = high
        self.constants = constants
        self.role = role
        self.may: May = may  # type: ignore[assignment]
        self.must: Must = must  # type: ignore[assignment]
        self.shape = shape
        self.sites = sites
        self.refs = refs
        self.node = node

    @property
    def is_known(self) -> bool:
        """Whether its kinds are certain."""
        return 0 < self.kinds < ANY

    @property
    def has_constant(self) -> bool:
        """Whether it is one number or text, or None."""
        return self.constants is not None and len(self.constants) == 1 and not self.kinds & ~SCALAR

    @property
    def constant(self) -> Any:
        """The only constant; see `has_constant`."""
        assert self.constants is not None
        return self.constants[0]

    @property
    def is_number(self) -> bool:
        """Whether it is a number, or True or False, in any case."""
        return bool(self.kinds) and not self.kinds & ~NUMBER

    @property
    def is_callable(self) -> bool:
        """Whether it may be a function or an object that can be called."""
        return bool(self.kinds & (FUNCTION | OBJECT))

    @property
    def is_list(self) -> bool:
        """Whether it is a list in any case."""
        return self.kinds == LIST

    @property
    def items(self) -> tuple[Value, ...] | None:
        """Its elements, one by one, if it is a list or tuple in any case, and they are known."""
        return None if self.shape is None or self.kinds not in (LIST, TUPLE) else self.shape.items

    def but(self, **changes: Any) -> Value:
        """Return a description that differs in some attributes."""
        made: Value = _new(Value)
        made.kinds = self.kinds
        made.low = self.low
        made.high = self.high
        made.constants = self.constants
        made.role = self.role
        made.may = self.may
        made.must = self.must
        made.shape = self.shape
        made.sites = self.sites
        made.refs = self.refs
        made.node = self.node
        for name, value in changes.items():
            setattr(made, name, value)
        return made


BOTTOM: Final = Value(0, constants=(), may=0, must=NOWHERE)
"""No value at all: not computed yet, or never."""
UNKNOWN: Final = Value(ANY, -inf, inf, None, "", NOWHERE, 0, None, NO_SITES, None)
SOME_BOOL: Final = Value(BOOL, 0, 1, (False, True))
SOME_INT: Final = Value(INT, -inf, inf)
SOME_COUNT: Final = Value(INT, 0, inf)
SOME_FLOAT: Final = Value(FLOAT, -inf, inf)
SOME_NUMBER: Final = Value(INT | FLOAT, -inf, inf)
SOME_TEXT: Final = Value(TEXT)
SOME_BYTES: Final = Value(BYTES)
NOTHING: Final = Value(NONE, constants=(None,))
A_FUNCTION: Final = Value(FUNCTION, constants=(), refs=None)
SOME_OBJECT: Final = Value(OBJECT, constants=(), refs=None)


def constant(value: Any, may: int = LITERAL, must: int = LITERAL) -> Value:
    """Return the description of one number, text, bytes, bool or None; of anything else `UNKNOWN`."""
    kind = TYPES.get(type(value), OBJECT)
    if not kind & SCALAR:
        return UNKNOWN
    if kind & NUMBER:
        if value != value:
            return Value(kind, -inf, inf, (value,), "", may, must)
        return Value(kind, value, value, (value,), "", may, must)
    return Value(kind, inf, -inf, (value,), "", may, must)


def of_constants(values: Iterable[Any], may: int, must: int) -> Value:
    """Return the description of a value that is one of a few; `BOTTOM` for none."""
    found = BOTTOM
    for value in values:
        found = join(found, constant(value, may, must))
    return found


def row(kind: Kinds, items: Iterable[Value], sites: frozenset[int] = NO_SITES, may: int = 0, must: int = 0) -> Value:
    """Return the description of a list or tuple with known elements."""
    return shaped(kind, Shape(tuple(items)), sites, may, must)


def shaped(kind: Kinds, shape: Shape, sites: frozenset[int] = NO_SITES, may: int = 0, must: int = 0) -> Value:
    """Return the description of something with elements; what is nested too deep, or too long, is left out."""
    if not may:
        parts = shape.items if shape.items is not None else (shape.element,)
        may, must = 0, NOWHERE
        for part in parts:
            may |= part.may
            must &= part.must
        if not parts:
            may = must = LITERAL
        may &= ~JOINED
        must &= ~JOINED
        may = may or COMPUTED
    made = Value(kind, inf, -inf, (), "", may, must, shape, sites)
    if shape.depth > DEPTH_MAX:
        return made.but(shape=None, sites=reach(made))
    return made


def reach(value: Value) -> frozenset[int]:
    """Return the sites of all lists and dicts that a value can be or hold."""
    shape = value.shape
    if shape is None:
        return value.sites
    found = value.sites
    for part in shape.items if shape.items is not None else (shape.element,):
        if part.shape is not None or part.sites:
            found = _united(found, reach(part))
    return found


def unknown_of(*values: Value) -> Value:
    """Return a value of which nothing is known but the lists that it can be or hold: those of other values."""
    sites = NO_SITES
    for value in values:
        if value.sites or value.shape is not None:
            sites = _united(sites, reach(value))
    return UNKNOWN.but(sites=sites) if sites else UNKNOWN


def is_same_constant(one: Any, other: Any) -> bool:
    """Return whether two constants are the same in type and value; 0.0 is not -0.0, and nan is nan."""
    if type(one) is not type(other):
        return False
    if one is other:
        return True
    if type(one) is float:
        return (one == other and (one != 0.0 or str(one) == str(other))) or (one != one and other != other)
    return bool(one == other)


def same(a: Value, b: Value) -> bool:
    """Return whether two descriptions say the same."""
    if a is b:
        return True
    return (
        a.kinds == b.kinds
        and a.low == b.low
        and a.high == b.high
        and a.role == b.role
        and a.may == b.may
        and a.must == b.must
        and a.node is b.node
        and (a.sites is b.sites or a.sites == b.sites)
        and (a.refs is b.refs or a.refs == b.refs)
        and _same_constants(a.constants, b.constants)
        and _same_shape(a.shape, b.shape)
    )


def _same_constants(a: tuple[Any, ...] | None, b: tuple[Any, ...] | None) -> bool:
    if a is b:
        return True
    if a is None or b is None or len(a) != len(b):
        return False
    return all(map(is_same_constant, a, b))


def _same_shape(a: Shape | None, b: Shape | None) -> bool:
    if a is b:
        return True
    if a is None or b is None:
        return False
    if a.least != b.least or a.most != b.most or a.is_counted != b.is_counted:
        return False
    if a.items is None or b.items is None:
        return a.items is b.items and same(a.element, b.element)
    return a.items is b.items or all(map(same, a.items, b.items))


def _united(a: frozenset[int], b: frozenset[int]) -> frozenset[int]:
    if a is b or not b:
        return a
    if not a:
        return b
    both = a | b
    return both if len(both) <= SITES_MAX and -1 not in both else EVERYWHERE


def join_all(values: Iterable[Value]) -> Value:
    """Return the description that holds for all of some values."""
    found = BOTTOM
    for value in values:
        found = join(found, value)
    return found


def join(a: Value, b: Value) -> Value:
    """Return the description that holds wherever one of two does."""
    if a is b or not b.kinds:
        return a
    if not a.kinds:
        return b
    if a is UNKNOWN:
        return a if not b.sites and b.shape is None else unknown_of(a, b)
    if b is UNKNOWN:
        return b if not a.sites and a.shape is None else unknown_of(a, b)
    constants: tuple[Any, ...] | None = a.constants
    if constants is not b.constants:
        constants = _joined_constants(a.constants, b.constants)
    shape, sites = a.shape, a.sites
    if shape is not b.shape or sites is not b.sites:
        has_a, has_b = a.kinds & ~(SCALAR | FUNCTION), b.kinds & ~(SCALAR | FUNCTION)
        if not has_b:
            shape = a.shape
        elif not has_a:
            shape = b.shape
        elif a.shape is None or b.shape is None or bool(a.kinds & DICT) != bool(b.kinds & DICT):
            shape = None
            sites = _united(reach(a), reach(b))
        else:
            shape = joined_shape(a.shape, b.shape)
        if shape is not None:
            sites = _united(a.sites, b.sites)
        elif not has_b or not has_a:
            sites = _united(reach(a), reach(b))
    refs = a.refs
    if refs is not b.refs:
        refs = _joined_references(a.refs, b.refs)
    # None has neither role nor origin: what is not None keeps them.
    role, must = a.role, a.must
    if b.kinds != NONE:
        role = b.role if a.kinds == NONE else role if role == b.role else ""
        must = b.must if a.kinds == NONE else Must(must & b.must)
    return Value(
        a.kinds | b.kinds,
        a.low if a.low <= b.low else b.low,
        a.high if a.high >= b.high else b.high,
        constants,
        role,
        a.may | b.may,
        must,
        shape,
        sites,
        refs,
        a.node if a.node is b.node else None,
    )


def _joined_constants(a: tuple[Any, ...] | None, b: tuple[Any, ...] | None) -> tuple[Any, ...] | None:
    if a is None or b is None:
        return None
    added = [value for value in b if not any(is_same_constant(value, known) for known in a)]
    if not added:
        return a
    return (*a, *added) if len(a) + len(added) <= CONSTANTS_MAX else None


def _joined_references(a: tuple[Any, ...] | None, b: tuple[Any, ...] | None) -> tuple[Any, ...] | None:
    if a is None or b is None:
        return None
    added = [ref for ref in b if ref not in a]
    if not added:
        return a
    return (*a, *added) if len(a) + len(added) <= REFERENCES_MAX else None


def joined_shape(a: Shape, b: Shape) -> Shape:
    """Return the elements that a value has in one or the other form."""
    if a is b:
        return a
    is_counted = a.is_counted and b.is_counted
    if a.items is not None and b.items is not None and len(a.items) == len(b.items):
        items = tuple(map(join, a.items, b.items))
        if all(x is y for x, y in zip(items, a.items, strict=True)):
            return a
        return Shape(items, is_counted=is_counted)
    return Shape(None, join(a.any, b.any), min(a.least, b.least), max(a.most, b.most), is_counted)


def widen(old: Value, new: Value) -> Value:
    """Return a description that holds for `new`, which holds for `old`, and that soon stops growing."""
    if old is new:
        return new
    low = new.low if new.low >= old.low else (0 if new.low >= 0 else -inf)
    high = new.high if new.high <= old.high else inf
    constants = new.constants if _same_constants(old.constants, new.constants) else None
    shape = new.shape
    if shape is not None and old.shape is not None and shape is not old.shape:
        shape = _widened_shape(old.shape, shape)
    return new.but(low=low, high=high, constants=constants, shape=shape)


def _widened_shape(old: Shape, new: Shape) -> Shape:
    if old.items is not None and new.items is not None and len(old.items) == len(new.items):
        return Shape(tuple(map(widen, old.items, new.items)), is_counted=new.is_counted)
    least = new.least if new.least >= old.least else 0
    most = new.most if new.most <= old.most else inf
    return Shape(None, widen(old.any, new.any), least, most, new.is_counted)


def kind_of(value: object) -> Kinds:
    """Return the kind of an object."""
    kind = type(value)
    found = TYPES.get(kind)
    if found is None:
        found = FUNCTION if isinstance(value, type) else OBJECT
    return found


def holds(value: Value, real: object, depth: int = 0) -> bool:
    """Return whether a description holds for an object."""
    kind = kind_of(real)
    if not kind & value.kinds:
        # Whether what can be called is a function depends on how the runtime makes it.
        return bool(callable(real) and value.kinds & (FUNCTION | OBJECT))
    if kind & SCALAR:
        # Which of the two zeros a float is plays no part.
        if value.constants is not None and not any(
            is_same_constant(real, known) or real == known == 0.0 for known in value.constants
        ):
            return False
        if kind & NUMBER:
            if real != real:
                return value.low == -inf and value.high == inf
            return value.low <= real <= value.high  # type: ignore[operator]
        return True
    shape = value.shape
    if shape is None or depth > DEPTH_MAX or not isinstance(real, (list, tuple, dict)):
        return True
    parts = list(real.values()) if isinstance(real, dict) else list(real)
    if not shape.least <= len(parts) <= shape.most:
        return False
    if shape.items is None:
        return all(holds(shape.element, part, depth + 1) for part in parts)
    return all(holds(item, part, depth + 1) for item, part in zip(shape.items, parts, strict=True))
