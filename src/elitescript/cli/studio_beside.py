"""The studios that `serve --studio` starts: one for each robot, in processes of their own."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from typing import Final

from elitescript import page
from elitescript.errors import UsageError
from elitescript.extras import require

END_S: Final = 5.0
"""Longest time for a studio to end when it is told to."""
NICENESS: Final = 5
"""By how much the ports of the robots come first, where processors are short."""
_EVERYWHERE: Final = {"0.0.0.0": "127.0.0.1", "::": "::1"}

Say = Callable[[str, str], None]


def check_studio() -> None:
    """Refuse to serve a studio that cannot start.

    Raises:
        UsageError: the page is not built, or a package is missing.
    """
    if not page.is_built():
        raise UsageError(page.NOT_BUILT)
    require("studio", "--studio")


@contextlib.contextmanager
def studios(robots: Sequence[tuple[str, str]], hosts: Sequence[str], folder: str | None, say: Say) -> Iterator[None]:
    """Start a studio for each robot; end them with the block.

    Args:
        robots: name and `ctl` address of each.
        hosts: that each robot is served at.
        folder: of programs that the page opens; the working directory if None.
        say: takes the name of a robot and a line of its studio, in a thread of its own; an empty one: it has ended.
    """
    processes: list[subprocess.Popen[str]] = []
    ending = threading.Event()
    try:
        for (name, address), host in zip(robots, hosts, strict=True):
            # Its input ends with this process, also when that is killed.
            command = _command(_EVERYWHERE.get(host, host), address, folder)
            process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
            processes.append(process)
            with contextlib.suppress(AttributeError, OSError):
                os.setpriority(os.PRIO_PROCESS, process.pid, NICENESS)
            threading.Thread(target=_listen, args=(process, name, say, ending), daemon=True).start()
        yield
    finally:
        ending.set()
        for process in processes:
            process.terminate()
        for process in processes:
            try:
                process.wait(END_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def _command(host: str, address: str, folder: str | None) -> list[str]:
    words = [sys.executable, "-m", "elitescript", "studio", folder or "."]
    return [*words, "--connect", host, "--socket", address, "--control", "--no-browser", "--ends-with-input"]


def _listen(process: subprocess.Popen[str], name: str, say: Say, ending: threading.Event) -> None:
    assert process.stdout is not None
    for line in process.stdout:
        say(name, line.rstrip("\n"))
    if not ending.is_set():
        say(name, "")
