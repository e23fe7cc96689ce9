"""A client of a line protocol without a socket, and a robot that is whatever the test says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

from elitescript.messages.inputs import Input
from elitescript.messages.outputs import Output, Reply
from elitescript.messages.snapshot import RobotDescription, TaskPicture
from elitescript.protocol.connection import Connection
from elitescript.protocol.dashboard.connection import SETTLING_TICKS
from tests.protocol.snapshots import description, output

TASK = TaskPicture("test.task", "", "default.configuration", is_saved=True, is_configuration_modified=False)
OF_TASK = {field.name for field in fields(TaskPicture)}


class Peer:
    """One client, its connection, and the robot's last output."""

    def __init__(
        self, kind: Callable[[str, RobotDescription], Connection], origin: str = "peer#1", **changes: Any
    ) -> None:
        self.connection = kind(origin, description())
        self.output = picture(0, **changes)
        self.greeting = self.connection.take()
        self.inputs: list[Input] = []

    def send(self, data: bytes) -> list[bytes]:
        """Send bytes; return the messages that come back at once."""
        self.inputs += self.connection.receive(data, self.output)
        return self.connection.take()

    def tick(self, *replies: Reply, ticks: int = SETTLING_TICKS, **changes: Any) -> list[bytes]:
        """Let the robot say something and change; return the messages that come then."""
        tick = self.output.tick + ticks
        after = picture(tick, **changes) if changes else replace(self.output, tick=tick)
        self.output = replace(after, replies=replies)
        self.connection.publish(self.output)
        self.inputs += self.connection.due()
        return self.connection.take()


def picture(tick: int, **changes: Any) -> Output:
    """An output of a robot with a loaded task, with some fields of its snapshot, its state or its task changed."""
    of_task = {name: changes.pop(name) for name in OF_TASK & changes.keys()}
    return output(tick, task=replace(TASK, **of_task), **changes)
