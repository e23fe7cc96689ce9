"""What newer clients (the vendor's SDK 1.4) do differently: plain commands and how they confirm them, longer messages,
more commands in their program.
"""

from __future__ import annotations

import struct
from math import cos, pi, sin

import pytest

from elitescript.devices.channels.network import Peer, VirtualNetwork
from elitescript.devices.memory import MemoryEnvironment
from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.events import Alarm, Warned
from elitescript.messages.inputs import Do
from elitescript.messages.machine import AskSafety
from elitescript.messages.outputs import OpenChannel
from elitescript.protocol.dashboard.connection import DashboardConnection
from elitescript.protocol.primary.connection import PrimaryConnection
from elitescript.robot import VirtualRobot
from tests.external_control.newer_control import PROGRAM
from tests.protocol import primary_client

REVERSE, TRAJECTORY, COMMANDS = 50001, 50003, 50004
MICRO = 1_000_000
POWER_OFF, IDLE, RUNNING = 3, 5, 7
NORMAL = 1
LOOP = "def work():\n while True:\n  sync()\n end\nend\n"


class Client:
    """A client of port 30001: sends lines, and polls the sub-messages 0 and 3."""

    def __init__(self, **config):
        self.kernel = Kernel(RobotOptions(**config))
        self.output = self.kernel.tick_and_snapshot()
        self.connection = PrimaryConnection("primary#1", self.kernel.description)
        self.inputs = []
        self.warnings = []
        self.mode = {}
        self.board = {}
        self.tick()

    def tick(self, *inputs):
        self.output = self.kernel.tick_and_snapshot([*self.inputs, *inputs])
        self.warnings += [event.text for event in self.output.events if isinstance(event, Warned)]
        self.connection.publish(self.output)
        self.inputs = self.connection.due()
        for message in self.connection.take():
            if message[4] == 16:
                parts = dict(primary_client.sub_messages(message))
                self.mode, self.board = primary_client.robot_mode(parts[0]), primary_client.master_board(parts[3])

    def send(self, text):
        self.inputs += self.connection.receive(text.encode(), self.output)

    def seconds_until(self, condition, limit_s, wait_s=0.0):
        """Robot time until a condition holds, looked at after every tick; waits first, as some confirmations do."""
        for tick in range(round(limit_s * 250)):
            if tick >= wait_s * 250 and condition(self):
                return tick / 250
            self.tick()
        raise AssertionError(f"not within {limit_s} s; {self.mode}, {self.warnings}")


def idle(client):
    client.send("power on\n")
    client.seconds_until(lambda c: c.mode["mode"] == IDLE, 30.0)


def running(client):
    client.send("set robotmode run\n")
    client.seconds_until(lambda c: c.mode["mode"] == RUNNING, 30.0)


def playing(client):
    running(client)
    client.send(LOOP)
    client.seconds_until(lambda c: c.mode["running"], 2.0)


def stopped_protectively(client):
    running(client)
    client.tick(Do("test", AskSafety("stop_protectively", "a test")))
    client.seconds_until(lambda c: c.mode["protective"], 1.0)
    for _ in range(5 * 250):
        client.tick()


def broken(client):
    client.tick(Do("test", AskSafety("fail", "a test")))
    client.seconds_until(lambda c: c.board["safety"] != NORMAL, 1.0)


CONFIRMATIONS = [
    ("power on", lambda c: None, lambda c: c.mode["mode"] in (IDLE, RUNNING), 30.0, 0.0),
    ("power off", running, lambda c: c.mode["mode"] == POWER_OFF, 30.0, 0.5),
    ("set robotmode run", idle, lambda c: c.mode["mode"] == RUNNING, 30.0, 0.0),
    ("pause task", playing, lambda c: c.mode["paused"], 30.0, 0.0),
    ("stop task", playing, lambda c: not c.mode["running"] and not c.mode["paused"], 30.0, 0.0),
    ("set unlock protective stop", stopped_protectively, lambda c: not c.mode["protective"], 5.0, 0.0),
    ("restart safetyboard", broken, lambda c: c.board["safety"] == NORMAL, 30.0, 0.5),
    ("set speed 0.37", lambda c: None, lambda c: round(c.mode["slider"] * 100) == 37, 3.0, 0.0),
]


