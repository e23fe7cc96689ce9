"""The nodes of a program tree: one record for each kind, frozen, values in SI units.

A node is equal to another one if it means the same. `source` is the element that it was read from; it carries what is
not understood (attributes, elements, blanks) through edits, and is None for a node that was made here.
"""

from __future__ import annotations

from typing import Final

from elitescript.program_tree.cells import UNTAUGHT, Expression, Joints, Pose
from elitescript.program_tree.xml_text import Element
from elitescript.records import field, record


@record
class Node:
    """What all nodes have.

    Attributes:
        children: nodes in it, in their order.
        is_suppressed: it is in the tree, takes one row and does nothing, with all that is in it.
        type_name: name of its kind in the language of the pendant that saved it; shown, never used to decide.
        source: the element that it was read from.
    """

    children: tuple[Node, ...] = ()
    is_suppressed: bool = False
    type_name: str = ""
    source: Element | None = field(default=None, compare=False, repr=False)


# ---------------------------------------------------------------- the parts of a task


@record
class InitVariables(Node):
    """Sets variables at each start. The shape of its entries is not known; they are kept."""


@record
class BeforeStart(Node):
    """Runs once before the main task."""


@record
class MainTask(Node):
    """The main part."""

    loops: bool = True
    """Its body is repeated for ever."""
    has_before_start: bool = False
    has_init_variables: bool = True


@record
class SubTask(Node):
    """A part that calls run."""

    name: str = ""
    is_hidden: bool = False
    is_synchronized: bool = False
    is_tracking: bool = False


# ---------------------------------------------------------------- order


@record
class Folder(Node):
    """Holds nodes under a name."""

    name: str = ""
    is_hidden: bool = False


@record
class If(Node):
    """Runs its children if a condition is true, else one of its `branches`."""

    condition: Expression = Expression()
    is_continuous: bool = False
    """The condition is computed all the time, and its end ends the children."""
    branches: tuple[Node, ...] = ()
    """`ElseIf` and `Else` nodes inside the element of the if."""


@record
class ElseIf(Node):
    """Another condition of the if in front of it. *Assumed*: name and place in the file."""

    condition: Expression = Expression()


@record
class Else(Node):
    """What runs if no condition of the if in front of it is true. *Assumed*: name and place in the file."""


LOOP_KINDS: Final = ("always", "count", "expression")


@record
class Loop(Node):
    """Repeats its children.

    Attributes:
        kind: one of `LOOP_KINDS`.
        count: how often, for `count`.
        variable: counts the turns, for `count`.
        condition: for `expression`.
        is_checked_continuously: the condition is computed all the time, and its end ends the children.
        is_post_test: the condition is computed after a turn.
    """

    kind: str = "always"
    count: int = 0
    variable: str = ""
    condition: Expression = Expression()
    is_checked_continuously: bool = False
    is_post_test: bool = False


@record
class Switch(Node):
    """Runs the case whose value an expression has."""

    value: Expression = Expression()


@record
class Case(Node):
    """A case of a switch."""

    name: str = ""


@record
class CallSubTask(Node):
    """Runs a sub-task by its name."""

    name: str = ""


@record
class Thread(Node):
    """Runs beside the main task. *Assumed*: name and attributes in the file."""

    name: str = ""
    loops: bool = True


@record
class Event(Node):
    """Runs beside the main task whenever a condition becomes true. *Assumed*: name and attributes in the file."""

    name: str = ""
    condition: Expression = Expression()


@record
class Halt(Node):
    """Ends the program."""


@record
class Comment(Node):
    """A text for people."""

    text: str = ""


@record
class Placeholder(Node):
    """Stands where a node needs a child and has none."""


# ---------------------------------------------------------------- motion

MOVEMENTS: Final = ("joint", "linear", "process")


@record
class Move(Node):
    """Moves the arm through its waypoints.

    Attributes:
        movement: one of `MOVEMENTS`.
        has_joint_positions: waypoints are joint positions, not poses.
        frame: name of the frame of its waypoints.
        tcp: name of the tool whose TCP is moved; None: the one that is set.
        joint_speed, joint_acceleration: rad/s, rad/s^2.
        speed, acceleration: of the TCP, m/s, m/s^2.
        radius: of blends of process moves, m.
    """

    movement: str = "joint"
    has_joint_positions: bool = False
    frame: str = "Ctrl_base_frame"
    tcp: str | None = None
    joint_speed: float | None = None
    joint_acceleration: float | None = None
    speed: float | None = None
    acceleration: float | None = None
    radius: float | None = None


@record
class Position:
    """A place of the arm.

    Attributes:
        joints: rad; NaN: not taught.
        pose: of the TCP at teaching time, m and rad in the base frame; None: none is stored.
    """

    joints: Joints = UNTAUGHT
    pose: Pose | None = None


POSITIONS: Final = ("fixed", "variable", "relative")
MOTION_BY: Final = ("move", "speed", "time")


