"""Runs the safety system: from inputs and limits to the state, and from the state to arm, task and power.

A state changes at once; its effects on the arm follow in the safety phase of the next tick that is run (`check`),
after the requests from outside and before the program.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

from elitescript.controller.safety.arm_watch import ArmWatch
from elitescript.controller.safety.monitor import Breach, obstacle_breach, requested_breach
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
from elitescript.controller.tasks import Task
from elitescript.errors import UsageError
from elitescript.messages.enums import SafetyMode, TaskState
from elitescript.messages.events import Alarm, Event, MotionStarted, SafetyModeChanged, Warned
from elitescript.messages.machine import AskSafety
from elitescript.messages.motion import Six
from elitescript.messages.signals import Value
from elitescript.messages.state import JointState
from elitescript.messages.yielding import ForceMode, Freedrive, YieldRequest
from elitescript.motion.streaming.speed import Obstacle
from elitescript.records import replace
from elitescript.said import said

_EXPLAINED: Final = (SafetyMode.PROTECTIVE_STOP, SafetyMode.VIOLATION, SafetyMode.FAULT)
"""States whose reason is a breach."""


class SafetyControl:
    """Decides what the arm may do, and stops, pauses and slows it down.

    Args:
        watch: compares the arm with its limits.
        speed: the speed percentage and its reduction.
        task: paused and ended by stops.
        on_event: receives every event in order.
        switch_off: stops the arm and switches its power off at standstill.
    """

    __slots__ = (
        "_arm_state",
        "_breach",
        "_cause",
        "_effects",
        "_force",
        "_is_disturbed",
        "_is_first",
        "_is_task_new",
        "_is_watching",
        "_on_event",
        "_safety",
        "_slowed_lines",
        "_speed",
        "_speeds_hold_from",
        "_switch_off",
        "_task",
        "_watch",
    )

    def __init__(
        self,
        watch: ArmWatch,
        speed: ReducedSpeed,
        task: Task,
        on_event: Callable[[Event], None],
        switch_off: Callable[[], None],
    ) -> None:
        self._watch = watch
        self._arm_state = watch.arm_state
        self._force = watch.force
        self._speed = speed
        self._task = task
        self._on_event = on_event
        self._switch_off = switch_off
        self._safety = Safety(self._mode_changed)
        self._breach: Breach | None = None
        self._cause: tuple[int, str] = (0, "main")
        """Line and thread of the call that has set the arm in motion last."""
        self._effects: list[tuple[SafetyMode, Breach | None]] = []
        self._is_first = True
        self._is_disturbed = True
        self._is_task_new = False
        self._is_watching = False
        self._update_watching()
        self._speeds_hold_from = 0
        self._slowed_lines: set[int] = set()

    # ---------------------------------------------------------------- reading

    @property
    def mode(self) -> SafetyMode:
        """State of the safety system."""
        return self._safety.mode

    @property
    def speed_scale(self) -> float:
        """Speed percentage that is set, as a fraction."""
        return self._speed.scale

    @property
    def obstruction(self) -> str:
        """Reason why the arm may not move, and the way back; empty if it may."""
        return WHAT_TO_DO.get(self.mode, "")

    def refusal(self, action: str) -> str:
        """Return why an action is refused now; empty if it is not."""
        return self._safety.refusal(action)

    def require(self, action: str) -> None:
        """Check that an action is allowed.

        Raises:
            ScriptStateError: the state does not allow it; the text names the remedy.
        """
        self._safety.check(action)

    def next_tick(self, tick: int) -> int | None:
        """Return the next tick, if it has to be checked; None while nothing moves that is watched."""
        if self._effects or self._is_task_new:
            return tick + 1
        if not self._is_watching:
            return None
        return tick + 1 if self._is_disturbed or self._arm_state.is_moving else None

    def is_within(self, q: Six, pairs: Sequence[bool] | None = None) -> bool:
        """See `ArmWatch.is_within`; the limits are those of the present mode."""
        return self._watch.is_within(q, self._inner_mode, pairs)

    # ---------------------------------------------------------------- notifications

    def note(self, event: Event) -> None:
        """Remember the motion that began last as the cause of a stop."""
        if isinstance(event, MotionStarted):
            self._cause = (event.line, event.thread)
        self.disturb()

    def disturb(self) -> None:
        """Have the next tick checked: something besides the joints has changed that limits depend on."""
        self._is_disturbed = True

    def signal_changed(self, name: str, value: Value, tick: int) -> None:
        """Act on the new level of a signal."""
        inputs = self._safety.inputs
        if name in INPUT_ACTIONS:
            setattr(inputs, name, bool(value))
            pressed, released = INPUT_ACTIONS[name]
            if not value:
                inputs.is_outside = self._watch.is_outside(tick, self._inner_mode)
            self._safety.apply(pressed if value else released, tick)
            self.disturb()
        elif name == "reduced_mode":
            self._update_reduced(tick, self._arm_state.joints(tick))
        elif name == "configurable_digital_in":
            self.disturb()
        elif name == "external_wrench":
            self._update_watching()
            self.disturb()

    def note_yielding(self, request: YieldRequest, tick: int, line: int, thread: str) -> None:
        """Remember force mode or hand guiding as the cause of a stop; warn of a target force above the limit."""
        if isinstance(request, ForceMode | Freedrive):
            self._cause = (line, thread)
        caution = self._force.caution(request, self.mode) if isinstance(request, ForceMode) else ""
        if caution:
            self._on_event(Warned(tick, caution, thread, line))

    def task_started(self) -> None:
        """Have the safety phase decide whether a new program may run."""
        self._is_task_new = True
        self._slowed_lines.clear()

    def set_speed_scale(self, fraction: float, tick: int) -> None:
        """See `ReducedSpeed.set_scale`."""
        self._speed.set_scale(fraction, tick)
        self.disturb()

    def meet_obstacle(self, tick: int, obstacle: Obstacle, thread: str, line: int) -> None:
        """Stop because a motion at a speed brakes at the end of a joint range or at a singularity."""
        self._cause = (line, thread)
        self._stop(obstacle_breach(obstacle), tick)

    def ask(self, request: AskSafety, tick: int) -> None:
        """Carry out an action that a user or client asks for.

        Raises:
            ScriptStateError: the state does not allow it, or it is too early.
            UsageError: no such action.
        """
        action = request.action
        if action not in ASKED_FROM_OUTSIDE:
            raise UsageError(f"no safety action is called {action!r}; there are {', '.join(ASKED_FROM_OUTSIDE)}")
        self._safety.inputs.is_outside = self._watch.is_outside(tick, self._inner_mode)
        if action != "unlock_protective_stop" and not (action == "stop_protectively" and not self._safety.may_move):
            self._breach = requested_breach(request.reason)
        self._safety.apply(action, tick, is_standing=not self._arm_state.is_moving)
        self.disturb()
        if action == "restart_safety":
            # The power goes off in every state.
            self._effects.append((SafetyMode.FAULT, requested_breach("the safety system was restarted")))

    # ---------------------------------------------------------------- the safety phase of a tick

    def check(self, tick: int) -> None:
        """Apply the effects of the state, then compare the arm with its limits."""
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
        watch = self._watch
        joints = self._arm_state.joints(tick)
        self._update_reduced(tick, joints)
        breach = watch.position_breach(joints, self._inner_mode)
        self._safety.inputs.is_outside = breach is not None
        if self.mode is SafetyMode.RECOVERY:
            if breach is None:
                self._safety.apply("come_inside", tick)
        elif breach is not None:
            if is_first:
                text = said(
                    "the arm begins outside its safety limits: {text}; it may move back (recovery)", text=breach.text
                )
                self._on_event(Warned(tick, text))
                self._safety.apply("find_outside", tick)
            else:
                self._stop(breach, tick)
                return
        breach, tolerated = self._force.look(joints.q_actual, joints.qd_actual, self.mode)
        if tolerated:
            self._on_event(Warned(tick, tolerated))
        if breach is None and (self.mode is SafetyMode.NORMAL or tick >= self._speeds_hold_from):
            breach = watch.speed_breach(joints, self.mode)
        if breach is not None:
            self._stop(breach, tick)
        if self.mode in SLOWED_MODES and self._speed.slow_down(tick):
            self._warn_of_slowing(tick)

    def _update_watching(self) -> None:
        self._is_watching = self._safety.may_move and self._watch.is_needed(self.mode)

    def _update_reduced(self, tick: int, joints: JointState) -> None:
        inputs, is_wanted = self._safety.inputs, self._watch.asks_for_reduced(joints)
        if inputs.reduced_mode != is_wanted:
            inputs.reduced_mode = is_wanted
            self._safety.apply("ask_for_reduced" if is_wanted else "end_reduced", tick)
            self.disturb()

    def _warn_of_slowing(self, tick: int) -> None:
        line, thread = self._cause
        if line in self._slowed_lines:
            return
        self._slowed_lines.add(line)
        mode = self.mode.name.lower()
        self._on_event(
            Warned(tick, said("the motion is slowed down to the limits of {mode} mode", mode=mode), thread, line)
        )

    def _stop(self, breach: Breach, tick: int) -> None:
        self._breach = breach
        self._safety.apply("stop_protectively", tick)

    def _admit_task(self, tick: int) -> None:
        if self._safety.refusal("start_task"):
            breach = self._breach if self.mode in _EXPLAINED else None
            why = "" if breach is None else said("; the reason of the stop was: {text}", text=breach.text)
            breach = breach or Breach("emergency_stop", "", hints=RESTART_HINTS)
            self._fail_task(
                self.mode,
                replace(breach, text=said("cannot start: {obstruction}{why}", obstruction=self.obstruction, why=why)),
                tick,
            )
        elif self.mode is SafetyMode.SAFEGUARD_STOP:
            self._hold(tick)

    @property
    def _inner_mode(self) -> SafetyMode:
        """The mode whose limits of position count."""
        return SafetyMode.REDUCED if self._safety.inputs.reduced_mode else SafetyMode.NORMAL

    # ---------------------------------------------------------------- effects of a state

    def _mode_changed(self, before: SafetyMode, after: SafetyMode) -> None:
        tick = self._safety.since_tick
        breach = self._breach if after in _EXPLAINED else None
        reason = breach.text if breach is not None else self._words(after)
        self._effects.append((after, breach))
        self._update_watching()
        self._force.is_to_tolerate |= before not in MOVING_MODES and after in MOVING_MODES
        if before not in SLOWED_MODES:
            self._speeds_hold_from = tick + GRACE_TICKS
        self._on_event(SafetyModeChanged(tick, after, reason))

    def _words(self, mode: SafetyMode) -> str:
        if mode in SLOWED_MODES:
            speed = self._watch.limits.bounds(mode).tcp_speed_max
            limit = "" if speed is None else f": the TCP moves at {speed:g} m/s at most"
            return said("motions are slowed down to the reduced limits{limit}", limit=limit)
        return WHAT_TO_DO.get(mode, "").partition(";")[0]

    def _act(self, tick: int) -> None:
        while self._effects:
            after, breach = self._effects.pop(0)
            effect = EFFECTS[after]
            if effect.task == "is stopped":
                breach = breach or Breach("emergency_stop", self._words(after), hints=RESTART_HINTS)
                self._fail_task(after, breach, tick)
                self._arm_state.stop(tick)
            elif effect.task == "is paused":
                self._hold(tick)
            else:
                self._speed.enter(after, tick)
                self._is_disturbed = True
                self._task.release()
            if not effect.is_power_kept:
                self._switch_off()

    def _hold(self, tick: int) -> None:
        """Pause the task until the safeguard is closed; without a task brake the arm."""
        if self._task.state is TaskState.PLAYING:
            self._task.hold()
        elif not self._task.is_running:
            self._arm_state.stop(tick)

    def _fail_task(self, mode: SafetyMode, breach: Breach, tick: int) -> None:
        line, thread = self._cause if self._arm_state.is_moving else (self._task.program.line, "main")
        effect = EFFECTS[mode]
        hints = breach.hints if effect.is_power_kept else RESTART_HINTS
        details = replace(breach, hints=hints).details(mode)
        self._task.fail(Alarm(tick, effect.code, effect.class_name, breach.text, line, 0, thread, "", details))
