"""Texts of findings, alarms and warnings keep their template and values: as they are written, and as they come out."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from elitescript import VirtualRobot
from elitescript.errors import CODES, ProgramError
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.lint.explanations import body
from elitescript.messages.events import Alarm, Warned
from elitescript.messages.profile import profile
from tests.texts import SOURCE, lost, tree_of

MAKERS = {
    "Alarm": (3, "text"),
    "DeviceNoted": (2, "text"),
    "Doubt": (1, "text", 2, "hint"),
    "Finding": (1, 4, "text", 2, 5, "hint"),
    "Fix": (0, "title"),
    "Warned": (1, "text", 5, "hint"),
    "Words": (0, 1),
    "diagnostic": (3, "text", "hint"),
    "found": (1, "text", "hint"),
    "report": (3, 4, "text", "hint"),
    "warn_once": (1, "text", "hint"),
}
"""Which arguments of these calls are texts for people: their places and keywords."""
ERRORS = {
    *("ArgumentCountError", "ArgumentRangeError", "ArgumentTypeError", "ArmNotReadyError", "FirmwareError"),
    *("InvalidValueError", "MirroredAddressError", "MotionError", "NotSimulatedError", "RpcError"),
    *("ScriptPermissionError", "ScriptStateError"),
}

NAMES = {*MAKERS, *ERRORS}
CALLS = re.compile(rf"\b(?:{'|'.join([*MAKERS, *ERRORS, 'said'])})\(")
"""A file without any of these has no text for people."""
WORDS = re.compile(r"[A-Za-z]{2,}.* |.* [a-z]{2,}")


PACKAGES = (
    *("commands", "controller", "devices", "environment", "findings", "kernel", "kinematics", "language", "lint"),
    *("modbus", "motion", "robot.py", "run.py", "runtime", "services", "solids"),
)
"""Where texts for people are made; an audit has findings of its own kind."""


def files() -> list[Path]:
    """Return the files in which texts for people are made."""
    paths = [path for path in sorted(SOURCE.rglob("*.py")) if path.relative_to(SOURCE).parts[0] in PACKAGES]
    return [path for path in paths if CALLS.search(path.read_text(encoding="utf-8"))]


def name_of(call: ast.Call) -> str:
    function = call.func
    return function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")


def texts_of(call: ast.Call) -> Iterator[ast.expr]:
    """Yield the arguments of a call that are texts for people."""
    name = name_of(call)
    places = (0, "text", "hint") if name in ERRORS else MAKERS.get(name, ())
    for place in places:
        if isinstance(place, int) and place < len(call.args):
            yield call.args[place]
        yield from (word.value for word in call.keywords if word.arg == place)


@cache
def calls_by_function(tree: ast.AST) -> list[list[ast.AST]]:
    """Return the calls and assignments of each function, and of the text outside of all."""
    found: list[list[ast.AST]] = [[]]
    left: list[tuple[ast.AST, list[ast.AST]]] = [(tree, found[0])]
    while left:
        node, own = left.pop()
        if isinstance(node, ast.FunctionDef):
            own = []
            found.append(own)
        elif isinstance(node, ast.Call | ast.Assign | ast.AugAssign):
            own.append(node)
        left += [(child, own) for child in ast.iter_child_nodes(node) if not isinstance(child, ast.expr_context)]
    return found


def mistakes(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Yield line and source of each text that loses its template."""
    for own in calls_by_function(tree):
        makers = [node for node in own if isinstance(node, ast.Call) and name_of(node) in NAMES]
        values: dict[str, list[ast.AST]] = {}
        for node in own if makers else ():
            if isinstance(node, ast.Assign):
                for target in node.targets:
                    pairs = [(target, node.value)]
                    if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                        pairs = list(zip(target.elts, node.value.elts, strict=True))
                    for left, right in pairs:
                        if isinstance(left, ast.Name):
                            values.setdefault(left.id, []).append(right)
            elif isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name):
                values.setdefault(node.target.id, []).append(node)
        for maker in makers:
            for text in texts_of(maker):
                for part in {id(part): part for part in sources(text, values)}.values():
                    if loses(part):
                        yield part.lineno, ast.unparse(part)


def sources(node: ast.expr, values: dict[str, list[ast.AST]]) -> Iterator[ast.AST]:
    """Yield what an expression may be: its branches, and what its variable was given."""
    if isinstance(node, ast.IfExp):
        yield from sources(node.body, values)
        yield from sources(node.orelse, values)
    elif isinstance(node, ast.BoolOp):
        for part in node.values:
            yield from sources(part, values)
    elif isinstance(node, ast.Name):
        for given in values.get(node.id, ()):
            if isinstance(given, ast.IfExp):
                yield from sources(given, {})
            else:
                yield given
    else:
        yield node


