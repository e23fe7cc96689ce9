import pytest

from elitescript.runtime.plain_words import Scene, plain_words, without_insides
from tests.runtime.machine import run


def said(*lines):
    """Text and hint of the alarm that a program of these lines ends with."""
    body = "\n".join(f"  {line}" for line in lines)
    (alarm,) = run(f"def job():\n{body}\nend\n").alarms
    return alarm.text, alarm.details.get("hint", "")


@pytest.mark.parametrize(
    ("lines", "text"),
    [
        (["x = 1 / 0"], "division by zero: the divisor is 0"),
        (["n = 0.0", "x = 1 / n"], "division by zero: `n` is 0.0"),
        (["a = 2", "b = 2", "x = 7 % (a - b)"], "division by zero: `a - b` is 0 (a = 2, b = 2)"),
        (["n = 3", "n //= 0"], "division by zero: the divisor is 0"),
        (["x = 'part ' + 3"], "`+` does not work between a str and an int: `'part '` and `3`"),
        (["n = 4", "x = n + ' parts'"], "`+` does not work between an int and a str: `n` (4) and `' parts'`"),
        (["p = [1, 2]", "x = p + 0.5"], "`+` does not work between a list and a float: `p` ([1, 2]) and `0.5`"),
        (["p = [1, 2]", "x = p * 0.5"], "`*` does not work between a list and a float: `p` ([1, 2]) and `0.5`"),
        (["x = [1] - [2]"], "`-` does not work between a list and a list: `[1]` and `[2]`"),
        (["x = None", "y = x + 1"], "`+` does not work between None and an int: `x` (None) and `1`"),
        (["x = 3 < 'a'"], "`<` does not work between an int and a str: `3` and `'a'`"),
        (["x = -'a'"], "`-` does not work with a str: `'a'`"),
        (["x = 'a' in 5"], "`in` cannot look into an int: `5`"),
        (["n = 5", "n()"], "`n` is an int (5), which cannot be called"),
        (["n = 5", "x = n[0]"], "`n` is an int (5), which has no elements"),
        (["n = 5", "x = len(n)"], "an int has no length: `n` (5)"),
        (["n = 5", "for i in n:", "  pass"], "`n` is an int (5), which has no elements to go through"),
        (["p = [1, 2, 3]", "x = p[3]"], "index 3 is out of range: `p` has 3 elements"),
        (["p = [1]", "i = 4", "p[i] = 0"], "index 4 is out of range: `p` has 1 element"),
        (["p = []", "x = p[0]"], "index 0 is out of range: `p` is empty"),
        (["x = [].pop()"], "pop() takes an element from an empty list"),
        (["p = [1]", "x = p['a']"], "the index of a list must be an int, not a str: `'a'`"),
        (["d = {'left': 1}", "x = d['lef']"], "`d` has no key 'lef'"),
        (["t = (1, 2)", "t[0] = 3"], "elements of a tuple cannot be changed: `t`"),
        (["p = [1, 2, 3]", "a, b = p"], "`p` has 3 elements for 2 names"),
        (["p = [1]", "a, b = p"], "`p` has 1 element for 2 names"),
        (["n = 5", "a, b = n"], "`n` is an int (5), which has no elements for these names"),
        (["p = [1]", "p.push(2)"], "a list has no `push`"),
        (["x = None", "x.append(2)"], "`x` is None, which has no `append`"),
        (["def f():", "  n = n + 1", "f()"], "the variable `n` has no value yet here"),
        (["x = int('1.5')"], "the text '1.5' is not an int"),
        (["x = float('q')"], "the text 'q' is not a number"),
        (["x = float(None)"], "float() cannot make a number of None"),
        (["import math", "x = math.sqrt(-4)"], "math.sqrt() has no result for `-4`"),
        (["x = 1.0e300 ** 2"], "the result is too large for a float"),
        (["n = 1", "assert n > 2"], "the condition of `assert` is not true: `n > 2`"),
    ],
)
def test_a_mistake_is_told_in_plain_words_with_its_values(lines, text):
    assert said(*lines)[0] == text


