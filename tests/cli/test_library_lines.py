"""Lines of libraries: each once in a while, and none that nothing has formatted."""

from __future__ import annotations

import gc
import logging
import threading

from elitescript.cli.output.library_lines import AGAIN_S, LibraryLines, library_lines


def test_a_line_that_is_repeated_is_written_once_in_a_while() -> None:
    said: list[str] = []
    now = 0.0
    lines = LibraryLines(said.append, lambda: now)
    for number in range(1000):
        lines.take("socket", f"socket {number} is closed")
    assert said == ["socket 0 is closed"]
    now = AGAIN_S
    lines.take("socket", "socket 7 is closed")
    assert said[1:] == ["socket 7 is closed (999 times more since then)"]


def test_whatever_a_library_reports_goes_to_the_log(capfd, monkeypatch) -> None:
    # The library of `mcp` sets a handler for its process, which is this one where a test makes such a server.
    monkeypatch.setattr(logging.getLogger(), "handlers", [])
    said: list[str] = []

    class Bad:
        def __del__(self) -> None:
            raise ZeroDivisionError

    # What other tests have left is not of this one.
    gc.collect()
    with library_lines(said.append):
        logging.getLogger("asyncio").warning("socket.send() raised exception.")
        logging.getLogger("asyncssh").info("connected")
        logging.getLogger("asyncio").error("%d and %s", "no number", exc_info=ValueError("x"))
        bad = Bad()
        del bad
        thread = threading.Thread(target=lambda: 1 / 0)
        thread.start()
        thread.join()
    heads = [text.splitlines()[0] for text in said]
    assert heads[0] == "asyncio: socket.send() raised exception."
    assert heads[1] == "internal error, please report it: asyncio: %d and %s"
    assert heads[2].startswith("internal error, please report it: ")
    assert heads[3] == "internal error, please report it: a thread has ended"
    assert capfd.readouterr().err == ""
