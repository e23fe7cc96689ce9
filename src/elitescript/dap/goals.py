"""How far a program is to go on, and how it goes on after it stopped halfway to answer requests."""

from __future__ import annotations

from collections.abc import Callable

from elitescript.dap.debuggee import Session
from elitescript.debugger.api import STEP, Stop
from elitescript.debugger.session import DebugSession
from elitescript.records import record, replace

Run = Callable[[DebugSession], Stop]


@record
class Goal:
    """Something that lets a program go on.

    Args:
        run: carries it out.
        rest: returns what is left of it after it stopped halfway.
        is_interruptible: whether it stops halfway to answer requests.
        how: method of `ServedSession.proceed`, for a robot that lives; empty to let it be.
        thread: that takes a step, or that a request to go in history has named; 0 for none.
    """

    run: Run
    rest: Callable[[], Goal]
    is_interruptible: bool = True
    how: str = ""
    thread: int = 0

    @staticmethod
    def start(*, stop_on_entry: bool, no_debug: bool) -> Goal:
        """Begin the run."""
        return Goal(
            lambda session: session.start(stop_on_entry=stop_on_entry, no_debug=no_debug),
            lambda: Goal.resume(),
        )

    @staticmethod
    def wait(*, stop_on_entry: bool) -> Goal:
        """Let a robot that lives go on, or pause it."""
        return replace(Goal.resume(), how="pause" if stop_on_entry else "")

    @staticmethod
    def resume() -> Goal:
        """Go on to the next stop."""
        return Goal(DebugSession.resume, Goal.resume, how="resume")

    @staticmethod
    def step(how: str, session: Session, thread: int) -> Goal:
        """Make a step of a thread: `next`, `step_in` or `step_out`."""
        kind: Callable[[DebugSession, int], Stop] = getattr(DebugSession, how)
        depth = len(session.stack(thread)) - (how == "step_out")

        def rest(session: DebugSession) -> Stop:
            # Calls that the step goes over have begun: leave them first.
            while len(session.stack(thread)) > depth:
                stop = session.step_out(thread)
                if stop.reason != STEP or stop.thread != thread or len(session.stack(thread)) <= depth:
                    return stop
            return session.next(thread)

        remaining = Goal(rest, lambda: remaining)
        whole = Goal(lambda session: kind(session, thread), lambda: remaining, how=how, thread=thread)
        return replace(whole, rest=lambda: whole) if how == "step_in" else whole

    @staticmethod
    def travel(run: Run, thread: int = 0) -> Goal:
        """Go back in history, or to a moment; it does not stop halfway to answer requests."""
        goal = Goal(run, lambda: goal, is_interruptible=False, thread=thread)
        return goal
