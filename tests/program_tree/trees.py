"""Random trees and random edits of them, from a seed."""

from __future__ import annotations

from random import Random

from elitescript.kinematics.transforms import pose_from_transform
from elitescript.models.model import load_model
from elitescript.program_tree import nodes
from elitescript.program_tree.cells import Expression, TextCell, VariableCell, expression
from elitescript.program_tree.nodes import Node, Position
from elitescript.program_tree.task import Task
from elitescript.records import replace

ARM = load_model("CS66").arm
NAMES = ("a", "b", "计数", "Loop_1", "x<y")


def random_task(random: Random, size: int = 12, *, is_runnable: bool = False) -> Task:
    """Return a task of about `size` nodes; a runnable one does not loop and sets its variables first."""
    making = _Making(random, is_runnable=is_runnable)
    children = making.nodes(size, 0)
    parts: list[Node] = [nodes.InitVariables(type_name="Init Variables Value")]
    if random.random() < 0.3:
        parts.append(nodes.BeforeStart(type_name="BeforeStart", children=making.nodes(2, 3)))
    turns = tuple(f"turn_{level}" for level in range(6))
    if is_runnable:
        start = tuple(nodes.Assignment(variable=name, value=expression("1")) for name in (*making.variables, *turns))
        if len(parts) > 1:
            parts[1] = replace(parts[1], children=(*start, *parts[1].children))
        else:
            children = (*start, *children)
    parts.append(
        nodes.MainTask(
            type_name="Robot Main Task",
            loops=not is_runnable and random.random() < 0.5,
            has_before_start=len(parts) > 1,
            children=children,
        )
    )
    parts += making.beside()
    return Task("cell", "", "CS66", parts=tuple(parts))


def rounded(pose: tuple[float, ...]) -> tuple[float, ...]:
    """Return a pose as a file can hold it, in millimetres."""
    return tuple(round(value, 6) for value in pose)


