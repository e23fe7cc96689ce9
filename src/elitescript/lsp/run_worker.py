"""The process of one run: a request as JSON on standard input, the outcome on standard output.

It is killed when its outcome has no use any more, or takes too long. Nothing outside the robot is real: the task folder
is a copy in memory, connections lead to the devices of the world file or nowhere, and on Linux the process is in the
jail of served robots before the program is compiled.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from time import perf_counter
from typing import Any, Final

from elitescript.environment.memory import FolderCopy, folder_contents
from elitescript.environment.process import end_with_parent
from elitescript.errors import ElitescriptError, ProgramError
from elitescript.language.text.source import SourceFile
from elitescript.lsp.last_run import last_run_of
from elitescript.lsp.recorder import CallRecorder
from elitescript.lsp.run_data import encoded
from elitescript.plotting.line_times import ThreadLines
from elitescript.plotting.page import page
from elitescript.plotting.recorder import RunRecorder
from elitescript.plotting.sampling import Sampling
from elitescript.robot import VirtualRobot
from elitescript.run import Run
from elitescript.services.child.jail import enter_jail
from elitescript.world_file import closed_world

UNTIL_S: Final = 300.0
"""Most robot time of a run, s."""
WALL_S: Final = 5.0
"""Most wall time of a run, unless the request names another, s."""
MEMORY_BYTES: Final = 1 << 30
MESSAGES_MAX: Final = 100
"""Messages in the report."""
FINDINGS_MAX: Final = 100
"""Findings in the report, the worst first."""


def outcome_of(request: Mapping[str, Any], *, is_jailed: bool = True) -> dict[str, Any]:
    """Run a program.

    Args:
        request: `text`, `name`, `folder` (of the task, or None), `world` (path, or None), `options` of the robot, and
            `with_page`; `wall_s`, after which it is cut short.
        is_jailed: lock this process in first.

    Returns:
        `report`: how it ended, or what keeps it from running; `last`: what editors show of it, None if it did not run;
        `page`: the text of the page that shows it, if that is asked for.
    """
    try:
        folder = request.get("folder")
        files = folder_contents(Path(folder)) if folder else FolderCopy()
        robot = _robot(request, files)
        if is_jailed:
            enter_jail(memory_max=MEMORY_BYTES)
        unit = robot.compile(SourceFile(request["name"], request["text"]))
    except ProgramError as error:
        return {"report": {"state": "does_not_compile", "problems": [str(found) for found in error.problems[:20]]}}
    except ElitescriptError as error:
        return {"report": {"state": "does_not_run", "problems": [str(error)]}}
    threads = ThreadLines()
    recorder = RunRecorder(robot, Sampling()) if request.get("with_page") else None

    limit_s = perf_counter() + float(request.get("wall_s", WALL_S))

    def watch(robot: VirtualRobot) -> None:
        if perf_counter() > limit_s:
            robot.interrupt("time_limit")
        threads.record(robot.time_s, [(thread.name, thread.line) for thread in robot.threads()])
        if recorder is not None:
            recorder.watch(robot)

    with CallRecorder(unit) as calls:
        run = robot.run(unit, until_s=UNTIL_S, trace=False if recorder is None else recorder.sampling, watch=watch)
    main = next(iter(threads.stretches(run.time_s).values()), [])
    last = last_run_of(run, request["text"], stretches=main, counts=calls.counts, values=calls.values())
    found: dict[str, Any] = {"report": _report(run, files.left_out), "last": encoded(last)}
    if recorder is not None:
        found["page"] = page(recorder.recording(Path(request["name"]).name, robot, unit.source, run))
    return found


def _robot(request: Mapping[str, Any], files: Mapping[str, bytes]) -> VirtualRobot:
    """Return the robot of a request, with a copy of the files of its folder."""
    robot = VirtualRobot(world=closed_world(request.get("world")), task_dir=files, **request.get("options", {}))
    robot.reports_signals = False
    return robot


def _report(run: Run, left_out: str) -> dict[str, Any]:
    return {
        "state": run.state,
        "time_s": run.time_s,
        "log": run.log[-MESSAGES_MAX:],
        "findings": run.findings.records()[:FINDINGS_MAX],
        "why": run.why,
        "warnings": [*([left_out] if left_out else []), *run.warnings[-MESSAGES_MAX:]],
        "alarms": [{"line": alarm.line, "code": alarm.code, "text": alarm.text} for alarm in run.alarms],
    }


def _main() -> None:
    end_with_parent(int(sys.argv[1]))
    answers = os.fdopen(os.dup(1), "wb")
    # What a program prints is not the outcome.
    os.dup2(2, 1)
    request = json.loads(sys.stdin.buffer.read())
    answers.write(json.dumps(outcome_of(request)).encode())
    answers.flush()
    # No destructor of a program's object is to run now.
    os._exit(0)


if __name__ == "__main__":
    _main()
