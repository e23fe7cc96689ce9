"""Graphical programs: what reading a tree, generating its script and checking both takes.

The aims, for 5,000 nodes: 0.3 s to read, 0.2 s to generate, and a check that costs no more than that of a script with
as many lines, 2.5 s at most.
"""

from __future__ import annotations

from functools import partial
from itertools import cycle

from benchmarks.checking import text_of
from benchmarks.measure import best_in_turn
from benchmarks.table import Row, timed_row

NODES = 5_000
ROUNDS = 5

_QUANTITY = (
    '<{name} value="{value}" unit="{unit}"><valueInSi>{value}</valueInSi>'
    '<siUnit class="cn.elibot.robot.plugin.domain.value.{kind}$Unit">{unit}</siUnit></{name}>'
)


def _quantity(name: str, value: str, unit: str, kind: str) -> str:
    return _QUANTITY.format(name=name, value=value, unit=unit, kind=kind)


PARTS = (
    f'<WaitNode type="WAIT_TIME" timeoutEnable="false" typeName="Wait">{_quantity("waitTime", "0.01", "S", "Time")}'
    "</WaitNode>",
    '<SetNode type="DIGITAL_OUTPUT" typeName="Set"><digitalOutputPinName>digital_out[{d}]</digitalOutputPinName>'
    "<digitalOutputPinValue>HIGH</digitalOutputPinValue></SetNode>",
    '<AssignmentNode valueSourceType="EXPRESSION" deepCopy="false" typeName="Assignment">'
    '<TaskVariable name="n{d}" type="Default"/><Expression><ExpressionCharCell char="{d}"/></Expression>'
    "</AssignmentNode>",
    '<IfNode checkExpressionContinuous="false" typeName="If"><Expression><ExpressionTokenCell token="in" '
    'scriptCode="get_standard_digital_in({d})"/></Expression><children><HaltNode typeName="Halt"/></children></IfNode>',
    '<MoveNode movementType="JOINT_MOVEMENT" positionType="JOINT_ANGLES" tcpType="ACTIVE_TCP" typeName="MoveJ">'
    f"<frameReference>Ctrl_base_frame</frameReference>{_quantity('jointSpeed', '1.0', 'RAD_S', 'AngularSpeed')}"
    f"{_quantity('jointAcceleration', '1.4', 'RAD_S2', 'AngularAcceleration')}"
    '<WaypointNode name="W{n}" positionNodeType="FIXED_POSITION" customTransitionRadius="false" '
    'advancedPositionOptionType="INHERITED_PARAMETERS" typeName="Waypoint"><internalPosition>'
    '<jointPositions joints="0.{d}, -1.5, -1.5, -1.5, 1.5, 0.0"/>'
    '<toolPose X="0.0" Y="0.0" Z="0.0" RX="0.0" RY="0.0" RZ="0.0"/></internalPosition></WaypointNode></MoveNode>',
)
"""Nodes of a tree; two of the five kinds hold another node."""


def tree_of(count: int) -> str:
    """Return a task of about so many nodes."""
    nodes, made = [], 0
    for number, part in enumerate(cycle(PARTS)):
        if made >= count:
            break
        nodes.append(part.replace("{n}", str(number)).replace("{d}", str(number % 8)))
        made += 1 + (number % len(PARTS) > 2)
    return (
        '<EliTask name="cell" robotType="CS66"><InitVariables/><MainTask isTaskAlwaysLoops="true" '
        f'hasInitVariables="true" typeName="Robot Main Task">{"".join(nodes)}</MainTask></EliTask>'
    )


def rows() -> list[Row]:
    """Read, generate and check a task of 5,000 nodes."""
    from elitescript.environment.task_files import script_of_data
    from elitescript.language.text.source import SourceFile
    from elitescript.lint.engine import check_source
    from elitescript.messages.profile import profile
    from elitescript.models.model import load_model
    from elitescript.program_tree import generated, read_task

    data = tree_of(NODES).encode()
    task = read_task(data)
    source, errors = script_of_data("cell.task", {"cell.task": data}.get)
    assert not errors
    lines = len(source.lines)
    arm = load_model("CS66")
    plain = SourceFile("cell.script", text_of("mixed statements", lines))

    def check() -> None:
        made, _ = script_of_data("cell.task", {"cell.task": data}.get)
        check_source(made, profile(), arm=arm)

    steps = {
        f"read a task of {NODES:,} nodes ({len(data) / 1e6:.1f} MB)": partial(read_task, data),
        f"generate its script ({lines:,} lines)": partial(generated, task),
        "read, generate and check it": check,
        f"check a script of {lines:,} mixed lines": lambda: check_source(plain, profile(), arm=arm),
    }
    return [timed_row(what, time) for what, time in zip(steps, best_in_turn(list(steps.values()), ROUNDS), strict=True)]
