"""What calls about a program ask for: checked, run, sampled. Called in a worker process, which may be killed.

Everything goes in and out as plain values. Nothing outside the robot is real: no network, no serial port.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any, Final, cast

from elitescript.debugger.values import more, shown
from elitescript.devices.world import World
from elitescript.environment.start_values import check_presets, sorted_settings
from elitescript.errors import UsageError
from elitescript.findings.found import Findings, finding_of_text, in_order
from elitescript.json_records.events import record_of
from elitescript.json_records.jsonlines import plain
from elitescript.kernel.options import UNTIL, accepted
from elitescript.language.diagnostics import Diagnostic, Severity
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import CheckResult, compile_checked
from elitescript.messages.signals import Value
from elitescript.plotting.events import moves
from elitescript.robot import VirtualRobot
from elitescript.run import Run
from elitescript.said import parts_of
from elitescript.world_file import closed_world

FINDINGS_MAX: Final = 100
MESSAGES_MAX: Final = 100
MOVES_MAX: Final = 200
ROWS_MAX: Final = 500
VALUE_MAX: Final = 2000
"""Characters of a text or of the value of a variable."""
ITEMS_MAX: Final = 500
"""Items of a global that is given as it is."""
UNTIL_S: Final = 3600.0
"""Most virtual time of a run that names none, s."""
WALL_S: Final = 10.0
"""Wall time of a run whose caller names none, s."""

_OPTIONS: Final = ("firmware", "seed", "joints", "strict", "task_dir")

_TEXT_KINDS: Final = frozenset(("log", "print", "popup", "warning", "device", "safety"))
"""Records of events that are messages for people."""


def check(request: Mapping[str, Any]) -> dict[str, Any]:
    """Return what `check` finds in a program."""
    robot = _robot(request)
    source = source_of_request(request)
    return cast("dict[str, Any]", with_nodes(_findings(_checked(source, robot)), source))


def run(request: Mapping[str, Any]) -> dict[str, Any]:
    """Run a program; return how it ended and what it did."""
    return _run(request, None)


def trace(request: Mapping[str, Any]) -> dict[str, Any]:
    """Run a program; return rows of the time between `from_s` and `to_s`, and how it ended."""
    begin, end = (float(accepted(UNTIL, request[name], name)) for name in ("from_s", "to_s"))
    step = float(request["step_s"])
    if not begin <= end:
        raise UsageError(f"from_s and to_s: from {begin:g} to {end:g} s is no stretch of time")
    if not step > 0.0:
        raise UsageError(f"step_s must be > 0 s, got {step:g}")
    if not (end - begin) / step <= ROWS_MAX:
        raise UsageError(f"{(end - begin) / step:.0f} rows are too many: at most {ROWS_MAX}; take a larger step_s")
    return _run(request, (begin, end, step))


def start_values(request: Mapping[str, Any]) -> tuple[dict[str, Value], dict[str, Any]]:
    """Return the signals and the program globals that have a value before the program begins."""
    levels, presets = sorted_settings(request.get("set") or {}, "set")
    check_presets(presets, request["text"], "set")
    return levels, presets


def source_of_request(request: Mapping[str, Any]) -> SourceFile:
    """Return the text of a request, that of a graphical program with its nodes.

    Raises:
        ProgramError: a graphical program that cannot run.
    """
    if path := request.get("task"):
        from elitescript.environment.task_files import source_of_task

        return source_of_task(path)
    return SourceFile(request["name"], request["text"])


def with_nodes(answer: Any, source: SourceFile) -> Any:
    """Return an answer with the node beside each line of a graphical program."""
    if not source.places:
        return answer
    if isinstance(answer, list):
        return [with_nodes(item, source) for item in answer]
    if not isinstance(answer, dict):
        return answer
    found = {name: with_nodes(value, source) for name, value in answer.items()}
    line = answer.get("line")
    if isinstance(line, int) and (node := source.place(line)):
        found["node"] = node
    return found


def until_of(request: Mapping[str, Any]) -> float | None:
    """Return the limit of robot time that a request names, s; None for none.

    Raises:
        UsageError: it is no time.
    """
    until_s = request.get("until_s")
    return None if until_s is None else float(accepted(UNTIL, until_s, "until_s"))


def world_of(request: Mapping[str, Any]) -> World:
    """Return what is around the robot: nothing of this computer.

    Raises:
        UsageError: an invalid world file, or one that names Python files or the network of this computer.
    """
    return closed_world(request.get("world"))


def options_of(request: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options of the robot by their names, `task_dir` among them."""
    named = {"model": request.get("robot"), **{name: request.get(name) for name in _OPTIONS}}
    return {name: value for name, value in named.items() if value is not None}


def _robot(request: Mapping[str, Any]) -> VirtualRobot:
    return VirtualRobot(world=world_of(request), **options_of(request))


def _checked(source: SourceFile, robot: VirtualRobot, presets: Mapping[str, Any] | None = None) -> CheckResult:
    options = robot.text_options(source)
    return compile_checked(source, robot.profile, options, presets=presets or (), arm=robot.model)


def _findings(checked: CheckResult) -> dict[str, Any]:
    problems = checked.problems
    return {
        "starts": not checked.is_refused,
        "errors": sum(problem.is_error for problem in problems),
        "warnings": sum(problem.severity is Severity.WARNING for problem in problems),
        "problems": [_finding(problem) for problem in problems[:FINDINGS_MAX]],
        "problems_left_out": max(0, len(problems) - FINDINGS_MAX),
    }


