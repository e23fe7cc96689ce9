"""`elitescript dap`: the Debug Adapter Protocol on standard input and output, or on a port of this computer."""

from __future__ import annotations

from elitescript.dap.server import serve_stdio, serve_tcp

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse


def dap(options: argparse.Namespace) -> int:
    """Serve debug sessions; return the exit code."""
    if options.tcp is None:
        serve_stdio()
    else:
        serve_tcp(options.tcp, lambda place: print(f"ready on {place}", flush=True))
    return 0
