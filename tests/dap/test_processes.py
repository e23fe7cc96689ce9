"""`elitescript dap` as processes: standard streams, ports, and programs that crash, hang or outlive somebody."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from elitescript.dap.worker import Incoming
from tests.dap.client import Client, Failed, environment, process_client, socket_client

CELL = Path(__file__).with_name("kit") / "cell.script"
HANGS = "def cell():\n  x = sum(range(10 ** 12))\nend\n"
ENDLESS = "def cell():\n  x = 0\n  while True:\n    x = x + 1\n  end\nend\n"

needs_signals = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")


def running(client: Client, path: Path, text: str) -> int:
    """Launch a program that does not stop by itself; return the number of the process that debugs."""
    path.write_text(text)
    client.initialize()
    launch = client.launch(path)
    client.request("configurationDone")
    client.answer(launch)
    return int(client.event("process")["body"]["systemProcessId"])


def is_alive(pid: int) -> bool:
    """Return whether a process that is no child of ours is there."""
    try:
        os.kill(pid, 0)
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except (ProcessLookupError, FileNotFoundError):
        return False
    return state != "Z"


def wait_for_end(pid: int) -> None:
    pipe = os.pidfd_open(pid) if is_alive(pid) else None
    if pipe is not None:
        import select

        try:
            assert select.select([pipe], [], [], 10.0)[0], f"process {pid} goes on"
        finally:
            os.close(pipe)


def test_a_session_on_standard_streams():
    with process_client() as client:
        stop = client.start(CELL, 12)
        assert stop["body"]["reason"] == "breakpoint"
        assert client.evaluate("count") == "0"
        assert client.go("stepBack")["body"]["reason"] == "step"
        assert client.line() == 11
        client.disconnect()


def test_what_is_no_message_is_answered_and_the_session_goes_on():
    with process_client() as client:
        client.send_bytes(b"Content-Length: 5\r\n\r\nhello" + b"nonsense\r\n\r\n")
        assert client.start(CELL, 12)["event"] == "stopped"
        assert [one["success"] for one in client.answers.pop(0)] == [False, False]
        client.disconnect()


@contextmanager
def server(*more: str) -> Iterator[int]:
    process = subprocess.Popen(
        [sys.executable, "-m", "elitescript", "dap", "--tcp", "0", *more],
        stdout=subprocess.PIPE,
        text=True,
        env=environment(),
    )
    assert process.stdout is not None
    try:
        yield int(process.stdout.readline().rpartition(":")[2])
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(10)
        process.stdout.close()


def test_clients_of_a_port_come_one_after_the_other():
    with server() as port:
        for _ in range(2):
            with socket_client(port) as client:
                assert client.start(CELL, 12)["body"]["reason"] == "breakpoint"
                client.disconnect()
        with socket_client(port) as client:
            client.start(CELL, 12)  # and is gone without a word
        with socket_client(port) as client:
            assert client.start(CELL, 12)["body"]["reason"] == "breakpoint"
            client.disconnect()


def test_a_web_page_cannot_speak_to_a_port():
    body = b'{"seq":1,"type":"request","command":"initialize","arguments":{}}'
    request = b"POST / HTTP/1.1\r\nHost: here\r\nContent-Length: %d\r\n\r\n%b" % (len(body), body)
    with server() as port:
        with socket.create_connection(("127.0.0.1", port)) as browser:
            browser.sendall(request)
            assert browser.recv(1) == b""
        with socket_client(port) as client:
            client.initialize()


@pytest.mark.parametrize("port", ["70000", "-1"])
def test_a_port_that_there_is_not_is_a_usage_error(port):
    found = subprocess.run(
        [sys.executable, "-m", "elitescript", "dap", f"--tcp={port}"],
        capture_output=True,
        text=True,
        env=environment(),
        check=False,
    )
    assert found.returncode == 2
    assert found.stderr.startswith("elitescript dap: ")


@needs_signals
class TestRunningPrograms:
    def test_an_endless_one_is_paused_looked_into_and_goes_on(self, tmp_path):
        with process_client() as client:
            running(client, tmp_path / "cell.script", ENDLESS)
            with pytest.raises(Failed, match="notStopped"):
                client.request("stackTrace", threadId=1)
            client.set_breakpoints(tmp_path / "cell.script", 4)
            assert client.stop()["body"]["reason"] == "breakpoint"
            client.set_breakpoints(tmp_path / "cell.script")
            seen = [int(client.evaluate("x"))]
            # On a busy machine the pause may be there before the program has gone on.
            while len(set(seen)) < 3:
                client.request("continue", threadId=1)
                client.request("pause", threadId=1)
                assert client.stop()["body"]["reason"] == "pause"
                seen.append(int(client.evaluate("x")))
            assert seen == sorted(seen)
            client.disconnect()

    def test_an_endless_one_is_ended(self, tmp_path):
        with process_client() as client:
            running(client, tmp_path / "cell.script", ENDLESS)
            client.request("terminate")
            assert client.event("exited")["body"] == {"exitCode": 0}
            client.event("terminated")
            client.disconnect()

    def test_a_call_that_does_not_return_is_ended_with_its_process(self, tmp_path):
        with process_client() as client:
            pid = running(client, tmp_path / "cell.script", HANGS)
            client.request("terminate")
            client.event("exited")
            client.event("terminated")
            client.disconnect()
        wait_for_end(pid)

    def test_a_process_that_is_killed_is_reported(self, tmp_path):
        with process_client() as client:
            pid = running(client, tmp_path / "cell.script", ENDLESS)
            os.kill(pid, signal.SIGKILL)
            assert "SIGKILL" in client.event("output")["body"]["output"]
            assert client.event("exited")["body"] == {"exitCode": 1}
            client.event("terminated")
            with pytest.raises(Failed, match="SIGKILL"):
                client.request("threads")
            client.disconnect()

    def test_a_crash_names_the_line_of_the_program(self, tmp_path):
        text = "def cell():\n  x = [1]\n  for i in range(150000):\n    x = map(int, x)\n  end\n  y = list(x)\nend\n"
        with process_client() as client:
            running(client, tmp_path / "cell.script", text)
            found = client.event("output")["body"]["output"]
            assert "crashed in line 6" in found
            client.event("terminated")
            client.disconnect()

    def test_nothing_outlives_a_killed_adapter(self, tmp_path):
        process = subprocess.Popen(
            [sys.executable, "-m", "elitescript", "dap"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            bufsize=0,
            env=environment(),
        )
        assert process.stdin is not None
        assert process.stdout is not None
        client = Client(process.stdin.write)
        while client._inbox.empty() or not any(one["event"] == "process" for one in client.events):
            if client.seq == 0:
                (tmp_path / "cell.script").write_text(HANGS)
                client.send("initialize", adapterID="x")
                client.send("launch", program=str(tmp_path / "cell.script"))
                client.send("configurationDone")
            client.receive(process.stdout.read(1 << 16))
            while not client._inbox.empty():
                client.pump()
            if any(one["event"] == "process" for one in client.events):
                break
        pid = int(client.event("process")["body"]["systemProcessId"])
        process.kill()
        process.wait()
        process.stdin.close()
        process.stdout.close()
        wait_for_end(pid)

    def test_the_end_of_the_input_ends_everything(self, tmp_path):
        with process_client() as client:
            pid = running(client, tmp_path / "cell.script", HANGS)
        wait_for_end(pid)


@needs_signals
def test_signals_that_come_in_the_middle_of_looking_for_requests_do_no_harm():
    """As on a busy machine, where the signal of a request comes when the request has long been read."""
    ours, theirs = os.pipe()
    incoming = Incoming(ours)
    looks: list[bool] = []
    before = signal.getsignal(signal.SIGURG)
    incoming.begin(lambda: looks.append(incoming.has_next()))
    once = f"    os.kill({os.getpid()}, signal.SIGURG)\n    time.sleep(2e-5)"
    sends = f"import os, signal, time\nfor _ in range(3000):\n{once}"
    sender = subprocess.Popen([sys.executable, "-c", sends])
    try:
        while sender.poll() is None:
            for _ in range(100):
                assert not incoming.has_next()
        assert sender.returncode == 0
        assert True not in looks and len(looks) > 10
        os.write(theirs, b"{}\n")
        assert incoming.has_next()
    finally:
        sender.kill()
        sender.wait()
        signal.signal(signal.SIGURG, before)
        os.close(ours)
        os.close(theirs)
