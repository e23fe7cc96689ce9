import re
from pathlib import Path

import pytest

from elitescript.commands.catalogue import CATALOGUE
from elitescript.errors import CODES
from elitescript.lint import rules
from elitescript.lint.explanations import body, explanation, markdown
from tests.lint.checking import problems

LEAST = 80
"""Characters that say something."""


@pytest.mark.parametrize("code", sorted(CODES))
def test_each_code_is_explained_with_an_example(code):
    text = body(code)
    prose, example = text.split("\n    ", 1) if "\n    " in text else (text, "")
    assert len(prose) >= LEAST, f"{code}: write it into lint/explanations.py, or into the docstring of the rule's file"
    assert example.strip(), f"{code}: an example is missing"
    assert CODES[code].title in explanation(code)


def test_commands_in_explanations_exist():
    names = {
        name
        for code in CODES
        if code not in ("E301", "W211")
        for name in re.findall(r"(?<![\w.])((?:set|get|modbus|serial|path|socket)_\w+)\(", body(code))
    }
    assert sorted(name for name in names if CATALOGUE.get(name) is None) == []


def test_markdown_fences_the_example():
    text = markdown("E108")
    assert text.count("```") == 2
    assert "```elite\nglobal count = 0" in text


@pytest.mark.parametrize(
    ("code", "text"),
    [
        ("E106", 'def a():\n  print "x"\nend\n'),
        ("E109", "def a():\n  n = 1\n  global n\nend\n"),
        ("E110", "def a():\n  n = 5L\nend\n"),
        ("W209", "def a():\n  n = xrange(3)\nend\n"),
        ("W201", "def a():\n  n = unknwn\nend\n"),
        ("E301", "def a():\n  unknwn()\nend\n"),
    ],
)
def test_the_severities_in_the_table_are_those_of_the_checker(code, text):
    row = CODES[code]
    (usual,) = {problem.severity for problem in problems(text) if problem.code == code}
    (strict,) = {problem.severity for problem in problems(text, strict=True) if problem.code == code}
    assert (usual, strict) == (row.default_severity, row.strict_severity)


def test_a_rule_that_strictness_makes_an_error_says_so_in_the_table():
    folder = Path(rules.__path__[0])
    for path in folder.glob("*.py"):
        text = path.read_text(encoding="utf-8")
        if "is_strict" in text:
            for code in re.findall(r'code="(\w+)"', text):
                assert CODES[code].strict_severity == "error", f"{code}: set is_tolerated in errors.CODES"


@pytest.mark.parametrize(
    "text",
    [
        "--network 192.168.1.5:502",
        'network="192.168.1.5:502"',
        '@pytest.mark.elitescript(network="192.168.1.5:502")',
        "# elitescript: network=192.168.1.5:502",
        '"network": "192.168.1.5:502"',
        "[robot]",
        'network = "192.168.1.5:502"',
        "Allow connections",
        "--serial",
    ],
)
def test_the_explanation_of_a_refused_connection_names_each_place_of_the_option(text):
    assert text in body("W274")
