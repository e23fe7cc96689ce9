"""Random texts and random programs.

Whatever the text, the only failure is `ProgramError`, and every place lies inside the text.
Whatever the program, checkpoints change nothing but the time it takes.
"""

from __future__ import annotations

import builtins
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elitescript.errors import ProgramError
from elitescript.language.compiler import check_unit, compile_unit
from elitescript.language.diagnostics import render
from elitescript.language.options import KINDS, Options
from elitescript.language.parser import parse
from elitescript.language.symbols import Resolution, Symbols
from elitescript.language.text.dialect import translate
from elitescript.language.text.source import SourceFile, apply_fixes
from tests.language.random_programs import random_program
from tests.language.stage import Stage

PROGRAMS = [
    """def job(v=1.0):
  global count
  count = 0
  while count < 3:
    $ LINE: (2, "步骤")
    count += 1
    if count == 2:
      textmsg(f"n={count:>{4}} {'x'}")
    elif count > 2: break
    else:
      pass
    end
  end
end
""",
    """global level
level = 7
def mix(u, *w, k=1, **d):
\tlevel = u * 2
\treturn [x for x in w if x]
end
mix(1, 2);
""",
    """sec go():
  try:
    socket_open('1.2.3.4', 5, "s")
  except (A, B) as e:
    raise
  finally:
    x = '''a
end
'''
  end
end""",
    r"""class Box(Base):
  __slots__ = ('v',)
  def __init__(self, v):
    super().__init__()
    self.__v = v

print 'a', b,
x = 12L + 0x1fl
y = "\e[1m\o12\d"
speed = 1
global speed
""",
    "def f(n): ; textmsg('f', n) ; if n > 1: ; textmsg('big') ; end ; end;",
    """match q:
  case [1, *r] if r: pass
  case {'k': v, **w}: pass
  case int() | Point(x=0): pass
with a as b, c:
  back = lambda t: (t, -t)
""",
]
_WORDS = r"""
end def sec if else: try: except: finally: class while for in with lambda yield async await match case
return break continue import from nonlocal global del raise print exec thread run kill join local xor
( ) [ ] { } " ' \ : ; , = == <> && || ! ? ++ -- ` $ # @ * ** ... -> :=
.format __x__ 12L 012 0x 1e999 f'{ }' \e \o7 温 ÿ
"""
WORDS = _WORDS.split()
SENTENCES = [
    "if x:",
    "except E, e:",
    "global x = 1",
    "$ LINE: (1, 'x')",
    "thread t():",
    "run f()",
    "a xor b",
    "raise E, 'x'",
]
BLANKS = [
    "\n",
    "\n  ",
    "\n    ",
    "\n\t",
    "\r\n",
    "\r",
    " ",
    "\x0c",
    "\u2028",
    "\u00a0",
    "\x00",
    "\ud800",
    "\ufeff",
    "\uff0c",
]
PIECES = [*WORDS, *SENTENCES, *BLANKS, *BLANKS, "'''", '"""', "9" * 40]


def mutated(text, rng):
    for _ in range(rng.randrange(1, 6)):
        at = rng.randrange(len(text) + 1)
        choice = rng.randrange(4)
        if choice == 0:
            text = text[:at] + rng.choice(PIECES) + text[at:]
        elif choice == 1:
            text = text[:at] + text[at + rng.randrange(1, 8) :]
        elif choice == 2:
            text = text[:at] + rng.choice(PIECES) + text[at + rng.randrange(1, 12) :]
        else:
            lines = text.split("\n")
            row = rng.randrange(len(lines))
            lines.insert(rng.randrange(len(lines)), lines[row] if rng.random() < 0.5 else lines.pop(row))
            text = "\n".join(lines)
    return text


def check(text, options):
    source = SourceFile("f.script", text)
    translation = translate(parse(source, options).source, options)
    if not options.one_line_blocks:
        assert translation.text.count("\n") == source.text.count("\n")
    problems = check_unit(source, options)
    for problem in problems:
        for line, column in ((problem.line, problem.column), (problem.end_line, problem.end_column)):
            assert 1 <= line <= len(source.lines), problem
            assert 1 <= column <= len(source.line(line)) + 2, problem
        assert (problem.line, problem.column) <= (problem.end_line, problem.end_column)
        assert problem.text
        assert render(problem, source.where(problem.line, problem.column), source.line(problem.line))
        if problem.fix:
            apply_fixes(source.text, [problem.fix])
    assert [(problem.line, problem.column) for problem in problems] == sorted(
        (problem.line, problem.column) for problem in problems
    )
    try:
        unit = compile_unit(source, options)
    except ProgramError as error:
        assert error.problems == problems
        assert any(problem.is_error for problem in problems)
    else:
        assert unit.diagnostics == problems
        assert not any(problem.is_error for problem in problems)


OPTIONS = [
    Options(),
    Options(strict=True),
    *(Options(kind=kind) for kind in KINDS),
    Options(kind="line", one_line_blocks=True),
]


@settings(max_examples=250)
@given(st.integers(0, 2**32))
def test_mutated_programs_fail_with_program_errors_alone(seed):
    rng = random.Random(seed)
    check(mutated(rng.choice(PROGRAMS), rng), rng.choice(OPTIONS))


@settings(max_examples=150)
@given(st.text(max_size=80), st.sampled_from(OPTIONS))
def test_any_text_at_all(text, options):
    check(text, options)


@settings(max_examples=150)
@given(st.lists(st.sampled_from(PIECES), max_size=30), st.sampled_from(OPTIONS))
def test_texts_made_of_mistakes(pieces, options):
    check("".join(pieces), options)


@pytest.mark.parametrize(
    "text",
    ["end\n" * 20_000, "if x:\n" * 20_000 + "end\n" * 20_000, "x.__dict__\n" * 20_000, "x = '\\d'\n" * 20_000],
    ids=["closers", "headers", "names", "escapes"],
)
def test_the_number_of_findings_is_bounded(text):
    assert 100 < len(check_unit(SourceFile("f", text))) < 1000


@pytest.mark.parametrize("text", [*PROGRAMS[:4], PROGRAMS[5]])
def test_the_programs_that_are_mutated_are_good(text):
    assert not [problem for problem in check_unit(SourceFile("f", text)) if problem.is_error]


@settings(max_examples=100)
@given(st.integers(0, 2**32))
def test_symbols_can_be_read_of_any_text(seed):
    rng = random.Random(seed)
    symbols = Symbols(parse(SourceFile("f", mutated(rng.choice(PROGRAMS), rng))))
    for scope in symbols.scopes:
        for name in (*scope.reads, *scope.bindings):
            assert scope.resolve(name) is not Resolution.BUILTIN or not scope.has_local(name)
    assert symbols.scopes[0] is symbols.body


@settings(max_examples=150)
@given(st.integers(0, 2**32))
def test_checkpoints_change_no_result(seed):
    text = random_program(random.Random(seed))
    stage = Stage()
    try:
        stage.run(text)
        ours = (stage.out, None)
    except Exception as error:
        ours = (stage.out, type(error))
    out = []
    namespace = {"__builtins__": {**vars(builtins), "textmsg": lambda *parts: out.append("".join(map(str, parts)))}}
    plain = translate(SourceFile("f", text)).text
    exec(compile(plain, "f", "exec"), namespace)
    try:
        namespace["job"]()
        theirs = (out, None)
    except Exception as error:
        theirs = (out, type(error))
    assert ours == theirs
