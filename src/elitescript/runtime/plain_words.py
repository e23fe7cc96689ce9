"""Rewrites Python's messages of uncaught exceptions in plain words, with the values involved.

The wording of Python's messages differs between versions and names things that programs do not have
(`main.<locals>.f()`, `NoneType`). What a program raises itself, and what commands refuse, is left as it is; a program
that catches the exception sees Python's text.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping
from types import CodeType, FunctionType
from typing import Any, Final

from elitescript.commands.definition.quantities import shown
from elitescript.language.advice.unknown_names import nearest
from elitescript.records import NamedTuple
from elitescript.said import Said, counted, said
from elitescript.values.concrete import UNKNOWN, glance
from elitescript.values.plain import SIGNS

_SCALARS: Final = (bool, int, float, str, type(None))
_LISTS: Final = (list, tuple)
_MOST_ELEMENTS: Final = 20
"""Elements of a list that is shown."""


class Scene:
    """The place where an exception was raised: expression and variables.

    Args:
        text: source of the failing expression or statement; empty if unknown.
        line: its whole line.
        names: local and global variables; read, never called.
    """

    __slots__ = ("_names", "line", "node")

    def __init__(self, text: str, line: str, names: Mapping[str, Any]) -> None:
        self._names = names
        self.node = _node_of(text)
        self.line = line

    def statement(self) -> ast.AST | None:
        """Return the statement on the line; of one with a block, its header."""
        row = self.line.strip()
        return _node_of(row) or _node_of(f"{row} pass")

    def value(self, node: ast.AST | None) -> Any:
        """Return the value of an expression, if no code has to run for it; else `UNKNOWN`."""
        return glance(node, self._names)

    def quoted(self, node: ast.AST | None) -> str:
        """Return an expression for a message: its text, and its value if that is known and differs."""
        if node is None:
            return ""
        text = ast.unparse(node)
        value = self.value(node)
        if isinstance(node, ast.Constant) or not _is_shown(value):
            return f"`{text}`"
        return f"`{text}`" if text == repr(value) else f"`{text}` ({shown(value)})"


class Words(NamedTuple):
    """Text and hint in place of Python's message."""

    text: str
    hint: str = ""


def plain_words(class_name: str, text: str, scene: Scene) -> Words:
    """Return the text and hint for the message of a built-in exception.

    Args:
        class_name: class of the exception.
        text: Python's message.
        scene: where it was raised.
    """
    for classes, pattern, tell in _TABLE:
        if class_name in classes:
            found = re.search(pattern, text)
            if found:
                return tell(found, scene)
    return Words(without_insides(text))


def without_locals(text: str) -> str:
    """Return a message with functions by their own names: `main.<locals>.f()` is `f()`."""
    return re.sub(r"(?:[^\W\d]\w*\.)+<locals>\.", "", text)


def without_insides(text: str) -> str:
    """Return a message without `<locals>` and `NoneType`."""
    text = without_locals(text)
    return text.replace("'NoneType' object", "None").replace("'NoneType'", "None").replace("NoneType", "None")


# ---------------------------------------------------------------- values


def _node_of(text: str) -> ast.AST | None:
    """Return the syntax tree of a text: an expression or a statement."""
    for source, mode in ((f"({text}\n)", "eval"), (text, "exec")):
        try:
            tree = ast.parse(source, mode=mode)
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            continue
        if isinstance(tree, ast.Expression):
            return tree.body
        if isinstance(tree, ast.Module) and len(tree.body) == 1:
            return tree.body[0]
    return None


def _is_shown(value: Any) -> bool:
    if type(value) in _LISTS:
        return len(value) <= _MOST_ELEMENTS and all(type(item) in _SCALARS for item in value)
    return type(value) in _SCALARS


_KINDS: Final = {
    "NoneType": "None",
    "int": "an int",
    "builtin_function_or_method": "a function",
    "function": "a function",
    "method": "a function",
    "type": "a class",
    "module": "a module",
    **{name: f"a {name}" for name in ("bool", "bytes", "dict", "float", "list", "range", "set", "str", "tuple")},
}


def _kind(name: str) -> str:
    """Return a type in words, from Python's name of it."""
    words = _KINDS.get(name)
    return Said(words) if words else said("an object of class {name}", name=name)


