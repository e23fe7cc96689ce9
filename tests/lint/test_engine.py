from __future__ import annotations

import ast
import gc
import sys
from collections.abc import Callable
from pathlib import Path
from random import Random
from textwrap import dedent

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.checking import text_of
from elitescript.language.diagnostics import Outdated
from elitescript.language.options import Options
from elitescript.language.parser import parse
from elitescript.language.scopes import Scope
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import WrittenProgram, check_source
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import all_rules
from elitescript.lint.rules.blend_too_long import blend_too_long
from elitescript.messages.profile import profile
from elitescript.values.program import Values
from tests.invariants.cases import first_of
from tests.invariants.random_programs import random_program
from tests.lint.checking import body, found, problems
from tests.specification.pages import Case, Expectation, parse_page

ROOT = Path(__file__).resolve().parent.parent.parent
EXAMPLES = sorted((ROOT / "examples").glob("*.script"))


def spec_cases() -> list[tuple[Case, Expectation]]:
    """The programs of the specification that stand in one text and are expected to run."""
    pages = sorted(path for path in (ROOT / "tests" / "spec").glob("*.md") if path.name != "README.md")
    cases = [case for page in pages for case in parse_page(page.read_text(encoding="utf-8"))]
    return [
        (case, expectation)
        for case in cases
        for expectation in case.expectations
        if len(case.texts) == 1 and not (case.is_stream or case.is_served or case.needs)
    ]


CASES = spec_cases()
IDS = [f"{case.title} {expectation.label}" for case, expectation in CASES]


class TestOrder:
    def test_problems_come_in_the_order_of_the_text(self):
        places = body("sleep = nothing", "x = = 1", "set_digital_out(p[1, 2])", "sync(1)")
        assert places == ["W203 2:3", "W201 2:11", "E001 3:7", "E301 4:3", "W211 4:19", "E303 5:8"]

    def test_the_same_text_gives_the_same_problems(self):
        text = "def job():\n  a(b, c)\n  sleep(-1, d)\n  global e\nend\n"
        assert problems(text) == problems(text)


class TestMerging:
    def test_in_one_place_the_specific_code_wins(self):
        assert body("job()") == ["W208 2:3"]
        assert body("xrange(3)") == ["W209 2:3"]
        assert body("x = p[0, 0, 0, 0, 0, 0]") == ["W211 2:7"]

    def test_a_specific_error_wins_over_the_syntax_error(self):
        assert body("if 1 <> 2: pass") == ["E111 2:8"]
        assert body("global x = 1") == ["E108 2:3"]

    def test_a_syntax_error_is_not_lost_behind_an_error_about_something_else_in_the_line(self):
        assert found("def h[T](x):\n  return x\nend\n") == ["E001 1:6", "E107 1:10"]
        assert found("def h[T](x=y.__dict__):\n  return x\nend\n") == ["E001 1:6", "E115 1:14"]

    def test_compile_errors_and_findings_stand_side_by_side(self):
        assert body("sleep('1')", "x = = 1", "nothing()") == ["E304 2:9", "E001 3:7", "E301 4:3"]


class TestMaskedText:
    @pytest.mark.parametrize(
        "mark", ["(1)", "(x, 'a')", "(1, 'a') + 2", "(1, 'a').b", "(1, 'a')(2)", "(job, sleep(x))"]
    )
    def test_a_malformed_line_mark_is_one_error(self, mark):
        assert body(f"$ LINE: {mark}", "textmsg(1)") == ["E001 2:3"]

    @pytest.mark.parametrize(
        "line",
        [
            "set_standard_digital_out(a ? 10 : 12, True)",
            "set_standard_digital_out(10 && 12, True)",
            "movej(a ? [1, 2, 3, 4, 5, 6] : [0, 0, 0, 0, 0, 0])",
            "movej([0, 0, 0, 0, 0, 0], a=!1)",
        ],
    )
    def test_what_stands_for_an_operator_of_another_language_has_no_value(self, line):
        assert [finding.split()[0] for finding in body("a = get_flag(0)", line)] == ["E113"]


class TestNamesBetweenErrors:
    @pytest.mark.parametrize(
        "line", ["x = (1", "def f(x)", "for x in range(3)", "import x y", "except E, x:", "global x = 1", "x = 1 +"]
    )
    def test_what_a_broken_line_may_define_is_not_reported(self, line):
        codes = {finding.split()[0] for finding in body(line, "textmsg(x)", "f(1)" if "def" in line else "pass")}
        assert codes & {"W201", "E301", "W206", "W202"} == set()


class TestFirmware:
    def test_the_profile_decides_what_exists(self):
        assert body("halt()") == []
        assert body("halt()", firmware="2.10") == ["E302 2:3"]


