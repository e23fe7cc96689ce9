"""Moves: waypoints, circles, directions, and what ends a motion."""

from __future__ import annotations

from math import pi
from typing import Final

from elitescript.kinematics.pose import pose_inv, pose_sub, pose_trans
from elitescript.program_tree import nodes
from elitescript.program_tree.cells import Pose, Quantity, is_taught, number_text
from elitescript.program_tree.nodes import Direction, Move, Until, Waypoint
from elitescript.program_tree.rows import Row
from elitescript.program_tree.script.writing import Script, identifier, listed
from elitescript.said import said

DEFAULTS: Final = {
    "joint_speed": Quantity(60 * pi / 180, "1.0471975511965976"),
    "joint_acceleration": Quantity(80 * pi / 180, "1.3962634015954636"),
    "speed": Quantity(0.25),
    "acceleration": Quantity(1.2),
    "radius": Quantity(0.025),
}
"""What a pendant takes where a file says nothing; rad/s, rad/s^2, m/s, m/s^2, m."""

BASE: Final = "Ctrl_base_frame"
TOOL: Final = "Ctrl_tool_frame"
HELPER: Final = "calculate_point_to_move_towards"
FAR: Final = "1000.0"
"""How far away the target of a direction is, m."""


def move(script: Script, row: Row) -> None:
    """Write a move: its mark, then what is in it, at the same level."""
    node = row.node
    assert isinstance(node, Move)
    script.mark(row)
    if node.movement not in nodes.MOVEMENTS:
        script.refuse(row, said("the kind of move {kind!r} is not known", kind=node.movement))
    if node.tcp is not None and node.tcp.strip():
        tool = script.configuration.tool(node.tcp.strip())
        if tool is None or tool.tcp is None:
            script.refuse(
                row,
                said("the configuration has no tool {name!r}", name=node.tcp.strip()),
                "Put the `.configuration` file of the installation beside the task.",
            )
        else:
            script.line(f"set_tcp([{', '.join(tool.number_texts)}])", row)
    outer, script.move = script.move, node
    for child in row.inside:
        inner = child.node
        if inner.is_suppressed:
            continue
        if isinstance(inner, Waypoint):
            waypoint(script, child)
        elif isinstance(inner, nodes.Arc):
            arc(script, child)
        elif isinstance(inner, Direction):
            direction(script, child)
        elif isinstance(inner, nodes.Placeholder):
            script.mark(child)
        elif isinstance(inner, nodes.Comment):
            script.mark(child)
            for line in inner.text.splitlines() or [""]:
                script.comment(f"# {line}", child)
        else:
            script.mark(child)
            script.refuse(child, said("a `{kind}` node cannot stand in a move", kind=child.mark))
    script.move = outer


def waypoint(script: Script, row: Row) -> None:
    """Write a waypoint."""
    node = row.node
    assert isinstance(node, Waypoint)
    script.mark(row, is_after=True)
    statement = statement_of(script, row)
    if statement is None:
        return
    untils = [child for child in row.inside if not child.node.is_suppressed]
    if untils:
        in_thread(script, row, [statement], untils)
    else:
        script.line(statement, row)


def statement_of(script: Script, row: Row) -> str | None:
    """Return the statement that moves to a waypoint; None: there is none, which is a problem that is noted."""
    node, move = row.node, script.move
    assert isinstance(node, Waypoint)
    target = target_of(script, row)
    if target is None:
        return None
    command = {"joint": "movej", "linear": "movel", "process": "movep"}.get(move.movement, "movej")
    return f"{command}({target}, {', '.join(motion_of(script, row))})"


def motion_of(script: Script, row: Row) -> list[str]:
    """Return the arguments of a move that say how fast it is, and its blend."""
    node, move = row.node, script.move
    assert isinstance(node, Waypoint)
    if node.motion_by not in nodes.MOTION_BY:
        script.refuse(row, said("where its speed comes from is not known: {kind!r}", kind=node.motion_by))
    if node.motion_by == "time" and node.duration is not None and move.movement != "process":
        arguments = [f"t={number_text(node.duration)}"]
    else:
        keys = ("joint_acceleration", "joint_speed") if move.movement == "joint" else ("acceleration", "speed")
        values = [_value(node if node.motion_by == "speed" else move, key, move) for key in keys]
        arguments = [f"a={number_text(values[0])}", f"v={number_text(values[1])}"]
    if move.movement == "process":
        radius = node.radius if node.has_own_radius else move.radius
        arguments.append(f"r={number_text(DEFAULTS['radius'] if radius is None else radius)}")
    elif node.has_own_radius:
        arguments.append(f"r={number_text(Quantity(0.0) if node.radius is None else node.radius)}")
    return arguments


