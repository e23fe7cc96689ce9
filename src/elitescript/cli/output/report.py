"""Reports of a run: lines of text, or one JSON object per line."""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Collection, Iterable
from typing import Any, Final

from elitescript.cli.output.screen import palette_of, rendered, shown_line_writer
from elitescript.controller.views.warning_limit import MOST
from elitescript.errors import UsageError
from elitescript.json_records import jsonlines
from elitescript.json_records.events import record_of
from elitescript.language.diagnostics import Diagnostic, excerpt, to_json
from elitescript.language.text.source import SourceFile
from elitescript.messages.events import (
    Alarm,
    ChannelActivity,
    DeviceNoted,
    Event,
    Popup,
    Printed,
    SafetyModeChanged,
    SignalChanged,
    TextMessage,
    Warned,
)
from elitescript.messages.timing import seconds
from elitescript.robot import VirtualRobot
from elitescript.run import Run
from elitescript.said import parts_of
from elitescript.shown import shown, shown_word

TYPE_CHECKING = False
if TYPE_CHECKING:
    from elitescript.cli.output.writable import Writable

LOGS: Final = ("signals", "channels")
"""Events that lines of text leave out unless `--log` names them."""


NO_FINDINGS: Final = {"error": 0, "warning": 0, "note": 0}
"""Numbers of findings of a run that has none."""


def parse_logs(text: str | None) -> frozenset[str]:
    """Return the names of `--log`, separated by commas; none if it is not given.

    Raises:
        UsageError: a name that is none of `LOGS`.
    """
    names = frozenset() if text is None else frozenset(name.strip() for name in text.split(","))
    for name in sorted(names.difference(LOGS)):
        raise UsageError(f"--log {text}: there is no {name!r}; there are {', '.join(LOGS)}")
    return names


_NO_SOURCE: Final = SourceFile("<program>", "")


class JsonRunReport:
    """Prints one JSON object per line; hints go to standard error. `TextRunReport` documents the methods."""

    def __init__(self, out: Writable) -> None:
        self._out = out
        self._reported: set[tuple[str, int]] = set()
        """Code and line of each problem found before the run, whose warnings are not repeated."""
        self._source = _NO_SOURCE

    def _write(self, record: dict[str, Any]) -> None:
        self._out.write(jsonlines.line(record) + "\n")
        self._out.flush()

    def problems(self, problems: Iterable[Diagnostic], source: SourceFile | None) -> None:
        self._source = source or _NO_SOURCE
        for problem in problems:
            self._reported.add((problem.code, problem.line))
            self._write(self._with_node(to_json(problem)))

    def _with_node(self, record: dict[str, Any]) -> dict[str, Any]:
        """Return a record with the node of a graphical program to which its line belongs."""
        node = self._source.place(record.get("line") or 0) if self._source.places else ""
        return {**record, "node": node} if node else record

    def goes_on(self, errors: int) -> None:
        print(_why_it_runs(errors), file=sys.stderr)

    def start(self) -> None:
        pass

    def event(self, event: Event) -> None:
        is_reported = isinstance(event, Warned) and (event.code, event.line) in self._reported
        record = None if is_reported else record_of(event)
        if record is not None:
            self._write(self._with_node(record))

    def still_running(self, robot: VirtualRobot, wall_s: float) -> None:
        print(_where(robot, wall_s), file=sys.stderr)

    def end(self, run: Run, *, is_interrupted: bool, overruns: int | None, is_strict: bool = False) -> None:
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
        if run.undelivered:
            record["undelivered"] = run.undelivered
        if not run.is_reproducible:
            record["reproducible"] = False
        if run.state not in ("finished", "alarm"):
            record["threads"] = [thread._asdict() for thread in run.threads]
        record["findings"] = run.findings.counts() if run.has_findings else dict(NO_FINDINGS)
        record["why"] = run.why
        if run.why is not None:
            record |= parts_of(run.why, "why_")
        self._write(record)

    def finish(self) -> None:
        pass


