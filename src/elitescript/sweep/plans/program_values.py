"""Values of a program that are varied: the constant that a name gets first, or one element of it."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any, Final

from elitescript.errors import UsageError, did_you_mean
from elitescript.language.parser import Parsed, parse
from elitescript.language.text.lexer import MARKS
from elitescript.language.text.source import SourceFile
from elitescript.sweep.plans.trees import INSTALLATION, PREFIXES, TASK, name_in_script

MARK: Final = "@"
"""Before a name: the preset that stands in the place of a constant. The variable monitor leaves out such names."""

_NAME: Final = re.compile(rf"([\w{MARKS}]+)((?:\[\d+\])*)")


def put_presets(parsed: Parsed, names: Sequence[str]) -> dict[str, str]:
    """Let a program take values from presets instead of the constants that it has for them.

    A name that the program gives a constant in a statement of its own, not within a loop, condition or function, gets
    its value there: that of the first such statement. A name that it only reads, or declares `global` without ever
    assigning to it, is a preset as of `--set`.

    Args:
        parsed: the program; its tree is changed.
        names: what is varied: `speed`, or an element of a list: `FEEDER[2]`; of a graphical program also `task.speed`
            and `installation.speed`.

    Returns:
        The name of the preset for each.

    Raises:
        UsageError: the program has no such name, or computes its value.
    """
    found: dict[str, str] = {}
    for text in names:
        match = _NAME.fullmatch(name_in_script(text, parsed.source) if text.startswith(PREFIXES) else text)
        if match is None or not match[1].isidentifier():
            raise UsageError(f"--vary {text}: it is neither a signal, nor a name of the program, nor a world setting")
        found[text] = _preset(parsed, text, match[1], [int(index) for index in re.findall(r"\d+", match[2])])
    return found


def constants(parsed: Parsed) -> list[str]:
    """Return the names that a program gives a constant, in the order of the text: those that can be varied."""
    return list(dict.fromkeys(name for name, statement in _assignments(parsed) if _is_constant(statement.value)))


def constant_lines(program: str, names: Sequence[str]) -> dict[str, int]:
    """Return the line in which a program gives each of these names a constant; others are left out.

    Args:
        program: its text.
        names: as they are varied, with or without an index.
    """
    lines: dict[str, int] = {}
    for name, statement in _assignments(parse(SourceFile("", program))):
        lines.setdefault(name, statement.lineno)
    return {text: lines[text.partition("[")[0]] for text in names if text.partition("[")[0] in lines}


def _preset(parsed: Parsed, text: str, name: str, indices: list[int]) -> str:
    statement = next((row for assigned, row in _assignments(parsed) if assigned == name), None)
    if statement is None or (text.startswith(TASK) and _reads(statement.value, name)):
        return _preset_of_unassigned(parsed, text, name, has_index=bool(indices))
    words = partial(_words, parsed)
    holder: ast.AST = statement
    field: str | int = "value"
    for index in indices:
        value = _child(holder, field)
        if not isinstance(value, ast.List | ast.Tuple):
            raise UsageError(f"--vary {text}: {words(statement)} gives {name} no list that is written out")
        if index >= len(value.elts):
            count = len(value.elts)
            raise UsageError(f"--vary {text}: in {words(statement)} {name} has {count} elements, from 0 on")
        holder, field = value, index
    old = _child(holder, field)
    if not _is_constant(old):
        raise UsageError(
            f"--vary {text}: {words(statement)} computes the value of {name}; vary what it is computed from"
            f"{_shown_names(parsed)}"
        )
    new = ast.copy_location(ast.Name(MARK + text, ast.Load()), old)
    if isinstance(field, int):
        assert isinstance(holder, ast.List | ast.Tuple)
        holder.elts[field] = new
    else:
        assert isinstance(holder, ast.Assign)
        holder.value = new
    return MARK + text


def _preset_of_unassigned(parsed: Parsed, text: str, name: str, *, has_index: bool) -> str:
    nodes = list(ast.walk(parsed.tree))
    stores = [node for node in nodes if isinstance(node, ast.Name) and node.id == name and _is_stored(node)]
    reads = [node.lineno for node in nodes if isinstance(node, ast.Name) and node.id == name and not _is_stored(node)]
    first = min(stores, key=lambda node: node.lineno, default=None)
    # A variable of a tree may be read, or counted on, before a node has given it a value.
    is_given_before = text.startswith(TASK) and not has_index and bool(reads)
    if first is not None and not (is_given_before and min(reads) <= first.lineno):
        raise UsageError(
            f"--vary {text}: {_words(parsed, first)} assigns to {name} within a loop, a condition or a function; "
            f"give it a constant before{_shown_names(parsed)}"
        )
    is_read = bool(reads)
    is_read = is_read or any(isinstance(node, ast.Global) and name in node.names for node in nodes)
    if not is_read:
        names = constants(parsed)
        near = did_you_mean(name, names)
        raise UsageError(f"--vary {text}: the program has no such name{near}{_shown_names(parsed)}")
    if has_index:
        raise UsageError(f"--vary {text}: the program gives {name} no value of which an element could be varied")
    return name


def _reads(node: ast.expr, name: str) -> bool:
    return any(isinstance(part, ast.Name) and part.id == name for part in ast.walk(node))


def _words(parsed: Parsed, node: ast.stmt | ast.Name) -> str:
    return parsed.source.line_words(node.lineno)


def _is_stored(node: ast.Name) -> bool:
    return isinstance(node.ctx, ast.Store)


def _shown_names(parsed: Parsed) -> str:
    names = constants(parsed)
    if (tree := parsed.source.tree) is not None:
        given = {known: f"{INSTALLATION}{shown}" for shown, known in tree.installation}
        given |= {known: f"{TASK}{shown}" for shown, known in tree.task if known not in given}
        names = [given[name] for name in names if name in given]
    if not names:
        return "; it has no constants that could be varied"
    return f"; it has {', '.join(names[:_SHOWN])}{', ...' if len(names) > _SHOWN else ''}"


_SHOWN: Final = 12


def _assignments(parsed: Parsed) -> Iterator[tuple[str, ast.Assign]]:
    """Yield the statements of a program that assign to one name and run once, in the order of the text.

    Those of a main task that begins anew for ever count too.
    """
    body = parsed.body
    if parsed.source.tree is not None and body and isinstance(body[-1], ast.While):
        body = [*body, *body[-1].body]
    for statement in body:
        if isinstance(statement, ast.Assign) and len(statement.targets) == 1:
            target = statement.targets[0]
            if isinstance(target, ast.Name):
                yield target.id, statement


def _child(holder: ast.AST, field: str | int) -> Any:
    return holder.elts[field] if isinstance(field, int) else getattr(holder, field)  # type: ignore[attr-defined]


def _is_constant(node: ast.AST) -> bool:
    """Return whether an expression has the same value in every run: literals, sums of them, `d2r(90)`."""
    if isinstance(node, ast.Call):
        is_conversion = isinstance(node.func, ast.Name) and node.func.id in _CONVERSIONS and not node.keywords
        return is_conversion and all(map(_is_constant, node.args))
    if isinstance(node, ast.Constant):
        return True
    if isinstance(node, ast.List | ast.Tuple):
        return all(map(_is_constant, node.elts))
    if isinstance(node, ast.UnaryOp):
        return _is_constant(node.operand)
    return isinstance(node, ast.BinOp) and _is_constant(node.left) and _is_constant(node.right)


_CONVERSIONS: Final = ("d2r", "r2d", "float", "int")
