"""The warnings about the programs of a test, for `--script-strict`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from elitescript.language.options import Options
from elitescript.lint.engine import compile_checked
from elitescript.pytest_plugin.script_program import RETURNED
from elitescript.pytest_plugin.watching import WatchedRun

NOTHING_RUNS: Final = "W214"


def warnings_of(watched: Iterable[WatchedRun]) -> list[str]:
    """Return what `check` finds in the programs of these runs, and what the runs have warned about; each once."""
    found: dict[str, None] = {}
    for watch in watched:
        unit = watch.unit
        options = Options(strict=watch.is_strict, kind=unit.kind)
        checked = compile_checked(unit.source, watch.profile, options, presets=watch.presets, arm=watch.model)
        problems = [*checked.problems, *unit.diagnostics]
        if RETURNED in unit.global_names:
            # Nothing in a file of tests calls them.
            problems = [problem for problem in problems if problem.code != NOTHING_RUNS]
        known = set(map(str, problems))
        for problem in problems:
            found[f"{unit.source.name}: {problem}"] = None
        for text in watch.warnings:
            if text not in known:
                found[f"{unit.source.name}: {text}"] = None
    return list(found)
