"""A run with a real connection is run again with what came in, and its peer notices nothing."""

from __future__ import annotations

import socket
from threading import Thread

from elitescript.debugger.api import LineBreakpoint
from tests.debugger.sessions import debugging, variables


def test_what_was_received_is_received_again():
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
    with server, debugging(text, said) as session:
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
