import copy

import pytest

from elitescript.sealed import Sealed, hidden_slot, no_copy


class Box(metaclass=Sealed):
    """Holds something that nobody sees."""

    __slots__ = ("_inside", "shown")
    __reduce_ex__ = no_copy

    def __init__(self, inside):
        self.shown = 1
        _inside.__set__(self, inside)

    def inside(self):
        return _inside.__get__(self)


_inside = hidden_slot(Box, "_inside")


def test_a_hidden_slot_keeps_its_value():
    assert Box("secret").inside() == "secret"
    assert Box(1).inside() != Box(2).inside()


@pytest.mark.parametrize("name", ["_inside", "inside_", "_Box_inside"])
def test_no_name_leads_to_it(name):
    box = Box("secret")
    assert not hasattr(box, name)
    assert "_inside" not in dir(box)
    with pytest.raises(AttributeError):
        setattr(box, name, 1)


def test_a_sealed_class_cannot_be_patched():
    with pytest.raises(TypeError, match="Box"):
        Box.inside = None
    with pytest.raises(TypeError, match="Box"):
        del Box.inside


def test_it_is_not_copied_without_its_inside():
    for call in (copy.copy, copy.deepcopy):
        with pytest.raises(TypeError, match="Box"):
            call(Box(1))
