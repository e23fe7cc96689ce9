from __future__ import annotations

import pytest

from elitescript.language.compiler import check_unit
from elitescript.language.parser import parse
from elitescript.language.text.source import SourceFile, apply_fixes

FLAT = """def job():
# wait for the part
while not get_flag(0):
if get_flag(1):
sleep(0.1)
else:
sync()
end
end
textmsg("there")
end
"""
INDENTED = """def job():
# wait for the part
  while not get_flag(0):
    if get_flag(1):
      sleep(0.1)
    else:
      sync()
    end
  end
  textmsg("there")
end
"""


def problems(text):
    return check_unit(SourceFile("f", text))


def test_the_loss_is_said_once_at_the_first_line_that_should_be_indented():
    (problem,) = problems(FLAT)
    assert (problem.code, problem.line, problem.column) == ("E001", 3, 1)
    assert problem.text == (
        "the indentation is lost: every line begins in column 1, so nothing is inside the `def` of line 1"
    )
    assert problem.hint == "indent the lines between each header and its `end` by two or four blanks"


def test_the_fix_follows_the_ends():
    (problem,) = problems(FLAT)
    assert problem.fix is not None
    assert problem.fix.safe
    assert apply_fixes(FLAT, [problem.fix]) == INDENTED
    assert problems(INDENTED) == ()


@pytest.mark.parametrize(
    "text",
    [
        "def job():\nif get_flag(0):\nsync()\nend\n",
        "def job():\nsync()\nend\nend\n",
        "def job():\nif get_flag(0): sync()\nelse:\nsync()\nend\nend\n",
        "def job():\nwhile get_flag(0):\nsync()\n",
    ],
)
def test_without_all_its_ends_there_is_no_fix(text):
    problem = problems(text)[0]
    assert "the indentation is lost" in problem.text
    assert problem.fix is None


def test_a_flat_secondary_program_stays_one():
    text = "sec lamp():\nset_configurable_digital_out(1, True)\nend\n"
    assert [problem.code for problem in problems(text)] == ["E001"]
    assert parse(SourceFile("f", text)).kind == "secondary"


def test_other_mistakes_are_found_at_their_own_places():
    text = FLAT.replace("sleep(0.1)", "sleep(0.1")
    assert [(problem.line, problem.column) for problem in problems(text)] == [(3, 1), (5, 6)]


@pytest.mark.parametrize(
    "text",
    [
        "sync()\nsync()\n",
        "def job():\nend\n",
        "if get_flag(0): sync()\nsync()\n",
        "x = [\n1,\n2]\n",
        "def job():\n  sync()\nend\n",
        "if get_flag(0):\nsync()\n",
    ],
)
def test_other_texts_did_not_lose_it(text):
    assert not any("the indentation is lost" in problem.text for problem in problems(text))


def test_a_text_with_very_many_headers_is_not_restored():
    text = "if x:\n" * 200 + "end\n" * 200
    assert not any("the indentation is lost" in problem.text for problem in problems(text))


def test_a_flat_secondary_program_without_end_is_about_its_indentation_alone() -> None:
    for text in ("sec s():\nset_flag(1, True)\nx = 2\n", "sec s():\nset_flag(1, True)\n"):
        parsed = parse(SourceFile("s.script", text))
        assert [(row.code, row.line) for row in parsed.diagnostics if row.is_error] == [("E001", 2)]
    longer = parse(SourceFile("s.script", "sec s():\n  set_flag(1, True)\nend\nx = 2\n"))
    assert [row.code for row in longer.diagnostics] == ["E105"]
