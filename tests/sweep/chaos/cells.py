"""Worlds and programs that tests of chaos disturb."""

from __future__ import annotations

from random import Random

from elitescript import VirtualRobot
from elitescript.run import Run
from elitescript.sweep.chaos.ground import Ears, Ground, survey
from elitescript.testing.world import TcpConnection, TcpServer, Wire, World

GRIPPER = r"""
def cell():
  SENSOR = 4
  socket_open("10.0.0.9", 5000, "gripper")
  for n in range(3):
    socket_send_string("close\n", "gripper")
    answer = socket_read_string("gripper", "", "", 1.0)
    set_standard_digital_out(1, True)
    while not get_standard_digital_in(SENSOR):
      sync()
    end
    set_standard_digital_out(1, False)
    sleep(1)
  end
end
"""


class Gripper(TcpServer):
    """Answers each line."""

    name = "gripper"
    port = 5000
    latency_s = 0.1

    def line_received(self, connection: TcpConnection, line: str) -> str:
        """Acknowledge."""
        return "ok"


def world(**more: object) -> World:
    """Return a world with a gripper at port 5000, and a sensor on input 4 that follows output 1."""
    sensor = Wire(name="sensor", when="standard_digital_out[1]", then="standard_digital_in[4]", after_s=0.2)
    unread = Wire(when="standard_digital_out[2]", then="standard_digital_in[5]")
    register = Wire(when="standard_digital_out[2]", then="input_bool_register[5]")
    return World([Gripper()], [sensor, unread, register], **more)  # type: ignore[arg-type]


def surveyed(program: str = GRIPPER, beside: World | None = None) -> tuple[Ground, VirtualRobot, Run]:
    """Return what there is to disturb, the robot and its plain run."""
    robot = VirtualRobot("CS66", world=beside or world(), task_dir={})
    ears = Ears(robot)
    run = robot.run(program, until_s=60)
    return survey(robot, run, ears.heard), robot, run


def source(seed: int, run: int, name: str) -> Random:
    """Return the source of random numbers of a run for a name."""
    return Random(f"{seed}/{run}/{name}")
