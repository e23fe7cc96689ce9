"""`elitescript lsp`: the language server for editors."""

from __future__ import annotations

from elitescript.errors import UsageError
from elitescript.extras import require

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse


def lsp(options: argparse.Namespace) -> int:
    """Serve one editor until it ends; return the exit code."""
    if options.tcp is not None and not 0 <= options.tcp <= 65_535:
        raise UsageError(f"--tcp {options.tcp}: a port is a number up to 65535 (0: any free one)")
    require("lsp")
    from elitescript.lsp.serve import serve_stdio, serve_tcp

    return serve_stdio() if options.tcp is None else serve_tcp(options.tcp)
