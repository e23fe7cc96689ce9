"""`elitescript studio`: one page on this computer over live runs and controllers."""

from __future__ import annotations

from pathlib import Path

from elitescript import page
from elitescript.cli.robot_options import options_from
from elitescript.errors import UsageError

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse


def studio(options: argparse.Namespace) -> int:
    """Serve the page until a signal comes; return the exit code."""
    if not page.is_built():
        raise UsageError(page.NOT_BUILT)
    if not 0 <= options.port <= 65_535:
        raise UsageError(f"--port {options.port}: a port is a number up to 65535 (0: any free one)")
    if options.control and options.connect is None:
        raise UsageError("--control goes with --connect: a live run moves no robot")
    try:
        from elitescript.studio.serving import serve_studio, workplace
    except ModuleNotFoundError as error:
        raise UsageError(
            f"the package {error.name!r} is missing; install it with: pip install 'elitescript[studio]'"
        ) from error
    place = workplace(Path(options.path), options_from(options), options.world, options.urdf)
    return serve_studio(place, options.port, opens_browser=not options.no_browser)
