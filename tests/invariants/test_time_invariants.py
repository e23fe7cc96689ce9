"""Leaping cannot be told from stepping, and the same run is the same twice."""

from random import Random

import pytest

from elitescript import PlantConfig, VirtualRobot
from elitescript.messages.events import Alarm
from elitescript.messages.machine import PauseTask, ResumeTask, SetSpeedScale
from elitescript.runtime.environment import EmptyEnvironment
from tests.invariants.cases import CASES
from tests.invariants.random_programs import random_program

COUNT = CASES

PLANTS = (
    None,
    PlantConfig(lag_s=0.02),
    PlantConfig(lag_s=0.03, noise_rad=1e-5, viscous_friction=0.1, coulomb_friction=0.05, seed=3),
)


def outcome(seed, pace):
    generator = Random(seed)
    program = random_program(generator)
    robot = VirtualRobot("CS66", seed=seed, world=EmptyEnvironment(), plant=PLANTS[seed % len(PLANTS)])
    for _ in range(generator.randrange(0, 6)):
        name = f"standard_digital_in[{generator.randrange(4)}]"
        robot.at(generator.uniform(0.0, 4.0), name, generator.random() < 0.7)
    for _ in range(generator.randrange(0, 3)):
        tick = generator.randrange(0, 800)
        robot.controller.put(tick, SetSpeedScale(generator.choice((0.05, 0.4, 1.0))))
    if generator.random() < 0.5:
        tick = generator.randrange(0, 500)
        robot.controller.put(tick, PauseTask())
        robot.controller.put(tick + generator.randrange(0, 200), ResumeTask())
    robot.set_speed(generator.choice((1.0, 1.0, 0.5, 0.13)))
    run = robot.run(program, until_s=30.0, trace=True, trace_step_s=0.02, pace=pace)
    warmth = robot.controller.joint_temperatures
    return (program, run.state, run.time_s, run.events, run.trace, run.globals, run.joints, run.signals, warmth)


@pytest.mark.invariants
@pytest.mark.parametrize("seed", range(max(COUNT, 10)))
def test_leaping_equals_stepping(seed, finding):
    leaped = outcome(seed, None)
    stepped = outcome(seed, lambda tick: None)
    for mine, other in zip(leaped, stepped, strict=True):
        assert mine == other
    # A motion at a speed may lead to the end of a joint's range or a singularity, which is a protective stop.
    alarms = {event.code for event in leaped[3] if isinstance(event, Alarm)}
    assert leaped[1] in ("finished", "time_limit") or alarms == {"R140"}, leaped[0]
    finding(
        "leaping against stepping", f"{max(COUNT, 10)} programs, each run both ways", "the same record to the last bit"
    )
