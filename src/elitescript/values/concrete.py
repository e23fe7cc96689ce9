"""Computes expressions without any effect: no code of the program runs, nothing waits, draws or prints.

The tree of the expression is computed node by node over values of built-in types. Attributes of a program's own objects
are read where they are stored. Everything that could run code of the program (its functions, operators of its classes)
or change something is refused with a text that says so. Used by the debugger, by the words of alarms, and by the
sentence that says why a thread does not go on.
"""

from __future__ import annotations

import ast
import builtins
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import islice
from types import WrapperDescriptorType
from typing import Any, Final

from elitescript.errors import DebugError, did_you_mean
from elitescript.language.builtin_names import PURE_BUILTINS
from elitescript.values.plain import BINARY, COMPARISONS, MEMBERSHIP, UNARY, NoExpression, tree_of

STEPS_MAX: Final = 200_000
"""Most nodes that one expression may take."""
CONDITION_STEPS_MAX: Final = 50_000
"""Most nodes that a condition may take, or what a data breakpoint watches: they are computed again and again."""
SIZE_MAX: Final = 1_000_000
"""Most elements of a text or list that an expression makes, and digits of a number."""

ROOM_MAX: Final = 20_000_000
"""Most elements of all texts and lists that it makes on its way."""

PLAIN: Final = frozenset(
    (
        *(bool, int, float, complex, str, bytes, bytearray, type(None), type(...), range, slice),
        *(list, tuple, dict, set, frozenset, type({}.keys()), type({}.values()), type({}.items())),
    )
)
_HOLDERS: Final = frozenset(
    (list, tuple, set, frozenset, type({}.keys()), type({}.values()), type({}.items())),
)

_COMPARE: Final = {**COMPARISONS, **MEMBERSHIP}

_MOST: Final = {
    **dict.fromkeys(("ljust", "rjust", "center", "zfill", "expandtabs", "to_bytes", "bytes", "bytearray"), SIZE_MAX),
    **dict.fromkeys(("factorial", "comb", "perm", "prod", "lcm", "round"), 10_000),
}
"""Largest number, and most elements, that are passed to functions whose result may be far larger."""

_WIDTH: Final = re.compile(r"%%|%[^a-zA-Z%]*")
"""Widths and precisions of a text with `%`."""
_MAKING: Final = (ast.BinOp, ast.Call, ast.JoinedStr)
_FILLED: Final = (str, bytes, bytearray, list, tuple)

_SHORT: Final = 100
"""Characters of a text of the user in a text that says what is wrong with it."""

_DIGITS: Final = "Exceeds the limit"
_LINE: Final = " (detected at line 1)"
"""Of what Python says."""

_FOREIGN: Final = "an operation with an object of the program"
_LARGE: Final = "it has more than {:,} elements"
_TOO_LARGE: Final = "the result would be too large"

_CALLABLE: Final = PURE_BUILTINS - {"id", "hash", "type", "format"}
"""Functions whose result is the same in every run."""
_OF_PYTHON_2: Final = {"long": "int", "unichr": "chr"}

_CONVERSIONS: Final[dict[str, Callable[[Any], str]]] = {"r": repr, "s": str, "a": ascii}

_CHANGING_METHODS: Final = frozenset(
    """
    add append clear difference_update discard extend insert intersection_update pop popitem remove reverse setdefault
    sort symmetric_difference_update update format format_map
    """.split()  # noqa: SIM905
)

_GROWING_METHODS: Final = frozenset(("join", "replace", "translate"))
"""Methods whose result can be as large as the product of what they are given."""

_SCALARS: Final = frozenset((bool, int, float, complex, str, bytes, bytearray, type(None), type(...), range))
_TEXTS: Final = (str, bytes, bytearray)

Call = Callable[[str, tuple[Any, ...], dict[str, Any]], Any]


