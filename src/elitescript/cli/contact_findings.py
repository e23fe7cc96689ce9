"""What `check --world` finds by running a program in a world with solids: contacts, as findings on their lines.

The run is in virtual time and reaches nothing of this computer: a connection that no device of the world takes fails,
and files are written to a copy in memory. Its length is bounded by robot time and by wall time. It has a process of its
own, which is killed if a single step of the program does not end.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from elitescript.devices.surroundings import REAL, VIRTUAL
from elitescript.devices.world import World
from elitescript.environment.process import Life, end_with_parent, module_command, module_environment
from elitescript.errors import ElitescriptError
from elitescript.language.diagnostics import Diagnostic, diagnostic, in_order
from elitescript.language.text.source import SourceFile
from elitescript.lint.suppression import without_suppressed
from elitescript.robot import VirtualRobot
from elitescript.run import Run
from elitescript.solids.contacts import Contact
from elitescript.untrusted.files import TASK_FILE, UnreadableError, read_bytes
from elitescript.untrusted.json_text import json_value
from elitescript.world_file import load_world_file

UNTIL_S: Final = 600.0
"""Robot time after which a run is cut off."""
WALL_S: Final = 5.0
"""Wall time after which it is, looked at in every tick."""
GRACE_S: Final = 5.0
"""Wall time that its process has beyond that: to start, and to come to the next tick."""
FILE_BYTES: Final = 1_000_000
"""Larger files beside a program are not in its copy of the task folder."""
FILES: Final = 100
"""Nor are more files."""


def contact_findings(
    source: SourceFile, folder: Path | None, world: str, options: Mapping[str, Any]
) -> tuple[tuple[Diagnostic, ...], str]:
    """Run a program in its world; return a finding for each contact and line, and why the run says less than all.

    Args:
        source: a program without errors.
        folder: where its file is; None for a text from standard input.
        world: path of a world file with solids.
        options: of the robot, as the command line gives them.
    """
    request = {
        "name": source.name,
        "text": source.text,
        "folder": None if folder is None else str(folder),
        "world": world,
        "options": dict(options),
        "until_s": UNTIL_S,
        "wall_s": WALL_S,
    }
    answer = _answered(request)
    problems = [_finding(line, text, source) for line, text in answer["contacts"]]
    return in_order(without_suppressed(problems, source)), answer["why_less"]


def _answered(request: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a process of its own says to a request; see `answer_to`."""
    life = Life()
    limit_s = WALL_S + GRACE_S
    try:
        with subprocess.Popen(
            module_command(__name__, [life.descriptor]),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=module_environment(),
            **life.options,
        ) as process:
            life.started()
            try:
                data, _ = process.communicate(json.dumps(request).encode(), timeout=limit_s)
            except BaseException as error:
                process.kill()
                if not isinstance(error, subprocess.TimeoutExpired):
                    raise
                return _nothing(f"a step of the program did not end within {limit_s:g} s")
    finally:
        life.close()
    if process.returncode != 0:
        return _nothing("the process of the run has ended: it may have needed too much memory")
    found: dict[str, Any] = json_value(data, depth_max=None)
    return found


def _nothing(why: str) -> dict[str, Any]:
    return {"contacts": [], "why_less": f"not run for contacts: {why}"}


def answer_to(request: Mapping[str, Any]) -> dict[str, Any]:
    """Run a program; return its `contacts`, line and text of the deepest of each line and names, and `why_less`."""
    file = load_world_file(request["world"], network=VIRTUAL)
    if file.beside.get("world", {}).get("network") == REAL:
        return _nothing("its world leads to the network of this computer")
    if file.world is None:
        file.world = World(network=VIRTUAL)
        file.world.settings = file
    folder = request["folder"]
    end_s = time.monotonic() + request["wall_s"]

    def watch(robot: VirtualRobot) -> None:
        if time.monotonic() >= end_s:
            robot.interrupt("time_limit")

    try:
        files = _copy(None if folder is None else Path(folder))
        robot = VirtualRobot(world=file.world, task_dir=files, **request["options"])
        unit = robot.compile(SourceFile(request["name"], request["text"]))
        run = robot.run(unit, until_s=request["until_s"], watch=watch)
    except ElitescriptError as error:
        return _nothing(str(error))
    found: dict[tuple[int, str, str], Contact] = {}
    for contact in run.contacts:
        line = max(contact.line, 1)
        deepest = found.get((line, contact.first, contact.second))
        if deepest is None or contact.distance_m < deepest.distance_m:
            found[line, contact.first, contact.second] = contact
    return {
        "contacts": [(line, contact.text) for (line, _, _), contact in found.items()],
        "why_less": _why_less(run),
    }


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
                found[path.name] = read_bytes(path, TASK_FILE)
        except (OSError, UnreadableError):
            continue  # as if it were not there: the program says if it misses it
    return found


def _main() -> None:
    end_with_parent(int(sys.argv[1]))
    answers = os.fdopen(os.dup(1), "wb")
    # What a program prints is not the answer.
    os.dup2(2, 1)
    answers.write(json.dumps(answer_to(json.loads(sys.stdin.buffer.read()))).encode())
    answers.flush()
    # No destructor of a program's object is to run now.
    os._exit(0)


if __name__ == "__main__":
    _main()
