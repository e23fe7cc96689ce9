"""The snapshot that ports publish."""

from __future__ import annotations

from dataclasses import replace

import pytest

from elitescript.controller.modes import PowerTimes
from elitescript.controller.views.snapshots import SnapshotBuilder, elbow_velocity
from elitescript.errors import UsageError
from elitescript.messages.enums import AnalogDomain, RobotMode
from elitescript.messages.machine import PauseTask, PowerOff, SetAnalogDomain, SetTcp, WriteSignal
from elitescript.messages.signals import SIGNALS
from elitescript.messages.snapshot import TaskPicture
from elitescript.messages.state import ZERO_SIX
from elitescript.models.model import load_model
from elitescript.robot import VirtualRobot

TASK = TaskPicture("", "", "", is_saved=True, is_configuration_modified=False)
MOVE = "movej([0.5, -1.2, -1.5, -1.4, 1.5, 0.2], v=0.3)"


class Cell:
    def __init__(self, program: str = "", **options) -> None:
        self.robot = VirtualRobot(**options)
        self.pictures = SnapshotBuilder(self.robot.controller)
        if program:
            self.robot.start(program)

    def look(self):
        return self.pictures.picture(TASK, "", is_remote=True)

    def wait(self, duration_s):
        self.robot.advance(duration_s)
        return self.look()


def test_the_robot_is_that_of_the_same_tick():
    cell = Cell(MOVE)
    picture = cell.wait(0.5)
    assert picture.robot == cell.robot.state


def test_a_moving_arm_has_torques_currents_and_a_moving_elbow():
    cell = Cell(MOVE)
    picture = cell.wait(0.5)
    torques, currents = cell.robot.controller.loads.measured(cell.robot.tick)
    assert (picture.joint_torques, picture.joint_currents) == (torques, currents)
    assert any(picture.elbow_velocity)
    assert picture.robot_current > sum(map(abs, currents))


def test_a_resting_arm_is_worked_out_once():
    cell = Cell()
    assert cell.look().joint_torques is cell.wait(1.0).joint_torques


@pytest.mark.parametrize(
    ("change", "field"),
    [
        (WriteSignal("external_wrench", 0, 10.0), "tcp_force"),
        (SetTcp((0.0, 0.0, 0.1, 1.0, 0.0, 0.0)), "tcp_force"),
        (PowerOff(), "joint_currents"),
    ],
)
def test_a_resting_arm_is_worked_out_anew_when_something_changes(change, field):
    cell = Cell()
    cell.robot.signals["external_wrench[1]"] = 3.0
    before = getattr(cell.look(), field)
    cell.robot.controller.request(change)
    assert getattr(cell.wait(0.1), field) != before


def test_an_arm_without_power_takes_none():
    cell = Cell()
    cell.robot.controller.request(PowerOff())
    picture = cell.wait(0.1)
    assert picture.robot.robot_mode is RobotMode.POWER_OFF
    assert (picture.joint_torques, picture.joint_currents, picture.joint_voltages) == (ZERO_SIX,) * 3
    assert (picture.robot_voltage, picture.robot_current) == (0.0, 0.0)


def test_every_family_of_signals_is_there_and_earlier_pictures_keep_theirs():
    cell = Cell()
    before = cell.look()
    cell.robot.signals["standard_digital_out[3]"] = True
    assert before.signals["standard_digital_out"] == (False,) * 16
    assert cell.look().signals["standard_digital_out"][3] is True
    assert {name: len(values) for name, values in before.signals.items()} == {
        name: row.size for name, row in SIGNALS.items()
    }


def test_analog_domains_are_told():
    cell = Cell()
    cell.robot.controller.request(SetAnalogDomain("standard_analog_out", 1, AnalogDomain.CURRENT))
    assert cell.look().domains["standard_analog_out"] == (AnalogDomain.VOLTAGE, AnalogDomain.CURRENT)


def test_a_resting_arm_feels_the_sensor_of_a_client_as_soon_as_a_program_asks_for_it():
    cell = Cell("sleep(0.1)\nft_rtsi_input_enable(True, 0.0, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0])\nsleep(1)")
    for index in range(6):
        cell.robot.controller.request(WriteSignal("external_force_torque", index, 7.0))
    assert cell.look().tcp_force == ZERO_SIX
    assert cell.wait(0.5).tcp_force != ZERO_SIX


def test_speed_scaling_follows_the_slider_in_a_ramp_and_is_zero_in_a_pause():
    cell = Cell(MOVE)
    cell.robot.advance(0.5)
    cell.robot.set_speed(0.5)
    assert cell.wait(0.1).speed_scaling == pytest.approx(0.75, abs=0.05)
    assert cell.wait(0.2).speed_scaling == 0.5
    cell.robot.controller.request(PauseTask())
    assert cell.wait(1.0).speed_scaling == 0.0


def test_a_guided_arm_is_told():
    cell = Cell("freedrive_mode()\nsleep(5)")
    assert cell.wait(0.1).is_freedrive


def test_the_elbow_moves_as_its_places_say():
    model = load_model("CS66")
    q, qd, h = (0.3, -1.0, 0.7, 0.1, 0.2, 0.3), (0.5, -0.4, 9.0, 9.0, 9.0, 9.0), 1e-6
    later = model.arm.elbow([a + h * w for a, w in zip(q, qd, strict=True)])
    wanted = [(b - a) / h for a, b in zip(model.arm.elbow(q), later, strict=True)]
    assert elbow_velocity(model.arm, q, qd) == pytest.approx(wanted, abs=1e-5)
    assert elbow_velocity(model.arm, q, ZERO_SIX) == (0.0, 0.0, 0.0)


def test_times_of_power_are_checked():
    with pytest.raises(UsageError, match="-1"):
        replace(PowerTimes(), boot_s=-1.0)
