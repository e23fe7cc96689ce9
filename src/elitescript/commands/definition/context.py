"""Interfaces that a command's body may use.

`Machine` is the controller in this tick; `Robot` is the machine together with the running program,
as one script thread sees them. The controller implements the first and the runtime the second; a
test needs neither.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from elitescript.kinematics.arm import Arm
from elitescript.messages.events import Event
from elitescript.messages.line import LineSettings
from elitescript.messages.machine import MachineRequest
from elitescript.messages.motion import DriveRequest, MicroLine, MotionRequest, MoveRequest, Six, TrackRequest
from elitescript.messages.path_offset import OffsetFrame, PathOffsetRequest
from elitescript.messages.profile import Profile
from elitescript.messages.signals import Value
from elitescript.messages.state import JointState, Payload, Poses, TcpSpeeds
from elitescript.messages.yielding import YieldRequest

if TYPE_CHECKING:
    from elitescript.commands.definition.plausibility import Doubt
    from elitescript.commands.socket_rules import Variable
    from elitescript.messages.observations import Observation


class Machine(Protocol):
    """The controller between two ticks. Reading and `write` cost little; other changes are requests."""

    @property
    def tick(self) -> int: ...

    @property
    def arm(self) -> Arm: ...

    @property
    def joint_ranges(self) -> tuple[tuple[float, float], ...]:
        """Six pairs of lowest and highest joint position, rad."""

    @property
    def payload_max_kg(self) -> float: ...

    @property
    def default_motion(self) -> tuple[float, float, float, float]:
        """Joint acceleration, joint speed, tool acceleration, tool speed that a 0 in a program stands for."""

    @property
    def tcp_offset(self) -> Six: ...

    @property
    def payload(self) -> Payload: ...

    @property
    def target_waypoint(self) -> Six:
        """Pose of the waypoint that the arm moves to, or moved to last."""

    @property
    def joint_temperatures(self) -> Six:
        """degC."""

    @property
    def controller_temperature(self) -> float:
        """degC."""

    def joints(self) -> JointState:
        """Return the target and actual joints of this tick."""

    def joint_torques(self) -> Six:
        """Return torques of this tick without those that the arm needs to carry and to move itself, N m."""

    def tcp_wrench(self, is_compensated: bool) -> Six:
        """Return the external wrench at the TCP in this tick, in its frame: N, N m.

        Args:
            is_compensated: without the payload and less the zero of the sensor.
        """

    def path_offset_along(self, frame: OffsetFrame) -> Six:
        """Return the path offset of this tick, along and about the axes of a frame: m, rad."""

    def tcp_pose_along_path(self) -> Six:
        """Return the target pose of the TCP in this tick without the path offset."""

    def poses(self) -> Poses:
        """Return the poses of TCP and flange in this tick."""

    def tcp_speeds(self) -> TcpSpeeds:
        """Return the velocities of the TCP in this tick."""

    def is_within_safety_limits(self, q: Six, pairs: Sequence[bool] | None = None) -> bool:
        """Return whether joints (rad) respect the joint ranges and the safety limits of position.

        Args:
            q: the joints.
            pairs: for each pair of configurable inputs, whether its planes count; by their levels if None.
        """

    def read(self, name: str, index: int = 0) -> Value:
        """Return one point of the signal image; see `messages.signals`."""

    def write(self, name: str, index: int, value: Value) -> None:
        """Set one point of the signal image.

        Raises:
            ScriptError: out of range, or a tool pin that is no output; nothing has changed.
        """

    def tool_pin(self, index: int) -> bool:
        """Return the level of a tool pin as its configuration makes it: the driven or the applied one."""

    def port_register(self, address: int, version: tuple[int, ...]) -> int:
        """Return a register of the controller's own Modbus server, 0 to 65535.

        Args:
            address: of the register, 0 to 511.
            version: of the controller: major, minor, bug fix.
        """

    def port_coil(self, address: int) -> bool:
        """Return a coil of the controller's own Modbus server, 0 to 127."""

    def encoder_count(self, index: int) -> float:
        """Return the count of a conveyor encoder."""

    def encoder_unwound(self, index: int, delta: float) -> float:
        """Return a difference of two counts of an encoder, without the overflow of its counter."""

    def timestamp_s(self) -> float:
        """Return the controller's clock, seconds since 1970."""

    def request_motion(self, request: MotionRequest | TrackRequest | YieldRequest, line: int, thread: str) -> int:
        """Begin to move (or to brake) at this tick; return the number of the move.

        Raises:
            ScriptError: the arm cannot or may not do it; nothing has changed.
        """

    def request_path_offset(self, request: PathOffsetRequest, line: int, thread: str) -> None:
        """Shift the motion by an offset from this tick on, or set how that is done.

        Raises:
            ScriptError: the arm may not move, or is guided by hand; nothing has changed.
        """

    def is_move_done(self, move: int) -> bool: ...

    def cancel_move(self, move: int) -> None:
        """Brake the move, if it is the active one: its thread was stopped."""

    def request(self, request: MachineRequest) -> None:
        """Change the machine without moving it.

        Raises:
            ScriptError: the request makes no sense now; nothing has changed.
        """

    def emit(self, event: Event) -> None:
        """Record an event."""

    def observe(self, seen: Observation) -> None:
        """Hand an observation to the observers of the run."""