class TestUnits:
    def test_programs_scripts_and_secondary_programs_are_checked(self):
        assert found("def job():\n  sleep('a')\nend\n") == ["E304 2:9"]
        assert found("sleep('a')\n") == ["E304 1:7"]
        assert found("sec job():\n  set_flag('a', 1)\nend\n") == ["E304 2:12"]

    def test_columns_count_characters(self):
        assert found("def job():\n  textmsg('温度', nothing)\nend\n") == ["W201 2:17"]

    @pytest.mark.parametrize("text", ["", "\n", "# nothing\n", "pass", "end\n", "\f\n"])
    def test_short_texts_are_no_trouble(self, text):
        assert set(found(text)) <= {"E101 1:1", "W214 1:1"}


class TestRealTexts:
    @pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
    def test_the_examples_have_no_problem(self, path):
        assert check_source(SourceFile(str(path), path.read_text(encoding="utf-8")), profile()) == ()

    @pytest.mark.parametrize("seed", first_of(range(40), 15))
    def test_random_programs_have_none_either(self, seed):
        assert problems(random_program(Random(seed))) == ()

    @pytest.mark.parametrize(("case", "expectation"), CASES, ids=IDS)
    def test_what_the_specification_expects_is_found(self, case, expectation):
        text = SourceFile("<page>", case.texts[0].sent)
        firmware = expectation.words.get("firmware", "2.14")
        found = check_source(text, profile(firmware), strict="strict" in expectation.words)
        lines = {f"{problem.severity} {problem.code} line {problem.line}" for problem in found}
        wanted = {f"warning {value}" for value in expectation.values("warn")}
        wanted |= {f"error {value}" for value in (*expectation.values("finding"), *expectation.values("error"))}
        assert wanted <= lines

    @pytest.mark.parametrize(("case", "expectation"), CASES, ids=IDS)
    def test_a_program_of_the_specification_that_runs_has_no_error(self, case, expectation):
        if expectation.values("alarm") or expectation.values("error") or expectation.values("finding"):
            return
        found = check_source(SourceFile("<page>", case.texts[0].sent), profile(), strict=False)
        caught = "except" in case.texts[0].text
        assert [problem for problem in found if problem.is_error and not caught] == []


FRAGMENTS = """
    def sec end if else: while True: for in return global x y = == ( ) [ ] { } : , . ; # check: ignore p[ job() movej
    sleep( 1 -2.5 "a" 'b f"{ }" \\ lambda import math class try: except with as *args **kw $ LINE: (1,"a") match case
    print raise halt() xrange True None not and or += != <> 温度 nonlocal yield @ -> := start_thread( del assert
""".split()  # noqa: SIM905
BREAKS = ["\n", "\n", "\n  ", "\n    ", "\t", "\n  x = 1\n", "def job():\n", "\nend\n", "\x00", "\ufeff", "\r"]
WORDS = st.sampled_from([*FRAGMENTS, *BREAKS])


class TestGarbage:
    @settings(max_examples=150)
    @given(st.lists(WORDS, max_size=40))
    def test_fragments_of_programs_never_raise(self, words):
        check_source(SourceFile("<garbage>", " ".join(words)), profile())

    @settings(max_examples=60)
    @given(st.text(max_size=80))
    def test_any_text_never_raises(self, text):
        check_source(SourceFile("<garbage>", text), profile(), strict=True)

    @settings(max_examples=60)
    @given(st.integers(0, 10_000), st.randoms(use_true_random=False))
    def test_damaged_programs_never_raise(self, seed, chance):
        text = random_program(Random(seed % 50))
        start = chance.randrange(len(text))
        damaged = (
            text[:start] + chance.choice(["", "(", '"', "\n", "end", ":", " = "]) + text[start + chance.randrange(9) :]
        )
        check_source(SourceFile("<garbage>", damaged), profile("2.10"))

    @pytest.mark.parametrize(
        "text",
        [
            "x = " + "(" * 300 + ")" * 300,
            "x = " + "1 + " * 3000 + "1",
            "x = " + "-" * 3000 + "1",
            "x" + ".a" * 3000,
            "x" + ".a" * 900,
            "x == y" + ".a" * 900,
            "movej(" + "[" * 90 + "]" * 90 + ")",
            "if a: b\n" + "".join(" " * n + "if a:\n" for n in range(1, 150)),
            "while True:\n  if a:\n    pass\n" + "  elif a:\n    pass\n" * 900,
            "if a:\n  return\n" + "elif a:\n  return\n" * 900 + "else:\n  return\npass\n",
            "while " + "a if b else " * 900 + "c:\n  pass\n",
            "while a:\n" + "".join("  " * n + "while a:\n" for n in range(1, 90)) + "  " * 90 + "pass",
            "def f():\n" + "".join("  " * n + "def f():\n" for n in range(1, 90)) + "  " * 90 + "return f()",
        ],
        ids=range(13),
    )
    def test_deep_texts_never_raise(self, text):
        check_source(SourceFile("<deep>", text), profile())


