"""`sys` for scripts: version, `exit` and standard output."""

from __future__ import annotations

import sys
from collections.abc import Callable
from operator import itemgetter
from typing import Any

from elitescript.runtime.files import ScriptStream
from elitescript.sealed import Sealed


class VersionInfo(tuple[Any, ...], metaclass=Sealed):
    """The version of Python, as programs see it."""

    __slots__ = ()
    __module__ = "sys"
    __qualname__ = "version_info"

    major = property(itemgetter(0))
    minor = property(itemgetter(1))
    micro = property(itemgetter(2))
    releaselevel = property(itemgetter(3))
    serial = property(itemgetter(4))

    def __repr__(self) -> str:
        fields = ("major", "minor", "micro", "releaselevel", "serial")
        return f"sys.version_info({', '.join(f'{name}={value!r}' for name, value in zip(fields, self, strict=True))})"


def system_names(
    write: Callable[[str], None], leave: Callable[[str], None], python: tuple[int, int, int]
) -> dict[str, Any]:
    """Return the public names of `sys` for one program.

    Args:
        write: writes to the standard output.
        leave: ends the program; called with the name of the function.
        python: the version of Python.
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
        "version": ".".join(map(str, python)),
        "version_info": VersionInfo((*python, "final", 0)),
    }
