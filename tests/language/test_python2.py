from __future__ import annotations

import pytest

from elitescript.language.diagnostics import Severity
from elitescript.language.text.source import apply_fixes
from tests.language.marked import check_marks, codes, unmarked
from tests.language.stage import output

PRINTS = [
    ("«print» x", "print(x)"),
    ("«print» 'a'", "print('a')"),
    ("«print»'a'", "print('a')"),
    ("«print»   'a', x", "print('a', x)"),
    ("«print» x,", 'print(x, end=" ")'),
    ("«print»", "print()"),
    ("«print» ; x = 1", "print() ; x = 1"),
    ("«print» 'a %d' % x  # note", "print('a %d' % x)  # note"),
    ("if x: «print» x; y = 1", "if x: print(x); y = 1"),
    ("«print» -x", "print(-x)"),
    ("«print» .5", "print(.5)"),
    ("«print» not x", "print(not x)"),
    ("«print» [x]", "print([x])"),
    ("«print» {1: 2}", "print({1: 2})"),
    ("«print» x, \\\n  y", "print(x, \\\n  y)"),
    ("«print» '온도', x", "print('온도', x)"),
    ("«print» f'{x}'", "print(f'{x}')"),
    ("«print» 'a'; «print» 'b'", "print('a'); print('b')"),
]
NOT_PRINTS = [
    "print(x)",
    "print (x)",
    "print = 3",
    "print = [x]",
    "y = print",
    "print[0] = 1",
    "print [0] = 1",
    "print.x = 1",
    "print - x",
    "print in x",
    "print not in x",
    "print if x else y",
    "print, x",
    "print == x",
    "print('a'); x",
    "printer = 1",
    "x = 'print y'",
    "# print y",
    "print is None",
]


@pytest.mark.parametrize(("text", "repaired"), PRINTS)
def test_the_print_statement_is_accepted_with_a_warning(text, repaired):
    found = check_marks("E106", text)
    assert {problem.severity for problem in found} == {Severity.WARNING}
    text, _ = unmarked(text)
    for problem in reversed(found):
        text = apply_fixes(text, [problem.fix])
    assert text == repaired


@pytest.mark.parametrize(("text", "repaired"), PRINTS)
def test_strict_refuses_the_print_statement(text, repaired):
    found = check_marks("E106", text, strict=True)
    assert {problem.severity for problem in found} == {Severity.ERROR}
    assert codes(repaired, strict=True) == []


@pytest.mark.parametrize("text", NOT_PRINTS)
def test_other_uses_of_the_name_print(text):
    assert codes(text) == []


def test_print_statements_print(capsys):
    output("x = 3\nprint 'a', x,\nprint x\nprint\nprint'e'")
    assert capsys.readouterr().out == "a 3 3\n\ne\n"


@pytest.mark.parametrize(
    "text",
    [
        "x = «12L»",
        "x = «0xFFl» + «0L»",
        "f(«1L»,«2L»)",
        "x = «86400000000L».bit_length()",
        "x = [«1L»]",
        "x = «0o17L»",
        "x = «1_000L»",
    ],
)
def test_the_long_suffix_is_accepted_with_a_warning(text):
    found = check_marks("E110", text)
    assert {problem.severity for problem in found} == {Severity.WARNING}
    assert {problem.severity for problem in check_marks("E110", text, strict=True)} == {Severity.ERROR}
    text, _ = unmarked(text)
    for problem in reversed(found):
        text = apply_fixes(text, [problem.fix])
    assert codes(text, strict=True) == []


@pytest.mark.parametrize("text", ["x = 12", "x1L = 3", "x = '12L'", "# 12L", "x = a.b1L", "L = 1", "x = 0b1"])
def test_numbers_without_the_suffix(text):
    assert codes(text) == []


def test_long_numbers_have_their_value():
    assert output("textmsg(12L + 0x1fL)") == ["43"]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        (r'"«\e»"', "\x1b"),
        (r'"«\e»[1m"', "\x1b[1m"),
        (r'"«\o12»"', "\n"),
        (r'"«\o7»x"', "\x07x"),
        (r'"«\o12»3"', "\n3"),
        (r"'a«\e»' 'b«\e»'", "a\x1bb\x1b"),
        (r'f"{1}«\e»"', "1\x1b"),
        ('"""x\n«\\e»"""', "x\n\x1b"),
        (r'"\\«\e»"', "\\\x1b"),
        (r'u"«\e»"', "\x1b"),
    ],
)
def test_escapes_of_the_manual_are_accepted_with_a_warning(text, value):
    found = check_marks("W210", f"x = {text}")
    assert {problem.severity for problem in found} == {Severity.WARNING}
    assert {problem.severity for problem in check_marks("W210", f"x = {text}", strict=True)} == {Severity.ERROR}
    plain, _ = unmarked(text)
    assert output(f"textmsg({plain})") == [value]
    fixed = f"x = {plain}"
    for problem in reversed(found):
        fixed = apply_fixes(fixed, [problem.fix])
    assert codes(fixed, strict=True) == []
    assert output(f"{fixed}\ntextmsg(x)") == [value]


