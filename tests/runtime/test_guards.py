import pytest
from hypothesis import given
from hypothesis import strategies as st

from elitescript.errors import ScriptPermissionError
from elitescript.runtime.names.guards import (
    attribute_hook,
    checked_delattr,
    checked_dir,
    checked_format,
    checked_format_method,
    checked_hasattr,
    checked_setattr,
    getattr_over,
)
from elitescript.runtime.names.identities import Identities, OneArgumentType

checked_getattr = getattr_over(attribute_hook(Identities()))


class Thing:
    """Something with attributes."""

    def __init__(self):
        self.x = 1
        self._y = 2


class Text(str):
    """A str of a program's own."""


class TestAttributes:
    def test_ordinary_ones_are_read(self):
        thing = Thing()
        assert checked_getattr(thing, "x") == 1
        assert checked_getattr(thing, "_y") == 2
        assert checked_getattr(thing, "z", 9) == 9
        assert checked_getattr(thing, "__class__") is Thing
        with pytest.raises(AttributeError):
            checked_getattr(thing, "z")

    def test_ordinary_ones_are_set_and_deleted(self):
        thing = Thing()
        checked_setattr(thing, "z", 5)
        assert thing.z == 5
        checked_delattr(thing, "z")
        assert not checked_hasattr(thing, "z")
        assert checked_hasattr(thing, "x")

    @pytest.mark.parametrize("name", ["__globals__", "__dict__", "gi_frame", "tb_frame", "mro", "f_back"])
    def test_inner_ones_are_refused(self, name):
        with pytest.raises(ScriptPermissionError, match=name):
            checked_getattr(Thing(), name)
        with pytest.raises(ScriptPermissionError):
            checked_getattr(Thing(), name, None)
        with pytest.raises(ScriptPermissionError):
            checked_setattr(Thing(), name, 1)
        with pytest.raises(ScriptPermissionError):
            checked_delattr(Thing(), name)
        assert not checked_hasattr(Thing(), name)

    def test_special_ones_that_can_be_read_cannot_be_changed(self):
        with pytest.raises(ScriptPermissionError):
            checked_setattr(Thing(), "__class__", Text)

    @pytest.mark.parametrize("name", [Text("x"), 3, None, b"x"])
    def test_a_name_must_be_a_plain_str(self, name):
        with pytest.raises(TypeError):
            checked_getattr(Thing(), name)
        with pytest.raises(TypeError):
            checked_hasattr(Thing(), name)

    @pytest.mark.parametrize("name", ["@tick", "a b", "", "1x"])
    def test_a_name_must_be_one_that_could_be_spelled(self, name):
        with pytest.raises(AttributeError):
            checked_setattr(Thing(), name, 1)

    def test_dir_lists_what_can_be_read(self):
        assert checked_dir(Thing()) == ["_y", "x"]
        with pytest.raises(ScriptPermissionError):
            checked_dir()

    def test_too_many_arguments_are_refused(self):
        with pytest.raises(TypeError):
            checked_getattr(1, "real", 2, 3)


