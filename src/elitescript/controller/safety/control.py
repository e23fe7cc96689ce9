"""The safety system at work: from inputs and limits to the state, and from the state to arm, task and power.

A state changes at once, so that whoever asks is answered; what follows from it for the arm happens in the safety phase
of the next tick that is run (`check`), after the inbox and before the program.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final, Protocol

from elitescript.controller.arm.state import ArmState
from elitescript.controller.force.compliance_control import ComplianceControl
from elitescript.controller.motion.control import MotionControl
from elitescript.controller.safety.force_watch import ForceWatch
from elitescript.controller.safety.limits import SafetyLimits, switched_pairs
from elitescript.controller.safety.monitor import Breach, SafetyMonitor, obstacle_breach, requested_breach
from elitescript.controller.safety.reduced_speed import GRACE_TICKS, SLOWED_MODES, ReducedSpeed
from elitescript.controller.safety.states import (
    ASKED_FROM_OUTSIDE,
    EFFECTS,
    INPUT_ACTIONS,
    MOVING_MODES,
    RESTART_HINTS,
    WHAT_TO_DO,
    Safety,
)
from elitescript.controller.signals.image import SignalImage
from elitescript.controller.tasks import ProgramPort, Task
from elitescript.controller.tool_setup import Setup
from elitescript.errors import ArgumentRangeError, UsageError
from elitescript.kinematics.arm import Arm
from elitescript.messages.enums import SafetyMode, TaskState
from elitescript.messages.events import Alarm, Event, MotionStarted, SafetyModeChanged, Warned
from elitescript.messages.machine import AskSafety
from elitescript.messages.motion import Six
from elitescript.messages.signals import Value
from elitescript.messages.yielding import ForceMode, Freedrive, YieldRequest
from elitescript.motion.limits import MotionLimits, joint_outside
from elitescript.motion.streaming.speed import Obstacle

_EXPLAINED: Final = (SafetyMode.PROTECTIVE_STOP, SafetyMode.VIOLATION, SafetyMode.FAULT)
"""States that are entered for a reason of their own."""


class SafetyPort(Protocol):
    """What the safety system asks of its controller."""

    @property
    def arm(self) -> Arm:
        """Geometry."""

    @property
    def tick(self) -> int:
        """The present one."""

    @property
    def program(self) -> ProgramPort:
        """What runs scripts."""

    def emit(self, event: Event) -> None:
        """Record what happened."""

    def switch_off(self) -> None:
        """Stop the arm and switch its power off at standstill."""


class SafetyControl:
    """The safety system of one controller.

    Args:
        port: the controller.
        limits: the configuration.
        motion_limits: limits of the model.
        motion: the nominal motion.
        arm_state: target and actual joints.
        setup: the active TCP.
        signals: inputs of the safety system.
        yielding: what yields to forces, and their sensor.
        task: is paused and ended by stops.
        speed_scale: speed percentage at the start, as a fraction.
    """

    __slots__ = (
        "_arm_state",
        "_blamed",
        "_breach",
        "_effects",
        "_force",
        "_is_disturbed",
        "_is_first",
        "_is_holding_task",
        "_is_task_new",
        "_is_watching",
        "_monitor",
        "_motion",
        "_motion_limits",
        "_port",
        "_safety",
        "_setup",
        "_signals",
        "_slowed_lines",
        "_speed",
        "_speeds_hold_from",
        "_task",
        "_yield",
    )

    def __init__(
        self,
        port: SafetyPort,
        limits: SafetyLimits,
        motion_limits: MotionLimits,
        motion: MotionControl,
        arm_state: ArmState,
        setup: Setup,
        signals: SignalImage,
        yielding: ComplianceControl,
        task: Task,
        speed_scale: float,
    ) -> None:
        self._port = port
        self._monitor = SafetyMonitor(port.arm, limits)
        self._safety = Safety(self._mode_changed)
        self._motion = motion
        self._motion_limits = motion_limits
        self._arm_state = arm_state
        self._setup = setup
        self._signals = signals
        self._yield = yielding
        self._force = ForceWatch(self._monitor, yielding.sensor)
        self._task = task
        self._speed = ReducedSpeed(self._monitor, motion, setup, speed_scale)
        self._breach: Breach | None = None
        self._blamed: tuple[int, str] = (0, "main")
        self._effects: list[tuple[SafetyMode, Breach | None]] = []
        self._is_first = True
        self._is_disturbed = True
        self._is_holding_task = False
        self._is_task_new = False
        self._is_watching = False
        self._update_watching()
        self._speeds_hold_from = 0
        self._slowed_lines: set[int] = set()
        motion.on_obstacle = self.meet_obstacle

    # ---------------------------------------------------------------- reading

    @property
    def mode(self) -> SafetyMode:
        """What the safety system allows."""
        return self._safety.mode

    @property
    def speed_scale(self) -> float:
        """Speed percentage that was asked for, as a fraction."""
        return self._speed.scale

    @property
    def obstruction(self) -> str:
        """Why nothing moves, and what leads back; empty if the arm may move."""
        return WHAT_TO_DO.get(self.mode, "")

    def refusal(self, action: str) -> str:
        """Why an action is refused now; empty if it is not."""
        return self._safety.refusal(action)

    def require(self, action: str) -> None:
        """Let an action pass.

        Raises:
            ScriptStateError: the state does not allow it; the text says what to do.
        """
        self._safety.check(action)

    def next_tick(self, tick: int) -> int | None:
        """Next tick that has to be looked at; None while nothing moves that is watched."""
        if self._effects or self._is_task_new:
            return tick + 1
        if not self._is_watching:
            return None
        return tick + 1 if self._is_disturbed or self._arm_state.is_moving else None

    def is_within(self, q: Six, pairs: Sequence[bool] | None = None) -> bool:
        """Whether joints (rad) respect the ranges of the model and the limits of position.

        Args:
            q: the joints.
            pairs: for each pair of configurable inputs, whether its planes count; by their levels if None.
        """
        if joint_outside(self._motion_limits, q) is not None:
            return False
        switched = self._pairs() if pairs is None else pairs
        return self._monitor.position_breach(q, self._setup.T_flange_tcp, self._inner_mode, switched) is None

    # ---------------------------------------------------------------- what happens elsewhere

    def note(self, event: Event) -> None:
        """An event of the motion: the last motion that began is the one to blame."""
        if isinstance(event, MotionStarted):
            self._blamed = (event.line, event.thread)
        self.disturb()

    def disturb(self) -> None:
        """Something besides the joints has changed that limits depend on: look at the next tick."""
        self._is_disturbed = True

    def signal_changed(self, name: str, value: Value) -> None:
        """A signal has another level."""
        inputs = self._safety.inputs
        if name in INPUT_ACTIONS:
            setattr(inputs, name, bool(value))
            pressed, released = INPUT_ACTIONS[name]
            if not value:
                self._note_place()
            self._safety.apply(pressed if value else released, self._port.tick)
            self.disturb()
        elif name == "reduced_mode":
            self._set_reduced(self._wants_reduced())
        elif name == "configurable_digital_in":
            self.disturb()
        elif name == "external_wrench":
            self._update_watching()
            self.disturb()

    def note_yielding(self, request: YieldRequest, line: int, thread: str) -> None:
        """Force mode or hand guiding is asked for: the one to blame, and a target force that the arm may not reach."""
        if isinstance(request, ForceMode | Freedrive):
            self._blamed = (line, thread)
        caution = self._force.caution(request, self.mode) if isinstance(request, ForceMode) else ""
        if caution:
            self._port.emit(Warned(self._port.tick, caution, thread, line))

    def task_started(self) -> None:
        """A program begins; whether it may is decided in the safety phase."""
        self._is_task_new = True
        self._is_holding_task = False
        self._slowed_lines.clear()

    def take_pause(self) -> bool:
        """Whether the task is paused already, by the safeguard: it does not go on then when that is closed."""
        was_holding, self._is_holding_task = self._is_holding_task, False
        return was_holding

    def set_speed_scale(self, fraction: float) -> None:
        """New speed percentage.

        Raises:
            ArgumentRangeError: outside [0, 1].
        """
        if not 0.0 <= fraction <= 1.0:
            text = f"the speed percentage must be in [0, 1], got {fraction:g}"
            raise ArgumentRangeError(text, value=fraction, limit="[0, 1]")
        self._speed.set_scale(fraction, self._port.tick)
        self.disturb()

    def meet_obstacle(self, tick: int, obstacle: Obstacle, thread: str, line: int) -> None:
        """A motion at a speed has come to the end of a joint range or to a singularity; it brakes already."""
        self._blamed = (line, thread)
        self._stop(obstacle_breach(obstacle))

    def ask(self, request: AskSafety) -> None:
        """One of the actions that people and clients ask for.

        Raises:
            ScriptStateError: the state does not allow it, or it is too early.
            UsageError: no such action.
        """
        action = request.action
        if action not in ASKED_FROM_OUTSIDE:
            raise UsageError(f"no safety action is called {action!r}; there are {', '.join(ASKED_FROM_OUTSIDE)}")
        self._note_place()
        if action != "unlock_protective_stop" and not (action == "stop_protectively" and not self._safety.may_move):
            self._breach = requested_breach(request.reason)
        self._safety.apply(action, self._port.tick, is_standing=not self._arm_state.is_moving)
        self.disturb()
        if action == "restart_safety":
            # The power goes off whatever the state was and is.
            self._effects.append((SafetyMode.FAULT, requested_breach("the safety system was restarted")))

    # ---------------------------------------------------------------- the safety phase of a tick

    def check(self, tick: int) -> None:
        """Do what the state asks for, then compare the arm with its limits."""
        if not (self._is_watching or self._is_disturbed or self._effects or self._is_task_new):
            return
        if self._is_task_new:
            self._is_task_new = False
            self._admit_task(tick)
        self._act(tick)
        is_moving = self._arm_state.is_moving
        is_disturbed, self._is_disturbed = self._is_disturbed, False
        is_first, self._is_first = self._is_first, False
        if self._is_watching and (is_disturbed or is_moving):
            self._look(tick, is_first=is_first, is_disturbed=is_disturbed)
            self._act(tick)
        self._force.is_to_tolerate = False
        if not is_moving:
            self._speed.release(tick)

    def _look(self, tick: int, *, is_first: bool, is_disturbed: bool) -> None:
        joints = self._arm_state.joints(tick)
        q, qd = joints.q_actual, joints.qd_actual
        T_flange_tcp = self._setup.T_flange_tcp
        self._set_reduced(self._wants_reduced(q))
        pairs = self._pairs()
        breach = self._monitor.position_breach(q, T_flange_tcp, self._inner_mode, pairs)
        if breach is None and joints.q_target != q:
            breach = self._monitor.position_breach(joints.q_target, T_flange_tcp, self._inner_mode, pairs)
        self._safety.inputs.is_outside = breach is not None
        if self.mode is SafetyMode.RECOVERY:
            if breach is None:
                self._safety.apply("come_inside", tick)
        elif breach is not None:
            if is_first:
                text = f"the arm begins outside its safety limits: {breach.text}; it may move back (recovery)"
                self._port.emit(Warned(tick, text))
                self._safety.apply("find_outside", tick)
            else:
                self._stop(breach)
                return
        breach, tolerated = self._force.look(q, qd, self.mode)
        if tolerated:
            self._port.emit(Warned(tick, tolerated))
        if breach is None and (self.mode is SafetyMode.NORMAL or tick >= self._speeds_hold_from):
            breach = self._monitor.speed_breach(q, qd, T_flange_tcp, self.mode)
        if breach is not None:
            self._stop(breach)
        if self.mode in SLOWED_MODES and self._speed.slow_down(tick):
            self._say_slowed(tick)

    def _update_watching(self) -> None:
        self._is_watching = self._safety.may_move and (self._monitor.is_watching(self.mode) or self._force.is_watching)

    def _say_slowed(self, tick: int) -> None:
        line, thread = self._blamed
        if line in self._slowed_lines:
            return
        self._slowed_lines.add(line)
        mode = self.mode.name.lower()
        self._port.emit(Warned(tick, f"the motion is slowed down to the limits of {mode} mode", thread, line))

    def _stop(self, breach: Breach) -> None:
        self._breach = breach
        self._safety.apply("stop_protectively", self._port.tick)

    def _admit_task(self, tick: int) -> None:
        if self._safety.refusal("start_task"):
            breach = self._breach if self.mode in _EXPLAINED else None
            why = "" if breach is None else f"; the reason of the stop was: {breach.text}"
            breach = breach or Breach("emergency_stop", "", hints=RESTART_HINTS)
            self._fail_task(self.mode, replace(breach, text=f"cannot start: {self.obstruction}{why}"))
        elif self.mode is SafetyMode.SAFEGUARD_STOP:
            self._hold(tick)

    # ---------------------------------------------------------------- what a state does

    def _mode_changed(self, before: SafetyMode, after: SafetyMode) -> None:
        breach = self._breach if after in _EXPLAINED else None
        reason = breach.text if breach is not None else self._words(after)
        self._effects.append((after, breach))
        self._update_watching()
        self._force.is_to_tolerate |= before not in MOVING_MODES and after in MOVING_MODES
        if before not in SLOWED_MODES:
            self._speeds_hold_from = self._port.tick + GRACE_TICKS
        self._port.emit(SafetyModeChanged(self._port.tick, after, reason))

    def _words(self, mode: SafetyMode) -> str:
        if mode in (SafetyMode.REDUCED, SafetyMode.RECOVERY):
            speed = self._monitor.limits.bounds(mode).tcp_speed_max
            limit = "" if speed is None else f": the TCP moves at {speed:g} m/s at most"
            return f"motions are slowed down to the reduced limits{limit}"
        return WHAT_TO_DO.get(mode, "").partition(";")[0]

    def _act(self, tick: int) -> None:
        while self._effects:
            after, breach = self._effects.pop(0)
            effect = EFFECTS[after]
            if effect.task == "is stopped":
                self._is_holding_task = False
                self._fail_task(after, breach or Breach("emergency_stop", self._words(after), hints=RESTART_HINTS))
                self._arm_state.stop(tick)
            elif effect.task == "is paused":
                self._hold(tick)
            else:
                self._enter_motion(after, tick)
            if not effect.is_power_kept:
                self._port.switch_off()

    def _hold(self, tick: int) -> None:
        if self._task.state is TaskState.PLAYING:
            self._task.apply("pause")
            self._port.program.pause()
            self._is_holding_task = True
        elif not self._task.is_running:
            self._arm_state.stop(tick)

    def _enter_motion(self, after: SafetyMode, tick: int) -> None:
        """Take on the limits of a state in which the arm may move, and let a task go on that a safeguard has held."""
        is_slowed = after in SLOWED_MODES
        self._yield.limit_speed(self._monitor.limits.bounds(after).tcp_speed_max if is_slowed else None)
        if not is_slowed:
            self._speed.release(tick)
        self._is_disturbed = True
        if self._is_holding_task:
            self._is_holding_task = False
            if self._task.state is TaskState.PAUSED:
                self._task.apply("resume")
                self._port.program.resume()

    def _fail_task(self, mode: SafetyMode, breach: Breach) -> None:
        if not self._task.is_running:
            return
        line, thread = self._blamed if self._arm_state.is_moving else (self._port.program.line, "main")
        effect = EFFECTS[mode]
        hints = breach.hints if effect.is_power_kept else RESTART_HINTS
        details = replace(breach, hints=hints).details(mode)
        alarm = Alarm(self._port.tick, effect.code, effect.class_name, breach.text, line, 0, thread, "", details)
        self._port.program.fail(alarm)

    # ---------------------------------------------------------------- inputs

    @property
    def _inner_mode(self) -> SafetyMode:
        """The mode whose limits of position count."""
        return SafetyMode.REDUCED if self._safety.inputs.reduced_mode else SafetyMode.NORMAL

    def _note_place(self) -> None:
        """Note whether the arm is outside its limits, before a state is chosen by that."""
        q = self._arm_state.joints(self._port.tick).q_actual
        breach = self._monitor.position_breach(q, self._setup.T_flange_tcp, self._inner_mode, self._pairs())
        self._safety.inputs.is_outside = breach is not None

    def _wants_reduced(self, q: Six | None = None) -> bool:
        if self._signals.read("reduced_mode"):
            return True
        place = self._arm_state.joints(self._port.tick).q_actual if q is None else q
        return self._monitor.asks_for_reduced(place, self._setup.T_flange_tcp, self._pairs())

    def _set_reduced(self, is_wanted: bool) -> None:
        inputs = self._safety.inputs
        if inputs.reduced_mode != is_wanted:
            inputs.reduced_mode = is_wanted
            self._safety.apply("ask_for_reduced" if is_wanted else "end_reduced", self._port.tick)
            self.disturb()

    def _pairs(self) -> tuple[bool, ...]:
        return switched_pairs(self._signals.read)
