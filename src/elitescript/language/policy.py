"""Checks which names and attributes a program uses.

Programs are compiled to ordinary Python functions. From almost any Python object a chain of
attributes leads to the interpreter itself; this module refuses those chains where they are written.
It protects the computer from mistakes and explains them; against a hostile program it is a second
line of defence, not a security boundary.

The rules use the syntax tree alone, and refuse unknown syntax. Names computed at run time
(`getattr`) are checked by the runtime with `is_attribute_allowed`.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from itertools import islice
from typing import Final

from elitescript.language.diagnostics import Diagnostic, diagnostic
from elitescript.language.hooks import ATTRIBUTE
from elitescript.language.nodes import Census, children
from elitescript.language.text.source import SourceFile
from elitescript.said import said

COMPREHENSION_DEPTH_MAX: Final = 12
"""Some releases of CPython 3.12 and 3.13 crash when they compile about twice as many inside each other."""

_INNER_PARTS: Final = """
    ag_await ag_code ag_frame ag_running ag_suspended
    co_cellvars co_code co_consts co_filename co_freevars co_lines co_names co_positions co_varnames
    cr_await cr_code cr_frame cr_origin cr_running cr_suspended
    f_back f_builtins f_code f_generator f_globals f_lasti f_lineno f_locals f_trace f_trace_lines f_trace_opcodes
    func_closure func_code func_defaults func_dict func_globals
    gi_code gi_frame gi_running gi_suspended gi_yieldfrom
    im_class im_func im_self mro
    tb_frame tb_lasti tb_lineno tb_next with_traceback
"""
DENIED_ATTRIBUTES: Final = frozenset(_INNER_PARTS.split())
"""Attributes that lead to frames, code objects, tracebacks and the class tree."""

FORMAT_ATTRIBUTES: Final = frozenset(("format", "format_map"))
"""Methods that fill format strings, which hold attribute names."""

GUARDED_ATTRIBUTES: Final = FORMAT_ATTRIBUTES | {"__class__", "__hash__"}
"""Attributes whose loads become calls of the `@attribute` hook; the hash of `object` would be an address."""

_OPERATORS: Final = "add sub mul truediv floordiv mod divmod pow matmul and or xor lshift rshift"
_METHODS: Final = """
    init post_init enter exit call repr str bytes format
    len iter next reversed contains getitem setitem delitem missing
    eq ne lt le gt ge hash bool
    int float complex index round trunc floor ceil
    neg pos abs invert copy deepcopy
"""
ALLOWED_DUNDER_DEFINITIONS: Final = frozenset(
    [f"__{name}__" for name in _METHODS.split()]
    + [f"__{side}{name}__" for name in _OPERATORS.split() for side in ("", "r", "i")]
)
"""Special methods that classes of a program may define."""

ALLOWED_DUNDER_LOADS: Final = ALLOWED_DUNDER_DEFINITIONS | frozenset(
    ("__class__", "__doc__", "__name__", "__qualname__")
)
"""Special attributes that a program may read."""

ALLOWED_CLASS_VARIABLES: Final = ALLOWED_DUNDER_DEFINITIONS | {"__doc__", "__slots__"}
"""Special names that may be assigned in the body of a class, as in `__rmul__ = __mul__`."""

FUTURE: Final = "__future__"
FUTURE_FEATURES: Final = frozenset(
    """
    absolute_import annotations division generator_stop generators nested_scopes print_function unicode_literals
    with_statement
    """.split()  # noqa: SIM905
)
"""What `from __future__ import` may name; all but `annotations` is so anyway."""

_MAX_FINDINGS: Final = 300

_ADVICE: Final = {
    "__name__": "a program has no module name; leave the test out",
    "__main__": "a program has no module name; leave the test out",
    "__file__": "get_task_path() returns the folder of the task",
    "__import__": "use an import statement",
    "__dict__": "name the attributes one by one",
    "__del__": "release things with `with` or `try` ... `finally`",
    "__new__": "set the object up in __init__",
    "__getattr__": "define the attributes one by one",
    "__getattribute__": "define the attributes one by one",
}
_DEFAULT_ADVICE: Final = "names between double underscores belong to Python itself"

_NAME_FIELDS: Final[tuple[tuple[type[ast.AST], str], ...]] = (
    (ast.arg, "arg"),
    (ast.keyword, "arg"),
    (ast.ExceptHandler, "name"),
    (ast.alias, "asname"),
    (ast.MatchAs, "name"),
    (ast.MatchStar, "name"),
    (ast.MatchMapping, "rest"),
)
"""Nodes besides `Name` that hold a name, and its field."""

_SYNTAX: Final = {
    "AsyncFunctionDef": ("`async def`", "start_thread() runs functions side by side"),
    "AsyncFor": ("`async for`", "start_thread() runs functions side by side"),
    "AsyncWith": ("`async with`", "start_thread() runs functions side by side"),
    "Await": ("`await`", "start_thread() runs functions side by side"),
    "TryStar": ("`except*`", "write `except`: a program raises one exception at a time, there are no groups of them"),
    "TypeAlias": ("the `type` statement", "assign the type to a name"),
    "FunctionDef": ("a type parameter", "leave the brackets behind the name out"),
    "ClassDef": ("a type parameter", "leave the brackets behind the name out"),
}


def is_dunder(name: str) -> bool:
    """Return whether a name is one of Python's special names, `__like_this__`."""
    return name[:2] == "__" == name[-2:] and name.strip("_") != ""


