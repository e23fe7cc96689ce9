"""`elitescript mcp`: the tools of this package for agents, on standard input and output."""

from __future__ import annotations

import sys

from elitescript.errors import UsageError

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse


def mcp(options: argparse.Namespace) -> int:
    """Serve one client until it closes standard input; return the exit code."""
    from elitescript.mcp.folder import Folder

    folder = Folder(options.folder)
    if not options.max_wall > 0.0:
        raise UsageError(f"--max-wall must be > 0 s, got {options.max_wall:g}")
    try:
        from elitescript.mcp.requests import requests
        from elitescript.mcp.server import make_server
    except ModuleNotFoundError as error:
        raise UsageError(
            f"the package {error.name!r} is missing; install it with: pip install 'elitescript[mcp]'"
        ) from error
    before = sys.stdin
    sys.stdin = requests(sys.stdin.buffer)
    try:
        make_server(folder, options.max_wall).run("stdio")
    finally:
        sys.stdin = before
    return 0