def test_the_docstring_example_of_each_rule_gives_its_code():
    for rule in all_rules():
        lines = rule.explanation.split("\n")
        example = dedent("\n".join(line for line in lines if line.startswith("    ") or not line.strip())).lstrip("\n")
        firmware = "2.10" if "--firmware 2.10" in example else "2.14"
        expected = [number for number, line in enumerate(example.split("\n"), 1) if f"# {rule.code}" in line]
        seen = {problem.line for problem in problems(example, firmware=firmware) if problem.code == rule.code}
        assert seen, rule.code
        assert seen >= set(expected), rule.code


class TestGrowth:
    """Work grows with the length of a text, whatever stands in it."""

    @staticmethod
    def steps(work: Callable[[], object]) -> int:
        """Return how many functions are called, and lines of them run."""
        count = 0

        def note(_frame: object, _event: str, _argument: object) -> object:
            nonlocal count
            count += 1
            return note

        outer = sys.gettrace()
        sys.settrace(note)
        try:
            work()
        finally:
            sys.settrace(outer)
        return count

    @pytest.mark.parametrize(
        "line",
        [
            "  movej([{n}, -1.4, -1.7, -1.6, 1.57, 0])",
            "  movel([0.4, -0.2, 0.{n}, 3.14, 0, 0], r=0.001)",
            "  name{n} = {n}",
            "  if x == {n}:\n    x = 1\n  end",
            "  elif x == {n}:\n    x = 1",
            "  def place{n}(x):\n    return x\n  end\n  place{n}(1)",
            "  unknown{n}(unknown)",
            "  movej([0, 0, 0, 0, 0, 0], vv={n})",
        ],
    )
    def test_ten_times_the_lines_take_ten_times_the_steps(self, line: str) -> None:
        def text(count: int) -> list[str]:
            lines = [line.format(n=number) for number in range(count)]
            return ["  x = 1", "  if x == 0:", "    x = 2", *lines, "  end"] if "elif" in line else lines

        def steps(count: int) -> int:
            source, firmware = SourceFile("long", "\n".join(["def job():", *text(count), "end", ""])), profile()
            return self.steps(lambda: check_source(source, firmware))

        _, few, many, more = (steps(count) for count in (20, 20, 60, 200))
        assert more - many < 1.3 * (many - few) * (200 - 60) / (60 - 20)

    @pytest.mark.parametrize(
        ("first", "part", "last"),
        [
            ("", "  def w{n}():\n    sleep(9)\n    set_flag(0, True)\n  end\n  t{n} = start_thread(w{n}, ())", ""),
            ("  def w():\n    sleep(9)\n    set_flag(0, True)\n  end", "  t{n} = start_thread(w, ())", ""),
            ("", "  def f{n}():\n    global v{n}\n    v{n} = 1\n  end", ""),
            ("", "  def f{n}():\n    global count\n    count = {n}\n  end", "  textmsg(count)"),
            ("", "  def f{n}():\n    level = {n}\n  end", "  global level\n  level = 0"),
            ("  ready = False", "  def f{n}():\n    ready = True\n  end", "  while not ready:\n    sync()\n  end"),
            ("", "  def f{n}():\n    return 1\n  end\n  x{n} = f{n}()\n  y = x{n} + 1", ""),
            ("", "  global name{n}", "  names = 1"),
            ("", "  v{n} = 1\n  global v{n}", ""),
            ("", "  go{n} = get_flag(0)\n  while not go{n}:\n    sync()\n  end\n  def f{n}():\n    x = 1\n  end", ""),
            ("", "  a = get_target_joint_positions()\n  b = a\n  b[{n} % 6] = 1\n  movej(a)", ""),
            ("", "  f{n} = sync\n  f{n}()", ""),
            ("  global flag", "  flag = get_flag(0)\n  if flag:\n    sync()\n  end", ""),
            ('  socket_open("10.0.0.1", 5000, "camera")', '  socket_send_line("x", 0, "camera{n}")', ""),
            ("", '  while True:\n    modbus_add_signal("10.0.0.1", 1, {n}, 2, "m{n}")\n    sync()\n  end', ""),
            ("  movel([0.4, 0, 0.4, 3.14, 0, 0], r=0.01)", "  set_standard_digital_out(0, True)", "  movej(HOME)"),
            ("  for i in range(9):", "    movel([0.4, i * 0.001, 0.{n}, 3.14, 0, 0])", "  end"),
            (
                "  try:",
                "    set_standard_analog_out(0, socket_read_ascii_float(1)[2])",
                "  except Exception:\n    sync()\n  end",
            ),
            ("", "  if get_flag(0):\n    halt()\n    textmsg({n})\n  end", ""),
            ("", "sec s{n}():\n  set_flag(0, True)\nend", ""),
        ],
    )
    def test_a_part_takes_each_rule_as_much_however_many_there_are(self, first: str, part: str, last: str) -> None:
        def steps(count: int) -> dict[str, int]:
            lines = ["def job():", first, *(part.format(n=number) for number in range(count)), last, "end", ""]
            program = AnalysedProgram(parse(SourceFile("long", "\n".join(lines)), Options()), profile())
            assert program.values.is_known
            return {rule.code: self.steps(lambda rule=rule: list(rule.check(program))) for rule in all_rules()}

        few, many, more = (steps(count) for count in (25, 50, 120))
        bounds = {code: 1.15 * max(0, many[code] - few[code]) * (120 - 50) / (50 - 25) + 300 for code in more}
        assert {code: more[code] - many[code] for code in more if more[code] - many[code] > bounds[code]} == {}

    def test_the_statements_of_a_block_are_gone_through_once_for_its_moves(self) -> None:
        class Noted(list):
            """A list that notes how many of its elements are looked at."""

            looked_at = 0

            def __iter__(self):
                for element in super().__iter__():
                    Noted.looked_at += 1
                    yield element

            def __contains__(self, element):
                return any(other is element for other in self)

        lines = [f"  movel([0.4, -0.2, 0.{number}, 3.14, 0, 0])" for number in range(100)]
        parsed = parse(SourceFile("long", "\n".join(["def job():", *lines, "end", ""])), Options())
        program = AnalysedProgram(parsed, profile())
        job = program.command_calls[0].scope.node
        job.body = Noted(job.body)
        assert list(blend_too_long(program)) == []
        assert Noted.looked_at <= 3 * len(lines)


