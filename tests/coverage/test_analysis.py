"""What a text could run, and what its counters say, against counts made by hand."""

from __future__ import annotations

import pytest

from elitescript.coverage.analysis import added, analyse, program_coverage
from elitescript.coverage.model import Branch, Function, Handler
from elitescript.errors import ProgramError
from elitescript.language.text.source import SourceFile

TEXT = """def cell():
  global a
  "a text"
  a = 1; b()
  if a > 1:
    while a:
      c()
    end
  end
  try:
    d()
  except (ValueError, KeyError) as error:
    global g
    g = 1
  except:
    pass
  end
  def e(x):
    return x
  end
end
"""


def coverage(counts: list[int]):
    return program_coverage("cell.script", analyse(SourceFile("cell.script", TEXT)), counts)


# Counters in the order of the text: a = 1, b(), if, while, c(), try, d(), g = 1, pass, def e, return; then the sides
# without statements: past the if, past the while.
COUNTS = [3, 2, 2, 0, 0, 2, 2, 1, 0, 1, 7, 2, 0]


def test_lines_have_the_largest_count_of_their_statements():
    assert coverage(COUNTS).lines == {4: 3, 5: 2, 6: 0, 7: 0, 10: 2, 11: 2, 14: 1, 16: 0, 18: 1, 19: 7}


def test_branches_of_lines_that_were_not_reached_have_no_count():
    assert coverage(COUNTS).branches == (Branch(5, 6, 0), Branch(5, None, 2), Branch(6, 7, None), Branch(6, None, None))


def test_functions_and_handlers():
    found = coverage(COUNTS)
    assert found.functions == (Function("e", 18, 19, 7),)
    assert found.handlers == (Handler(12, "except (ValueError, KeyError) as error", 1), Handler(15, "except", 0))


def test_a_program_that_no_test_ran():
    found = coverage([])
    assert set(found.lines.values()) == {0}
    assert found.numbers.percent == 0
    assert len(found.source) == 21


def test_counters_beyond_those_of_the_text_do_not_matter():
    assert coverage([*COUNTS, 9, 9]) == coverage(COUNTS)


def test_counts_of_processes_are_added():
    assert added([]) == []
    assert added([(1, 2), (3,), (0, 0, 5)]) == [4, 2, 5]


def test_calls_are_known_by_their_first_line():
    program = analyse(SourceFile("a", "def a():\n  sleep(1)\n  sleep(2)\n  movej(p)\nend\n"))
    assert program.calls == {"sleep": 2, "movej": 4}
    assert program.kind == "program"


def test_what_does_not_compile_is_refused():
    with pytest.raises(ProgramError):
        analyse(SourceFile("a", "def a(:\n"))