_NUMBERS: Final = ("int", "float", "bool")
_NO_VALUE: Final = "A command without a result gives None, and so does a function that ends without `return`"


# ---------------------------------------------------------------- operators


def _division(_found: re.Match[str], scene: Scene) -> Words:
    divisor = _operands(scene)[2]
    if divisor is None:
        return Words("division by zero", "test the divisor before")
    name = ast.unparse(divisor)
    if isinstance(divisor, ast.Constant):
        return Words(said("division by zero: the divisor is {name}", name=name))
    value = scene.value(divisor)
    # The values of its names show why it is zero.
    parts = sorted({node.id for node in ast.walk(divisor) if isinstance(node, ast.Name)} - {name})
    values = {part: scene.value(ast.Name(part)) for part in parts}
    known = [f"{part} = {shown(held)}" for part, held in values.items() if _is_shown(held)]
    holds = f" ({', '.join(known)})" if known else ""
    zero = shown(value) if type(value) in (int, float, bool) else "0"
    return Words(
        said("division by zero: `{name}` is {zero}{holds}", name=name, zero=zero, holds=holds),
        said("test `{name}` before the division", name=name),
    )


def _operands(scene: Scene) -> tuple[ast.AST | None, str, ast.AST | None]:
    """Return left operand, sign and right operand of the failed operation; None where unknown."""
    node = scene.node
    if isinstance(node, ast.BinOp):
        return node.left, SIGNS.get(type(node.op), ""), node.right
    if isinstance(node, ast.AugAssign):
        return node.target, SIGNS.get(type(node.op), ""), node.value
    if isinstance(node, ast.Compare) and len(node.ops) == 1:
        return node.left, SIGNS.get(type(node.ops[0]), ""), node.comparators[0]
    return None, "", None


def _pair(sign: str, left: str, right: str, scene: Scene) -> Words:
    """Return the words for an operator that two types do not have."""
    first, _, second = _operands(scene)
    where = (
        said(": {first} and {second}", first=scene.quoted(first), second=scene.quoted(second))
        if first is not None
        else ""
    )
    text = said(
        "`{sign}` does not work between {kind} and {other}{where}",
        sign=sign,
        kind=_kind(left),
        other=_kind(right),
        where=where,
    )
    return Words(text, _pair_hint(sign, left, right))


def _pair_hint(sign: str, left: str, right: str) -> str:
    kinds = {left, right}
    if "NoneType" in kinds:
        return _NO_VALUE
    if "str" in kinds and kinds & {*_NUMBERS, "list", "tuple", "dict"}:
        if sign == "+":
            return "join them with str_cat(a, b), or make a text of the value with to_str(x)"
        return "make a number of the text with float(x) or int(x)"
    if kinds & {"list", "tuple"} and sign in ("+", "-", "*", "/"):
        if sign == "+" and kinds & set(_NUMBERS):
            appended = "p + [x]" if left == "list" else "[x] + p"
            return said("add to each element with [e + k for e in p], or append one: {appended}", appended=appended)
        if sign == "+":
            return "`+` joins two lists or two tuples: list(x) makes a list"
        if sign == "-":
            return "subtract element by element, or poses with pose_sub(p1, p2)"
        return "calculate element by element: [k * e for e in p]"
    return ""


def _unsupported(found: re.Match[str], scene: Scene) -> Words:
    sign = found[1].split()[0].removesuffix("=") or found[1]
    return _pair(sign, found[2], found[3], scene)


def _concatenation(found: re.Match[str], scene: Scene) -> Words:
    return _pair("+", found[1], found[2], scene)


def _repetition(found: re.Match[str], scene: Scene) -> Words:
    first, _, second = _operands(scene)
    kinds = [_type_name(scene.value(node)) for node in (first, second)]
    if "" not in kinds:
        return _pair("*", kinds[0], kinds[1], scene)
    where = (
        said(": {first} and {second}", first=scene.quoted(first), second=scene.quoted(second))
        if first is not None
        else ""
    )
    text = said(
        "`*` repeats a list or a text a whole number of times, not by {kind}{where}", kind=_kind(found[1]), where=where
    )
    return Words(text, "calculate element by element: [k * e for e in p]")


def _type_name(value: Any) -> str:
    return "" if value is UNKNOWN else type(value).__name__


def _comparison(found: re.Match[str], scene: Scene) -> Words:
    return _pair(found[1], found[2], found[3], scene)


