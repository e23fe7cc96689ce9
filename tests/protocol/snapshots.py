"""Snapshots, outputs and descriptions for the tests of the ports; no two of their numbers are the same."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from elitescript.messages.enums import AnalogDomain, RobotMode, SafetyMode, TaskState
from elitescript.messages.motion import Six
from elitescript.messages.outputs import Output
from elitescript.messages.signals import SIGNALS, Value
from elitescript.messages.snapshot import RobotDescription, Snapshot, TaskPicture
from elitescript.messages.state import Payload, RobotState
from elitescript.messages.timing import seconds

VOLTAGE, CURRENT = AnalogDomain.VOLTAGE, AnalogDomain.CURRENT


def six(first: float) -> Six:
    """Six numbers that grow by a tenth."""
    return (first, first + 0.1, first + 0.2, first + 0.3, first + 0.4, first + 0.5)


def signal_image(values: Mapping[str, Mapping[int, Value]] | None = None) -> dict[str, tuple[Value, ...]]:
    """All families at their defaults, but for the points that are given: `{"flag": {3: True}}`."""
    image: dict[str, tuple[Value, ...]] = {}
    for name, row in SIGNALS.items():
        levels = [row.default] * row.size
        for index, value in ((values or {}).get(name) or {}).items():
            levels[index] = value
        image[name] = tuple(levels)
    return image


def robot_state(tick: int = 1000, **changes: Any) -> RobotState:
    """The machine, running and at rest."""
    state = RobotState(
        tick=tick,
        time_s=seconds(tick),
        robot_mode=RobotMode.RUNNING,
        safety_mode=SafetyMode.NORMAL,
        task_state=TaskState.STOPPED,
        q_target=six(0.0),
        qd_target=six(1.0),
        q_actual=six(2.0),
        qd_actual=six(3.0),
        tcp_offset=six(4.0),
        tcp_pose_target=six(5.0),
        tcp_pose_actual=six(6.0),
        tcp_speed_target=six(7.0),
        tcp_speed_actual=six(8.0),
        flange_pose_actual=six(9.0),
        payload=Payload(1.25, (0.01, 0.02, 0.03)),
        gravity=(0.0, 0.0, 9.82),
        speed_scale=0.75,
        is_moving=False,
        line=17,
        node=(3, "MoveJ"),
    )
    return replace(state, **changes)


def snapshot(tick: int = 1000, **changes: Any) -> Snapshot:
    """What ports see.

    Args:
        tick: of the snapshot.
        changes: fields of `Snapshot` or of `RobotState`; `signals` as for `signal_image`.
    """
    signals = signal_image(changes.pop("signals", None))
    of_robot = {field.name for field in fields(RobotState)} & changes.keys()
    whole = Snapshot(
        robot=robot_state(tick, **{name: changes.pop(name) for name in of_robot}),
        joint_torques=six(10.0),
        joint_currents=six(11.0),
        joint_temperatures=six(12.0),
        joint_voltages=six(13.0),
        tcp_force=six(14.0),
        raw_wrench=six(15.0),
        elbow_position=(16.0, 16.1, 16.2),
        elbow_velocity=(17.0, 17.1, 17.2),
        speed_scaling=0.625,
        controller_temperature=31.5,
        robot_voltage=48.5,
        robot_current=1.5,
        io_current=0.125,
        tool_current=0.0625,
        tool_temperature=29.5,
        signals=signals,
        domains={
            "standard_analog_in": (VOLTAGE, CURRENT),
            "standard_analog_out": (CURRENT, VOLTAGE),
            "tool_analog_in": (VOLTAGE,),
            "tool_analog_out": (CURRENT,),
        },
        tool_analog_mode=3,
        tool_pin_modes=(0, 1, 2, 1),
        is_remote=True,
        is_freedrive=False,
        popup="",
        task=TaskPicture("", "", "default.configuration", is_saved=True, is_configuration_modified=False),
        overruns=0,
    )
    return replace(whole, **changes)


def output(tick: int = 1000, **changes: Any) -> Output:
    """What a tick gives: nothing but a snapshot; `changes` as for `snapshot`, or `events`, `requests`, `replies`."""
    rest = {name: changes.pop(name, ()) for name in ("events", "requests", "replies")}
    return Output(tick=tick, snapshot=snapshot(tick, **changes), **rest)


def description(**changes: Any) -> RobotDescription:
    """An arm."""
    arm = RobotDescription(
        model="CS66",
        type_id=62,
        serial_number="CS66-0001",
        robot_id="robot-1",
        firmware=(2, 14),
        version=(2, 14, 2, 7),
        q_min=six(-6.25),
        q_max=six(5.75),
        qd_max=six(2.5),
        qdd_max=six(20.0),
        default_joint_speed=1.05,
        default_joint_acceleration=1.4,
        default_tool_speed=0.25,
        default_tool_acceleration=1.2,
        equivalent_radius_m=0.35,
        dh_a=six(0.5),
        dh_d=six(0.05),
        dh_alpha=six(1.5),
        safety_checksum=0x1234ABCD,
    )
    return replace(arm, **changes)
