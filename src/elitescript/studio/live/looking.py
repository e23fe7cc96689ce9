"""Moments of a run, in a worker process: at any time, and at the beginnings of statements.

The run is made again by the debugger, which goes on from where it stands, or from a copy of the process that stood
before the moment; nothing of the moments is stored.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from typing import Any, Final, NoReturn

from elitescript.conversation import describe
from elitescript.conversation.describe import Moment, Thread, Variable
from elitescript.debugger.api import BEFORE_STATEMENT, Picture, Position
from elitescript.debugger.session import DebugSession
from elitescript.debugger.source import ProgramSource
from elitescript.environment.network_option import STUDIO
from elitescript.errors import DebugError, ElitescriptError, ProgramError
from elitescript.studio.live.jobs import PreparedJob, job_of
from elitescript.studio.live.link import Link
from elitescript.world_file import closed_world

CAN_COPY: Final = hasattr(os, "fork")
"""Whether copies of the run are left behind on the way, so that going back does not begin at the start."""

_MAIN: Final = 1
"""Number of the main thread, also when it has ended."""

NO_THREAD: Final = "there is no thread {name!r} at this moment"


def look(link: Link, request: Mapping[str, Any], jail: Callable[[], None]) -> None:
    """Answer requests for moments until the link is closed; never returns otherwise.

    Args:
        link: to the engine.
        request: `job`, `run`, `until_s`. Then come `seek` and `step` as the page has them.
        jail: called before the text is compiled.
    """
    run, job = request["run"], job_of(request["job"])
    try:
        prepared = PreparedJob(job)
        # What the Python files of a world import cannot be read later on.
        prepared.robot()
        jail()
        session = DebugSession(
            ProgramSource(
                job.source.name,
                source=job.source,
                world=lambda: closed_world(job.world or None, is_trusted=job.is_trusted),
                levels=prepared.levels,
                schedule=prepared.schedule,
                presets=job.presets,
                until_s=request["until_s"],
                task_dir=prepared.files,
                network_by=STUDIO,
                **job.robot,
            ),
            forks=CAN_COPY,
        )
    except ProgramError as error:
        _refuse_all(link, "; ".join(map(str, error.problems)))
    except ElitescriptError as error:
        _refuse_all(link, str(error))
    session.set_exception_filters(())
    session.start(stop_on_entry=True)
    moments = Moments(session)
    try:
        while True:
            asked = link.receive()
            try:
                found = moments.at(asked["t"]) if asked["do"] == "seek" else moments.stepped(asked)
            except DebugError as error:
                link.send(describe.refused(str(error), asked["ask"]))
            else:
                link.send(describe.state(run, asked["ask"], found))
    finally:
        session.close()


def _refuse_all(link: Link, text: str) -> NoReturn:
    while True:
        link.send(describe.refused(text, link.receive()["ask"]))


class Moments:
    """Finds moments of a debugged run.

    Args:
        session: stands anywhere.
    """

    def __init__(self, session: DebugSession) -> None:
        self._session = session
        self._last: Moment | None = None

    def at(self, t: float) -> Moment:
        """Return the moment behind the tick at a time, s."""
        self._session.run_to_time(t)
        return self._found()

    def stepped(self, asked: Mapping[str, Any]) -> Moment:
        """Return the moment at the next or previous beginning of a statement of a thread.

        Raises:
            DebugError: there is no such thread.
        """
        session = self._session
        position = position_of(asked["position"])
        if position is None:
            session.run_to_time(asked["t"])
        elif position != session.stop.position:
            session.run_to(position)
        name = asked["thread"]
        living = {thread.name: thread.id for thread in session.threads()}
        number = living.get(name, _MAIN if name == "main" else 0)
        if not number:
            raise DebugError(NO_THREAD.format(name=name))
        if asked["by"] < 0:
            session.step_in_back(number)
        elif name in living:
            session.step_in(number)
        return self._found()

    def _found(self) -> Moment:
        found = describe.with_changes(moment_of(self._session.picture(), self._session), self._last)
        self._last = found
        return found


def moment_of(picture: Picture, session: DebugSession) -> Moment:
    """Return a picture of the debugger as a page has it."""
    stop = session.stop
    threads = zip(picture.threads, picture.functions, strict=True)
    return Moment(
        t=picture.t,
        line=stop.line if stop.position.kind == BEFORE_STATEMENT else picture.line,
        joints=picture.joints,
        tcp_pose=picture.tcp_pose,
        globals=tuple(Variable(item.name, item.value, item.type) for item in picture.globals),
        signals=dict(picture.signals),
        threads=tuple(
            Thread(thread.name, thread.line, thread.waits_for, name, thread.because) for thread, name in threads
        ),
        position=position_text(stop.position),
    )


def position_text(position: Position) -> str:
    """Return a position as the opaque text of a moment."""
    return ".".join(map(str, position))


def position_of(text: str) -> Position | None:
    """Return the position of such a text; None if it is none."""
    parts = text.split(".")
    if len(parts) != len(Position._fields) or not all(part.isdecimal() for part in parts[:3]):
        return None
    return Position(int(parts[0]), int(parts[1]), int(parts[2]), parts[3])