def _unary(found: re.Match[str], scene: Scene) -> Words:
    operand = scene.node.operand if isinstance(scene.node, ast.UnaryOp) else None
    where = f": {scene.quoted(operand)}" if operand is not None else ""
    hint = _NO_VALUE if found[2] == "NoneType" else ""
    return Words(
        said(
            "`{sign}` does not work with {kind}{where}",
            sign=found[1].rstrip(":")[-1],
            kind=_kind(found[2]),
            where=where,
        ),
        hint,
    )


# ---------------------------------------------------------------- calls


def _function_name(qualified: str, scene: Scene) -> tuple[str, int]:
    """Return the name of a function as the program calls it, and the number of arguments that Python adds."""
    name = without_insides(qualified)
    holder, _, method = name.rpartition(".")
    if method == "__call__" and isinstance(scene.node, ast.Call):
        return ast.unparse(scene.node.func), 1
    if method in ("__init__", "__call__"):
        return holder, 1
    return (name, 1) if holder else (name, 0)


def _defined_as(name: str, scene: Scene) -> str:
    """Return the definition of a function of the program, in words."""
    function = scene.value(scene.node.func) if isinstance(scene.node, ast.Call) else UNKNOWN
    if type(function) is not FunctionType or function.__name__ != name:
        return ""
    return said(
        "it is defined in line {line} as {name}({parameters})",
        line=function.__code__.co_firstlineno,
        name=name,
        parameters=", ".join(_parameters(function)),
    )


def _parameters(function: FunctionType) -> list[str]:
    code: CodeType = function.__code__
    names = list(code.co_varnames[: code.co_argcount])
    defaults = function.__defaults__ or ()
    for index, value in enumerate(defaults, len(names) - len(defaults)):
        names[index] += f"={shown(value)}" if _is_shown(value) else "=..."
    return names


def _surplus(found: re.Match[str], scene: Scene) -> Words:
    name, own = _function_name(found[1], scene)
    takes, given = int(found[3]) - own, int(found[4]) - own
    allowed = counted(takes, "argument", "arguments")
    if found[2]:
        allowed = said("{least} to {most}", least=int(found[2]) - own, most=allowed)
    elif not takes:
        allowed = Said("no arguments")
    return Words(
        said("{name}() takes {allowed}, got {given}", name=name, allowed=allowed, given=given), _defined_as(name, scene)
    )


def _missing(found: re.Match[str], scene: Scene) -> Words:
    name, _ = _function_name(found[1], scene)
    names = re.findall(r"'(\w+)'", found[2])
    listed = " and ".join(f"`{item}`" for item in names)
    if len(names) == 1:
        return Words(
            said("{name}() was called without its argument {listed}", name=name, listed=listed),
            _defined_as(name, scene),
        )
    return Words(
        said("{name}() was called without its arguments {listed}", name=name, listed=listed), _defined_as(name, scene)
    )


def _unexpected(found: re.Match[str], scene: Scene) -> Words:
    name, _ = _function_name(found[1], scene)
    return Words(
        said("{name}() has no parameter `{parameter}`", name=name, parameter=found[2]), _defined_as(name, scene)
    )


def _twice(found: re.Match[str], scene: Scene) -> Words:
    name, _ = _function_name(found[1], scene)
    return Words(
        said("{name}() gets its argument `{parameter}` twice", name=name, parameter=found[2]), _defined_as(name, scene)
    )


def _not_callable(found: re.Match[str], scene: Scene) -> Words:
    function = scene.node.func if isinstance(scene.node, ast.Call) else None
    if function is None:
        return Words(said("{kind} cannot be called", kind=_kind(found[1])))
    hint = _NO_VALUE if found[1] == "NoneType" else ""
    if isinstance(function, ast.Name) and found[1] in _KINDS:
        name = function.id
        hint = hint or said(
            "write `{name}` to read the variable; if a function of that name is meant, rename the variable", name=name
        )
    elif isinstance(function, (ast.Constant, ast.BinOp, ast.Tuple, ast.List)):
        hint = "is an operator or a comma missing before the bracket?"
    return Words(said("{what}, which cannot be called", what=_said_value(function, found[1], scene)), hint)


