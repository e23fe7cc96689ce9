"""What the log says of a client's recipes: unknown names, claimed inputs, and levels without their mask.

The client gets one word for a name and nothing else, and values without effect are answered by nothing at all.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from elitescript.protocol.lines import shown
from elitescript.protocol.rtsi.inputs import EFFECTS, INPUTS
from elitescript.protocol.rtsi.variables import OUTPUTS

NAMES_MAX: Final = 5
"""Names that a line shows; further ones are counted."""

RELATED: Final = {
    "actual_q": "actual_joint_positions",
    "actual_qd": "actual_joint_speeds",
    "target_q": "target_joint_positions",
    "target_qd": "target_joint_speeds",
    "actual_main_voltage": "actual_robot_voltage",
    "payload": "payload_mass",
    "tool_temperature0": "tool_temperature",
}
"""Names of a related interface that clients are ported from, and what they are called here."""


def unknown_names(names: Iterable[str], *, is_input: bool) -> str:
    """Return what is wrong with the unknown names of a recipe, with the nearest known name of each."""
    known, other = (INPUTS, OUTPUTS) if is_input else (OUTPUTS, INPUTS)
    unknown = [name for name in dict.fromkeys(names) if name not in known]
    what = "input" if is_input else "output"
    found = [f"{_quoted(name)}{_meant(name, known, other, is_input=is_input)}" for name in unknown[:NAMES_MAX]]
    if more := len(unknown) - NAMES_MAX:
        found += [f"{more} more"] if more > 0 else []
    return f"a recipe is refused, since there is no RTSI {what} {', '.join(found)}"


def claimed_names(owners: Iterable[tuple[str, str]]) -> str:
    """Return which client has which inputs of a refused recipe, from pairs of input and client."""
    pairs = list(owners)
    found = [f"{name} belongs to {owner}" for name, owner in pairs[:NAMES_MAX]]
    if len(pairs) > NAMES_MAX:
        found.append(f"{len(pairs) - NAMES_MAX} more belong to others")
    return f"a recipe is refused: {', '.join(found)}, until that client closes"


def without_effect(names: Iterable[str], recipes: Iterable[Iterable[str]]) -> list[str]:
    """Return what a client sends in vain: variables whose effect needs others that no recipe of the client has.

    Args:
        names: of the recipe of a package.
        recipes: names of all input recipes of the client, this one included.
    """
    held = {name for recipe in recipes for name in recipe}
    texts: list[str] = []
    for name in dict.fromkeys(names):
        effects = [effect.variables for effect in EFFECTS if name in effect.variables]
        missing = [[other for other in variables if other not in held] for variables in effects]
        if missing and all(missing):
            verb = "is" if len(missing[0]) == 1 else "are"
            texts.append(f"{name} has no effect: {' and '.join(missing[0])} {verb} in none of the client's recipes")
    return texts


def _meant(name: str, known: Iterable[str], other: Iterable[str], *, is_input: bool) -> str:
    if name in other:
        return f" (that is an {'output' if is_input else 'input'})"
    family = name.rstrip("0123456789")
    if family != name and (indices := [int(row[len(family) :]) for row in known if _is_of(row, family)]):
        return f" (they go from {min(indices)} to {max(indices)})"
    near = RELATED.get(name, "")
    if near not in known:
        from difflib import get_close_matches

        # Comparisons take time, and clients send what they like: a name of quite another length is no match.
        possible = [row for row in known if abs(len(row) - len(name)) <= 2 + len(name) // 4]
        matches = get_close_matches(name, possible, n=1, cutoff=0.6)
        near = matches[0] if matches else ""
    return f" (is {near} meant?)" if near else ""


def _is_of(name: str, family: str) -> bool:
    return name.startswith(family) and name[len(family) :].isdecimal()


def _quoted(name: str) -> str:
    return f"`{shown(name)}`"
