"""`--watch`: runs a call again whenever a file that it reads has changed."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Final

from elitescript.cli.call_paths import files_read
from elitescript.environment.stop_signals import leave_by_signals
from elitescript.environment.watched_files import Rounds
from elitescript.errors import UsageError
from elitescript.paths import stream_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

FLAG: Final = "--watch"


def _is_flag(word: str) -> bool:
    return word.startswith("--wa") and FLAG.startswith(word)


def watch(options: argparse.Namespace, command: list[str], environment: dict[str, str], *, is_process: bool) -> int:
    """Run a call in rounds, until Ctrl-C; return the exit code of a call whose output is no longer read.

    Args:
        options: of the call.
        command: starts it in a process of its own, with `--watch`.
        environment: of that process.
        is_process: whether this process has nothing else to do.

    Raises:
        UsageError: there is no file that could change.
        KeyboardInterrupt: the end.
    """
    given = options.files if options.command == "check" else [options.case or options.file]
    if not all(given) or not given:
        raise UsageError(f"{FLAG} goes with the name of a program")
    for name in given:
        if name == "-" or stream_of(name) is not None:
            raise UsageError(f"{FLAG}: {name} is no file, so it never changes")
        if not Path(name).exists():
            raise UsageError(f"{FLAG}: {name}: no such file")
    if is_process:
        leave_by_signals()
    words = [word for word in command if not _is_flag(word)]

    def start() -> subprocess.Popen[bytes]:
        return subprocess.Popen(words, env=environment)

    return Rounds(start, lambda: files_read(options), f"elitescript {options.command}").run()
