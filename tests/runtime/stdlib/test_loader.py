import sys

import pytest

from elitescript.errors import InternalError
from elitescript.language.modules import COPIED as COPIED_MODULES
from elitescript.runtime.stdlib.loader import COPIED, KNOWN_PYTHONS, CopyLoader, check_python, real


def test_an_unknown_python_is_refused_with_the_known_ones():
    with pytest.raises(InternalError, match=r"Python 3\.99 .* use Python 3\.11, 3\.12, 3\.13"):
        check_python((3, 99))


def test_this_python_is_known():
    assert sys.version_info[:2] in KNOWN_PYTHONS
    check_python()


def test_copies_are_private():
    one, two = CopyLoader({}), CopyLoader({})
    assert one.load("textwrap").TextWrapper is not two.load("textwrap").TextWrapper
    assert one.load("textwrap") is one.load("textwrap")
    assert one.load("textwrap").TextWrapper is not real("textwrap").TextWrapper


def test_copies_find_each_other():
    loader = CopyLoader({"random": None})
    assert loader.load("statistics").Fraction is loader.load("fractions").Fraction


def test_a_copy_that_cannot_be_made_leaves_nothing_behind():
    loader = CopyLoader({})
    with pytest.raises(InternalError, match="not installed"):
        loader.load("no_such_module")
    with pytest.raises(InternalError):
        loader.load("no_such_module")


def test_copies_print_nothing(capsys):
    loader = CopyLoader({})
    loader.load("collections.abc").Mapping._dump_registry()
    copied = vars(loader.load("textwrap"))["__builtins__"]
    copied["print"]("nothing")
    assert "nothing" not in capsys.readouterr().out


def test_every_module_that_programs_get_as_a_copy_can_be_copied():
    assert COPIED >= COPIED_MODULES
