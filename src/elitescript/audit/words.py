"""An audit in words, one screen with the most important first, and as JSON."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from math import isfinite
from typing import Any, Final

from elitescript.audit.differences import Finding, Largest
from elitescript.audit.findings import AuditedRun, AuditFindings, Cut
from elitescript.audit.verdict import SOURCE, findings_of, verdict_of
from elitescript.json_records.jsonlines import plain
from elitescript.messages.signals import Value
from elitescript.shown import shown

SHOWN: Final = 6
"""Rows of each list; what is left out is counted."""


def audit_in_words(audit: AuditFindings) -> str:
    """Return the audit for people."""
    lines = [
        *_head(audit),
        *_arm(audit),
        *_run(audit.first, audit.cell.source.line_words),
        *_others(audit),
        *_fit(audit),
        *_rest(audit),
    ]
    lines += _found(audit)
    # Texts of the controller are among them.
    return "\n".join(map(shown, lines))


def audit_as_json(audit: AuditFindings) -> dict[str, Any]:
    """Return the audit as JSON has it; times are s since the begin of the run, in the recording."""
    first = audit.first
    return {
        "agrees": audit.agrees,
        "complete": audit.is_complete,
        "begins": cut_as_json(audit.begins),
        "ends": cut_as_json(audit.ends),
        "divergence": _finding(first, audit.divergence),
        "run": first.number,
        "parameters": {} if audit.fit is None else audit.fit.json()["parameters"],
        "arm": [
            {"name": its.name, "unit": its.unit, "recorded": its.recorded, "model": its.model} for its in audit.arm
        ],
        "runs": [_run_as_json(run) for run in audit.runs],
        "runs_in_all": audit.runs_in_all,
        "model": audit.model.name,
        "rows": len(audit.recording.t),
        "lost": audit.lost,
        "taken": [*audit.taken],
        "not_taken": [*audit.not_taken],
        "findings": findings_of(audit).records(),
        "verdict": {"words": verdict_of(audit), **findings_of(audit).counts()},
        "not_compared": [*dict.fromkeys((*first.comparison.notes, *audit.not_compared))],
        **_details(first),
    }


def cut_as_json(cut: Cut | None) -> dict[str, Any] | None:
    """Return where a run is cut as JSON has it."""
    return None if cut is None else {**cut._asdict(), "t": round(cut.t, 6), "controller_s": round(cut.controller_s, 6)}


def _run_as_json(run: AuditedRun) -> dict[str, Any]:
    return {
        "run": run.number,
        "begin_s": run.begin_s,
        "end_s": run.end_s,
        "complete": not (run.recorded.is_headless or run.recorded.is_open),
        "divergence": _finding(run, run.comparison.divergence),
        "differences": [_finding(run, finding) for finding in run.comparison.findings],
    }


def _finding(run: AuditedRun, finding: Finding | None) -> dict[str, Any] | None:
    if finding is None:
        return None
    return {
        "t": round(finding.t, 6),
        "line": finding.line,
        "what": finding.what,
        "cause": finding.cause,
        "controller_s": round(run.begin_s + finding.t, 6),
    }


def _details(run: AuditedRun) -> dict[str, Any]:
    found = run.comparison
    return {
        "errors": {
            "joints": _largest(found.joints),
            "path": _largest(found.path),
            "measured_joints": _largest(found.measured),
        },
        "lines": [
            {
                "line": its.line,
                "recorded_s": round(its.recorded_s, 6),
                "simulated_s": round(its.simulated_s, 6),
                "recorded_passes": its.recorded_passes,
                "simulated_passes": its.simulated_passes,
                "slowed_s": round(its.slowed_s, 6),
                "cause": its.cause,
            }
            for its in found.lines
        ],
        "signals": [
            {
                "t": round(its.t, 6),
                "line": its.line,
                "name": its.name,
                "value": plain(its.value),
                "only_in": "recording" if its.is_recorded else "simulation",
            }
            for its in found.signals
        ],
        "inputs": [{"t": round(its.t, 6), "what": its.text} for its in run.inputs.arrivals],
        "recorded_s": round(run.recorded.t[-1], 6),
        "simulated_s": round(found.simulated_s, 6),
    }


def _largest(error: Largest | None) -> dict[str, Any] | None:
    return None if error is None or not isfinite(error.rms) else {**error._asdict(), "t": round(error.t, 6)}


# ---------------------------------------------------------------- words


def _head(audit: AuditFindings) -> Iterator[str]:
    rows, run = len(audit.recording.t), audit.first
    lost = f", {audit.lost} lost" if audit.lost else ""
    runs = "" if audit.runs_in_all == 1 else f", {audit.runs_in_all} runs"
    yield f"{audit.cell.source.name}: {run.recorded.t[-1]:.3f} s of {audit.model.name}, {rows} rows{lost}{runs}"
    where = "" if audit.runs_in_all == 1 else f"run {run.number}, "
    yield from audit.not_taken
    if audit.taken:
        yield f"with {' and '.join(audit.taken)} of the recording"
    yield from _cuts(audit)
    so_far = "" if audit.is_complete else " as far as it is recorded"
    if (finding := audit.divergence) is not None:
        yield f"differs from {finding.t:.3f} s on, {where}{audit.cell.source.line_words(finding.line)}: {finding.what}"
    elif audit.agrees:
        yield f"agrees{so_far}: target joints, times and signals"
    else:
        yield f"target joints, times and signals agree{so_far}, the arm does not:"


def _cuts(audit: AuditFindings) -> Iterator[str]:
    """Say where the recording begins or ends within a run, and what is not compared so."""
    words = audit.cell.source.line_words
    for run in audit.runs:
        series, of_run = run.recorded, "" if audit.runs_in_all == 1 else f" of run {run.number}"
        if series.is_headless:
            where = f", in {words(series.lines[0])}" if series.lines[0] else ""
            begin = f"the program{of_run} ran already when the recording began{where}"
            yield f"{begin}: what was before is not compared"
        if series.is_open:
            where = f", in {words(series.lines[-1])}" if series.lines[-1] else ""
            end = f"the recording ends at {series.t[-1]:.3f} s{where}, before the program{of_run} does"
            yield f"{end}: nothing from there on is compared"
    if audit.recording.is_cut_off:
        why = "its recorder was killed, or the file has lost its end"
        yield f"the file of the recording is cut off: {why}; what came behind its last row is not compared"


def _arm(audit: AuditFindings) -> Iterator[str]:
    for its in audit.arm[:SHOWN]:
        factor, unit = (1000.0, "mm") if its.unit == "m" else (1.0, its.unit)
        yield f"  {its.name}: {its.recorded * factor:.7g} {unit}, model {its.model * factor:.7g} {unit}"
    yield from _left_out(audit.arm[SHOWN:], "number of the arm", "numbers of the arm")


def _run(run: AuditedRun, words: Callable[[int], str]) -> Iterator[str]:
    found = run.comparison
    kinds: dict[tuple[int, str], list[Finding]] = {}
    for finding in found.findings:
        kinds.setdefault((finding.line, finding.cause), []).append(finding)
    further = list(kinds.values())
    for number, alike in enumerate(further[:SHOWN]):
        first, more = alike[0], f", {len(alike) - 1} times more" if len(alike) > 1 else ""
        if number:
            yield f"  then {first.t:.3f} s, {words(first.line)}: {first.what}{more}"
        elif more:
            yield f"  the same in this line {len(alike) - 1} times more, up to {alike[-1].t:.3f} s"
    yield from _left_out(further[SHOWN:], "further difference", "further differences")
    for name, error, factor, unit in (
        ("joints along the path", found.joints, 1.0, "rad"),
        ("TCP along the path", found.path, 1000.0, "mm"),
        ("measured joints", found.measured, 1.0, "rad"),
    ):
        if error is not None:
            yield (
                f"{name:<22} rms {factor * error.rms:.3g} {unit}, largest {factor * error.largest:.3g} {unit}"
                + (f" at {error.t:.3f} s, {words(error.line)}" if error.largest else "")
            )
    yield from _lines(run)
    for its in found.signals[:SHOWN]:
        only = "recording" if its.is_recorded else "simulated run"
        yield f"signal {its.name} {_level(its.value)} at {its.t:.3f} s, {words(its.line)}: in the {only} only"
    yield from _left_out(found.signals[SHOWN:], "further edge", "further edges")
    if not found.signals and found.compared_signals:
        yield f"signals                the edges of {found.compared_signals} come in the same order"
    if run.inputs.arrivals:
        texts = Counter(arrival.text for arrival in run.inputs.arrivals)
        shown = [f"{text} ({count} times)" if count > 1 else text for text, count in texts.most_common(4)]
        more = f", and {len(texts) - 4} more" if len(texts) > 4 else ""
        yield f"inputs from outside    {', '.join(shown)}{more}"
    if run.inputs.speed is not None and run.inputs.speed < 1.0:
        yield f"speed slider           {run.inputs.speed:.0%} at the start, in the simulated run too"


def _lines(run: AuditedRun) -> Iterator[str]:
    times = [its for its in run.comparison.lines if its.cause or abs(its.recorded_s - its.simulated_s) > 0.05]
    recorded_s, simulated_s = run.recorded.t[-1], run.comparison.simulated_s
    yield f"time                   {recorded_s:.3f} s recorded, {simulated_s:.3f} s simulated"
    if times:
        yield "  line   recorded  simulated  difference  passes  cause"
        for its in times[:SHOWN]:
            passes = str(its.recorded_passes)
            if its.simulated_passes != its.recorded_passes:
                passes += f":{its.simulated_passes}"
            slow = f" ({its.slowed_s:.2f} s)" if its.cause in ("slider", "speed scaling") else ""
            yield (
                f"  {its.line:4}  {its.recorded_s:7.3f} s  {its.simulated_s:7.3f} s  "
                f"{its.recorded_s - its.simulated_s:+8.3f} s  {passes:>6}  {its.cause}{slow}"
            )
        yield from _left_out(times[SHOWN:], "further line", "further lines")


def _others(audit: AuditFindings) -> Iterator[str]:
    words = audit.cell.source.line_words
    for run in audit.runs:
        if run is not audit.first:
            finding = run.comparison.divergence
            what = "agrees" if finding is None else f"{finding.t:.3f} s, {words(finding.line)}: {finding.what}"
            yield f"run {run.number} at {run.begin_s:.3f} s: {what}"


def _fit(audit: AuditFindings) -> Iterator[str]:
    if audit.fit is not None:
        from elitescript.audit.fit.words import table

        yield from table(audit.fit.parameters)
        yield from audit.fit.words


def _rest(audit: AuditFindings) -> Iterator[str]:
    notes = [*dict.fromkeys((*audit.first.comparison.notes, *audit.not_compared))]
    if notes:
        yield "not compared:"
        for note in notes[:SHOWN]:
            yield f"  {note}"
        yield from _left_out(notes[SHOWN:], "further one", "further ones")


def _found(audit: AuditFindings) -> Iterator[str]:
    """Say what was found in the simulated program and its run; last of all the verdict."""
    found = [finding for finding in findings_of(audit) if finding.source != SOURCE]
    if found:
        yield "found in the simulated program and its run:"
        for finding in found[:SHOWN]:
            yield f"  {finding}"
        yield from _left_out(found[SHOWN:], "further finding", "further findings")
    yield f"verdict: {verdict_of(audit)}"


def _left_out(rest: Any, one: str, many: str) -> Iterator[str]:
    if rest:
        yield f"  and {len(rest)} {one if len(rest) == 1 else many} (--json has all)"


def _level(value: Value) -> str:
    return ("off", "on")[value] if isinstance(value, bool) else f"{value:g}"
