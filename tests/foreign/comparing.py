"""Compares what came of a program on the robot and on CPython, and names the cause of a difference."""

from __future__ import annotations

import re
from dataclasses import replace
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
    r"not available|of the robot has no|the robot's \w+ does not have|is not (?:allowed|possible)|belongs? to Python"
    r"|programs cannot|to programs|the module '\w+' cannot be changed|\btype\(\) takes one object"
    r"|has no terminal to read"
)
_TEXTS: Final = re.compile(
    r"name '(?:compile|globals|locals|vars)' is not defined|\b(?:eval|exec)\(\) takes|nested too deeply to be compiled"
)


def plain(text: str) -> str:
    """Return a text without addresses."""
    return _PLACE.sub("", text)


def without(outcome: Outcome, varying: frozenset[int]) -> Outcome:
    """Return an outcome without the operands of some assertions."""
    notes = [["varies"] if place in varying else note for place, note in enumerate(outcome.notes)]
    return replace(outcome, notes=notes)


def settle(python: Outcome, robot: Outcome, fresh: Outcome) -> Verdict:
    """Return how a program came out, once what CPython itself gives otherwise in another process is left out."""
    if len(fresh.notes) != len(python.notes) or (fresh.end, fresh.kind) != (python.end, python.kind):
        return Verdict(Cause.VARIES, "CPython ends otherwise in another process")
    pairs = enumerate(zip(python.notes, fresh.notes, strict=True))
    varying = frozenset(place for place, (left, right) in pairs if list(map(plain, left)) != list(map(plain, right)))
    verdict = compare(without(python, varying), without(robot, varying))
    # What a test fails with where it depends on time may be more or less than its bound elsewhere.
    is_about_end = verdict.cause == Cause.WORDING or (verdict.cause == Cause.VALUE and python.end != robot.end)
    if is_about_end and python.text != fresh.text:
        return Verdict(Cause.VARIES, verdict.text)
    return verdict if verdict.cause in IS_DIFFERENT else Verdict(Cause.VARIES, verdict.text)


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
    if is_policy and (python.end, python.kind, python.text) != (robot.end, robot.kind, robot.text):
        return Verdict(is_policy, f"{robot.kind}: {robot.text}")
    if robot.end == "skipped" and python.end != "skipped":
        return Verdict(Cause.POLICY, "the test skips itself, as something that it asks for is not there")
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
