"""Mistakes of arguments: other places, numbers and ranges of them."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from tests.mistakes.kinds.units import number_of
from tests.mistakes.planting import Edit, Program, kind, misspelt

GROUP = "arguments"


@kind(GROUP, "two arguments of a command swapped")
def swapped(program: Program) -> Iterator[Edit]:
    for command, call, _ in program.calls:
        for at, (first, second) in enumerate(zip(call.args, call.args[1:], strict=False)):
            # Two numbers in each other's place may be meant, as far as anybody can see.
            kinds = [_family(param.quantity.type_name) for param in command.params[at : at + 2]]
            if len(set(kinds)) == 2 and "any" not in kinds:
                yield Edit(first, program.source(second), and_at=((second, program.source(first)),))


def _family(type_name: str) -> str:
    """Return what a parameter takes, so roughly that another cannot be meant."""
    return "number" if type_name in ("int", "float") else type_name.partition(" ")[0]


@kind(GROUP, "two arguments of a function of one's own swapped")
def swapped_own(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Call):
        if isinstance(node.func, ast.Name) and node.func.id in program.functions and len(node.args) == 2:
            first, second = node.args
            shapes = {_shape(program, first), _shape(program, second)}
            if len(shapes) == 2 and "?" not in shapes:
                names = frozenset(arg.arg for arg in program.functions[node.func.id].args.args)
                yield Edit(first, program.source(second), names, ((second, program.source(first)),))


def _shape(program: Program, node: ast.expr) -> str:
    """Return roughly what an argument is; what is not known is like everything."""
    literal = program.literal(node) or node
    if number_of(literal) is not None:
        return "number"
    if isinstance(literal, ast.Constant):
        return type(literal.value).__name__
    return type(literal).__name__ if isinstance(literal, ast.List | ast.Dict) else "?"


@kind(GROUP, "argument left out")
def left_out(program: Program) -> Iterator[Edit]:
    for command, call, given in program.calls:
        required = [param for param in command.params if param.is_required]
        if len(call.args) == len(required) and call.args and not call.keywords and given:
            rest = ", ".join(program.source(value) for value in call.args[:-1])
            yield Edit(call, f"{command.name}({rest})")


@kind(GROUP, "argument too many")
def too_many(program: Program) -> Iterator[Edit]:
    for command, call, _ in program.calls:
        if len(call.args) == len(command.params) and not call.keywords and not command.takes_more and call.args:
            yield Edit(call.args[-1], f"{program.source(call.args[-1])}, 0")


@kind(GROUP, "argument of a function of one's own left out")
def own_left_out(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Call):
        called = program.functions.get(node.func.id) if isinstance(node.func, ast.Name) else None
        if called is not None and len(node.args) == len(called.args.args) > 0 and not called.args.defaults:
            rest = ", ".join(program.source(value) for value in node.args[:-1])
            yield Edit(node, f"{called.name}({rest})", frozenset({called.name}))


@kind(GROUP, "keyword misspelt")
def keyword_misspelt(program: Program) -> Iterator[Edit]:
    for _, call, _ in program.calls:
        for keyword in call.keywords:
            if keyword.arg is not None:
                wrong = misspelt(keyword.arg)
                yield Edit(keyword, f"{wrong}={program.source(keyword.value)}", frozenset({wrong}))


@kind(GROUP, "one number too few in a list of six")
def five(program: Program) -> Iterator[Edit]:
    for node in _sixes(program):
        yield Edit(node, f"[{', '.join(program.source(element) for element in node.elts[:-1])}]")


@kind(GROUP, "one number too many in a list of six")
def seven(program: Program) -> Iterator[Edit]:
    for node in _sixes(program):
        yield Edit(node, f"[{', '.join([*(program.source(element) for element in node.elts), '0'])}]")


@kind(GROUP, "decimal comma in a list of six")
def decimal_comma(program: Program) -> Iterator[Edit]:
    for node in _sixes(program):
        for element in node.elts:
            text = program.source(element)
            if "." in text and number_of(element):
                yield Edit(element, text.replace(".", ", "))


def _sixes(program: Program) -> Iterator[ast.List]:
    """Yield lists of six numbers that are the argument of a command, or the only value of a name that is one."""
    seen = set()
    for _, _, _, value in program.arguments(lambda quantity: quantity.type_name == "list[float] of 6"):
        literal = program.literal(value)
        if isinstance(literal, ast.List) and len(literal.elts) == 6 and literal not in seen:
            seen.add(literal)
            yield literal


@kind(GROUP, "element behind the end of a list")
def behind_end(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Subscript):
        index = node.slice
        if isinstance(index, ast.Constant) and type(index.value) is int and index.value > 1:
            yield Edit(index, str(index.value + 4), frozenset({program.source(node.value)}))


@kind(GROUP, "loop that goes one element too far")
def one_too_far(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.For):
        if not (isinstance(node.target, ast.Name) and isinstance(node.iter, ast.Call) and len(node.iter.args) == 1):
            continue
        indexed = [
            other
            for other in ast.walk(node)
            if isinstance(other, ast.Subscript)
            and isinstance(other.slice, ast.Name)
            and other.slice.id == node.target.id
        ]
        for other in indexed:
            known = program.literal(other.value)
            limit = node.iter.args[0]
            if isinstance(known, ast.List) and number_of(limit) == len(known.elts):
                yield Edit(limit, str(len(known.elts) + 1), frozenset({program.source(other.value)}))


_PINS = ("n", "port", "address", "index")


@kind(GROUP, "pin or register that does not exist")
def no_such_pin(program: Program) -> Iterator[Edit]:
    for command, _, param, value in program.arguments(lambda quantity: quantity.type_name == "int"):
        is_pin = param.name in _PINS and (
            "digital" in command.name or "analog" in command.name or "register" in command.name
        )
        literal = program.literal(value)
        if is_pin and literal is not None and number_of(literal) is not None:
            yield Edit(literal, str(int(number_of(literal) or 0) + (64 if "register" in command.name else 16)))


@kind(GROUP, "pin of the tool that is an input")
def tool_input(program: Program) -> Iterator[Edit]:
    for command, _, given in program.calls:
        if command.name == "set_tool_digital_io_config" and "is_out" in given:
            yield Edit(given["is_out"][1], "False", frozenset({"set_tool_digital"}))


@kind(GROUP, "number that a register does not hold")
def too_large(program: Program) -> Iterator[Edit]:
    for command, call, _ in program.calls:
        if command.name in ("modbus_set_output_register", "write_output_integer_register", "write_port_register"):
            yield Edit(call.args[1], "3000000000" if "output_integer" in command.name else "70000")
        elif command.name == "serial_modbus_write_registers" and isinstance(call.args[2], ast.List):
            yield Edit(call.args[2], "[70000]")
