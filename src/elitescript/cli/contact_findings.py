"""What `check --world` finds by running a program in a world with solids: contacts, as findings on their lines.

The run is in virtual time and reaches nothing of this computer: a connection that no device of the world takes fails,
and files are written to a copy in memory. Its length is bounded by robot time and by wall time.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any, Final

from elitescript.devices.surroundings import REAL, VIRTUAL
from elitescript.devices.world import World
from elitescript.errors import ElitescriptError
from elitescript.language.diagnostics import Diagnostic, diagnostic, in_order
from elitescript.language.text.source import SourceFile
from elitescript.lint.suppression import without_suppressed
from elitescript.robot import VirtualRobot
from elitescript.run import Run
from elitescript.solids.contacts import Contact
from elitescript.world_file import load_world_file

UNTIL_S: Final = 600.0
"""Robot time after which a run is cut off."""
WALL_S: Final = 5.0
"""Wall time after which it is, looked at in every tick."""
FILE_BYTES: Final = 1_000_000
"""Larger files beside a program are not in its copy of the task folder."""
FILES: Final = 100
"""Nor are more files."""


def contact_findings(
    source: SourceFile, folder: Path | None, world: str, options: dict[str, Any]
) -> tuple[tuple[Diagnostic, ...], str]:
    """Run a program in its world; return a finding for each contact and line, and why the run says less than all.

    Args:
        source: a program without errors.
        folder: where its file is; None for a text from standard input.
        world: path of a world file with solids.
        options: of the robot, as the command line gives them.
    """
    file = load_world_file(world, network=VIRTUAL)
    if file.beside.get("world", {}).get("network") == REAL:
        return (), "not run for contacts: its world leads to the network of this computer"
    if file.world is None:
        file.world = World()
        file.world.settings = file
    end_s = time.monotonic() + WALL_S

    def watch(robot: VirtualRobot) -> None:
        if time.monotonic() >= end_s:
            robot.interrupt("time_limit")

    try:
        robot = VirtualRobot(world=file.world, task_dir=_copy(folder), **options)
        run = robot.run(robot.compile(source), until_s=UNTIL_S, watch=watch)
    except ElitescriptError as error:
        return (), f"not run for contacts: {error}"
    found: dict[tuple[int, str, str], Contact] = {}
    for contact in run.contacts:
        line = max(contact.line, 1)
        deepest = found.get((line, contact.first, contact.second))
        if deepest is None or contact.distance_m < deepest.distance_m:
            found[line, contact.first, contact.second] = contact
    problems = [_finding(line, contact.text, source) for (line, _, _), contact in found.items()]
    return in_order(without_suppressed(problems, source)), _why_less(run)


def _finding(line: int, text: str, source: SourceFile) -> Diagnostic:
    row = source.line(line)
    column = len(row) - len(row.lstrip()) + 1
    return diagnostic("W273", line, column, text, end_column=max(len(row.rstrip()), column) + 1)


def _why_less(run: Run) -> str:
    """Return up to when contacts are known, if that is not the end of the program."""
    if run.state == "finished":
        return ""
    reason = {"time_limit": "the run was cut off there", "stuck": "the program is stuck there"}.get(run.state, "")
    if run.alarms:
        alarm = run.alarms[-1]
        reason = f"the run ended there by alarm {alarm.code} in line {alarm.line}: {alarm.text}"
    return f"contacts are known up to {run.time_s:.3f} s of robot time: {reason or 'the program was stopped there'}"


def _copy(folder: Path | None) -> dict[str, bytes]:
    """Return the files beside a program, for a task folder in memory."""
    found: dict[str, bytes] = {}
    for path in sorted(folder.iterdir()) if folder is not None else ():
        try:
            if len(found) < FILES and path.is_file() and path.stat().st_size <= FILE_BYTES:
                found[path.name] = path.read_bytes()
        except OSError:
            continue  # as if it were not there: the program says if it misses it
    return found