@pytest.mark.parametrize(
    ("call", "text"),
    [
        ("f()", "f() was called without its argument `a`"),
        ("f(1, 2, 3)", "f() takes 1 to 2 arguments, got 3"),
        ("f(1, c=2)", "f() has no parameter `c`"),
        ("f(1, a=2)", "f() gets its argument `a` twice"),
    ],
)
def test_a_call_with_wrong_arguments_says_how_the_function_is_defined(call, text):
    assert said("def f(a, b=2):", "  return a", call) == (text, "it is defined in line 2 as f(a, b=2)")


def test_a_method_does_not_count_the_object_itself():
    assert said("class A:", "  def f(self, x):", "    return x", "A().f(1, 2)")[0] == "A.f() takes 1 argument, got 2"


@pytest.mark.parametrize(
    ("lines", "hint"),
    [
        (["x = 'n = ' + 3"], "join them with str_cat(a, b), or make a text of the value with to_str(x)"),
        (["p = [1, 2]", "x = p[5]"], "indices go from 0 to 1, or from -2 to -1 counted from the end"),
        (["d = {'left': 1}", "x = d['lef']"], "is 'left' meant?"),
        (["d = {'a': 1}", "x = d['z']"], "it has 'a'"),
        (["p = [1]", "p.push(2)"], "append(x) adds an element at the end"),
        (["p = [1]", "p.appendd(2)"], "is `append` meant?"),
        (["x = int('1.5')"], "int(float(x)) takes a text with a decimal point"),
    ],
)
def test_the_hint_says_what_to_do(lines, hint):
    assert said(*lines)[1] == hint


@pytest.mark.parametrize("raised", ["KeyError('own')", "TypeError('own text')", "ValueError('own text')"])
def test_what_a_program_raises_itself_keeps_its_text(raised):
    assert said(f"raise {raised}")[0] in ("'own'", "own text")


def test_a_program_that_catches_it_sees_pythons_text():
    assert said("try:", "  x = 1 / 0", "except ZeroDivisionError as e:", "  raise ValueError(str(e))")[0] == (
        "division by zero"
    )


def test_no_code_of_the_program_runs_to_make_a_message():
    lines = [
        "class Odd:",
        "  def __repr__(self):",
        "    textmsg('run')",
        "    return 'odd'",
        "odd = Odd()",
        "x = odd + 1",
    ]
    body = "\n".join(f"  {line}" for line in lines)
    bench = run(f"def job():\n{body}\nend\n")
    assert bench.alarms[0].text == "`+` does not work between an object of class Odd and an int: `odd` and `1`"
    assert bench.log == []


@pytest.mark.parametrize(
    ("text", "clean"),
    [
        ("main.<locals>.f() is odd", "f() is odd"),
        ("job.<locals>.f.<locals>.g() is odd", "g() is odd"),
        ("expected str instance, NoneType found", "expected str instance, None found"),
        ("'NoneType' object is odd", "None is odd"),
        ("plain", "plain"),
    ],
)
def test_names_that_only_python_uses_are_left_out(text, clean):
    assert without_insides(text) == clean


def test_messages_of_newer_pythons_are_known():
    scene = Scene("", "a, b = p", {"p": [1, 2, 3]})
    assert plain_words("ValueError", "too many values to unpack (expected 2, got 3)", scene).text == (
        "`p` has 3 elements for 2 names"
    )
    assert plain_words(
        "TypeError", "argument of type 'int' is not a container or iterable", Scene("", "", {})
    ).text == ("`in` cannot look into an int")


def test_a_class_that_is_called_wrongly_is_named_as_it_is_written():
    lines = ["class Part:", "  def __init__(self, mass):", "    self.mass = mass", "Part()"]
    assert said(*lines)[0] == "Part() was called without its argument `mass`"
