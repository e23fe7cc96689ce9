"""The warnings about the programs of a test, for `--script-strict`."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.language.options import Options
from elitescript.lint.engine import compile_checked
from elitescript.pytest_plugin.watching import WatchedRun


def warnings_of(watched: Iterable[WatchedRun]) -> list[str]:
    """Return what `check` finds in the programs of these runs, and what the runs have warned about; each once."""
    found: dict[str, None] = {}
    for watch in watched:
        unit = watch.run.unit
        options = Options(strict=watch.is_strict, kind=unit.kind)
        checked = compile_checked(unit.source, watch.profile, options, presets=watch.presets, arm=watch.model)
        known = {str(problem) for problem in (*checked.problems, *unit.diagnostics)}
        for problem in (*checked.problems, *unit.diagnostics):
            found[f"{unit.source.name}: {problem}"] = None
        for text in watch.run.warnings:
            if text not in known:
                found[f"{unit.source.name}: {text}"] = None
    return list(found)
