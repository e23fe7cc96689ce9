import pytest
from hypothesis import given
from hypothesis import strategies as st

from elitescript.errors import ScriptPermissionError
from elitescript.runtime.names.guards import (
    IDS_MAX,
    Identities,
    OneArgumentType,
    checked_delattr,
    checked_dir,
    checked_format,
    checked_format_method,
    checked_getattr,
    checked_hasattr,
    checked_setattr,
)


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


class TestIdentities:
    def test_objects_are_counted_as_they_are_asked_for(self):
        identities = Identities()
        a, b = Thing(), Thing()
        assert [identities.number(item) for item in (a, b, a)] == [16, 32, 16]

    def test_an_object_stays_known_while_it_could_be_asked_for(self):
        identities = Identities()
        first = identities.number([1])
        assert all(identities.number([n]) != first for n in range(100))

    def test_memory_is_bounded(self):
        identities = Identities()
        kept = [Thing() for _ in range(IDS_MAX + 10)]
        for item in kept:
            identities.number(item)
        assert len(identities._known) == IDS_MAX
        assert identities.number(kept[-1]) == 16 * (IDS_MAX + 10)
        assert identities.number(kept[0]) == 16 * (IDS_MAX + 11)
        identities.clear()
        assert identities._known == {}
