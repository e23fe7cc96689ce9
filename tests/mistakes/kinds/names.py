"""Mistakes of names: misspelt, or those of something else."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from itertools import pairwise

from tests.mistakes.planting import Edit, Program, kind, misspelt

GROUP = "names and scopes"
_LONG = 3


@kind(GROUP, "command misspelt")
def command_misspelt(program: Program) -> Iterator[Edit]:
    for command, call, _ in program.calls:
        yield Edit(call.func, misspelt(command.name))


@kind(GROUP, "variable misspelt where it is read")
def read_misspelt(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Name):
        if isinstance(node.ctx, ast.Load) and node.id in program.bound and len(node.id) > _LONG:
            yield Edit(node, misspelt(node.id), frozenset({misspelt(node.id)}))


@kind(GROUP, "variable misspelt where it gets a value")
def write_misspelt(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Assign):
        target = node.targets[0]
        if isinstance(target, ast.Name) and len(target.id) > _LONG:
            yield Edit(target, misspelt(target.id), frozenset({misspelt(target.id), target.id}))


@kind(GROUP, "function of one's own misspelt")
def function_misspelt(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Call):
        if isinstance(node.func, ast.Name) and node.func.id in program.functions and len(node.func.id) > _LONG:
            yield Edit(node.func, misspelt(node.func.id), frozenset({misspelt(node.func.id)}))


@kind(GROUP, "capital letter in a name")
def capital(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Name):
        if isinstance(node.ctx, ast.Load) and node.id in program.bound and node.id.islower():
            yield Edit(node, node.id.capitalize(), frozenset({node.id.capitalize()}))


@kind(GROUP, "name of a channel misspelt")
def channel_misspelt(program: Program) -> Iterator[Edit]:
    for command, _, given in program.calls:
        if "socket_name" in given and command.name.startswith("socket_"):
            value = given["socket_name"][1]
            if isinstance(value, ast.Constant) and isinstance(value.value, str):
                yield Edit(value, f'"{misspelt(value.value)}"', frozenset({value.value, misspelt(value.value)}))


@kind(GROUP, "name of a channel left out")
def channel_left_out(program: Program) -> Iterator[Edit]:
    for command, call, given in program.calls:
        if "socket_name" not in given or not command.name.startswith("socket_"):
            continue
        value = given["socket_name"][1]
        if call.args and value is call.args[-1]:
            rest = ", ".join(program.source(other) for other in call.args[:-1])
            named = program.literal(value)
            name = str(named.value) if isinstance(named, ast.Constant) else ""
            yield Edit(call, f"{command.name}({rest})", frozenset({"socket_0", name} - {""}))


@kind(GROUP, "two servers under one name")
def one_name(program: Program) -> Iterator[Edit]:
    opened = [
        (call, given["socket_name"][1])
        for command, call, given in program.calls
        if command.name == "socket_open" and "socket_name" in given
    ]
    for (_, first), (_, second) in pairwise(opened):
        if program.source(first) != program.source(second):
            name = program.source(first).strip('"')
            yield Edit(second, program.source(first), frozenset({name, program.source(second).strip('"')}))


@kind(GROUP, "name of a MODBUS signal misspelt")
def signal_misspelt(program: Program) -> Iterator[Edit]:
    for command, _, given in program.calls:
        if "signal_name" in given and command.name.startswith("modbus_"):
            value = given["signal_name"][1]
            if isinstance(value, ast.Constant) and isinstance(value.value, str):
                yield Edit(value, f'"{misspelt(value.value)}"', frozenset({value.value, misspelt(value.value)}))


@kind(GROUP, "MODBUS signal of another kind")
def other_signal(program: Program) -> Iterator[Edit]:
    for command, call, given in program.calls:
        if command.name == "modbus_add_signal" and "signal_type" in given:
            value = given["signal_type"][1]
            if isinstance(value, ast.Constant) and value.value in (1, 3):
                name = given["signal_name"][1]
                yield Edit(value, str(value.value - 1), frozenset({program.source(name).strip('"')}))
        elif command.name in ("modbus_set_output_signal", "modbus_set_output_register") and call.args:
            other = "modbus_set_output_register" if command.name.endswith("signal") else "modbus_set_output_signal"
            yield Edit(call.func, other, frozenset({program.source(call.args[0]).strip('"')}))


@kind(GROUP, "address that no device has")
def no_address(program: Program) -> Iterator[Edit]:
    for command, _, given in program.calls:
        if command.name == "modbus_add_signal":
            value = given["signal_address"][1]
            name = frozenset({program.source(given["signal_name"][1]).strip('"')})
            kind_of = getattr(program.literal(given["signal_type"][1]), "value", 0)
            yield Edit(value, "40001" if kind_of in (2, 3) else "10001", name)
        value = given.get("IP", given.get("address", (None, None)))[1]
        literal = program.literal(value) if value is not None else None
        if command.name in ("modbus_add_signal", "socket_open") and isinstance(literal, ast.Constant):
            address = str(literal.value)
            yield Edit(literal, f'"{address}:502"')
            yield Edit(literal, f'"{address.rsplit(".", 1)[0]}.300"')


@kind(GROUP, "`global` or `nonlocal` dropped")
def dropped_global(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.stmt):
        if not isinstance(node, ast.Global | ast.Nonlocal):
            continue
        function = program.function(node)
        # At the start of the program `global` says what the monitor shows: without it nothing goes wrong.
        if function is None or function.name not in program.functions:
            continue
        for name in node.names:
            rest = [other for other in node.names if other != name]
            word = "global" if isinstance(node, ast.Global) else "nonlocal"
            yield Edit(node, f"{word} {', '.join(rest)}" if rest else "pass", frozenset({name}))


@kind(GROUP, "`global` of a misspelt name")
def global_misspelt(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Global):
        for name in node.names:
            if len(name) > _LONG:
                names = ", ".join(misspelt(other) if other == name else other for other in node.names)
                yield Edit(node, f"global {names}", frozenset({name, misspelt(name)}))


@kind(GROUP, "first value left out")
def first_value(program: Program) -> Iterator[Edit]:
    seen = set()
    for node in program.every(ast.Assign):
        target = node.targets[0]
        if isinstance(target, ast.Name) and (key := (program.function(node), target.id)) not in seen:
            seen.add(key)
            yield Edit(node, "pass", frozenset({target.id}))


@kind(GROUP, "value in one branch alone")
def one_branch(program: Program) -> Iterator[Edit]:
    seen = set()
    for node in program.every(ast.Assign):
        target = node.targets[0]
        if not isinstance(target, ast.Name) or (key := (program.function(node), target.id)) in seen:
            continue
        seen.add(key)
        if isinstance(program.parents[node], ast.FunctionDef):
            indent = " " * node.col_offset
            text = f"if get_flag(30):\n{indent}  {program.source(node)}\n{indent}end"
            yield Edit(node, text, frozenset({target.id}))


@kind(GROUP, "built-in function hidden by a variable and called")
def hidden_function(program: Program) -> Iterator[Edit]:
    called = {
        node.func.id
        for node in program.every(ast.Call)
        if isinstance(node.func, ast.Name) and node.func.id not in program.bound
    }
    for node in program.every(ast.Assign):
        target = node.targets[0]
        function = program.function(node)
        if not isinstance(target, ast.Name) or function is None or function.name in program.functions:
            continue
        uses = [other for other in program.every(ast.Name) if other.id == target.id]
        declared = [row for row in program.every(ast.Global) if target.id in row.names]
        if declared or len(uses) > 6:
            continue
        for name in sorted(
            called & {"max", "min", "len", "abs", "int", "range", "textmsg", "sleep", "length", "force"}
        ):
            names = frozenset({name, target.id})
            others = tuple((other, name) for other in uses if other is not target)
            yield Edit(target, name, names, others)


@kind(GROUP, "words of other languages")
def other_words(program: Program) -> Iterator[Edit]:
    for command, call, _ in program.calls:
        if command.name == "sleep":
            yield Edit(call.func, "wait")
            yield Edit(call.func, "delay")
        elif command.name == "textmsg":
            yield Edit(call.func, "print_msg")
        elif command.name in ("set_standard_digital_out", "get_standard_digital_in", "get_actual_joint_positions"):
            other = {"set_standard_digital_out": "set_digital_out", "get_standard_digital_in": "get_digital_in"}
            yield Edit(call.func, other.get(command.name, "get_joint_positions"))
    for node in program.every(ast.Constant):
        if isinstance(node.value, bool):
            yield Edit(node, str(node.value).lower())
    for test in program.every(ast.BoolOp):
        word = "&&" if isinstance(test.op, ast.And) else "||"
        yield Edit(test, f" {word} ".join(program.source(value) for value in test.values))
