"""`sys` for scripts: version, `exit` and standard output."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

from elitescript.runtime.files import ScriptStream


def system_names(write: Callable[[str], None], leave: Callable[[str], None]) -> dict[str, Any]:
    """Return the public names of `sys` for one program.

    Args:
        write: writes to the standard output.
        leave: ends the program; called with the name of the function.
    """

    def exit(status: object = None) -> None:
        """End the program, like `halt()`."""
        leave("sys.exit")

    stream = ScriptStream("<stdout>", write)
    return {
        "byteorder": sys.byteorder,
        "exit": exit,
        "float_info": sys.float_info,
        "maxsize": sys.maxsize,
        "platform": "linux",
        "stderr": stream,
        "stdout": stream,
        "version": ".".join(str(part) for part in sys.version_info[:3]),
        "version_info": tuple(sys.version_info[:3]),
    }
