"""A world: one time, one seed, devices whose code fails."""

from __future__ import annotations

from pathlib import Path

import pytest

from elitescript.errors import UsageError
from elitescript.messages.events import DeviceNoted
from elitescript.testing.world import Device, DeviceError, Fault, Parts, Schedule, SerialDevice, TcpServer, Wire, World
from tests.devices.programs import robot_in, run


class Noisy(TcpServer):
    """Answers after a random time, and talks by itself."""

    port = 5000
    jitter_s = 0.05

    def opened(self, connection):
        self.every(0.37, lambda: connection.send_line(f"{self.random.random():.6f}"))

    def line_received(self, connection, line):
        self.after(self.random.random(), connection.send_line, line.upper())


class Scale(SerialDevice):
    line = "tool"

    def started(self):
        self.every(0.05, lambda: self.send(f"{self.random.gauss(1, 0.1):.4f}"))


def busy_world(seed):
    return World(
        devices=[
            Noisy(),
            Scale(),
            Schedule(signal="standard_digital_in[7]", at=[(0.1, True), (0.25, False)], every_s=0.9),
            Parts(
                counts_per_m=1000,
                speed_m_s=0.3,
                pitch_m=0.2,
                jitter_m=0.05,
                sensor="standard_digital_in[3]",
                sensor_m=0.5,
            ),
        ],
        wires=[Wire(when="standard_digital_out[0]", then="standard_digital_in[1]", after_s=0.3)],
        seed=seed,
    )


BUSY = """
socket_open("h", 5000)
tool_serial_config(True, 9600, 0, 1, 8, False)
for n in range(12):
  set_standard_digital_out(0, n % 2 == 0)
  socket_send_line("abc")
  textmsg(socket_read_string("socket_0", "", "\\n", 0.3))
  textmsg(tool_serial_read(9, False, 0.2))
  movej([0.1 * n, -1.57, -1.57, -1.57, 1.57, 0], a=3, v=3)
end
"""


def test_leaps_cannot_be_told_from_steps():
    assert (
        run(BUSY, robot=robot_in(busy_world(5))).events == run(BUSY, robot=robot_in(busy_world(5)), steps=True).events
    )


def test_a_seed_gives_the_same_run_and_another_seed_another_one():
    first, again, other = (run(BUSY, robot=robot_in(busy_world(seed))).events for seed in (1, 1, 2))
    assert first == again
    assert first != other


def test_a_device_that_fails_ends_the_run_and_is_named_with_file_and_line():
    class Broken(TcpServer):
        port = 5000

        def line_received(self, connection, line):
            return 1 / 0  # here

    line = next(n for n, text in enumerate(Path(__file__).read_text().splitlines(), 1) if text.endswith("0  # here"))
    with pytest.raises(DeviceError) as caught:
        run('socket_open("h", 5000)\nsocket_send_line("x")\nsleep(1)', Broken(name="eye"))
    assert str(caught.value) == f"{__file__}:{line}: device eye (Broken): ZeroDivisionError: division by zero"


@pytest.mark.parametrize("method", ["started", "signal_changed", "opened", "received", "closed"])
def test_whatever_fails_is_caught_where_it_is_called(method):
    class Broken(TcpServer):
        port = 5000

    setattr(Broken, method, lambda self, *rest: [][1])
    body = 'socket_open("h", 5000)\nsocket_send_line("x")\nset_standard_digital_out(0, True)\nsocket_close()\nsleep(1)'
    with pytest.raises(DeviceError, match="device Broken: IndexError"):
        run(body, Broken())


def test_somebody_who_is_told_of_failures_goes_on_without_the_device():
    class Broken(TcpServer):
        port = 5000

        def started(self):
            self.every(0.01, lambda: None)

        def line_received(self, connection, line):
            raise ValueError("oops")

    world, told = World(devices=[Broken()]), []
    world.on_device_failure = told.append
    body = """
socket_open("h", 5000)
socket_send_line("x")
sleep(0.1)
textmsg(socket_is_connected())
textmsg(socket_open("h", 5000))
"""
    assert run(body, robot=robot_in(world)).log == ["False", "False"]
    assert ["ValueError: oops" in str(error) for error in told] == [True]


def test_a_device_that_has_failed_does_nothing_any_more():
    class Broken(Device):
        def started(self):
            self.every(0.01, self.beat)
            self.cell.watch("standard_digital_out[0]", self.seen)

        def beat(self):
            raise ValueError("beat")

        def seen(self, level):
            raise ValueError("seen")

    world, told = World(devices=[Broken()]), []
    world.on_device_failure = told.append
    run("sleep(0.1)\nset_standard_digital_out(0, True)\nsleep(0.1)", robot=robot_in(world))
    assert ["ValueError: beat" in str(error) for error in told] == [True]


def test_a_call_for_a_signal_fails_in_the_name_of_the_device():
    class Broken(Device):
        def started(self):
            self.cell.watch("standard_digital_out[0]", lambda level: 1 / 0)

    with pytest.raises(DeviceError, match=r"test_world\.py:\d+: device Broken: ZeroDivisionError"):
        run("set_standard_digital_out(0, True)\nsleep(0.1)", Broken())


