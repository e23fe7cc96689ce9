"""Mistakes of order and time: steps that are missing, or stand at another place."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from tests.mistakes.planting import COMMANDS, Edit, Program, kind

GROUP = "steps and waits"
_MODES = ("end_force_mode", "stop_conveyor_tracking", "end_freedrive_mode", "stopj", "stopl", "path_offset_disable")


def _called(program: Program, *names: str) -> Iterator[tuple[ast.Call, ast.Expr]]:
    """Yield the calls of commands that are statements."""
    for command, call, _ in program.calls:
        statement = program.parents[call]
        if command.name in names and isinstance(statement, ast.Expr):
            yield call, statement


@kind(GROUP, "no wait in a loop that asks an input")
def no_wait(program: Program) -> Iterator[Edit]:
    for _, statement in _called(program, "sleep", "sync"):
        loop = program.parents[statement]
        if not isinstance(loop, ast.While):
            continue
        waits = [command for command, call, _ in program.calls if command.waits and _is_within(program, call, loop)]
        # What it asks, perhaps through a function, and not only a variable that another thread sets.
        asked = {_first_name(node.func) for node in ast.walk(loop.test) if isinstance(node, ast.Call)}
        is_asked = any(_asks_input(program, name) for name in asked)
        if len(waits) == 1 and is_asked:
            yield Edit(statement, "pass", frozenset(asked))


def _is_within(program: Program, node: ast.AST, around: ast.AST) -> bool:
    while node in program.parents and node is not around:
        node = program.parents[node]
    return node is around


def _first_name(node: ast.expr) -> str:
    return node.id if isinstance(node, ast.Name) else ""


def _asks_input(program: Program, name: str) -> bool:
    """Return whether a command, or a function that calls one, reads a signal or a sensor."""
    if name in COMMANDS and name not in program.bound:
        return COMMANDS[name].details.result.origin in ("signal", "measured")
    function = program.functions.get(name)
    calls = [] if function is None else [node for node in ast.walk(function) if isinstance(node, ast.Call)]
    return any(_asks_input(program, _first_name(call.func)) for call in calls if _first_name(call.func) != name)


def _words(program: Program, node: ast.AST) -> set[str]:
    return {other.id for other in ast.walk(node) if isinstance(other, ast.Name)}


@kind(GROUP, "no wait between on and off")
def no_pulse(program: Program) -> Iterator[Edit]:
    outputs = (
        "set_standard_digital_out",
        "set_configurable_digital_out",
        "set_tool_digital",
        "modbus_set_output_signal",
    )
    for _, statement in _called(program, "sleep"):
        body = next((rows for rows in _bodies(program.parents[statement]) if statement in rows), [])
        at = body.index(statement)
        around = body[at - 1 : at] + body[at + 1 : at + 2]
        first = [
            row.value.func.id
            for row in around
            if isinstance(row, ast.Expr) and isinstance(row.value, ast.Call) and isinstance(row.value.func, ast.Name)
        ]
        if len(first) == 2 and first[0] == first[1] and first[0] in outputs:
            yield Edit(statement, "pass", frozenset({first[0]}))


def _bodies(node: ast.AST) -> list[list[ast.stmt]]:
    return [rows for name in ("body", "orelse", "finalbody") if isinstance(rows := getattr(node, name, None), list)]


@kind(GROUP, "no wait between a new MODBUS signal and its first reading")
def no_first_wait(program: Program) -> Iterator[Edit]:
    added = [call for call, _ in _called(program, "modbus_add_signal")]
    for _, statement in _called(program, "sleep"):
        body = next((rows for rows in _bodies(program.parents[statement]) if statement in rows), [])
        before = body[max(0, body.index(statement) - 3) : body.index(statement)]
        if any(program.parents[call] in before for call in added):
            yield Edit(statement, "pass", frozenset({"modbus_get_signal_status"}))


@kind(GROUP, "mode or motion without its end")
def no_end_of_mode(program: Program) -> Iterator[Edit]:
    for call, statement in _called(program, *_MODES):
        # A motion that ends by itself needs no stop.
        if call.func.id in ("stopj", "stopl") and not _is_endless(program, statement):  # type: ignore[attr-defined]
            continue
        begun = {
            "end_force_mode": ("force_mode",),
            "stop_conveyor_tracking": ("track_conveyor_linear", "track_conveyor_circular"),
            "stopj": ("servoj",),
            "stopl": ("speedl",),
        }
        # A report that names the step that is missing is about it.
        missing = call.func.id  # type: ignore[attr-defined]
        yield Edit(statement, "pass", frozenset({missing, "speedj", *begun.get(missing, ())}))


def _is_endless(program: Program, stop: ast.stmt) -> bool:
    """Return whether the motion in front of a stop has no end of its own: speed commands without a time."""
    before = [
        (call, given)
        for command, call, given in program.calls
        if command.name in ("speedl", "speedj") and call.lineno < stop.lineno
    ]
    return bool(before) and "t" not in before[-1][1]


@kind(GROUP, "channel that is never opened")
def never_opened(program: Program) -> Iterator[Edit]:
    for command, call, given in program.calls:
        if command.name in ("socket_open", "serial_config") and not _is_off(given):
            statement = program.parents[call]
            names = {command.name.split("_")[0]} | {program.source(value).strip('"') for value in call.args[2:3]}
            yield Edit(call if not isinstance(statement, ast.Expr) else statement, "True", frozenset(names))


def _is_off(given: dict[str, tuple[object, ast.expr]]) -> bool:
    enable = given.get("enable")
    return enable is not None and isinstance(enable[1], ast.Constant) and enable[1].value is False


@kind(GROUP, "MODBUS signal that is never added")
def never_added(program: Program) -> Iterator[Edit]:
    for call, statement in _called(program, "modbus_add_signal"):
        yield Edit(statement, "pass", frozenset({program.source(call.args[4]).strip('"')}))


@kind(GROUP, "encoder that is not set up or not fed")
def no_encoder(program: Program) -> Iterator[Edit]:
    names = ("encoder_enable_set_tick_count", "encoder_set_tick_count", "encoder_enable_pulse_decode")
    for call, statement in _called(program, *names):
        # To begin at 0 is a habit, and no mistake if left out.
        if call.func.id == "encoder_set_tick_count" and isinstance(call.args[-1], ast.Constant):  # type: ignore[attr-defined]
            continue
        yield Edit(statement, "pass", frozenset({"track_conveyor_linear", "encoder_set_tick_count"}))


@kind(GROUP, "output behind a blended move")
def blended(program: Program) -> Iterator[Edit]:
    for call, statement in _called(program, "movel", "movej"):
        body = next((rows for rows in _bodies(program.parents[statement]) if statement in rows), [])
        at = body.index(statement)
        after = body[at + 1 : at + 2]
        is_output = after and "digital_out" in program.source(after[0]) and isinstance(after[0], ast.Expr)
        if is_output and not any(keyword.arg == "r" for keyword in call.keywords):
            inside = program.source(call)[:-1]
            yield Edit(call, f"{inside}, r=0.02)", frozenset({"set_standard_digital_out"}))


@kind(GROUP, "thread that is never started")
def never_started(program: Program) -> Iterator[Edit]:
    for command, call, _ in program.calls:
        if command.name == "start_thread" and isinstance(call.args[0], ast.Name):
            statement = program.statement(call)
            used = program.functions.get(call.args[0].id)
            written = (
                {name for node in ast.walk(used) if isinstance(node, ast.Global | ast.Nonlocal) for name in node.names}
                if used
                else set()
            )
            yield Edit(statement, "pass", frozenset({call.args[0].id, *written}))


@kind(GROUP, "result that is not returned")
def no_return(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Return):
        function = program.function(node)
        if node.value is not None and function is not None and not isinstance(node.value, ast.Constant):
            yield Edit(node, program.source(node.value), frozenset({function.name}))


@kind(GROUP, "input that nothing changes is waited for")
def other_input(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.While):
        test = node.test
        call = test.operand if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not) else None
        name = _first_name(call.func) if isinstance(call, ast.Call) else ""
        function = program.functions.get(name)
        inner = next((row.value for row in function.body if isinstance(row, ast.Return)), None) if function else call
        if isinstance(inner, ast.Call) and _first_name(inner.func) in (
            "get_standard_digital_in",
            "get_configurable_digital_in",
        ):
            yield Edit(inner.args[0], "7", frozenset({"standard_digital_in[7]", name}))


@kind(GROUP, "line end that the peer does not send")
def other_line_end(program: Program) -> Iterator[Edit]:
    for command, _, given in program.calls:
        if command.name == "socket_read_string" and "suffix" in given:
            value = given["suffix"][1]
            if isinstance(value, ast.Constant) and value.value == "\n":
                yield Edit(value, '"\\r\\n"', _channel(program, given))


@kind(GROUP, "line end as the mark in front of a text")
def line_end_in_front(program: Program) -> Iterator[Edit]:
    for command, _, given in program.calls:
        if command.name == "socket_read_string" and "suffix" in given and "prefix" in given:
            prefix, suffix = given["prefix"][1], given["suffix"][1]
            if isinstance(suffix, ast.Constant) and isinstance(prefix, ast.Constant) and suffix.value:
                yield Edit(prefix, program.source(suffix), _channel(program, given), ((suffix, '""'),))


@kind(GROUP, "line end left out of what is sent")
def no_line_end(program: Program) -> Iterator[Edit]:
    for command, call, given in program.calls:
        if command.name == "socket_send_line":
            rest = [value for name, (_, value) in given.items() if name in ("str", "socket_name")]
            yield Edit(
                call,
                f"socket_send_string({', '.join(program.source(value) for value in rest)})",
                _channel(program, given),
            )


def _channel(program: Program, given: dict[str, tuple[object, ast.expr]]) -> frozenset[str]:
    value = given.get("socket_name")
    return frozenset() if value is None else frozenset({program.source(value[1]).strip('"')})


@kind(GROUP, "condition that is never asked: `=` for `==`")
def assigned(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Compare):
        if isinstance(node.ops[0], ast.Eq) and isinstance(program.parents[node], ast.If | ast.While):
            yield Edit(node, f"{program.source(node.left)} = {program.source(node.comparators[0])}")


@kind(GROUP, "counter that is not counted")
def not_counted(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Assign):
        target = node.targets[0]
        loop = program.parents[node]
        is_counted = (
            isinstance(node.value, ast.BinOp)
            and isinstance(target, ast.Name)
            and target.id in _words(program, node.value)
        )
        if (
            is_counted
            and isinstance(loop, ast.While)
            and isinstance(target, ast.Name)
            and target.id in _words(program, loop.test)
        ):
            yield Edit(node, "pass", frozenset({target.id}))