def _said_value(node: ast.AST, kind: str, scene: Scene) -> str:
    """Return a text such as `x` is an int (5)."""
    name, value = ast.unparse(node), scene.value(node)
    shows = _is_shown(value) and value is not None and not isinstance(node, (ast.Constant, ast.List, ast.Tuple))
    if shows:
        return said("`{name}` is {kind} ({value})", name=name, kind=_kind(kind), value=shown(value))
    return said("`{name}` is {kind}", name=name, kind=_kind(kind))


# ---------------------------------------------------------------- elements


def _out_of_range(found: re.Match[str], scene: Scene) -> Words:
    node = scene.node
    if not isinstance(node, ast.Subscript):
        # An assignment to an element fails on the target alone, or on the whole line.
        statement = scene.statement()
        targets = statement.targets if isinstance(statement, ast.Assign) else []
        node = targets[0] if len(targets) == 1 and isinstance(targets[0], ast.Subscript) else None
    if node is None:
        return Words("there is no element with this index", "the first element has the index 0")
    holder, index = scene.value(node.value), scene.value(node.slice)
    name = ast.unparse(node.value)
    which = (
        said("index {index}", index=shown(index))
        if type(index) in (int, bool)
        else said("the index {index}", index=scene.quoted(node.slice))
    )
    if type(holder) in (list, tuple, str):
        count = len(holder)
        nouns = ("character", "characters") if type(holder) is str else ("element", "elements")
        if not count:
            return Words(said("{which} is out of range: `{name}` is empty", which=which, name=name))
        elements = counted(count, *nouns)
        has = said("`{name}` has {elements}", name=name, elements=elements)
        hint = said(
            "indices go from 0 to {last}, or from -{count} to -1 counted from the end",
            last=count - 1,
            count=count,
        )
        if count == 1:
            hint = "its only index is 0"
        if found[0].startswith("list assignment"):
            hint = said("{hint}; `{name}.append(x)` adds an element", hint=hint, name=name)
        return Words(said("{which} is out of range: {has}", which=which, has=has), hint)
    return Words(
        said("{which} is out of range: `{name}` has fewer elements", which=which, name=name),
        "the first element has the index 0",
    )


def _key(found: re.Match[str], scene: Scene) -> Words:
    node = scene.node
    if not isinstance(node, ast.Subscript):
        # `pop`, `remove`, or a `raise` of the program itself.
        return Words(said("there is no key {key}", key=found[0]) if isinstance(node, ast.Call) else found[0])
    holder = scene.value(node.value)
    key = scene.value(node.slice)
    text = said("`{expression}` has no key {key}", expression=ast.unparse(node.value), key=found[0])
    if type(holder) is not dict or not all(type(item) in (str, int, float) for item in holder):
        return Words(text)
    if not holder:
        return Words(said("{text}: it is empty", text=text))
    near = nearest(key, (item for item in holder if type(item) is str)) if type(key) is str else ""
    keys = ", ".join(shown(item) for item in list(holder)[:_MOST_ELEMENTS])
    return Words(text, said("is {near!r} meant?", near=near) if near else said("it has {keys}", keys=keys))


def _unpacking(found: re.Match[str], scene: Scene) -> Words:
    expected = int(found["expected"])
    got = found.groupdict().get("got")
    statement = scene.statement()
    if isinstance(statement, ast.Assign):
        value = scene.value(statement.value)
        if type(value) in (list, tuple, str):
            got = str(len(value))
        name = f"`{ast.unparse(statement.value)}`"
    else:
        name = "the value"
    has = got or ("fewer" if found[0].startswith("not enough") else "more")
    elements = "1 element" if has == "1" else said("{has} elements", has=has)
    return Words(
        said("{name} has {elements} for {expected} names", name=name, elements=elements, expected=expected),
        "there must be as many names as elements",
    )


def _not_unpackable(found: re.Match[str], scene: Scene) -> Words:
    statement = scene.statement()
    hint = _NO_VALUE if found[1] == "NoneType" else ""
    if isinstance(statement, ast.Assign):
        value = _said_value(statement.value, found[1], scene)
        if isinstance(statement.value, ast.Constant):
            value = said("the value is {kind}", kind=_kind(found[1]))
        return Words(said("{value}, which has no elements for these names", value=value), hint)
    return Words(said("{kind} has no elements for these names", kind=_kind(found[1])), hint)


