"""What a report of a failed test says of its robots: last lines, signals, messages, alarm, and a page of the run."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from elitescript.conversation.describe import alarm_report, asked_motion
from elitescript.language.text.source import SourceFile
from elitescript.messages.events import (
    Alarm,
    Event,
    Popup,
    Printed,
    SignalChanged,
    TaskStateChanged,
    TextMessage,
    Warned,
)
from elitescript.messages.timing import TICKS_PER_S, seconds
from elitescript.outputs.writing import why_no_page, write_file
from elitescript.plotting.line_times import stretches
from elitescript.plotting.page import page
from elitescript.plotting.recording import Recording
from elitescript.pytest_plugin.watching import WatchedRun
from elitescript.shown import continued, shown_word

LINES_SHOWN: Final = 12
SIGNALS_SHOWN: Final = 12
MESSAGES_SHOWN: Final = 8
FINDINGS_SHOWN: Final = 8
TEXT_MAX: Final = 160
"""Characters of one text."""
NAME_MAX: Final = 120
"""Characters of the name of a page."""
_SERVED: Final = ("type", "name", "value", "state", "code", "class", "text")
"""What is shown of a line that `serve --json` has printed, in this order."""


def section(watched: Iterable[WatchedRun], pages: Iterable[str] = ()) -> str:
    """Return the section of a report about the runs of a test."""
    parts = [_about(run) for run in watched]
    parts += [f"page: {shown_word(text)}" for text in pages]
    return "\n".join(parts)


def served_section(log: Sequence[Mapping[str, Any]]) -> str:
    """Return the section of a report about a served robot: the last lines of its log."""
    out = []
    for line in log[-LINES_SHOWN:]:
        time = f"{line['t']:9.3f} s" if "t" in line else ""
        text = " ".join(str(line[name]) for name in _SERVED if name in line)
        place = f"  (line {line['line']})" if line.get("line") else ""
        out.append(f"  {time:11}  {continued(_short(text))}{place}")
    return "\n".join(["last lines of the log:", *out])


def _about(watched: WatchedRun) -> str:
    source, start = watched.unit.source, watched.start_tick
    events = watched.record.read()

    def at(tick: int, text: str, line: int = 0) -> str:
        place = f"  (line {line})" if line else ""
        return f"  {seconds(tick - start):9.3f} s  {continued(_short(text))}{place}"

    out = [f"{shown_word(source.name)} on {watched.model.name}: {_ending(watched, events)}"]
    if lines := _lines(watched, events)[-LINES_SHOWN:]:
        out.append("last lines:" if watched.rows is not None else "last lines with an effect:")
        out += [at(tick, _line(source, line)) for tick, line in lines]
    signals = [event for event in events if isinstance(event, SignalChanged)]
    if signals:
        out.append("signals that changed:")
        for event in signals[-SIGNALS_SHOWN:]:
            by = "" if event.by == "program" else f"  by {event.by}"
            out.append(at(event.tick, f"{event.name} = {event.value}{by}", event.line))
        if len(signals) > SIGNALS_SHOWN:
            out[-SIGNALS_SHOWN - 1] = f"signals that changed, the last {SIGNALS_SHOWN} of {len(signals)}:"
    # An alarm has a part of its own below.
    if found := watched.findings.without_alarms:
        out.append(f"found: {found.words}")
        out += [f"  {continued(_short(str(finding)))}" for finding in found[:FINDINGS_SHOWN]]
    texts = [event for event in events if isinstance(event, TextMessage | Printed | Popup | Warned)]
    if texts:
        out.append("last messages:")
        for message in texts[-MESSAGES_SHOWN:]:
            text = str(message.text).rstrip("\n")
            out.append(at(message.tick, f"warning: {text}" if isinstance(message, Warned) else text, message.line))
    for alarm in watched.alarms:
        out.append("alarm:")
        out += [f"  {line}" for line in _alarm_lines(alarm, source, start)]
    run = watched.run()
    waiting = () if run is None else run.threads
    if waiting:
        out.append("threads:")
        out += [f"  {shown_word(row.name)}: line {row.line}, {continued(row.doing)}" for row in waiting]
    return "\n".join(out)


def _line(source: SourceFile, line: int) -> str:
    """Return a line with its number; in the script of a graphical program with its node."""
    node = source.place(line)
    return f"{line:4}  {f'{node}: ' if node else ''}{source.line(line).strip()}"


def _ending(watched: WatchedRun, events: Sequence[Event]) -> str:
    """Return how and when a run ended, in words."""
    if (run := watched.run()) is not None:
        said = {"": "still running", "time_limit": "still running at the time limit"}.get(run.state, run.state)
        return f"{said} after {run.time_s:.3f} s"
    ends = [event for event in events if isinstance(event, TaskStateChanged) and event.ending]
    if not ends:
        return "dropped before its end"
    return f"{ends[-1].ending} after {seconds(ends[-1].tick - watched.start_tick):.3f} s"


def _lines(watched: WatchedRun, events: Sequence[Event]) -> list[tuple[int, int]]:
    """Return tick and line of the last lines, each once in a row: all that took time, or those that did something."""
    found: list[tuple[int, int]] = []
    if watched.rows is not None:
        rows = watched.rows.rows
        spans = stretches(rows) if len(rows) else []
        found = [(round(span.start_s * TICKS_PER_S), span.line) for span in spans if span.line]
    else:
        found = [(event.tick, line) for event in events if (line := getattr(event, "line", 0))]
    return [here for before, here in zip([(0, 0), *found], found, strict=False) if before[1] != here[1]]


def _alarm_lines(alarm: Alarm, source: SourceFile, start_tick: int) -> list[str]:
    place = source.where(alarm.line, alarm.column) if alarm.line else shown_word(source.name)
    text = continued(f"{alarm.code} {alarm.class_name}: {alarm.text}")
    lines = [f"{seconds(alarm.tick - start_tick):.3f} s  {place}: {text}"]
    if alarm.source_line:
        lines.append(f"    {alarm.source_line.strip()}")
    if alarm.details.get("hint"):
        lines.append(f"hint: {continued(str(alarm.details['hint']))}")
    return lines


def _short(text: str) -> str:
    return text if len(text) <= TEXT_MAX else f"{text[: TEXT_MAX - 3]}..."


def write_pages(folder: Path, test: str, watched: Iterable[WatchedRun]) -> list[str]:
    """Write a page for each run that has rows; return their paths, with the reason for one that is not written.

    Args:
        folder: is made if it is missing.
        test: id of the test, which names the files.
        watched: the runs.
    """
    found = [run for run in watched if run.rows is not None and len(run.rows.rows)]
    stem = re.sub(r"[^\w.]+", "-", test).strip("-.")[-NAME_MAX:]
    paths: list[str] = []
    for number, watch in enumerate(found, 1):
        assert watch.rows is not None
        run, events = watch.run(), watch.record.read()
        alarm = watch.alarms[-1] if watch.alarms else None
        recording = Recording(
            f"{test}: {Path(watch.unit.source.name).name}",
            watch.model,
            watch.rows.rows,
            watch.unit.source,
            events,
            "" if run is None else run.state,
            watch.rows.step_s,
            alarm=None if alarm is None else alarm_report(alarm, asked_motion(alarm, None, events)),
            problems=() if watch.check_text is None else watch.check_text(),
            findings=watch.findings,
        )
        path = folder / (f"{stem}.html" if len(found) == 1 else f"{stem}.{number}.html")
        folder.mkdir(parents=True, exist_ok=True)
        if why := why_no_page(path):
            paths.append(f"{path} is not written: {why}")
            continue
        write_file(path, page(recording))
        paths.append(str(path))
    return paths