def _value(node: Waypoint | Move | Direction, key: str, move: Move) -> float:
    value = getattr(node, key, None)
    if value is None:
        value = getattr(move, key)
    return DEFAULTS[key] if value is None else value


def target_of(script: Script, row: Row) -> str | None:
    """Return the first argument of the move to a waypoint."""
    node, move = row.node, script.move
    assert isinstance(node, Waypoint)
    if node.position == "variable":
        if not node.variable:
            script.refuse(row, said("the waypoint has no variable"))
            return None
        return identifier(node.variable)
    if node.position == "relative":
        if node.target.pose is None or node.start.pose is None:
            script.refuse(row, said("the two places of the relative waypoint have not been taught"), _TEACH)
            return None
        offset = listed(_java(pose_sub(node.target.pose, node.start.pose)))
        moved = f"pose_add(get_target_tcp_pose(), {offset})"
        return f"get_inverse_kin({moved})" if move.movement == "joint" else moved
    if node.position != "fixed":
        script.refuse(row, said("the kind of waypoint {kind!r} is not known", kind=node.position))
        return None
    if not is_taught(node.target.joints) and node.target.pose is None:
        script.refuse(row, said("the waypoint has never been taught"), _TEACH)
        return None
    joints = listed(node.target.joints) if is_taught(node.target.joints) else ""
    if move.movement == "joint":
        if joints and (move.has_joint_positions or node.target.pose is None):
            return joints
        near = f", qnear={joints}" if joints else ""
        return f"get_inverse_kin({pose_text(script, row)}{near})"
    if node.target.pose is None:
        # Real files have no pose where the pendant can compute it. Assumed.
        return f"get_forward_kin({joints})"
    return pose_text(script, row)


_TEACH: Final = "Teach it on the pendant, or give it joint positions."


def pose_text(script: Script, row: Row) -> str:
    """Return the pose of a fixed waypoint: in the base frame, or in the frame of its move."""
    node, frame = row.node, script.move.frame
    assert isinstance(node, Waypoint) and node.target.pose is not None
    if frame in ("", BASE):
        return listed(node.target.pose)
    if script.configuration.frame(frame) is None and frame != TOOL:
        script.refuse(row, said("the configuration has no frame {name!r}", name=frame))
    base = node.frame_pose or (0.0,) * 6
    inside = _java(pose_trans(pose_inv(base), node.target.pose))
    name = "get_target_tcp_pose()" if frame == TOOL else identifier(frame)
    return f"pose_trans({name}, {listed(inside)})"


def _java(pose: tuple[float, ...]) -> Pose:
    """Return a pose that was computed, without the noise of its last digits."""
    return tuple(Quantity(round(value, 12) + 0.0) for value in pose)  # type: ignore[return-value]


def arc(script: Script, row: Row) -> None:
    """Write a circle through two waypoints."""
    node = row.node
    assert isinstance(node, nodes.Arc)
    script.mark(row, is_after=True)
    points = [child for child in row.inside if isinstance(child.node, Waypoint) and not child.node.is_suppressed]
    if len(points) != 2:
        script.refuse(row, said("a circle has a via point and an end point, here are {count}", count=len(points)))
        return
    for point in points:
        script.mark(point, is_after=True)
    via, end = target_of(script, points[0]), target_of(script, points[1])
    arguments = motion_of(script, points[1])
    if via is None or end is None:
        return
    if script.move.movement == "joint":
        script.refuse(row, said("a circle stands in a linear or process move"))
    if not any(argument.startswith("r=") for argument in arguments):
        arguments.append("r=0.0")
    mode = 0 if node.is_orientation_free is True else 1
    script.line(f"movec({via}, {end}, {', '.join(arguments)}, mode={mode})", row)


