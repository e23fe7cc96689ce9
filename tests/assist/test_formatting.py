"""Layout of programs: what it looks like, and that nothing that runs changes."""

from __future__ import annotations

from random import Random

import pytest

from elitescript.assist.document import Document
from elitescript.assist.formatting import format_edits, formatted, is_generated
from elitescript.assist.typing_edits import TRIGGERS, typing_edits
from elitescript.errors import ProgramError
from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.text.source import apply_fixes
from elitescript.lint.program import Span
from tests.assist.layouts import compiled, mangled, texts_of_the_repository
from tests.invariants.cases import first_of
from tests.invariants.random_programs import random_program as random_robot_program
from tests.language.random_programs import random_program

DAMAGE = (
    *("", "\n", "end", "  ", "\t", "(", ")", ":", "'''", "'", "#", "\\\n", "\f", "$ LINE: (1, 'a')", "\\", "\r"),
    *("é", "=", "-", "**", "lambda x=1: ", "[", "]", "\n\n\n", "if a: b\n", "; ", "\ufeff", "\0", "{1:2}", "f'{a}'"),
)
TEXTS = texts_of_the_repository()


def laid_out(text: str) -> str:
    result = formatted(text, pendant=True)
    assert result.problems == ()
    return result.text


def with_edits(text: str, edits: tuple[Edit, ...]) -> str:
    return apply_fixes(text, [Fix("layout", edits, safe=True)])


def check_that_nothing_changes(text: str) -> None:
    """Check what holds for every text: what runs is the same, in the same lines; doing it again changes nothing."""
    new = laid_out(text)
    assert compiled(new) == compiled(text)
    assert laid_out(new) == new
    assert len(new.rstrip().splitlines()) == len(text.rstrip().splitlines())
    assert with_edits(text, format_edits(Document("p.script", text), pendant=True)) == new


