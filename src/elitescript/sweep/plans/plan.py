"""What a sweep is made of: its plan, the choices of one run, and the row that the run leaves behind.

Everything here is frozen data. A plan with the number of a run determines that run's choices, and choices determine
the row, on any computer of one platform.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from elitescript import __version__
from elitescript.messages.signals import Value
from elitescript.records import field, record

HUNG: Final = "hung"
"""State of a run that did not come back in time."""

CRASHED: Final = "crashed"
"""State of a run whose process died."""

ERROR: Final = "error"
"""State of a run that could not begin, or whose device failed."""

LOST: Final = (HUNG, CRASHED, ERROR)
"""States of runs of which there is no record. Each is also what is written as the property that did not hold."""


@record
class Plan:
    """Everything that determines the rows of a sweep; nothing else does, and nothing of a disk is needed beside it.

    The number of runs is not part of it: a longer sweep begins like a shorter one.

    Attributes:
        program: text of the program.
        program_name: what alarms call it, without a folder.
        tree: of the script of a graphical program, what is known of its tree; see `plans.trees`.
        files: content of the task folder by name, Base64; each run gets a copy in memory.
        world: text of the world file; empty without one.
        world_name: its name, without a folder.
        python: texts of Python files by name: of devices and of properties, and what is beside them.
        options: of the robot, by the names of `RobotOptions`, as JSON has them; with `model_text` for an own arm.
        settings: `NAME=VALUE` as of `--set`: signals and program globals at the start.
        variations: what is drawn for each run.
        seed: of everything that is drawn.
        until_s: limit of virtual time, s; None for none.
        ensure: properties, as text: expressions, names of built-in ones, or `FILE.py:function`.
        measures: expressions by name.
        chaos: name of a profile, or text of a profile file; empty without disturbances.
        step_s: time between two rows that properties over time see, s; None for each tick.
        has_margins: whether rows have a column with the margin of each property.
        version: of elitescript.
    """

    program: str
    program_name: str = "program.script"
    tree: Mapping[str, Any] = field(default_factory=dict)
    files: Mapping[str, str] = field(default_factory=dict)
    world: str = ""
    world_name: str = ""
    python: Mapping[str, str] = field(default_factory=dict)
    options: Mapping[str, Any] = field(default_factory=dict)
    settings: tuple[str, ...] = ()
    variations: tuple[Variation, ...] = ()
    seed: int = 0
    until_s: float | None = None
    ensure: tuple[str, ...] = ()
    measures: Mapping[str, str] = field(default_factory=dict)
    chaos: str = ""
    step_s: float | None = None
    has_margins: bool = False
    version: str = __version__


@record
class Variation:
    """One `--vary NAME=KIND(...)`.

    Attributes:
        name: of a signal, a global, or a place in the world file such as `box.0.x` or `plant.lag_s`.
        kind: `uniform`, `normal`, `choice` or `grid`.
        arguments: as they were written: two numbers, the choices, or two ends and a number of points.
    """

    name: str
    kind: str
    arguments: tuple[Value | str, ...]


@record
class Disturbance:
    """Something that goes wrong, or that a person does, in one run.

    Attributes:
        kind: a kind of fault, as in `[[fault]]` of a world file; or one of `sweep.chaos`, as `safeguard_stop`.
        on: place: a port, a serial line, an input or the name of a device; empty where the kind needs none.
        at_s: begin, s after the start of the robot.
        for_s: duration, s; None until the end of the run.
        settings: the others, by their names in `[[fault]]`.
    """

    kind: str
    on: int | str = ""
    at_s: float = 0.0
    for_s: float | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)


@record
class Choices:
    """Everything that makes one run differ from the others of its plan.

    Attributes:
        run: number, from 0.
        seed: of this run: of `random()` in its program, and of what its world draws.
        values: what was drawn for each variation, by its name.
        disturbances: in the order of time.
    """

    run: int
    seed: int
    values: Mapping[str, Value | str] = field(default_factory=dict)
    disturbances: tuple[Disturbance, ...] = ()


@record
class Failure:
    """Why a run failed: what is the same for two runs that failed in the same way is their `kind`.

    Attributes:
        expression: the first property that did not hold.
        state: of the run.
        code: of its last alarm, empty without one.
        line: of that alarm, or where the program waited; 0 if unknown.
        disturbance: kind of the last disturbance that had begun; empty without one.
        text: what happened, for people.
        t: when the property was decided, s; None if that has no time.
        margin: by how much it failed, in the unit of its comparison; None where it has none.
    """

    expression: str
    state: str
    code: str = ""
    line: int = 0
    disturbance: str = ""
    text: str = ""
    t: float | None = None
    margin: float | None = None

    @property
    def kind(self) -> tuple[str, str, int, str]:
        """Expression, alarm code, line and last disturbance."""
        return self.expression, self.code, self.line, self.disturbance


@record
class Row:
    """What one run leaves behind: a row of the table, and why it failed.

    Attributes:
        choices: of the run.
        state: in which it ended: a state of `Run`; `crashed` or `hung` if it did not come back; `error` if it could not
            begin, or a device of its world failed.
        time_s: virtual time, s; None of a run that did not come back.
        measures: by their names.
        digest: of positions, times, signals and texts at the end, rounded so that other processors give the same.
        failure: None if every property held.
        margins: of the properties in their order; None where one has none.
        is_warned: the run has found warnings of its own.
    """

    choices: Choices
    state: str
    time_s: float | None
    measures: Mapping[str, Value | str | None] = field(default_factory=dict)
    digest: str = ""
    failure: Failure | None = None
    margins: tuple[float | None, ...] = ()
    is_warned: bool = False

    @property
    def failed(self) -> str:
        """Text of the first property that did not hold; empty if all did."""
        return "" if self.failure is None else self.failure.expression