class TestFormat:
    @pytest.mark.parametrize(
        ("text", "args", "kwargs"),
        [
            ("plain {{}}", (), {}),
            ("{} {} {}", (1, "b", None), {}),
            ("{1} {0}", (1, 2), {}),
            ("{a} {b!r} {a!s:>5} {b!a}", (), {"a": "x", "b": "ü"}),
            ("{:.3f}|{:>8}|{:+d}|{:,}", (3.14159, "x", 5, 1234567), {}),
            ("{:{}}", ("x", 6), {}),
            ("{0:{1}.{2}f}", (3.14159, 10, 2), {}),
            ("{0[1]} {a[key]}", ([1, 2],), {"a": {"key": 3}}),
            ("{0.real} {0.imag}", (2 + 3j,), {}),
            ("{!r}", ("a",), {}),
        ],
    )
    def test_it_does_what_str_format_does(self, text, args, kwargs):
        assert checked_format(text, args, kwargs) == text.format(*args, **kwargs)

    @pytest.mark.parametrize(
        ("text", "args", "kwargs"),
        [
            ("{", (), {}),
            ("}", (), {}),
            ("{}{0}", (1,), {}),
            ("{0}{}", (1,), {}),
            ("{2}", (1,), {}),
            ("{a}", (), {}),
            ("{0[9]}", ([1],), {}),
            ("{0.nothing}", (1,), {}),
            ("{0!x}", (1,), {}),
            ("{:{:{}}}", (1, 2, 3), {}),
            ("{:d}", ("x",), {}),
        ],
    )
    def test_it_refuses_what_str_format_refuses(self, text, args, kwargs):
        with pytest.raises(Exception) as real:
            text.format(*args, **kwargs)
        with pytest.raises(type(real.value)):
            checked_format(text, args, kwargs)

    @given(st.text("{}0:!r.ab[]<>5", max_size=12))
    def test_every_text_comes_out_as_from_str_format(self, text):
        def outcome(call):
            try:
                return call()
            except Exception as error:
                return type(error)

        args = (3, "b", [1, 2])
        assert outcome(lambda: checked_format(text, args, {"a": 1})) == outcome(lambda: text.format(*args, a=1))

    def test_a_method_of_a_text_is_the_checked_one(self):
        assert checked_format_method("{}", "format")(1) == "1"
        assert checked_format_method("{a}", "format_map")({"a": 1}) == "1"
        assert checked_format_method(Text("{}"), "format")(1) == "1"
        assert checked_format_method(str, "format")("{}", 1) == "1"
        assert checked_format_method(Text, "format_map")("{a}", {"a": 2}) == "2"

    def test_a_method_of_something_else_is_its_own(self):
        class Printer:
            def format(self, text):
                return text.upper()

        assert checked_format_method(Printer(), "format")("x") == "X"
        with pytest.raises(AttributeError):
            checked_format_method(3, "format")

    def test_unbound_it_wants_a_text(self):
        with pytest.raises(TypeError, match="str"):
            checked_format_method(str, "format")(3)

    def test_format_map_has_no_positions(self):
        with pytest.raises(ValueError, match="positional"):
            checked_format_method("{}", "format_map")({})

    @pytest.mark.parametrize("text", ["{0.__class__.__mro__}", "{0:{0.__dict__}}", "{0.format.__self__}"])
    def test_fields_read_only_what_programs_may(self, text):
        with pytest.raises(ScriptPermissionError):
            checked_format(text, ("x",), {})


class TestType:
    def test_it_tells_the_class_of_an_object(self):
        assert OneArgumentType(3) is int
        assert OneArgumentType(Thing()) is Thing

    def test_it_knows_classes(self):
        assert isinstance(int, OneArgumentType)
        assert not isinstance(3, OneArgumentType)
        assert issubclass(type, OneArgumentType)
        assert repr(OneArgumentType) == "<class 'type'>"

    def test_it_makes_none(self):
        with pytest.raises(ScriptPermissionError):
            OneArgumentType("X", (), {})
        with pytest.raises(ScriptPermissionError):
            OneArgumentType(1, a=2)


class Slotted:
    """Something without weak references."""

    __slots__ = ("other",)


class TestIdentities:
    def test_objects_are_counted_as_they_are_asked_for(self):
        identities = Identities()
        a, b = Thing(), Thing()
        assert [identities.number(item) for item in (a, b, a)] == [16, 32, 16]

    def test_no_number_is_given_twice(self):
        identities = Identities()
        assert len({identities.number([n]) for n in range(100)}) == 100

    @pytest.mark.parametrize("make", [Thing, Slotted, list])
    def test_a_living_object_keeps_its_number(self, make):
        identities = Identities()
        kept = [make() for _ in range(5000)]
        numbers = [identities.number(item) for item in kept]
        assert [identities.number(item) for item in kept] == numbers

    @pytest.mark.parametrize("make", [Thing, Slotted, list, lambda: [[]], lambda: {"a": ([],)}])
    def test_memory_does_not_grow_with_objects_that_are_gone(self, make):
        identities = Identities()
        for _ in range(10):
            kept = [make() for _ in range(1500)]
            for item in kept:
                identities.number(item)
        del kept, item
        identities.number([])
        assert len(identities._known) <= 3500

    def test_memory_stays_flat_for_large_ones(self):
        identities = Identities()
        for _ in range(100):
            identities.number(bytearray(10_000_000))
        pairs = [bytearray(1_000_000) for _ in range(2)]
        for _ in range(100):
            for item in pairs:
                identities.number(item)
            pairs = [bytearray(1_000_000) for _ in range(2)]
        assert sum(map(len, (held for _, held in identities._known.values()))) < 30_000_000

    def test_cycles_are_let_go(self):
        def cycle():
            first, second, third = [], {}, Slotted()
            first.append(second)
            second["next"] = third
            third.other = first
            return first

        identities = Identities()
        kept = cycle()
        number = identities.number(kept)
        inner = identities.number(kept[0]["next"])
        for _ in range(5000):
            identities.number(cycle())
        assert len(identities._known) <= 2100
        assert (identities.number(kept), identities.number(kept[0]["next"])) == (number, inner)

    def test_a_program_that_is_over_leaves_nothing(self):
        identities = Identities()
        identities.number([])
        identities.clear()
        assert identities._known == {}