@record
class Waypoint(Node):
    """A point of a move.

    Attributes:
        name: of a fixed one.
        position: one of `POSITIONS`.
        variable: that holds a variable one; `is_global`: of the configuration.
        target: the place; `start`: of a relative one, the place it is relative to.
        frame_pose: the frame of the move in the base frame at teaching time; None: none is stored.
        has_own_radius: `radius`, m, is used instead of that of the move.
        motion_by: where the speed comes from, one of `MOTION_BY`; the four of them as with `Move`.
        duration: of the motion by time, s.
    """

    name: str = ""
    position: str = "fixed"
    variable: str = ""
    is_global: bool = False
    target: Position = Position()
    start: Position = Position()
    frame_pose: Pose | None = None
    has_own_radius: bool = False
    radius: float | None = None
    motion_by: str = "move"
    joint_speed: float | None = None
    joint_acceleration: float | None = None
    speed: float | None = None
    acceleration: float | None = None
    duration: float | None = None


@record
class Arc(Node):
    """A circle through a via point to an end point: its two waypoints."""

    is_orientation_free: bool = True


DIRECTIONS: Final[dict[str, tuple[float, float, float]]] = {
    "XPositive": (1.0, 0.0, 0.0),
    "XNegative": (-1.0, 0.0, 0.0),
    "YPositive": (0.0, 1.0, 0.0),
    "YNegative": (0.0, -1.0, 0.0),
    "ZPositive": (0.0, 0.0, 1.0),
    "ZNegative": (0.0, 0.0, -1.0),
}
"""Axes by name; all but `ZPositive` are *assumed*."""


@record
class Direction(Node):
    """Moves the TCP along a line until one of its `Until` nodes is true.

    Attributes:
        axis: a key of `DIRECTIONS`.
        vector: gives the direction, if it is no axis.
        frame: in which the direction counts; None: that of the move.
        speed, acceleration: m/s, m/s^2; None: those of the move.
    """

    axis: str = "ZPositive"
    is_axis: bool = True
    vector: Expression = Expression()
    has_own_frame: bool = False
    frame: str = ""
    has_own_motion: bool = False
    speed: float | None = None
    acceleration: float | None = None


UNTILS: Final = ("expression", "input", "distance", "contact", "waypoint")


@record
class Until(Node):
    """Ends a motion.

    Attributes:
        kind: one of `UNTILS`; all but `expression` are *assumed*.
        condition: for `expression`.
        pin, is_high: for `input`.
        distance: from the start of the motion, m, for `distance`.
        force: N, for `contact`.
        has_own_deceleration: `joint_deceleration`, rad/s^2, and `deceleration`, m/s^2, are used instead of the move's.
    """

    kind: str = "expression"
    condition: Expression = Expression()
    pin: str = ""
    is_high: bool = True
    distance: float | None = None
    force: float | None = None
    has_own_deceleration: bool = False
    joint_deceleration: float | None = None
    deceleration: float | None = None


# ---------------------------------------------------------------- signals, values, people

WAITS: Final = ("time", "input", "expression")


@record
class Wait(Node):
    """Waits.

    Attributes:
        kind: one of `WAITS`.
        duration: s, for `time`.
        pin, is_high: for `input`.
        condition: for `expression`.
        timeout: s, after which it goes on in any case; None: never.
    """

    kind: str = "time"
    duration: float | None = None
    pin: str = ""
    is_high: bool = True
    condition: Expression = Expression()
    has_timeout: bool = False
    timeout: float | None = None


SETS: Final = ("digital", "analog", "expression", "none")


@record
class Set(Node):
    """Sets an output.

    Attributes:
        kind: one of `SETS`.
        pin: the output.
        is_high: for `digital`.
        value: A or V, for `analog`; `unit` is `A` or `V`.
        expression: for `expression`.
        sets_tcp: a TCP is set too.
    """

    kind: str = "digital"
    pin: str = ""
    is_high: bool = True
    value: float | None = None
    unit: str = ""
    expression: Expression = Expression()
    sets_tcp: bool = False


@record
class Assignment(Node):
    """Gives a variable the value of an expression.

    Attributes:
        variable: its name; `is_global`: it is one of the configuration.
        value: the expression; `is_copied`: a list is copied with all that is in it.
    """

    variable: str = ""
    is_global: bool = False
    value: Expression = Expression()
    is_copied: bool = False


@record
class Popup(Node):
    """Shows a text.

    Attributes:
        kind: `info`, `warning` or `error`.
        message: the text, or the name of a variable that holds it (`is_variable`).
        is_blocking: the program waits until it is closed.
    """

    kind: str = "info"
    message: str = ""
    is_variable: bool = False
    is_blocking: bool = False


TIMER_ACTIONS: Final = ("reset", "start", "stop")


@record
class Timer(Node):
    """Starts, stops or resets a timer, a variable that counts seconds."""

    action: str = "reset"
    variable: str = ""


# ---------------------------------------------------------------- texts


@record
class ScriptLine(Node):
    """A statement."""

    statement: Expression = Expression()


@record
class ScriptFile(Node):
    """A file of script.

    Attributes:
        path: of the file, below the task folder.
        text: the text that the file had when the node was saved.
    """

    path: str = ""
    text: str = ""


@record
class Extension(Node):
    """A node of a plugin, which alone could say what it does."""

    name: str = ""
    plugin: str = ""
    version: str = ""
    vendor: str = ""


@record
class Unknown(Node):
    """A node whose kind is not known: kept, counted and shown by the name of its element.

    Nodes in it are not read, since nothing says which elements are nodes.
    """

    element: str = ""