@pytest.mark.parametrize("text", [r'"«\d»+"', r'"«\o»"', r'"«\o»9"', r'"«\ »"', r'b"«\u»1234"'])
def test_other_unknown_escapes_keep_their_backslash_and_are_only_a_warning(text):
    for strict in (False, True):
        found = check_marks("W210", f"x = {text}", strict=strict)
        assert {problem.severity for problem in found} == {Severity.WARNING}
    plain, _ = unmarked(text)
    assert output(f"textmsg({plain}.find({'b' if plain[0] == 'b' else ''}'\\\\'))") == ["0"]


@pytest.mark.parametrize(
    "text",
    [
        r'r"\e"',
        r'R"\o12"',
        r'rb"\d"',
        r'"\\e"',
        r'"\n\t\x41\101\u00e9\N{DIGIT ONE}\'"',
        '"a\\\nb"',
        r'fr"\d{1}"',
        r"# \e",
    ],
)
def test_known_escapes_and_raw_strings(text):
    assert codes(f"x = {text}" if text[0] != "#" else text) == []


@pytest.mark.parametrize(
    ("text", "repaired"),
    [
        ("if 1 «<>» 2: f()", "if 1 != 2: f()"),
        ("x = a«<>»b", "x = a!=b"),
        ("x = «`y`» + 1", "x = repr(y) + 1"),
    ],
)
def test_operators_of_python_2(text, repaired):
    (found,) = check_marks("E111", text)
    assert apply_fixes(unmarked(text)[0], [found.fix]) == repaired
    assert codes(repaired) == []


def test_a_lone_backquote():
    check_marks("E111", "x = «`»y\nz = 1")


def test_strings_may_hold_what_code_may_not():
    assert codes("x = '<> ` && || ! ? ++ xor $ 012 12L'  # <> ` && ! ? $ 012") == []


@pytest.mark.parametrize(
    ("text", "repaired"),
    [
        ("try:\n  f()\n«except E, e»:\n  g()", "try:\n  f()\nexcept E as e:\n  g()"),
        ("try:\n  f()\n«except E,e»: g()", "try:\n  f()\nexcept E as e: g()"),
        ("try:\n  f()\n«except (A, B), e»:\n  g()", "try:\n  f()\nexcept (A, B) as e:\n  g()"),
        ("try:\n  f()\n«except A, B, C»:\n  g()", None),
        ("«raise E, 'x'»", "raise E('x')"),
        ("if x: «raise E, 'a' % b»; y", "if x: raise E('a' % b); y"),
        ("«raise E, 'x', t»", None),
        ("«exec 's'»", None),
        ("«exec code»", None),
    ],
)
def test_statements_of_python_2(text, repaired):
    (found,) = check_marks("E112", text)
    assert (found.fix is None) == (repaired is None)
    if found.fix:
        assert apply_fixes(unmarked(text)[0], [found.fix]) == repaired
        assert codes(repaired) == []


def test_exec_is_said_to_be_a_function():
    (found,) = check_marks("E112", "«exec 's'»")
    assert found.hint == "it is a function: write exec(text), with brackets"


@pytest.mark.parametrize(
    "text",
    [
        "try:\n  f()\nexcept (A, B):\n  g()",
        "raise E('a', 'b')",
        "raise f(a, b) from c",
        "exec = 1",
        "exec(x)",
        "exec in x",
    ],
)
def test_statements_that_only_resemble_python_2(text):
    assert codes(text) == []


@pytest.mark.parametrize(
    ("text", "fixed"),
    [("x = «012»", "x = 0o12"), ("f(«0777», 1)", "f(0o777, 1)"), ("x = «089»", None), ("x = «012L»", "x = 0o12")],
)
def test_numbers_that_begin_with_zero(text, fixed):
    (found,) = check_marks("E001", text)
    assert (apply_fixes(unmarked(text)[0], [found.fix]) if found.fix else None) == fixed


@pytest.mark.parametrize(
    "text",
    [
        "x = 0",
        "x = 000",
        "x = 0.12",
        "x = 012.5",
        "x = 01e5",
        "x = 1e-08",
        "x = 1.5E+03 - 2.e-01",
        "x = 0o12",
        "x = 0x012",
        "a012 = 1",
        "x = 10",
    ],
)
def test_numbers_that_may_begin_with_zero(text):
    assert codes(text) == []


def test_a_mistake_leaves_the_rest_of_the_text_readable():
    text = "def a():\n  raise E, [1,\n    2]\n  x = 1 <> 2\n  exec 's'; y = `z`\n  w = 012\nend"
    assert codes(text) == ["E112 2", "E111 4", "E112 5", "E001 6"]
