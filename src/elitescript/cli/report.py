"""What a run prints: lines for people, or one JSON object per line for programs."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Protocol

from elitescript.cli import jsonlines
from elitescript.cli.writable import Writable
from elitescript.language.diagnostics import Diagnostic, render, to_json
from elitescript.language.source import SourceFile
from elitescript.messages.events import (
    Alarm,
    DeviceNoted,
    Event,
    Popup,
    Printed,
    SafetyModeChanged,
    TextMessage,
    Warned,
)
from elitescript.messages.timing import seconds
from elitescript.robot import VirtualRobot
from elitescript.run import Run


class Report(Protocol):
    """Where a run's words go."""

    def problems(self, problems: Iterable[Diagnostic], source: SourceFile | None) -> None:
        """What was found before the run."""

    def goes_on(self, errors: int) -> None:
        """Say that the program starts though `errors` of its problems are errors."""

    def start(self, robot: VirtualRobot, path: Path) -> None:
        """The run begins."""

    def event(self, event: Event) -> None:
        """Something happened."""

    def still_running(self, robot: VirtualRobot, wall_s: float) -> None:
        """The run takes long."""

    def end(self, run: Run, *, is_interrupted: bool, overruns: int | None) -> None:
        """The run is over.

        Args:
            run: its record.
            is_interrupted: Ctrl-C ended it.
            overruns: ticks that began late, if it was paced.
        """


class JsonReport:
    """One JSON object per line; hints for people go to standard error."""

    def __init__(self, out: Writable) -> None:
        self._out = out

    def _write(self, record: dict[str, Any]) -> None:
        self._out.write(jsonlines.line(record) + "\n")
        self._out.flush()

    def problems(self, problems: Iterable[Diagnostic], source: SourceFile | None) -> None:
        for problem in problems:
            self._write(to_json(problem))

    def goes_on(self, errors: int) -> None:
        print(_why_it_runs(errors), file=sys.stderr)

    def start(self, robot: VirtualRobot, path: Path) -> None:
        pass

    def event(self, event: Event) -> None:
        record = _RECORDS.get(type(event))
        if record is not None:
            self._write(record(event))

    def still_running(self, robot: VirtualRobot, wall_s: float) -> None:
        print(_where(robot, wall_s), file=sys.stderr)

    def end(self, run: Run, *, is_interrupted: bool, overruns: int | None) -> None:
        record: dict[str, Any] = {
            "type": "end",
            "state": run.state,
            "t": run.time_s,
            "globals": run.globals,
            "joints": run.joints,
            "tcp_pose": run.tcp_pose,
            "signals": run.signals,
        }
        if overruns is not None:
            record.update(paced=True, overruns=overruns)
        elif run.is_paced:
            record["paced"] = True
        if not run.is_reproducible:
            record["reproducible"] = False
        if run.state not in ("finished", "alarm"):
            record["threads"] = [thread._asdict() for thread in run.threads]
        self._write(record)


def _log_record(event: Any) -> dict[str, Any]:
    return {
        "type": "log",
        "t": seconds(event.tick),
        "level": event.level,
        "text": event.text,
        "thread": event.thread,
        "line": event.line,
    }


def _print_record(event: Any) -> dict[str, Any]:
    return {"type": "print", "t": seconds(event.tick), "text": event.text, "thread": event.thread, "line": event.line}


def _popup_record(event: Any) -> dict[str, Any]:
    return {
        "type": "popup",
        "t": seconds(event.tick),
        "level": event.level,
        "title": event.title,
        "text": event.text,
        "blocking": event.is_blocking,
        "confirmed": event.is_confirmed_at_once,
        "thread": event.thread,
        "line": event.line,
    }


def _warning_record(event: Any) -> dict[str, Any]:
    record = {
        "type": "warning",
        "t": seconds(event.tick),
        "text": event.text,
        "thread": event.thread,
        "line": event.line,
    }
    for name in ("code", "hint", "column"):
        if value := getattr(event, name):
            record[name] = value
    if event.code:
        record["severity"] = event.severity
    return record


def _device_record(event: Any) -> dict[str, Any]:
    level = "warning" if event.is_warning else "info"
    return {"type": "device", "t": seconds(event.tick), "level": level, "device": event.device, "text": event.text}


def _alarm_record(event: Any) -> dict[str, Any]:
    return {
        "type": "alarm",
        "t": seconds(event.tick),
        "code": event.code,
        "class": event.class_name,
        "text": event.text,
        "line": event.line,
        "column": event.column,
        "thread": event.thread,
        **event.details,
    }


def _safety_record(event: Any) -> dict[str, Any]:
    return {"type": "safety", "t": seconds(event.tick), "mode": event.mode.name, "text": event.reason}


