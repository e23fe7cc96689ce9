"""Records against the dataclasses that they stand for."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import json
import pickle
import subprocess
import sys
import typing
from pathlib import Path
from typing import Any, ClassVar, get_type_hints

import pytest

from elitescript import records
from elitescript.records import NamedTuple, field, fields_of, is_record, record, replace

ROOT = Path(__file__).resolve().parent.parent


@record
class Point:
    """A point with all kinds of fields."""

    x: float
    y: float = 2.0
    note: str = field(default="", repr=False, compare=False)
    tags: list[str] = field(default_factory=list)
    length: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if self.x < 0.0:
            raise ValueError(self.x)
        object.__setattr__(self, "length", (self.x**2 + self.y**2) ** 0.5)


@dataclasses.dataclass(frozen=True, slots=True)
class Reference:
    """The same, made by the standard library."""

    x: float
    y: float = 2.0
    note: str = dataclasses.field(default="", repr=False, compare=False)
    tags: list[str] = dataclasses.field(default_factory=list)
    length: float = dataclasses.field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if self.x < 0.0:
            raise ValueError(self.x)
        object.__setattr__(self, "length", (self.x**2 + self.y**2) ** 0.5)


@record
class Point3(Point):
    """A record that is a record too."""

    x: float = 7.0
    z: float = 1.0


@dataclasses.dataclass(frozen=True, slots=True)
class Reference3(Reference):
    """The same, made by the standard library."""

    x: float = 7.0
    z: float = 1.0


@record
class Own:
    """A record with methods of its own in place of those that are made."""

    x: int

    def __repr__(self) -> str:
        return f"<{self.x}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Own) and self.x % 10 == other.x % 10

    def __hash__(self) -> int:
        return self.x % 10


@record
class Nothing:
    """A record without fields."""


PAIRS = [(Point, Reference), (Point3, Reference3)]
CALLS: list[tuple[tuple[Any, ...], dict[str, Any]]] = [
    ((1.0,), {}),
    ((1.0, 3.0), {}),
    ((1.0,), {"note": "n", "tags": ["a"]}),
    ((), {"x": 4.0, "y": 5.0}),
    ((), {}),
    ((-1.0,), {}),
    ((1.0, 2.0, "n", ["t"], 4.0, 5.0), {}),
    ((1.0,), {"length": 3.0}),
    ((1.0,), {"colour": 3.0}),
]


def result(function, *args, **named):
    """Return what a call returns, or the kind and text of its error."""
    try:
        return function(*args, **named)
    except Exception as error:
        return type(error).__name__, str(error)


def plain(value, kind):
    """Return a text in which a record and its reference do not differ."""
    return repr(value).replace(kind.__name__, "Kind")


@pytest.mark.parametrize(("kind", "reference"), PAIRS)
class TestAgainstDataclasses:
    def test_calls_and_their_errors_are_the_same(self, kind, reference):
        for args, named in CALLS:
            ours, theirs = result(kind, *args, **named), result(reference, *args, **named)
            assert plain(ours, kind) == plain(theirs, reference)

    def test_slots_matching_and_signature_are_the_same(self, kind, reference):
        assert kind.__slots__ == reference.__slots__
        assert kind.__match_args__ == reference.__match_args__
        assert str(inspect.signature(kind)) == str(inspect.signature(reference))
        assert get_type_hints(kind.__init__) == get_type_hints(reference.__init__)
        assert not hasattr(kind(1.0), "__dict__")

    def test_fields_are_the_same(self, kind, reference):
        assert dataclasses.is_dataclass(kind)
        assert [repr(row) for row in dataclasses.fields(kind)] == [repr(row) for row in dataclasses.fields(reference)]
        assert list(fields_of(kind)) == [row.name for row in dataclasses.fields(reference)]
        assert repr(kind.__dataclass_params__) == repr(reference.__dataclass_params__)

    def test_functions_of_dataclasses_give_the_same(self, kind, reference):
        ours, theirs = kind(3.0, 4.0, tags=["a"]), reference(3.0, 4.0, tags=["a"])
        assert dataclasses.asdict(ours) == dataclasses.asdict(theirs)
        assert dataclasses.astuple(ours) == dataclasses.astuple(theirs)
        for change in ({"y": 0.0}, {"length": 1.0}, {"colour": 1}):
            expected = plain(result(dataclasses.replace, theirs, **change), reference)
            assert plain(result(dataclasses.replace, ours, **change), kind) == expected
            if "length" not in change:
                assert plain(result(replace, ours, **change), kind) == expected

    def test_equality_and_hash_are_the_same(self, kind, reference):
        values = [(1.0, 2.0, "a", ()), (1.0, 2.0, "b", ()), (1.0, 2, "a", ()), (1.0, 3.0, "a", ())]
        for one in values:
            assert hash(kind(*one[:3], tags=())) == hash(reference(*one[:3], tags=()))
            for other in values:
                assert (kind(*one) == kind(*other)) is (reference(*one) == reference(*other))
        # From Python 3.13 on dataclasses compare field by field, so that one NaN does not equal itself. Records compare
        # tuples on every version: the same value is equal.
        nan = float("nan")
        assert kind(nan, 0.0) == kind(nan, 0.0) != kind(float("nan"), 0.0)
        assert kind(1.0) != reference(1.0)
        assert "__eq__" in vars(kind) and kind.__eq__(kind(1.0), 1) is NotImplemented

    def test_it_cannot_be_changed(self, kind, reference):
        for value in (kind(1.0), reference(1.0)):
            with pytest.raises(dataclasses.FrozenInstanceError, match="cannot assign to field 'x'"):
                value.x = 2.0
            with pytest.raises(dataclasses.FrozenInstanceError, match="cannot delete field 'x'"):
                del value.x

    def test_copies_are_equal(self, kind, reference):
        value = kind(3.0, 4.0, "n", ["t"])
        for other in (copy.copy(value), copy.deepcopy(value), pickle.loads(pickle.dumps(value))):
            assert other == value and other is not value
            assert (other.note, other.length) == ("n", 5.0)

    def test_a_class_that_is_no_record_can_have_it_as_base(self, kind, reference):
        class Derived(kind):
            def __init__(self) -> None:
                super().__init__(3.0, 4.0)

        assert Derived().length == 5.0
        assert Derived() == Derived() and Derived() != kind(3.0, 4.0)


def test_methods_of_the_class_itself_stay():
    assert (repr(Own(12)), Own(12) == Own(2), hash(Own(12))) == ("<12>", True, 2)


def test_a_record_with_its_own_equality_has_a_hash_as_a_dataclass_has():
    @record
    class Ours:
        x: int

        def __eq__(self, other: object) -> bool:
            return True

    @record
    class Unhashable:
        x: int
        __hash__ = None

    assert hash(Ours(1)) == hash((1,))
    with pytest.raises(TypeError, match="unhashable"):
        hash(Unhashable(1))


def test_a_field_that_no_constructor_takes_has_its_default():
    @record
    class Ours:
        x: int
        y: int = field(default=3, init=False)

    assert (Ours(1).y, repr(Ours(1)).partition("(")[2]) == (3, "x=1, y=3)")


def test_methods_are_written_although_the_module_is_gone(monkeypatch):
    module = type(sys)("gone")
    module.__dict__["record"] = record
    exec("from __future__ import annotations\n@record\nclass Ours:\n  x: int\n", module.__dict__)
    monkeypatch.delitem(sys.modules, "gone", raising=False)
    assert module.Ours(1) == module.Ours(1) != module.Ours(2)


def test_a_record_without_fields_is_equal_to_another_one():
    assert Nothing() == Nothing() and hash(Nothing()) == hash(()) and repr(Nothing()) == "Nothing()"


def test_a_record_in_itself_is_shown_once():
    value = Point(1.0)
    value.tags.append(value)
    assert repr(value) == "Point(x=1.0, y=2.0, tags=[...])"


def test_kinds_of_fields_that_it_has_not_are_refused():
    with pytest.raises(TypeError, match=r"Kind\.x: a record has no field of the type 'ClassVar\[int\]'"):

        @record
        class Kind:
            x: ClassVar[int] = 1


def test_only_a_record_is_one():
    assert is_record(Point) and not is_record(Reference) and not is_record(Point(1.0))


class Row(NamedTuple):
    """A row of a table."""

    name: str
    size: int = 3
    parts: tuple[int, ...] = ()

    @property
    def double(self) -> int:
        return 2 * self.size


class RowReference(typing.NamedTuple):
    """The same, made by the standard library."""

    name: str
    size: int = 3
    parts: tuple[int, ...] = ()

    @property
    def double(self) -> int:
        return 2 * self.size


class Narrow(Row):
    """A class that is derived from a named tuple."""

    __slots__ = ()

    def __new__(cls, name: str) -> Narrow:
        return super().__new__(cls, name, 1)


def like_reference(value: Any) -> str:
    return repr(value).replace("RowReference", "Row")


class TestNamedTuples:
    CALLS: ClassVar = [
        (("a",), {}),
        (("a", 4, (1,)), {}),
        ((), {"name": "b", "parts": (2,)}),
        ((), {}),
        (("a",), {"name": "b"}),
        (("a", 1, (), 2), {}),
        (("a",), {"colour": 3}),
    ]

    def test_calls_and_their_errors_are_those_of_typing(self):
        for args, named in self.CALLS:
            ours, theirs = result(Row, *args, **named), result(RowReference, *args, **named)
            assert like_reference(ours) == like_reference(theirs)

    def test_what_a_class_says_of_itself_is_the_same(self):
        for name in ("_fields", "_field_defaults", "__match_args__", "__slots__", "__doc__"):
            if name != "__doc__":
                assert getattr(Row, name) == getattr(RowReference, name)
        assert str(inspect.signature(Row)) == "(name: 'str', size: 'int' = 3, parts: 'tuple[int, ...]' = ())"
        assert get_type_hints(Row) == get_type_hints(RowReference)
        assert Row.__mro__ == (Row, tuple, object)
        assert Row.__doc__ == "A row of a table."

    def test_methods_give_the_same(self):
        for args, named in (("a",), {}), (("b", 5, (6,)), {}):
            ours, theirs = Row(*args, **named), RowReference(*args, **named)
            assert (ours, ours.name, ours.size, ours.parts, ours.double) == (
                tuple(theirs),
                theirs.name,
                theirs.size,
                theirs.parts,
                theirs.double,
            )
            assert ours._asdict() == theirs._asdict()
            assert hash(ours) == hash(theirs)
            for change in ({"size": 9}, {"colour": 9}):
                expected = like_reference(result(theirs._replace, **change))
                assert like_reference(result(ours._replace, **change)) == expected
            for values in (["x", 1, ()], ["x"], range(4)):
                expected = like_reference(result(RowReference._make, values))
                assert like_reference(result(Row._make, values)) == expected
            assert result(setattr, ours, "size", 1) == result(setattr, theirs, "size", 1)

    def test_copies_are_equal(self):
        value = Row("a", 4, (1,))
        for other in (copy.copy(value), copy.deepcopy(value), pickle.loads(pickle.dumps(value))):
            assert other == value and type(other) is Row

    def test_a_derived_class_makes_its_own_kind(self):
        assert repr(Narrow("a")) == "Narrow(name='a', size=1, parts=())"
        assert type(Narrow("a")._replace(size=2)) is Narrow

    def test_matching_takes_fields_in_their_order(self):
        match Row("a", 7):
            case Row(name, size):
                assert (name, size) == ("a", 7)

    def test_what_would_lose_bases_or_fields_is_refused(self):
        with pytest.raises(TypeError, match="Kind: a named tuple has annotated fields and no other base"):

            class Kind(NamedTuple, Own):
                x: int

        with pytest.raises(TypeError, match="Real: a named tuple has annotated fields"):
            exec(compile("class Real(NamedTuple):\n  x: int", "m", "exec", dont_inherit=True), dict(globals()))

    def test_fields_can_be_read_without_the_getter_of_cpython(self):
        program = """
