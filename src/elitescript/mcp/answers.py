"""The form of every answer. Their JSON schemas are made of these.

`node` stands beside the line of a graphical program: its node, as people say it.
"""

from __future__ import annotations

from typing import Any, NotRequired

from typing_extensions import TypedDict

Six = list[float]


class Problem(TypedDict):
    """A finding of the check; line and column from 1, columns in characters."""

    severity: str
    code: str
    line: int
    node: NotRequired[str]
    column: int
    text: str
    hint: str
    fix: NotRequired[str]
    """Title of a repair that `elitescript check --fix` makes."""


class Found(TypedDict):
    """A finding of text and run, as `--json` of `check` and `run` has it."""

    code: str
    severity: str
    """`error`, `warning` or `note`; a note is what a sound program may have too."""
    line: int
    node: NotRequired[str]
    column: int
    text: str
    hint: str
    t: float | None
    """Robot time of the first time, s; null if the text shows it."""
    count: int
    thread: str
    source: str
    """`check` (the text), `run`, `device`, `contact`, `limit` or `end`."""
    template: NotRequired[str]
    values: NotRequired[dict[str, Any]]
    hint_template: NotRequired[str]
    hint_values: NotRequired[dict[str, Any]]


class Findings(TypedDict):
    """What the check finds."""

    starts: bool
    """Whether the program would start."""
    errors: int
    warnings: int
    problems: list[Problem]
    problems_left_out: int


class Move(TypedDict):
    """A motion of the arm."""

    begin_s: float
    end_s: float
    kind: str
    line: int
    node: NotRequired[str]


class Thread(TypedDict):
    """A script thread of a program that did not end by itself."""

    name: str
    line: int
    node: NotRequired[str]
    doing: str


class Outcome(TypedDict):
    """How a run ended and what it did; times in s of robot time, angles in rad, lengths in m."""

    findings: list[Found]
    """What text and run have found, the worst first: empty only if nothing was found."""
    findings_left_out: int
    why: str | None
    """Why the run did not finish; null if it did, and if nothing was run."""
    check: Findings
    state: str
    """`finished`, `alarm`, `stopped`, `time_limit`, `stuck` or `does_not_compile`."""
    time_s: float
    cut_by_wall_time: NotRequired[bool]
    """Whether the run was ended because it took too much of this computer's time."""
    alarm: NotRequired[dict[str, Any] | None]
    threads: NotRequired[list[Thread]]
    messages: NotRequired[list[dict[str, Any]]]
    """Messages, prints, popups and warnings: the last ones."""
    messages_left_out: NotRequired[int]
    moves: NotRequired[list[Move]]
    moves_left_out: NotRequired[int]
    signal_changes: NotRequired[list[dict[str, Any]]]
    signal_changes_left_out: NotRequired[int]
    globals: NotRequired[dict[str, Any]]
    signals: NotRequired[dict[str, Any]]
    """Those not at their default at the end."""
    joints: NotRequired[Six]
    tcp_pose: NotRequired[Six]


class Row(TypedDict):
    """The robot at one moment."""

    t: float
    line: int
    node: NotRequired[str]
    joints: Six
    joint_speeds: Six
    tcp_pose: Six
    state: str
    signals: dict[str, Any]


class Trace(Outcome):
    """Rows of a stretch of time, and how the run ended."""

    rows: NotRequired[list[Row]]


class Explanation(TypedDict):
    """What a code means."""

    code: str
    title: str
    text: str


class Commands(TypedDict):
    """Commands that were found: all facts of one, or the names and summaries of several."""

    commands: list[dict[str, Any]]
    commands_left_out: int


class Programs(TypedDict):
    """Programs in the folder."""

    folder: str
    programs: list[str]
    programs_left_out: int


class DebugThread(TypedDict):
    """A script thread."""

    id: int
    name: str
    line: int
    node: NotRequired[str]
    waits_for: str
    """Empty while it does not wait."""
    because: str
    """Why it does not go on, such as the condition of its loop; empty if that is not known."""


class DebugFrame(TypedDict):
    """A call on the stack, the innermost one first."""

    function: str
    line: int
    node: NotRequired[str]


class Said(TypedDict):
    """Something that the program or the robot has said."""

    t: float
    line: int
    node: NotRequired[str]
    text: str


class Stopped(TypedDict):
    """Where a debugged run stands: before a statement, behind a tick, or at its end."""

    session: int
    reason: str
    text: str
    time_s: float
    thread: int
    """Whose stack and variables are shown: the one that stopped, or else the first; 0 if there is none."""
    result: str
    """How the run ended; empty before."""
    threads: list[DebugThread]
    stack: list[DebugFrame]
    variables: dict[str, dict[str, str]]
    """By scope: `Locals`, `Globals`, `Robot`."""
    joints: Six
    tcp_pose: Six
    output: list[Said]
    """Since the last stop."""


class SetBreakpoint(TypedDict):
    """Where a breakpoint is now."""

    line: int
    node: NotRequired[str]
    set: bool
    why: str
    """Why it is not set."""


class Breakpoints(TypedDict):
    """All breakpoints of a debugged run."""

    breakpoints: list[SetBreakpoint]


class Value(TypedDict):
    """The value of an expression."""

    value: str
    type: str


class ValueChange(TypedDict):
    """A change of a variable or signal."""

    t: float
    line: int
    node: NotRequired[str]
    by: str
    """The thread that made it, or what else did."""
    old: str
    new: str


class History(TypedDict):
    """Changes in the order of time, the last ones."""

    changes: list[ValueChange]
    changes_left_out: int


class Ended(TypedDict):
    """A debugged run that was given up."""

    session: int
