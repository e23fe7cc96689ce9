"""Makes a session that breaks something as short as possible: fewer acts, fewer lines, plain options."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from tests.chaos.sessions import Session


def name_of(failure: str) -> str:
    """Return what failures of the same kind have in common: everything before the numbers of this one."""
    head, _, rest = failure.partition(": ")
    return f"{head}: {rest.partition(': ')[0]}" if rest else head


def fewest(items: list[Any], fails: Callable[[list[Any]], bool]) -> list[Any]:
    """Return the fewest of some items, in their order, that still fail (ddmin, Zeller and Hildebrandt 2002)."""
    parts = 2
    while len(items) >= 1:
        step = -(-len(items) // parts)
        for at in range(0, len(items), step):
            rest = items[:at] + items[at + step :]
            if fails(rest):
                items, parts = rest, max(parts - 1, 2)
                break
        else:
            if step == 1:
                return items
            parts = min(2 * parts, len(items))
    return items


def shortest(session: Session, breaks: Callable[[Session], bool]) -> Session:
    """Return the shortest session that still breaks the same."""
    before: Session = {}
    while session != before:
        before = session
        session = _with_fewest_acts(session, breaks)
        session = _with_fewest_lines(session, breaks)
        for name in list(session["options"]):
            options = {key: value for key, value in session["options"].items() if key != name}
            if breaks({**session, "options": options}):
                session = {**session, "options": options}
    return session


def _with_fewest_acts(session: Session, breaks: Callable[[Session], bool]) -> Session:
    acts = fewest(session["acts"], lambda acts: breaks({**session, "acts": acts}))
    return {**session, "acts": acts}


def _with_fewest_lines(session: Session, breaks: Callable[[Session], bool]) -> Session:
    lines = session["program"].splitlines(keepends=True)
    lines = fewest(lines, lambda rows: breaks({**session, "program": "".join(rows)}))
    return {**session, "program": "".join(lines)}
