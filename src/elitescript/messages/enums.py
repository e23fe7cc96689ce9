"""Modes of robot, safety and task, with the numbers that clients see.

Evidence: *documented* by the vendor's SDK and dashboard pages unless marked otherwise.
"""

from __future__ import annotations

from enum import IntEnum


class Mode(IntEnum):
    """Named numbers whose `repr` is Python, as that of the events that hold them."""

    def __repr__(self) -> str:
        return f"{type(self).__name__}.{self.name}"


class RobotMode(Mode):
    """State of the arm's power and brakes."""

    NO_CONTROLLER = -1
    DISCONNECTED = 0
    CONFIRM_SAFETY = 1
    BOOTING = 2
    POWER_OFF = 3
    POWER_ON = 4
    IDLE = 5
    BACK_DRIVE = 6
    RUNNING = 7
    UPDATING = 8
    WAITING_CALIBRATION = 9


POWERED = frozenset({RobotMode.POWER_ON, RobotMode.BOOTING, RobotMode.IDLE, RobotMode.BACK_DRIVE, RobotMode.RUNNING})
"""Modes in which the arm has power."""


class SafetyMode(Mode):
    """What the safety system allows."""

    NORMAL = 1
    REDUCED = 2
    PROTECTIVE_STOP = 3
    RECOVERY = 4
    SAFEGUARD_STOP = 5
    SYSTEM_EMERGENCY_STOP = 6
    ROBOT_EMERGENCY_STOP = 7
    VIOLATION = 8
    FAULT = 9
    VALIDATE_JOINT_ID = 10
    UNDEFINED = 11
    AUTOMATIC_MODE_SAFEGUARD_STOP = 12
    SYSTEM_THREE_POSITION_ENABLING_STOP = 13
    TP_THREE_POSITION_ENABLING_STOP = 14


class TaskState(Mode):
    """State of the program."""

    UNKNOWN = 0
    PLAYING = 1
    PAUSED = 2
    STOPPED = 3


class AnalogDomain(Mode):
    """Electrical meaning of an analog channel (manual, I/O chapter)."""

    CURRENT = 0
    """4 to 20 mA."""
    VOLTAGE = 1
    """0 to 10 V."""


class RunstateChoice(Mode):
    """Level of an output while no program runs (manual, `set_runstate_..._to_value`)."""

    KEEP = 0
    LOW_WHEN_STOPPED = 1
    HIGH_WHEN_STOPPED = 2
    FOLLOW = 3
    """Low while no program runs, high while one runs."""


class ToolPinMode(Mode):
    """Driver of a tool digital pin (manual 2.14, `set_tool_digital_io_config`)."""

    PUSH_PULL = 0
    PNP = 1
    NPN = 2


class PulseDecoder(Mode):
    """Which edges of an incremental encoder count (manual 2.14, 3.1.25)."""

    QUADRATURE = 1
    """All edges of two channels, which also give the direction."""
    EDGES = 2
    """Both edges of one channel."""
    RISING = 3
    FALLING = 4


class DiscardReason(Mode):
    """Why a statement of interpreter mode will not run; the numbers are ours."""

    COMPILE_ERROR = 1
    INVALID_STATE = 2
    """No program runs."""
    TOO_MANY = 3
    """Too many statements wait."""
    CLEARED_BEFORE = 4
    """It waited when a session began that clears the queue."""
    CLEARED_AT_END = 5
    """It waited when the session ended."""
    CLEARED = 6
    """It waited when `clear_interpreter()` was executed."""


class ChannelError(Mode):
    """Why a channel does not open or breaks: errno of Linux, which programs see."""

    BARRED = -2
    """The options of the robot do not let it through: it goes on as if there were no host at the address."""
    NOTHING_BOUND = -1
    """Nothing is bound to the serial port: it opens all the same, and is silent."""
    OTHER = 5
    BROKEN_PIPE = 32
    NETWORK_UNREACHABLE = 101
    RESET = 104
    """Also when the peer closes."""
    TIMED_OUT = 110
    REFUSED = 111
    HOST_DOWN = 112
    HOST_UNREACHABLE = 113
    """Also for an unknown address."""
