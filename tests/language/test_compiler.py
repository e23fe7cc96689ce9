from __future__ import annotations

import builtins
import subprocess
import sys
import traceback
from pathlib import Path

import pytest

import elitescript
from elitescript.errors import ProgramError
from elitescript.language.compiler import (
    check_unit,
    column_of,
    compile_expression,
    compile_parsed,
    compile_task,
    compile_unit,
)
from elitescript.language.hooks import HOOKS, MAIN
from elitescript.language.options import Options
from elitescript.language.parser import parse
from elitescript.language.text.source import SourceFile
from tests.language.marked import check_marks, codes
from tests.language.stage import Stage


def compiled(text, **options):
    return compile_unit(SourceFile("pick.script", text), Options(**options))


def test_a_unit_says_what_it_is():
    unit = compiled('def job():\n  global a, b\n  def f():\n    global c\n    c = 1\n  end\n  $ LINE: (1, "x")\nend')
    assert (unit.kind, unit.name, unit.has_line_marks) == ("program", "job", True)
    assert unit.global_names == {"a", "b", "c"}
    assert unit.diagnostics == ()
    assert unit.code.co_filename == "pick.script"


def test_executing_the_code_binds_one_hidden_name():
    namespace = {"__builtins__": dict(vars(builtins))}
    exec(compiled("def job(x=3):\n  return x\nend").code, namespace)
    assert set(namespace) == {"__builtins__", MAIN}
    assert not MAIN.isidentifier()


def test_hidden_names_cannot_be_spelled_and_are_not_mangled():
    for name in HOOKS:
        assert not name.isidentifier()
        assert not name.startswith("__")
        assert codes(f"{name}()") != []


def test_nothing_but_hooks_and_names_of_the_text_are_used():
    code = compiled("def job():\n  class C:\n    def __init__(self): self.__x = [i for i in y]\nend").code
    names = set()
    stack = [code]
    while stack:
        item = stack.pop()
        names.update(item.co_names)
        stack.extend(constant for constant in item.co_consts if hasattr(constant, "co_names"))
    assert names - set(HOOKS) <= {
        MAIN,
        "y",
        "_C__x",
        "__init__",
        "__name__",
        "__module__",
        "__qualname__",
        "__static_attributes__",
        "__classdictcell__",
        "__firstlineno__",
    }


class TestErrors:
    def test_all_findings_are_raised_together_in_order(self):
        with pytest.raises(ProgramError) as caught:
            compiled("def job(p):\n  print x\n  x = = 1\n  x.__dict__\n  break\n  y = '\\d'\nend")
        found = [(problem.code, problem.line) for problem in caught.value.problems]
        assert found == [("E107", 1), ("E106", 2), ("E001", 3), ("E115", 4), ("E001", 5), ("W210", 6)]

    def test_warnings_come_with_the_unit(self):
        assert [problem.code for problem in compiled("print 1\nx = 2L").diagnostics] == ["E106", "E110"]

    def test_strict_makes_them_errors(self):
        with pytest.raises(ProgramError):
            compiled("print 1", strict=True)

    def test_checking_returns_what_compiling_raises(self):
        text = "def job(p):\n  print x\n  break\nend"
        with pytest.raises(ProgramError) as caught:
            compiled(text)
        assert check_unit(SourceFile("f", text)) == caught.value.problems

    @pytest.mark.parametrize(
        "text",
        [
            "def job(«a»):\n  f()\nend",
            "def job(«a», b=1, *c, d=2, **e):\n  f()\nend",
            "def job(a=1, *, «b», c=2):\n  f()\nend",
            "def job(«a», /, «b»: int):\n  f()\nend",
            "sec go(«温度»):\n  f()\nend",
        ],
    )
    def test_parameters_of_a_unit_need_defaults(self, text):
        check_marks("E107", text)

    @pytest.mark.parametrize(
        "text",
        [
            "def job():\n  f()\nend",
            "def job(a=1, *b, c=2, **d):\n  f()\nend",
            "def job(a):\n  f()\nend\njob(1)",
            "x = 1\ndef f(a):\n  pass\n",
        ],
    )
    def test_other_functions_take_what_they_like(self, text):
        assert codes(text) == []

    @pytest.mark.parametrize(
        "text",
        ["def job():\n  x = «yield» 1\nend", "«yield» x", "def job():\n  for i in j:\n    «yield» from i\nend"],
    )
    def test_a_program_cannot_be_a_generator(self, text):
        check_marks("E001", text)

    def test_functions_in_it_can(self):
        assert codes("def job():\n  def g():\n    yield 1\n  x = lambda: (yield)\nend") == []

    def test_mistakes_that_only_pythons_compiler_finds_are_all_found(self):
        text = (
            "def a():\n  break\n  def f(x, x):\n    continue\n  for i in y:\n    break\n  nonlocal z\n  return 1\nend"
        )
        assert codes(text) == ["E001 2", "E001 3", "E001 4", "E001 7"]

    def test_a_variable_whose_line_has_a_mistake_is_not_missed(self):
        assert codes("def a():\n  z = = 1\n  def f():\n    nonlocal z\n    z = 2\nend") == ["E001 2"]


