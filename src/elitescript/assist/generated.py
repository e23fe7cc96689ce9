"""Texts that were generated from a graphical program: the tree is their source, so they are not edited."""

from __future__ import annotations

from pathlib import PurePath

from elitescript.paths import PROGRAM_SUFFIX, TASK_SUFFIX

GENERATED_SUFFIX = f"{TASK_SUFFIX}{PROGRAM_SUFFIX}"
"""Of the name of a script that a pendant, or a tool, has generated from a task and put beside it."""


def task_of(name: str) -> str:
    """Return the name of the task from which a text was generated, by its own name; empty: it was not."""
    return name[: -len(PROGRAM_SUFFIX)] if name.lower().endswith(GENERATED_SUFFIX) else ""


def refusal(task: str) -> str:
    """Return why a text that was generated from a task is not edited."""
    return f"this text is generated from {PurePath(task).name}: the tree is the source, so change it there"
