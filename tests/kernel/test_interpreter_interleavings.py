"""Interpreter mode under everything that clients can do to it at once, in random order."""

from __future__ import annotations

import random
import re
from collections import Counter
from itertools import pairwise

import pytest

from elitescript.environment.memory import MemoryEnvironment
from elitescript.kernel import Kernel
from elitescript.messages.enums import TaskState
from elitescript.messages.inputs import ClosePopup, Do, Input, Query, RunUnit
from elitescript.messages.machine import PauseTask, ResumeTask, StopTask
from elitescript.messages.outputs import Output
from elitescript.protocol.interpreter import WORDS, InterpreterConnection
from tests.invariants.cases import first_of
from tests.kernel.machine import READY, program

SEEDS = range(12)
TICKS = 250
REST_TICKS = 400
"""For what waits: sleeps and moves of the statements."""

COMMON = (
    "g = {n}",
    "x = x + {n}",
    "y{n} = {n}",
    "textmsg({n})",
    "sync(); {n}",
    "sleep(0.02); {n}",
    "def f{n}(): ; global g ; g = {n} ; end",
    "if g > {n}: ; textmsg({n}) ; else: ; sync() ; end",
    "{n} +",
    "while g == {n}:",
    "start_thread(f, ({n},))",
    "global new{n}; new{n} = 1",
    "\udcff{n}",
    "clear_interpreter(); {n}",
    "sleep(0.05); clear_interpreter(); {n}",
    "if False: ; clear_interpreter() ; end ; {n}",
    "movej([0.{n}, -1.5, -1.5, -1.5, 1.5, 0]); {n}",
)
RARE = (
    "end_interpreter(); {n}",
    "{n} / 0",
    "halt(); {n}",
    "pause(); {n}",
    "interpreter_mode(); {n}",
    "popup('{n}', blocking=True)",
    "while True: ; sync() ; end ; {n}",
    "while True: ; {n} ; end",
)
HOSTS = (
    ("global g", "g = 1", "x = 2", "interpreter_mode()", "textmsg(g)"),
    ("global g", "g = 1", "x = 2", "sleep(0.1)", "interpreter_mode(False, False)", "interpreter_mode(True, False)"),
    ("global g", "g = 1", "x = 2", "while True:", "  try:", "    interpreter_mode(clearOnEnd=False)",
     "  except Exception:", "    sync()"),
    ("global g", "g = x = 1", "def t():", "  sleep(0.2)", "  end_interpreter()", "h = start_thread(t, ())",
     "interpreter_mode()", "sleep(0.1)", "interpreter_mode()"),
    ("sleep(0.3)",),
    ("1 +",),
)  # fmt: skip
SECONDARIES = ("end_interpreter()", "clear_interpreter()", "halt()", "textmsg(1)", "interpreter_mode()")


class Client:
    """One client, and what it was told of each of its lines."""

    def __init__(self, origin: str, kernel: Kernel) -> None:
        self.connection = InterpreterConnection(origin, kernel.description)
        self.lines: list[str] = []
        self.words: Counter[str] = Counter()
        self.heard: list[str] = []

    def send(self, data: bytes, output: Output, *, in_bytes: bool) -> list[Input]:
        pieces = [data[at : at + 1] for at in range(len(data))] if in_bytes else [data]
        return [item for piece in pieces for item in self.connection.receive(piece, output)]

    def hear(self, output: Output) -> list[Input]:
        self.connection.publish(output)
        for message in self.connection.take():
            assert message.endswith(b"\n") and message.count(b"\n") == 1
            self.heard.append(message[:-1].decode())
        return self.connection.due()