def _not_subscriptable(found: re.Match[str], scene: Scene) -> Words:
    hint = _NO_VALUE if found[1] == "NoneType" else ""
    if isinstance(scene.node, ast.Subscript):
        return Words(said("{what}, which has no elements", what=_said_value(scene.node.value, found[1], scene)), hint)
    return Words(said("{kind} has no elements", kind=_kind(found[1])), hint)


def _fixed(found: re.Match[str], scene: Scene) -> Words:
    kind = found[1]
    hint = "make a list of it: list(x)" if kind in ("tuple", "range") else ""
    if kind == "str":
        hint = "build a new text: a[:i] + c + a[i + 1:]"
    if kind == "NoneType":
        hint = _NO_VALUE
    name = f": `{ast.unparse(scene.node.value)}`" if isinstance(scene.node, ast.Subscript) else ""
    return Words(said("elements of {kind} cannot be changed{name}", kind=_kind(kind), name=name), hint)


def _wrong_index(found: re.Match[str], scene: Scene) -> Words:
    holder = {"string": "str"}.get(found[1], found[1])
    index = scene.node.slice if isinstance(scene.node, ast.Subscript) else None
    where = f": {scene.quoted(index)}" if index is not None else ""
    hint = "int(x) makes an int of it" if found[2] == "float" else ""
    return Words(
        said(
            "the index of {kind} must be an int, not {given}{where}",
            kind=_kind(holder),
            given=_kind(found[2]),
            where=where,
        ),
        hint,
    )


def _not_iterable(found: re.Match[str], scene: Scene) -> Words:
    kind = found[1]
    node = scene.node
    hint = _NO_VALUE if kind == "NoneType" else ""
    if kind in ("int", "float"):
        hint = "to count use range(n)"
    if not isinstance(node, ast.expr):
        statement = scene.statement()
        node = statement.iter if isinstance(statement, ast.For) else None
    if isinstance(node, (ast.Name, ast.Attribute, ast.Subscript)):
        return Words(said("{what}, which has no elements to go through", what=_said_value(node, kind, scene)), hint)
    return Words(said("{kind} has no elements to go through", kind=_kind(kind)), hint)


def _not_a_container(found: re.Match[str], scene: Scene) -> Words:
    second = scene.node.comparators[0] if isinstance(scene.node, ast.Compare) else None
    where = f": {scene.quoted(second)}" if second is not None else ""
    return Words(said("`in` cannot look into {kind}{where}", kind=_kind(found[1]), where=where))


def _no_length(found: re.Match[str], scene: Scene) -> Words:
    argument = scene.node.args[0] if isinstance(scene.node, ast.Call) and len(scene.node.args) == 1 else None
    where = f": {scene.quoted(argument)}" if argument is not None else ""
    return Words(
        said("{kind} has no length{where}", kind=_kind(found[1]), where=where),
        _NO_VALUE if found[1] == "NoneType" else "",
    )


_ELSEWHERE: Final = {
    "push": "append(x) adds an element at the end",
    "push_back": "append(x) adds an element at the end",
    "add": "append(x) adds an element at the end",
    "length": "len(x) gives the number of elements",
    "size": "len(x) gives the number of elements",
    "has_key": "a key is looked for with `key in x`",
}
"""Methods of other languages."""

_OF_PYTHON: Final[dict[str, type]] = {
    kind.__name__: kind for kind in (bool, bytes, dict, float, int, list, set, str, tuple)
}


def _no_attribute(found: re.Match[str], scene: Scene) -> Words:
    kind, name = found[1], found[2]
    if kind == "NoneType":
        node = scene.node
        if isinstance(node, ast.Call):
            node = node.func
        of = (
            said("`{expression}` is None, which", expression=ast.unparse(node.value))
            if isinstance(node, ast.Attribute)
            else "None"
        )
        return Words(said("{of} has no `{name}`", of=of, name=name), _NO_VALUE)
    near = nearest(name, (item for item in dir(_OF_PYTHON[kind]) if item[0] != "_")) if kind in _OF_PYTHON else ""
    hint = _ELSEWHERE.get(name, "") if kind in ("list", "tuple", "dict", "str") else ""
    return Words(
        said("{kind} has no `{name}`", kind=_kind(kind), name=name),
        said("is `{near}` meant?", near=near) if near else hint,
    )


# ---------------------------------------------------------------- names and values