@pytest.mark.parametrize(
    ("line", "prepare", "confirmed", "limit_s", "wait_s"), CONFIRMATIONS, ids=lambda v: str(v)[:30]
)
def test_a_plain_command_is_confirmed_in_time(line, prepare, confirmed, limit_s, wait_s):
    client = Client()
    prepare(client)
    assert not confirmed(client)
    client.send(f"{line}\n")
    assert client.seconds_until(confirmed, limit_s, wait_s) < limit_s / 2
    assert client.warnings == []


def test_the_first_state_comes_within_two_seconds():
    client = Client()
    assert client.seconds_until(lambda c: c.mode and c.board, 2.0) <= 0.1


def test_a_command_that_is_refused_is_a_warning_that_says_why():
    client = Client()
    stopped_protectively(client)
    client.tick(Do("test", AskSafety("stop_protectively", "again")))
    client.send("pause task\n")
    client.tick()
    assert client.warnings == ["cannot pause: no task is running"]


@pytest.mark.parametrize(
    ("line", "reply", "is_remote"),
    [
        ("remoteControl -s", "Remote control is on", True),
        ("remoteControl -status", "Remote control is on", True),
        ("remoteControl -off", "Remote control is off", False),
        ("remoteControl -on", "Remote control is on", True),
    ],
)
def test_remote_control_is_switched_and_asked_for_on_the_dashboard(line, reply, is_remote):
    kernel = Kernel(RobotOptions())
    output = kernel.tick_and_snapshot()
    shell = DashboardConnection("dashboard#1", kernel.description)
    shell.take()
    inputs = shell.receive(f"{line}\n".encode(), output)
    assert shell.take() == [f"{reply}\r\n".encode()]
    assert kernel.tick_and_snapshot(inputs).snapshot.is_remote is is_remote


class _Accepted(Peer):
    def __init__(self, link, pc, port):
        super().__init__(link)
        self.pc = pc
        self.port = port

    def opened(self):
        self.pc.links[self.port] = self.link

    def received(self, data):
        self.pc.sent[self.port] += data


class Pc:
    """A computer with the three servers of a newer driver."""

    def __init__(self):
        self.links = {}
        self.sent = dict.fromkeys((REVERSE, TRAJECTORY, COMMANDS), b"")
        self.channels = VirtualNetwork({port: self._server(port) for port in self.sent})
        self.robot = VirtualRobot(world=MemoryEnvironment(channels=self.channels))
        self.run = self.robot.start(PROGRAM)
        self.robot.advance(0.05)

    def _server(self, port):
        return lambda link: _Accepted(link, self, port)

    def send(self, port, *numbers):
        self.links[port].send(struct.pack(f">{len(numbers)}i", *numbers))
        self.robot.advance(0.02)

    def command(self, mode, values=(0, 0, 0, 0, 0, 0), frame=-1, timeout_ms=0):
        self.send(REVERSE, timeout_ms, *values, frame, mode)

    def point(self, values, *, time_s=0.0, speed=0.0, acceleration=0.0, is_cartesian=False, frame=-1):
        numbers = [round(value * MICRO) for value in (*values, speed, acceleration)] + [0] * 10
        self.send(TRAJECTORY, *numbers, round(time_s * 1000), 0, int(is_cartesian), frame)

    def script_command(self, number, *values):
        self.send(COMMANDS, number, *values, *[0] * (25 - len(values)))

    def events(self):
        """What came back of the trajectory: lists of ten numbers."""
        data = self.sent[TRAJECTORY]
        assert len(data) % 40 == 0
        return [struct.unpack_from(">10i", data, at) for at in range(0, len(data), 40)]

    def end(self):
        self.command(-2)
        self.robot.advance(0.2)
        assert (self.run.state, [event for event in self.run.events if isinstance(event, Alarm)]) == ("finished", [])