class Play:
    """A seeded session."""

    def __init__(self, seed: int, *, in_bytes: bool = False) -> None:
        self.chance = random.Random(seed)
        self.in_bytes = in_bytes
        self.kernel = Kernel(READY, MemoryEnvironment({}))
        self.output = self.kernel.tick_and_snapshot()
        self.said: list[str] = []
        self.clients: list[Client] = []
        self.present: list[Client] = []
        self.count = 0
        self.inputs: list[Input] = []

    def run(self) -> Play:
        for _ in range(TICKS):
            for _ in range(self.chance.randrange(3)):
                self.act()
            self.tick()
        self.inputs += [Do("ctl", ResumeTask()), ClosePopup("ctl")]
        for _ in range(REST_TICKS):
            self.tick()
        self.inputs.append(Do("ctl", StopTask()))
        for _ in range(50):
            self.tick()
        return self

    def tick(self) -> None:
        inputs, self.inputs = self.inputs, []
        self.output = self.kernel.tick_and_snapshot(inputs)
        self.said.append(repr((self.output.tick, self.output.events, self.output.replies)))
        for client in self.present:
            self.inputs += client.hear(self.output)

    def act(self) -> None:
        chance = self.chance
        action = chance.random()
        if not self.present or action < 0.03:
            client = Client(f"interpreter#{len(self.clients) + 1}", self.kernel)
            self.clients.append(client)
            self.present.append(client)
        elif action < 0.05:
            client = self.present.pop(chance.randrange(len(self.present)))
            self.clients.remove(client)
            self.inputs += client.connection.closed()
            self.clients.append(Client("gone", self.kernel))
        elif action < 0.12:
            self.inputs.append(program(*chance.choice(HOSTS)))
        elif action < 0.15:
            body = chance.choice(SECONDARIES)
            self.inputs.append(RunUnit("primary#1", "secondary", f"sec s():\n  {body}\nend\n"))
        elif action < 0.2:
            request = chance.choice((PauseTask(), ResumeTask(), ResumeTask(), StopTask()))
            self.inputs.append(Do("ctl", request))
        elif action < 0.22:
            self.inputs.append(ClosePopup("ctl"))
        elif action < 0.25:
            self.inputs.append(Query("query#1/1", "g"))
        else:
            self.talk(chance.choice(self.present))

    def talk(self, client: Client) -> None:
        chance = self.chance
        data = b""
        for _ in range(chance.choice((1, 1, 2, 30))):
            if chance.random() < 0.2:
                word = chance.choice(list(WORDS))
                client.words[word] += 1
                data += word.encode() + b"\n"
                continue
            self.count += 1
            line = chance.choice(RARE if chance.random() < 0.05 else COMMON).format(n=100000 + self.count)
            data += line.encode("utf-8", "surrogateescape") + chance.choice((b"\n", b" \r\n"))
            client.lines.append(line.replace("\udcff", "\ufffd"))
        self.inputs += client.send(data, self.output, in_bytes=self.in_bytes)


@pytest.mark.parametrize("seed", first_of(SEEDS, 6))
def test_every_line_has_one_reply_whatever_happens(seed: int) -> None:
    play = Play(seed).run()
    assert play.output.snapshot.robot.task_state is TaskState.STOPPED
    for client in play.clients:
        first: list[str] = []
        later: Counter[str] = Counter()
        words: Counter[str] = Counter()
        for reply in client.heard:
            kind, _, rest = reply.partition(": ")
            if kind == "state":
                words[rest.rpartition(": ")[2]] += 1
                continue
            line = next(line for line in client.lines if reply.endswith(f": {line}"))
            if line in first:
                assert reply.startswith("discard: Cleaned up")
                later[line] += 1
            else:
                assert kind in ("ack", "discard")
                first.append(line)
        assert first == client.lines
        assert all(count == 1 for count in later.values())
        assert words == {word: count for word, count in client.words.items() if WORDS[word].reply}


@pytest.mark.parametrize("seed", first_of(SEEDS[:3], 1))
def test_it_is_the_same_in_every_run_and_however_the_bytes_arrive(seed: int) -> None:
    said = Play(seed).run().said
    assert Play(seed).run().said == said
    assert Play(seed, in_bytes=True).run().said == said


@pytest.mark.parametrize("seed", first_of(SEEDS[:5], 2))
def test_numbers_of_a_program_have_no_gaps(seed: int) -> None:
    numbers = [int(found) for text in Play(seed).run().said for found in re.findall(r"text=.ack: (\d+):", text)]
    for before, after in pairwise(numbers):
        assert after in (1, before + 1)
