"""Programs against devices: what the tests of devices share."""

from __future__ import annotations

from elitescript import VirtualRobot
from elitescript.testing.world import World


def robot_in(world):
    return VirtualRobot("CS66", world=world)


def run(body, *devices, steps=False, robot=None, until_s=100.0, **of_the_world):
    """Run the body of a program beside devices; `steps` looks at every tick."""
    robot = robot or robot_in(World(devices=devices, **of_the_world))
    text = "def main():\n" + "".join(f"  {line}\n" for line in body.strip("\n").split("\n")) + "end\n"
    return robot.run(text, until_s=until_s, pace=(lambda tick: None) if steps else None)
