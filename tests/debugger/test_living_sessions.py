"""Random sessions of a debugger with a living robot: nothing hangs, and a program computes the same."""

from __future__ import annotations

import json
from pathlib import Path
from random import Random
from typing import Any

import pytest

from elitescript.environment.memory import MemoryFiles
from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Alarm, TextMessage
from elitescript.messages.inputs import Debug, Do, Input, RunUnit
from elitescript.messages.machine import PauseTask, ResumeTask
from elitescript.messages.outcomes import Debugged
from elitescript.services.debugging import debugging
from elitescript.services.journal.replay import RecordedRobot, Replay
from elitescript.services.journal.writer import Journal, JournalReader
from tests.debugger.test_living import COUNT, FUNCTIONS
from tests.invariants.cases import CASES

TICKS_MAX = 20_000

PROGRAM = """def job():
  global total, log
  total = 0
  log = []
  lock = RLock()
  def add(who, n):
    global total
    lock.acquire()
    total = total + n
    log.append(who)
    lock.release()
  end
  def other(n):
    for k in range(n):
      add("b", k)
      sleep(0.02)
    end
  end
  handle = start_thread(other, (12,))
  for k in range(10):
    add("a", k * 100)
    movej([0.01 * k, -1.57, 1.57, -1.57, 1.57, 0], a=8, v=3)
    x = 0
    while x < 20:
      x = x + 1
      if x % 7 == 0:
        total = total + 1
      end
    end
    set_standard_digital_out(k % 4, k % 2 == 0)
  end
  join_thread(handle)
  textmsg("total ", total, " of ", len(log))
end
"""
PROGRAM = PROGRAM.replace("lock = RLock()", "import threading\n  lock = threading.RLock()")
LINES = PROGRAM.count("\n")
OPTIONS = RobotOptions(power_on=True, joints=(0.0, -1.57, 1.57, -1.57, 1.57, 0.0))


class Client:
    """Asks at random."""

    def __init__(self, rng: Random) -> None:
        self._rng = rng
        self._count = 0
        self.is_stopped = False
        self.stops = 0

    def request(self, do: str, **arguments: Any) -> Debug:
        self._count += 1
        return Debug(f"ctl#1/{self._count}", "ctl#1", json.dumps({"do": do, **arguments}))

    def any_request(self) -> Input:
        rng = self._rng
        lines = [{"line": rng.randrange(1, LINES + 3), **self._condition()} for _ in range(rng.randrange(3))]
        return rng.choice(
            (
                lambda: self.request("resume"),
                lambda: self.request(rng.choice(("next", "step_in", "step_out")), thread=rng.randrange(1, 4)),
                lambda: self.request("pause"),
                lambda: self.request("set_breakpoints", requests=lines),
                lambda: self.request("set_function_breakpoints", requests=[{"name": rng.choice(("add", "movej"))}]),
                lambda: self.request("set_data_breakpoints", requests=[{"data_id": rng.choice(DATA)}]),
                lambda: self.request("set_exception_filters", filters=["alarm", "warning"]),
                lambda: self.request(rng.choice(("threads", "state", "sources", "nothing"))),
                lambda: self.request("stack", thread=rng.randrange(1, 4)),
                lambda: self.request("scopes", frame=rng.randrange(4)),
                lambda: self.request("variables", reference=rng.randrange(6)),
                lambda: self.request(
                    "evaluate", text=rng.choice(("total", "k", "log[-1]", "1 +", "add(1, 2)", "get_tcp_force()"))
                ),
                lambda: self.request("detach", leaves_paused=False),
                lambda: Do("dashboard#1", rng.choice((PauseTask(), ResumeTask()))),
            )
        )()

    def _condition(self) -> dict[str, str]:
        return self._rng.choice(({}, {"condition": "k > 3"}, {"hit_condition": "% 2"}, {"log_message": "{total}"}))

    def take(self, output: Any) -> None:
        for reply in output.replies:
            if reply.origin == "ctl#1" and isinstance(reply.outcome, Debugged):
                event = json.loads(reply.outcome.text)["event"]
                self.stops += event == "stopped"


DATA = ("total", "standard_digital_out[0]", "total > 1000", "tcp.z < 0.3", "robot mode")


def end_of(kernel: Kernel, client: Client | None = None, rng: Random | None = None) -> tuple[Any, ...]:
    """Run the program to its end; return what it has computed, said and done."""
    said: list[str] = []
    inputs: list[Input] = [RunUnit("primary#1", "program", PROGRAM)]
    for tick in range(TICKS_MAX):
        if client is not None and rng is not None:
            if tick < 1500 and rng.random() < 0.1:
                inputs.append(client.any_request())
            elif tick == 1500:
                # Whatever the debugger has done: it leaves, and somebody resumes what he may have paused himself.
                inputs += [client.request("detach"), Do("dashboard#1", ResumeTask())]
        output = kernel.tick_and_snapshot(inputs)
        inputs = []
        if client is not None:
            client.take(output)
        said += [event.text for event in output.events if isinstance(event, TextMessage | Alarm)]
        if tick > 1500 or client is None:
            task = kernel.controller.task_state
            assert task is not TaskState.PAUSED or client is None
            if task is TaskState.STOPPED:
                values = kernel.host.monitor()
                signals = [kernel.controller.read("standard_digital_out", index) for index in range(4)]
                return said, values["total"], sorted(values["log"]), signals, output.snapshot.robot.q_target
    raise AssertionError("the program does not end")


def test_random_sessions_leave_a_program_what_it_computes() -> None:
    plain = end_of(Kernel(OPTIONS))
    assert plain[0][-1].startswith("total ")
    stops = 0
    for seed in range(max(6, CASES // 8)):
        rng = Random(seed)
        client = Client(rng)
        assert end_of(Kernel(OPTIONS, debugging=debugging()), client, rng) == plain, seed
        stops += client.stops
    assert stops > 20


@pytest.mark.parametrize("seed", range(3))
def test_a_journal_with_a_debugger_is_replayed_to_the_same_bytes(tmp_path: Path, seed: int) -> None:
    path = tmp_path / "a.journal"
    journal, rng = Journal(path, OPTIONS), Random(seed)
    client = Client(rng)
    robot = RecordedRobot(OPTIONS, MemoryFiles({}), journal)
    outputs = []
    for tick in range(600):
        inputs: list[Input] = [client.any_request()] if rng.random() < 0.2 else []
        if tick in (3, 200):
            inputs.append(RunUnit("primary#1", "program", (COUNT, FUNCTIONS)[tick > 100]))
        outputs.append(robot.tick(inputs).with_snapshot(robot.snapshot()))
        client.take(outputs[-1])
    journal.close()
    session = Replay(JournalReader(path))
    assert list(session.outputs()) == outputs
    assert session.difference is None
    assert client.stops > 3
