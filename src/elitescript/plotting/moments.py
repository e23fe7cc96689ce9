"""Describes a robot and its run at a moment, as a page shows them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from elitescript.conversation import describe
from elitescript.conversation.describe import Message, Moment, Thread, Variable
from elitescript.debugger.values import shown, type_name
from elitescript.robot import VirtualRobot
from elitescript.run import Run
from elitescript.solids.contacts import Contact
from elitescript.solids.scene import scene


def scene_of(robot: VirtualRobot) -> Message:
    """Return the robot and what is around it, as the run begins."""
    setup, cell = robot.controller.setup, robot.cell
    return scene(
        robot.model,
        tcp=setup.tcp_offset,
        payload_kg=setup.payload.mass_kg,
        center_of_gravity=setup.payload.cog,
        gravity=setup.gravity,
        parts=() if cell is None else cell.parts,
    )


def moment_now(robot: VirtualRobot) -> Moment:
    """Return the state behind the present tick, as the row of a trace has it."""
    controller = robot.controller
    q = controller.joints_at(controller.tick + 1).q_target
    states = robot.threads()
    return Moment(
        t=robot.time_s,
        line=controller.line,
        joints=q,
        tcp_pose=controller.tcp_pose(q),
        globals=variables_of(robot.host.monitor()),
        signals=controller.non_default_signals(),
        threads=tuple(Thread(state.name, state.line, state.waits_for, "") for state in states),
    )


def moment_of_run(run: Run) -> Moment:
    """Return the state at the end of a run."""
    joints, pose = run.joints, run.tcp_pose
    assert joints
    assert pose
    return Moment(
        t=run.time_s,
        line=0,
        joints=joints,
        tcp_pose=pose,
        globals=variables_of(run.globals),
        signals=dict(run.signals),
        threads=tuple(Thread(state.name, state.line, state.waits_for, "", state.because) for state in run.threads),
    )


def variables_of(values: Mapping[str, Any]) -> tuple[Variable, ...]:
    """Return program globals as a page shows them."""
    return tuple(Variable(name, shown(value), type_name(value)) for name, value in values.items())


def contacts_of(run: Run) -> list[Contact] | None:
    """Return the contacts of a run, and the closest that anything came to a thing; None if there are no things."""
    if run.watch is None:
        return None
    return [*run.contacts, *(contact for contact in run.clearances if not contact.is_contact)]


def alarm_of(robot: VirtualRobot, run: Run) -> Message | None:
    """Return what a page shows of the alarm that ended a run; None if none did."""
    if not run.alarms:
        return None
    alarm = run.alarms[-1]
    return describe.alarm_report(alarm, describe.asked_motion(alarm, robot.controller.motion.refused, run.events))