class _Making:
    def __init__(self, random: Random, *, is_runnable: bool) -> None:
        self.random = random
        self.is_runnable = is_runnable
        self.variables = ("a", "b", "计数")

    def beside(self) -> list[Node]:
        """Return sub-tasks, threads and events, which the main task may call or that run beside it."""
        random = self.random
        found: list[Node] = []
        inside: tuple[Node, ...]
        if random.random() < 0.3:
            found.append(
                nodes.SubTask(name="grip", children=(nodes.Set(pin="digital_out[6]"), nodes.Wait(duration=0.02)))
            )
        if random.random() < 0.2:
            inside = (nodes.Wait(duration=0.05), nodes.Assignment(variable="seen", value=expression("1")))
            found.append(nodes.Thread(name="watch", loops=random.random() < 0.5, children=inside))
        if random.random() < 0.2:
            inside = (nodes.Set(pin="digital_out[7]"),)
            found.append(nodes.Event(name="rise", condition=expression("get_standard_digital_in(3)"), children=inside))
        return found

    def nodes(self, count: int, level: int) -> tuple[Node, ...]:
        made = []
        while count > 0:
            inside = self.random.randrange(count) if level < 5 else 0
            node = self.node(inside, level)
            made.append(node)
            count -= 1 + inside
        return tuple(made)

    def node(self, inside: int, level: int) -> Node:
        random = self.random
        is_suppressed = random.random() < 0.1
        if inside:
            children = self.nodes(inside, level + 1)
            match random.randrange(7):
                case 5:
                    return nodes.If(condition=self.condition(), is_continuous=True, children=children)
                case 6:
                    return nodes.Loop(
                        kind="expression",
                        condition=self.ended(level),
                        is_post_test=random.random() < 0.5,
                        children=(*children, self.counted(level)),
                    )
                case 0:
                    return nodes.Folder(name=random.choice(NAMES), children=children, is_suppressed=is_suppressed)
                case 1:
                    return nodes.If(condition=self.condition(), children=children, is_suppressed=is_suppressed)
                case 2:
                    return nodes.If(
                        condition=self.condition(),
                        children=children,
                        branches=(
                            nodes.ElseIf(condition=self.condition(), children=self.nodes(1, level + 1)),
                            nodes.Else(children=self.nodes(1, level + 1)),
                        ),
                    )
                case 3:
                    return nodes.Switch(
                        value=self.condition(),
                        children=(
                            nodes.Case(name="case_1", children=children),
                            nodes.Case(name="default case", children=self.nodes(1, level + 1)),
                        ),
                    )
                case _:
                    return nodes.Loop(
                        kind="count", count=random.randrange(3), variable=f"Loop_{level}", children=children
                    )
        match random.randrange(15):
            case 10:
                return self.direction()
            case 11:
                return nodes.Wait(
                    kind="input", pin="digital_in[3]", is_high=random.random() < 0.5, has_timeout=True, timeout=0.3
                )
            case 12:
                return nodes.Wait(kind="expression", condition=self.condition(), has_timeout=True, timeout=0.1)
            case 13:
                return nodes.Timer(action=random.choice(nodes.TIMER_ACTIONS), variable="t1")
            case 14:
                pose = random.random() < 0.5
                return self.move(has_pose=pose, relative=not pose)
            case 0:
                return nodes.Wait(duration=random.choice((0.01, 0.5, 7.5e-7)), is_suppressed=is_suppressed)
            case 1:
                return nodes.Set(pin="digital_out[3]", is_high=random.random() < 0.5)
            case 2:
                return nodes.Set(kind="analog", pin="analog_out[0]", value=0.012, unit="A")
            case 3:
                return nodes.Assignment(variable=random.choice(self.variables), value=self.condition())
            case 4:
                return nodes.Comment(text=random.choice(("", "one", "two\nlines", 'a "b" <c>')))
            case 5:
                return nodes.ScriptLine(statement=expression("textmsg(1)"))
            case 6:
                return nodes.ScriptFile(path="f.script", text="textmsg('<a & b>')\n\nsync()\n")
            case 7:
                return self.move()
            case 8:
                return nodes.Popup(message='a "b"', kind=random.choice(("info", "warning")))
            case _:
                return nodes.Placeholder(type_name="PlaceHolder")

    def ended(self, level: int) -> Expression:
        """Return a condition that `counted` makes false after a few turns."""
        return Expression((VariableCell(f"turn_{level}"), TextCell("%"), TextCell("3"), TextCell(">"), TextCell("0")))

    def counted(self, level: int) -> Node:
        return nodes.Assignment(variable=f"turn_{level}", value=expression(f"turn_{level} + 1"))

    def direction(self) -> Node:
        """Return a motion along a line that ends after at most 2 cm, whatever the input says."""
        random = self.random
        untils: tuple[Node, ...] = (
            nodes.Until(kind="distance", distance=random.choice((0.005, 0.02))),
            nodes.Until(
                kind="input",
                pin="digital_in[4]",
                has_own_deceleration=random.random() < 0.5,
                deceleration=random.choice((0.4, 3.0)),
                children=(nodes.Set(pin="digital_out[5]"),),
            ),
        )
        axis = random.choice(tuple(nodes.DIRECTIONS))
        home = self.move(movement="joint")
        line = nodes.Move(
            movement="linear",
            speed=0.1,
            acceleration=random.choice((0.5, 1.2)),
            children=(nodes.Direction(axis=axis, children=untils),),
        )
        return nodes.Folder(name="line", children=(home, line))

    def move(self, *, movement: str = "", has_pose: bool = False, relative: bool = False) -> Node:
        random = self.random
        joints = tuple(round(value + random.uniform(-0.1, 0.1), 4) for value in (0.0, -1.5, -1.5, -1.5, 1.5, 0.0))
        pose = ARM.forward(joints) if has_pose else None
        point = nodes.Waypoint(
            name=random.choice(NAMES),
            target=Position(joints, None if pose is None else rounded(pose_from_transform(pose))),  # type: ignore[arg-type]
            has_own_radius=random.random() < 0.2,
            radius=0.0,
            motion_by=random.choice(nodes.MOTION_BY),
            duration=1.5,
            joint_speed=0.5,
            speed=0.1,
            children=(nodes.Until(kind="input", pin="digital_in[4]"),) if random.random() < 0.1 else (),
        )
        if relative:
            start = (0.4, 0.1, 0.3, 0.0, 0.0, 0.0)
            end = (0.4, 0.1, 0.3 + random.choice((-0.01, 0.01)), 0.0, 0.0, 0.0)
            point = nodes.Waypoint(
                name="R", position="relative", start=Position(joints, start), target=Position(joints, end)
            )
        return nodes.Move(
            movement=movement or random.choice(("joint", "linear")),
            has_joint_positions=not has_pose or random.random() < 0.5,
            joint_speed=1.0,
            speed=0.25,
            children=(point, *((point,) if random.random() < 0.2 else ())),
        )

    def condition(self) -> Expression:
        name = self.random.choice(self.variables)
        return Expression((VariableCell(name), TextCell("<"), TextCell("2")))
