"""Records runs of a virtual robot in memory, through its RTSI port, with differences that an audit has to find."""

from __future__ import annotations

import random
from array import array
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any

from elitescript.client.rtsi_messages import FrameReader, OutputLayout, message, output_request
from elitescript.client.rtsi_signals import POINTS
from elitescript.protocol.rtsi.recipes import DATA_PACKAGE
from elitescript.protocol.rtsi.variables import OUTPUTS
from elitescript.recorder.recording import Recording
from elitescript.robot import VirtualRobot

VARIABLES = (
    "timestamp",
    "script_control_line",
    "runtime_state",
    "safety_status",
    "target_joint_positions",
    "target_joint_speeds",
    "actual_joint_positions",
    "target_TCP_pose",
    "speed_scaling",
    "target_speed_fraction",
    "payload_mass",
    "payload_cog",
    *(name for name in POINTS if "_register" not in name),
    "output_bit_registers0_to_31",
    "input_bit_registers0_to_31",
    *(
        f"{side}_{kind}_register{index}"
        for side in ("input", "output")
        for kind in ("int", "double")
        for index in (0, 1, 5)
    ),
)


def record_run(
    program: Any,
    *,
    model: str = "CS66",
    wait_s: float = 0.06,
    after_s: float = 0.02,
    phase_s: float = 0.0,
    noise_rad: float = 0.0,
    lost: float = 0.0,
    jitter_s: float = 0.0,
    seed: int = 0,
    hz: float = 250.0,
    at: Sequence[tuple[float, str, Any]] = (),
    acts: Mapping[float, Callable[[VirtualRobot], None]] | None = None,
    until_s: float | None = None,
    variables: Sequence[str] = VARIABLES,
    facts: Mapping[str, Any] | None = None,
    **options: Any,
) -> Recording:
    """Return what RTSI shows of a run.

    Args:
        program: that runs.
        model: of the robot.
        wait_s: before it begins; the recording has this time too.
        after_s: after its end.
        phase_s: is added to the controller's times.
        noise_rad: of the measured joints.
        lost: share of the packages that do not arrive.
        jitter_s: of the arrival of packages.
        seed: of noise, jitter and lost packages.
        hz: of the packages.
        at: levels of inputs, by the time since the program's begin.
        acts: done to the robot, by the time since the program's begin.
        until_s: end of the recording, while the program runs.
        variables: of the recipe.
        facts: of the recording.
        **options: of the robot.
    """
    draw = random.Random(seed)
    robot = VirtualRobot(model, **options)
    client = robot.connect("rtsi")
    client.send(output_request(variables, hz))
    client.send(message("S"))
    robot.advance(wait_s)
    begin = robot.tick
    for time_s, name, level in at:
        robot.at(begin / 250 + time_s, name, level)
    left = sorted((acts or {}).items())

    def watch(robot: VirtualRobot) -> None:
        while left and robot.tick >= begin + round(250 * left[0][0]):
            left.pop(0)[1](robot)

    run = robot.run(program, watch=watch, until_s=until_s)
    if until_s is None:
        robot.advance(after_s)
    layout = OutputLayout(1, variables, [OUTPUTS[name].type.name for name in variables], hz)
    packages = [frame.payload for frame in FrameReader().feed(client.receive()) if frame.command == DATA_PACKAGE]
    if until_s is not None:
        packages = packages[:-1]
    rows = [layout.values(layout.flat(payload)) for payload in packages if draw.random() >= lost]
    columns: dict[str, array[float]] = {}
    for name in variables[1:]:
        first = rows[0][name]
        if isinstance(first, tuple):
            for place in range(len(first)):
                columns[f"{name}.{place}"] = array("d", [row[name][place] for row in rows])
        else:
            columns[name] = array("d", [float(row[name]) for row in rows])
    if noise_rad:
        for place in range(6):
            column = columns[f"actual_joint_positions.{place}"]
            for row, value in enumerate(column):
                column[row] = value + draw.gauss(0.0, noise_rad)
    t = array("d", [row["timestamp"] + phase_s for row in rows])
    arrived = array("d", [time - t[0] + draw.random() * jitter_s for time in t])
    gaps = tuple((before, now) for before, now in pairwise(t) if now - before > 1.5 / hz)
    assert run.state, program
    return Recording(t, arrived, columns, hz, gaps, facts={"model": robot.model.name, **(facts or {})})
