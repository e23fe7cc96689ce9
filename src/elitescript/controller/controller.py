"""Runs the virtual controller: one tick at a time, or straight to the next tick that is due.

`run_tick` lists the phases of a control period. Between two ticks that are due, the machine is a function of time:
getters and traces sample it, and a leap gives the same as the ticks that it leaves out.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from math import dist
from typing import TYPE_CHECKING, Any, Final

from elitescript.controller.arm.cartesian_state import CartesianStateFinder
from elitescript.controller.arm.joint_encoders import JointEncoders
from elitescript.controller.arm.joint_loads import JointLoads
from elitescript.controller.arm.plant import LaggingJoints
from elitescript.controller.arm.state import ArmState, Correction
from elitescript.controller.force.compliance_control import YIELD_SETTINGS, ComplianceControl
from elitescript.controller.force.contact import ContactConfig
from elitescript.controller.force.yielding_correction import Caller
from elitescript.controller.modes import AT_ONCE, WHY_NOT_READY, Power, PowerTimes
from elitescript.controller.motion.control import MotionControl, motion_limits
from elitescript.controller.motion.conveyor_encoders import ENCODER_HANDLERS, SPEED_SIGNAL
from elitescript.controller.motion.conveyor_tracking import Tracking
from elitescript.controller.motion.path_offset import PathOffset
from elitescript.controller.request_queue import RequestQueue
from elitescript.controller.safety.arm_watch import ArmWatch
from elitescript.controller.safety.control import SafetyControl
from elitescript.controller.safety.force_watch import ForceWatch
from elitescript.controller.safety.limits import SafetyLimits
from elitescript.controller.safety.monitor import SafetyMonitor
from elitescript.controller.safety.reduced_speed import ReducedSpeed
from elitescript.controller.signals.image import SIGNAL_SETTINGS, TOOL_PIN_IN, SignalImage
from elitescript.controller.tasks import ProgramPort, Task
from elitescript.controller.tool_setup import SETUP_HANDLERS, Setup
from elitescript.errors import MotionError, ScriptStateError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.rotations import Vector3
from elitescript.kinematics.tcp import tcp_pose
from elitescript.messages.enums import RobotMode, TaskState
from elitescript.messages.events import (
    Change,
    Event,
    LineMarked,
    RobotModeChanged,
    TaskStateChanged,
    Warned,
    event_of,
)
from elitescript.messages.machine import (
    AskSafety,
    DisturbInput,
    EndInputFaults,
    MachineRequest,
    PauseTask,
    PowerDown,
    PowerOff,
    PowerOn,
    ReleaseBrakes,
    ResumeTask,
    SetLineMark,
    SetSpeedScale,
    StopTask,
    WritePortCoils,
    WritePortRegisters,
    WriteSignal,
)
from elitescript.messages.motion import MotionRequest, Six, StopJ, StopL, StopTracking, TrackRequest
from elitescript.messages.path_offset import OffsetFrame, PathOffsetRequest
from elitescript.messages.plant import PlantConfig
from elitescript.messages.signals import SIGNALS, Value, signal_name
from elitescript.messages.state import JointState, Payload, Poses, RobotState, TcpSpeeds
from elitescript.messages.timing import seconds
from elitescript.messages.yielding import EndForceMode, EndFreedrive, YieldRequest
from elitescript.models.model import RobotModel
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.speed import SpeedProfile
from elitescript.said import Said, said

if TYPE_CHECKING:
    from elitescript.controller.signals.signal_watch import SignalWatch
    from elitescript.messages.observations import Observation
    from elitescript.modbus.port_image import PortImage

PROGRAM: Final = "program"
"""`SignalChanged.by` of changes that no request from outside has caused."""

FAULT: Final = "fault"
"""`SignalChanged.by` of a level that an input reads because of a fault."""

STOPS: Final = (StopJ, StopL, StopTracking, EndForceMode, EndFreedrive)
"""Requests that only end a motion or mode; they are also accepted by an arm that rests without power."""


_NO_CHANGE: Final[Change] = (-1, "", 0, False, "", 0)


class Controller:
    """One robot: arm, signals, power, task. Implements `commands.definition.context.Machine`.

    Args:
        model: the arm.
        epoch_s: the controller's clock at tick 0, seconds since 1970.
        on_event: receives every event in order.
        on_change: receives the changes of signals instead of `on_event`; that gets their events if None.
        on_observation: receives what observers of a run may see.
        home: joint positions at the start, rad; the model's home if None.
        speed_scale: speed percentage at the start, as a fraction.
        contact: what the TCP can touch; nothing if None.
        safety: limits of the safety system.
        plant: dynamics of the joints; exact if None.
        is_powered: whether power is on and the brakes are open at the start.
        power_times: durations of powering on and releasing the brakes.
    """

    __slots__ = (
        "_by",
        "_cartesian",
        "_ending",
        "_epoch_s",
        "_inbox",
        "_joint_encoders",
        "_model",
        "_node",
        "_on_change",
        "_on_event",
        "_on_observation",
        "_tick",
        "_unseen",
        "_watch",
        "_written",
        "arm",
        "arm_state",
        "joint_ranges",
        "loads",
        "motion",
        "path_offset",
        "power",
        "requests",
        "safety",
        "setup",
        "signals",
        "task",
        "tracking",
        "yielding",
    )

    def __init__(
        self,
        model: RobotModel,
        *,
        epoch_s: float,
        on_event: Callable[[Event], None],
        on_change: Callable[[Change], None] | None = None,
        on_observation: Callable[[Observation], None] = lambda seen: None,
        home: Six | None = None,
        speed_scale: float = 1.0,
        contact: ContactConfig | None = None,
        safety: SafetyLimits | None = None,
        plant: PlantConfig | None = None,
        is_powered: bool = True,
        power_times: PowerTimes = AT_ONCE,
    ) -> None:
        plant = PlantConfig() if plant is None else plant
        self._ending = ""
        self._by = PROGRAM
        self._model = model
        self.arm: Arm = model.arm
        self._cartesian = CartesianStateFinder(model.arm)
        self.joint_ranges: tuple[tuple[float, float], ...] = model.joint_ranges
        self._epoch_s = epoch_s
        self._on_event = on_event
        self._on_observation = on_observation
        self._on_change = on_change or (lambda change: on_event(event_of(change)))
        self._tick = 0
        self.requests = 0
        """Requests that were carried out, or refused, since the start."""
        self._inbox = RequestQueue()
        self._watch: SignalWatch | None = None
        """From the first change of a signal on."""
        self._unseen: dict[tuple[str, int], int] = {}
        """See `SignalWatch.inputs`."""
        self._written: dict[str, tuple[list[Change], list[Value]]] = {}
        """Of outputs that the program has changed, by family and index: the last change, and the level before the
        first change in its tick."""
        self.signals = SignalImage(self._signal_changed, self._write_overridden)
        mode = RobotMode.RUNNING if is_powered else RobotMode.POWER_OFF
        self.power = Power(lambda mode: on_event(RobotModeChanged(self._tick, mode)), mode, power_times)
        self.task = Task(self._task_changed)
        limits = motion_limits(model)
        self.motion = MotionControl(
            model.arm,
            limits,
            model.home if home is None else home,
            model.stop_joint_deceleration,
            model.speed_ramp_s,
            self._motion_event,
            self._motion_ended,
        )
        self.motion.set_speed_scale(speed_scale, 0)
        self.tracking = Tracking(model, limits, self.motion.take_over, on_event)
        self.setup = Setup(model)
        self.yielding = ComplianceControl(
            model, limits, self.setup, self.signals, contact, on_event, self._motion_ended
        )
        self.path_offset = PathOffset(
            model.arm, limits, model.stop_joint_deceleration, self.setup, self._unshifted, self._halt, on_event
        )
        joints = LaggingJoints(plant, limits.qd_max) if plant.lag_s > 0.0 else None
        corrections: tuple[Correction, ...] = (self.tracking, self.path_offset, *self.yielding.corrections)
        self.arm_state = ArmState(self.motion, corrections, joints)
        self._joint_encoders = JointEncoders(plant.noise_rad, plant.seed)
        self._node: tuple[int, str] = (0, "")
        self.loads = JointLoads(model, plant, self.arm_state, self.setup)
        monitor = SafetyMonitor(model.arm, safety or SafetyLimits())
        force = ForceWatch(monitor, self.yielding.sensor)
        watch = ArmWatch(monitor, limits, self.arm_state, self.setup, self.signals, force)
        speed = ReducedSpeed(monitor, self.motion, self.yielding, self.setup, speed_scale)
        self.safety = SafetyControl(watch, speed, self.task, on_event, self.switch_off)
        for part in (self.motion, self.tracking, self.path_offset):
            part.on_obstacle = self.safety.meet_obstacle
        for observed in (self.motion, self.tracking, self.yielding):
            observed.observe = on_observation

    def attach(self, program: ProgramPort) -> None:
        """Set the host of scripts."""
        self.task.program = program

    # ---------------------------------------------------------------- time

    @property
    def tick(self) -> int:
        """Ticks since the start."""
        return self._tick

    def run_tick(self, take: Callable[[], None] = lambda: None) -> None:
        """Run all phases of the present tick; `leap` then goes on to the next one.

        Args:
            take: called in the inbox phase, after the requests that were `put` for this tick.
        """
        self.arm_state.settle(self._tick)
        faults = self.signals.faults
        if faults is not None and faults.run_tick(self._tick):
            self.guide_by_input()
        self._inbox.deliver(self._tick, self.request_from, self.emit)
        take()
        self.safety.check(self._tick)
        self.power.go_on(self._tick)
        if self.power.is_going_off:
            self.power.settle(self.arm_state.is_moving)
        self.task.program.run_tick(self._tick)

    def next_tick(self) -> int | None:
        """Return the next tick at which anything is due; None if nothing will happen by itself."""
        tick = self._tick
        # In the order in which the next tick is due most often: nothing else matters then.
        due_program = self.task.program.next_tick(tick)
        if due_program == tick + 1:
            return due_program
        due_arm = self.arm_state.next_tick
        if due_arm == tick + 1 or self.safety.next_tick(tick) is not None:
            return tick + 1
        due = due_program, due_arm, self._inbox.next_tick, self.power.next_tick, self._fault_tick
        ticks = [at for at in due if at is not None]
        return max(min(ticks), tick + 1) if ticks else None

    @property
    def is_idle(self) -> bool:
        """Whether nothing but an arm at standstill can be due; see `ArmState.is_standing`."""
        # What costs least comes first: the joints are computed only if all else is idle.
        return (
            self.motion.next_tick is None
            and self._inbox.next_tick is None
            and self._fault_tick is None
            and self.task.program.next_tick(self._tick) is None
            and self.arm_state.is_standing
        )

    @property
    def _fault_tick(self) -> int | None:
        """Next tick at which a fault of an input takes effect."""
        return None if self.signals.faults is None else self.signals.faults.next_tick

    def leap(self, tick: int) -> None:
        """Go to a tick that is not later than the next one at which anything is due."""
        self.loads.leap(tick)
        self._tick = tick

    def put(self, tick: int, request: MachineRequest, by: str = "client") -> None:
        """Queue a request from outside for a tick, not before the present one; a refusal becomes a warning."""
        self._inbox.put(max(tick, self._tick), request, by)

    def next_write(self, family: str, index: int) -> int | None:
        """Return the earliest tick at which a queued request sets a point; None if none does."""
        return self._inbox.next_write(family, index)

    # ---------------------------------------------------------------- reading

    @property
    def payload_max_kg(self) -> float:
        """Rated payload of the model."""
        return self._model.payload_max_kg

    @property
    def default_motion(self) -> tuple[float, float, float, float]:
        """Joint acceleration, joint speed, tool acceleration, tool speed when a program gives none."""
        model = self._model
        return (
            model.default_joint_acceleration,
            model.default_joint_speed,
            model.default_tool_acceleration,
            model.default_tool_speed,
        )

    @property
    def tcp_offset(self) -> Six:
        """Active TCP in the flange frame."""
        return self.setup.tcp_offset

    @property
    def payload(self) -> Payload:
        """Payload that was set last."""
        return self.setup.payload

    @property
    def target_waypoint(self) -> Six:
        """Pose of the last waypoint; before any move the present target pose."""
        return self.motion.waypoint or self.tcp_pose(self.joints().q_target)

    @property
    def joint_temperatures(self) -> Six:
        """Joint temperatures, degC; see `arm.thermal_model`."""
        return self.loads.temperatures(self._tick)[0]

    @property
    def controller_temperature(self) -> float:
        """Temperature of the control box, degC; see `arm.thermal_model`."""
        return self.loads.temperatures(self._tick)[1]

    def is_within_safety_limits(self, q: Six, pairs: Sequence[bool] | None = None) -> bool:
        """See `commands.definition.context.Machine.is_within_safety_limits`."""
        return self.safety.is_within(q, pairs)

    @property
    def robot_mode(self) -> RobotMode:
        """Power and brakes."""
        return self.power.mode

    @property
    def task_state(self) -> TaskState:
        """State of the program."""
        return self.task.state

    @property
    def line(self) -> int:
        """Line of the main thread; 0 without a program."""
        return self.task.program.line

    @property
    def is_moving(self) -> bool:
        """Whether a move is under way."""
        return self.arm_state.is_moving

    @property
    def speed_scale(self) -> float:
        """Speed percentage as a fraction."""
        return self.safety.speed_scale

    def joints(self) -> JointState:
        """Return the target and measured joints of the present tick."""
        return self.joints_at(self._tick)

    def joint_torques(self) -> Six:
        """Return the torques of this tick less those that the arm alone needs, N m."""
        return self.loads.remaining_torques(self._tick)

    @property
    def is_plant_ideal(self) -> bool:
        """Whether actual always equals target."""
        return self._joint_encoders.is_exact and not self.arm_state.has_plant

    @property
    def is_resting(self) -> bool:
        """Whether every tick looks the same until something is due."""
        return self.arm_state.is_resting and self._joint_encoders.is_exact

    def tcp_wrench(self, is_compensated: bool) -> Six:
        """Return the wrench on the TCP in this tick, TCP frame; see `wrench_sensor`."""
        return self.yielding.wrench(self.arm_state, self._tick, is_compensated)

    def tcp_wrenches(self) -> tuple[Six, Six]:
        """Return both wrenches of `tcp_wrench`: the compensated one, and the one as the sensor measures it."""
        return self.yielding.wrenches(self.arm_state, self._tick)

    def turned(self, begin: int, end: int) -> Six | None:
        """Return how far each joint of the target turns between two ticks, rad; see `MotionControl.turned`."""
        return self.arm_state.turned(begin, end)

    def tool_way(self, begin: int, end: int) -> tuple[float, float, Vector3] | None:
        """Return how far TCP goes, m, and tool turns, rad, between two ticks, and the TCP; see `Move.tool_way`."""
        return self.arm_state.tool_way(begin, end)

    def course(self, begin: int, end: int) -> Hashable | None:
        """Return what the target joints between two ticks follow from, None if not known; see `Move.course`."""
        return self.arm_state.course(begin, end)

    def targets_at(self, ticks: range) -> list[tuple[Six, Six]]:
        """Return the target joints, rad, and their speeds, rad/s, from the present tick to the next that is due."""
        return self.arm_state.targets(ticks)

    def joints_at(self, tick: int) -> JointState:
        """Return the target and measured joints at a tick, from the present one to the next that is due."""
        return self._joint_encoders.read(tick, self.arm_state.joints(tick))

    def tcp_pose(self, q: Six) -> Six:
        """Return the pose of the active TCP at joint positions, base frame."""
        return tcp_pose(self.arm, q, self.setup.T_flange_tcp)

    def path_offset_along(self, frame: OffsetFrame) -> Six:
        """See `commands.definition.context.Machine.path_offset_along`."""
        return self.path_offset.offset(frame)

    def tcp_pose_along_path(self) -> Six:
        """See `commands.definition.context.Machine.tcp_pose_along_path`."""
        joints = self.joints()
        return self.tcp_pose(self.path_offset.without(Setpoint(joints.q_target, joints.qd_target)).q)

    def state_at(self, tick: int) -> RobotState:
        """Return the state of the machine at a tick, as `joints_at`."""
        joints = self.joints_at(tick)
        return self.state_of(tick, joints, self.poses_of(joints), self.tcp_speeds_of(joints))

    def poses(self) -> Poses:
        """Return the poses of TCP and flange in the present tick."""
        return self.poses_of(self.joints())

    def tcp_speeds(self) -> TcpSpeeds:
        """Return the velocities of the TCP in the present tick."""
        return self.tcp_speeds_of(self.joints())

    def poses_of(self, joints: JointState) -> Poses:
        """Return the poses of TCP and flange for joints."""
        return self._cartesian.poses(joints, self.setup.T_flange_tcp)

    def tcp_speeds_of(self, joints: JointState) -> TcpSpeeds:
        """Return the velocities of the TCP for joints."""
        return self._cartesian.speeds(joints, self.setup.T_flange_tcp)

    def state_of(self, tick: int, joints: JointState, poses: Poses, speeds: TcpSpeeds) -> RobotState:
        """Return the state of the machine at a tick with these joints, poses and velocities."""
        setup = self.setup
        # By position, in the order of the fields: so many keywords take a microsecond.
        return RobotState(
            tick,
            seconds(tick),  # time_s
            self.power.mode,  # robot_mode
            self.safety.mode,  # safety_mode
            self.task.state,  # task_state
            joints.q_target,
            joints.qd_target,
            joints.q_actual,
            joints.qd_actual,
            setup.tcp_offset,
            poses.target,  # tcp_pose_target
            poses.actual,  # tcp_pose_actual
            speeds.target,  # tcp_speed_target
            speeds.actual,  # tcp_speed_actual
            poses.flange,  # flange_pose_actual
            setup.payload,
            setup.gravity,
            self.safety.speed_scale,
            self.arm_state.is_moving,
            self.task.program.line,
            self._node,
        )

    def state(self) -> RobotState:
        """Return the state of the machine at the present tick."""
        return self.state_at(self._tick)

    def read(self, name: str, index: int = 0) -> Value:
        """Return the level of a signal."""
        if self._unseen:
            self._look(name, index)
        return self.signals.read(name, index)

    def _watching(self) -> SignalWatch:
        if self._watch is None:
            # Imported late: many programs change no signal.
            from elitescript.controller.signals.signal_watch import SignalWatch

            self._watch = SignalWatch(self._on_observation, self._unseen, lambda: self.task.program)
        return self._watch

    def _look(self, name: str, index: int) -> None:
        self._watching().looked((name, index), self._tick)

    def port_register(self, address: int, version: tuple[int, ...]) -> int:
        """See `commands.definition.context.Machine.port_register`."""
        return self.port_image(version).registers(address, 1)[0]

    def port_coil(self, address: int) -> bool:
        """See `commands.definition.context.Machine.port_coil`."""
        return self.port_image(()).coils(address, 1)[0]

    def port_image(self, version: tuple[int, ...]) -> PortImage:
        """Return the registers and coils of the controller's own Modbus server at this moment.

        Args:
            version: of the controller: major, minor, bug fix.
        """
        # Imported late: few programs read them.
        from elitescript.controller.signals.modbus_access import LivePortSource
        from elitescript.modbus.port_image import PortImage
        from elitescript.modbus.port_map import View

        source = LivePortSource(self._tick, self.state, self.power, self.loads, self.signals)
        return PortImage(View(source, version))

    def tool_pin(self, index: int) -> bool:
        """Return the level of a tool pin."""
        if self._unseen:
            self._look(TOOL_PIN_IN, index)
        return self.signals.tool_pin(index)

    def non_default_signals(self) -> dict[str, Value]:
        """Return every signal that is not at its default, by name."""
        return self.signals.non_defaults()

    def encoder_count(self, index: int) -> float:
        """Return the count of a conveyor encoder."""
        return self.tracking.encoders[index].count(self._tick)

    def encoder_unwound(self, index: int, delta: float) -> float:
        """Return a difference of two counts of an encoder, without the overflow of its counter."""
        return self.tracking.encoders[index].range.unwound(delta)

    def timestamp_s(self) -> float:
        """Return the controller's clock, seconds since 1970."""
        return self._epoch_s + seconds(self._tick)

    # ---------------------------------------------------------------- requests

    def request_motion(self, request: MotionRequest | TrackRequest | YieldRequest, line: int, thread: str) -> int:
        """See `commands.definition.context.Machine.request_motion`."""
        if not (isinstance(request, STOPS) and self.arm_state.is_resting):
            self.power.require_ready()
            self.safety.require("move")
        T_flange_tcp = self.setup.T_flange_tcp
        if isinstance(request, YieldRequest) or self.yielding.is_ended_by(request):
            if isinstance(request, YieldRequest):
                self.safety.note_yielding(request, self._tick, line, thread)
            is_moving = self.motion.is_moving or self.tracking.is_active or self.path_offset.is_active
            return self.yielding.request(request, self._tick, is_moving, Caller(line, thread))
        if isinstance(request, TrackRequest):
            nominal = self.motion.setpoint(self._tick)
            return self.tracking.request(request, self._tick, nominal, T_flange_tcp, line, thread)
        return self.motion.request(request, self._tick, T_flange_tcp, line, thread)

    def request_path_offset(self, request: PathOffsetRequest, line: int, thread: str) -> None:
        """See `commands.definition.context.Machine.request_path_offset`."""
        self.power.require_ready()
        self.safety.require("move")
        if self.yielding.is_guiding:
            raise MotionError(
                "a path offset is not possible while the arm is guided by hand",
                code="R114",
                hint="call end_freedrive_mode first",
            )
        self.path_offset.request(request, self._tick, line, thread)

    def _unshifted(self) -> Setpoint:
        """Return the setpoint that path offsets shift, at the present tick."""
        return self.tracking.setpoint if self.tracking.is_active else self.motion.setpoint(self._tick)

    def _halt(self, braking: SpeedProfile, tick: int, thread: str) -> None:
        """Bring the motion that path offsets shift to rest together with them."""
        self.tracking.abandon(tick)
        self.motion.take_over(braking, tick, thread)

    def is_move_done(self, move: int) -> bool:
        """Return whether that move is over."""
        return self.motion.is_done(move) and self.yielding.is_done(move)

    def cancel_move(self, move: int) -> None:
        """Brake that move, if it is under way."""
        self.motion.cancel(move, self._tick)

    def request(self, request: MachineRequest) -> None:
        """Carry out a request."""
        self.arm_state.step_before_request(self._tick)
        self.requests += 1
        HANDLERS[type(request)](self, request)

    def request_from(self, request: MachineRequest, by: str) -> None:
        """Carry out a request that does not come from the program.

        Args:
            request: the request.
            by: its origin, for the signals that it changes; see `events.SignalChanged.by`.

        Raises:
            ScriptError: the request is not possible now; nothing has changed.
        """
        before, self._by = self._by, by
        try:
            self.request(request)
        finally:
            self._by = before

    def write(self, name: str, index: int, value: Value) -> None:
        """Set one point of the signal image: the request `WriteSignal`, for programs that write in every tick.

        Raises:
            ScriptError: out of range, or a tool pin that is no output; nothing has changed.
        """
        self.signals.write(name, index, value)
        if self.signals.freedrive_inputs:
            self.guide_by_input()

    def emit(self, event: Event) -> None:
        """Record an event."""
        self._on_event(event)

    def observe(self, seen: Observation) -> None:
        """Hand an observation to the observers of the run."""
        self._on_observation(seen)

    # ---------------------------------------------------------------- the task, for the runtime and robot.py

    def power_up(self) -> None:
        """Power on and release the brakes where necessary.

        Raises:
            ScriptStateError: the safety system does not allow it.
        """
        self.safety.require("power_on")
        self.power.go_up(RobotMode.RUNNING, self._tick)

    def task_started(self, name: str) -> None:
        """Begin the task of a program in this tick.

        Raises:
            ScriptStateError: a task is running; nothing has changed.
        """
        self.task.require("start")
        self.task.name = name
        self._node = (0, "")
        self._written.clear()
        if self._watch is not None:
            self._watch.begin_program()
        self.motion.begin_program()
        self.path_offset.begin_program(self._tick)
        self.yielding.begin_program()
        self.task.start()
        self.safety.task_started()

    def task_ended(self, ending: str = "stopped") -> None:
        """End the task: the arm brakes; after a program that has finished it goes on to its waypoint.

        Args:
            ending: `finished`, `alarm` or `stopped`.
        """
        self._ending = ending
        if self.task.is_running:
            self.task.apply("stop")

    def _task_changed(self, before: TaskState, after: TaskState) -> None:
        ending = self._ending if after is TaskState.STOPPED else ""
        if ending == "finished" and self.arm_state.is_moving:
            self._observe_motion_left()
        self.emit(TaskStateChanged(self._tick, after, self.task.name, ending, self.task.successor))
        if after is TaskState.PAUSED:
            self.arm_state.pause(self._tick)
        elif before is TaskState.PAUSED:
            self.arm_state.resume(self._tick)
            self.safety.disturb()
        if after is TaskState.STOPPED:
            self.arm_state.stop(self._tick, arrives=ending == "finished")
        if TaskState.STOPPED in (before, after):
            # Outputs tied to the program follow it, also if a client starts or stops it.
            by, self._by = self._by, PROGRAM
            self.signals.set_running(self.task.is_running)
            self._by = by

    def _observe_motion_left(self) -> None:
        """Let observers see what of the arm is under way at the end of a program that has finished."""
        # Imported late: few programs end so.
        from elitescript.messages.observations import MotionLeft

        if (left := self.motion.left(self._tick)) is not None:
            self.observe(left)
        if (caller := self.yielding.force_caller) is not None:
            self.observe(MotionLeft(self._tick, "force_mode", caller.line, caller.thread))
        if (tracker := self.tracking.caller) is not None:
            self.observe(MotionLeft(self._tick, "tracking", *tracker))

    def _motion_ended(self, move: int, is_complete: bool) -> None:
        self.task.program.motion_ended(move, is_complete)
        self.power.settle(self.arm_state.is_moving)

    def _motion_event(self, event: Event) -> None:
        self.safety.note(event)
        self.emit(event)

    def _signal_changed(self, name: str, index: int, value: Value, before: Value) -> None:
        by, tick = self._by, self._tick
        line = self.task.program.caller_line if by == PROGRAM else 0
        change = tick, name, index, value, by, line
        self._on_change(change)
        if SIGNALS[name].is_input:
            if name == SPEED_SIGNAL:
                self.tracking.encoders[index].turn(float(value), tick)
            if value is True or value is False:
                self._watching().input_changed((name, index))
            self.safety.signal_changed(name, value, tick)
        elif line:
            if self.motion.flying is not None:
                self._look_at_blend(name, index, line)
            try:
                changes, levels = self._written[name]
            except KeyError:
                size = SIGNALS[name].size
                changes, levels = self._written[name] = [_NO_CHANGE] * size, [False] * size
            known = changes[index]
            changes[index] = change
            if known[0] != tick:
                levels[index] = before
            else:
                self._watching().output_changed((name, index), (levels[index], known[3], known[5]), value, tick, line)

    def _look_at_blend(self, name: str, index: int, line: int) -> None:
        """Let observers see an output that comes behind a move with a blend radius and before its point."""
        source = self.motion.flying
        if source is None or source is not self.motion.source:
            self.motion.flying = None
            return
        thread = self.task.program.caller[0]
        if not source.is_stopping and source.thread == thread:
            from elitescript.messages.observations import OutputBeforePoint

            left_m = dist(self.tcp_pose(self.motion.setpoint(self._tick).q)[:3], source.waypoint[:3])
            signal = signal_name(SIGNALS[name], index)
            self.observe(OutputBeforePoint(self._tick, signal, line, thread, source.line, left_m))

    def _write_overridden(self, name: str, index: int, level: Value) -> None:
        point = signal_name(SIGNALS[name], index)
        state = "runs" if self.task.is_running else "does not run"
        shown = (
            Said("stays high" if level else "stays low")
            if isinstance(level, bool)
            else said("stays at {level:g}", level=level)
        )
        text = said(
            "{point} {shown}: the write has no effect while the task {state}, as the output is tied to that",
            point=point,
            shown=shown,
            state=state,
        )
        thread, line = self.task.program.caller
        hint = "set_runstate_…_to_value with runstate 0 unties it"
        self.emit(Warned(self._tick, text, thread, line, "W271", hint))

    def disturb_input(self, request: DisturbInput) -> None:
        """Let an input read another level than the applied one; see `input_faults`."""
        if self.signals.faults is None:
            # Imported late: few robots have such faults.
            from elitescript.controller.signals.input_faults import InputFaults

            self.signals.faults = InputFaults(lambda: self._tick, self.signals.highest, self._show_input)
        self.signals.faults.add(request, self.signals.physical(request.name, request.index))

    def _show_input(self, name: str, index: int, value: Value, is_fault: bool) -> None:
        before = self._by
        if is_fault:
            self._by = FAULT
        self.signals.show(name, index, value)
        self._by = before

    def mark(self, number: int, label: str) -> None:
        """Record that the program has reached a node of its tree."""
        self._node = (number, label)
        self.emit(LineMarked(self._tick, number, label))

    def guide_by_input(self) -> None:
        """Begin or end hand guiding by the inputs that are bound to it."""
        why_not = WHY_NOT_READY.get(self.power.mode) or self.safety.refusal("move")
        self.yielding.guide_by_input(why_not, self.arm_state, self._tick)

    def switch_off(self) -> None:
        """Stop the arm and switch its power off at standstill."""
        self.arm_state.stop(self._tick)
        self.power.go_off()
        self.power.settle(self.arm_state.is_moving)


