"""Programs that are cut out of modules of tests: what they hold, and what they leave out."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.foreign.running import on_python
from tests.foreign.slicing import Case, cases
from tests.foreign.sources import Library, read_module, words_of

MODULE = '''"""A module of tests."""
import unittest, math
from test import helpers
from test.support import cpython_only, ALWAYS_EQ as EQUAL

LIMIT = 3
LIMITS = []
LIMITS.append(LIMIT)
UNUSED = object.__subclasses__()

def double(x):
    global calls
    calls = calls + 1
    return 2 * x

calls = 0

class Base:
    name = "base"
    other = 5

    def helped(self, x):
        return double(x)

    def test_in_base(self):
        self.assertEqual(self.helped(LIMIT), 6)


class Tests(Base, unittest.TestCase):
    """Says nothing."""

    def setUp(self):
        self.x = 1

    # about the next one
    @cpython_only
    def test_one(self):
        self.assertEqual(math.floor(1.5), self.x)
        text = """
no indentation
"""
        self.assertIn("no", text)

    def test_two(self):
        self.assertTrue(helpers.is_odd(3) and EQUAL == 5)
        self.assertEqual(LIMITS, [3])

    def test_three(self):
        with self.assertRaises(ZeroDivisionError):
            1 / 0
        self.assertRaises(ValueError, int, "x")

    def test_four(self):
        missing_helper.f()

    def test_five(self):
        mock.patch()


class NoTests(Base):
    pass

from unittest import mock

if __name__ == "__main__":
    unittest.main()
'''
HELPERS = "import os\ndef is_odd(x): return x % 2 == 1\ndef never(x): return os.system(x)\n"
SUPPORT = """class _Equal:
    def __eq__(self, other):
        return True
ALWAYS_EQ = _Equal()
"""


@pytest.fixture
def library(tmp_path: Path) -> Library:
    (tmp_path / "support").mkdir()
    (tmp_path / "support" / "__init__.py").write_text(SUPPORT)
    (tmp_path / "helpers.py").write_text(HELPERS)
    (tmp_path / "test_it.py").write_text(MODULE)
    return Library(tmp_path)


def sliced(library: Library) -> dict[str, Case]:
    return {case.name.rpartition(".")[2]: case for case in cases(library, "language", ["test_it"])}


def test_each_method_of_a_class_and_its_bases_is_a_case(library: Library) -> None:
    found = [case.name for case in cases(library, "language", ["test_it"])]
    methods = ["test_one", "test_two", "test_three", "test_four", "test_five", "test_in_base"]
    assert found == [f"test_it.Tests.{method}" for method in methods]


def test_a_program_holds_what_its_method_needs_and_no_more(library: Library) -> None:
    text = sliced(library)["test_one"].text
    assert "import math" in text and "def setUp" in text and '\nno indentation\n"""' in text
    for name in ("LIMIT", "double", "test_two", "test_in_base", "helped", "__subclasses__", "helpers", "other = 5"):
        assert name not in text
    assert text.endswith("foreign_run(Tests, 'test_one')\n")


def test_what_another_module_of_the_tests_gives_is_taken_out_of_it(library: Library) -> None:
    text = sliced(library)["test_two"].text
    assert "def is_odd" in text and "helpers = Namespace(is_odd=is_odd)" in text and "EQUAL = ALWAYS_EQ" in text
    assert "never" not in text and "LIMITS.append(LIMIT)" in text
    assert "from test" not in text and "import unittest" not in text


def test_names_that_are_declared_global_are_global_in_the_program(library: Library) -> None:
    text = sliced(library)["test_in_base"].text
    assert text.splitlines()[0] == "global calls, foreign_end, foreign_notes"
    assert on_python(text).end == "passed"


@pytest.mark.parametrize("method", ["test_one", "test_two", "test_three", "test_in_base"])
def test_programs_run_as_the_body_of_a_function(library: Library, method: str) -> None:
    outcome = on_python(sliced(library)[method].text)
    assert (outcome.end, outcome.kind, outcome.text) == ("passed", "", "")
    assert outcome.notes


def test_operands_are_noted_in_their_order(library: Library) -> None:
    found = sliced(library)
    assert on_python(found["test_one"].text).notes == [["equal", "1", "1"], ["in", "'no'", "'\\nno indentation\\n'"]]
    assert on_python(found["test_three"].text).notes == [
        ["raises", "<class 'ZeroDivisionError'>"],
        ["message", "'division by zero'"],
        ["raises", "<class 'ValueError'>"],
        ["message", "\"invalid literal for int() with base 10: 'x'\""],
    ]


def test_a_name_that_nothing_gives_fails_where_it_is_used(library: Library) -> None:
    case = sliced(library)["test_four"]
    outcome = on_python(case.text)
    assert (outcome.end, outcome.kind) == ("error", "NameError")
    assert case.text.split("\n")[outcome.line - 1].strip() == "missing_helper.f()"


def test_what_has_no_stand_in_is_said(library: Library) -> None:
    case = sliced(library)["test_five"]
    assert (case.text, case.why) == ("", "it needs unittest.mock")


def test_modules_for_the_tests_of_the_interpreter_are_no_matter_of_programs(tmp_path: Path) -> None:
    text = "import unittest\ntry:\n    import _testcapi\nexcept ImportError:\n    _testcapi = None\n"
    tests = "class T(unittest.TestCase):\n    def test_a(self):\n        _testcapi.f()\n"
    (tmp_path / "test_x.py").write_text(text + tests)
    case = next(cases(Library(tmp_path), "language", ["test_x"]))
    assert case.why == "it needs a module that CPython has for its own tests alone"


def test_a_module_is_imported_as_it_is_for_tests_that_ask_for_a_fresh_one() -> None:
    module = read_module("test_x", "c = import_helper.import_fresh_module('heapq', fresh=['_heapq'])\n")
    assert [piece.text for piece in module.pieces] == [
        "c = foreign_module_heapq",
        "import heapq as foreign_module_heapq",
    ]


def test_statements_that_share_a_line_are_written_anew() -> None:
    module = read_module("test_x", "a = 1; b = (a,\n    2)\n")
    assert [(piece.names, piece.text) for piece in module.pieces] == [(("a",), "a = 1"), (("b",), "b = (a, 2)")]


def test_what_a_text_takes_from_around_it() -> None:
    words = words_of(
        "class A(B):\n    def f(self, x):\n        global g\n        y = x + h\n        return [z for z in y]\n"
    )
    assert words.free == {"B", "g", "h"}
    assert words.declared == {"g"}
    assert {"A", "f", "self", "x", "y", "z"} <= words.all
