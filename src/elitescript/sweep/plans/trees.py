"""What a plan knows of the tree of a graphical program: the node of each line of its script, its variables, its arm."""

from __future__ import annotations

from typing import Any, Final

from elitescript.errors import CODES, UsageError, did_you_mean
from elitescript.language.diagnostics import diagnostic
from elitescript.language.text.source import SourceFile, TreeFacts
from elitescript.sweep.plans.plan import Plan

TASK: Final = "task."
INSTALLATION: Final = "installation."
PREFIXES: Final = (TASK, INSTALLATION)
"""Before the name of a variable that is varied: whose it is."""

_SHOWN: Final = 12


def tree_data(source: SourceFile) -> dict[str, Any]:
    """Return what is known of the tree of a script, as JSON has it; nothing for a script that was written by hand."""
    if source.tree is None:
        return {}
    rows: list[list[Any]] = []
    for place in source.places:
        if rows and rows[-1][0] == place:
            rows[-1][1] += 1
        else:
            rows.append([place, 1])
    return {
        "places": rows,
        "notes": [[note.code, note.line, str(note.text), str(note.hint)] for note in source.notes],
        "arm": source.tree.arm,
        "unset": list(source.tree.unset),
        "installation": [list(pair) for pair in source.tree.installation],
        "task": [list(pair) for pair in source.tree.task],
    }


def tree_of(data: Any, place: str) -> dict[str, Any]:
    """Return such data, checked.

    Raises:
        UsageError: it is something else; the text begins with `place`.
    """
    shapes = {"places": (str, int), "notes": (str, int, str, str), "installation": (str, str), "task": (str, str)}
    if data == {}:
        return {}
    is_whole = (
        isinstance(data, dict)
        and set(data) == {*shapes, "arm", "unset"}
        and isinstance(data["arm"], str)
        and isinstance(data["unset"], list)
        and all(isinstance(name, str) for name in data["unset"])
        and all(isinstance(data[name], list) for name in shapes)
        and all(
            isinstance(row, list) and tuple(map(type, row)) == shape
            for name, shape in shapes.items()
            for row in data[name]
        )
        and all(row[0] in CODES for row in data["notes"])
        and sum(row[1] for row in data["places"]) <= _LINES_MAX
    )
    if not is_whole:
        raise UsageError(f"{place}: this is no tree")
    return dict(data)


_LINES_MAX: Final = 10**7


def source_of_plan(plan: Plan) -> SourceFile:
    """Return the program of a plan, with the node of each line if it has a tree."""
    if not plan.tree:
        return SourceFile(plan.program_name, plan.program)
    given = plan.tree
    tree = TreeFacts(given["arm"], tuple(given["unset"]), _pairs(given["installation"]), _pairs(given["task"]))
    places = tuple(place for place, count in given["places"] for _ in range(count))
    notes = tuple(diagnostic(code, line, 1, text, hint=hint) for code, line, text, hint in given["notes"])
    return SourceFile(plan.program_name, plan.program, places, notes, tree)


def _pairs(rows: list[list[str]]) -> tuple[tuple[str, str], ...]:
    return tuple((name, known) for name, known in rows)


def name_in_script(text: str, source: SourceFile) -> str:
    """Return a varied variable of a graphical program as its script calls it, with the index that it may have.

    Args:
        text: `task.NAME` or `installation.NAME`, perhaps with indices.
        source: the script.

    Raises:
        UsageError: there is no such variable; the text lists them.
    """
    prefix = next(prefix for prefix in PREFIXES if text.startswith(prefix))
    name, bracket, index = text.removeprefix(prefix).partition("[")
    if source.tree is None:
        raise UsageError(f"--vary {text}: the program is no graphical program (.task), which alone has a {prefix[:-1]}")
    known = dict(source.tree.task if prefix == TASK else source.tree.installation)
    if name not in known:
        owner = "task" if prefix == TASK else "installation"
        other = dict(source.tree.installation if prefix == TASK else source.tree.task)
        if name in other:
            there = f"; is {INSTALLATION if prefix == TASK else TASK}{name} meant?"
        else:
            there = did_you_mean(name, known)
        names = list(known)
        listed = f"it has {', '.join(names[:_SHOWN])}{', ...' if len(names) > _SHOWN else ''}"
        raise UsageError(
            f"--vary {text}: the {owner} has no variable {name}{there}; {listed if names else 'it has none'}"
        )
    return f"{known[name]}{bracket}{index}"