def is_attribute_allowed(name: str) -> bool:
    """Return whether a program may read the attribute `name` of any object."""
    if name in DENIED_ATTRIBUTES:
        return False
    return not is_dunder(name) or name in ALLOWED_DUNDER_LOADS


def review(source: SourceFile, census: Census) -> list[Diagnostic]:
    """Return the breaches of the policy, as E115; a bounded number of them."""
    return list(islice(_Reviewer(source, census).findings(), _MAX_FINDINGS))


def first_too_deep(census: Census) -> ast.AST | None:
    """Return the first comprehension nested deeper than `COMPREHENSION_DEPTH_MAX`; None if there is none."""
    kinds = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)
    found = [node for kind in kinds for node in census.of(kind)]
    if len(found) <= COMPREHENSION_DEPTH_MAX:
        return None
    # By place, so that a comprehension comes before those inside it. In some formatted strings places are wrong, so
    # that one is looked into again when it turns out to be deeper than it seemed.
    pending: list[tuple[ast.AST, int]] = [(node, 0) for node in sorted(found, key=_place, reverse=True)]
    known: dict[ast.AST, int] = {}
    while pending:
        node, depth = pending.pop()
        if isinstance(node, kinds):
            depth += 1
            if depth <= known.get(node, 0):
                continue
            known[node] = depth
            if depth > COMPREHENSION_DEPTH_MAX:
                return node
        pending += [(child, depth) for child in children(node)]
    return None


def _place(node: ast.expr) -> tuple[int, int]:
    return node.lineno, node.col_offset


def is_future(node: ast.ImportFrom) -> bool:
    """Return whether a statement asks for what is so anyway, or for annotations that are texts."""
    return node.module == FUTURE and not node.level and all(alias.name in FUTURE_FEATURES for alias in node.names)


def obey_futures(census: Census) -> None:
    """Take `from __future__ import` out of a tree; if it names `annotations`, make texts of all annotations."""
    futures = [node for node in census.of(ast.ImportFrom) if is_future(node)]
    if not futures:
        return
    if any(alias.name == "annotations" for node in futures for alias in node.names):
        for argument in census.of(ast.arg):
            argument.annotation = _as_text(argument.annotation)
        for function in census.of(ast.FunctionDef):
            function.returns = _as_text(function.returns)
        for assignment in census.of(ast.AnnAssign):
            assignment.annotation = ast.copy_location(ast.Constant(ast.unparse(assignment.annotation)), assignment)
    census.replace({node: ast.copy_location(ast.Pass(), node) for node in futures})


def _as_text(annotation: ast.expr | None) -> ast.expr | None:
    return None if annotation is None else ast.copy_location(ast.Constant(ast.unparse(annotation)), annotation)