def direction(script: Script, row: Row) -> None:
    """Write a motion along a line that an until ends."""
    node, move = row.node, script.move
    assert isinstance(node, Direction)
    if move.movement == "joint":
        script.refuse(row, said("a direction stands in a linear move"))
    script.has_direction = True
    script.mark(row)
    frame_name = node.frame if node.has_own_frame and node.frame else move.frame
    if frame_name in ("", BASE):
        frame = "[0.0, 0.0, 0.0, 0.0, 0.0, 0.0]"
    elif frame_name == TOOL:
        frame = "get_forward_kin()"
    else:
        if script.configuration.frame(frame_name) is None:
            script.refuse(row, said("the configuration has no frame {name!r}", name=frame_name))
        frame = identifier(frame_name)
    if not node.is_axis:
        vector = script.expression(node.vector, row, "direction")
    elif node.axis in nodes.DIRECTIONS:
        vector = f"[{','.join(number_text(number) for number in nodes.DIRECTIONS[node.axis])}]"
    else:
        script.refuse(row, said("the direction {axis!r} is not known", axis=node.axis))
        vector = "[0.0,0.0,0.0]"
    source = node if node.has_own_motion else move
    a, v = (number_text(_value(source, key, move)) for key in ("acceleration", "speed"))
    body = [f"towardsPos = {HELPER}({frame}, {vector}, {FAR})", f"movel(towardsPos, a={a}, v={v})"]
    in_thread(script, row, body, [child for child in row.inside if not child.node.is_suppressed])


def in_thread(script: Script, row: Row, body: list[str], untils: list[Row]) -> None:
    """Write a motion in a thread of its own, which the first until that is true ends."""
    number = row.number
    flag, thread, handle = f"move_thread_flag_{number}", f"move_thread_{number}", f"move_thread_han_{number}"
    starts = [child for child in untils if isinstance(child.node, Until) and child.node.kind == "distance"]
    if starts:
        script.line(f"towardsPos_{number} = get_target_tcp_pose()", row)
    script.line(f"global {flag}", row)
    script.line(f"{flag} = 0", row)
    with script.function(f"def {thread}():", row):
        script.line(f"global {flag}", row)
        script.line(f"{flag} = 1", row)
        for line in body:
            script.line(line, row)
        script.line(f"{flag} = 2", row)
    script.line(f"{flag} = 0", row)
    script.line(f"{handle} = start_thread({thread}, (), detach_mode = False)", row)
    with script.block("while (True):", row, is_loop=True):
        for child in untils:
            if isinstance(child.node, Until):
                until(script, child, row)
            elif isinstance(child.node, nodes.Placeholder):
                script.mark(child)
            else:
                script.mark(child)
                script.refuse(child, said("a `{kind}` node cannot end a motion", kind=child.mark))
        if isinstance(row.node, Waypoint):
            with script.block(f"if ({flag} == 2):", row):
                script.line("break", row)
        script.line("sync()", row)
    if isinstance(row.node, Direction) and not any(isinstance(child.node, Until) for child in untils):
        script.refuse(row, said("the direction has no until that ends it"), "Add an until below it.")


def until(script: Script, row: Row, motion: Row) -> None:
    """Write the check of an until: its condition, the stop, its mark, what follows."""
    node, move = row.node, script.move
    assert isinstance(node, Until)
    number = motion.number
    if node.kind == "expression":
        condition = script.expression(node.condition, row, "condition")
    elif node.kind == "input":
        condition = f"{script.pin(node.pin, row)} == {node.is_high is True}"
    elif node.kind == "distance" and node.distance is not None:
        condition = f"point_dist(towardsPos_{number}, get_target_tcp_pose()) >= {number_text(node.distance)}"
    elif node.kind == "contact" and node.force is not None:
        condition = f"norm(get_tcp_force(True)[0:3]) >= {number_text(node.force)}"
    elif node.kind == "waypoint":
        condition = f"move_thread_flag_{number} == 2"
    else:
        script.refuse(row, said("what ends the motion is not known: {kind!r}", kind=node.kind))
        condition = "True"
    is_joint = move.movement == "joint"
    own = node.joint_deceleration if is_joint else node.deceleration
    inherited = _value(move, "joint_acceleration" if is_joint else "acceleration", move)
    value = own if node.has_own_deceleration is not False and own is not None else inherited
    with script.block(f"if ({condition}):", row):
        script.line(f"stop_thread(move_thread_han_{number})", row)
        script.line(f"{'stopj' if is_joint else 'stopl'}({number_text(value)})", row)
        script.mark(row)
        script.body(script, row.inside)
        script.line("break", row)
