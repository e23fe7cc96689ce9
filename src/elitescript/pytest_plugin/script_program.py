"""Makes the program of one test in the language: what its file defines, mocks in the place of commands, and the call.

`assert` gets a message that shows the values of its condition, as pytest's own does.
"""

from __future__ import annotations

import ast
from typing import Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.errors import UsageError, did_you_mean
from elitescript.language.parser import Parsed

PREFIX: Final = "test_"
"""Begin of the names of functions that are tests."""
MOCK: Final = "mock_"
"""Begin of the names of functions that take the place of a command."""
RETURNED: Final = "_test_has_returned"
"""Program global that exists when the test has returned."""

_LEFT: Final = "@left"
_RIGHT: Final = "@right"
_LOAD: Final = ast.Load()


def tests_of(parsed: Parsed) -> list[ast.FunctionDef]:
    """Return the functions of a file that are tests, in their order."""
    return [node for node in parsed.body if isinstance(node, ast.FunctionDef) and node.name.startswith(PREFIX)]


def why_not_called(function: ast.FunctionDef) -> str:
    """Return why a function cannot be a test; empty if it can."""
    args = function.args
    missing = len(args.posonlyargs) + len(args.args) > len(args.defaults) or None in args.kw_defaults
    return f"{function.name} has parameters without a default; a test is called without arguments" if missing else ""


def make_test(parsed: Parsed, name: str) -> None:
    """Make of a file that was read the program of one of its tests.

    The statements of the file run first, then the function is called. A function `mock_NAME` takes the place of the
    command NAME from its definition on.

    Args:
        parsed: the file; its tree is changed.
        name: of the test.

    Raises:
        UsageError: a mock of something that is no command.
    """
    for node in ast.walk(parsed.tree):
        if isinstance(node, ast.Assert):
            _explain(node)
    body = parsed.body
    mocked = []
    statements: list[ast.stmt] = []
    for statement in body:
        statements.append(statement)
        if isinstance(statement, ast.FunctionDef) and statement.name.startswith(MOCK):
            command = statement.name.removeprefix(MOCK)
            if CATALOGUE.get(command) is None:
                near = did_you_mean(command, CATALOGUE.names())
                raise UsageError(f"line {statement.lineno}: {statement.name} is the mock of no command{near}")
            mocked.append(command)
            statements.append(_added(_assign(command, ast.Name(statement.name, _LOAD))))
    call = ast.Expr(ast.Call(ast.Name(name, _LOAD), [], []))
    declared = ast.Global([*dict.fromkeys(mocked), RETURNED])
    body[:] = [_added(declared), *statements, _added(call), _added(_assign(RETURNED, ast.Constant(True)))]


def _assign(name: str, value: ast.expr) -> ast.Assign:
    return ast.Assign([ast.Name(name, ast.Store())], value)


def _added(statement: ast.stmt) -> ast.stmt:
    """Put a statement that is not of the text into line 0, where nothing counts it."""
    for node in ast.walk(statement):
        node.lineno = node.end_lineno = node.col_offset = node.end_col_offset = 0  # type: ignore[attr-defined]
    return statement


def _explain(node: ast.Assert) -> None:
    """Give an `assert` a message with the values of its condition."""
    condition = node.test
    if isinstance(condition, ast.Compare) and len(condition.ops) == 1:
        operator = f" {_OPERATORS[type(condition.ops[0])]} "
        left = _captured(condition.left, _LEFT)
        right = _captured(condition.comparators[0], _RIGHT)
        condition.left, condition.comparators = left, [right]
        parts: list[ast.expr] = [ast.Constant("assert "), _shown(_LEFT), ast.Constant(operator), _shown(_RIGHT)]
    elif isinstance(condition, ast.UnaryOp) and isinstance(condition.op, ast.Not):
        condition.operand = _captured(condition.operand, _LEFT)
        parts = [ast.Constant("assert not "), _shown(_LEFT)]
    else:
        node.test = _captured(condition, _LEFT)
        parts = [ast.Constant("assert "), _shown(_LEFT)]
    if node.msg is not None:
        given = ast.FormattedValue(node.msg, ord("s"), None)
        parts = [given, ast.Constant("\n"), *parts]
    node.msg = ast.copy_location(ast.JoinedStr(parts), node)
    ast.fix_missing_locations(node)


def _captured(value: ast.expr, name: str) -> ast.NamedExpr:
    return ast.copy_location(ast.NamedExpr(ast.Name(name, ast.Store()), value), value)


def _shown(name: str) -> ast.FormattedValue:
    return ast.FormattedValue(ast.Name(name, _LOAD), ord("r"), None)


_OPERATORS: Final[dict[type[ast.cmpop], str]] = {
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Is: "is",
    ast.IsNot: "is not",
    ast.In: "in",
    ast.NotIn: "not in",
}