class TestLayout:
    def test_blocks_get_two_blanks_and_end_stands_below_its_opener(self):
        text = (
            "def job():\n"
            "      if a:\n"
            "          b()\n"
            "      else:\n"
            "       for i in c:\n"
            "        d()\n"
            "       end\n"
            "      end\n"
            "      e()\n"
            "end\n"
        )
        assert laid_out(text) == (
            "def job():\n  if a:\n    b()\n  else:\n    for i in c:\n      d()\n    end\n  end\n  e()\nend\n"
        )

    def test_an_outer_end_may_close_several_blocks(self):
        text = "def job():\n    while a:\n        if b:\n            c()\n    end\n    d()\nend\n"
        assert laid_out(text) == "def job():\n  while a:\n    if b:\n      c()\n  end\n  d()\nend\n"

    def test_tabs_become_blanks(self):
        assert laid_out("def job():\n\tif a:\n\t    b()\n\tend\nend\n") == "def job():\n  if a:\n    b()\n  end\nend\n"

    def test_comments_of_their_own_move_with_their_block(self):
        text = (
            "# of the file\n"
            "def job():\n"
            "# of the first statement\n"
            "    if a:\n"
            "# of the body\n"
            "        b()\n"
            "        # still of the body\n"
            "    # of the else\n"
            "    else:\n"
            "        c()\n"
            "          #   still of the else, as it stands\n"
            "    # of the end\n"
            "    end\n"
            "  # of the job, although not deep enough\n"
            "end\n"
            "  # of nothing\n"
        )
        assert laid_out(text) == (
            "# of the file\n"
            "def job():\n"
            "  # of the first statement\n"
            "  if a:\n"
            "    # of the body\n"
            "    b()\n"
            "    # still of the body\n"
            "  # of the else\n"
            "  else:\n"
            "    c()\n"
            "    #   still of the else, as it stands\n"
            "  # of the end\n"
            "  end\n"
            "  # of the job, although not deep enough\n"
            "end\n"
            "# of nothing\n"
        )

    def test_comments_behind_code_keep_two_blanks_and_their_common_column(self):
        text = "a=1     # one\nbb = 2   # two\n         # goes on\nccc = 3 # three\nd = 4     # four\n\ne = 5#five\n"
        assert laid_out(text) == (
            "a = 1     # one\nbb = 2   # two\n         # goes on\nccc = 3  # three\nd = 4     # four\n\ne = 5  #five\n"
        )
        assert laid_out("a=1   # one\nbcd=2 # two\n") == "a = 1    # one\nbcd = 2  # two\n"

    def test_statements_over_several_lines_keep_their_inside_and_their_alignment(self):
        text = (
            "def job():\n"
            "    M=[[ 1,  2],\n"
            "       [10, 20]]   \n"
            "    x=f(a ,\n"
            "        b)+ 1   # sum\n"
            "    if a and \\\n"
            "            b:\n"
            "        movej(\n"
            "            [1,2],\n"
            "\n"
            "            # slow\n"
            "            a=1,\n"
            "        )\n"
            "end\n"
        )
        assert laid_out(text) == (
            "def job():\n"
            "  M = [[ 1,  2],\n"
            "       [10, 20]]\n"
            "  x = f(a ,\n"
            "        b)+ 1   # sum\n"
            "  if a and \\\n"
            "          b:\n"
            "    movej(\n"
            "        [1,2],\n"
            "\n"
            "        # slow\n"
            "        a=1,\n"
            "    )\n"
            "end\n"
        )

    def test_rows_aligned_with_a_bracket_move_with_it(self):
        text = "def job():\n    x=f(a,\n        g(b,\n          [1,\n           2]),\n      c)\nend\n"
        assert laid_out(text) == ("def job():\n  x = f(a,\n        g(b,\n          [1,\n           2]),\n    c)\nend\n")

    def test_strings_over_several_lines_stay_as_they_are(self):
        text = "def job():\n    s='''a  \n      b   \n\t''' % (1,2)\n    t=1\nend\n"
        assert laid_out(text) == "def job():\n  s = '''a  \n      b   \n\t''' % (1,2)\n  t = 1\nend\n"

    def test_marks_of_the_pendant_stay_byte_for_byte(self):
        text = 'def job():\n    $ LINE:  (1 ,"a,b")\n    if x: $ LINE: (2,"c")\nend\n'
        assert laid_out(text) == 'def job():\n  $ LINE:  (1 ,"a,b")\n  if x: $ LINE: (2,"c")\nend\n'

    def test_no_line_is_added_or_taken_away_but_blank_ones_at_the_end(self):
        assert laid_out("\n\n\na=1\n  \n\t\n\n\nb=2\n\n \n\n") == "\n\n\na = 1\n\n\n\n\nb = 2\n"
        assert laid_out("a = 1") == "a = 1\n"
        assert laid_out("\r\n \r\n") == ""
        assert laid_out("") == ""

    def test_line_ends_and_the_byte_order_mark_stay(self):
        assert laid_out("\ufeffdef f():\r\n    a=1\r\nend") == "\ufeffdef f():\r\n  a = 1\r\nend\r\n"
        assert laid_out("a=1\rb=2\r") == "a = 1\rb = 2\r"
        assert laid_out("a=1\r\nb=2\n") == "a = 1\r\nb = 2\n"

    def test_remains_of_python_2_keep_the_blanks_that_tell_them_apart(self):
        assert laid_out('def job():\n    print  "x" ,1\n    a=12L\n    b=1\nend\n') == (
            'def job():\n  print  "x" ,1\n  a=12L\n  b = 1\nend\n'
        )

    @pytest.mark.parametrize(
        "text",
        [
            "def job():\n\\\n    a=1\n    b=2\nend\n",
            "def job():\n    \\\na=1\n    b=f(2,\n  3)\nend\n",
            "def job():\n   \\\n  \\\na=1\n   # c\n   b=2\nend\n",
        ],
    )
    def test_an_indentation_before_a_backslash_stays(self, text):
        assert compiled(laid_out(text)) == compiled(text)
        assert laid_out(text) == text.replace("=", " = ")


class TestWhatIsLeft:
    def test_a_text_with_syntax_errors_is_left_and_they_are_located(self):
        text = "def job():\n    a=(1\n    b  = 2\nend\n"
        result = formatted(text, "cell.script")
        assert result.text == text
        assert [(problem.code, problem.line, problem.column) for problem in result.problems] == [("E001", 2, 7)]
        assert format_edits(Document("cell.script", text)) == ()

    def test_what_only_fails_when_it_runs_is_laid_out(self):
        assert laid_out("foo( 1 )\nmovej(vv = 2)\n") == "foo(1)\nmovej(vv=2)\n"

    @pytest.mark.parametrize("mark", ['$ LINE: (1, "a")', 'labelmsg(1, "a")'])
    def test_a_text_of_the_pendant_is_left_unless_asked(self, mark):
        text = f"def job():\n    {mark}\n    a=1\nend\n"
        result = formatted(text)
        assert (result.text, result.is_left, result.problems) == (text, True, ())
        document = Document("p", text)
        assert is_generated(document.parsed)
        assert format_edits(document) == ()
        assert laid_out(text) == f"def job():\n  {mark}\n  a = 1\nend\n"


