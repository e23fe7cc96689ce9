"""Sessions over short programs, for tests."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from elitescript.debugger.api import Output, Position, Stop
from elitescript.debugger.session import DebugSession
from elitescript.debugger.source import ProgramSource


@contextmanager
def debugging(
    text: str, outputs: list[Output] | None = None, *, forks: bool = False, **options: Any
) -> Iterator[DebugSession]:
    """A session over a text."""
    hear = None if outputs is None else outputs.append
    session = DebugSession(ProgramSource("job.script", text=text, **options), hear, forks=forks)
    try:
        yield session
    finally:
        session.close()


def at_entry(text: str) -> Any:
    """A session that stands at the entry."""

    @contextmanager
    def opened() -> Iterator[DebugSession]:
        with debugging(text) as session:
            session.start(stop_on_entry=True)
            yield session

    return opened()


def lines(stops: list[Stop]) -> list[int]:
    """The lines of stops."""
    return [stop.line for stop in stops]


def variables(session: DebugSession, thread: int = 1, scope: int = 0) -> dict[str, str]:
    """Names and values of a scope of the innermost frame of a thread."""
    frame = session.stack(thread)[0].id
    reference = session.scopes(frame)[scope].reference
    return {child.name: child.value for child in session.variables(reference)}


def everything(session: DebugSession) -> object:
    """All that a session shows at its stop."""
    threads = []
    for thread in session.threads():
        frames = []
        for frame in session.stack(thread.id):
            local = session.scopes(frame.id)[0]
            shown = [(child.name, child.value) for child in session.variables(local.reference)]
            frames.append((frame.name, frame.line, frame.column, sorted(shown)))
        threads.append((thread, frames))
    robot = [
        (child.name, child.value, [(inner.name, inner.value) for inner in session.variables(child.reference)])
        if child.reference
        else (child.name, child.value)
        for scope in session.scopes(0)
        for child in session.variables(scope.reference)
    ]
    return session.state(), threads, robot


def key(position: Position) -> tuple[object, ...]:
    """A position as a key."""
    return tuple(position)