def test_a_world_belongs_to_one_robot():
    world = World()
    robot_in(world)
    with pytest.raises(UsageError, match="belongs to another robot already"):
        robot_in(world)


def test_words_of_devices_are_in_the_record():
    class Talker(Device):
        def started(self):
            self.after(0.5, self.log, "half a second")
            self.after(0.6, self.warn, "too late")

    found = run("sleep(1)", Talker())
    notes = [event for event in found.events if isinstance(event, DeviceNoted)]
    assert notes == [
        DeviceNoted(125, "Talker", "half a second", False),
        DeviceNoted(150, "Talker", "too late", True),
    ]
    assert found.warnings == ["Talker: too late"]


def test_a_device_reads_and_sets_signals_and_hears_of_them():
    seen = []

    class Gripper(Device):
        def signal_changed(self, name, value):
            seen.append((self.cell.time_s, name, value))
            if name == "standard_digital_out[0]":
                self.cell.set("standard_digital_in[1]", value, after_s=0.3)

        def started(self):
            assert self.cell.read("standard_digital_out[0]") is False
            self.cell.pulse("standard_digital_in[2]", 0.1, after_s=0.05)

    body = """
set_standard_digital_out(0, True)
while not get_standard_digital_in(1):
  sync()
end
"""
    assert run(body, Gripper()).time_s == 0.3
    assert seen == [
        (0.0, "standard_digital_out[0]", True),
        (0.052, "standard_digital_in[2]", True),
        (0.152, "standard_digital_in[2]", False),
        (0.3, "standard_digital_in[1]", True),
    ]


def test_what_a_device_does_in_no_time_reaches_the_robot_in_the_next_tick():
    class Mirror(Device):
        def started(self):
            self.cell.watch("standard_digital_out[0]", lambda level: self.cell.set("standard_digital_in[0]", level))

    read = "textmsg(get_standard_digital_in(0))"
    body = f"set_standard_digital_out(0, True)\n{read}\nsync()\n{read}"
    assert run(body, Mirror()).log == ["False", "True"]


@pytest.mark.parametrize(
    "act, words",
    [
        (lambda device: device.cell.set("standard_digital_in[99]", True), "indices 0 to 15, not 99"),
        (lambda device: device.cell.set("standard_digital_in[0]", 3), "takes True or False"),
        (lambda device: device.cell.set("standard_digital_in[0]", True, after_s=-1), "after_s must be >= 0 s"),
        (lambda device: device.cell.read("nothing"), "no signal is called 'nothing'"),
        (lambda device: device.every(0, print), "the period must be > 0 s"),
    ],
)
def test_what_a_device_asks_wrongly_is_said_with_its_line(act, words):
    class Wrong(Device):
        def started(self):
            act(self)

    with pytest.raises(DeviceError, match=rf"test_world\.py:\d+: device Wrong: UsageError: .*{words}"):
        run("sleep(1)", Wrong())


def test_a_device_without_a_world_says_where_its_begin_belongs():
    with pytest.raises(UsageError, match="what it does at the start belongs into `started`"):
        Device().after(1.0, print)


def test_a_world_is_made_of_devices():
    with pytest.raises(UsageError, match="a world is made of devices and wires, not of 'camera'"):
        World(devices=["camera"])


def test_nothing_of_a_program_is_left_when_it_ends_in_the_middle():
    class Slow(TcpServer):
        port = 5000

        def closed(self, connection):
            self.log("closed")

    world = World(devices=[Slow()])
    robot = robot_in(world)
    found = run('socket_open("h", 5000)\nsocket_send_line("x")\nraise ValueError("x")', robot=robot)
    assert found.state == "alarm"
    robot.advance(0.1)
    assert world.network.open_channels == 0


def test_what_a_test_asks_of_a_device_between_two_runs_counts_from_then():
    class Button(Device):
        def press(self):
            self.after(0.5, self.cell.set, "standard_digital_in[0]", True)

    button = Button()
    robot = robot_in(World(devices=[button]))
    robot.advance(10.0)
    button.press()
    robot.advance(0.4)
    assert robot.signals["standard_digital_in[0]"] is False
    robot.advance(0.2)
    assert robot.signals["standard_digital_in[0]"] is True


class Misspelt(TcpServer):
    port = 5000

    def line_recieved(self, connection, line):
        connection.send_line(line)

    def answer(self, connection):
        """A name of its own."""


def test_a_method_that_nothing_calls_is_told_of():
    result = run("sync()", Misspelt())
    notes = [event.text for event in result.events if isinstance(event, DeviceNoted)]
    assert notes == ["nothing calls line_recieved(); is it meant to be line_received()?"]


@pytest.mark.parametrize("on", [5001, "10.0.0.1:5001", "tool"])
def test_a_fault_where_nothing_is_is_refused(on):
    kind = "silence"
    with pytest.raises(UsageError, match=r"^on: no device of this world is at "):
        World(devices=[Noisy()], faults=[Fault(kind, on)])
    world = World(devices=[Noisy()])
    with pytest.raises(UsageError, match=r"^on: no device of this world is at "):
        world.fault(kind, on)
    assert World(devices=[Noisy()], faults=[Fault(kind, on)], network="real").faults
