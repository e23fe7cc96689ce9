"""`elitescript mcp`: the tools of this package for agents, on standard input and output."""

from __future__ import annotations

import sys

from elitescript.errors import UsageError
from elitescript.extras import require

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse


def mcp(options: argparse.Namespace) -> int:
    """Serve one client until it closes standard input; return the exit code."""
    from elitescript.mcp.folder import Folder

    folder = Folder(options.folder)
    if not options.max_wall > 0.0:
        raise UsageError(f"--max-wall must be > 0 s, got {options.max_wall:g}")
    require("mcp")
    from elitescript.mcp.requests import requests
    from elitescript.mcp.server import make_server

    before = sys.stdin
    sys.stdin = requests(sys.stdin.buffer)
    try:
        make_server(folder, options.max_wall).run("stdio")
    finally:
        sys.stdin = before
    return 0
