"""How far a program is to go on, and how it goes on after it stopped halfway to answer requests."""

from __future__ import annotations

from collections.abc import Callable

from elitescript.debugger.api import STEP, Position, Stop
from elitescript.debugger.session import DebugSession
from elitescript.records import record

Run = Callable[[DebugSession], Stop]


@record
class Goal:
    """Something that lets a program go on.

    Args:
        run: carries it out.
        rest: returns what is left of it after it stopped halfway.
        is_interruptible: whether it stops halfway to answer requests.
    """

    run: Run
    rest: Callable[[], Goal]
    is_interruptible: bool = True

    @staticmethod
    def start(*, stop_on_entry: bool, no_debug: bool) -> Goal:
        """Begin the run."""
        return Goal(
            lambda session: session.start(stop_on_entry=stop_on_entry, no_debug=no_debug),
            lambda: Goal.resume(),
        )

    @staticmethod
    def resume() -> Goal:
        """Go on to the next stop."""
        return Goal(DebugSession.resume, Goal.resume)

    @staticmethod
    def step(kind: Callable[[DebugSession, int], Stop], session: DebugSession, thread: int) -> Goal:
        """Make a step of a thread: `DebugSession.next`, `step_in` or `step_out`."""
        depth = len(session.stack(thread))
        if kind is DebugSession.step_out:
            depth -= 1

        def rest(session: DebugSession) -> Stop:
            # Calls that the step goes over have begun: leave them first.
            while len(session.stack(thread)) > depth:
                stop = session.step_out(thread)
                if stop.reason != STEP or stop.thread != thread or len(session.stack(thread)) <= depth:
                    return stop
            return session.next(thread)

        again = Goal(lambda session: kind(session, thread), lambda: again)
        if kind is not DebugSession.step_in:
            remaining = Goal(rest, lambda: remaining)
            return Goal(lambda session: kind(session, thread), lambda: remaining)
        return again

    @staticmethod
    def travel(run: Run) -> Goal:
        """Go back in history, or to a moment; it does not stop halfway to answer requests."""
        goal = Goal(run, lambda: goal, is_interruptible=False)
        return goal

    @staticmethod
    def to(position: Position) -> Goal:
        """Go to a position."""
        return Goal.travel(lambda session: session.run_to(position))