def _no_value_yet(found: re.Match[str], _scene: Scene) -> Words:
    name = found[1]
    hint = said(
        "assign it before, or write `global {name}` at the start of the function if the global is meant", name=name
    )
    return Words(said("the variable `{name}` has no value yet here", name=name), hint)


def _no_free_value(found: re.Match[str], _scene: Scene) -> Words:
    return Words(
        said("the variable `{name}` of the enclosing function has no value yet", name=found[1]),
        "assign it before the call",
    )


def _not_an_int(found: re.Match[str], _scene: Scene) -> Words:
    hint = "int(float(x)) takes a text with a decimal point" if re.fullmatch(r"'\s*[+-]?\d*\.\d*\s*'", found[1]) else ""
    return Words(said("the text {name} is not an int", name=found[1]), hint)


def _not_convertible(found: re.Match[str], _scene: Scene) -> Words:
    return Words(
        said("{name}() cannot make a number of {kind}", name=found[1], kind=_kind(found[2])),
        _NO_VALUE if found[2] == "NoneType" else "",
    )


def _domain(_found: re.Match[str], scene: Scene) -> Words:
    if isinstance(scene.node, ast.Call):
        arguments = [scene.quoted(argument) for argument in scene.node.args]
        return Words(
            said(
                "{expression}() has no result for {arguments}",
                expression=ast.unparse(scene.node.func),
                arguments=", ".join(arguments),
            )
        )
    return Words("the function has no result for this value")


def _no_file(found: re.Match[str], _scene: Scene) -> Words:
    return Words(said("there is no file {name}", name=found[1]), "paths count from the task folder (--task-dir)")


def _said(text: str, hint: str = "") -> Callable[[re.Match[str], Scene], Words]:
    return lambda found, _scene: Words(found.expand(text), hint)


def _assertion(_found: re.Match[str], scene: Scene) -> Words:
    node = scene.node if isinstance(scene.node, ast.Assert) else scene.statement()
    condition = f": `{ast.unparse(node.test)}`" if isinstance(node, ast.Assert) else ""
    return Words(said("the condition of `assert` is not true{condition}", condition=condition))