# While a text is written


def analysed(text, is_outdated=bool):
    return AnalysedProgram(parse(SourceFile("a.script", text), Options()), profile(), is_outdated=is_outdated)


class Older:
    """Counts how often it is asked, and says from some time on that there is a newer version."""

    def __init__(self, after: int) -> None:
        self.after = after
        self.asked = 0

    def __call__(self) -> bool:
        self.asked += 1
        return self.asked > self.after


def test_all_findings_of_a_written_program_are_those_of_check():
    text = 'def p():\n  sleep("x" + "y")\n  x = nonsense\n  movej([0, 0])\nend\n'
    written = WrittenProgram(analysed(text))
    quick = written.quick_problems()
    assert [found.code for found in quick] == ["W201"]
    assert written.problems() == check_source(SourceFile("a.script", text), profile())
    assert WrittenProgram(analysed(text)).problems() == written.problems()


@pytest.mark.parametrize("after", [0, 1, 5, 20])
def test_a_check_is_given_up_between_two_rules(after):
    older = Older(after)
    with pytest.raises(Outdated):
        WrittenProgram(analysed("def p():\n  x = nonsense\nend\n", older)).problems()
    assert older.asked == after + 1


def test_an_evaluation_is_given_up_between_two_statements():
    older = Older(500)
    program = analysed("def p():\n  x = 0\n" + "  x = x + 1\n" * 1000 + "  sleep(x)\nend\n", older)
    with pytest.raises(Outdated):
        program.values.of(program.symbols.body.calls[0])
    assert older.asked == 501
    older.after = 1_000_000
    assert program.values.of(program.symbols.body.calls[0].args[0]).constant == 1000


def test_rules_that_need_no_values_evaluate_nothing():
    quick = [each for each in all_rules() if not each.needs_values]
    for other in all_rules():
        example = "\n".join(line[4:] for line in other.explanation.split("\n") if line.startswith("    "))
        program = analysed(example)
        if program.parsed.is_complete:
            for each in quick:
                list(each.check(program))
                assert "values" not in program.__dict__, f"{each.code} in the example of {other.code}"


@pytest.mark.parametrize("kind", ["mixed statements", "functions", "lists that change", "threads"])
def test_nothing_of_a_checked_text_waits_for_the_collector(kind):
    source = SourceFile("a.script", text_of(kind, 60))
    gc.collect()
    gc.disable()
    gc.set_debug(gc.DEBUG_SAVEALL)
    try:
        check_source(source, profile())
        gc.collect()
        assert not [found for found in gc.garbage if isinstance(found, (ast.AST, Scope, AnalysedProgram, Values))]
    finally:
        gc.set_debug(0)
        gc.garbage.clear()
        gc.enable()