class MissingName(DebugError):
    """A name that nothing has where an expression is computed.

    Args:
        name: that is missing.
        known: returns the names that there are.
    """

    def __init__(self, name: str, known: Callable[[], Iterable[str]]) -> None:
        super().__init__(f"there is no variable {short(name)!r} here")
        self._name = name
        self._known = known

    def near(self) -> str:
        """Return the most similar name as a question; empty if none is similar."""
        return did_you_mean(self._name, self._known())


class TooLong(DebugError):
    """An expression that takes more steps than it may."""


class Refusal(DebugError):
    """Something that an expression may not do, since it is only looked at.

    Args:
        reason: what it is, and why.

    Attributes:
        reason: the same.
    """

    def __init__(self, reason: str) -> None:
        super().__init__(f"refused: {reason}; allow changes to run it")
        self.reason = reason


@lru_cache(maxsize=64)
def parsed(text: str) -> ast.expr:
    """Return the tree of an expression; it is not changed. A condition is asked for again and again.

    Raises:
        DebugError: it is none.
    """
    try:
        return tree_of(text.strip(), None, None)
    except NoExpression as error:
        reason = "it cannot be read" if error.place is None else _reason(error)
        raise DebugError(f"{short(text)!r} is no expression: {reason}") from None


def short(text: str) -> str:
    """Return a text of the user as one line, cut."""
    line = " ".join(text.split())
    return line if len(line) <= _SHORT else f"{line[:_SHORT]}…"


def variables_of(tree: ast.expr) -> frozenset[str]:
    """Return the names of variables that an expression reads: not of functions that it calls, nor its own ones."""
    names = [node for node in ast.walk(tree) if isinstance(node, ast.Name)]
    called = {id(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)}
    own = {node.id for node in names if not isinstance(node.ctx, ast.Load)}
    return frozenset(node.id for node in names if id(node) not in called) - own


def computed(
    tree: ast.AST, names: Callable[[str], Any], call: Call, steps_max: int = STEPS_MAX, size_max: int = SIZE_MAX
) -> Any:
    """Return the value of an expression.

    Args:
        tree: of the expression.
        names: returns the value of a name.
        call: calls a predefined function or command by its name, or refuses.
        steps_max: most nodes that it may take.
        size_max: most elements of a list or dict that are gone through.

    Raises:
        DebugError: it has no value, or is refused.
    """
    try:
        return _Computation(names, call, steps_max, size_max).value(tree)
    except DebugError:
        raise
    except RecursionError:
        raise DebugError("the expression is nested too deeply") from None
    except Exception as error:
        raise DebugError(f"{type(error).__name__}: {_reason(error)}") from None


class Unknown:
    """Stands for a value that is not known without running the program."""


UNKNOWN: Final = Unknown()
GLANCE_STEPS_MAX: Final = 500
GLANCE_SIZE_MAX: Final = 1_000
"""Most nodes, and most elements of a list, for the values of a sentence; made within a tick, beside a running robot."""


def glance(tree: ast.AST | None, names: Mapping[str, Any]) -> Any:
    """Return the value of an expression if it is known where its variables have these values; else `UNKNOWN`.

    Args:
        tree: of the expression; of anything else nothing is known.
        names: variables with their values.
    """

    def value(name: str) -> Any:
        if name not in names:
            raise MissingName(name, names.keys)
        return names[name]

    def call(name: str, arguments: tuple[Any, ...], named: dict[str, Any]) -> Any:
        if name in names:
            raise Refusal(name)
        return builtin_call(name, arguments, named)

    try:
        return UNKNOWN if tree is None else computed(tree, value, call, GLANCE_STEPS_MAX, GLANCE_SIZE_MAX)
    except DebugError:
        return UNKNOWN


def builtin_call(name: str, arguments: tuple[Any, ...], named: dict[str, Any]) -> Any:
    """Return the result of a built-in function that only gives a value.

    Raises:
        DebugError: there is none of that name, or it would take too long.
    """
    if name not in _CALLABLE:
        raise DebugError(f"refused: there is no function {name}() that only gives a value")
    if name != "len" and any(hasattr(value, "__len__") and len(value) > SIZE_MAX for value in arguments):
        raise DebugError(_TOO_LARGE)
    made = getattr(builtins, _OF_PYTHON_2.get(name, name))(*arguments, **named)
    return made if is_plain(made) else list(made)