def guard_attributes(tree: ast.AST, census: Census) -> None:
    """Replace loads of guarded attributes by calls of the `@attribute` hook."""
    calls: dict[ast.AST, ast.Call] = {
        node: _guarded(node)
        for node in census.of(ast.Attribute)
        if node.attr in GUARDED_ATTRIBUTES and isinstance(node.ctx, ast.Load)
    }
    if not calls:
        return
    for call in calls.values():
        call.args[0] = calls.get(call.args[0], call.args[0])
    census.replace(calls)


def _guarded(node: ast.Attribute) -> ast.Call:
    hook = ast.copy_location(ast.Name(ATTRIBUTE, ast.Load()), node)
    name = ast.copy_location(ast.Constant(node.attr), node)
    return ast.copy_location(ast.Call(hook, [node.value, name], []), node)


class _Reviewer:
    __slots__ = ("census", "source")

    def __init__(self, source: SourceFile, census: Census) -> None:
        self.source = source
        self.census = census

    def findings(self) -> Iterator[Diagnostic]:
        yield from self._unknown()
        yield from self._names()
        yield from self._attributes()
        yield from self._definitions()
        yield from self._imports()
        yield from self._patterns()
        yield from self._nesting()
        for node in self.census.of(ast.comprehension):
            if node.is_async:
                yield self._finding(node.target, "`async for` is not available", _SYNTAX["AsyncFor"][1])

    def _nesting(self) -> Iterator[Diagnostic]:
        node = first_too_deep(self.census)
        if node is not None:
            text = said(
                "comprehensions are nested more than {comprehension_depth_max} deep",
                comprehension_depth_max=COMPREHENSION_DEPTH_MAX,
            )
            yield self._finding(node, text, "give the inner ones names of their own")

    def _finding(self, node: ast.AST, text: str, hint: str, name: str = "") -> Diagnostic:
        line = getattr(node, "lineno", 1)
        row = self.source.line(line)
        offset = getattr(node, "col_offset", 0)
        if isinstance(node, ast.Attribute) and node.end_lineno and node.end_col_offset is not None:
            line = node.end_lineno
            row = self.source.line(line)
            offset = max(0, node.end_col_offset - len(node.attr.encode()))
        column = len(row.encode()[:offset].decode("utf-8", "ignore"))
        if name and not isinstance(node, ast.Attribute):
            found = row.find(name, column)
            column = column if found < 0 else found
        return diagnostic("E115", line, column + 1, text, end_column=column + 1 + max(1, len(name)), hint=hint)

    def _special(self, node: ast.AST, name: str) -> Diagnostic:
        return self._finding(
            node, said("programs cannot use the name `{name}`", name=name), _ADVICE.get(name, _DEFAULT_ADVICE), name
        )

    def _unknown(self) -> Iterator[Diagnostic]:
        for node in self.census.unknown:
            kind = type(node).__name__
            what, hint = _SYNTAX.get(kind, (said("this syntax ({kind})", kind=kind), "write it in a simpler way"))
            yield self._finding(node, said("{what} is not available", what=what), hint)

    def _names(self) -> Iterator[Diagnostic]:
        """Yield special names, wherever a name can stand."""
        census = self.census
        allowed = self._class_variables()
        for node in census.of(ast.Name):
            if node.id[:2] == "__" and is_dunder(node.id) and id(node) not in allowed:
                yield self._special(node, node.id)
        for kind, field in _NAME_FIELDS:
            for other in census.by_kind[kind]:
                name = getattr(other, field)
                if name and is_dunder(name):
                    yield self._special(other, name)
        declarations: list[ast.Global | ast.Nonlocal] = [*census.of(ast.Global), *census.of(ast.Nonlocal)]
        for declaration in declarations:
            yield from (self._special(declaration, name) for name in declaration.names if is_dunder(name))

    def _class_variables(self) -> set[int]:
        """Return the special names that class bodies assign, and that they use for it, and may."""
        allowed = set()
        for node in self.census.of(ast.ClassDef):
            for statement in node.body:
                if isinstance(statement, ast.Assign):
                    targets = statement.targets
                elif isinstance(statement, ast.AnnAssign):
                    targets = [statement.target]
                else:
                    continue
                for target in targets:
                    if isinstance(target, ast.Name) and target.id in ALLOWED_CLASS_VARIABLES:
                        allowed.add(id(target))
                for used in () if statement.value is None else ast.walk(statement.value):
                    if isinstance(used, ast.Name) and used.id in ALLOWED_DUNDER_DEFINITIONS:
                        allowed.add(id(used))
        return allowed

    def _attributes(self) -> Iterator[Diagnostic]:
        for node in self.census.of(ast.Attribute):
            name = node.attr
            if name in DENIED_ATTRIBUTES:
                text = said("the attribute `{name}` is not available to programs", name=name)
                yield self._finding(node, text, "it belongs to the inside of Python", name)
            elif name[:2] == "__" and is_dunder(name):
                if name not in ALLOWED_DUNDER_LOADS:
                    text = said("the attribute `{name}` is not available to programs", name=name)
                    yield self._finding(node, text, _ADVICE.get(name, _DEFAULT_ADVICE), name)
                elif not isinstance(node.ctx, ast.Load):
                    text = said("the attribute `{name}` cannot be changed", name=name)
                    yield self._finding(node, text, "define it in the body of the class", name)
        for statement in self.census.of(ast.AugAssign):
            target = statement.target
            if isinstance(target, ast.Attribute) and target.attr in GUARDED_ATTRIBUTES:
                text = said("the attribute `{attr}` cannot be changed in place", attr=target.attr)
                yield self._finding(target, text, "assign it with `=`", target.attr)

    def _definitions(self) -> Iterator[Diagnostic]:
        census = self.census
        methods = None
        for function in census.of(ast.FunctionDef):
            if is_dunder(function.name):
                methods = self._methods() if methods is None else methods
                if id(function) not in methods:
                    yield self._special(function, function.name)
                elif function.name not in ALLOWED_DUNDER_DEFINITIONS:
                    text = said("a class cannot define `{function}`", function=function.name)
                    yield self._finding(function, text, _ADVICE.get(function.name, _DEFAULT_ADVICE), function.name)
        for node in census.of(ast.ClassDef):
            if is_dunder(node.name):
                yield self._special(node, node.name)
            for keyword in node.keywords:
                text = said("a class takes no `{arg}=`", arg=keyword.arg or "**")
                yield self._finding(keyword, text, "name only the classes that it extends")

    def _methods(self) -> set[int]:
        """Return the functions that are defined in a class body, also inside an `if` there."""
        methods = set()
        for node in self.census.of(ast.ClassDef):
            stack: list[ast.AST] = list(node.body)
            while stack:
                statement = stack.pop()
                if isinstance(statement, ast.FunctionDef):
                    methods.add(id(statement))
                elif not isinstance(statement, ast.ClassDef):
                    for field in ("body", "orelse", "finalbody", "handlers", "cases"):
                        stack.extend(getattr(statement, field, ()))
        return methods

    def _imports(self) -> Iterator[Diagnostic]:
        for node in self.census.of(ast.ImportFrom):
            if is_future(node):
                continue
            if any(is_dunder(part) for part in (node.module or "").split(".")):
                yield self._special(node, node.module or "")
                continue
            for alias in node.names:
                if not is_attribute_allowed(alias.name):
                    yield self._special(alias, alias.name)
        for statement in self.census.of(ast.Import):
            for alias in statement.names:
                if any(is_dunder(part) for part in alias.name.split(".")):
                    yield self._special(alias, alias.name)

    def _patterns(self) -> Iterator[Diagnostic]:
        for pattern in self.census.of(ast.MatchClass):
            if pattern.patterns:
                # Any class can define which attributes its positions stand for.
                text = "this class pattern needs names for its values"
                yield self._finding(pattern, text, "write `case int() as n`, or `case Point(x=a, y=b)`")
            for name in pattern.kwd_attrs:
                if not is_attribute_allowed(name) or name in GUARDED_ATTRIBUTES:
                    text = said("the attribute `{name}` is not available in patterns", name=name)
                    yield self._finding(pattern, text, "test it with `if`", name)
