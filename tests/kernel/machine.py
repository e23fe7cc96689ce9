"""A kernel with what it has said so far."""

from __future__ import annotations

from typing import Any

from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.events import Event, TextMessage
from elitescript.messages.inputs import Do, Input, RunUnit
from elitescript.messages.machine import MachineRequest
from elitescript.messages.outputs import Output
from elitescript.messages.timing import ticks_for

READY = RobotOptions(power_on=True)
FOREVER = "while True:\n    sync()\n  end"


def program(*lines: str, name: str = "job") -> RunUnit:
    """A program of these lines, as it comes from port 30001."""
    return RunUnit("primary#1", "program", f"def {name}():\n" + "".join(f"  {line}\n" for line in lines) + "end\n")


class Session:
    """Runs a kernel and keeps its events, replies and last output."""

    def __init__(self, config: RobotOptions | None = None, world: Any = None) -> None:
        self.kernel = Kernel(config or RobotOptions(), world)
        self.events: list[Event] = []
        self.replies: list[str] = []
        self.first: Output | None = None
        self.last: Any = None

    def send(self, *inputs: Input) -> Output:
        """One tick with inputs."""
        self.last = self.kernel.tick_and_snapshot(inputs)
        self.first = self.first or self.last
        self.events += self.last.events
        self.replies += [reply.text for reply in self.last.replies]
        return self.last

    def tick(self) -> Output:
        """One tick without any."""
        return self.send()

    def run(self, duration_s: float) -> None:
        """Let time go by."""
        for _ in range(ticks_for(duration_s)):
            self.send()

    def do(self, request: MachineRequest) -> Output:
        """One tick with a request."""
        return self.send(Do("ctl", request))

    def start(self, *lines: str, name: str = "job") -> Output:
        """One tick with a program of these lines."""
        return self.send(program(*lines, name=name))

    def of(self, kind: type) -> list[Any]:
        """Events of a kind."""
        return [event for event in self.events if isinstance(event, kind)]

    @property
    def texts(self) -> list[str]:
        """What was written to the log."""
        return [event.text for event in self.events if isinstance(event, TextMessage)]
