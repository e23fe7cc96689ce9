"""The program of a driver is uploaded: to a robot without power, again and again, and stopped from outside."""

from __future__ import annotations

from elitescript.kernel import Kernel, RobotOptions
from elitescript.language.text.units import UnitSplitter
from elitescript.messages.events import Alarm
from elitescript.messages.inputs import Do, RunUnit
from elitescript.messages.machine import PowerOff, StopTask
from elitescript.messages.outputs import CloseChannel, CreditChannel, OpenChannel, SendChannel
from tests.external_control.control import PROGRAM
from tests.external_control.pc import COMMANDS, REVERSE, SERVOJ, SPEEDJ, TRAJECTORY, Pc

ALL = [REVERSE, TRAJECTORY, COMMANDS]


class Session:
    """A kernel, and a computer that holds its programs' connections."""

    def __init__(self, **config):
        self.pc = Pc()
        self.kernel = Kernel(RobotOptions(**config))
        self.alarms = []

    def run(self, duration_s, *inputs):
        """Let time go by; what is asked for comes in its first tick."""
        pending = list(inputs)
        for _ in range(round(duration_s * 250)):
            arrivals = self.pc.channels.arrivals(self.kernel.next_tick)
            output = self.kernel.tick_and_snapshot([*pending, *arrivals])
            pending = []
            self.alarms += [event for event in output.events if isinstance(event, Alarm)]
            for request in output.requests:
                self._carry_out(request)
        return output.snapshot

    def _carry_out(self, request):
        channels = self.pc.channels
        match request:
            case OpenChannel(number, "tcp", address, port, timeout_s):
                assert channels.open(address, port, timeout_s) == number
            case SendChannel(number, data):
                channels.send(number, data)
            case CreditChannel(number, size):
                channels.credit(number, size)
            case CloseChannel(number):
                channels.close(number)

    def upload(self):
        """What arrives when a client uploads the program."""
        (unit,) = UnitSplitter().receive(f"{PROGRAM}\n".encode())
        return RunUnit("primary#1", unit.kind, unit.text, unit.first_line)


def test_it_runs_and_ends_without_power():
    session = Session()
    session.run(0.1, session.upload())
    assert session.pc.accepted == ALL
    session.pc.stop()
    session.run(0.1)
    assert (len(session.pc.closed), session.alarms) == (3, [])


def test_a_second_upload_takes_the_place_of_the_first():
    session = Session()
    session.run(0.1, session.upload())
    session.run(0.1, session.upload())
    assert session.pc.accepted == ALL * 2
    assert [port for port, _ in session.pc.closed] == ALL


def test_the_next_upload_may_come_while_the_last_one_still_ends():
    session = Session()
    session.run(0.1, session.upload())
    session.pc.stop()
    session.run(0.008)
    session.run(0.1, session.upload())
    assert session.pc.accepted == ALL * 2
    assert len(session.pc.closed) == 3


def test_with_power_it_moves_the_arm():
    session = Session(power_on=True)
    start = session.run(0.1, session.upload()).robot.q_actual
    for step in range(50):
        session.pc.command(SERVOJ, [*start[:5], start[5] + 0.0005 * step], 100)
        end = session.run(0.004).robot.q_actual
    assert end[5] - start[5] > 0.01


def test_a_stop_from_the_dashboard_and_a_loss_of_power_close_the_connections():
    for request in (StopTask(), PowerOff()):
        session = Session(power_on=True)
        session.run(0.1, session.upload())
        session.pc.command(SPEEDJ, [0, 0, 0, 0, 0, 0.1])
        session.run(0.2)
        session.run(0.02, Do("dashboard#1", request))
        assert len(session.pc.closed) == 3