def loses(node: ast.AST) -> bool:
    """Return whether an expression makes a plain text of words and values."""
    if isinstance(node, ast.AugAssign):
        return isinstance(node.op, ast.Add) and has_words(node.value)
    if isinstance(node, ast.BinOp):
        return isinstance(node.op, ast.Add) and (has_words(node.left) or has_words(node.right))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        return node.func.attr == "format"
    return isinstance(node, ast.JoinedStr) and any(isinstance(part, ast.FormattedValue) for part in node.values)


def has_words(node: ast.AST) -> bool:
    """Return whether there are words in a text that is written in an expression."""
    parts = [part.value for part in ast.walk(node) if isinstance(part, ast.Constant)]
    if isinstance(node, ast.Call) and name_of(node) == "said":
        return True
    return bool(WORDS.search("".join(part for part in parts if isinstance(part, str))))


def test_no_text_for_people_is_an_f_string():
    """Write `said("... {x} ...", x=x)`: see CONTRIBUTING.md, "How a message is written"."""
    found = [f"{path.relative_to(SOURCE)}:{line}: {text}" for path in files() for line, text in mistakes(tree_of(path))]
    assert found == []


@pytest.mark.parametrize(
    ("text", "is_found"),
    [
        ('found("W1", f"{a} is wrong")', True),
        ('found("W1", "a is wrong")', False),
        ('found("W1", said("{a} is wrong", a=a))', False),
        ('found("W1", f"{a}: {b}")', True),
        ('found("W1", text, hint=f"write {a} here")', True),
        ('t = f"{a} is wrong"\nfound("W1", t)', True),
        ('t = said("{a} is wrong", a=a)\nt += f", and {b} too"\nfound("W1", t)', True),
        ('t = said("{a} is wrong", a=a)\nfound("W1", t + said(", and {b}", b=b))', True),
        ('raise MotionError("too far: {}".format(a))', True),
        ('raise MotionError(said("{a} is too far", a=a) if a else f"{b} is too near")', True),
        ('what, t = 1, f"{a} is wrong"\nself._draft.report("E1", 1, 2, t)', True),
        ('print(f"{a} is wrong")', False),
    ],
)
def test_texts_that_lose_their_template_are_found(text, is_found):
    assert bool(list(mistakes(ast.parse(text)))) is is_found


def test_every_hole_has_its_value():
    for path in files():
        for node in (node for own in calls_by_function(tree_of(path)) for node in own):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "said":
                for template in literals(node.args[0]):
                    holes = set(re.findall(r"\{(\w+)", template.replace("{{", "").replace("}}", "")))
                    given = {word.arg for word in node.keywords}
                    assert holes <= given, f"{path}:{node.lineno}"
                    assert isinstance(node.args[0], ast.IfExp) or holes == given, f"{path}:{node.lineno}"


def literals(node: ast.expr) -> list[str]:
    if isinstance(node, ast.IfExp):
        return literals(node.body) + literals(node.orelse)
    return [node.value] if isinstance(node, ast.Constant) and isinstance(node.value, str) else []


def example_of(code: str) -> str:
    """Return the program of the explanation of a code; lines without a `def` stand in one."""
    _, _, example = body(code).partition("\n    ")
    lines = [line[4:] if line.startswith("    ") else line for line in ("    " + example).splitlines()]
    text = "\n".join(line for line in lines if "\u2026" not in line) + "\n"
    if re.search(r"^(def|sec) ", text, re.MULTILINE):
        return text
    return "def job():\n" + "".join(f"  {line}\n" for line in text.splitlines()) + "end\n"


RUN = {f"R{number}" for number in (*range(101, 120), 122, 123, 133, 134)} | {"W235", "W250", "W260", "W271", "N223"}
"""Codes whose examples are run: others show what needs a device, or do not end."""


@pytest.mark.parametrize("code", sorted(CODES))
def test_what_examples_find_keeps_its_template(code):
    """The example of each code: what `check` finds in it, and what its run says."""
    text = example_of(code)
    plain = []
    for problem in check_source(SourceFile("job", text), profile("2.14")):
        plain += lost(problem.text) + lost(problem.hint)
        plain += lost(problem.fix.title) if problem.fix is not None else []
    if code in RUN:
        try:
            run = VirtualRobot().run(text, until_s=2.0)
        except ProgramError:
            assert plain == []
            return
        for event in run.events:
            if isinstance(event, Warned):
                plain += lost(event.text) + lost(event.hint)
            elif isinstance(event, Alarm):
                plain += lost(event.text) + lost(event.details.get("hint", ""))
    assert plain == []
