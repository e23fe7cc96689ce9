"""A robot goes on where another one ended."""

from elitescript.kernel import Kernel, RobotOptions
from elitescript.kernel.restart import restored_inputs, restored_options
from elitescript.messages.enums import AnalogDomain, RobotMode, SafetyMode, TaskState
from elitescript.messages.inputs import Do, RunUnit, SetRemote
from elitescript.messages.machine import (
    AskSafety,
    SetAnalogDomain,
    SetPayload,
    SetSpeedScale,
    SetTcp,
    WritePortCoils,
    WritePortRegisters,
    WriteSignal,
)

TCP = (0.1, 0.0, 0.2, 0.0, 0.5, 0.0)


def do(*requests):
    return [Do("test", request) for request in requests]


def restarted(kernel: Kernel, config: RobotOptions, first_tick: int):
    """A kernel that goes on, and what it says in its first tick."""
    last = kernel.tick_and_snapshot().snapshot
    fresh = Kernel(restored_options(config, kernel.description, last, first_tick))
    return last, fresh, fresh.tick_and_snapshot(restored_inputs(last))


class TestRestart:
    def test_keeps_what_the_last_picture_shows(self):
        config = RobotOptions(power_on=True)
        kernel = Kernel(config)
        kernel.tick_and_snapshot(
            [
                *do(
                    SetTcp(TCP),
                    SetPayload(1.5, (0.0, 0.01, 0.02)),
                    SetSpeedScale(0.5),
                    SetAnalogDomain("standard_analog_out", 1, AnalogDomain.CURRENT),
                    WriteSignal("flag", 3, True),
                    WriteSignal("output_int_register", 5, -7),
                    WriteSignal("input_float_register", 47, 0.1),
                    WriteSignal("standard_digital_out", 2, True),
                    WritePortRegisters(256, (700, 65535)),
                    WritePortCoils(60, (True, False, True)),
                ),
                RunUnit("test", "program", "def p():\n  movej([0.1, -1.4, -1.6, -1.5, 1.5, 0.2])\n"),
                SetRemote("test", False),
            ]
        )
        for _ in range(150):
            kernel.tick_and_snapshot()
        last, _, output = restarted(kernel, config, 1000)
        now = output.snapshot
        assert now.robot.q_actual == last.robot.q_actual
        assert now.robot.q_actual != Kernel(config).tick_and_snapshot().snapshot.robot.q_actual
        assert now.robot.tcp_offset == TCP
        assert now.robot.payload == last.robot.payload
        assert now.robot.speed_scale == 0.5
        assert now.robot.robot_mode is RobotMode.RUNNING
        assert now.robot.task_state is TaskState.STOPPED
        assert now.signals == last.signals
        assert now.signals["general_register"][:2] == (700, 65535)
        assert now.signals["general_coil"][:3] == (True, False, True)
        assert now.domains == last.domains
        assert not now.is_remote

    def test_goes_on_with_its_time(self):
        _, fresh, output = restarted(Kernel(RobotOptions()), RobotOptions(), 1000)
        assert output.tick == output.snapshot.robot.tick == 1000
        assert fresh.tick_and_snapshot().snapshot.robot.time_s == 1001 / 250

    def test_an_arm_without_power_stays_so(self):
        _, _, output = restarted(Kernel(RobotOptions()), RobotOptions(power_on=True), 5)
        assert output.snapshot.robot.robot_mode is RobotMode.POWER_OFF

    def test_a_stopped_arm_stays_stopped(self):
        kernel = Kernel(RobotOptions(power_on=True))
        kernel.tick_and_snapshot(do(AskSafety("stop_protectively", "a test")))
        _, _, output = restarted(kernel, RobotOptions(power_on=True), 5)
        assert output.snapshot.robot.safety_mode is SafetyMode.PROTECTIVE_STOP

    def test_a_pressed_button_stays_pressed(self):
        kernel = Kernel(RobotOptions(power_on=True))
        kernel.tick_and_snapshot(do(WriteSignal("emergency_stop", 0, True)))
        _, fresh, _ = restarted(kernel, RobotOptions(power_on=True), 5)
        assert fresh.tick_and_snapshot().snapshot.robot.safety_mode is SafetyMode.ROBOT_EMERGENCY_STOP
