"""Compares what came of a program on the robot and on CPython, and names the cause of a difference."""

from __future__ import annotations

import re
from enum import StrEnum
from typing import Final, NamedTuple

from tests.foreign.running import Outcome


class Cause(StrEnum):
    """How a test came out; `IS_DIFFERENT` has those that need a reason."""

    SAME = "same, passed"
    ALIKE = "same, otherwise"
    UNSLICED = "no program"
    REFUSED = "refused before the run"
    POLICY = "refused in the run"
    TEXTS = "`exec` and `compile`"
    VARIES = "varies in CPython"
    WORDING = "wording"
    VALUE = "value"
    SYNTAX = "syntax"
    STUCK = "no end"
    OURS = "mistake of ours"


IS_DIFFERENT: Final = frozenset((Cause.WORDING, Cause.VALUE, Cause.SYNTAX, Cause.STUCK, Cause.OURS))


class Verdict(NamedTuple):
    """The cause, and what shows it."""

    cause: Cause
    text: str = ""


_PLACE: Final = re.compile(r"(?: at)? 0x[0-9a-fA-F]+")
_POLICY: Final = re.compile(
    r"not available|of the robot has no|is not (?:allowed|possible)|belongs? to Python|programs cannot|to programs"
)
_TEXTS: Final = re.compile(
    r"name '(?:compile|exec|globals|locals|vars|__import__|open|input|breakpoint)' is not defined"
)


def plain(text: str) -> str:
    """Return a text without addresses."""
    return _PLACE.sub("", text)


def compare(python: Outcome, robot: Outcome) -> Verdict:
    """Return how a program came out on the robot, beside CPython."""
    if robot.end in ("internal", "crash"):
        return Verdict(Cause.OURS, f"{robot.kind}: {robot.text}")
    if robot.end in ("late", "stuck"):
        is_same = python.end in ("late", "stuck")
        return Verdict(Cause.ALIKE if is_same else Cause.STUCK, f"{robot.end}: {robot.text[:200]}")
    if robot.end == "refused":
        if robot.kind == "E115":
            return Verdict(Cause.REFUSED, robot.text)
        return Verdict(Cause.ALIKE if python.end == "refused" else Cause.SYNTAX, f"{robot.kind}: {robot.text}")
    difference, is_wording = _first_difference(python.notes, robot.notes)
    is_policy = robot.end in ("error", "failed") and _cause_of_refusal(robot)
    if difference and not is_wording:
        return Verdict(Cause.VALUE, difference)
    if is_policy and (python.end, python.kind) != (robot.end, robot.kind):
        return Verdict(is_policy, f"{robot.kind}: {robot.text}")
    if (python.end, python.kind) != (robot.end, robot.kind) or len(python.notes) != len(robot.notes):
        return Verdict(Cause.VALUE, f"{_shown(python)} <> {_shown(robot)}")
    if difference:
        return Verdict(Cause.WORDING, difference)
    if plain(python.text) != plain(robot.text):
        return Verdict(Cause.WORDING, f"{_shown(python)} <> {_shown(robot)}")
    if python.line != robot.line:
        return Verdict(Cause.VALUE, f"line {python.line} <> line {robot.line}: {_shown(robot)}")
    return Verdict(Cause.SAME if robot.end == "passed" else Cause.ALIKE, _shown(robot))


def _cause_of_refusal(robot: Outcome) -> Cause | None:
    if _TEXTS.search(robot.text):
        return Cause.TEXTS
    if robot.kind == "ScriptPermissionError" or _POLICY.search(robot.text):
        return Cause.POLICY
    return None


def _shown(outcome: Outcome) -> str:
    return f"{outcome.end} {outcome.kind}: {outcome.text[:200]}".rstrip(": ") + (
        f" (line {outcome.line}, {len(outcome.notes)} notes)" if outcome.line else f" ({len(outcome.notes)} notes)"
    )


def _first_difference(python: list[list[str]], robot: list[list[str]]) -> tuple[str, bool]:
    """Return the first operands that differ, values before wording; and whether wording alone differs."""
    wording = ""
    for number, (left, right) in enumerate(zip(python, robot, strict=False), 1):
        if list(map(plain, left)) == list(map(plain, right)):
            continue
        text = f"assertion {number}: {' '.join(left)[:300]} <> {' '.join(right)[:300]}"
        if left[0] != "message" or right[0] != "message":
            return text, False
        wording = wording or text
    return wording, bool(wording)