def _go_up(controller: Controller, goal: RobotMode) -> None:
    controller.safety.require("power_on")
    if controller.power.is_going_off:
        raise ScriptStateError("cannot power on: the arm is being switched off", hint="ask again when it is off")
    controller.power.go_up(goal, controller.tick)


def _power_off(controller: Controller, _request: PowerOff | PowerDown) -> None:
    if controller.task.is_running:
        controller.task.stop("power off")
    controller.switch_off()


def _resume(controller: Controller, _request: ResumeTask) -> None:
    controller.safety.require("resume_task")
    controller.task.resume()


def _declare(controller: Controller, request: Any) -> None:
    SETUP_HANDLERS[type(request)](controller.setup, request)
    controller.safety.disturb()


def _set_signal(controller: Controller, request: Any) -> None:
    SIGNAL_SETTINGS[type(request)](controller.signals, request)
    controller.guide_by_input()


def _disturb_input(controller: Controller, request: DisturbInput) -> None:
    controller.disturb_input(request)
    controller.guide_by_input()


def _end_input_faults(controller: Controller, _request: EndInputFaults) -> None:
    if controller.signals.faults is not None:
        controller.signals.faults.end()
        controller.guide_by_input()


def _set_encoder(controller: Controller, request: Any) -> None:
    ENCODER_HANDLERS[type(request)](controller.tracking.encoders[request.index], request, controller.tick)


