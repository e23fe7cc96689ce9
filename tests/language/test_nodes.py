from __future__ import annotations

import ast

import pytest

from elitescript.language.nodes import CHILDREN, Census

REFUSED = {"AsyncFunctionDef", "AsyncFor", "AsyncWith", "Await", "TryStar", "TypeAlias", "TemplateStr", "Interpolation"}
NOT_IN_PROGRAMS = {"Interactive", "FunctionType", "TypeIgnore", "TypeVar", "ParamSpec", "TypeVarTuple"}
BASES = {"AST", "mod", "stmt", "expr", "excepthandler", "pattern", "type_ignore", "type_param", "slice", "Suite"}
OLD = {
    "Num",
    "Str",
    "Bytes",
    "NameConstant",
    "Ellipsis",
    "Index",
    "ExtSlice",
    "AugLoad",
    "AugStore",
    "Param",
    "_ast_Ellipsis",
}


def kinds():
    operators = (ast.expr_context, ast.operator, ast.unaryop, ast.boolop, ast.cmpop)
    for name, kind in vars(ast).items():
        if isinstance(kind, type) and issubclass(kind, ast.AST) and not issubclass(kind, operators):
            yield name, kind


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_every_kind_of_node_is_known_or_refused_on_purpose():
    """Fails when a new Python adds a kind: then decide."""
    known = {kind.__name__ for kind in CHILDREN}
    unsorted = {name for name, _ in kinds()} - known - REFUSED - NOT_IN_PROGRAMS - BASES - OLD
    assert unsorted == set()


def test_children_are_exactly_the_nodes_below():
    tree = ast.parse(
        "def f(a: int, /, b=1, *c, d=2, e, **g) -> h:\n  x = {1: 2, **y}\n  return [i for i in z if i][1:2]\n"
        "with a as b:\n  pass\ntry:\n  pass\nexcept E as e:\n  raise X from Y\n"
        "match a:\n  case {'k': 1, **r} if b: pass\n  case C(x=1) | [*s]: pass\n"
    )
    census = Census(tree)
    ignored = (ast.expr_context, ast.operator, ast.unaryop, ast.boolop, ast.cmpop)
    expected = {id(node) for node in ast.walk(tree) if not isinstance(node, ignored)}
    assert {id(node) for nodes in census.by_kind.values() for node in nodes} == expected
    assert census.unknown == []


def test_what_is_not_known_is_not_looked_into():
    census = Census(ast.parse("async def f():\n  x = 1\ny = 2"))
    assert [type(node) for node in census.unknown] == [ast.AsyncFunctionDef]
    assert [node.id for node in census.of(ast.Name)] == ["y"]


def test_a_filled_field_that_is_not_known_makes_a_node_unknown(monkeypatch):
    from elitescript.language import nodes

    monkeypatch.setattr(nodes, "_surplus_fields", lambda: {ast.Return: ("speed",)})
    tree = ast.parse("def f():\n  return 1\n  return 2")
    tree.body[0].body[1].speed = [3]
    assert Census(tree).unknown == [tree.body[0].body[1]]
