"""A run with a real connection is run again with what came in, and its peer notices nothing."""

from __future__ import annotations

import socket
from threading import Thread

import pytest

from elitescript.debugger.api import LineBreakpoint
from elitescript.debugger.source import ProgramSource
from elitescript.errors import DebugError
from tests.debugger.sessions import debugging, variables

WIRE = "[[wire]]\nwhen = 'standard_digital_out[0]'\nthen = 'standard_digital_in[1]'\n"


@pytest.mark.parametrize("world", ["", WIRE], ids=["alone", "in a world"])
def test_what_was_received_is_received_again(world, tmp_path):
    (tmp_path / "cell.toml").write_text(world)
    taken: list[bytes] = []
    server = socket.create_server(("127.0.0.1", 0))
    port = server.getsockname()[1]

    def answer() -> None:
        peer, _ = server.accept()
        with peer:
            for number in (b"(7)", b"(8)"):
                taken.append(peer.recv(100))
                peer.sendall(number)
            peer.recv(100)

    thread = Thread(target=answer, daemon=True)
    thread.start()
    text = f"""def job():
  socket_open("127.0.0.1", {port}, "a")
  socket_send_string("one", "a")
  x = socket_read_ascii_float(1, "a", 2)
  textmsg("first ", x)
  socket_send_string("two", "a")
  y = socket_read_ascii_float(1, "a", 2)
  textmsg("second ", y)
  socket_close("a")
end
"""
    said = []
    with server, debugging(text, said, world=tmp_path / "cell.toml" if world else None) as session:
        session.set_breakpoints([LineBreakpoint(5), LineBreakpoint(8)])
        there = [session.start()]
        first = variables(session)
        back = session.step_back(1)
        assert back.line == 4 and "x" not in variables(session)
        assert session.resume() == there[0] and variables(session) == first
        session.resume()
        assert variables(session)["y"] == "[1, 8.0]"
        session.reverse()
        assert variables(session)["x"] == "[1, 7.0]"
        session.resume()
        assert variables(session)["y"] == "[1, 8.0]"
        session.set_breakpoints([])
        assert session.resume().result == "finished"
    thread.join(5)
    assert taken == [b"one", b"two"]
    assert "real connections" in said[0].text


DEVICE = "[[tcp]]\nport = 5000\n"


@pytest.mark.parametrize(
    ("call", "network", "may_fork"),
    [
        ('socket_open("10.0.0.1", 5000)', "local", True),
        ('socket_open("127.0.0.1", 5000)', "all", True),
        ('socket_open("127.0.0.1", 5001)', "local", False),
        ('socket_open("127.0.0.1", 5001)', "none", True),
        ('socket_open("10.0.0.1", 5001)', "local", True),
        ('socket_open("10.0.0.1", 5001)', "10.0.0.1", False),
        ("socket_open(get_task_path(), 5000)", "local", False),
        ("socket_open(get_task_path(), 5000)", "none", True),
        ('rpc_factory("xmlrpc", "http://10.0.0.1:5000/RPC2")', "all", True),
        ('rpc_factory("xmlrpc", "http://127.0.0.1:80/RPC2")', "local", False),
        ("tool_serial_config(True, 115200, 0, 1)", "local", True),
        ("f = socket_open", "local", False),
    ],
)
def test_copies_are_made_of_a_run_that_leads_nowhere_real(call, network, may_fork, tmp_path):
    (tmp_path / "cell.toml").write_text(DEVICE)
    (tmp_path / "cell.script").write_text(f"def job():\n  {call}\nend\n")
    source = ProgramSource(tmp_path / "cell.script", world=tmp_path / "cell.toml", network=network)
    assert source.may_fork is may_fork


def test_what_is_not_let_through_is_counted_once_however_often_it_is_run_again():
    said = []
    with debugging('def job():\n  socket_open("10.0.0.1", 80)\n  x = 1\n  y = 2\nend\n', said) as session:
        session.set_breakpoints([LineBreakpoint(4)])
        session.start()
        session.step_back(1)
        session.resume()
        assert session.resume().result == "finished"
    texts = [output.text for output in said]
    assert len([text for text in texts if "not connected to 10.0.0.1:80" in text]) == 1
    assert len([text for text in texts if 'network="local" has refused 1 connection: 10.0.0.1:80' in text]) == 1


def test_a_peer_is_named_once_in_what_the_run_says(capfd):
    """Users of an editor do not see the error output of what runs there."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        text = f'def job():\n  ok = socket_open("127.0.0.1", {port}, "a")\n  x = 1\n  sleep(0.1)\n  y = 1\n'
        text += '  socket_close("a")\nend\n'
        said = []
        with debugging(text, said) as session:
            session.set_breakpoints([LineBreakpoint(5)])
            session.start()
            session.step_back(1)
            session.resume()
            session.reverse()
            session.set_breakpoints([])
            assert session.resume().result == "finished"
    line = f'network: the program connects to 127.0.0.1:{port} (network="local")'
    assert [item.text for item in said if "connects" in item.text] == [line]
    assert capfd.readouterr().err == ""


def test_what_the_console_connects_to_is_named_and_has_no_copies(capfd):
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        said = []
        with debugging("def job():\n  x = 1\n  sleep(0.1)\n  y = 1\nend\n", said, forks=True) as session:
            session.set_breakpoints([LineBreakpoint(4)])
            session.start()
            frame = session.stack(1)[0].id
            for number in (port, port + 1):
                with pytest.raises(DebugError, match="it waits"):
                    session.evaluate(f'socket_open("127.0.0.1", {number}, "a")', frame, may_change=True)
            assert session.step_back(1).line == 3
            assert session.resume().line == 4
    assert [item.text for item in said if "connects" in item.text] == [
        f'network: the program connects to 127.0.0.1:{number} (network="local")' for number in (port, port + 1)
    ]
    assert [item.text for item in said if "real connections" in item.text] == [said[0].text]
    assert capfd.readouterr().err == ""