def _finding(problem: Diagnostic) -> dict[str, Any]:
    found: dict[str, Any] = {
        "severity": str(problem.severity),
        "code": problem.code,
        "line": problem.line,
        "column": problem.column,
        "text": problem.text,
        "hint": problem.hint,
        **parts_of(problem.text),
        **parts_of(problem.hint, "hint_"),
    }
    if problem.fix is not None:
        found["fix"] = problem.fix.title
    return found


def _run(request: Mapping[str, Any], window: tuple[float, float, float] | None) -> dict[str, Any]:
    source = source_of_request(request)
    return cast("dict[str, Any]", with_nodes(_outcome_of(request, source, window), source))


def _outcome_of(
    request: Mapping[str, Any], source: SourceFile, window: tuple[float, float, float] | None
) -> dict[str, Any]:
    levels, presets = start_values(request)
    robot = _robot(request)
    robot.set_start(levels)
    checked = _checked(source, robot, presets)
    found = {"check": _findings(checked)}
    if checked.unit is None or checked.is_refused:
        of_text = in_order(map(finding_of_text, checked.problems))
        return _listed(of_text) | {"why": None, "state": "does_not_compile", "time_s": 0.0, **found}
    rows: dict[str, Any] = {}
    if window is not None:
        begin, end, step = window
        rows = {"trace": True, "trace_step_s": step, "trace_window_s": (begin, end)}
    until_s = until_of(request)
    clock = _Clock(float(request.get("wall_s", WALL_S)))
    made = robot.run(
        checked.unit, presets=presets, until_s=UNTIL_S if until_s is None else until_s, watch=clock.watch, **rows
    )
    answer = _verdict(made) | found | {"cut_by_wall_time": clock.is_over} | _outcome(made)
    if window is not None:
        answer["rows"] = [
            {
                "t": row.t,
                "line": row.line,
                "joints": list(row.q),
                "joint_speeds": list(row.qd),
                "tcp_pose": list(row.tcp_pose),
                "state": row.state,
                "signals": plain(dict(row.signals)),
            }
            for row in made.trace[:ROWS_MAX]
        ]
    return answer


def _verdict(run: Run) -> dict[str, Any]:
    """Return what text and run have found, the worst first, and why the run did not finish."""
    return _listed(run.findings) | {"why": None if run.why is None else _short_value(run.why)}


def _listed(findings: Findings) -> dict[str, Any]:
    return {
        "findings": [_short(record) for record in findings.records()[:FINDINGS_MAX]],
        "findings_left_out": max(0, len(findings) - FINDINGS_MAX),
    }


class _Clock:
    """Ends a run that takes too much wall time, so that there is an answer that says how far it came."""

    def __init__(self, wall_s: float) -> None:
        self._end_s = time.monotonic() + wall_s
        self.is_over = False

    def watch(self, robot: VirtualRobot) -> None:
        if time.monotonic() > self._end_s:
            self.is_over = True
            robot.interrupt("time_limit")


def _outcome(run: Run) -> dict[str, Any]:
    """Return how a run ended and what it did."""
    records = [record for event in run.events if (record := record_of(event)) is not None]
    messages = [record for record in records if record["type"] in _TEXT_KINDS]
    signals = [record for record in records if record["type"] == "signal"]
    stretches = moves(run.events, run.time_s)
    alarms = [record for record in records if record["type"] == "alarm"]
    return {
        "state": run.state,
        "time_s": run.time_s,
        "alarm": plain(alarms[-1]) if alarms else None,
        "threads": [
            {"name": thread.name, "line": thread.line, "doing": thread.doing} for thread in run.threads[:MESSAGES_MAX]
        ],
        "messages": [_short(record) for record in messages[-MESSAGES_MAX:]],
        "messages_left_out": max(0, len(messages) - MESSAGES_MAX),
        "moves": [
            {"begin_s": begin, "end_s": end, "kind": kind, "line": line}
            for begin, end, kind, line in stretches[:MOVES_MAX]
        ],
        "moves_left_out": max(0, len(stretches) - MOVES_MAX),
        "signal_changes": [_short(record) for record in signals[-MESSAGES_MAX:]],
        "signal_changes_left_out": max(0, len(signals) - MESSAGES_MAX),
        "globals": {name: _global(value) for name, value in run.globals.items()},
        "signals": plain(dict(run.signals)),
        "joints": list(run.joints),
        "tcp_pose": list(run.tcp_pose),
    }


def _short(record: dict[str, Any]) -> dict[str, Any]:
    return {name: _short_value(value) for name, value in plain(record).items()}


def _global(value: Any) -> Any:
    """Return the value of a global; of a large one what the debugger shows of it."""
    if isinstance(value, (list, tuple, dict, set, frozenset, bytes, bytearray)) and len(value) > ITEMS_MAX:
        return {"repr": shown(value, VALUE_MAX)}
    return _short_value(plain(value))


def _short_value(value: Any) -> Any:
    """Return a plain value, or the begin of its text if that is long."""
    if isinstance(value, (list, dict)):
        text = str(value)
        return value if len(text) <= VALUE_MAX else {"repr": text[:VALUE_MAX] + more(len(text) - VALUE_MAX)}
    if isinstance(value, str) and len(value) > VALUE_MAX:
        return value[:VALUE_MAX] + more(len(value) - VALUE_MAX)
    return value
