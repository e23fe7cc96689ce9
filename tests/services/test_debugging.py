"""Debugging a served robot: real processes, its ctl socket, and what its other clients see meanwhile."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from elitescript.debugger.api import DataBreakpoint, FunctionBreakpoint, LineBreakpoint, Output
from elitescript.debugger.living import REQUESTS, LivingDebugger
from elitescript.debugger.session import DebugSession
from elitescript.errors import DebugError, UsageError
from elitescript.services.control.channel import ask
from elitescript.services.control.debugging import ServedSession
from tests.protocol import rtsi_client

SOURCE = Path(__file__).resolve().parent.parent.parent / "src"
COUNT = """def count():
  global n
  n = 0
  while True:
    n = n + 1
    sleep(0.01)
    textmsg(n)
  end
end
"""


class Serve:
    """A `serve` process with one robot."""

    def __init__(self, place: str) -> None:
        environment = {**os.environ, "PYTHONPATH": str(SOURCE), "XDG_RUNTIME_DIR": place, "PYTHONHASHSEED": "0"}
        command = [sys.executable, "-m", "elitescript", "serve", "--json", "--port", "all=0", "--power-on"]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
        assert self.process.stdout is not None
        self.stdout = self.process.stdout
        robot = json.loads(self.stdout.readline())["robots"][0]
        self.ports: dict[str, int] = robot["ports"]
        self.ctl: str = robot["ctl"]
        self.reader = threading.Thread(target=self.stdout.read, daemon=True)
        self.reader.start()

    def send(self, text: str, port: str = "primary") -> None:
        with socket.create_connection(("127.0.0.1", self.ports[port])) as peer:
            peer.sendall(text.encode())
            peer.recv(1)

    def order(self, verb: str, **values: Any) -> dict[str, Any]:
        with socket.socket(socket.AF_UNIX) as peer:
            peer.connect(self.ctl)
            peer.sendall(json.dumps({"verb": verb, "values": values}).encode() + b"\n")
            answers = map(json.loads, peer.makefile())
            answer: dict[str, Any] = next(answer for answer in answers if "event" not in answer)
            return answer

    @property
    def task(self) -> str:
        return str(self.order("state")["result"]["task_state"])

    def until(self, task: str) -> None:
        while self.task != task:
            time.sleep(0.01)


pytestmark = pytest.mark.skipif(os.name != "posix", reason="children and signals")


@pytest.fixture(scope="module")
def served() -> Iterator[Serve]:
    with tempfile.TemporaryDirectory(prefix="es") as place:
        robot = Serve(place)
        yield robot
        robot.process.send_signal(signal.SIGINT)
        assert robot.process.wait(20) == 0
        robot.reader.join()
        robot.stdout.close()


@pytest.fixture
def robot(served: Serve) -> Iterator[Serve]:
    yield served
    if served.task != "STOPPED":
        served.order("stop")
        served.until("STOPPED")


Attach = Callable[..., ServedSession]


@pytest.fixture
def attach(robot: Serve) -> Iterator[Attach]:
    """Make debuggers of the robot; they leave at the end."""
    with contextlib.ExitStack() as stack:

        def made(*listeners: Any) -> ServedSession:
            return stack.enter_context(contextlib.closing(ServedSession(robot.ctl, *listeners)))

        yield made


class Rtsi(threading.Thread):
    """A client at 250 Hz that notes the robot time of each package, and when it came."""

    def __init__(self, port: int) -> None:
        super().__init__(daemon=True)
        self.peer = socket.create_connection(("127.0.0.1", port))
        self.times: list[tuple[float, float]] = []
        self.peer.sendall(rtsi_client.output_recipe(250.0, ["timestamp"]) + rtsi_client.message("S"))
        self.start()

    def run(self) -> None:
        with self.peer, self.peer.makefile("rb") as stream:
            while len(head := stream.read(2)) == 2:
                body = stream.read(int.from_bytes(head) - 2)
                if body[:1] == b"U":
                    self.times.append((struct.unpack(">d", body[-8:])[0], time.monotonic()))

    def next(self, count: int) -> list[tuple[float, float]]:
        """The next packages, with the times at which they came."""
        first = len(self.times)
        while len(self.times) < first + count:
            assert self.is_alive()
            time.sleep(0.01)
        return self.times[first : first + count]

    def close(self) -> None:
        self.peer.shutdown(socket.SHUT_RDWR)
        self.join()


def test_a_program_is_stopped_while_other_clients_are_served(robot: Serve, attach: Attach) -> None:
    clients = Rtsi(robot.ports["rtsi"])
    robot.send(COUNT)
    said: list[Output] = []
    events: list[str] = []
    session = attach(said.append, lambda kind, content: events.append(kind))
    (state,) = session.set_breakpoints([LineBreakpoint(6, condition="n % 10 == 0")], text=COUNT)
    assert (state.verified, state.line) == (True, 6)
    stop = session.wait_for_stop()
    assert (stop.reason, stop.line, session.stop) == ("breakpoint", 6, stop)
    assert robot.task == "PAUSED"
    shown = clients.next(100)
    took_s = shown[-1][1] - shown[0][1]
    assert took_s < 0.8, "99 periods of 4 ms"
    steps = {round((later[0] - before[0]) / 0.004) for before, later in pairwise(shown)}
    assert steps == {1}
    (frame,) = session.stack(1)
    assert session.evaluate("n", frame.id).value.endswith("0")
    assert [scope.name for scope in session.scopes(frame.id)] == ["Locals", "Globals", "Robot"]
    assert [session.next(1).line for _ in range(3)] == [7, 4, 5]
    n = int(session.evaluate("n").value)
    assert session.resume().line == 6
    assert int(session.evaluate("n").value) == n + 10
    assert [int(output.text) for output in said] == list(range(int(said[0].text), n + 10))
    assert session.source_text(frame.source) == COUNT.rstrip()
    session.close()
    robot.until("PLAYING")
    assert set(events) == {"stopped"}
    clients.close()


def test_a_second_debugger_is_refused(robot: Serve, attach: Attach) -> None:
    first, second = attach(), attach()
    assert first.threads() == ()
    with pytest.raises(DebugError, match=r"^another debugger is attached: ctl#\d+$"):
        second.threads()
    first.close()
    assert second.threads() == ()
    second.close()


def test_a_debugger_that_dies_leaves_the_robot_running(robot: Serve, attach: Attach) -> None:
    robot.send(COUNT)
    session = attach()
    session.set_breakpoints([LineBreakpoint(6)])
    session.wait_for_stop()
    session._socket.shutdown(socket.SHUT_RDWR)
    robot.until("PLAYING")
    again = attach()
    n = int(again.evaluate("n").value)
    while int(again.evaluate("n").value) < n + 3:
        pass
    again.close()


def test_a_debugger_may_leave_a_program_paused(robot: Serve, attach: Attach) -> None:
    robot.send(COUNT)
    session = attach()
    assert session.start(stop_on_entry=True).reason == "pause"
    session.close(leaves_paused=True)
    assert robot.task == "PAUSED"
    robot.order("resume")
    robot.until("PLAYING")


def test_a_debugger_may_end_the_task(robot: Serve, attach: Attach) -> None:
    robot.send(COUNT)
    session = attach()
    session.close(terminates=True)
    assert robot.task == "STOPPED"


def test_a_program_that_comes_later(robot: Serve, attach: Attach) -> None:
    events: list[tuple[str, dict[str, Any]]] = []
    session = attach(None, lambda kind, content: events.append((kind, content)))
    (state,) = session.set_function_breakpoints([FunctionBreakpoint("grip")])
    assert not state.verified
    stops: list[Any] = []
    waiting = threading.Thread(target=lambda: stops.append(session.start()))
    waiting.start()
    robot.send("def job():\n  def grip():\n    sync()\n  end\n  grip()\nend\n")
    waiting.join()
    assert stops[0].line == 3
    assert [kind for kind, _ in events] == ["source", "breakpoint", "stopped"]
    robot.order("stop")
    robot.until("STOPPED")
    assert session.threads() == ()
    assert (events[-1][0], events[-1][1]["result"]) == ("ended", "stopped")
    session.close()


def test_an_input_that_somebody_else_changes(robot: Serve, attach: Attach) -> None:
    robot.send(COUNT)
    session = attach()
    session.set_data_breakpoints([DataBreakpoint("standard_digital_in[4]")])
    robot.order("set", **{"standard_digital_in[4]": True})
    stop = session.wait_for_stop()
    (change,) = stop.changes
    assert (stop.reason, change.old, change.new, change.thread_name) == ("data breakpoint", "False", "True", "client")
    session.set_signal("standard_digital_in[4]", "False")
    session.close()


def test_ctl_asks_one_question(robot: Serve) -> None:
    robot.send(COUNT)
    robot.until("PLAYING")
    answer = robot.order("debug", do="threads")
    assert (answer["ok"], answer["result"]["result"][0]["name"]) == (True, "main")
    assert robot.order("debug", do="what")["error"].startswith('debug: a request is an object of JSON in which "do" is')
    assert robot.task == "PLAYING"


def test_what_the_program_says_meanwhile_is_no_answer(robot: Serve) -> None:
    robot.send(COUNT.replace("0.01", "0.004"))
    robot.until("PLAYING")
    assert all(ask(Path(robot.ctl), "debug", [], {"do": "threads"})["ok"] for _ in range(20))


def test_a_robot_that_hangs_is_replaced_under_its_debugger(robot: Serve, attach: Attach) -> None:
    heard = threading.Event()
    session = attach(None, lambda kind, content: heard.set() if kind == "detached" else None)
    session.set_breakpoints([LineBreakpoint(3)])
    robot.send("def hang():\n  sum(range(10 ** 12))\nend\n")
    assert heard.wait(10)
    assert session.threads() == ()
    session.close()


def test_nobody_is_served_there(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no controller is served here"):
        ServedSession(tmp_path / "serve-0.sock")


def test_a_served_robot_is_debugged_with_the_methods_of_a_run() -> None:
    def methods(kind: type) -> set[str]:
        return {name for name in vars(kind) if not name.startswith("_")}

    backwards = {
        "step_back",
        "reverse",
        "run_to",
        "run_to_tick",
        "run_to_time",
        "last_pass",
        "restart",
        "step_in_back",
        "picture",
    }
    history = {"history", "passes", "who_changed", "furthest", "function_of"}
    own = {"wait_for_stop", "proceed", "sources", "source_text"}
    assert methods(DebugSession) - backwards - history - {"problems"} == methods(ServedSession) - own
    assert set(REQUESTS) - {"attach", "detach"} <= methods(ServedSession)
    assert set(REQUESTS) <= methods(LivingDebugger)
