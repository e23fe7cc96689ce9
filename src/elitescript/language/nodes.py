"""Lists the known kinds of syntax nodes, and takes a census of a tree.

The table fails closed: a kind that is not in it, or a field that a newer Python added to one, is
never looked into and always refused.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from functools import cache
from operator import attrgetter
from typing import Final, TypeVar, cast

_Node = TypeVar("_Node", bound=ast.AST)

# For each known kind: the fields that hold nodes, and those that hold anything else.
_KNOWN: Final[dict[type[ast.AST], tuple[str, str]]] = {
    ast.Module: ("body", "type_ignores"),
    ast.Expression: ("body", ""),
    ast.FunctionDef: ("args body decorator_list returns", "name type_comment"),
    ast.ClassDef: ("bases keywords body decorator_list", "name"),
    ast.Return: ("value", ""),
    ast.Delete: ("targets", ""),
    ast.Assign: ("targets value", "type_comment"),
    ast.AugAssign: ("target value", "op"),
    ast.AnnAssign: ("target annotation value", "simple"),
    ast.For: ("target iter body orelse", "type_comment"),
    ast.While: ("test body orelse", ""),
    ast.If: ("test body orelse", ""),
    ast.With: ("items body", "type_comment"),
    ast.Match: ("subject cases", ""),
    ast.Raise: ("exc cause", ""),
    ast.Try: ("body handlers orelse finalbody", ""),
    ast.Assert: ("test msg", ""),
    ast.Import: ("names", ""),
    ast.ImportFrom: ("names", "module level"),
    ast.Global: ("", "names"),
    ast.Nonlocal: ("", "names"),
    ast.Expr: ("value", ""),
    ast.Pass: ("", ""),
    ast.Break: ("", ""),
    ast.Continue: ("", ""),
    ast.BoolOp: ("values", "op"),
    ast.NamedExpr: ("target value", ""),
    ast.BinOp: ("left right", "op"),
    ast.UnaryOp: ("operand", "op"),
    ast.Lambda: ("args body", ""),
    ast.IfExp: ("test body orelse", ""),
    ast.Dict: ("keys values", ""),
    ast.Set: ("elts", ""),
    ast.ListComp: ("elt generators", ""),
    ast.SetComp: ("elt generators", ""),
    ast.DictComp: ("key value generators", ""),
    ast.GeneratorExp: ("elt generators", ""),
    ast.Yield: ("value", ""),
    ast.YieldFrom: ("value", ""),
    ast.Compare: ("left comparators", "ops"),
    ast.Call: ("func args keywords", ""),
    ast.FormattedValue: ("value format_spec", "conversion"),
    ast.JoinedStr: ("values", ""),
    ast.Constant: ("", "value kind"),
    ast.Attribute: ("value", "attr ctx"),
    ast.Subscript: ("value slice", "ctx"),
    ast.Starred: ("value", "ctx"),
    ast.Name: ("", "id ctx"),
    ast.List: ("elts", "ctx"),
    ast.Tuple: ("elts", "ctx"),
    ast.Slice: ("lower upper step", ""),
    ast.comprehension: ("target iter ifs", "is_async"),
    ast.ExceptHandler: ("type body", "name"),
    ast.arguments: ("posonlyargs args vararg kwonlyargs kw_defaults kwarg defaults", ""),
    ast.arg: ("annotation", "arg type_comment"),
    ast.keyword: ("value", "arg"),
    ast.alias: ("", "name asname"),
    ast.withitem: ("context_expr optional_vars", ""),
    ast.match_case: ("pattern guard body", ""),
    ast.MatchValue: ("value", ""),
    ast.MatchSingleton: ("", "value"),
    ast.MatchSequence: ("patterns", ""),
    ast.MatchMapping: ("keys patterns", "rest"),
    ast.MatchClass: ("cls patterns kwd_patterns", "kwd_attrs"),
    ast.MatchStar: ("", "name"),
    ast.MatchAs: ("pattern", "name"),
    ast.MatchOr: ("patterns", ""),
}

CHILDREN: Final[dict[type[ast.AST], tuple[str, ...]]] = {
    kind: tuple(children.split()) for kind, (children, _) in _KNOWN.items()
}
"""For each known kind of node, the fields that hold other nodes."""

BLOCKS: Final = ("body", "orelse", "finalbody")
"""The fields that hold statements."""

FUNCTIONS: Final = (ast.FunctionDef, ast.Lambda)


def children(node: ast.AST) -> list[ast.AST]:
    """Return the nodes directly inside a node, without operators and contexts; faster than `ast.iter_child_nodes`."""
    fields = CHILDREN.get(type(node))
    if fields is None:
        return list(ast.iter_child_nodes(node))
    found: list[ast.AST] = []
    for field in fields:
        child = getattr(node, field)
        if type(child) is list:
            found += [item for item in child if item is not None]
        elif child is not None:
            found.append(child)
    return found


class Census:
    """All nodes of a tree, by kind.

    Attributes:
        tree: where the count began.
        by_kind: the nodes of known kinds.
        unknown: nodes of other kinds, and known ones with fields that are not known.
    """

    __slots__ = ("by_kind", "tree", "unknown")

    def __init__(self, tree: ast.AST) -> None:
        self.tree = tree
        self.by_kind: dict[type[ast.AST], list[ast.AST]] = {kind: [] for kind in CHILDREN}
        self.unknown: list[ast.AST] = []
        self._count(tree)
        for kind, fields in _surplus_fields().items():
            for node in self.by_kind[kind]:
                if any(getattr(node, field, None) for field in fields):
                    self.unknown.append(node)

    def _count(self, tree: ast.AST) -> None:
        by_kind, children = self.by_kind, CHILDREN
        # Most nodes are constants and names, which hold no others.
        constant, add_constant = ast.Constant, by_kind[ast.Constant].append
        name, add_name = ast.Name, by_kind[ast.Name].append
        stack = [tree]
        pop, push = stack.pop, stack.append
        while stack:
            node = pop()
            kind = type(node)
            fields = children.get(kind)
            if fields is None:
                if node is not None:
                    self.unknown.append(node)
                continue
            by_kind[kind].append(node)
            for field in fields:
                child = getattr(node, field)
                what = type(child)
                if what is constant:
                    add_constant(child)
                elif what is name:
                    add_name(child)
                elif what is list:
                    for item in child:
                        what = type(item)
                        if what is constant:
                            add_constant(item)
                        elif what is name:
                            add_name(item)
                        else:
                            push(item)
                elif child is not None:
                    push(child)

    def of(self, kind: type[_Node]) -> list[_Node]:
        """Return all nodes of one kind, in no particular order."""
        return cast("list[_Node]", self.by_kind[kind])

    def replace(self, replacements: Mapping[ast.AST, ast.AST]) -> None:
        """Put other nodes where counted nodes hold the keys; the nodes that are put in are not counted."""
        keys = replacements.keys()
        for kind, nodes in self.by_kind.items():
            for field in CHILDREN[kind]:
                for node, child in zip(nodes, map(attrgetter(field), nodes), strict=True):
                    if type(child) is list:
                        if not keys.isdisjoint(child):
                            child[:] = [replacements.get(item, item) for item in child]
                    elif child in keys:
                        setattr(node, field, replacements[child])


@cache
def _surplus_fields() -> dict[type[ast.AST], tuple[str, ...]]:
    """Return fields that this Python has and the table has not."""
    surplus = {}
    for kind, (children, plain) in _KNOWN.items():
        fields = tuple(set(kind._fields).difference(children.split(), plain.split()))
        if fields:
            surplus[kind] = fields
    return surplus
