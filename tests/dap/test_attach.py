"""`attach`: the programs of a robot that is served and lives."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from threading import Thread

import pytest

from tests.dap.client import Failed, MemoryClient, environment, process_client

PROGRAM = "def job():\n  n = 0\n  while n < 100000:\n    n = n + 1\n    sleep(0.02)\n  end\nend\n"

pytestmark = pytest.mark.skipif(os.name != "posix", reason="a socket in the file system")


@pytest.fixture
def served(tmp_path: Path) -> Iterator[tuple[int, str]]:
    """A served robot: the number of its primary port, the address of its `ctl` socket."""
    process = subprocess.Popen(
        [sys.executable, "-m", "elitescript", "serve", "--in-process", "--instance", "63", "--port", "all=0"],
        stdout=subprocess.PIPE,
        text=True,
        env={**environment(), "XDG_RUNTIME_DIR": str(tmp_path)},
    )
    assert process.stdout is not None
    try:
        ports, control = process.stdout.readline(), process.stdout.readline()
        primary = next(one for one in ports.replace(":", ",").split(",") if " primary " in one)
        yield int(primary.split()[1]), control.partition("ctl at ")[2].strip()
    finally:
        process.terminate()
        process.wait(10)
        process.stdout.close()


def test_a_living_program_is_stopped_looked_into_changed_and_left_to_go_on(served, tmp_path):
    port, control = served
    path = tmp_path / "job.script"
    path.write_text(PROGRAM)
    with socket.create_connection(("127.0.0.1", port)) as primary, process_client() as client:
        primary.sendall(PROGRAM.encode())
        client.initialize()
        attach = client.send("attach", socket=control)
        client.event("initialized")
        changed = client.event("capabilities")["body"]["capabilities"]
        assert changed["supportsStepBack"] is False
        client.set_breakpoints(path, 4)
        stop = client.stop_of(attach)["body"]
        thread = stop["threadId"]
        assert (stop["reason"], client.line(thread)) == ("breakpoint", 4)
        assert client.stack(thread)[0]["source"]["path"] == str(path)
        client.go("next", thread)
        assert client.line(thread) == 5
        client.evaluate("n = 5000", "repl", thread)
        assert client.evaluate("n", thread=thread) == "5000"
        client.set_breakpoints(path)
        client.request("continue", threadId=thread)
        with pytest.raises(Failed, match="notStopped"):
            client.request("stackTrace", threadId=thread)
        client.request("pause", threadId=thread)
        assert client.stop()["body"]["reason"] == "pause"
        assert int(client.evaluate("n", thread=thread)) >= 5000
        for command in ("stepBack", "reverseContinue", "elitescript/history", "restart"):
            with pytest.raises(Failed, match="that lives"):
                client.request(command, threadId=thread, name="n")
        client.disconnect()


def test_where_nothing_is_served_is_an_error(tmp_path):
    client = MemoryClient()
    client.initialize()
    with pytest.raises(Failed, match="no controller is served here"):
        client.request("attach", socket=str(tmp_path / "no.sock"))


def test_a_robot_that_lies_does_not_end_the_adapter(tmp_path: Path) -> None:
    lies = ({"event": "breakpoint", "state": 7}, {"event": "stopped", "stop": {"reason": 5}}, {"event": None})
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(tmp_path / "lies.sock"))
        listener.listen(1)

        def lie() -> None:
            robot, _ = listener.accept()
            with robot, robot.makefile("rwb") as lines:
                for _ in lines:
                    answers = [*lies, {"ok": True, "text": "", "result": {"result": None}}]
                    lines.write(b"".join(json.dumps(answer).encode() + b"\n" for answer in answers))
                    lines.flush()

        Thread(target=lie, daemon=True).start()
        with process_client() as client:
            client.initialize()
            attach = client.send("attach", socket=str(tmp_path / "lies.sock"))
            client.event("initialized")
            client.request("configurationDone")
            client.answer(attach)
            client.request("threads")
            assert "the robot: BreakpointState, not 7" in client.outputs()
            client.disconnect()