class TextRunReport:
    """Prints lines of text: messages on standard output, problems on standard error.

    Args:
        out: for messages.
        err: for problems.
        logs: further events to print, of `LOGS`.
    """

    def __init__(self, out: Writable, err: Writable, logs: Collection[str] = ()) -> None:
        self._logs = frozenset(logs)
        self._out = out
        self._write_line = shown_line_writer(out)
        self._err = err
        self._palette = palette_of(err)
        self._start_s = 0.0
        self._reported: set[tuple[str, int]] = set()
        """Code and line of each problem found before the run, whose warnings are not repeated."""
        self._source = _NO_SOURCE

    def problems(self, problems: Iterable[Diagnostic], source: SourceFile | None) -> None:
        """Report the findings before the run."""
        self._source = source or _NO_SOURCE
        counts: Counter[str] = Counter()
        for problem in problems:
            self._reported.add((problem.code, problem.line))
            counts[problem.code] += not problem.is_error
            if counts[problem.code] <= MOST:
                print(rendered(problem, source, self._palette), file=self._err)
        for code, count in counts.items():
            if count > MOST:
                print(f"… {count - MOST:,} more {code}: `elitescript check` shows all of them", file=self._err)

    def goes_on(self, errors: int) -> None:
        """Report that the program starts although `errors` of its problems are errors."""
        print(_why_it_runs(errors), file=self._err)

    def start(self) -> None:
        """Note the begin of the run."""
        self._start_s = time.perf_counter()

    def event(self, event: Event) -> None:
        """Report an event."""
        if isinstance(event, TextMessage):
            self._line(event.tick, shown(event.text))
        elif isinstance(event, Printed):
            self._line(event.tick, shown(event.text.rstrip("\n")))
        elif isinstance(event, Popup):
            note = " (confirmed at once: there is no person to press the button)" if event.is_confirmed_at_once else ""
            self._line(
                event.tick, f"[popup, {shown_word(event.level)}] {shown(event.title)}: {shown(event.text)}{note}"
            )
        elif isinstance(event, Warned):
            self._warned(event)
        elif isinstance(event, DeviceNoted) and event.is_warning:
            kind = self._palette.paint("warning", "warning")
            self._problem(event.tick, f"{kind}: {shown_word(event.device)}: {shown(event.text)}")
        elif isinstance(event, DeviceNoted):
            self._line(event.tick, f"[{shown_word(event.device)}] {shown(event.text)}")
        elif isinstance(event, SafetyModeChanged):
            mode = self._palette.paint("warning", event.mode.name)
            self._problem(event.tick, f"safety: {mode}" + (f": {shown(event.reason)}" if event.reason else ""))
        elif isinstance(event, Alarm):
            self._alarm(event)
        elif isinstance(event, SignalChanged):
            if "signals" in self._logs:
                name = shown_word(event.name)
                by = event.by if event.by != "program" or not event.line else self._source.line_words(event.line)
                self._line(event.tick, f"[signal] {name} = {shown(str(event.value))} ({shown_word(by)})")
        elif isinstance(event, ChannelActivity) and "channels" in self._logs:
            data = f" {event.data!r}" if event.data else ""
            where = f" ({self._source.line_words(event.line)})" if event.line else ""
            self._line(event.tick, shown(f"[{event.kind} {event.channel!r}] {event.what}{data}{where}"))

    def _warned(self, event: Warned) -> None:
        if (event.code, event.line) in self._reported:
            return
        role = event.severity
        kind = self._palette.paint(role, shown_word(f"{event.severity} {event.code}".rstrip()))
        where = f"{self._source.line_words(event.line)}: " if event.line else ""
        self._problem(event.tick, f"{kind}: {where}{shown(event.text)}")
        if event.hint:
            print(self._palette.paint("hint", f"{'':14}hint: {shown(event.hint)}"), file=self._err)

    def _words(self, line: int, node: str) -> str:
        """Return a line in words; of a program that stands elsewhere, its event says the node."""
        if node and not self._source.places:
            return f"{shown(node)} (script line {line})"
        return self._source.line_words(line)

    def _line(self, tick: int, text: str) -> None:
        """Write a line of standard output; the texts in it have been shown."""
        self._write_line(f"{seconds(tick):10.3f} s  {text}\n")

    def _problem(self, tick: int, text: str) -> None:
        self._out.flush()
        print(f"{seconds(tick):10.3f} s  {text}", file=self._err)

    def _alarm(self, alarm: Alarm) -> None:
        thread = "" if alarm.thread in ("", "main") else f", thread {shown_word(alarm.thread)}"
        words = self._words(alarm.line, str(alarm.details.get("node", "")))
        where = f" in {words}{thread}" if alarm.line else thread
        paint = self._palette.paint
        kind = paint("alarm", f"ALARM {shown_word(alarm.code)}")
        self._problem(alarm.tick, f"{kind}{where}: {shown_word(alarm.class_name)}: {shown(alarm.text)}")
        if alarm.source_line.strip():
            around, cut = excerpt(alarm.source_line, min(alarm.column, len(alarm.source_line)))
            print(f"{'':14}{alarm.line:>5} | {shown(around).expandtabs(8)}", file=self._err)
            if 0 < alarm.column <= len(alarm.source_line):
                before = len(shown(around[: alarm.column - 1 - cut]).expandtabs(8))
                print(f"{'':14}      | {' ' * before}{paint('caret', '^')}", file=self._err)
        if alarm.details.get("hint"):
            print(paint("hint", f"{'':14}hint: {shown(str(alarm.details['hint']))}"), file=self._err)
        for hint in alarm.details.get("hints", ()):
            print(paint("hint", f"{'':14}try: {shown(str(hint))}"), file=self._err)

    def still_running(self, robot: VirtualRobot, wall_s: float) -> None:
        """Report the place of a long run."""
        self._out.flush()
        print(_where(robot, wall_s), file=self._err)

    def end(self, run: Run, *, is_interrupted: bool, overruns: int | None, is_strict: bool = False) -> None:
        """Report the end of a run.

        Args:
            run: the run.
            is_interrupted: whether Ctrl-C has ended it.
            overruns: ticks that began late; None if it was not paced.
            is_strict: whether warnings of the run are a failure.
        """
        wall_s = time.perf_counter() - self._start_s
        self._out.flush()
        if run.state not in ("finished", "alarm"):
            for thread in run.threads:
                where = self._source.line_words(thread.line)
                print(f"{'':14}{shown_word(thread.name)}: {where}, {shown(thread.doing)}", file=self._err)
        late = f"; {overruns} ticks began late" if overruns else ""
        # What has errors or warnings is not green, though it has finished.
        role = "finished" if run.is_clean else "alarm" if run.state == "alarm" else "warning"
        verdict = run.verdict.replace("stopped", "interrupted", 1) if is_interrupted else run.verdict
        state = palette_of(self._out).paint(role, verdict)
        spoilt = ", which --strict does not allow" if is_strict and run.is_spoilt else ""
        print(
            f"{run.time_s:10.3f} s  {state}{spoilt} (robot time; {wall_s:.2f} s on this computer{late})", file=self._out
        )

    def finish(self) -> None:
        """Complete the report, also of a program that was refused."""


RunReport = JsonRunReport | TextRunReport


def _why_it_runs(errors: int) -> str:
    found = "1 error: its line raises" if errors == 1 else f"{errors} errors: their lines raise"
    return f"{found} an exception. A program can catch exceptions, so it runs. --strict refuses it"


def _where(robot: VirtualRobot, wall_s: float) -> str:
    threads = "; ".join(
        f"{shown_word(thread.name)} in line {thread.line}, {shown(thread.doing)}"
        for thread in robot.explained_threads()
    )
    hint = "(Ctrl-C ends it, --until limits it)"
    return f"{robot.time_s:10.3f} s  still running after {wall_s:.0f} s on this computer: {threads} {hint}"