_TABLE: Final[tuple[tuple[tuple[str, ...], str, Callable[[re.Match[str], Scene], Words]], ...]] = (
    (
        ("UnicodeDecodeError",),
        r"^'utf-8' codec can't decode byte",
        _said("the text is not UTF-8", 'files of a Chinese Windows are often GBK: open(name, encoding="gbk")'),
    ),
    (("ZeroDivisionError",), r"cannot be raised to a negative power", _said("0 has no negative power")),
    (("ZeroDivisionError",), r"(?:division|modulo|divmod\(\)).*", _division),
    (("TypeError",), r"^can only concatenate (\w+) \(not \"(\w+)\"\) to \w+$", _concatenation),
    (("TypeError",), r"^unsupported operand type\(s\) for (.+): '([\w.]+)' and '([\w.]+)'", _unsupported),
    (("TypeError",), r"^can't multiply sequence by non-int of type '(\w+)'$", _repetition),
    (("TypeError",), r"^'(<=?|>=?)' not supported between instances of '([\w.]+)' and '([\w.]+)'$", _comparison),
    (("TypeError",), r"^bad operand type for unary (.+): '([\w.]+)'$", _unary),
    (
        ("TypeError",),
        r"^([\w.<>]+)\(\) takes (?:from (\d+) to )?(\d+) positional arguments? but (\d+) (?:was|were) given$",
        _surplus,
    ),
    (("TypeError",), r"^([\w.<>]+)\(\) missing \d+ required (?:positional|keyword-only) arguments?: (.*)$", _missing),
    (("TypeError",), r"^([\w.<>]+)\(\) got an unexpected keyword argument '(\w+)'", _unexpected),
    (("TypeError",), r"^([\w.<>]+)\(\) got multiple values for (?:keyword )?argument '(\w+)'$", _twice),
    (("TypeError",), r"^'([\w.]+)' object is not callable", _not_callable),
    (("TypeError",), r"^'([\w.]+)' object is not subscriptable$", _not_subscriptable),
    (("TypeError",), r"^'([\w.]+)' object does(?: no|n')t support item (?:assignment|deletion)$", _fixed),
    (
        ("TypeError",),
        r"^(\w+) (?:indices must be integers(?: or slices)?|index must be integer), not '?(\w+)'?$",
        _wrong_index,
    ),
    (("TypeError",), r"^cannot unpack non-iterable ([\w.]+) object$", _not_unpackable),
    (("TypeError",), r"^argument of type '([\w.]+)' is not (?:iterable|a container or iterable)$", _not_a_container),
    (("TypeError",), r"^'([\w.]+)' object is not (?:iterable|a container or iterable)$", _not_iterable),
    (("TypeError",), r"^object of type '([\w.]+)' has no len\(\)$", _no_length),
    (("TypeError",), r"^(int|float)\(\) argument must be .*, not '([\w.]+)'$", _not_convertible),
    (
        ("TypeError",),
        r"unhashable type: '(\w+)'",
        _said(r"a \1 cannot be a key of a dict or an element of a set", "make a tuple of it: tuple(x)"),
    ),
    (
        ("TypeError",),
        r"^exceptions must derive from BaseException$",
        _said("`raise` takes an exception", 'write raise RuntimeError("text")'),
    ),
    (
        ("TypeError",),
        r"^not all arguments converted during string formatting$",
        _said("there are more values than places for them in the text", "each value needs its %s or %d"),
    ),
    (
        ("TypeError",),
        r"^not enough arguments for format string$",
        _said("there are fewer values than places for them in the text", "each %s or %d needs its value"),
    ),
    (
        ("TypeError",),
        r"^%(\w) format: a (?:real )?number is required, not (\w+)$",
        _said(r"%\1 takes a number, not a \2", "%s takes any value"),
    ),
    (("IndexError",), r"(?:index|assignment index) out of range$", _out_of_range),
    (("IndexError",), r"^pop from (?:an )?empty (\w+)$", _said(r"pop() takes an element from an empty \1")),
    (("KeyError",), r"(?s)^.*$", _key),
    (("ValueError",), r"^too many values to unpack \(expected (?P<expected>\d+)(?:, got (?P<got>\d+))?\)$", _unpacking),
    (
        ("ValueError",),
        r"^not enough values to unpack \(expected (?:at least )?(?P<expected>\d+), got (?P<got>\d+)\)$",
        _unpacking,
    ),
    (("ValueError",), r"(?s)^invalid literal for int\(\) with base \d+: (.*)$", _not_an_int),
    (("ValueError",), r"(?s)^could not convert string to float: (.*)$", _said(r"the text \1 is not a number")),
    (("ValueError",), r"^math domain error$|^expected a (?:nonnegative|positive|finite|number).*", _domain),
    (
        ("ValueError",),
        r"^(?:list\.(?:remove|index)\(x\): x|(.+) is) not in (list|tuple)$",
        _said(r"the value is not in the \2"),
    ),
    (
        ("ValueError",),
        r"^Exceeds the limit \((\d+) digits\) for integer string conversion(?:: value has (\d+) digits)?",
        _said(r"an int of more than \1 digits cannot be written as text, nor read from it", "compute with a float"),
    ),
    (
        ("OverflowError", "IndexError"),
        r"^(?:cannot fit 'int' into an index-sized integer|too many digits in integer"
        r"|Python int too large to convert to C (?:ssize_t|int|long).*)$",
        _said("the number is too large for this"),
    ),
    (
        ("OverflowError",),
        r"(?:Numerical result|math range error|int too large|too large)",
        _said("the result is too large for a float"),
    ),
    (("AttributeError",), r"^'([\w.]+)' object has no attribute '(\w+)'", _no_attribute),
    (("UnboundLocalError",), r"^cannot access local variable '(\w+)'", _no_value_yet),
    (("NameError",), r"^cannot access free variable '(\w+)'", _no_free_value),
    (("FileNotFoundError",), r"^\[Errno \d+\] No such file or directory: (.*)$", _no_file),
    (
        ("OSError", "FileExistsError", "IsADirectoryError", "NotADirectoryError", "PermissionError"),
        r"^\[Errno \d+\] (.*)$",
        _said(r"\1"),
    ),
    (
        ("RecursionError",),
        r"^maximum recursion depth exceeded(?! while (?:en|de)coding| while getting)",
        _said("functions call each other too deeply", "does the recursion have an end?"),
    ),
    (
        ("RecursionError",),
        r"^maximum recursion depth exceeded",
        _said("values are nested too deeply, or functions call each other too deeply"),
    ),
    (("AssertionError",), r"^$", _assertion),
)
