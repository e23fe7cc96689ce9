"""Reads expressions: checks names, kinds and units of every part, with its place, and makes what computes it.

One pass over the tree of `ast`. Nothing of the text is ever run: what is not in the tables is refused.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection, Sequence
from math import isfinite
from typing import Any, Final, NoReturn

from elitescript.errors import UsageError, did_you_mean
from elitescript.language.advice.expression_slips import plain_word
from elitescript.messages.signals import SIGNALS, Signal, parse_signal_name, signal_name
from elitescript.properties import over_time
from elitescript.properties.functions import DIGITS_MAX, EXPONENT_MAX, FUNCTIONS, powered
from elitescript.properties.names import CONSTANTS, COUNTED, INSTEAD, LISTS, OVER_TIME, RECORD, TEXTS
from elitescript.properties.over_time import FUNCTIONS_OVER_TIME, Part, keys_over_time, part_of
from elitescript.properties.pieces import (
    ANY,
    LEVEL,
    LIST,
    NONE,
    NUMBER,
    NUMBERS,
    SIZED,
    TABLE,
    TEXT,
    TRUTH,
    Margin,
    MarginKey,
    Piece,
    Value,
    all_of,
    any_of,
    greatest,
    keys_of,
    least,
    margin_of,
    number,
    opposite,
    shown,
    truth,
)
from elitescript.properties.places import located, wrong_at
from elitescript.properties.units import Unit, UnitsDiffer, common, power, product, unit, unit_text
from elitescript.properties.verdicts import NOTHING, Needs, Undefined, plain
from elitescript.records import NamedTuple
from elitescript.run import EXIT_CODES
from elitescript.values.places import PLACES, signal_at
from elitescript.values.plain import BINARY, COMPARISONS, TEXT_MAX, NoExpression
from elitescript.values.plain import tree_of as expression

_ENDS: Final = Needs(line=True)
"""What shows few moments, but the first and the last."""


class OverTimeCall(NamedTuple):
    """A call of a function over time in an expression."""

    name: str
    parts: tuple[Part, ...]
    text: str


class Side(NamedTuple):
    """One side of a comparison outside functions over time."""

    text: str
    value: Value


class Clause(NamedTuple):
    """One of the parts that `and` joins at the top of an expression, or the whole."""

    piece: Piece
    calls: range
    """Indices of its functions over time."""
    sides: tuple[Side, ...]
    """What it compares, for people; without functions over time and literals."""


class Parsed(NamedTuple):
    """A checked expression."""

    text: str
    piece: Piece
    calls: tuple[OverTimeCall, ...]
    clauses: tuple[Clause, ...]
    needs: Needs


class Record:
    """What the closures of an expression read: the record of a run, and what its functions over time came to."""

    __slots__ = ("over_time", "run")

    def __init__(self, run: Any, watched: Sequence[over_time.Watched]) -> None:
        self.run = run
        self.over_time = watched


def one_line(text: str) -> str:
    """Return an expression without blanks around it; line ends are blanks."""
    return text.replace("\r", " ").replace("\n", " ").strip()


def tree_of(text: str) -> ast.expr:
    """Return the tree of an expression of one line.

    Raises:
        UsageError: it is none.
    """
    if not text:
        raise UsageError("write an expression, such as 'time_s < 20', not ''")
    for index, char in enumerate(text):
        if char == "\0" or "\ud800" <= char <= "\udfff":
            raise located("?" * len(text), index, index + 1, "this is no character")
    try:
        return expression(text)
    except NoExpression as error:
        if error.node is not None:
            raise wrong_at(text, error.node, error.text) from None
        if error.place is None:
            raise UsageError(f"this is no expression: {error}" if len(text) <= TEXT_MAX else error.text) from None
        start, end = error.place
        name = text[:start].strip()
        is_global = text[start:end] == "=" and name.isidentifier() and name not in RECORD
        raise located(
            text, start, end, f'write globals["{name}"] == ...: `==` compares' if is_global else error.text
        ) from None


def parse(text: str, program_globals: Collection[str] | None = None) -> Parsed:
    """Check an expression.

    Args:
        text: as written.
        program_globals: names of the globals that the program has; any name is taken if None.

    Raises:
        UsageError: it is no expression; with the place.
    """
    text = one_line(text)
    return _Reader(text, program_globals).parsed(tree_of(text))


class _Reader:
    """Reads one expression."""

    __slots__ = ("_calls", "_globals", "_is_over_time", "_needs", "_sides", "_text")

    def __init__(self, text: str, program_globals: Collection[str] | None) -> None:
        self._text = text
        self._globals = program_globals
        self._calls: list[OverTimeCall] = []
        self._sides: list[Side] = []
        self._needs = NOTHING
        self._is_over_time = False

    def parsed(self, body: ast.expr) -> Parsed:
        """Check the whole."""
        if isinstance(body, ast.BoolOp) and isinstance(body.op, ast.And):
            clauses = [self._clause(part) for part in body.values]
            piece = self._joined(body, [self.as_truth(clause.piece) for clause in clauses])
        else:
            clauses = [self._clause(body)]
            piece = clauses[0].piece
        # A function over time that names nothing, as `duration(True)`, sees the first moment and the last.
        needs = _ENDS if self._calls and self._needs.nothing else self._needs
        return Parsed(self._text, piece, tuple(self._calls), tuple(clauses), needs)

    def _clause(self, node: ast.expr) -> Clause:
        calls, sides = len(self._calls), len(self._sides)
        piece = self.read(node)
        return Clause(piece, range(calls, len(self._calls)), tuple(self._sides[sides:]))

    # ---------------------------------------------------------------- parts

    def read(self, node: ast.expr) -> Piece:
        """Check a part."""
        return _READERS.get(type(node), _Reader._not_possible)(self, node)

    def _wrong(self, node: ast.AST | None, message: str) -> UsageError:
        return wrong_at(self._text, node, message)

    def _part_text(self, node: ast.AST) -> str:
        return " ".join((ast.get_source_segment(self._text, node) or self._text).split())

    def _not_possible(self, node: ast.expr) -> NoReturn:
        what, instead = _NOT_POSSIBLE.get(type(node), ("this", ""))
        raise self._wrong(node, f"{what} is not possible here{instead}")

    def _constant(self, node: ast.Constant) -> Piece:
        value = node.value
        kind = {bool: TRUTH, int: NUMBER, float: NUMBER, str: TEXT, type(None): NONE}.get(type(value))
        if kind is None:
            raise self._wrong(node, "this is neither a number nor a text")
        if type(value) is float and not isfinite(value):
            raise self._wrong(node, "this number is too large")
        return Piece(node, kind, lambda x: value, constant=value)

    def _name(self, node: ast.Name) -> Piece:
        name = node.id
        if name in CONSTANTS:
            value = CONSTANTS[name]
            return Piece(node, NUMBER, lambda x: value, constant=value)
        if self._is_over_time and name in OVER_TIME:
            over = OVER_TIME[name]
            self._needs = self._needs.with_those_of(over.needs)
            return Piece(node, over.kind, over.value, over.unit, items=over.items)
        if not self._is_over_time and name in RECORD:
            return self._of_record(node, name)
        if (level := self._level_at(node)) is not None:
            return level
        raise self._unknown_name(node, name)

    def _level_at(self, node: ast.expr) -> Piece | None:
        """Return the level of the signal that a part names, as `flag[0]`; None if it names none."""
        is_point = isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name) and node.value.id in SIGNALS
        try:
            found = signal_at(node, has_lists=not is_point)
        except UsageError as error:
            raise self._wrong(node, str(error)) from None
        return None if found is None else self._level(node, *found)

    def _level(self, node: ast.expr, row: Signal, index: int) -> Piece:
        """Return the level of a signal: over time, or at the end of the run."""
        name = signal_name(row, index)
        units = row.unit.split(", ")
        its_unit = "" if " or " in row.unit else units[0] if len(units) == 1 or index < _FORCES else units[1]
        kind, of = LEVEL if row.kind == "bool" else NUMBER, unit(its_unit.replace("1/s", ""))
        if not self._is_over_time:
            return Piece(node, kind, lambda x: x.run.signals[name], of)
        self._needs = self._needs.with_those_of(Needs(signals=frozenset({name})))
        return Piece(node, kind, lambda m: m.levels[name], of)

    def _of_record(self, node: ast.Name, name: str) -> Piece:
        row = RECORD[name]
        get = row.value
        if row.kind == TABLE and row.keys is None:
            # `globals` and `signals` by themselves: for `len` and `in`.
            return Piece(node, row.kind, lambda x: dict.fromkeys(get(x.run)), keys={})
        if name in TEXTS:
            return Piece(node, row.kind, lambda x: get(x.run), keys={})
        return Piece(node, row.kind, lambda x: get(x.run), row.unit, items=row.items, keys=row.keys)

    def _attribute(self, node: ast.Attribute) -> Piece:
        """Check `findings.warning`; a dot behind anything else is refused with the form that is meant."""
        name = node.value.id if isinstance(node.value, ast.Name) else ""
        if name == "findings" and not self._is_over_time:
            key = ast.copy_location(ast.Constant(node.attr), node)
            return self._subscript(ast.copy_location(ast.Subscript(node.value, key, ast.Load()), node))
        if name == "signals" and node.attr in SIGNALS:
            raise self._wrong(node, f"write {self._signal_example(node.attr)}")
        if name in ("globals", "signals"):
            raise self._wrong(node, f'write {name}["{node.attr}"]')
        if name == "run" and node.attr in RECORD:
            raise self._wrong(node, f"write {node.attr} alone, without `run.`")
        elements = self._elements(name)
        if node.attr in elements:
            index = ast.copy_location(ast.Constant(elements.index(node.attr)), node)
            return self._subscript(ast.copy_location(ast.Subscript(node.value, index, ast.Load()), node))
        if elements:
            raise self._wrong(node, f"{name} has {', '.join(elements)}")
        return self._not_possible(node)

    def _elements(self, name: str) -> tuple[str, ...]:
        """Return the names of the elements of a place; none if a name is none."""
        place = PLACES.get(_PLACES_AT_END.get(name, name))
        return () if place is None else place.elements

    def _unknown_name(self, node: ast.AST, name: str) -> UsageError:
        """Return the refusal of a name."""
        if self._globals is not None and name in self._globals and not self._is_over_time:
            return self._wrong(node, f'{name!r} is a global of the program: write globals["{name}"]')
        if name in OVER_TIME:
            return self._wrong(node, f"{name!r} is there inside functions over time alone, such as always(...)")
        if self._is_over_time and name in RECORD:
            instead = f": write {INSTEAD[name]}" if name in INSTEAD else ""
            return self._wrong(node, f"{name!r} is known at the end of the run, not over time{instead}")
        if name in FUNCTIONS or name in FUNCTIONS_OVER_TIME or name in ("len", "signal"):
            return self._wrong(node, f"{name!r} is a function: call it, as {name}(...)")
        if word := plain_word(name) or (f'"{name}"' if name in EXIT_CODES else ""):
            return self._wrong(node, f"write {word}")
        if name in COUNTED and not self._is_over_time:
            return self._wrong(node, f"nothing is called {name!r}: write findings.{COUNTED[name]}")
        known = (*(OVER_TIME if self._is_over_time else RECORD), *CONSTANTS)
        near = did_you_mean(name, known)
        of_program = "" if near or self._is_over_time else f'; a global of the program is globals["{name}"]'
        return self._wrong(node, f"nothing is called {name!r}{near or '; there are ' + ', '.join(known)}{of_program}")

    def _signal_example(self, family: str) -> str:
        name = signal_name(SIGNALS[family], 0)
        return f'signal("{name}")' if self._is_over_time else f'signals["{name}"]'

    # ---------------------------------------------------------------- subscripts

    def _subscript(self, node: ast.Subscript) -> Piece:
        if isinstance(node.value, ast.Name) and not self._is_over_time and node.value.id in ("globals", "signals"):
            return (self._global if node.value.id == "globals" else self._signal_named)(node, node.slice)
        if (level := self._level_at(node)) is not None:
            return level
        whole = self.read(node.value)
        index = self._index(node.slice)
        get, what = whole.value, self._part_text(node.value)
        if whole.kind not in (LIST, TABLE, ANY, TEXT):
            raise self._wrong(node.value, f"this is {whole.kind}, which has no parts")
        if whole.items is not None:
            count = len(whole.items)
            if type(index) is not int or not -count <= index < count:
                raise self._wrong(node.slice, f"{what} has indices 0 to {count - 1}")
            item = whole.items[index]
            place = index
            return Piece(node, item.kind, lambda x: _at(get(x), place, what), item.unit)
        if whole.kind == TABLE and whole.keys is not None:
            if index not in whole.keys:
                near = did_you_mean(str(index), whole.keys)
                raise self._wrong(
                    node.slice, f"there is no {index!r} here{near or '; there are ' + ', '.join(whole.keys)}"
                )
            kind, its_unit = whole.keys[str(index)]
            return Piece(node, kind, lambda x: _at(get(x), index, what), its_unit)
        if whole.kind in (LIST, TEXT) and type(index) is not int:
            raise self._wrong(node.slice, f"{what} is {whole.kind}: write the index as a number")
        if whole.kind == TEXT or whole.keys == {}:
            return Piece(node, TEXT, lambda x: _at(get(x), index, what))
        if whole.keys is not None:
            return Piece(node, TABLE, lambda x: _at(get(x), index, what), keys=whole.keys)
        return Piece(node, ANY, lambda x: _at(get(x), index, what))

    def _index(self, node: ast.expr) -> int | str:
        """Return an index: a literal."""
        match node:
            case ast.Constant(value=int() | str() as value) if type(value) is not bool:
                return value
            case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=int() as value)) if type(value) is not bool:
                return -value
        raise self._wrong(node, "write the index as a number, or a name as a text")

    def _global(self, node: ast.Subscript, index: ast.expr) -> Piece:
        name = self._index(index)
        if type(name) is not str:
            raise self._wrong(index, 'write the name of the global as a text, such as globals["count"]')
        if self._globals is not None and name not in self._globals:
            near = did_you_mean(name, self._globals)
            there = f"; there are {', '.join(sorted(self._globals))}" if self._globals else "; it has none"
            raise self._wrong(index, f"the program has no global {name!r}{near or there}")

        def value(x: Record) -> Any:
            values = x.run.globals
            if name not in values:
                raise Undefined(f"global {name!r} has no value")
            try:
                return plain(values[name])
            except Undefined as error:
                raise Undefined(f"global {name!r}: {error}") from None

        return Piece(node, ANY, value)

    def _signal_named(self, node: ast.expr, name: ast.expr) -> Piece:
        """Return the level of the signal that a literal names."""
        if not isinstance(name, ast.Constant) or not isinstance(name.value, str):
            raise self._wrong(name, 'write the name of the signal as a text, such as "standard_digital_out[0]"')
        try:
            row, index = parse_signal_name(name.value)
        except UsageError as error:
            raise self._wrong(name, str(error)) from None
        return self._level(node, row, index)

    # ---------------------------------------------------------------- true or false

    def truth(self, node: ast.expr) -> Piece:
        """Check a part that must be true or false."""
        piece = self.read(node)
        return self.as_truth(piece)

    def as_truth(self, piece: Piece) -> Piece:
        """Return a part as one that is true or false."""
        if piece.kind == TRUTH:
            return piece
        get = piece.value
        if piece.kind == LEVEL:
            return piece._replace(kind=TRUTH, value=lambda x: bool(get(x)))
        if piece.kind == ANY:
            what = self._part_text(piece.node)
            return piece._replace(kind=TRUTH, value=lambda x: truth(get(x), what))
        raise self._wrong(piece.node, f"this is {piece.kind}, not true or false: compare it with something")

    def _bool_op(self, node: ast.BoolOp) -> Piece:
        return self._joined(node, [self.truth(value) for value in node.values])

    def _joined(self, node: ast.BoolOp, pieces: Sequence[Piece]) -> Piece:
        """Return `a and b and ...`, or `a or b or ...`."""
        is_and = isinstance(node.op, ast.And)
        combined = least if is_and else greatest
        margins = {key: combined([margin_of(piece, key) for piece in pieces]) for key in keys_of(pieces)}
        return Piece(node, TRUTH, (all_of if is_and else any_of)([piece.value for piece in pieces]), margins=margins)

    def _unary_op(self, node: ast.UnaryOp) -> Piece:
        if isinstance(node.op, ast.Not):
            piece = self.truth(node.operand)
            get = piece.value
            margins = {key: opposite(margin) for key, margin in piece.margins.items()}
            return Piece(node, TRUTH, lambda x: not get(x), margins=margins)
        if isinstance(node.op, ast.Invert):
            raise self._wrong(node, "~ is not possible here; write not")
        piece = self.number(node.operand)
        get = piece.value
        if isinstance(node.op, ast.UAdd):
            return piece._replace(node=node)
        if piece.is_literal:
            constant = -piece.constant
            return Piece(node, NUMBER, lambda x: constant, piece.unit, constant=constant)
        return Piece(node, NUMBER, lambda x: -get(x), piece.unit)

    def _if_exp(self, node: ast.IfExp) -> Piece:
        test, yes, no = self.truth(node.test), self.read(node.body), self.read(node.orelse)
        kinds = {yes.kind, no.kind}
        kind = yes.kind if len(kinds) == 1 else NUMBER if kinds <= NUMBERS else ANY
        its_unit = self._common(node, (yes, no)) if kind == NUMBER else None
        asks, first, second = test.value, yes.value, no.value
        return Piece(node, kind, lambda x: first(x) if asks(x) else second(x), its_unit)

    def _compare(self, node: ast.Compare) -> Piece:
        sides = [self._side(side) for side in (node.left, *node.comparators)]
        pieces = [
            self._comparison(node, sign, left, right)
            for sign, left, right in zip(node.ops, sides, sides[1:], strict=False)
        ]
        if len(pieces) == 1:
            return pieces[0]
        margins = {key: least([margin_of(piece, key) for piece in pieces]) for key in keys_of(pieces)}
        return Piece(node, TRUTH, all_of([piece.value for piece in pieces]), margins=margins)

    def _side(self, node: ast.expr) -> Piece:
        calls = len(self._calls)
        piece = self.read(node)
        if not self._is_over_time and len(self._calls) == calls and not piece.is_literal:
            self._sides.append(Side(self._part_text(node), piece.value))
        return piece

    def _comparison(self, node: ast.Compare, sign: ast.cmpop, left: Piece, right: Piece) -> Piece:
        if isinstance(sign, ast.In | ast.NotIn):
            return self._membership(node, sign, left, right)
        if isinstance(sign, ast.Is | ast.IsNot):
            if NONE not in (left.kind, right.kind):
                raise self._wrong(node, "is compares with None alone; write == or !=")
            sign = ast.Eq() if isinstance(sign, ast.Is) else ast.NotEq()
        is_order = type(sign) in _ORDERS
        kinds = {left.kind, right.kind}
        if kinds <= {NUMBER, LEVEL} and (kinds == {NUMBER} or is_order or NUMBER in kinds):
            return self._numbers_compared(node, sign, left, right)
        for side, other in ((left, right), (right, left)):
            if isinstance(side.node, ast.Name) and side.node.id in LISTS and other.kind == NUMBER:
                raise self._wrong(node, LISTS[side.node.id])
            is_state = isinstance(side.node, ast.Name) and side.node.id == "state"
            if is_state and other.is_literal and other.kind == TEXT and other.constant not in EXIT_CODES:
                near = did_you_mean(str(other.constant).lower(), EXIT_CODES)
                states = f"; there are {', '.join(EXIT_CODES)}"
                raise self._wrong(other.node, f"no run ends with {other.constant!r}{near or states}")
        if is_order:
            for side in (left, right):
                if side.kind not in (*NUMBERS, ANY):
                    raise self._wrong(
                        side.node, f"this is {side.kind}, which is neither smaller nor larger than anything"
                    )
            return self._numbers_compared(node, sign, left, right)
        groups = {_GROUPS.get(kind, kind) for kind in kinds} - {ANY, NONE}
        if len(groups) > 1:
            raise self._wrong(node, f"this compares {left.kind} with {right.kind}, which are never equal")
        if ANY in kinds and kinds <= {ANY, NUMBER}:
            return self._numbers_compared(node, sign, left, right, is_any=True)
        first, second = left.value, right.value
        if isinstance(sign, ast.Eq):
            return Piece(node, TRUTH, lambda x: _equal(first(x), second(x)))
        return Piece(node, TRUTH, lambda x: not _equal(first(x), second(x)))

    def _numbers_compared(
        self, node: ast.Compare, sign: ast.cmpop, left: Piece, right: Piece, *, is_any: bool = False
    ) -> Piece:
        """Return the comparison of two numbers.

        Args:
            node: it.
            sign: its sign.
            left: of it.
            right: of it.
            is_any: whether one side may be no number, which is equal to none.
        """
        its_unit = self._common(node, (left, right))
        first, second = (self.as_number(left), self.as_number(right)) if not is_any else (left, right)
        a, b = first.value, second.value
        compare = COMPARISONS[type(sign)]
        if second.is_literal and type(sign) in _FAST:
            value = _FAST[type(sign)](a, second.constant)
        elif is_any:
            equal = isinstance(sign, ast.Eq)
            value = lambda x: _equal(a(x), b(x)) is equal  # noqa: E731
        else:
            value = lambda x: compare(a(x), b(x))  # noqa: E731
        if {left.kind, right.kind} == {LEVEL}:
            return Piece(node, TRUTH, value)
        open_parts = [self._part_text(side.node) for side in (left, right) if not side.is_literal]
        if not open_parts:
            return Piece(node, TRUTH, value)
        key = MarginKey(its_unit, "" if its_unit is not None else " and ".join(sorted(open_parts)))
        if is_any:
            first, second = self.as_number(left), self.as_number(right)
        return Piece(node, TRUTH, value, margins={key: _distance(type(sign), first, second)})

    def _membership(self, node: ast.Compare, sign: ast.cmpop, left: Piece, right: Piece) -> Piece:
        if right.kind not in (*SIZED, ANY):
            raise self._wrong(right.node, f"this is {right.kind}, and holds nothing")
        if right.kind == TEXT and left.kind not in (TEXT, ANY):
            raise self._wrong(left.node, f"this is {left.kind}, and cannot be in a text")
        if right.keys == {} and left.kind not in (TEXT, ANY):
            raise self._wrong(left.node, f"this is {left.kind}, and the list holds texts")
        is_in = isinstance(sign, ast.In)
        a, b, what = left.value, right.value, self._part_text(right.node)
        return Piece(node, TRUTH, lambda x: _is_in(a(x), b(x), what) is is_in)

    def _literal_list(self, node: ast.List | ast.Tuple) -> Piece:
        items = [self.read(item) for item in node.elts]
        for item in items:
            if item.kind in (LIST, TABLE):
                raise self._wrong(item.node, "lists of lists are not possible here")
        values = [item.value for item in items]
        return Piece(node, LIST, lambda x: [value(x) for value in values], items=items)

    # ---------------------------------------------------------------- numbers

    def number(self, node: ast.expr) -> Piece:
        """Check a part that must be a number."""
        return self.as_number(self.read(node))

    def as_number(self, piece: Piece) -> Piece:
        """Return a part as one that is a number."""
        if piece.kind in NUMBERS:
            return piece
        if piece.kind == ANY:
            get, what = piece.value, self._part_text(piece.node)
            return piece._replace(kind=NUMBER, value=lambda x: number(get(x), what))
        raise self._wrong(piece.node, f"this is {piece.kind}, not a number")

    def _common(self, node: ast.AST, pieces: Sequence[Piece]) -> Unit:
        try:
            return common([piece.unit for piece in pieces])
        except UnitsDiffer as differ:
            raise self._wrong(
                node,
                f"{unit_text(differ.first)} and {unit_text(differ.second)} are different units, "
                "which are neither compared nor added",
            ) from None

    def _bin_op(self, node: ast.BinOp) -> Piece:
        compute = _OPERATORS.get(type(node.op))
        if compute is None:
            raise self._wrong(node, "this operator is not possible here; there are + - * / // % **")
        left, right = self.number(node.left), self.number(node.right)
        a, b, what = left.value, right.value, self._part_text(node)
        if isinstance(node.op, ast.Pow):
            if not right.is_literal or abs(right.constant) > EXPONENT_MAX:
                raise self._wrong(node.right, f"an exponent is a literal from -{EXPONENT_MAX} to {EXPONENT_MAX}")
            its_unit = power(left.unit, right.constant)
        elif isinstance(node.op, ast.Mult):
            its_unit = product(left.unit, right.unit)
        elif isinstance(node.op, ast.Div | ast.FloorDiv):
            its_unit = product(left.unit, power(right.unit, -1.0))
        else:
            its_unit = self._common(node, (left, right))
        if isinstance(node.op, ast.Add):
            return Piece(node, NUMBER, lambda x: a(x) + b(x), its_unit)
        if isinstance(node.op, ast.Sub):
            return Piece(node, NUMBER, lambda x: a(x) - b(x), its_unit)
        return Piece(node, NUMBER, _guarded(lambda x: compute(a(x), b(x)), what), its_unit)

    # ---------------------------------------------------------------- calls

    def _call(self, node: ast.Call) -> Piece:
        if not isinstance(node.func, ast.Name):
            raise self._wrong(node.func, "only functions by their names can be called here")
        name = node.func.id
        for keyword in node.keywords:
            raise self._wrong(keyword.value, f"{name} takes no arguments by name")
        for argument in node.args:
            if isinstance(argument, ast.Starred):
                raise self._wrong(argument, "* is not possible here")
        if name in FUNCTIONS_OVER_TIME:
            return self._over_time(node, name)
        if name == "signal":
            return self._signal(node)
        if name == "len":
            return self._len(node)
        if name in FUNCTIONS:
            return self._function(node, name)
        if name in OVER_TIME or name in RECORD or name in CONSTANTS:
            raise self._wrong(node.func, f"{name!r} is a value, and cannot be called")
        family = name.removeprefix("get_").removeprefix("read_")
        if family in SIGNALS:
            raise self._wrong(node, f"commands are not there: write {self._signal_example(family)}")
        known = (*FUNCTIONS, "len", *(("signal",) if self._is_over_time else FUNCTIONS_OVER_TIME))
        near = did_you_mean(name, known)
        raise self._wrong(node.func, f"there is no function {name!r}{near or '; there are ' + ', '.join(known)}")

    def _counted(self, node: ast.Call, name: str, least_: int, most: int | None) -> None:
        given = len(node.args)
        if given < least_ or (most is not None and given > most):
            wanted = str(least_) if most == least_ else f"{least_} or more" if most is None else f"{least_} to {most}"
            raise self._wrong(node, f"{name} takes {wanted} argument{'' if wanted == '1' else 's'}, not {given}")

    def _signal(self, node: ast.Call) -> Piece:
        if not self._is_over_time:
            raise self._wrong(
                node, 'signal(...) is there inside functions over time alone; at the end of the run: signals["..."]'
            )
        self._counted(node, "signal", 1, 1)
        return self._signal_named(node, node.args[0])

    def _len(self, node: ast.Call) -> Piece:
        self._counted(node, "len", 1, 1)
        piece = self.read(node.args[0])
        if piece.kind not in (*SIZED, ANY):
            raise self._wrong(piece.node, f"this is {piece.kind}, which has no length")
        get, what = piece.value, self._part_text(piece.node)
        return Piece(node, NUMBER, lambda x: _length(get(x), what))

    def _function(self, node: ast.Call, name: str) -> Piece:
        row = FUNCTIONS[name]
        self._counted(node, name, row.least, row.most)
        compute, what = row.compute, self._part_text(node)
        if row.takes_list and len(node.args) == 1:
            return self._of_list(node, name)
        pieces = [self.number(argument) for argument in node.args]
        if name == "round" and len(pieces) == 2:
            digits = pieces.pop()
            if type(digits.constant) is not int or not 0 <= digits.constant <= DIGITS_MAX:
                raise self._wrong(digits.node, f"round takes 0 to {DIGITS_MAX} digits, as a literal")
            get, count = pieces[0].value, digits.constant
            return Piece(node, NUMBER, _guarded(lambda x: compute(get(x), count), what), pieces[0].unit)
        its_unit = self._common(node, pieces)
        if row.takes is not None and its_unit not in (None, row.takes):
            raise self._wrong(node.args[0], f"{name} takes {unit_text(row.takes)}, and this is {unit_text(its_unit)}")
        values = [piece.value for piece in pieces]
        if len(values) == 1:
            get = values[0]
            return Piece(node, NUMBER, _guarded(lambda x: compute(get(x)), what), row.unit(its_unit))
        return Piece(
            node, NUMBER, _guarded(lambda x: compute(*[value(x) for value in values]), what), row.unit(its_unit)
        )

    def _of_list(self, node: ast.Call, name: str) -> Piece:
        piece = self.read(node.args[0])
        compute, what = FUNCTIONS[name].compute, self._part_text(node)
        if piece.kind not in (LIST, ANY) or piece.keys is not None:
            raise self._wrong(piece.node, f"this is {piece.kind}: {name} takes numbers, or one list of numbers")
        its_unit = None
        if piece.items is not None:
            for item in piece.items:
                if item.kind not in (*NUMBERS, ANY):
                    raise self._wrong(item.node, f"this is {item.kind}, not a number")
            its_unit = self._common(node, piece.items)
        get = piece.value
        return Piece(node, NUMBER, _guarded(lambda x: compute(*_numbers(get(x), what)), what), its_unit)

    def _over_time(self, node: ast.Call, name: str) -> Piece:
        row = FUNCTIONS_OVER_TIME[name]
        if self._is_over_time:
            raise self._wrong(node, f"{name}(...) cannot stand inside another function over time")
        self._counted(node, name, row.arguments, row.arguments)
        self._is_over_time = True
        try:
            pieces = [self.read(argument) for argument in node.args]
        finally:
            self._is_over_time = False
        for piece in pieces:
            if piece.kind not in row.takes:
                wanted = "true or false" if TRUTH in row.takes else "a number"
                raise self._wrong(piece.node, f"this is {piece.kind}, and {name} takes what is {wanted}")
        parts = tuple(part_of(piece, self._part_text(piece.node)) for piece in pieces)
        index = len(self._calls)
        self._calls.append(OverTimeCall(name, parts, self._part_text(node)))

        def margin(key_index: int) -> Margin:
            return lambda x: x.over_time[index].margin(key_index)

        margins = {key: margin(place) for place, key in enumerate(keys_over_time(name, pieces))}
        its_unit = pieces[0].unit if row.keeps_unit else row.unit
        return Piece(node, row.kind, lambda x: x.over_time[index].value(), its_unit, margins)


_READERS: Final[dict[type, Callable[[_Reader, Any], Piece]]] = {
    ast.Constant: _Reader._constant,
    ast.Attribute: _Reader._attribute,
    ast.Name: _Reader._name,
    ast.Subscript: _Reader._subscript,
    ast.BoolOp: _Reader._bool_op,
    ast.UnaryOp: _Reader._unary_op,
    ast.BinOp: _Reader._bin_op,
    ast.Compare: _Reader._compare,
    ast.IfExp: _Reader._if_exp,
    ast.Call: _Reader._call,
    ast.List: _Reader._literal_list,
    ast.Tuple: _Reader._literal_list,
}

_NOT_POSSIBLE: Final[dict[type, tuple[str, str]]] = {
    ast.Attribute: ("a dot", '; parts are taken with brackets, such as alarms[0]["code"]'),
    ast.Lambda: ("lambda", ""),
    ast.NamedExpr: (":=", ""),
    ast.JoinedStr: ("an f-string", ""),
    ast.ListComp: ("a comprehension", "; over time write always(...) or eventually(...)"),
    ast.SetComp: ("a comprehension", "; over time write always(...) or eventually(...)"),
    ast.DictComp: ("a comprehension", "; over time write always(...) or eventually(...)"),
    ast.GeneratorExp: ("a comprehension", "; over time write always(...) or eventually(...)"),
    ast.Await: ("await", ""),
    ast.Yield: ("yield", ""),
    ast.YieldFrom: ("yield", ""),
    ast.Dict: ("a table", ""),
    ast.Set: ("a set", "; write a list"),
    ast.Starred: ("*", ""),
    ast.Slice: ("a slice", ""),
}

_PLACES_AT_END: Final = {"joints": "q", "tcp_pose": "tcp"}
"""Names of the record for places as they are at the end of the run."""

_ORDERS: Final = frozenset({ast.Lt, ast.LtE, ast.Gt, ast.GtE})

_FAST: Final[dict[type, Callable[[Value, Any], Value]]] = {
    ast.Lt: lambda a, edge: lambda x: a(x) < edge,
    ast.LtE: lambda a, edge: lambda x: a(x) <= edge,
    ast.Gt: lambda a, edge: lambda x: a(x) > edge,
    ast.GtE: lambda a, edge: lambda x: a(x) >= edge,
}

_OPERATORS: Final[dict[type, Callable[[Any, Any], Any]]] = {
    **{sign: BINARY[sign] for sign in (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.Mod)},
    ast.Pow: powered,
}

_GROUPS: Final = {LEVEL: NUMBER, TRUTH: NUMBER, TABLE: LIST}
"""Kinds that may be equal."""

_FORCES: Final = 3
"""Points of a wrench that are forces; the others are moments."""


def _distance(sign: type, left: Piece, right: Piece) -> Margin:
    """Return the margin of a comparison of two numbers."""
    a, b = left.value, right.value
    edge = right.constant
    if sign in (ast.Gt, ast.GtE):
        if right.is_literal and _is_simple(left.node):
            return lambda x: a(x) - edge
        return lambda x: _difference(a(x), b(x))
    if sign in (ast.Lt, ast.LtE):
        if right.is_literal and _is_simple(left.node):
            return lambda x: edge - a(x)
        return lambda x: _difference(b(x), a(x))
    if sign is ast.Eq:
        return lambda x: -abs(_difference(a(x), b(x))) + 0.0
    return lambda x: abs(_difference(a(x), b(x)))


def _is_simple(node: ast.expr) -> bool:
    """Return whether a part is a name or a part of the arm's state, which is always a finite number."""
    return isinstance(node, ast.Name) or (isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name))