from __future__ import annotations
import collections, sys
sys.modules["_collections"] = None
from elitescript.records import NamedTuple
class Row(NamedTuple):
    x: int
    y: int = 2
print(Row(1).x, Row(1).y, Row.x.__get__(Row(5)))
"""
        command, environment = [sys.executable, "-c", program], {"PYTHONPATH": str(ROOT / "src")}
        done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
        assert done.stdout == "1 2 5\n", done.stderr

    def test_the_constructor_is_written_at_the_first_call(self, monkeypatch):
        made = []
        written = records._written
        monkeypatch.setattr(
            records, "_written", lambda kind, name, *rest: made.append(name) or written(kind, name, *rest)
        )

        class Late(NamedTuple):
            x: int

        assert made == []
        assert Late(1).x + Late(x=2).x == 3
        assert made == ["__new__"]


class TestFirstUse:
    def test_a_method_is_made_when_it_is_called_and_only_once(self, monkeypatch):
        made = []
        written = records._written

        def count(kind, name, *rest):
            made.append(name)
            return written(kind, name, *rest)

        monkeypatch.setattr(records, "_written", count)

        @record
        class Late:
            x: int

        assert made == []
        Late(1), Late(2)
        assert made == ["__init__"]
        assert Late(1) == Late(1) and Late(1) != Late(2)
        assert made == ["__init__", "__eq__"]
        assert len({Late(1), Late(1)}) == 1
        assert made == ["__init__", "__eq__", "__hash__"]


def test_every_record_of_the_package_is_the_dataclass_that_its_text_describes():
    """Runs in a process of its own: it imports every module."""
    program = """
