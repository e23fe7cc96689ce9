"""A run in a process that can be ended from outside.

A single call into C, such as `sum(range(10**12))`, reaches no checkpoint and lets no other thread of its process run.
So with `--max-wall` the program runs in a child, and the parent does nothing but wait for it.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from contextlib import suppress
from types import FrameType
from typing import Any, Final

MARK: Final = "ELITESCRIPT_WATCHED"
"""Set in the environment of a child that is watched."""

GRACE_S: Final = 2.0
"""What a child gets beyond its limit: to start, and to end by itself at its next checkpoint."""

TIME_LIMIT: Final = 4
"""Exit code, as that of a run that ends at its limit by itself."""


def run_watched(command: list[str], environment: dict[str, str], max_wall_s: float, *, is_json: bool) -> int:
    """Run a command for so much wall time at most; return its exit code, or that of the time limit."""
    # In a process group of its own, the child hears of Ctrl-C once: through us.
    own_group: dict[str, Any] = {"process_group": 0, "close_fds": False} if os.name == "posix" else {}
    child = subprocess.Popen(command, env={**environment, MARK: "1"}, **own_group)

    def pass_on(number: int, _frame: FrameType | None) -> None:
        with suppress(OSError, ValueError):
            child.send_signal(number)

    signal.signal(signal.SIGINT, pass_on if os.name == "posix" else signal.SIG_IGN)
    signal.signal(signal.SIGTERM, pass_on)
    try:
        code = child.wait(timeout=max_wall_s + GRACE_S)
    except subprocess.TimeoutExpired:
        child.kill()
        child.wait()
        from elitescript.cli.screen import ERASE, understands_escapes

        text = f"no checkpoint within --max-wall {max_wall_s:g} s: a single call does not come back; process ended"
        # The child was killed with its status line on the terminal.
        has_status = sys.stderr.isatty() and understands_escapes(os.environ, os.name)
        print(f"{ERASE if has_status else ''}elitescript run: {text}", file=sys.stderr)
        if is_json:
            from elitescript.cli import jsonlines

            print(jsonlines.line({"type": "end", "state": "time_limit", "t": None, "killed": True, "text": text}))
        return TIME_LIMIT
    return code if code >= 0 or os.name != "posix" else 128 - code
