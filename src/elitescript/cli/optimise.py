"""`elitescript sweep --minimise`: looks for the best values, and says what they are worth."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import Any, Final

from elitescript.cli.output.screen import palette_of, progress_on, rendered
from elitescript.environment.stop_signals import cause_of, exit_code_of
from elitescript.errors import ProgramError, UsageError
from elitescript.shown import shown
from elitescript.sweep.chaos.properties import properties_of
from elitescript.sweep.engines.engine import Engine
from elitescript.sweep.optimise import Candidate, Change, Outcome, Search, check_search, optimise
from elitescript.sweep.plans.plan import Plan
from elitescript.sweep.plans.program_values import constant_lines
from elitescript.sweep.plans.trees import PREFIXES, source_of_plan
from elitescript.sweep.plans.variations import parse_variation
from elitescript.sweep.results.table_files import TableFiles
from elitescript.sweep.results.tables import json_line, output_of, write_table

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

FOUND: Final = 0
NONE_HOLDS: Final = 1
DOES_NOT_COMPILE: Final = 3

RUNS: Final = 100
"""Default of --runs."""


def searches(options: argparse.Namespace) -> bool:
    """Return whether values are to be looked for.

    Raises:
        UsageError: options that do not go together.
    """
    asked = [name for name in ("minimise", "maximise") if getattr(options, name) is not None]
    if len(asked) == 2:
        raise UsageError("--minimise and --maximise: name one measure only, such as 'time_s + 2 * max_of(tcp_speed)'")
    if asked:
        if options.resume:
            raise UsageError(f"--resume: a search is not gone on with; --{asked[0]} begins anew and finds the same")
        for name in ("page", "only"):
            if getattr(options, name) is not None:
                raise UsageError(f"--{name} is of a sweep, and does not go with --{asked[0]}")
        return True
    for name in ("over", "worst"):
        if getattr(options, name):
            raise UsageError(f"--{name} goes with --minimise or --maximise")
    if options.repeat != 1:
        raise UsageError("--repeat goes with --minimise or --maximise; of a sweep, --runs is the number of runs")
    return False


def search_values(options: argparse.Namespace, plan: Plan, engine: Engine, files: TableFiles | None) -> int:
    """Look for the values of the command line; return the exit code."""
    search = Search(
        plan,
        tuple(parse_variation(text, "--over") for text in options.over),
        options.minimise if options.maximise is None else options.maximise,
        is_maximum=options.maximise is not None,
        runs=RUNS if options.runs is None else options.runs,
        repeats=options.repeat,
        is_worst=options.worst,
    )
    try:
        problems = check_search(search)
    except ProgramError as error:
        _print_problems(error.problems, plan)
        return DOES_NOT_COMPILE
    if not options.json:
        _print_problems(problems, plan)
    meter = _Meter(search, options.json)
    output = None if files is None else output_of(files.table)
    try:
        with engine:
            outcome = optimise(search, engine, on_candidate=meter.note)
    except BaseException as stop:
        if output is not None:
            output.drop()
        if not isinstance(stop, KeyboardInterrupt):
            raise
        done = f"ended by {cause_of(stop)} after {meter.done} candidates; {meter.shown()}"
        print(f"elitescript sweep: {done}", file=sys.stderr)
        return exit_code_of(stop)
    if files is not None and output is not None:
        files.forget()
        write_table(output, search.table_plan, (row for candidate in outcome.candidates for row in candidate.rows))
    if options.json:
        data = outcome_data(outcome)
        print(json_line(data, data.values()))
    else:
        print(*map(shown, report(outcome, options.file)), sep="\n")
    return NONE_HOLDS if outcome.best is None else FOUND


class _Meter:
    """Shows how far a search is.

    Attributes:
        done: number of candidates.
    """

    def __init__(self, search: Search, is_json: bool) -> None:
        self.done = 0
        self._search = search
        self._best: Candidate | None = None
        self._is_json = is_json
        self._progress = None if is_json else progress_on(sys.stderr)

    def note(self, candidate: Candidate) -> None:
        """Show a candidate."""
        self.done += 1
        self._best = self._search.better(self._best, candidate)
        if self._is_json:
            data = {"type": "candidate", **candidate_data(candidate)}
            print(json_line(data, data.values()), flush=True)
        if self._progress is not None:
            self._progress.note(f"{self.done} of {self._search.candidates} candidates, {self.shown()}")

    def shown(self) -> str:
        """Return the best so far."""
        if self._best is None:
            return "none holds so far"
        return f"best {shown_value(self._best.objective)} with {_values(self._best.values)}"


# ---------------------------------------------------------------- words


def report(outcome: Outcome, file: str) -> list[str]:
    """Return the lines that say what was found."""
    search, plain, best = outcome.search, outcome.plain, outcome.best
    word = "largest" if search.is_maximum else "smallest"
    each = f", {search.repeats} runs of each: {'the worst' if search.is_worst else 'the mean'} counts"
    lines = [
        f"{search.objective}, {word} of {len(outcome.candidates)} candidates{each if search.repeats > 1 else ''}",
        f"  as it is  {_judgement(plain)}",
    ]
    if best is None:
        lines.append("  no candidate holds")
        nearest = _commonest(candidate.failed for candidate in outcome.candidates)
        lines.append(f"  most often: {nearest}")
        return lines
    lines.append(f"  best      {_judgement(best)}{_gain(plain, best)}, candidate {best.number}")
    lines += [f"    {name} = {shown_value(value)}" for name, value in best.values.items()]
    for text, margin in zip(properties_of(search.plan), best.margins, strict=False):
        lines.append(f"    holds: {text}{'' if margin is None else f', margin {shown_value(margin)}'}")
    lines += ["", "what each value does alone, from the best:"]
    lines += [line for change in outcome.changes for line in _change_lines(change, best, search)]
    lines += ["", "to use it:", *_use_lines(search, best, file)]
    return lines


def _judgement(candidate: Candidate) -> str:
    if not candidate.failed:
        return shown_value(candidate.objective)
    reason = f"fails: {candidate.failed}"
    return reason if candidate.objective is None else f"{shown_value(candidate.objective)}, but {reason}"


def _gain(plain: Candidate, best: Candidate) -> str:
    before, after = plain.objective, best.objective
    if before is None or after is None or plain.failed or not before:
        return ""
    share = 100 * (after - before) / abs(before)
    return f" ({shown_value(before)} -> {shown_value(after)}, {share:+.1f} %)"


def _change_lines(change: Change, best: Candidate, search: Search) -> list[str]:
    name, value = change.name, best.values[change.name]
    lines = []
    changed = [*((side,) if (side := change.low) else ()), *((side,) if (side := change.high) else ()), *change.others]
    for candidate in changed:
        lines.append(f"  {name} = {shown_value(candidate.values[name])}: {_against(best, candidate)}")
    variation = next(row for row in search.over if row.name == name)
    if changed and all(one.rows_digest == best.rows_digest for one in changed):
        values = ", ".join(shown_value(one.values[name]) for one in changed)
        return [f"  {name} = {values}: the same in every digit; something else is the limit, or {name} is not used"]
    if variation.kind != "choice" and value in variation.arguments[:2]:
        lines.append(f"  {name} = {shown_value(value)} is an end of its range: beyond it may be better")
    return lines


def _against(best: Candidate, candidate: Candidate) -> str:
    if candidate.failed:
        return f"fails: {candidate.failed}"
    assert best.objective is not None
    assert candidate.objective is not None
    return f"{shown_value(candidate.objective)} ({candidate.objective - best.objective:+.4g})"


def _use_lines(search: Search, best: Candidate, file: str) -> list[str]:
    settings: list[str] = []
    lines: list[str] = []
    constants = constant_lines(search.plan.program, [row.name for row in search.over])
    for name, value in best.values.items():
        if name.startswith(PREFIXES):
            lines.append(f"  in {file}: {name} = {shown_value(value)}")
        elif "." in name:
            lines.append(f"  in the world file: {name} = {shown_value(value)}")
        elif name in constants:
            lines.append(f"  {file}:{constants[name]}: {name} = {shown_value(value)}")
        else:
            settings.append(f"--set '{name}={shown_value(value)}'")
    if settings:
        lines.append(f"  elitescript run {file} {' '.join(settings)}")
    return lines


def shown_value(value: Any) -> str:
    """Return a value as people write it."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _values(values: Any) -> str:
    return ", ".join(f"{name} = {shown_value(value)}" for name, value in values.items())


def _commonest(texts: Iterable[str]) -> str:
    every = list(texts)
    return max(dict.fromkeys(every), key=every.count)


def _print_problems(problems: Iterable[Any], plan: Plan) -> None:
    source = source_of_plan(plan)
    for problem in problems:
        print(rendered(problem, source, palette_of(sys.stderr)), file=sys.stderr)


# ---------------------------------------------------------------- JSON


def candidate_data(candidate: Candidate) -> dict[str, Any]:
    """Return a candidate as JSON has it."""
    return {
        "number": candidate.number,
        "values": dict(candidate.values),
        "objective": candidate.objective,
        "holds": candidate.holds,
        "failed": candidate.failed,
        "margins": list(candidate.margins),
    }


def outcome_data(outcome: Outcome) -> dict[str, Any]:
    """Return what was found as JSON has it."""
    return {
        "type": "summary",
        "objective": outcome.search.objective,
        "candidates": len(outcome.candidates),
        "baseline": candidate_data(outcome.plain),
        "best": None if outcome.best is None else candidate_data(outcome.best),
        "changes": {
            change.name: [candidate_data(one) for one in (change.low, change.high, *change.others) if one is not None]
            for change in outcome.changes
        },
    }
