from __future__ import annotations

import os
import subprocess
import sys

from elitescript.commands.definition.docstring import read_docstring

ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}

TEXT = """Do a thing: at once.

    How it is done,
    in two lines.

    And a second paragraph.

    Args:
        q: joints: all of them,
            base first.
        t: time.

    Returns:
        What came
        of it.

    Raises:
        ValueError: it did not
            work.
    """


def test_all_parts_are_found() -> None:
    doc = read_docstring(TEXT)
    assert doc.summary == "Do a thing: at once."
    assert doc.behaviour == "How it is done,\nin two lines.\n\nAnd a second paragraph."
    assert doc.args == {"q": "joints: all of them, base first.", "t": "time."}
    assert doc.returns == "What came of it."
    assert doc.raises == {"ValueError": "it did not work."}


def test_compilers_that_remove_the_indentation_change_nothing() -> None:
    first, *rest = TEXT.split("\n")
    dedented = "\n".join([first, *(line[4:] for line in rest)])
    assert read_docstring(dedented) == read_docstring(TEXT)


def test_one_line_is_a_summary() -> None:
    assert read_docstring("Only this.") == ("Only this.", "", {}, "", {})
    assert read_docstring("") == ("", "", {}, "", {})


def test_text_behind_a_section_belongs_to_the_behaviour() -> None:
    doc = read_docstring("One.\n\nArgs:\n    a: first.\n\nLater words.\n")
    assert doc.args == {"a": "first."}
    assert doc.behaviour == "Later words."


class TestDocstringsThatPythonHasLeftOut:
    """`-OO` strips them from the code; the sources have them."""

    def test_those_of_commands_and_rules_are_read_from_their_sources(self) -> None:
        call = """
from inspect import cleandoc
from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.docstring import docstring_of
from elitescript.lint.registry import all_rules

for text in (*(docstring_of(row.function) for row in CATALOGUE), *(row.explanation for row in all_rules())):
    assert text
    print(cleandoc(text))
"""
        shown = [
            subprocess.run([sys.executable, *options, "-c", call], env=ENVIRONMENT, capture_output=True, check=True)
            for options in ([], ["-OO"])
        ]
        assert shown[0].stdout == shown[1].stdout
        assert len(shown[0].stdout) > 50_000