import dataclasses, inspect, json, pkgutil, sys
from importlib import import_module
import elitescript
from elitescript.records import fields_of, is_record
seen = set()
for module in pkgutil.walk_packages(elitescript.__path__, "elitescript."):
    if module.name.endswith("__main__"):
        continue
    try:
        space = vars(import_module(module.name))
    except ImportError:
        continue  # an extra that is not installed
    for kind in space.values():
        if is_record(kind) and kind.__module__ == module.name:
            seen.add(kind)
for kind in seen:
    twin = {row.name: row for row in dataclasses.fields(kind)}
    assert list(twin) == list(fields_of(kind)), kind
    for name, row in fields_of(kind).items():
        assert (twin[name].init, twin[name].repr, twin[name].compare) == (row.init, row.repr, row.compare), kind
        assert twin[name].type == row.type
    names = [name for name, row in twin.items() if row.init]
    assert list(inspect.signature(kind).parameters) == names == list(kind.__match_args__), kind
    assert kind.__doc__, kind
print(json.dumps(len(seen)))
"""
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        env={"PYTHONPATH": str(ROOT / "src")},
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) > 150


@record
class Wide:
    """A record of so many fields that it is made as an object of an open class."""

    a: int
    b: int = 2
    c: list[int] = field(default_factory=list)
    d: str = field(default="d", init=False)
    e: float = 0.5
    f: bytes = b""
    g: int = field(init=False, compare=False)

    def __post_init__(self) -> None:
        assert type(self) in (Wide, Wider, Loose)
        object.__setattr__(self, "g", self.a + self.b)


@record
class Wider(Wide):
    """One that inherits most of its fields."""

    h: int = 8


class Loose(Wide):
    """A plain class above a record: its objects have another layout."""


@pytest.mark.parametrize("kind", [Wide, Wider, Loose])
def test_a_wide_record_is_frozen_and_of_its_own_class(kind: type[Wide]) -> None:
    assert len(fields_of(kind)) >= records.MANY_FIELDS
    made = kind(1, e=1.5)
    assert type(made) is kind
    assert (made.a, made.b, made.c, made.d, made.e, made.f, made.g) == (1, 2, [], "d", 1.5, b"", 3)
    assert made == kind(1, e=1.5) != kind(2)
    for change in (lambda: setattr(made, "a", 3), lambda: delattr(made, "a")):
        with pytest.raises(dataclasses.FrozenInstanceError):
            change()
    assert replace(made, f=b"x").f == b"x"
    assert pickle.loads(pickle.dumps(made)) == made == copy.copy(made)
    assert kind.__mro__[0] is kind


def test_a_wide_record_refuses_wrong_arguments_as_a_function_does() -> None:
    with pytest.raises(TypeError, match="missing 1 required positional argument: 'a'"):
        Wide()  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="unexpected keyword argument 'd'"):
        Wide(1, d="x")  # type: ignore[call-arg]