def _set_force(controller: Controller, request: Any) -> None:
    YIELD_SETTINGS[type(request)](controller.yielding, request, controller.arm_state.joints(controller.tick))


def _write_port(controller: Controller, request: WritePortCoils | WritePortRegisters) -> None:
    # Imported late: few programs write them.
    from elitescript.controller.signals.modbus_access import port_writes

    for part in port_writes(controller.signals, request):
        controller.request(part)


HANDLERS: Final[dict[type, Callable[[Controller, Any], None]]] = {
    SetSpeedScale: lambda controller, request: controller.safety.set_speed_scale(request.fraction, controller.tick),
    SetLineMark: lambda controller, request: controller.mark(request.number, request.label),
    AskSafety: lambda controller, request: controller.safety.ask(request, controller.tick),
    PauseTask: lambda controller, request: controller.task.pause(),
    ResumeTask: _resume,
    StopTask: lambda controller, request: controller.task.stop("stopped"),
    PowerOn: lambda controller, request: _go_up(controller, RobotMode.IDLE),
    ReleaseBrakes: lambda controller, request: _go_up(controller, RobotMode.RUNNING),
    **dict.fromkeys((PowerOff, PowerDown), _power_off),
    **dict.fromkeys((WritePortCoils, WritePortRegisters), _write_port),
    DisturbInput: _disturb_input,
    EndInputFaults: _end_input_faults,
    **dict.fromkeys(SIGNAL_SETTINGS, _set_signal),
    WriteSignal: lambda controller, request: controller.write(request.name, request.index, request.value),
    **dict.fromkeys(SETUP_HANDLERS, _declare),
    **dict.fromkeys(ENCODER_HANDLERS, _set_encoder),
    **dict.fromkeys(YIELD_SETTINGS, _set_force),
}
"""Handler of every kind of machine request."""