def _reason(error: Exception) -> str:
    """Return what Python says, but for what helps nobody here."""
    text = str(error)
    return "a number has too many digits" if text.startswith(_DIGITS) else text.removesuffix(_LINE)


def is_plain(value: Any) -> bool:
    """Return whether a value, with all that it holds, is of built-in types, so that its operators run no program."""
    return _why_not_plain(value) == ""


def truth(value: Any) -> bool:
    """Return whether a value counts as true, without running code of the program.

    Raises:
        DebugError: a class of the program decides that.
    """
    if isinstance(value, Indexed | Pure):
        raise DebugError("it is a group: name one of it")
    for name in ("__bool__", "__len__"):
        for kind in type.__dict__["__mro__"].__get__(type(value)):
            held = type.__dict__["__dict__"].__get__(kind)
            if name in held:
                if type(held[name]) is not WrapperDescriptorType:
                    raise _refused(f"{name} of {type.__dict__['__name__'].__get__(kind)}")
                return bool(value)
    return True


def _why_not_plain(value: Any, size_max: int = SIZE_MAX) -> str:
    """Return why operators of a value might run code of the program, or take too long; empty if they do not."""
    stack, left, seen = [value], size_max, set()
    while stack:
        item = stack.pop()
        kind = type(item)
        if kind not in PLAIN:
            return _FOREIGN
        if kind is slice:
            stack += (item.start, item.stop, item.step)
        elif kind in _HOLDERS or kind is dict:
            if id(item) in seen:
                continue
            seen.add(id(item))
            left -= len(item)
            if left < 0:
                return _LARGE
            for part in (item.values(), item) if kind is dict else (item,):
                # One pass without a step of Python for each element: most of them are numbers or texts.
                if not _SCALARS.issuperset(map(type, part)):
                    stack += [held for held in part if type(held) not in _SCALARS]
    return ""


