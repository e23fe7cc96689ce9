"""`elitescript mcp`: the tools of this package for agents, on standard input and output."""

from __future__ import annotations

import os
import sys
from io import BufferedReader, FileIO

from elitescript.errors import UsageError
from elitescript.extras import require

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse


def mcp(options: argparse.Namespace) -> int:
    """Serve one client until it closes standard input, or reads no more; return the exit code."""
    from elitescript.cli.output.streams import OUTPUT
    from elitescript.mcp.folder import Folder

    folder = Folder(options.folder)
    if not options.max_wall > 0.0:
        raise UsageError(f"--max-wall must be > 0 s, got {options.max_wall:g}")
    require("mcp")
    from elitescript.mcp.requests import UntilReaderGoes, requests
    from elitescript.mcp.server import make_server

    before = sys.stdin
    # The library has something else at the number of standard output.
    output = os.dup(sys.stdout.fileno())
    sys.stdin = requests(BufferedReader(UntilReaderGoes(FileIO(sys.stdin.fileno(), closefd=False), output)))
    try:
        make_server(folder, options.max_wall).run("stdio")
    except ExceptionGroup as failures:
        failure = _first(failures)
        if not isinstance(failure, OSError):
            raise
        # A client that has gone ends a session as its end of standard input does.
        if not isinstance(failure, BrokenPipeError):
            raise OSError(failure.errno, failure.strerror, OUTPUT) from failures
    finally:
        sys.stdin = before
        os.close(output)
    return 0


def _first(failures: BaseExceptionGroup) -> BaseException:
    """Return the first exception of a group that is no group."""
    first = failures.exceptions[0]
    return _first(first) if isinstance(first, BaseExceptionGroup) else first
