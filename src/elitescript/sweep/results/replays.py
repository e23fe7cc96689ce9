"""Writes the page of a sweep and, in a folder beside it, pages of single runs: failing, and nearest to failing."""

from __future__ import annotations

import os
import shlex
from collections.abc import Callable, Sequence
from typing import Final
from urllib.parse import quote

from elitescript.outputs.writing import Output, write_file
from elitescript.plotting.page import page as page_of_run
from elitescript.plotting.recorder import RunRecorder
from elitescript.plotting.sampling import Sampling
from elitescript.robot import VirtualRobot
from elitescript.sweep.failures.findings import Finding
from elitescript.sweep.plans.plan import LOST, Choices, Row
from elitescript.sweep.plans.trees import source_of_plan
from elitescript.sweep.results.page import REPLAYS, PageTexts, Replay, sweep_page
from elitescript.sweep.results.summary import Summary
from elitescript.sweep.results.totals import Totals
from elitescript.sweep.single import Runner

REPLAYS_MAX: Final = 12
"""Runs that get a page of their own, besides the smallest ones that fail: a page has 0.6 MB."""

OF_KIND: Final = 3
"""Of each kind of failure, at most."""


def write_pages(
    output: Output,
    runner: Runner,
    totals: Totals,
    summary: Summary,
    findings: Sequence[Finding],
    command: str,
    note: Callable[[str], None],
) -> int:
    """Write the page of a sweep, and its replays into `NAME.replays` beside it; return its size in bytes.

    Args:
        output: file of the page.
        runner: of the plan.
        totals: of all rows.
        summary: of them.
        findings: failures that were made smaller.
        command: line of the sweep.
        note: shows what is done.

    Raises:
        UsageError: the front end is not built.
        OSError: a file cannot be written.
    """
    target = output.path
    folder = target.with_name(target.stem + REPLAYS)
    name = runner.plan.program_name
    replays: dict[int, Replay] = {}
    smallest: dict[int, Replay] = {}
    stories: dict[int, Sequence[str]] = {}

    def written(choices: Choices, file: str, title: str) -> str:
        note(f"page of {title}")
        text = replay_of(runner, choices, f"{name}, {title}")
        if not text:
            return ""
        folder.mkdir(exist_ok=True)
        write_file(folder / file, text, f"{output.called}: {folder / file}")
        return f"{quote(os.fsencode(folder.name))}/{file}"

    for finding in findings:
        run = finding.first.choices.run
        if finding.story is not None:
            stories[run] = finding.story.lines
        case = f"elitescript run --case {shlex.quote(str(finding.case))}"
        page = ""
        if finding.first.state not in LOST:
            page = written(finding.choices, f"run-{run}-smallest.html", f"run {run} made smaller")
        smallest[run] = Replay(page, case)
    for row in _rows_of(totals):
        run = row.choices.run
        replays[run] = Replay(written(row.choices, f"run-{run}.html", f"run {run}"))
    texts = PageTexts(
        f"{name}: sweep",
        command,
        f"{command} --only {{run}} --page run-{{run}}.html" if command else "",
        stories,
        replays,
        smallest,
    )
    text = sweep_page(runner.plan, totals, summary, texts)
    output.finish(text)
    return len(text)


def replay_of(runner: Runner, choices: Choices, title: str) -> str:
    """Return the page of one run; empty if it cannot begin."""
    sampling = Sampling()
    recorders: list[RunRecorder] = []
    robots: list[VirtualRobot] = []

    def begin(robot: VirtualRobot) -> None:
        robots.append(robot)
        recorders.append(RunRecorder(robot, sampling))

    _, run = runner.play(choices, before=begin, trace=sampling, watch=lambda robot: recorders[0].watch(robot))
    if run is None:
        return ""
    source = source_of_plan(runner.plan)
    return page_of_run(recorders[0].recording(title, robots[0], source, run, runner.problems))


def _rows_of(totals: Totals) -> list[Row]:
    """Return the rows that get a page: first failures of each kind in turn, and those that were nearest to failing."""
    groups = [[row for row in group.rows if row.state not in LOST] for group in totals.groups.values()]
    nearest = [row for row in totals.nearest_rows if row is not None]
    chosen = {row.choices.run: row for row in nearest[: REPLAYS_MAX // 3]}
    for place in range(OF_KIND):
        for rows in groups:
            if place < len(rows) and len(chosen) < REPLAYS_MAX:
                chosen.setdefault(rows[place].choices.run, rows[place])
    return [chosen[run] for run in sorted(chosen)]