@pytest.fixture
def pc():
    return Pc()


def micro(values):
    return [round(value * MICRO) for value in values]


def test_each_point_of_a_trajectory_is_reported_with_ten_numbers(pc):
    start = pc.robot.state.q_actual
    first, second = [*start[:5], start[5] + 0.2], [*start[:5], start[5] - 0.1]
    pc.command(3, (1, 2, 0, 0, 0, 0))
    pc.point(first, time_s=0.5)
    pc.point(second, speed=1.0, acceleration=2.0)
    pc.robot.advance(3.0)
    kinds = [event[:4] for event in pc.events()]
    assert kinds == [(1, 0, 2, -1), (2, 0, 2, -1), (1, 1, 2, -1), (2, 1, 2, -1), (3, 2, 2, 0)]
    assert list(pc.events()[0][4:]) == micro(first)
    assert pc.robot.state.q_actual == pytest.approx(second, abs=1e-6)
    pc.end()


def test_a_cartesian_point_counts_in_its_user_frame(pc):
    pose = pc.robot.state.tcp_pose_actual
    frame = [0.0, 0.0, 0.05, 0.0, 0.0, 0.0]
    pc.script_command(12, 1, *micro(frame))
    pc.command(3, (1, 1, 0, 0, 0, 0))
    pc.point(pose, time_s=1.0, is_cartesian=True, frame=1)
    pc.robot.advance(2.0)
    moved = [after - before for after, before in zip(pc.robot.state.tcp_pose_actual, pose, strict=True)]
    assert moved[:3] == pytest.approx([0.0, 0.0, 0.05], abs=2e-6)
    pc.end()


def test_a_command_has_its_mode_at_the_end_and_a_user_frame_before(pc):
    z = pc.robot.state.tcp_pose_actual[2]
    for _ in range(10):
        pc.command(4, micro([0.0, 0.0, -0.02, 0.0, 0.0, 0.0]))
    assert pc.robot.state.tcp_pose_actual[2] < z
    pc.end()


def test_the_mounting_and_the_collision_detection_are_set(pc):
    turn, tilt = pi / 6, pi / 4
    pc.script_command(11, *micro([turn, tilt]))
    pc.script_command(9, 1)
    pc.script_command(10, 60)
    g = 9.82
    assert pc.robot.state.gravity == pytest.approx(
        [g * sin(tilt) * cos(turn), g * sin(tilt) * sin(turn), g * cos(tilt)], abs=1e-5
    )
    assert pc.robot.controller.setup.options == {"collision_detect_enabled": True, "dyn_collision_force_min_ratio": 60}
    pc.end()


def test_kinematics_are_answered_with_six_numbers(pc):
    q = pc.robot.state.q_actual
    tcp = [0.0, 0.0, 0.1, 0.0, 0.0, 0.0]
    pc.script_command(6, *micro(q), *micro(tcp))
    pose = struct.unpack(">6i", pc.sent[COMMANDS])
    pc.sent[COMMANDS] = b""
    pc.script_command(5, *pose, *micro(q), *micro(tcp))
    assert struct.unpack(">6i", pc.sent[COMMANDS]) == pytest.approx(micro(q), abs=20)
    pc.end()


def test_bytes_are_sent_as_a_list(pc):
    pc.script_command(7)
    assert pc.sent[COMMANDS] == b"\x01\x02\xff"
    pc.end()


def test_the_program_is_uploaded_in_one_piece():
    client = Client()
    client.send(f"{PROGRAM}\n")
    client.seconds_until(lambda c: any(isinstance(asked, OpenChannel) for asked in c.output.requests), 2.0)
    assert (client.warnings, client.output.snapshot.task.running) == ([], "control")
