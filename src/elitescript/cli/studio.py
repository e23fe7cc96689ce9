"""`elitescript studio`: one page on this computer over live runs and controllers."""

from __future__ import annotations

from pathlib import Path

from elitescript import page
from elitescript.cli.robot_options import options_from
from elitescript.errors import UsageError
from elitescript.extras import require

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

    from elitescript.studio.connected.target import Target


def studio(options: argparse.Namespace) -> int:
    """Serve the page until a signal comes; return the exit code."""
    if not page.is_built():
        raise UsageError(page.NOT_BUILT)
    if not 0 <= options.port <= 65_535:
        raise UsageError(f"--port {options.port}: a port is a number up to 65535 (0: any free one)")
    if options.connect is None:
        for flag in ("control", "instance", "socket", "jog_register"):
            if getattr(options, flag):
                raise UsageError(f"--{flag.replace('_', '-')} goes with --connect: a live run has no controller")
    require("studio")
    from elitescript.studio.serving import serve_studio, workplace

    given = options_from(options)
    path = options.path or (None if options.connect else ".")
    place = workplace(path, given, options.world, options.urdf)
    target = None if options.connect is None else _target(options, given.get("model", ""))
    return serve_studio(
        place,
        options.port,
        target,
        opens_browser=not options.no_browser,
        ends_with_input=options.ends_with_input,
    )


def _target(options: argparse.Namespace, robot: str) -> Target:
    from elitescript.studio.connected.target import JOG_REGISTER, find_target

    register: int | None = options.jog_register
    return find_target(
        options.connect,
        instance=options.instance,
        socket=None if options.socket is None else Path(options.socket),
        robot=robot,
        may_control=options.control,
        jog_register=JOG_REGISTER if register is None else register,
    )