class TestNames:
    def test_the_program_keeps_its_name_in_listings(self):
        stage = Stage()
        stage.run(
            "def job():\n  def f():\n    class C:\n      def m(self): pass\n    return C\n"
            "  textmsg(f.__qualname__, ' ', f().__qualname__, ' ', f().m.__qualname__)\nend"
        )
        assert stage.out == ["job.<locals>.f job.<locals>.f.<locals>.C job.<locals>.f.<locals>.C.m"]

    def test_a_script_is_called_main(self):
        stage = Stage()
        stage.run("f = lambda: 0\ntextmsg(f.__qualname__)")
        assert stage.out == ["main.<locals>.<lambda>"]

    def test_the_program_cannot_call_itself(self):
        with pytest.raises(NameError):
            Stage().run("def job():\n  job()\nend")


class TestPlaces:
    def frames(self, text, **options):
        """(line, column, name) of the frames of the script when it fails."""
        source = SourceFile("pick.script", text)
        try:
            Stage().run(text, Options(**options))
        except Exception as error:
            found = []
            for frame, line in traceback.walk_tb(error.__traceback__):
                if frame.f_code.co_filename == "stage.script":
                    position = list(frame.f_code.co_positions())[_lasti(error, frame) // 2]
                    found.append((line, column_of(source, position[0], position[2]), frame.f_code.co_name))
            return found
        raise AssertionError("the program did not fail")

    @pytest.mark.parametrize(
        ("text", "expected"),
        [
            ("def job():\n  x = 1\n  y = x / 0\nend", [(3, 7, "job")]),
            ("def job():\n\n  def f(n):\n    return [1][n]\n  end\n  f(5)\nend", [(6, 3, "job"), (4, 12, "f")]),
            ("温 = 1; 度 = 温 / 0", [(1, 12, "main")]),
            ("print '温', 1L; x = 1 / 0", [(1, 20, "main")]),
            ("x = '\\e' + 5", [(1, 5, "main")]),
            ("print'温'; x = '\\e\\e'; y = 1 / 0", [(1, 27, "main")]),
            ("while True:\n  try:\n    [0 for i in [1] if i / 0]\n  finally:\n    pass", [(3, 24, "main")]),
        ],
    )
    def test_failures_have_the_authors_line_and_column(self, text, expected, capsys):
        found = self.frames(text)
        assert found[-1][:2] == expected[-1][:2]
        assert len(expected) == 1 or found == expected

    def test_places_in_an_unfolded_line(self):
        text = "def f(n): ; if n: ; 1 / 0 ; end ; end ; f(1)"
        assert self.frames(text, kind="line", one_line_blocks=True) == [(1, 41, "main"), (1, 21, "f")]

    def test_columns_count_characters(self):
        source = SourceFile("f", "温度 = x\nabc")
        assert [column_of(source, 1, offset) for offset in (0, 3, 6, 9)] == [1, 2, 3, 6]
        assert column_of(source, 2, 2) == 3
        assert column_of(source, 9, 4) == 5


def _lasti(error, frame):
    found = error.__traceback__
    while found.tb_frame is not frame:
        found = found.tb_next
    return found.tb_lasti


class TestExpressions:
    def value(self, text):
        stage = Stage()
        return eval(compile_expression(SourceFile("e", text)), {"__builtins__": {**vars(builtins), **stage._names()}})

    @pytest.mark.parametrize(
        ("text", "value"),
        [("1 + 2", 3), ("  [i for i in range(3)]\n", [0, 1, 2]), ("(lambda x: x)(4)", 4), ("'{}'.format(5)", "5")],
    )
    def test_they_have_a_value(self, text, value):
        assert self.value(text) == value

    @pytest.mark.parametrize(
        ("text", "code", "column"),
        [
            ("x = 1", "E001", 1),
            ("a; b", "E001", 1),
            ("1 +", "E001", 4),
            ("温度 +", "E001", 5),
            ("x.__globals__", "E115", 3),
            ("__import__('os')", "E115", 1),
            ("", "E001", 1),
            ("(" * 400, "E001", 1),
            ("温.__dict__", "E115", 3),
        ],
    )
    def test_what_is_none_or_not_allowed_is_refused(self, text, code, column):
        with pytest.raises(ProgramError) as caught:
            compile_expression(SourceFile("e", text))
        problem = caught.value.problems[0]
        assert problem.code == code
        assert abs(problem.column - column) <= 1 or len(text) > 100


class TestWarnings:
    @pytest.mark.filterwarnings("error")
    @pytest.mark.parametrize("text", ["x = '\\d'", "x is 1", "assert (x, 'text')", "f = 1 ()", "x = b'\\d'"])
    def test_pythons_own_warnings_stay_silent(self, text, capfd):
        compiled(text)
        assert capfd.readouterr().err == ""


class TestCost:
    @staticmethod
    def program(parts):
        return "def job():\n" + "".join(
            f"  def part_{n}(q, speed=0.25):\n"
            f'    """Part {n}."""\n'
            f"    global count_{n}\n"
            f"    count_{n} = [0.1 * i for i in range(6)]\n"
            f"    for i in range(len(q)):\n"
            f"      if q[i] > {n} and speed != 0.5:  # limit\n"
            f'        textmsg("joint ", i, " of {{}}".format(n))\n'
            f"      else:\n"
            f"        movej([q[0], q[1] + {n}, 0.0, -1.57, 1.57, 0.0], a=1.4, v=speed)\n"
            f"      end\n"
            f"    end\n"
            f"    while get_standard_digital_in({n % 8}) == False:\n"
            f"      sync()\n"
            f"    end\n"
            f"  end\n"
            for n in range(parts)
        )

    @staticmethod
    def calls_of(action):
        """Calls of functions, those written in C included: a measure of work that a busy computer does not change."""
        count = 0

        def note(_frame, event, _argument):
            nonlocal count
            count += event in ("call", "c_call")

        sys.setprofile(note)
        try:
            action()
        finally:
            sys.setprofile(None)
        return count

    def test_the_work_grows_with_the_number_of_lines(self):
        compiled(self.program(33))  # a text that is long makes patterns, once
        once, twice = (self.calls_of(lambda parts=parts: compiled(self.program(parts))) for parts in (33, 66))
        assert once < 300 * self.program(33).count("\n")
        assert 1.9 < twice / once < 2.1

    def test_the_package_starts_without_what_it_does_not_need(self):
        source = str(Path(elitescript.__file__).parent.parent)
        code = (
            "import ast, dataclasses, sys; had = set(sys.modules); import elitescript.language.compiler; "
            "print(' '.join(sorted(set(sys.modules) - had)))"
        )
        result = subprocess.run(
            [sys.executable, "-S", "-c", f"import sys; sys.path.insert(0, {source!r}); {code}"],
            capture_output=True,
            text=True,
            check=True,
        )
        loaded = [name for name in result.stdout.split() if not name.startswith("elitescript")]
        assert set(loaded) <= {
            "__future__",
            "_bisect",
            "_contextvars",
            "_py_warnings",
            "_typing",
            "bisect",
            "gc",
            "typing",
            "typing.io",
            "typing.re",
            "warnings",
        }
        assert "elitescript.language.symbols" not in result.stdout
        assert "elitescript.language.text.units" not in result.stdout


def test_a_text_can_be_analysed_before_it_is_compiled():
    parsed = parse(SourceFile("f", "def job():\n  textmsg(1)\nend"))
    assert parsed.unit.name == "job"
    unit = compile_parsed(parsed)
    assert (unit.name, parsed.name) == ("job", "job")


def test_a_file_of_that_name_on_the_disk_makes_no_difference(tmp_path, monkeypatch):
    """Python looks up the line of a mistake in the file, to count columns in it."""
    monkeypatch.chdir(tmp_path)
    Path("pick.script").write_text("温度温度温度温度\n" * 3, encoding="utf-8")
    for text in ("x = '温'; y = 1 2", "x = '温'; break", "x = '温'; y = 012"):
        (found,) = check_unit(SourceFile("pick.script", text))
        assert found.column in (10, 14, 16)


class TestTasks:
    IDLE = "x = 1\ndef a():\n  pass\ndef b():\n  a()\n"

    def test_a_text_in_which_nothing_runs_says_so(self):
        unit = compile_task(SourceFile("f", self.IDLE))
        assert [(problem.code, problem.line, problem.is_error) for problem in unit.diagnostics] == [("W214", 4, False)]

    def test_a_strict_run_refuses_it(self):
        with pytest.raises(ProgramError) as caught:
            compile_task(SourceFile("f", self.IDLE), Options(strict=True))
        assert [problem.code for problem in caught.value.problems] == ["W214"]

    @pytest.mark.parametrize("text", ["def a():\n  pass\n", "def a():\n  pass\na()\n", "x = 1\n", IDLE + "b()\n"])
    def test_other_texts_say_nothing(self, text):
        assert compile_task(SourceFile("f", text)).diagnostics == ()
