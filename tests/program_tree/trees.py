"""Random trees and random edits of them, from a seed."""

from __future__ import annotations

from random import Random

from elitescript.program_tree import nodes
from elitescript.program_tree.cells import Expression, TextCell, VariableCell, expression
from elitescript.program_tree.nodes import Node, Position
from elitescript.program_tree.task import Task

NAMES = ("a", "b", "计数", "Loop_1", "x<y")


def random_task(random: Random, size: int = 12, *, is_runnable: bool = False) -> Task:
    """Return a task of about `size` nodes; a runnable one does not loop and sets its variables first."""
    making = _Making(random, is_runnable=is_runnable)
    children = making.nodes(size, 0)
    parts: list[Node] = [nodes.InitVariables(type_name="Init Variables Value")]
    if random.random() < 0.3:
        parts.append(nodes.BeforeStart(type_name="BeforeStart", children=making.nodes(2, 3)))
    if is_runnable:
        start = tuple(nodes.Assignment(variable=name, value=expression("1")) for name in making.variables)
        children = (*start, *children)
    parts.append(
        nodes.MainTask(
            type_name="Robot Main Task",
            loops=not is_runnable and random.random() < 0.5,
            has_before_start=len(parts) > 1,
            children=children,
        )
    )
    return Task("cell", "inst", "CS66", parts=tuple(parts))


class _Making:
    def __init__(self, random: Random, *, is_runnable: bool) -> None:
        self.random = random
        self.is_runnable = is_runnable
        self.variables = ("a", "b", "计数")

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
            match random.randrange(5):
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
        match random.randrange(10):
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

    def move(self) -> Node:
        random = self.random
        joints = tuple(round(value + random.uniform(-0.1, 0.1), 4) for value in (0.0, -1.5, -1.5, -1.5, 1.5, 0.0))
        point = nodes.Waypoint(
            name=random.choice(NAMES),
            target=Position(joints),  # type: ignore[arg-type]
            has_own_radius=random.random() < 0.2,
            radius=0.0,
        )
        return nodes.Move(
            movement=random.choice(("joint", "linear")),
            has_joint_positions=True,
            joint_speed=1.0,
            speed=0.25,
            children=(point, *((point,) if random.random() < 0.2 else ())),
        )

    def condition(self) -> Expression:
        name = self.random.choice(self.variables)
        return Expression((VariableCell(name), TextCell("<"), TextCell("2")))
