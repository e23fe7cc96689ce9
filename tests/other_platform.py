"""Run a piece of elitescript as if this Linux were another system: `python other_platform.py win32|darwin PIECE`.

`sys.platform` and `os.name` change, and modules and functions that the other system does not have disappear, before
the package is imported. What the standard library itself does there (paths, processes, event loops) does not change.

Pieces: `record` imports every module, runs a program and prints what it leaves behind; `command ...` is the command
line without, `start ...` with the process that it starts for programs. That process is one of this Linux.
"""

from __future__ import annotations

import asyncio
import faulthandler
import os
import pathlib
import pkgutil
import signal
import socket
import subprocess
import sys
import time
import types
from importlib import import_module
from importlib.util import find_spec

NOT_ON_MACOS = {
    os: "eventfd memfd_create pidfd_open sched_getaffinity sched_setaffinity timerfd_create timerfd_settime_ns",
    signal: "sigtimedwait sigwaitinfo",
    socket: "TCP_KEEPIDLE",
    time: "pthread_getcpuclockid",
}
"""Names that the standard library does not have there, by its documentation."""

NOT_ON_WINDOWS = {
    os: NOT_ON_MACOS[os]
    + " O_ASYNC O_CLOEXEC O_DIRECTORY O_NOFOLLOW O_NONBLOCK WNOHANG chown fork forkpty geteuid getgid"
    " getpgid getpgrp getuid killpg mkfifo nice openpty posix_spawn pread preadv pwrite pwritev register_at_fork"
    " set_blocking get_blocking setpriority setsid statvfs ttyname uname wait wait3 wait4 waitid",
    signal: NOT_ON_MACOS[signal]
    + " SIGALRM SIGCHLD SIGHUP SIGKILL SIGPIPE SIGQUIT SIGSTOP SIGTSTP SIGUSR1 SIGUSR2 alarm"
    " pthread_kill pthread_sigmask setitimer siginterrupt sigpending sigwait",
    socket: "SO_REUSEPORT",
    time: NOT_ON_MACOS[time] + " clock_getres clock_gettime clock_gettime_ns tzset",
    faulthandler: "register unregister",
    asyncio: "open_unix_connection start_unix_server",
}
LOOKING_AT_THE_SYSTEM = ("ctypes", "shutil", "tempfile", "uuid")
"""Modules of the standard library that look at the system when they are imported."""
OF_OTHERS = (
    *("asyncssh", "mcp.server.stdio", "mcp.server.mcpserver", "pygls.lsp.server", "pytest"),
    "websockets.asyncio.server",
)
"""Libraries of extras, which look at the system too."""
MODULES_NOT_ON_WINDOWS = ("fcntl", "grp", "pty", "pwd", "readline", "resource", "syslog", "termios", "tty")
PROGRAM = """
def cell():
  global count
  count = 0
  while count < 3:
    movej([0.1 * count, -1.4, -1.7, -1.6, 1.57, 0])
    count = count + 1
  end
  write_output_integer_register(3, 7)
  file = open("result.txt", "w")
  file.write(str(count))
  file.close()
  textmsg("count ", count)
end
"""


def import_all() -> None:
    """Import every module of the package."""
    import elitescript

    for found in pkgutil.walk_packages(elitescript.__path__, "elitescript."):
        if found.name != "elitescript.__main__":
            import_module(found.name)


def pretend(platform: str) -> None:
    """Take away what the other system does not have."""
    for name in LOOKING_AT_THE_SYSTEM:
        import_module(name)
    sys.platform = platform
    missing = NOT_ON_MACOS
    if platform == "win32":
        missing = NOT_ON_WINDOWS
        os.name = "nt"
        own = sys.modules[pathlib.Path.__module__]
        own.WindowsPath = own.PosixPath  # type: ignore[attr-defined]  # paths here stay what they are
        for name in MODULES_NOT_ON_WINDOWS:
            sys.modules[name] = None  # type: ignore[assignment]
        console = types.ModuleType("msvcrt")
        vars(console).update(LK_NBLCK=2, LK_UNLCK=0, locking=lambda *_: None)
        sys.modules["msvcrt"] = console
        loop = asyncio.SelectorEventLoop
        for name in ("add_reader", "add_signal_handler", "add_writer"):
            setattr(loop, name, _not_there)  # as the event loop of Windows has them
        # The standard library itself goes on with what this system has.
        for used in (os, signal):
            setattr(subprocess, used.__name__, types.SimpleNamespace(**vars(used)))
    for module, names in missing.items():
        for name in names.split():
            if hasattr(module, name):
                delattr(module, name)


def _not_there(*_: object) -> None:
    raise NotImplementedError


def main(platform: str, piece: str, arguments: list[str]) -> int:
    if piece == "record":
        for name in OF_OTHERS:
            if find_spec(name.partition(".")[0]):
                import_module(name)
    pretend(platform)
    if piece == "record":
        import_all()
        print(record(arguments[0]))
        return 0
    from elitescript.cli import watched
    from elitescript.cli.main import main as command_line

    # Nothing that is started here needs longer to end by itself.
    watched.GRACE_S = 0.5  # type: ignore[misc]
    sys.argv[1:] = arguments
    return command_line(arguments if piece == "command" else None)


def record(folder: str) -> str:
    """Run the program with its files in a folder; return what it leaves behind."""
    from elitescript import VirtualRobot

    run = VirtualRobot("CS66", task_dir=folder, state_file=f"{folder}/state.json").run(PROGRAM, until_s=60).check()
    return repr((run.state, run.time_s, run.log, run.globals, run.joints, run.tcp_pose))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], sys.argv[3:]))
