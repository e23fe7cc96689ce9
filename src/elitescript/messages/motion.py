"""Requests that move the arm.

`q` are joint positions (six, rad), `p` are TCP poses in the base frame (`[x, y, z, rx, ry, rz]`, m and rad,
roll-pitch-yaw). Values have passed the command's own checks; the machine checks limits and reach when it
accepts the request.
"""

from __future__ import annotations

from array import array
from typing import Final

from elitescript.records import field, record

BLEND_SHARE: Final = 0.5
"""Largest share of a move that a blend takes."""

RADIUS_SHORTENED: Final = "r = {r:g} m is shortened to {most:.4g} m: a blend takes at most half of a move"
"""Text of the warning about a longer radius (W235)."""


def shortened_radius(text: str) -> tuple[float, float] | None:
    """Return the radius that was asked for and the one that is used, m, from that warning; None for another text."""
    words = RADIUS_SHORTENED.split("{")
    asked, middle, used = text.partition(words[1].partition("}")[2])
    behind = words[2].partition("}")[2]
    if not middle or not asked.startswith(words[0]) or not used.endswith(behind):
        return None
    return float(asked.removeprefix(words[0])), float(used.removesuffix(behind))


DIRECTION_M: Final = 100.0
"""From so far away on, the target of a straight line is a direction: programs of the pendant name points 1000 m away
where the arm moves until something stops it. *Assumed*: the limit."""

TOWARDS_M: Final = 1000.0
"""How far away programs of the pendant put the target of a motion in a direction."""
FARTHEST_REACH_M: Final = 3.0
"""Farther than the TCP of any arm is from its base."""

RADIUS_HINT: Final = "choose r up to {most:.4g}, or leave more way between the points"

Six = tuple[float, float, float, float, float, float]


@record
class MoveJ:
    """Move straight in joint space to `q_target`."""

    q_target: Six
    a: float
    """Acceleration of the leading joint, rad/s^2."""
    v: float
    """Speed of the leading joint, rad/s."""
    t_s: float = 0.0
    """Wanted duration; 0 plans from `a` and `v`."""
    r: float = 0.0
    """Blend radius, m."""


@record
class MoveL:
    """Move the TCP on a straight line to `p_target`."""

    p_target: Six
    a: float
    """Tool acceleration, m/s^2 (rad/s^2 for a pure rotation)."""
    v: float
    """Tool speed, m/s (rad/s for a pure rotation)."""
    t_s: float = 0.0
    r: float = 0.0


@record
class MoveC:
    """Move the TCP on the circle through the present pose, `p_via` and `p_target`."""

    p_via: Six
    p_target: Six
    a: float
    v: float
    r: float = 0.0
    is_orientation_fixed: bool = True
    """Keep the orientation's relation to the tangent; else turn evenly from start to end."""


@record
class MoveP:
    """Move the TCP on a line to `p_target`, one of a chain of lines that keeps its speed at the corners."""

    p_target: Six
    a: float
    v: float
    r: float = 0.0
    """Blend radius at `p_target`, m; 0 rounds the corner as little as the speed allows."""


@record
class StopJ:
    """Brake to standstill with joint deceleration `a` (rad/s^2)."""

    a: float


@record
class StopL:
    """Brake to standstill along the path with tool deceleration `a` (m/s^2)."""

    a: float


@record
class MicroLine:
    """Points of a file at a constant interval of time, in SI units.

    Points are numbered from 1, as scripts number them. Lines of the file that hold no point do not count (*assumed*:
    the manual counts lines, of files that hold only points).
    """

    name: str
    """Of the file, in the task folder."""
    interval_s: float
    is_cartesian: bool
    """Whether the points are poses (m, rad, roll-pitch-yaw); else they are joint positions (rad)."""
    numbers: bytes = field(repr=False)
    """Six doubles for each point, in the machine's own format."""
    file_lines: bytes = field(repr=False)
    """Line in the file of each point, as unsigned 32-bit numbers."""
    frame: Six = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    """Part frame in which poses are given, in the base frame."""

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.numbers) // 48

    def point(self, number: int) -> Six:
        """Return one point, counted from 1."""
        a, b, c, d, e, f = array("d", self.numbers[48 * number - 48 : 48 * number])
        return a, b, c, d, e, f

    def file_line(self, number: int) -> int:
        """Return the line of the file that holds a point."""
        return array("I", self.file_lines[4 * number - 4 : 4 * number])[0]

    def place(self, number: int) -> str:
        """Return the place of a point in the file, for messages."""
        line = self.file_line(number)
        where = f"line {line} of {self.name}"
        return where if line == number else f"point {number} ({where})"


@record
class MoveML:
    """Move through the points of a loaded file, at its interval."""

    points: MicroLine
    first: int
    """Number of the first point to play, from 1."""
    last: int
    a: float
    """Joint acceleration of the way to the first point, rad/s^2."""
    v: float
    """Joint speed of the way to the first point, rad/s."""

    @property
    def r(self) -> float:
        """Blend radius, m: 0, it always ends at rest."""
        return 0.0


@record
class SpeedJ:
    """Move the joints at the speeds `qd` (rad/s) until the next motion."""

    qd: Six
    a: float
    """Acceleration of the leading joint, rad/s^2."""
    t_s: float | None = None
    """Time after which the call returns; None returns when the speeds are reached."""


@record
class SpeedL:
    """Move the TCP at the velocity `xd` (m/s and rad/s, base frame) until the next motion."""

    xd: Six
    a: float
    """Tool acceleration, m/s^2."""
    a_rot: float
    """Angular acceleration, rad/s^2."""
    t_s: float | None = None


@record
class ServoJ:
    """Give the next target of a stream of joint targets."""

    q_target: Six
    t_s: float
    """Control time of this target; the call takes it."""
    lookahead_s: float
    """Window of the smoothing."""
    gain: float
    """Gain of the following arm, 100 to 2000."""


@record
class TrackLinear:
    """Follow a belt from now on."""

    direction: tuple[float, float, float]
    """Of travel, base frame; its length does not count."""
    counts_per_m: float
    encoder: int


@record
class TrackCircular:
    """Follow a turntable from now on."""

    center: Six
    """Pose in the base frame; the table turns about its z axis."""
    counts_per_turn: float
    turns_tool: bool
    """Whether the tool keeps its orientation relative to the table."""
    encoder: int


@record
class StopTracking:
    """Follow no conveyor any more, and come to rest."""


MoveRequest = MoveJ | MoveL | MoveC | MoveP | MoveML
"""A move to a target, planned as a whole."""
DriveRequest = SpeedJ | SpeedL | ServoJ
"""A motion that begins in any state and goes on after the call."""
MotionRequest = MoveRequest | DriveRequest | StopJ | StopL
TrackRequest = TrackLinear | TrackCircular | StopTracking
"""Following a conveyor, besides any other motion."""