Rule = Callable[[bytearray, bool], tuple[Any, int]]
"""Reads from the begin of what a connection has received; see `socket_rules`.

The second argument is True if no more bytes will come; then there must be a result. Returns the result, or None if more
is needed, and how many bytes are used up.
"""


class SocketAccess(Protocol):
    """The TCP connections of a program, by name."""

    def open(self, address: str, port: int, name: str) -> bool:
        """Connect to a server within 2 s; return whether the connection is open."""

    def close(self, name: str) -> None:
        """Close a connection; no effect on an unknown one."""

    def is_connected(self, name: str) -> bool:
        """Return whether a connection is open."""

    def send(self, name: str, data: bytes, *, is_text: bool = False) -> bool:
        """Send bytes, which may be those of a text; return whether the connection is open."""

    def ask(self, name: str, question: bytes, rule: Variable, timeout_s: float) -> int:
        """Send a question and return the number in its answer; 0 without one."""

    def read(self, name: str, rule: Rule, timeout_s: float) -> Any:
        """Return what a rule finds, waiting at most `timeout_s`; 0 and less wait for ever."""


class SerialLineAccess(Protocol):
    """Give access to the serial ports, `tool` or that of the control box (`runtime.connections.serial_lines`)."""

    def enable(self, device: str, settings: LineSettings, *, is_modbus: bool, is_daemons: bool = False) -> bool:
        """Open a port, or open it anew; return whether it is open."""

    def disable(self, device: str) -> None:
        """Close a port; no effect on a closed one."""

    def is_open(self, device: str) -> bool:
        """Return whether a port is enabled."""

    def open_devices(self) -> list[str]:
        """Return the devices of the enabled ports, sorted."""

    def mode(self, device: str) -> str:
        """Return `RS485`, `MODBUS-RTU` or `CLOSE`."""

    def read(self, device: str, count: int, timeout_s: float) -> bytes:
        """Read bytes, fewer after the timeout; 0 s and less wait for ever.

        Raises:
            ScriptPermissionError: the port belongs to a daemon; so for all that follow.
        """

    def write(self, device: str, data: bytes, *, is_text: bool = False) -> int | None:
        """Send bytes, of a text if `is_text`; return how many were sent, None if the port is not open in plain mode."""

    def flush(self, device: str) -> None:
        """Drop received bytes that are not read."""

    def read_slave(
        self, device: str, slave: int, function: int, address: int, count: int, timeout_s: float, *, is_polled: bool
    ) -> tuple[int, ...] | None:
        """Read values of a slave with function 1 to 4; return None if that fails. `is_polled`: no wait in a `sec`."""

    def write_slave(
        self,
        device: str,
        slave: int,
        function: int,
        address: int,
        values: tuple[int, ...],
        timeout_s: float,
        *,
        is_polled: bool,
    ) -> bool:
        """Write values to a slave with function 5, 6, 15 or 16; return whether it accepted them; see `read_slave`."""


class ModbusSignalAccess(Protocol):
    """The MODBUS TCP signals of the controller, by name.

    The name of an unknown signal raises `InvalidValueError`; the use of one that has not worked for longer than its
    watchdog allows raises `ScriptStateError`, code R134.
    """

    def add(
        self, address: str, port: int, name: str, kind: int, slave: int, first: int, count: int, *, is_sequential: bool
    ) -> None:
        """Add a signal that reads or writes coils or registers, of the kind that `modbus_add_signal` names.

        Raises:
            ScriptStateError: there are too many.
        """

    def add_read_write(
        self,
        address: str,
        port: int,
        name: str,
        slave: int,
        read: tuple[int, int],
        write: tuple[int, int],
        *,
        is_sequential: bool,
    ) -> None:
        """Add a signal that reads and writes registers; `read` and `write` are first register and count.

        Raises:
            ScriptStateError: there are too many.
        """

    def delete(self, name: str) -> None:
        """Remove a signal."""

    def status(self, name: str) -> bool | int | tuple[bool, ...] | tuple[int, ...]:
        """Return the value of a signal: a tuple if it has several coils or registers."""

    def set(self, name: str, values: tuple[int, ...], *, is_digital: bool) -> None:
        """Set an output; of each value of a register, the low 16 bits count.

        Raises:
            InvalidValueError: it is none of that sort, or has fewer coils or registers.
        """

    def tie(self, name: str, choice: int) -> None:
        """Tie a digital output to whether a program runs.

        Raises:
            InvalidValueError: it is no digital output.
        """

    def retime(self, name: str, frequency_hz: int) -> None:
        """Change how often a signal is requested."""

    def set_watchdog(self, name: str, timeout_s: float) -> None:
        """Change how long a signal may be faulty before its use is an alarm."""

    def errors(self, name: str) -> tuple[int, int]:
        """Return the error code of the device and the error number of the connection."""

    def invalid_s(self, name: str) -> float:
        """Return the time since a faulty signal worked; 0 for one that does."""

    def request(self, address: str, port: int, slave: int, function: int, data: bytes, *, is_once: bool) -> None:
        """Send a request once, or repeatedly.

        Raises:
            ScriptStateError: too many requests are queued, or there are too many signals.
        """

    def reset(self, address: str, port: int, *, waits: bool) -> None:
        """Connect anew; a thread may wait for the outcome, a secondary program does not.

        Raises:
            InvalidValueError: no signal uses that connection.
        """


