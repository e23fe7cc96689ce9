"""The keeper: a process that has imported everything, of which each worker is a copy; so that one starts in 2 ms.

It runs no program of a page itself, so it always answers. Commands come through a socket, and events go back, as `link`
has them.
"""

from __future__ import annotations

import faulthandler
import gc
import os
import select
import signal
import socket
import sys
from contextlib import suppress
from typing import Final

from elitescript.environment.process import end_with_parent
from elitescript.studio.live.jobs import Job, job_data
from elitescript.studio.live.link import COMMAND, DESCRIPTORS, EVENT, Board, Link
from elitescript.studio.live.running import run_program
from elitescript.studio.live.worker import serve

_WARM_UP: Final = """def warm_up():
  global total
  total = 1
  movej([0, -1.5, -1.5, -1.5, 1.5, 0])
  movel([-0.4, -0.15, 0.4, 3, 0, 0])
  textmsg("ready")
end
"""


class Keeper:
    """Starts and ends workers.

    Args:
        commands: the socket.
    """

    def __init__(self, commands: socket.socket) -> None:
        self._commands = commands
        self._workers: dict[int, int] = {}
        """Process of each worker, by its number."""
        self._woken, wake = os.pipe()
        os.set_blocking(wake, False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.set_wakeup_fd(wake)

    def serve(self) -> None:
        """Carry out commands until the socket is closed."""
        while True:
            readable, _, _ = select.select([self._commands.fileno(), self._woken], [], [])
            if self._woken in readable:
                os.read(self._woken, 1 << 10)
                self._reap()
            if self._commands.fileno() in readable:
                data, descriptors, _, _ = socket.recv_fds(self._commands, COMMAND.size, DESCRIPTORS)
                if len(data) < COMMAND.size:
                    return
                command, number = COMMAND.unpack(data)
                self._carry_out(command, number, descriptors)

    def _carry_out(self, command: bytes, number: int, descriptors: list[int]) -> None:
        if command == b"n":
            self._begin(number, *descriptors)
        elif number in self._workers:
            os.kill(self._workers[number], signal.SIGKILL if command == b"k" else signal.SIGUSR1)

    def _begin(self, number: int, *descriptors: int) -> None:
        process = os.fork()
        if process == 0:
            try:
                self._become_worker(*descriptors)
            finally:
                os._exit(1)
        for descriptor in descriptors:
            os.close(descriptor)
        self._workers[number] = process
        self._commands.sendall(EVENT.pack(b"b", number, process))

    def _become_worker(self, link: int, trace: int, life: int, board: int) -> None:
        # Its copies end with it.
        os.setpgid(0, 0)
        end_with_parent(life)
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        self._commands.close()
        os.close(self._woken)
        os.dup2(trace, 1)
        os.dup2(trace, 2)
        # Written by the handler itself, also while a call of the program computes.
        faulthandler.register(signal.SIGUSR1, file=2, all_threads=False)
        faulthandler.enable(file=2, all_threads=False)
        serve(Link(link, link, Board(board)))
        os._exit(0)

    def _reap(self) -> None:
        with suppress(ChildProcessError):
            while (ended := os.waitpid(-1, os.WNOHANG)) != (0, 0):
                process, status = ended
                for number, other in self._workers.items():
                    if other == process:
                        del self._workers[number]
                        code = os.waitstatus_to_exitcode(status)
                        self._commands.sendall(EVENT.pack(b"e", number, code))
                        break


class _Nothing(Link):
    """Takes what a run reports, and throws it away."""

    def __init__(self) -> None:
        super().__init__(-1, -1)

    def _write(self, data: bytes) -> None:
        pass


def warm_up() -> None:
    """Run a small program, so that every worker has what is made when it is first used."""
    request = {
        "job": job_data(Job("warm_up.script", _WARM_UP)),
        "run": 0,
        "version": 0,
        "options": {},
        "until_s": 60.0,
        "wall_s": 60.0,
        "known": None,
    }
    run_program(_Nothing(), request, lambda: None)


def main() -> None:
    """Serve the socket whose number is the second argument."""
    end_with_parent(int(sys.argv[1]))
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    commands = socket.socket(fileno=int(sys.argv[2]))
    warm_up()
    # What is there now stays: a collection of garbage that looked at it would copy its pages in each worker.
    gc.collect()
    gc.freeze()
    with suppress(OSError):
        Keeper(commands).serve()
    os._exit(0)


if __name__ == "__main__":
    main()
