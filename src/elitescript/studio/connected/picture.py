"""What is known of a controller at a moment, from all of its ports, as the page gets it."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any, Final, TypeVar

from elitescript.client.primary_messages import RobotState
from elitescript.messages.enums import Mode, RobotMode, SafetyMode, TaskState
from elitescript.messages.timing import TICKS_PER_S
from elitescript.protocol.binary import WireValue
from elitescript.protocol.dashboard.guards import MAY_MOVE, safety_name
from elitescript.protocol.primary.packets import CARTESIAN, JOINTS, MASTER_BOARD, ROBOT_MODE
from elitescript.studio.connected.signals import FAST, signals_of

PICTURE_HZ: Final = 25.0
"""How often the page gets a picture."""

VARIABLES: Final = (
    "timestamp",
    "actual_joint_positions",
    "target_joint_positions",
    "actual_joint_speeds",
    "actual_TCP_pose",
    "actual_TCP_speed",
    "actual_TCP_force",
    "robot_mode",
    "safety_status",
    "runtime_state",
    "target_speed_fraction",
    "script_control_line",
    *FAST,
)
"""Variables of the recipe of pictures; a controller may lack any but the joints."""

LEAP_TICKS: Final = 60 * TICKS_PER_S
"""Longest gap in time that is shown as one."""

TIME_MAX_S: Final = 1e11
"""Times from here on are none of a controller."""

Kind = TypeVar("Kind", bound=Mode)

_MICROSECONDS_PER_S: Final = 1e6


class Picture:
    """The newest values of one controller.

    Args:
        address: of the controller, for the page.

    Attributes:
        link: "connecting", "connected" or "lost".
        values: of RTSI, by variable; those of the primary port where RTSI is not there.
        popup: the message window that is open: title, text, level, number.
        globals: variables of the program as shown, by name.
    """

    __slots__ = (
        "address",
        "firmware",
        "globals",
        "is_jogging",
        "is_remote",
        "line_offset",
        "link",
        "model",
        "popup",
        "program",
        "serial",
        "values",
        "zero_s",
    )

    def __init__(self, address: str) -> None:
        self.address = address
        self.link = "connecting"
        self.values: dict[str, WireValue] = {}
        self.zero_s: float | None = None
        """Time of the controller at which the page's time is 0."""
        self.model = ""
        self.firmware = ""
        self.serial = ""
        self.program = ""
        self.is_remote = True
        self.line_offset = 0
        """Lines that the controller counts in front of the text of the page."""
        self.is_jogging = False
        """Whether the program that runs is the studio's own, whose lines nobody has."""
        self.popup: dict[str, Any] | None = None
        self.globals: dict[str, str] = {}

    # ---------------------------------------------------------------- what comes in

    def take_package(self, values: Mapping[str, WireValue]) -> None:
        """Take the values of an RTSI package; one with numbers that no controller has is left out."""
        joints, time_s = values.get("actual_joint_positions"), values.get("timestamp")
        if joints is not None and _six(joints) is None:
            return
        if isinstance(time_s, float) and not abs(time_s) < TIME_MAX_S:
            return
        self.values.update(values)

    def take_state(self, state: RobotState) -> None:
        """Take a robot state of the primary port, for controllers without RTSI."""
        mode, joints = state.part(ROBOT_MODE), state.part(JOINTS)
        cartesian, board = state.part(CARTESIAN), state.part(MASTER_BOARD)
        values: dict[str, WireValue] = {}
        if mode is not None:
            time_us, is_paused, is_playing = mode["timestamp"], mode["task paused"], mode["task running"]
            task = TaskState.PAUSED if is_paused else TaskState.PLAYING if is_playing else TaskState.STOPPED
            values |= {
                "timestamp": time_us / _MICROSECONDS_PER_S if isinstance(time_us, int) else 0.0,
                "robot_mode": mode["robot mode"],
                "runtime_state": int(task),
                "target_speed_fraction": mode["target speed fraction"],
            }
        if joints is not None:
            values |= {
                "actual_joint_positions": joints["actual position"],
                "target_joint_positions": joints["target position"],
                "actual_joint_speeds": joints["actual velocity"],
            }
        if cartesian is not None:
            values["actual_TCP_pose"] = cartesian["TCP pose"]
        if board is not None:
            values |= {
                "safety_status": board["safety mode"],
                "actual_digital_input_bits": board["digital inputs"],
                "actual_digital_output_bits": board["digital outputs"],
            }
        self.forget()
        self.take_package(values)

    def forget(self) -> None:
        """Forget the values: what follows is from another port, which may not have all of them."""
        self.values.clear()

    # ---------------------------------------------------------------- what is known

    @property
    def time_s(self) -> float:
        """Time since the first picture, or since the controller was restarted, s."""
        time_s = self.values.get("timestamp")
        return time_s - self.zero_s if isinstance(time_s, float) and self.zero_s is not None else 0.0

    @property
    def tick(self) -> int:
        """The same in ticks."""
        return round(self.time_s * TICKS_PER_S)

    @property
    def joints(self) -> tuple[float, ...] | None:
        """Measured joints, rad; None while nothing is known."""
        return _six(self.values.get("actual_joint_positions"))

    @property
    def robot_mode(self) -> RobotMode:
        """What power and brakes are doing."""
        return _mode(RobotMode, self.values.get("robot_mode"), RobotMode.DISCONNECTED)

    @property
    def safety_mode(self) -> SafetyMode:
        """What the safety system allows."""
        return _mode(SafetyMode, self.values.get("safety_status"), SafetyMode.UNDEFINED)

    @property
    def task_state(self) -> TaskState:
        """Whether a program runs."""
        return _mode(TaskState, self.values.get("runtime_state"), TaskState.UNKNOWN)

    @property
    def may_move(self) -> bool:
        """Whether power, brakes and safety let the arm move."""
        return self.robot_mode is RobotMode.RUNNING and self.safety_mode in MAY_MOVE

    def begins_anew(self, last_tick: int) -> bool:
        """Return whether the controller's time does not go on from that of the last row: it was restarted, or away."""
        return not 0 <= self.tick - last_tick <= LEAP_TICKS

    def begin(self) -> None:
        """Count the page's time from now."""
        time_s = self.values.get("timestamp")
        self.zero_s = time_s if isinstance(time_s, float) else 0.0

    def columns(self) -> dict[str, float]:
        """Return the values of a row of samples by column; empty while nothing is known."""
        joints = self.joints
        if joints is None:
            return {}
        row = {f"q{index}": value for index, value in enumerate(joints, 1)}
        speeds = _six(self.values.get("actual_joint_speeds"))
        if speeds is not None:
            row |= {f"qd{index}": value for index, value in enumerate(speeds, 1)}
        pose = self.tcp_pose
        if pose is not None:
            row |= dict(zip(("x", "y", "z", "rx", "ry", "rz"), pose, strict=True))
        moving = _six(self.values.get("actual_TCP_speed"))
        if moving is not None:
            row["speed"] = sum(part * part for part in moving[:3]) ** 0.5
        force = _six(self.values.get("actual_TCP_force"))
        if force is not None:
            row |= dict(zip(("fx", "fy", "fz", "mx", "my", "mz"), force, strict=True))
        return row

    @property
    def tcp_pose(self) -> tuple[float, ...] | None:
        """Pose of the TCP, m and rad, roll-pitch-yaw (*assumed*); None while it is not known."""
        return _six(self.values.get("actual_TCP_pose"))

    def message(self) -> dict[str, Any]:
        """Return the message `moment`; with zeros as long as nothing is known."""
        joints = self.joints or (0.0,) * 6
        line = self.values.get("script_control_line", 0)
        line = max(int(line) - self.line_offset, 0) if isinstance(line, int) else 0
        is_running = self.task_state in (TaskState.PLAYING, TaskState.PAUSED) and not self.is_jogging
        moment: dict[str, Any] = {
            "t": self.time_s,
            "line": line if is_running else 0,
            "joints": joints,
            "tcp_pose": self.tcp_pose or (0.0,) * 6,
            "globals": [
                {"name": name, "value": value, "type": "", "changed": False} for name, value in self.globals.items()
            ],
            "signals": signals_of(self.values),
            "threads": [{"name": "main", "line": line, "waits_for": "", "function": ""}] if is_running else [],
        }
        force = _six(self.values.get("actual_TCP_force"))
        if force is not None:
            moment["tcp_force"] = force
        return {"type": "moment", "moment": moment, "controller": self._controller()}

    def _controller(self) -> dict[str, Any]:
        fraction = self.values.get("target_speed_fraction", 1.0)
        state: dict[str, Any] = {
            "link": self.link,
            "address": self.address,
            "model": self.model,
            "firmware": self.firmware,
            "serial": self.serial,
            "robot_mode": self.robot_mode.name,
            "safety_mode": safety_name(self.safety_mode),
            "task_state": self.task_state.name,
            "program": self.program,
            "speed_fraction": fraction if isinstance(fraction, float) and isfinite(fraction) else 1.0,
            "operation_mode": "remote" if self.is_remote else "local",
        }
        target = _six(self.values.get("target_joint_positions"))
        if target is not None:
            state["target_joints"] = target
        if self.popup is not None:
            state["popup"] = self.popup
        return state


def _six(value: WireValue | None) -> tuple[float, ...] | None:
    """Return six finite numbers; None for anything else."""
    if not isinstance(value, tuple) or len(value) != 6 or not all(map(isfinite, value)):
        return None
    return tuple(map(float, value))


def _mode(kind: type[Kind], value: WireValue | None, unknown: Kind) -> Kind:
    if not isinstance(value, int):
        return unknown
    try:
        return kind(value if value != 0xFF else -1)
    except ValueError:
        return unknown