class Robot(Protocol):
    """Machine and program, as the calling script thread sees them."""

    @property
    def machine(self) -> Machine: ...

    @property
    def profile(self) -> Profile: ...

    @property
    def is_secondary(self) -> bool:
        """Whether the caller is a secondary program (`sec`)."""

    @property
    def task_path(self) -> str:
        """Virtual path of the task folder, ending in `/`."""

    @property
    def sockets(self) -> SocketAccess:
        """The program's TCP connections."""

    def remote_procedures(self, url: str) -> object:
        """Return an object whose methods are the procedures of an XML-RPC server.

        Raises:
            InvalidValueError: the URL is not valid.
        """

    @property
    def lines(self) -> SerialLineAccess:
        """The serial ports of the robot."""

    @property
    def modbus(self) -> ModbusSignalAccess:
        """The MODBUS TCP signals of the controller."""

    @property
    def micro_lines(self) -> list[MicroLine]:
        """The point files that the program has loaded, by index."""

    def read_task_file(self, path: str, size_max: int) -> bytes:
        """Read a file of the task folder.

        Raises:
            InvalidValueError: there is no such file, it cannot be read or has more bytes than that.
            ScriptPermissionError: the path leads out of the task folder.
        """

    def move(self, request: MoveRequest | DriveRequest | YieldRequest) -> None:
        """Request a motion and wait until its call is over; for a move, until it ends."""

    def track(self, request: TrackRequest) -> None:
        """Begin to track a conveyor, or end that and wait for standstill."""

    def shift(self, request: PathOffsetRequest) -> None:
        """Shift the motion by an offset, or set how that is done; returns at once."""

    def stop_motion(self, request: MotionRequest | YieldRequest) -> None:
        """Request a stop and wait for standstill."""

    def request(self, request: MachineRequest) -> None:
        """Change the machine without moving it."""

    def wait_ticks(self, count: int) -> None:
        """Wait `count` ticks; 0 returns at once."""

    def start_thread(self, function: Callable[..., Any], args: tuple[Any, ...], name: str) -> int:
        """Start a script thread in this tick, after the threads that run already; return its handle (never 0).

        Raises:
            ScriptStateError: too many threads (code R121).
        """

    def join_thread(self, handle: int) -> None:
        """Wait for a thread; returns at once for 0, an unknown or a finished one.

        Raises:
            ScriptStateError: a thread cannot wait for itself.
        """

    def stop_thread(self, handle: int) -> None:
        """End a thread where it stands; no effect on 0, an unknown or a finished one."""

    def message(self, text: str) -> None:
        """Write one entry in the robot's log."""

    def popup(self, text: str, title: str, level: str, *, is_blocking: bool) -> None:
        """Show a message window; wait for its confirmation when it blocks."""

    def warn_once(self, key: str, text: str, *, code: str = "", hint: str = "") -> None:
        """Record a warning, once in a program for each `key`."""

    def mistaken(self, meaning: str, value: Six) -> Doubt | None:
        """Return the doubt about joint positions where a pose belongs, or the reverse, if a command returned them.

        Args:
            meaning: of the parameter.
            value: of the argument.
        """

    def note_missing(self, command: str, came: int, number: int) -> None:
        """Keep that the values which a reading gives are not all there: nan stands for the others.

        Args:
            command: that has read.
            came: how many have come.
            number: how many were asked for.
        """

    def remember(self, kind: str, value: Six) -> None:
        """Keep what a command returns, `joints` or a `pose`, for `mistaken`."""

    def hold_doubts(self, doubts: Sequence[Doubt]) -> None:
        """Keep doubts about the present call until it is accepted; replaces those before."""

    def tell_doubts(self) -> None:
        """Record the held doubts as warnings, each once for a line."""

    def random(self) -> float:
        """Return the next number in [0, 1) of the program's seeded generator."""

    def pause(self) -> None:
        """Pause the task until it is resumed."""

    def halt(self) -> None:
        """Stop the task; does not return."""

    def enter_interpreter(self, *, clears_queue: bool, clears_at_end: bool) -> None:
        """Run statements of clients until the session ends.

        Raises:
            ScriptStateError: not the main thread, or a session runs already.
        """

    def end_interpreter(self) -> None:
        """End the session of interpreter mode, if one runs."""

    def clear_interpreter(self) -> None:
        """Drop the queued statements and the definitions of earlier ones."""

    def watch(self, variable: str, frequency_hz: float, action: str) -> None:
        """Watch an RTSI input until the program ends.

        Raises:
            InvalidValueError: there is no such input.
        """

    def mark(self, number: int, label: str) -> None:
        """Record the node of the program tree that was reached."""
