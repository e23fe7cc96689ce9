"""Random requests in random programs: one answer each, and the same statement always shows the same."""

from __future__ import annotations

from random import Random
from typing import Any

import pytest

from elitescript.dap.framing import framed
from elitescript.debugger.api import BEFORE_STATEMENT
from tests.dap.client import Client, Failed, MemoryClient, process_client
from tests.debugger.random_programs import random_program
from tests.invariants.cases import CASES

SESSIONS = max(6, CASES // 5)
"""2,000 in `make invariants`."""

STEPS = ("next", "stepIn", "stepOut", "stepBack", "continue", "reverseContinue")
EXPRESSIONS = ("total", "shared", "total + 1", "no_such", "items[0]", "1 / 0", "get_target_joint_positions()", "((", "")


class Session:
    """A client that asks for anything, and remembers what it saw at each statement."""

    def __init__(self, rng: Random, client: MemoryClient, path: str, lines: int) -> None:
        self.rng = rng
        self.client = client
        self.path = path
        self.lines = lines
        self.seen: dict[Any, str] = {}
        self.stops = 0

    def run(self, count: int) -> None:
        client, rng = self.client, self.rng
        client.initialize(supportsInvalidatedEvent=True, supportsVariableType=True)
        launch = client.launch(self.path, stopOnEntry=rng.random() < 0.5, stopOnEnd=rng.random() < 0.7, until=5.0)
        self.breakpoints()
        if rng.random() < 0.5:
            self.ask("setExceptionBreakpoints", filters=rng.sample(["alarm", "warning"], rng.randrange(3)))
        client.stop_of(launch)
        for _ in range(count):
            self.look()
            if client.all_events[-1]["event"] == "terminated":
                break
            rng.choice((self.go, self.go, self.go, self.change, self.breakpoints, self.nonsense))()
        for request in client.requests.waiting:
            # Nothing has run since it was sent.
            client.adapter.handle(request)
        client.disconnect()

    def ask(self, command: str, **arguments: Any) -> dict[str, Any]:
        """Send a request; an error is an answer, too."""
        try:
            return self.client.request(command, **arguments)
        except Failed as error:
            # A mistake of the adapter's own would be this one.
            assert error.number != 1008, error.text
            return {}

    def thread(self) -> int:
        threads = self.ask("threads").get("threads", [])
        return int(self.rng.choice(threads)["id"]) if threads else 1

    def go(self) -> None:
        if self.rng.random() < 0.2:
            with self.client.meanwhile():
                self.client.send(
                    *self.rng.choice((("pause",), ("threads",), ("stackTrace",), ("setExceptionBreakpoints",)))
                )
        kind = self.rng.random()
        if kind < 0.8:
            self.ask(self.rng.choice(STEPS), threadId=self.thread())
        elif kind < 0.9 and self.seen:
            self.ask("elitescript/goto", statement=self.rng.choice(list(self.seen)).statement)
        else:
            self.ask("elitescript/goto", tick=self.rng.randrange(300))

    def change(self) -> None:
        frame = next(iter(self.ask("stackTrace", threadId=self.thread()).get("stackFrames", [])), {"id": 0})["id"]
        if self.rng.random() < 0.6:
            expression = self.rng.choice(EXPRESSIONS)
            context = self.rng.choice(("watch", "hover", "repl", "clipboard"))
            self.ask("evaluate", expression=expression, frameId=frame, context=context)
            if context == "repl":
                self.seen.clear()
        else:
            self.ask("setExpression", expression="shared", value=str(self.rng.randrange(9)), frameId=frame)
            self.seen.clear()

    def breakpoints(self) -> None:
        lines = [{"line": self.rng.randrange(1, self.lines + 2)} for _ in range(self.rng.randrange(3))]
        self.ask("setBreakpoints", source={"path": self.path}, breakpoints=lines)
        names = self.rng.sample(["risky", "movej", "climb", "nothing"], self.rng.randrange(2))
        self.ask("setFunctionBreakpoints", breakpoints=[{"name": name} for name in names])
        data = self.rng.sample(["shared", "standard_digital_out[1]", "tcp.z < 0.4"], self.rng.randrange(2))
        self.ask("setDataBreakpoints", breakpoints=[{"dataId": name} for name in data])

    def nonsense(self) -> None:
        command = self.rng.choice(("launch", "initialize", "scopes", "variables", "goto", "exceptionInfo", "source"))
        names = ("threadId", "frameId", "variablesReference", "targetId", "sourceReference", "program")
        value = self.rng.choice((-1, 0, 1, 99999, "x", None, [], {}, 1.5, True))
        self.ask(command, **{self.rng.choice(names): value})

    def look(self) -> None:
        stop = self.client.adapter.session.stop
        if self.client.all_events[-1]["event"] == "terminated" or stop.position.kind != BEFORE_STATEMENT:
            return
        self.stops += 1
        moment = self.client.moment(stop.thread)
        assert self.seen.setdefault(stop.position, moment) == moment


@pytest.mark.invariants
@pytest.mark.parametrize("part", range(4))
def test_each_request_gets_one_answer_and_the_same_statement_shows_the_same(part, tmp_path):
    stops = 0
    for number in range(part, SESSIONS, 4):
        rng = Random(number)
        text = random_program(rng)
        path = tmp_path / "job.script"
        path.write_text(text)
        session = Session(rng, MemoryClient(), str(path), text.count("\n"))
        session.run(25)
        stops += session.stops
    assert stops


@pytest.mark.invariants
@pytest.mark.slow
@pytest.mark.timeout(7200)
@pytest.mark.parametrize("part", range(4))
def test_processes_end_whatever_they_are_sent_and_when(part, tmp_path):
    for number in range(part, max(4, CASES // 100), 4):
        hit(Random(number), str(tmp_path / "job.script"))


def test_a_process_ends_whatever_it_is_sent_and_when(tmp_path):
    hit(Random(7), str(tmp_path / "job.script"))


def hit(rng: Random, path: str) -> None:
    """Send requests without waiting for answers, broken bytes among them, and leave at any moment."""
    with open(path, "w", encoding="utf-8") as file:  # noqa: PTH123
        file.write(random_program(rng))
    with process_client() as client:
        for command, arguments in (
            ("initialize", {"adapterID": "x"}),
            ("launch", {"program": path}),
            ("configurationDone", {}),
        ):
            client.send(command, **arguments)
        for _ in range(rng.randrange(40)):
            command = rng.choice((*STEPS, "pause", "threads", "stackTrace", "evaluate", "setBreakpoints", "restart"))
            client.send(command, threadId=1, expression="total", source={"path": path}, breakpoints=[{"line": 9}])
            if rng.random() < 0.2:
                broken(rng, client)
        if rng.random() < 0.7:
            client.disconnect_among_others()


def broken(rng: Random, client: Client) -> None:
    body = bytearray(framed({"seq": 1, "type": "request", "command": "threads"}).partition(b"\r\n\r\n")[2])
    for _ in range(3):
        body[rng.randrange(len(body))] = rng.randrange(256)
    client.send_bytes(b"Content-Length: %d\r\n\r\n%b" % (len(body), bytes(body)))
