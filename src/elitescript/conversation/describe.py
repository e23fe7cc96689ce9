"""Makes the messages to a page of what is known of a robot, a text and a run, each ready for JSON.

A live engine, a recorded page and a connected controller describe themselves with the same functions, which take
records and rows and know nothing of processes. `web/src/source/messages.ts` says what each message holds; the one with
the solids is made by `solids.scene`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

from elitescript.conversation.limits import (
    FINDINGS_BYTES_MAX,
    FINDINGS_MAX,
    FIX_BYTES_MAX,
    PLACES_MAX,
    RUN_FINDINGS_MAX,
    THREADS_MAX,
    VARIABLES_BYTES_MAX,
    VARIABLES_MAX,
    EventBudget,
    bounded,
    cut,
    cut_name,
    cut_text,
    size_of,
)
from elitescript.conversation.messages import PROTOCOL, RunOptions, options_data
from elitescript.json_records.events import record_of
from elitescript.json_records.jsonlines import plain
from elitescript.language.diagnostics import Diagnostic, Severity
from elitescript.lint.registry import all_rules
from elitescript.messages.events import Alarm, Event, MotionEnded, MotionStarted
from elitescript.messages.findings import NOTE, Finding
from elitescript.messages.motion import MotionRequest, MoveC, MoveJ, MoveL, MoveP, ServoJ, Six
from elitescript.messages.signals import Value
from elitescript.messages.timing import seconds
from elitescript.records import field, record, replace
from elitescript.said import parts_of
from elitescript.solids.contacts import Contact
from elitescript.untrusted.json_text import json_value

Message = dict[str, Any]

LIVE_ABILITIES: Final = ("edit", "save", "services", "seek", "step", "record", "inputs", "connect")
"""What a live engine can do."""

# ---------------------------------------------------------------- the conversation


def hello(
    mode: str,
    product: str,
    abilities: Iterable[str],
    title: str,
    *,
    programs: Sequence[str] | None = None,
    settings: Mapping[str, Any] | None = None,
) -> Message:
    """Return the first message of a source.

    Args:
        mode: `live`, `recorded` or `connected`.
        product: name and version of what speaks.
        abilities: what the source can do.
        title: of the page.
        programs: names of programs that can be opened or loaded.
        settings: what the page has asked to remember.
    """
    found: Message = {
        "type": "hello",
        "protocol": PROTOCOL,
        "product": product,
        "mode": mode,
        "abilities": list(abilities),
        "title": title,
    }
    if programs is not None:
        found["programs"] = list(programs)
    if settings is not None:
        found["settings"] = dict(settings)
    return found


def refused(text: str, ask: int | None = None, conflict: Mapping[str, str] | None = None) -> Message:
    """Return the answer to what cannot be done, with the reason for people."""
    found: Message = {"type": "refused", "text": cut(text)[0]}
    if ask is not None:
        found["ask"] = ask
    if conflict is not None:
        found["conflict"] = dict(conflict)
    return found


def recorded(ask: int, content: str) -> Message:
    """Return the answer to `record`: a recording in base 64, or the text of a page."""
    return {"type": "recorded", "ask": ask, "content": content}


def notice(severity: str, text: str) -> Message:
    """Return a message for people: `information`, `warning` or `error`."""
    return {"type": "notice", "severity": severity, "text": cut(text)[0]}


# ---------------------------------------------------------------- the text


def problems(version: int, found: Iterable[Diagnostic], *, compiles: bool, start: Moment | None = None) -> Message:
    """Return the findings of a text, and how many rules were checked.

    Args:
        version: of the text.
        found: what `check` finds, in the order of the text; too many are counted in `left_out` by severity.
        compiles: whether the program starts.
        start: of a text that holds nothing yet, of which no run comes: the robot before it.
    """
    shown, left_out = _shown_findings(list(found))
    made: Message = {
        "type": "problems",
        "version": version,
        "list": shown,
        "compiles": compiles,
        "rules": len(all_rules()),
    }
    if left_out:
        made["left_out"] = left_out
    return made if start is None else made | {"start": moment(start)}


def _shown_findings(found: Sequence[Diagnostic]) -> tuple[list[Message], dict[str, int]]:
    """Return the findings that a page is given, in the order of the text, and how many are left out by severity.

    Where there are too many, errors are given before all others.
    """
    shown: dict[int, Message] = {}
    left_out: dict[str, int] = {}
    size = 0
    for index in sorted(range(len(found)), key=lambda index: found[index].severity is not Severity.ERROR):
        if len(shown) < FINDINGS_MAX and size <= FINDINGS_BYTES_MAX:
            made = problem(found[index])
            size += size_of(made)
            if size <= FINDINGS_BYTES_MAX:
                shown[index] = made
                continue
        severity = _severity(found[index])
        left_out[severity] = left_out.get(severity, 0) + 1
    return [shown[index] for index in sorted(shown)], left_out


def _severity(found: Diagnostic) -> str:
    """Return the severity of a finding as the page names it, which is that of editors: a note is information."""
    return "information" if found.severity is Severity.NOTE else str(found.severity)


def problem(found: Diagnostic) -> Message:
    """Return one finding, with its repair if that is certainly what the author meant; a long one is left out whole."""
    made: Message = {
        "severity": _severity(found),
        "code": found.code,
        "text": cut_text(found.text),
        "hint": cut_text(found.hint),
        "line": found.line,
        "column": found.column,
        "end_line": found.end_line,
        "end_column": found.end_column,
    }
    made |= _parts(made)
    if found.fix is not None and found.fix.safe:
        fix = {"title": cut_text(found.fix.title), "edits": [edit._asdict() for edit in found.fix.edits]}
        if size_of(fix) <= FIX_BYTES_MAX:
            made["fix"] = fix
    return made


# ---------------------------------------------------------------- the run


def run_began(run: int, version: int, options: RunOptions, same_until_s: float = 0.0) -> Message:
    """Return the begin of a run."""
    return {
        "type": "run_began",
        "run": run,
        "version": version,
        "same_until_s": same_until_s,
        "options": options_data(options),
    }


def progress(run: int, t: float) -> Message:
    """Return how far a run has come, s."""
    return {"type": "progress", "run": run, "t": t}


def events(run: int, happened: Iterable[Event], budget: EventBudget) -> Message:
    """Return events as `run --json` has them, as far as the page is given them."""
    records = (plain(found) for event in happened if (found := record_of(event)) is not None)
    return {"type": "events", "run": run, "list": budget.take(records)}


def left_out(run: int, budget: EventBudget) -> Message:
    """Return how much of the events of a run is left out, and from when on whole ones are, s."""
    return {
        "type": "left_out",
        "run": run,
        "events": budget.events,
        "bytes": budget.bytes,
        "from_s": budget.from_s,
    }


def lines(run: int, thread: str, stretches: Sequence[tuple[float, int]]) -> Message:
    """Return the times, s, at which a thread comes to a line; line 0 while there is no such thread."""
    return {
        "type": "lines",
        "run": run,
        "thread": cut_name(thread),
        "t": [t for t, _ in stretches],
        "line": [line for _, line in stretches],
    }


def moves(run: int, found: Iterable[tuple[float, float, str, int]]) -> Message:
    """Return moves: start, end, kind and line of each."""
    rows = [{"start_s": start, "end_s": end, "kind": kind, "line": line} for start, end, kind, line in found]
    return {"type": "moves", "run": run, "list": rows}


def marks(run: int, found: Sequence[tuple[int, int]]) -> Message:
    """Return at which ticks which nodes of a graphical program began."""
    return {
        "type": "marks",
        "run": run,
        "t": [seconds(tick) for tick, _ in found],
        "node": [number for _, number in found],
    }


def contacts(run: int, found: Iterable[Contact]) -> Message:
    """Return contacts, and the closest that anything came to a thing."""
    return {"type": "contacts", "run": run, "list": [contact._asdict() for contact in found]}


def cycle(run: int, table: Iterable[tuple[int, float, float, int]]) -> Message:
    """Return the time by line: line, time moving, time standing and visits of each; line 0, no program, is left out."""
    rows = [
        {"line": line, "moving_s": moving, "standing_s": standing, "visits": visits}
        for line, moving, standing, visits in table
        if line
    ]
    return {"type": "cycle", "run": run, "table": rows}


@record
class Variable:
    """A program global at a moment: its value and type as text, and whether it differs from the moment before."""

    name: str
    value: str
    type: str
    changed: bool = False


@record
class Thread:
    """A thread at a moment: its line, what it waits for, and its innermost function."""

    name: str
    line: int
    waits_for: str
    function: str
    because: str = ""
    """Why it does not go on, such as the condition of its loop."""


@record
class Moment:
    """The exact state at a moment.

    Attributes:
        t: s.
        line: of the main thread; 0 if no program runs.
        joints: target positions, rad.
        tcp_pose: m and rad, base frame, roll-pitch-yaw.
        globals, threads: in their order.
        signals: those that are not at their default, by name.
        position: opaque place in the program, for `step`; empty if unknown.
        tcp_force: wrench at the TCP, if it is known.
    """

    t: float
    line: int
    joints: Six
    tcp_pose: Six
    globals: tuple[Variable, ...] = ()
    signals: Mapping[str, Value] = field(default_factory=dict)
    threads: tuple[Thread, ...] = ()
    position: str = ""
    tcp_force: Six | None = None


def moment(found: Moment) -> Message:
    """Return a moment as messages hold it; `left_out` is how many globals and threads are too many, if any are."""
    shown = _shown_variables(found.globals)
    left_out = len(found.globals) - len(shown) + max(0, len(found.threads) - THREADS_MAX)
    made: Message = {
        "t": found.t,
        "line": found.line,
        "joints": list(found.joints),
        "tcp_pose": list(found.tcp_pose),
        "globals": [
            {"name": cut_name(v.name), "value": v.value, "type": cut_name(v.type), "changed": v.changed} for v in shown
        ],
        "signals": plain(dict(found.signals)),
        "threads": [
            {
                "name": cut_name(t.name),
                "line": t.line,
                "waits_for": cut_name(t.waits_for),
                "function": cut_name(t.function),
                **({"because": cut_text(t.because)} if t.because else {}),
            }
            for t in found.threads[:THREADS_MAX]
        ],
    }
    if left_out:
        made["left_out"] = left_out
    if found.position:
        made["position"] = found.position
    if found.tcp_force is not None:
        made["tcp_force"] = list(found.tcp_force)
    return made


def _shown_variables(found: Sequence[Variable]) -> Sequence[Variable]:
    """Return the first variables that a page is given."""
    size = 0
    for number, variable in enumerate(found[:VARIABLES_MAX]):
        size += len(variable.name) + len(variable.value)
        if size > VARIABLES_BYTES_MAX:
            return found[:number]
    return found[:VARIABLES_MAX]


def with_changes(found: Moment, before: Moment | None) -> Moment:
    """Return a moment whose globals are marked where they differ from another moment."""
    if before is None:
        return found
    known = {variable.name: variable.value for variable in before.globals}
    marked = [replace(item, changed=known.get(item.name) != item.value) for item in found.globals]
    return replace(found, globals=tuple(marked))


def state(run: int, ask: int, found: Moment) -> Message:
    """Return the answer to `seek` and `step`."""
    return {"type": "state", "ask": ask, "run": run, "moment": moment(found)}


def run_ended(
    run: int,
    state: str,
    last: Moment,
    *,
    alarm: Message | None = None,
    killed: str = "",
    refused_connections: Sequence[str] = (),
    findings: Sequence[Finding] = (),
) -> Message:
    """Return the end of a run.

    Args:
        run: its number.
        state: `finished`, `stopped`, `alarm`, `time_limit`, `stuck` or `killed`.
        last: its last moment.
        alarm: what `alarm_report` says of it.
        killed: why it was killed.
        refused_connections: where it has tried to connect in vain, since nothing leads out of the simulation.
        findings: of text and run; a page gets those that no other message has.
    """
    found: Message = {"type": "run_ended", "run": run, "state": state, "moment": moment(last)}
    if alarm is not None:
        found["alarm"] = alarm
    if killed:
        found["killed"] = killed
    if refused_connections:
        found["refused_connections"] = [cut_name(place) for place in refused_connections[:PLACES_MAX]]
    if rows := run_findings(findings):
        found["findings"] = rows
    return found


def run_findings(findings: Sequence[Finding]) -> list[Message]:
    """Return what a run itself has found, the worst first; alarms and contacts have messages of their own."""
    rows: list[Message] = []
    for finding in findings:
        if finding.t is None or finding.source in ("check", "contact") or finding.code.startswith("R"):
            continue
        if len(rows) == RUN_FINDINGS_MAX:
            break
        rows.append(
            {
                "severity": "information" if finding.severity == NOTE else finding.severity,
                "code": finding.code,
                "line": finding.line,
                "t": finding.t,
                "count": finding.count,
                "text": cut_text(finding.text),
                "hint": cut_text(finding.hint),
            }
        )
        rows[-1] |= _parts(rows[-1])
    return rows


def _parts(made: Message) -> Message:
    """Return template and values of the text and the hint of a message; what was cut is a constant."""
    return parts_of(made["text"]) | parts_of(made["hint"], "hint_")


# ---------------------------------------------------------------- alarms


def alarm_report(found: Alarm, asked: MotionRequest | None = None) -> Message:
    """Return what a page shows of an alarm.

    Args:
        found: the alarm.
        asked: the motion that was refused or under way; None if it has nothing to do with one.
    """
    details = found.details
    hints = [hint for hint in (details.get("hint", ""), *details.get("hints", ())) if hint]
    made: Message = {
        "t": seconds(found.tick),
        "line": found.line,
        "column": found.column,
        "code": found.code,
        "text": found.text,
        "hints": hints,
        **parts_of(cut(found.text)[0]),
        "hint_parts": [parts_of(cut(hint)[0]) for hint in hints],
    }
    if (limit := limit_in_words(details)) != "":
        made["limit"] = limit
    return bounded(made | (_asked(asked) or _asked_of_command(details)))


_PROTECTIVE_STOP: Final = "R140"
_OF_POSES: Final = "m, rad"
"""Unit of an argument that is a pose."""


def limit_in_words(details: Mapping[str, Any]) -> str:
    """Return the limit of an alarm in words, as `q: 7 rad, allowed [-6.28, 6.28] rad`; empty if it has none."""
    limit, value, unit = details.get("limit"), details.get("value"), str(details.get("unit") or "")
    if not limit:
        return ""
    behind = f" {unit}" if unit else ""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    shown = "" if value is None else f"{value:.6g}{behind}, " if number else f"{value}, "
    name = f"{details['argument']}: " if details.get("argument") else ""
    return f"{name}{shown}allowed {limit}{behind}"


def asked_motion(
    found: Alarm, refused: tuple[int, int, MotionRequest] | None, happened: Iterable[Event]
) -> MotionRequest | None:
    """Return the motion that an alarm is about: the one that was refused there, else the one under way.

    Args:
        found: the alarm.
        refused: tick, line and request of the last motion that was refused.
        happened: events up to the alarm.
    """
    if refused is not None and refused[:2] == (found.tick, found.line):
        return refused[2]
    under_way: MotionRequest | None = None
    for event in happened:
        if isinstance(event, MotionStarted):
            under_way = event.request
        elif isinstance(event, MotionEnded) and event.tick < found.tick:
            under_way = None
        elif event is found:
            break
    return under_way if found.code == _PROTECTIVE_STOP else None


def _asked_of_command(details: Mapping[str, Any]) -> Message:
    """Return the pose that a command was called with, where it is what the command refused."""
    if details.get("unit") != _OF_POSES:
        return {}
    try:
        pose = json_value(str(details.get("value")))
    except ValueError:
        return {}
    is_pose = isinstance(pose, list) and len(pose) == 6 and all(type(item) in (int, float) for item in pose)
    return {"asked_pose": [float(item) for item in pose]} if is_pose else {}


def _asked(request: MotionRequest | None) -> Message:
    if isinstance(request, MoveJ | ServoJ):
        return {"asked_joints": list(request.q_target)}
    if isinstance(request, MoveL | MoveC | MoveP):
        return {"asked_pose": list(request.p_target)}
    return {}
