"""Mistakes of kind: a value of another kind than the one that is wanted."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.commands.definition.quantities import Boolean
from tests.mistakes.kinds.units import number_of
from tests.mistakes.planting import Edit, Program, kind

GROUP = "values of another kind"
_ANGLES = ("joints", "joint speeds")


@kind(GROUP, 'text for a truth value: `"True"`')
def text_for_truth(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Constant):
        parent = program.parents.get(node)
        if isinstance(node.value, bool) and isinstance(parent, ast.Call | ast.Compare | ast.keyword):
            yield Edit(node, f'"{node.value}"')


@kind(GROUP, "text for a number as an argument")
def text_for_number(program: Program) -> Iterator[Edit]:
    for _, _, param, value in program.arguments(lambda quantity: quantity.type_name in ("int", "float", "bool")):
        if number_of(value) is not None and param.name:
            yield Edit(value, f'"{program.source(value)}"')


@kind(GROUP, "number for a text as an argument")
def number_for_text(program: Program) -> Iterator[Edit]:
    for _, _, _, value in program.arguments(lambda quantity: quantity.type_name == "str"):
        if isinstance(value, ast.Constant) and isinstance(value.value, str) and value.value:
            yield Edit(value, "1")


@kind(GROUP, "comparison with a text for a number")
def compared_with_text(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Compare):
        right = node.comparators[-1]
        if number_of(right) is not None and isinstance(node.ops[-1], ast.Eq | ast.NotEq):
            yield Edit(right, f'"{program.source(right)}"')


@kind(GROUP, "comparison with a number for a text or a truth value")
def compared_with_number(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Compare):
        right = node.comparators[-1]
        is_text = isinstance(right, ast.Constant) and isinstance(right.value, str | bytes) and right.value
        if is_text and isinstance(node.ops[-1], ast.Eq | ast.NotEq):
            yield Edit(right, "1")


@kind(GROUP, "list compared with a number")
def list_compared(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Compare):
        left = node.left
        if (
            isinstance(left, ast.Subscript)
            and isinstance(left.value, ast.Name)
            and number_of(node.comparators[0]) is not None
        ):
            yield Edit(left, left.value.id)


@kind(GROUP, "truth of a position: `if str_find(...)`")
def truth_of_position(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Compare):
        call = node.left
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "str_find":
            yield Edit(node, program.source(call))
        elif isinstance(call, ast.Name) and "str_find(" in ast.unparse(program.literal(call) or call):
            yield Edit(node, program.source(call), frozenset({call.id}))


@kind(GROUP, "joints for a pose: the positions that the arm has")
def joints_for_pose(program: Program) -> Iterator[Edit]:
    for _, _, _, value in program.arguments(lambda quantity: quantity.unit == "m, rad" and quantity.meaning != "tcp"):
        if not isinstance(value, ast.Constant):
            yield Edit(value, "get_actual_joint_positions()")


@kind(GROUP, "pose for joints: the pose that the tool has")
def pose_for_joints(program: Program) -> Iterator[Edit]:
    for _, _, _, value in program.arguments(lambda quantity: quantity.meaning == "joints"):
        yield Edit(value, "get_actual_tcp_pose()")


@kind(GROUP, "`movej` with a pose, `movel` with joints")
def other_move(program: Program) -> Iterator[Edit]:
    for command, call, given in program.calls:
        target = next((value for name, (_, value) in given.items() if name in ("q", "p")), None)
        if command.name not in ("movej", "movel") or target is None:
            continue
        is_inverse = (
            isinstance(target, ast.Call) and isinstance(target.func, ast.Name) and target.func.id == "get_inverse_kin"
        )
        if command.name == "movej" and is_inverse and isinstance(target, ast.Call) and target.args:
            yield Edit(target, program.source(target.args[0]))
        else:
            yield Edit(call.func, "movel" if command.name == "movej" else "movej")


@kind(GROUP, "lists joined with `+` for `pose_add`, `pose_trans`")
def joined(program: Program) -> Iterator[Edit]:
    for command, call, _ in program.calls:
        if command.name in ("pose_add", "pose_trans") and len(call.args) == 2:
            yield Edit(call, f"{program.source(call.args[0])} + {program.source(call.args[1])}")


@kind(GROUP, "bytes for a text that is sent")
def bytes_sent(program: Program) -> Iterator[Edit]:
    for command, call, _ in program.calls:
        if command.name in ("socket_send_string", "socket_send_line") and call.args:
            value = call.args[0]
            if isinstance(value, ast.Constant) and isinstance(value.value, str):
                yield Edit(value, f"b{program.source(value)}")
            else:
                yield Edit(value, f"({program.source(value)}).encode()")


@kind(GROUP, "function for the handle of its thread")
def function_for_handle(program: Program) -> Iterator[Edit]:
    for command, call, _ in program.calls:
        if command.name in ("stop_thread", "join_thread") and call.args and isinstance(call.args[0], ast.Name):
            started = program.literal(call.args[0])
            if isinstance(started, ast.Call) and started.args:
                yield Edit(call.args[0], program.source(started.args[0]))


@kind(GROUP, "function called where it is to be handed over")
def called_for_thread(program: Program) -> Iterator[Edit]:
    for command, call, _ in program.calls:
        if command.name == "start_thread" and call.args and isinstance(call.args[0], ast.Name):
            yield Edit(call.args[0], f"{call.args[0].id}()", frozenset({call.args[0].id}))


@kind(GROUP, "call without its parentheses")
def without_parentheses(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Call):
        if isinstance(node.func, ast.Name) and not node.args and not node.keywords:
            yield Edit(node, node.func.id, frozenset({node.func.id}))


@kind(GROUP, "measured values compared exactly")
def measured_exactly(program: Program) -> Iterator[Edit]:
    for command, call, given in program.calls:
        statement = program.statement(call)
        if command.name not in ("movej", "movel") or not isinstance(statement, ast.Expr):
            continue
        target = next((value for name, (_, value) in given.items() if name in ("q", "p")), None)
        if target is not None and isinstance(target, ast.Name | ast.List):
            measured = "get_actual_joint_positions" if command.name == "movej" else "get_actual_tcp_pose"
            indent = " " * statement.col_offset
            wait = f"while {measured}() != {program.source(target)}: sync()"
            yield Edit(statement, f"{program.source(statement)}\n{indent}{wait}", frozenset({measured}))


@kind(GROUP, "`x == 1 or 2`")
def or_number(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Compare):
        right = node.comparators[-1]
        if isinstance(node.ops[-1], ast.Eq) and isinstance(right, ast.Constant) and number_of(right) is not None:
            yield Edit(right, f"{program.source(right)} or {int(number_of(right) or 0) + 1}")


@kind(GROUP, "register or signal beyond its range in a comparison")
def beyond_range(program: Program) -> Iterator[Edit]:
    wanted = (
        "modbus_get_signal_status",
        "get_standard_digital_in",
        "get_standard_analog_in",
        "get_configurable_digital_in",
    )
    for node in program.every(ast.Compare):
        left = program.literal(node.left)
        if isinstance(left, ast.Call) and isinstance(left.func, ast.Name) and left.func.id in wanted:
            right = node.comparators[-1]
            if number_of(right) is not None:
                yield Edit(right, "-1" if isinstance(node.ops[-1], ast.Lt | ast.LtE | ast.Eq) else "70000")


@kind(GROUP, "number for a truth value that is compared: `== 2`")
def truth_compared(program: Program) -> Iterator[Edit]:
    for node in program.every(ast.Call):
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        parent = program.parents[node]
        is_test = isinstance(parent, ast.If | ast.While) or (
            isinstance(parent, ast.UnaryOp) and isinstance(parent.op, ast.Not)
        )
        if name in ("get_standard_digital_in", "get_flag", "socket_open", "get_tool_digital") and is_test:
            yield Edit(node, f"{program.source(node)} == 2")


@kind(GROUP, "element of a reading that was made a list of another length")
def other_length(program: Program) -> Iterator[Edit]:
    for command, _, given in program.calls:
        if command.name == "socket_read_ascii_float" and "number" in given:
            number = number_of(given["number"][1])
            if number:
                yield Edit(given["number"][1], str(int(number) - 1))


def is_truth(quantity: object) -> bool:
    """Whether a parameter takes a truth value."""
    return isinstance(quantity, Boolean)