_RECORDS = {
    TextMessage: _log_record,
    Printed: _print_record,
    Popup: _popup_record,
    Warned: _warning_record,
    DeviceNoted: _device_record,
    Alarm: _alarm_record,
    SafetyModeChanged: _safety_record,
}


class TextReport:
    """Lines for people: messages on standard output, everything about mistakes on standard error."""

    def __init__(self, out: Writable, err: Writable) -> None:
        self._out = out
        self._err = err
        self._start_s = 0.0

    def problems(self, problems: Iterable[Diagnostic], source: SourceFile | None) -> None:
        for problem in problems:
            print(str(problem) if source is None else render(problem, source), file=self._err)

    def goes_on(self, errors: int) -> None:
        print(_why_it_runs(errors), file=self._err)

    def start(self, robot: VirtualRobot, path: Path) -> None:
        self._start_s = time.perf_counter()

    def event(self, event: Event) -> None:
        if isinstance(event, TextMessage):
            self._line(event.tick, event.text)
        elif isinstance(event, Printed):
            self._line(event.tick, event.text.rstrip("\n"))
        elif isinstance(event, Popup):
            note = " (confirmed at once: nobody is there to press the button)" if event.is_confirmed_at_once else ""
            self._line(event.tick, f"[popup, {event.level}] {event.title}: {event.text}{note}")
        elif isinstance(event, Warned):
            kind = f"{event.severity} {event.code}".rstrip()
            where = f"line {event.line}: " if event.line else ""
            self._problem(event.tick, f"{kind}: {where}{event.text}")
            if event.hint:
                print(f"{'':14}hint: {event.hint}", file=self._err)
        elif isinstance(event, DeviceNoted) and event.is_warning:
            self._problem(event.tick, f"warning: {event.device}: {event.text}")
        elif isinstance(event, DeviceNoted):
            self._line(event.tick, f"[{event.device}] {event.text}")
        elif isinstance(event, SafetyModeChanged):
            self._problem(event.tick, f"safety: {event.mode.name}" + (f": {event.reason}" if event.reason else ""))
        elif isinstance(event, Alarm):
            self._alarm(event)

    def _line(self, tick: int, text: str) -> None:
        print(f"{seconds(tick):10.3f} s  {text}", file=self._out)

    def _problem(self, tick: int, text: str) -> None:
        self._out.flush()
        print(f"{seconds(tick):10.3f} s  {text}", file=self._err)

    def _alarm(self, alarm: Alarm) -> None:
        thread = "" if alarm.thread in ("", "main") else f", thread {alarm.thread}"
        where = f" in line {alarm.line}{thread}" if alarm.line else thread
        self._problem(alarm.tick, f"ALARM {alarm.code}{where}: {alarm.class_name}: {alarm.text}")
        if alarm.source_line.strip():
            text = alarm.source_line.expandtabs(8)
            print(f"{'':14}{alarm.line:>5} | {text}", file=self._err)
            if alarm.column > 0:
                before = len(alarm.source_line[: alarm.column - 1].expandtabs(8))
                print(f"{'':14}      | {' ' * before}^", file=self._err)
        if alarm.details.get("hint"):
            print(f"{'':14}hint: {alarm.details['hint']}", file=self._err)
        for hint in alarm.details.get("hints", ()):
            print(f"{'':14}try: {hint}", file=self._err)

    def still_running(self, robot: VirtualRobot, wall_s: float) -> None:
        self._out.flush()
        print(_where(robot, wall_s), file=self._err)

    def end(self, run: Run, *, is_interrupted: bool, overruns: int | None) -> None:
        wall_s = time.perf_counter() - self._start_s
        words = {
            "finished": "finished",
            "alarm": "ended by an alarm",
            "stopped": "interrupted" if is_interrupted else "stopped",
            "time_limit": "still running at the time limit",
            "stuck": "stuck: nothing can ever happen again",
        }
        self._out.flush()
        if run.state not in ("finished", "alarm"):
            for thread in run.threads:
                print(f"{'':14}{thread.name}: line {thread.line}, {thread.doing}", file=self._err)
        late = f"; {overruns} ticks began late" if overruns else ""
        print(f"{run.time_s:10.3f} s  {words[run.state]} (robot time; {wall_s:.2f} s of yours{late})", file=self._out)


def _why_it_runs(errors: int) -> str:
    found = "1 error: its line raises an exception" if errors == 1 else f"{errors} errors: their lines raise exceptions"
    return f"{found}, which the program may catch, so it runs anyway; --strict refuses it"


def _where(robot: VirtualRobot, wall_s: float) -> str:
    threads = "; ".join(f"{thread.name} in line {thread.line}, {thread.doing}" for thread in robot.threads())
    hint = "(Ctrl-C ends it, --until limits it)"
    return f"{robot.time_s:10.3f} s  still running after {wall_s:.0f} s of yours: {threads} {hint}"