class _Computation:
    """Computes one expression."""

    __slots__ = ("_call", "_left", "_names", "_own", "_room", "_size_max")

    def __init__(self, names: Callable[[str], Any], call: Call, steps_max: int, size_max: int) -> None:
        self._names = names
        self._call = call
        self._size_max = size_max
        self._own: dict[str, Any] = {}
        self._left = steps_max
        self._room = ROOM_MAX

    def value(self, node: ast.AST) -> Any:
        """Return the value of a part."""
        self._left -= 1
        if self._left < 0:
            raise TooLong("the expression takes too long")
        compute = getattr(self, f"_{type(node).__name__}", None)
        if compute is None:
            raise Refusal(f"{_described(node)} may change something")
        made = compute(node)
        if isinstance(node, _MAKING) and type(made) in _FILLED:
            self._room -= len(made)
            if self._room < 0:
                raise DebugError("the expression takes too much memory")
        return made

    def _plain(self, node: ast.expr) -> Any:
        return self._checked(self.value(node))

    def _held(self, node: ast.expr) -> Any:
        """Return the value of a part that something else holds or gets."""
        value = self.value(node)
        return list(value.whole) if isinstance(value, Indexed) and value.whole is not None else value

    def _checked(self, value: Any) -> Any:
        """Return a value whose operators run no code of the program; refuse any other."""
        if type(value) in PLAIN:
            if type(value) is range and value and abs((value[-1] - value[0]) // value.step) > SIZE_MAX:
                raise DebugError("the range is too long")
            why_not = _why_not_plain(value, self._size_max)
            if why_not == _LARGE:
                raise DebugError(_LARGE.format(self._size_max))
            if not why_not:
                return value
        elif isinstance(value, Indexed):
            if value.whole is not None:
                return list(value.whole)
            raise DebugError("it needs an index in brackets")
        raise _refused(_FOREIGN)

    def _counted(self, value: Any) -> Any:
        """Return a value; refuse one that has too many elements to go through, such as a long range."""
        if hasattr(value, "__len__") and len(value) > (SIZE_MAX if type(value) in _TEXTS else self._size_max):
            raise DebugError(_TOO_LARGE)
        return value

    # ---------------------------------------------------------------- nodes

    def _Constant(self, node: ast.Constant) -> Any:
        return node.value

    def _Name(self, node: ast.Name) -> Any:
        return self._own[node.id] if node.id in self._own else self._names(node.id)

    def _Tuple(self, node: ast.Tuple) -> Any:
        return tuple(self._items(node.elts))

    def _List(self, node: ast.List) -> Any:
        return self._items(node.elts)

    def _Set(self, node: ast.Set) -> Any:
        return set(self._checked(self._items(node.elts)))

    def _items(self, nodes: list[ast.expr]) -> list[Any]:
        items: list[Any] = []
        for node in nodes:
            if isinstance(node, ast.Starred):
                items += self._counted(self._plain(node.value))
            else:
                items.append(self._held(node))
        return items

    def _Dict(self, node: ast.Dict) -> Any:
        made: dict[Any, Any] = {}
        for key, value in zip(node.keys, node.values, strict=True):
            if key is None:
                made.update(self._plain(value))
            else:
                made[self._plain(key)] = self._held(value)
        return made

    def _BinOp(self, node: ast.BinOp) -> Any:
        left, right = self._plain(node.left), self._plain(node.right)
        _refuse_too_large(node.op, left, right)
        return BINARY[type(node.op)](left, right)

    def _UnaryOp(self, node: ast.UnaryOp) -> Any:
        return UNARY[type(node.op)](self._plain(node.operand))

    def _BoolOp(self, node: ast.BoolOp) -> Any:
        value = None
        for operand in node.values:
            value = self._plain(operand)
            if bool(value) is isinstance(node.op, ast.Or):
                return value
        return value

    def _IfExp(self, node: ast.IfExp) -> Any:
        return self.value(node.body if self._plain(node.test) else node.orelse)

    def _Compare(self, node: ast.Compare) -> Any:
        left = self.value(node.left)
        for sign, comparator in zip(node.ops, node.comparators, strict=True):
            right = self.value(comparator)
            if isinstance(sign, ast.Is | ast.IsNot):
                is_true: Any = (left is right) is isinstance(sign, ast.Is)
            else:
                first, second = self._checked(left), self._checked(right)
                if isinstance(sign, ast.In | ast.NotIn) and type(left) not in (int, bool):
                    self._counted(right)  # a range is searched for it, number by number
                is_true = _COMPARE[type(sign)](first, second)
            if not is_true:
                return is_true
            left = right
        return True

    def _Subscript(self, node: ast.Subscript) -> Any:
        holder = self.value(node.value)
        key = self._plain(node.slice)
        if isinstance(holder, Indexed):
            return holder.at(key)
        if type(holder) not in PLAIN:
            raise _refused("the brackets of an object")
        return self._entry(holder, key) if type(holder) is dict else holder[key]

    def _entry(self, holder: dict[Any, Any], key: Any) -> Any:
        """Return an entry, without comparing the key with an object of the program's classes."""
        if not _why_not_plain(holder.keys(), self._size_max):
            return holder[key]
        for held in islice(holder, self._size_max):
            if type(held) in _SCALARS and held == key:
                return holder[held]
        raise _refused(_FOREIGN)

    def _Slice(self, node: ast.Slice) -> Any:
        return slice(*(None if part is None else self._plain(part) for part in (node.lower, node.upper, node.step)))

    def _Attribute(self, node: ast.Attribute) -> Any:
        return stored_attribute(self.value(node.value), node.attr)

    def _JoinedStr(self, node: ast.JoinedStr) -> Any:
        return "".join(str(self.value(part)) for part in node.values)

    def _FormattedValue(self, node: ast.FormattedValue) -> Any:
        value = self._plain(node.value)
        form = "" if node.format_spec is None else self.value(node.format_spec)
        if any(int(number) > SIZE_MAX for number in _numbers(form)):
            raise DebugError("the text would be too long")
        if node.conversion >= 0:
            value = _CONVERSIONS[chr(node.conversion)](value)
        return format(value, form)

    def _ListComp(self, node: ast.ListComp) -> Any:
        return list(self._passes(node.generators, node.elt))

    _GeneratorExp = _ListComp

    def _SetComp(self, node: ast.SetComp) -> Any:
        return set(self._checked(list(self._passes(node.generators, node.elt))))

    def _DictComp(self, node: ast.DictComp) -> Any:
        pair = ast.Tuple([node.key, node.value], ast.Load())
        return {self._checked(key): value for key, value in self._passes(node.generators, pair)}

    def _passes(self, generators: list[ast.comprehension], element: ast.expr) -> Iterator[Any]:
        if not generators:
            yield self._held(element)
            return
        first, *rest = generators
        before = dict(self._own)
        for item in self._plain(first.iter):
            self._bind(first.target, item)
            if all(self._plain(condition) for condition in first.ifs):
                yield from self._passes(rest, element)
        self._own = before

    def _bind(self, target: ast.expr, value: Any) -> None:
        if isinstance(target, ast.Name):
            self._own[target.id] = value
        elif isinstance(target, ast.Tuple | ast.List):
            for part, item in zip(target.elts, self._checked(value), strict=True):
                self._bind(part, item)
        else:
            raise _refused("an assignment")

    def _Call(self, node: ast.Call) -> Any:
        function = node.func
        arguments = tuple(self._items(node.args))
        if _is_len(function) and not node.keywords and "len" not in self._own and _are_plain_holders(arguments):
            # Asks for no element, however many there are.
            return self._call("len", arguments, {})
        named: dict[str, Any] = {}
        for keyword in node.keywords:
            if keyword.arg is None:
                named.update(self._plain(keyword.value))
            else:
                named[keyword.arg] = self._held(keyword.value)
        for value in (*arguments, *named.values()):
            self._counted(self._checked(value))
        if isinstance(function, ast.Name):
            if function.id in self._own:
                raise _refused(f"{function.id}()")
            _refuse_too_long(function.id, arguments, named)
            return self._call(function.id, arguments, named)
        if not isinstance(function, ast.Attribute):
            raise _refused("a call")
        holder = self.value(function.value)
        if isinstance(holder, Pure):
            _refuse_too_long(function.attr, arguments, named)
            return holder.function(function.attr)(*arguments, **named)
        kind = type(holder)
        if kind not in PLAIN or function.attr.startswith("_") or function.attr in _CHANGING_METHODS:
            raise _refused(f"{function.attr}()")
        self._counted(self._checked(holder))
        _refuse_too_long(function.attr, arguments, named)
        if function.attr in _GROWING_METHODS:
            largest = max(map(_size_of, (*arguments, *named.values())), default=0)
            if _size_of(holder) * largest > SIZE_MAX:
                raise DebugError(_TOO_LARGE)
        return getattr(holder, function.attr)(*arguments, **named)


class Indexed:
    """Something that has values by index, such as the points of a family of signals.

    Args:
        at: returns the value at an index.
        whole: the values, if there is a use for all of them together: `max(q)`.
        names: names of the values: `tcp.z`.
    """

    __slots__ = ("at", "names", "whole")

    def __init__(
        self, at: Callable[[Any], Any], whole: tuple[Any, ...] | None = None, names: Sequence[str] = ()
    ) -> None:
        self.at = at
        self.whole = whole
        self.names = names


class Pure:
    """A module whose functions only compute.

    Args:
        names: what it holds.
    """

    __slots__ = ("_names",)

    def __init__(self, names: dict[str, Any]) -> None:
        self._names = names

    def function(self, name: str) -> Any:
        """Return a function or a number by name.

        Raises:
            DebugError: there is none.
        """
        if name.startswith("_") or name not in self._names:
            raise DebugError(f"there is no {name!r} in the module")
        return self._names[name]


def stored_attribute(value: Any, name: str) -> Any:
    """Return an attribute without running code of the program.

    Raises:
        DebugError: there is none, or reading it would run code.
    """
    if name.startswith("_"):
        raise DebugError(f"{name!r} cannot be read")
    if isinstance(value, Pure):
        return value.function(name)
    if isinstance(value, Indexed) and name in value.names:
        return value.at(value.names.index(name))
    if type(value) in PLAIN:
        if name in ("real", "imag", "start", "stop", "step") and hasattr(value, name):
            return getattr(value, name)
        raise DebugError(f"{name!r} of a {type(value).__name__} can only be called")
    fields = own_fields(value)
    if name in fields:
        return fields[name]
    for kind in type.__dict__["__mro__"].__get__(type(value)):
        held = type.__dict__["__dict__"].__get__(kind)
        if name in held:
            if type(held[name]) in PLAIN:
                return held[name]
            raise _refused(f"reading {name}")
    raise DebugError(f"there is no attribute {name!r}")


def own_fields(value: Any) -> dict[str, Any]:
    """Return what an object of a program's class holds, without running its code."""
    try:
        fields = object.__getattribute__(value, "__dict__")
    except (AttributeError, TypeError):
        return {}
    return fields if type(fields) is dict else {}


def _is_len(function: ast.expr) -> bool:
    return isinstance(function, ast.Name) and function.id == "len"


def _are_plain_holders(arguments: tuple[Any, ...]) -> bool:
    return len(arguments) == 1 and type(arguments[0]) in PLAIN


def _refused(what: str) -> Refusal:
    return Refusal(f"{what} may run code of the program")


def _described(node: ast.AST) -> str:
    return {"Lambda": "a function", "NamedExpr": "an assignment", "Await": "await"}.get(type(node).__name__, "this")


def _refuse_too_large(sign: ast.operator, left: Any, right: Any) -> None:
    """Refuse operations whose result could fill the memory."""
    if isinstance(sign, ast.Pow) and isinstance(left, int) and isinstance(right, int) and right > 0:
        size = left.bit_length() * right
    elif isinstance(sign, ast.LShift) and isinstance(left, int) and isinstance(right, int):
        size = left.bit_length() + right
    elif isinstance(sign, ast.Mult):
        holder, times = (left, right) if hasattr(left, "__len__") else (right, left)
        size = len(holder) * times if hasattr(holder, "__len__") and isinstance(times, int) else 0
    elif isinstance(sign, ast.Mod) and isinstance(left, str | bytes):
        form = " ".join(_WIDTH.findall(left if isinstance(left, str) else left.decode("latin-1")))
        size = SIZE_MAX + 1 if "*" in form else max((int(number) for number in _numbers(form)), default=0)
    else:
        return
    if size > SIZE_MAX:
        raise DebugError(_TOO_LARGE)


def _refuse_too_long(name: str, arguments: tuple[Any, ...], named: dict[str, Any]) -> None:
    """Refuse calls whose result or time grows with the value of a number: nothing could end them."""
    if name == "pow" and len(arguments) + len(named) == 2:
        _refuse_too_large(ast.Pow(), *arguments, *named.values())
    values = [*(arguments[1:] if name == "round" else arguments), *named.values()]
    most = _MOST.get(name)
    if most is not None and any(
        (isinstance(value, int) and abs(value) > most) or (hasattr(value, "__len__") and len(value) > most)
        for value in values
    ):
        raise DebugError(_TOO_LARGE)


def _size_of(value: Any) -> int:
    """Return the number of elements of a value, those of its texts included."""
    if type(value) is dict:
        value = list(value.values())
    if type(value) in _HOLDERS:
        return len(value) + sum(len(item) for item in value if isinstance(item, str | bytes | bytearray))
    return len(value) if isinstance(value, str | bytes | bytearray) else 0


def _numbers(form: str) -> list[str]:
    return [word for word in "".join(sign if sign.isdigit() else " " for sign in form).split() if word]
