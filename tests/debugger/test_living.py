"""Debugging a robot that lives, in memory: requests are inputs at ticks."""

from __future__ import annotations

import json
from typing import Any

from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.enums import TaskState
from elitescript.messages.events import TextMessage
from elitescript.messages.inputs import Debug, Do, Input, RunUnit
from elitescript.messages.machine import PauseTask, ResumeTask, StopTask
from elitescript.messages.outcomes import Debugged, Refused
from elitescript.services.debugging import debugging

COUNT = """def count():
  global n
  n = 0
  while True:
    n = n + 1
    textmsg(n)
    sleep(0.1)
  end
end
"""


class Living:
    """A robot with a debugger."""

    def __init__(self, **options: Any) -> None:
        self.kernel = Kernel(RobotOptions(power_on=True, **options), debugging=debugging())
        self.events: list[dict[str, Any]] = []
        self.said: list[str] = []
        self.last: Any = None
        self._count = 0

    def tick(self, *inputs: Input, count: int = 1) -> None:
        for _ in range(count):
            self.last = self.kernel.tick_and_snapshot(inputs)
            inputs = ()
            self.said += [event.text for event in self.last.events if isinstance(event, TextMessage)]
            for reply in self.last.replies:
                if reply.origin == "ctl#1" and isinstance(reply.outcome, Debugged):
                    self.events.append(json.loads(reply.outcome.text))

    def run(self, text: str = COUNT, origin: str = "primary#1", kind: str = "program") -> None:
        self.tick(RunUnit(origin, kind, text))

    def ask(self, do: str, session: str = "ctl#1", **arguments: Any) -> Any:
        """Ask, in one tick; return the result, or the refusal as a text that begins with `refused: `."""
        self._count += 1
        origin = f"{session}/{self._count}"
        self.tick(Debug(origin, session, json.dumps({"do": do, **arguments})))
        (outcome,) = (reply.outcome for reply in self.last.replies if reply.origin == origin)
        return f"refused: {outcome.reason}" if isinstance(outcome, Refused) else json.loads(outcome.text)["result"]

    def until(self, event: str, ticks: int = 2000) -> dict[str, Any]:
        """Run to the next event of a kind, and forget those before."""
        for _ in range(ticks):
            while self.events:
                found = self.events.pop(0)
                if found["event"] == event:
                    return found
            self.tick()
        raise AssertionError(f"no event {event!r} within {ticks} ticks")

    def stop(self) -> dict[str, Any]:
        stop: dict[str, Any] = self.until("stopped")["stop"]
        return stop

    @property
    def task(self) -> TaskState:
        return self.kernel.controller.task_state

    @property
    def n(self) -> int:
        return int(self.kernel.host.monitor()["n"])


def test_a_line_breakpoint_pauses_the_task_before_the_line() -> None:
    living = Living()
    living.run()
    states = living.ask("set_breakpoints", requests=[{"line": 6}])
    assert [(state["verified"], state["line"]) for state in states] == [(True, 6)]
    stop = living.stop()
    assert (stop["reason"], stop["thread"], stop["line"], stop["hits"]) == ("breakpoint", 1, 6, [1])
    assert living.task is TaskState.PAUSED
    n, said = living.n, list(living.said)
    living.tick(count=500)
    assert (living.n, living.said) == (n, said)
    assert living.ask("resume") is None
    stop = living.stop()
    assert (living.n, stop["line"], living.said) == (n + 1, 6, [*said, str(n)])


def test_steps() -> None:
    living = Living()
    living.run()
    living.ask("pause")
    assert living.stop()["reason"] == "pause"
    lines = []
    for _ in range(6):
        living.ask("next", thread=1)
        stop = living.stop()
        assert stop["reason"] == "step"
        lines.append(stop["line"])
    assert lines == [4, 5, 6, 7, 4, 5]
