"""What no line coverage shows: refusals, `except` paths, states and faults that no test has met."""

from __future__ import annotations

from elitescript.records import record


@record
class Refusal:
    """A reason for which a command that a program calls can refuse, and that no test has met.

    Attributes:
        path: of the program.
        line: of the first call.
        command: its name.
        error: class of the exception, as the catalogue names it.
        text: when the command raises it.
    """

    path: str
    line: int
    command: str
    error: str
    text: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.command}: {self.error}: {self.text}"


@record
class UnmetHandler:
    """An `except` clause that no test has entered."""

    path: str
    line: int
    text: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.text}"


@record
class UnmetFault:
    """A fault that a connection, a serial line or an input of a world can have, and that no test has tried."""

    on: str
    kinds: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.on}: {', '.join(self.kinds)}"


@record
class Unmet:
    """All of it.

    Attributes:
        refusals: of commands, by program and line.
        handlers: by program and line.
        safety_states: names of states.
        task_states: names of states.
        faults: by place.
        alarms: codes that tests have met: of alarms, and of refusals that programs have caught.
    """

    refusals: tuple[Refusal, ...] = ()
    handlers: tuple[UnmetHandler, ...] = ()
    safety_states: tuple[str, ...] = ()
    task_states: tuple[str, ...] = ()
    faults: tuple[UnmetFault, ...] = ()
    alarms: tuple[str, ...] = ()

    def sections(self) -> tuple[tuple[str, list[str]], ...]:
        """Return titles, and what stands below each."""
        return (
            ("refusals of commands", [str(refusal) for refusal in self.refusals]),
            ("except paths", [str(handler) for handler in self.handlers]),
            ("safety states", [", ".join(self.safety_states)] if self.safety_states else []),
            ("task states", [", ".join(self.task_states)] if self.task_states else []),
            ("faults of the world", [str(fault) for fault in self.faults]),
        )
