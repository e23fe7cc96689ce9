"""`elitescript replay`: replays a recorded session as fast as possible, and checks that it is the same."""

from __future__ import annotations

import contextlib
import platform
import sys
from pathlib import Path

from elitescript import __version__
from elitescript.cli.output.report import JsonRunReport, TextRunReport, parse_logs
from elitescript.cli.output.screen import palette_of, progress_on
from elitescript.cli.output.trace_file import TraceFile
from elitescript.controller.views.trace import TraceRow
from elitescript.controller.views.trace_signals import NO_SIGNALS, TraceSignals
from elitescript.errors import UsageError
from elitescript.json_records import jsonlines
from elitescript.kernel.options import UNTIL, accepted
from elitescript.messages.outputs import Output
from elitescript.messages.timing import seconds, ticks_for
from elitescript.services.journal.replay import Replay
from elitescript.services.journal.writer import JournalReader
from elitescript.shown import shown

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

DIFFERS = 1
"""Exit code if the session differs."""


def replay(options: argparse.Namespace) -> int:
    """Play a journal; return the exit code."""
    if options.until is not None:
        accepted(UNTIL, options.until, "--until")
    reader = JournalReader(Path(options.file))
    session = Replay(reader, None if options.until is None else ticks_for(options.until))
    logs = parse_logs(options.log)
    report = JsonRunReport(sys.stdout) if options.json else TextRunReport(sys.stdout, sys.stderr, logs)
    for hint in _hints(reader):
        print(f"note: {shown(hint)}", file=sys.stderr)

    if options.trace_signals is not None and not options.trace:
        raise UsageError("--trace-signals goes with --trace")
    signals = None if options.trace_signals is None else TraceSignals(options.trace_signals)
    names = () if signals is None else signals.names
    trace = TraceFile(options.outputs["trace"], has_actual=True, signals=names) if options.trace else None
    with contextlib.ExitStack() as stack:
        if trace is not None:
            stack.enter_context(trace)
        progress = None if options.json else progress_on(sys.stderr)
        for output in session.outputs():
            if progress is not None:
                progress.update(seconds(output.tick), output.snapshot.robot.line)
            for event in output.events:
                report.event(event)
            if trace is not None:
                trace.write(_row(output, signals))
    if reader.note:
        print(f"note: {shown(reader.note)}", file=sys.stderr)
    _conclude(session, is_json=options.json)
    return 0 if session.difference is None else DIFFERS


def _hints(reader: JournalReader) -> list[str]:
    """Return the differences from the process that wrote the journal, which may change results."""
    theirs = {
        "elitescript": (reader.header.get("version"), __version__),
        "Python": (reader.header.get("python"), platform.python_version()),
    }
    hints = [
        f"recorded by {name} {then}, replayed by {now}: results may differ"
        for name, (then, now) in theirs.items()
        if then != now
    ]
    if reader.header.get("hash_seed") != "0":
        hints.append("recorded in a process without a fixed hash seed: programs that go through a set may differ")
    return hints


def _conclude(session: Replay, *, is_json: bool) -> None:
    difference, last_s = session.difference, seconds(max(session.last_tick, 0))
    if is_json:
        record = {
            "type": "end",
            "state": "same" if difference is None else "differs",
            "t": last_s,
            "ticks": session.last_tick + 1,
            "checked_ticks": session.checked_ticks,
            "first_difference": None if difference is None else difference.tick,
        }
        print(jsonlines.line(record))
    elif difference is None:
        same = palette_of(sys.stdout).paint("finished", "all the same")
        print(f"{last_s:10.3f} s  end of the journal; {session.checked_ticks} ticks checked, {same}")
    else:
        sys.stdout.flush()
        differs = palette_of(sys.stderr).paint("alarm", "differs")
        text = f"{differs} from the journal first at tick {difference.tick}: {shown(difference.text)}"
        print(f"{seconds(difference.tick):10.3f} s  {text}", file=sys.stderr)


def _row(output: Output, signals: TraceSignals | None) -> TraceRow:
    state = output.snapshot.robot
    return TraceRow(
        seconds(output.tick),
        state.line,
        state.q_target,
        state.qd_target,
        state.tcp_pose_target,
        state.task_state.name.lower(),
        state.q_actual,
        NO_SIGNALS if signals is None else signals.of(output.snapshot.signals),
    )
