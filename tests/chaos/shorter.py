"""Makes a session that breaks something as short as possible: fewer acts, fewer lines, plain options."""

from __future__ import annotations

from collections.abc import Callable

from elitescript.sweep.failures.shrinking import fewest
from tests.chaos.sessions import Session


def name_of(failure: str) -> str:
    """Return what failures of the same kind have in common: everything before the numbers of this one."""
    head, _, rest = failure.partition(": ")
    return f"{head}: {rest.partition(': ')[0]}" if rest else head


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
    return {**session, "acts": list(acts)}


def _with_fewest_lines(session: Session, breaks: Callable[[Session], bool]) -> Session:
    lines = session["program"].splitlines(keepends=True)
    lines = fewest(lines, lambda rows: breaks({**session, "program": "".join(rows)}))
    return {**session, "program": "".join(lines)}