class TestEdits:
    def test_they_are_the_least_of_each_line(self):
        document = Document("p", "def job():\n  a = 1\n  b =2\n    # c\nend\n")
        assert format_edits(document) == (Edit(3, 6, 3, 6, " "), Edit(4, 3, 4, 5, ""))

    def test_a_laid_out_text_needs_none(self):
        assert format_edits(Document("p", "def job():\n  a = 1\nend\n")) == ()

    def test_blank_lines_at_the_end_go_and_a_missing_line_end_comes(self):
        assert format_edits(Document("p", "a = 1")) == (Edit(1, 6, 1, 6, "\n"),)
        assert with_edits("a=1\n\n \n", format_edits(Document("p", "a=1\n\n \n"))) == "a = 1\n"

    def test_a_range_changes_its_lines_alone_and_no_block_in_part(self):
        text = "def job():\n    a=1\n    if b:\n        c=2\n        d=3\n    end\nend\n"
        document = Document("p", text)
        assert with_edits(text, format_edits(document, Span(4, 1, 5, 1))) == text.replace("c=2", "c = 2")
        whole_block = with_edits(text, format_edits(document, Span(3, 2, 6, 3)))
        assert whole_block == "def job():\n    a=1\n    if b:\n      c = 2\n      d = 3\n    end\nend\n"

    @pytest.mark.parametrize("seed", first_of(range(20), 8))
    def test_random_ranges_keep_what_runs(self, seed):
        rng = Random(seed)
        text = mangled(rng, random_program(rng))
        last = text.count("\n") + 1
        for _ in range(5):
            first = rng.randrange(1, last + 1)
            span = Span(first, 1, rng.randrange(first, last + 1), 3)
            assert compiled(with_edits(text, format_edits(Document("p", text), span))) == compiled(text)


class TestNothingChanges:
    @pytest.mark.parametrize("name", TEXTS)
    def test_in_programs_of_the_repository(self, name):
        text = TEXTS[name]
        try:
            compiled(text)
        except ProgramError:
            assert formatted(text).text == text or not formatted(text).problems
            return
        rng = Random(name)
        variants = [text, mangled(rng, text)]
        if name.endswith(".script"):
            variants.append("\ufeff" + text.replace("\n", "\r\n"))
        for variant in variants:
            check_that_nothing_changes(variant)

    @pytest.mark.parametrize("seed", first_of(range(60), 25))
    def test_in_random_programs(self, seed):
        rng = Random(seed)
        write = rng.choice((random_program, random_robot_program))
        check_that_nothing_changes(mangled(rng, write(rng)))

    @pytest.mark.parametrize("seed", first_of(range(20), 8))
    def test_in_damaged_texts_and_nothing_is_raised(self, seed):
        rng = Random(seed)
        for text in map(rng.choice, [list(TEXTS.values())] * 40):
            damaged = text[:800]
            for _ in range(rng.randrange(1, 4)):
                at = rng.randrange(len(damaged) + 1)
                damaged = damaged[:at] + rng.choice(DAMAGE) + damaged[at + rng.randrange(5) :]
            document = Document("p", damaged)
            place = rng.randrange(document.line_count + 2), rng.randrange(20)
            typing_edits(document, *place, rng.choice(TRIGGERS))
            try:
                before = compiled(damaged)
            except ProgramError:
                formatted(damaged)
                continue
            new = laid_out(damaged)
            assert compiled(new) == before
            assert laid_out(new) == new
            edits = format_edits(document, Span(place[0], 1, place[0] + 3, 1), pendant=True)
            assert compiled(with_edits(damaged, edits)) == before

    def test_the_examples_are_laid_out(self):
        examples = {name: text for name, text in TEXTS.items() if name.endswith(".script")}
        assert examples == {name: laid_out(text) for name, text in examples.items()}

    def test_bad_layout_becomes_the_good_one_again(self):
        for seed in range(60):
            rng = Random(seed)
            good = laid_out(random_robot_program(rng))
            assert laid_out(mangled(rng, good)) == good