def _difference(a: float, b: float) -> float:
    """Return a difference; that of equal numbers is 0 whatever their size."""
    if a == b:
        return 0.0
    difference = float(a - b)
    if difference != difference:
        raise Undefined("a comparison with what is no number (nan)")
    return difference


def _guarded(compute: Value, what: str) -> Value:
    """Return a computation that raises Undefined where it has no result."""

    def value(x: Any) -> Any:
        try:
            return compute(x)
        except ZeroDivisionError:
            raise Undefined(f"division by zero in {what}") from None
        except OverflowError:
            raise Undefined(f"{what} is too large") from None
        except ValueError:
            raise Undefined(f"{what} has no value") from None

    return value


def _at(values: Any, index: int | str, what: str) -> Any:
    """Return a part of a value."""
    if isinstance(values, dict):
        if index in values:
            return values[index]
        raise Undefined(f"{what} has no {index!r}")
    if not isinstance(values, list | tuple | str):
        raise Undefined(f"{what} is {shown(values)}, which has no parts")
    if type(index) is not int:
        raise Undefined(f"{what} has no {index!r}, but numbers as indices")
    if not -len(values) <= index < len(values):
        raise Undefined(f"{what} has {len(values)} part{'' if len(values) == 1 else 's'}, and none at {index}")
    return values[index]


def _length(value: Any, what: str) -> int:
    if isinstance(value, str | list | tuple | dict | frozenset):
        return len(value)
    raise Undefined(f"{what} is {shown(value)}, which has no length")


def _numbers(value: Any, what: str) -> list[Any]:
    """Return the numbers of a list."""
    if not isinstance(value, list | tuple) or not value:
        raise Undefined(f"{what}: there are no numbers in {shown(value)}")
    return [number(item, f"a part of {what}") for item in value]


def _equal(a: Any, b: Any) -> bool:
    """Return whether two values are equal; a list and a tuple of equal parts are."""
    if isinstance(a, tuple):
        a = list(a)
    if isinstance(b, tuple):
        b = list(b)
    return bool(a == b)


def _is_in(item: Any, values: Any, what: str) -> bool:
    """Return whether a value holds another one."""
    if isinstance(values, str):
        if not isinstance(item, str):
            raise Undefined(f"{what} is a text, and {shown(item)} is none")
        return item in values
    if isinstance(values, dict | frozenset):
        return isinstance(item, bool | int | float | str | None) and item in values
    if isinstance(values, list | tuple):
        return any(_equal(item, one) for one in values)
    raise Undefined(f"{what} is {shown(values)}, and holds nothing")
