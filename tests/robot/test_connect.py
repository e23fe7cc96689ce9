"""Clients of every port in memory and robot time: `VirtualRobot.connect`."""

from __future__ import annotations

import doctest
import struct
from itertools import pairwise

import pytest

from elitescript import VirtualRobot
from elitescript.errors import UsageError
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Alarm, DeviceNoted, Popup, TextMessage, Warned
from elitescript.testing.world import TcpClient, World
from tests.protocol import modbus_client, rtsi_client

PORTS = ["dashboard", "primary", "secondary", "realtime", "readonly", "rtsi", "interpreter", "query", "modbus"]
"""By hand, in the order of the manual's numbers."""

TICK_S = 0.004
HELLO = b'def hello():\n  textmsg("hello")\nend\n'
WAITING = b"def waiting():\n  while True:\n    sync()\n  end\nend\n"


def program(*lines: str) -> bytes:
    return b"def job():\n" + "".join(f"  {line}\n" for line in lines).encode() + b"end\n"


def texts(events) -> list[str]:
    return [event.text for event in events if isinstance(event, TextMessage)]


def primary_messages(stream: bytes) -> list[bytes]:
    """Cut a stream of a primary port into messages, each without its size."""
    found = []
    while stream:
        size = int.from_bytes(stream[:4])
        found.append(stream[4:size])
        stream = stream[size:]
    return found


def states(stream: bytes) -> list[bytes]:
    return [message for message in primary_messages(stream) if message[0] == 16]


def timestamps(stream: bytes) -> list[float]:
    """Of RTSI packages whose first variable is a `DOUBLE`."""
    return [struct.unpack_from(">d", body, 1)[0] for letter, body in rtsi_client.messages(stream) if letter == "U"]


def streaming(robot: VirtualRobot, frequency_hz: float = 250.0, names: tuple[str, ...] = ("timestamp",)):
    """A client that gets packages of these variables."""
    client = robot.connect("rtsi")
    client.send(rtsi_client.message("V", b"\0\1") + rtsi_client.output_recipe(frequency_hz, names))
    robot.advance(TICK_S)
    client.send(rtsi_client.message("S"))
    robot.advance(TICK_S)
    return client


class TestBytes:
    def test_what_is_sent_is_answered_by_the_next_tick(self):
        robot = VirtualRobot()
        client = robot.connect("dashboard")
        assert client.receive().startswith(b"EliRobot dashboard shell")
        client.send(b"robotMode\n")
        assert client.receive() == b""
        robot.advance(TICK_S)
        assert client.receive() == b"robotMode: RUNNING\r\n"

    def test_a_command_may_come_in_pieces(self):
        robot = VirtualRobot()
        client = robot.connect("dashboard")
        client.receive()
        for piece in (b"rob", b"otMo", b"de\n"):
            client.send(piece)
            robot.advance(TICK_S)
        assert client.receive() == b"robotMode: RUNNING\r\n"

    def test_a_part_of_what_has_come_may_be_received(self):
        client = VirtualRobot().connect("dashboard")
        assert (client.receive(3), client.receive(5)) == (b"Eli", b"Robot")

    @pytest.mark.parametrize("port", PORTS)
    def test_there_is_every_port(self, port):
        robot = VirtualRobot(firmware="2.14")
        client = robot.connect(port)
        assert client.is_open
        assert client.name == f"{port}#1"
        robot.advance(0.2)
        sends_by_itself = {"dashboard", "primary", "secondary", "realtime", "readonly"}
        assert bool(client.receive()) == (port in sends_by_itself)

    def test_another_port_is_refused_with_those_that_there_are(self):
        with pytest.raises(UsageError, match=r"the ports dashboard, .*, modbus, not 'telnet'"):
            VirtualRobot().connect("telnet")

    def test_a_misspelt_port_is_answered_with_the_one_that_was_meant(self):
        with pytest.raises(UsageError, match=r"not 'dashbord'; did you mean 'dashboard'\?"):
            VirtualRobot().connect("dashbord")

    def test_a_text_is_refused(self):
        with pytest.raises(TypeError, match=r"bytes are sent, not str; a text needs \.encode\(\)"):
            VirtualRobot().connect("dashboard").send("robotMode\n")  # type: ignore[arg-type]

    def test_an_old_firmware_has_no_interpreter_port(self):
        with pytest.raises(UsageError, match="not 'interpreter'"):
            VirtualRobot(firmware="2.10").connect("interpreter")

    def test_more_than_a_connection_takes_at_once_waits(self):
        robot = VirtualRobot()
        client = robot.connect("dashboard")
        client.receive()
        client.send(b"robotMode\n" * 250)
        robot.advance(TICK_S)
        first = client.receive().count(b"RUNNING")
        robot.advance(0.1)
        assert 0 < first < 250
        assert first + client.receive().count(b"RUNNING") == 250


class TestTime:
    def test_rtsi_gets_a_package_in_every_tick(self):
        robot = VirtualRobot()
        client = streaming(robot)
        client.receive()
        robot.advance(1.0)
        found = timestamps(client.receive())
        assert len(found) == 250
        assert all(later - earlier == pytest.approx(TICK_S) for earlier, later in pairwise(found))

    @pytest.mark.parametrize("port, count", [("primary", 10), ("realtime", 125)])
    def test_the_state_is_sent_at_the_rate_of_the_port(self, port, count):
        robot = VirtualRobot()
        client = robot.connect(port)
        robot.advance(TICK_S)
        client.receive()
        robot.advance(1.0)
        assert len(states(client.receive())) == count

    @pytest.mark.parametrize("frequency_hz", [250.0, 125.0, 60.0, 7.0, 1.0])
    def test_leaps_cannot_be_told_from_steps(self, frequency_hz):
        streams = []
        for steps in (False, True):
            robot = VirtualRobot()
            names = ("timestamp", "actual_joint_positions", "speed_scaling", "joint_temperatures")
            rtsi, primary = streaming(robot, frequency_hz, names), robot.connect("primary")
            robot.start("movej([0, -1, 1, -1, -1, 0], a=1, v=1)\nsleep(1)\nfor n in range(5):\n  textmsg(n)\nend")
            for _ in range(1000 if steps else 1):
                robot.advance(TICK_S if steps else 4.0)
            streams.append((rtsi.receive(), primary.receive()))
        assert streams[0] == streams[1]
        assert len(timestamps(streams[0][0])) >= 4 * frequency_hz

    def test_a_stream_begins_with_the_tick_before_the_start(self):
        assert timestamps(streaming(VirtualRobot()).receive()) == [0.0, TICK_S]

    def test_lines_that_are_no_script_are_reported_in_their_tick(self):
        found = []
        for steps in (False, True):
            events = []
            robot = VirtualRobot(on_event=events.append)
            client = robot.connect("primary")
            robot.advance(7 * TICK_S)  # the report is due between two states
            client.send(b"nonsense()\n" * 20)
            for _ in range(500 if steps else 1):
                robot.advance(TICK_S if steps else 2.0)
            found.append([(event.tick, event.text) for event in events if isinstance(event, Alarm | Warned)])
        assert found[0] == found[1]
        assert "10 more lines that are no script" in found[0][-1][1]

    def test_messages_that_wait_leave_seven_ticks_apart(self):
        robot = VirtualRobot()
        client = robot.connect("primary")
        robot.start("for n in range(4):\n  textmsg(n)\nend")
        robot.advance(TICK_S)
        client.receive()
        ticks: list[int] = []

        def watch(robot):
            ticks.extend(robot.tick for message in primary_messages(client.receive()) if message[0] == 20)

        robot.run("sleep(1)", watch=watch)
        waited = [tick for tick in ticks if tick < 50]  # those of the second program's end come a second later
        assert len(waited) > 3
        assert {later - earlier for earlier, later in pairwise(waited)} == {7}

    def test_time_leaps_to_what_is_sent_next(self):
        ticks: list[int] = []
        robot = VirtualRobot()
        robot.connect("primary")
        robot.run("sleep(10)", watch=lambda robot: ticks.append(robot.tick))
        assert set(ticks) - {0, 1, 2500, 2501} <= set(range(0, 2501, 25))

    def test_time_leaps_as_before_without_a_client_and_after_it(self):
        def ticks_of(robot):
            ticks: list[int] = []
            robot.run("sleep(3600)", watch=lambda robot: ticks.append(robot.tick))
            return len(ticks)

        robot = VirtualRobot()
        before = ticks_of(robot)
        client = robot.connect("rtsi")
        client.close()
        assert before < 5
        assert ticks_of(robot) <= before + 2

    @pytest.mark.parametrize("ports", [["dashboard"], ["rtsi", "modbus"], PORTS])
    def test_a_run_is_the_same_with_silent_clients(self, ports):
        script = "movej([0, -1, 1, -1, -1, 0])\nset_standard_digital_out(1, True)\nsleep(0.3)\ntextmsg(get_time())"
        alone = VirtualRobot().run(script, trace=True)
        robot = VirtualRobot()
        for port in ports:
            robot.connect(port)
        found = robot.run(script, trace=True)
        assert (found.events, found.time_s, found.trace) == (alone.events, alone.time_s, alone.trace)

    def test_a_tick_is_given_to_clients_once(self):
        robot = VirtualRobot()
        client = streaming(robot)
        robot.run("sleep(0.1)")
        robot.run("sleep(0.1)")
        robot.advance(0.1)
        found = timestamps(client.receive())
        assert len(found) > 75
        assert len(set(found)) == len(found)

    def test_advance_takes_its_time_after_a_run_that_a_client_follows(self):
        robot = VirtualRobot()
        robot.run("sleep(0.02)")
        client = robot.connect("dashboard")
        begin_s = robot.time_s
        client.send(b"robotMode\n")
        robot.advance(0.1)
        assert robot.time_s == pytest.approx(begin_s + 0.1, abs=1e-9)
        assert client.receive().endswith(b"robotMode: RUNNING\r\n")

    def test_a_client_acts_in_watch(self):
        robot = VirtualRobot()
        client = robot.connect("dashboard")
        heard = []

        def watch(robot):
            if robot.tick == 50:
                client.send(b"status\n")
            if data := client.receive():
                heard.append((robot.tick, data))

        run = robot.run("while True:\n  sync()\nend", until_s=0.4, watch=watch)
        assert heard[1:] == [(51, b"PLAYING\r\n")] or heard[1][0] == 51
        assert run.state == "time_limit"

    def test_what_looks_stuck_waits_for_a_client_that_acts_in_watch(self):
        robot = VirtualRobot(confirms_popups=False)
        client = robot.connect("dashboard")

        def watch(robot):
            if robot.tick == 1000:
                client.send(b"popup -c\n")

        run = robot.run('popup("go on?", blocking=True)\ntextmsg("on")', watch=watch)
        assert run.log == ["on"]
        assert run.time_s == pytest.approx(4.004, abs=0.009)

    def test_without_watch_it_is_stuck(self):
        robot = VirtualRobot(confirms_popups=False)
        robot.connect("dashboard")
        assert robot.run('popup("go on?", blocking=True)').state == "stuck"


class TestExpect:
    def test_it_returns_everything_up_to_what_was_expected(self):
        robot = VirtualRobot()
        client = robot.connect("dashboard")
        assert client.expect(b"EliRobot") == b"EliRobot"
        assert client.expect(b"NAME.\r\n").startswith(b" dashboard shell")
        client.send(b"robotMode\nrobotMode\n")
        assert client.expect(b"\r\n") == b"robotMode: RUNNING\r\n"
        assert client.receive() == b"robotMode: RUNNING\r\n"
        assert robot.time_s == TICK_S

    def test_what_does_not_come_is_said_with_what_has_come(self):
        robot = VirtualRobot()
        client = robot.connect("dashboard")
        client.receive()
        client.send(b"robotMode\n")
        with pytest.raises(TimeoutError, match=r"dashboard#1: after 0.02 s of robot time, b'IDLE' .* b'robotMode: RUN"):
            client.expect(b"IDLE", within_s=0.02)
        assert robot.time_s == pytest.approx(0.02)

    def test_it_lets_a_program_go_on(self):
        robot = VirtualRobot()
        client = robot.connect("primary")
        client.send(program("sleep(0.5)", 'textmsg("late")'))
        client.expect(b"late")
        assert 0.5 <= robot.time_s < 0.6

    def test_it_cannot_be_used_while_time_goes_by(self):
        robot = VirtualRobot()
        client = robot.connect("dashboard")
        with pytest.raises(UsageError, match="use receive"):
            robot.run("sleep(1)", watch=lambda _: client.expect(b"nothing"))


class TestEnds:
    def test_bytes_that_make_no_sense_end_the_connection(self):
        events = []
        robot = VirtualRobot(on_event=events.append)
        client, other = robot.connect("rtsi"), robot.connect("rtsi")
        client.send(b"\0\1V")
        assert client.is_open
        robot.advance(TICK_S)
        assert not client.is_open
        assert client.error == "a message has at least 3 bytes, not 1"
        assert other.is_open
        assert [(event.device, event.is_warning) for event in events if isinstance(event, DeviceNoted)] == [
            ("rtsi#1", True)
        ]
        with pytest.raises(ConnectionError, match="rtsi#1: the connection is closed by the robot: a message has"):
            client.send(b"x")
        with pytest.raises(ConnectionError, match=r"rtsi#1: .*; b'V' has not come; instead: .*at least 3 bytes"):
            client.expect(b"V")

    def test_the_robot_closes_what_quits(self):
        robot = VirtualRobot()
        client = robot.connect("dashboard")
        client.receive()
        client.send(b"quit\n")
        robot.advance(TICK_S)
        assert client.receive() != b""
        assert not client.is_open
        assert client.error == ""

    def test_a_program_arrives_though_its_client_closes_at_once(self):
        events = []
        robot = VirtualRobot(on_event=events.append)
        client = robot.connect("primary")
        client.send(HELLO)
        client.close()
        assert not client.is_open
        robot.advance(0.1)
        assert texts(events) == ["hello"]
        with pytest.raises(ConnectionError, match="primary#1: the connection is closed already"):
            client.send(HELLO)

    def test_a_client_that_goes_sets_its_inputs_free(self):
        robot = VirtualRobot()
        first, second = robot.connect("rtsi"), robot.connect("rtsi")
        recipe = rtsi_client.input_recipe(["input_int_register0"])
        first.send(recipe)
        robot.advance(TICK_S)
        second.send(recipe)
        robot.advance(TICK_S)
        assert second.receive().endswith(b"\0IN_USE")
        first.close()
        robot.advance(TICK_S)
        second.send(recipe)
        robot.advance(TICK_S)
        assert second.receive().endswith(b"\1INT32")


class TestPorts:
    def test_programs_run(self):
        events = []
        robot = VirtualRobot(on_event=events.append)
        first, second = robot.connect("primary"), robot.connect("primary")
        first.send(HELLO)
        robot.advance(0.2)
        assert texts(events) == ["hello"]
        assert all(b"hello" in client.receive() for client in (first, second))
        assert (first.name, second.name) == ("primary#1", "primary#2")

    def test_a_program_takes_the_place_of_the_one_that_runs(self):
        robot = VirtualRobot()
        client = robot.connect("secondary")
        run = robot.start("global mine\nmine = 1\nwhile True:\n  sync()\nend")
        robot.advance(0.1)
        client.send(program("global mine", "mine = 2", "sleep(0.5)", 'textmsg("second")'))
        robot.advance(0.1)
        assert run.state == "stopped"
        assert run.globals["mine"] == 1
        assert robot.state.task_state is TaskState.PLAYING
        robot.advance(1.0)
        assert robot.state.task_state is TaskState.STOPPED

    def test_a_program_that_does_not_compile_is_an_exception_message(self):
        robot = VirtualRobot()
        client = robot.connect("primary")
        client.send(b"def job():\n  movej(\nend\n")
        assert b"SyntaxError" in client.expect(b"never closed")

    def test_a_task_of_the_folder_is_played(self, tmp_path):
        (tmp_path / "pick.task").write_text("<task/>")
        (tmp_path / "pick.script").write_text('def pick():\n  textmsg("picked")\nend\n')
        events = []
        robot = VirtualRobot(task_dir=tmp_path, on_event=events.append)
        client = robot.connect("dashboard")
        client.receive()
        client.send(b"task -p pick.task\n")
        assert b"pick.task" in client.expect(b"\r\n")
        client.send(b"play\n")
        client.expect(b"\r\n")
        robot.advance(0.1)
        assert texts(events) == ["picked"]

    def test_interpreter_mode(self):
        robot = VirtualRobot()
        primary, client = robot.connect("primary"), robot.connect("interpreter")
        client.send(b"set_standard_digital_out(0, True)\n")
        assert client.expect(b"\n") == (b"discard: Task is in an invalid state: set_standard_digital_out(0, True)\n")
        primary.send(program("interpreter_mode()"))
        robot.advance(0.1)
        client.send(b"set_standard_digital_out(0, True)\nend_interpreter()\n")
        assert client.expect(b"\n") == b"ack: 1: set_standard_digital_out(0, True)\n"
        assert client.expect(b"\n") == b"ack: 2: end_interpreter()\n"
        robot.advance(0.1)
        assert robot.signals["standard_digital_out[0]"] is True
        assert robot.state.task_state is TaskState.STOPPED

    def test_a_query(self):
        robot = VirtualRobot()
        client = robot.connect("query")
        client.send(b"req 7 1 + 2\n")
        assert client.expect(b"\n") == b"[7] [success] : [3]\n"

    def test_popups(self):
        events = []
        robot = VirtualRobot(confirms_popups=False, on_event=events.append)
        client = robot.connect("dashboard")
        run = robot.start('popup("go on?", blocking=True)\ntextmsg("on")')
        robot.advance(1.0)
        assert run.log == []
        client.send(b"popup -c\n")
        robot.advance(0.1)
        assert run.log == ["on"]
        client.send(b"popup -s hello\n")
        robot.advance(0.1)
        assert [event.text for event in events if isinstance(event, Popup)] == ["go on?", "hello"]

    def test_popups_are_confirmed_at_once_by_default(self):
        robot = VirtualRobot()
        robot.connect("dashboard")
        assert robot.run('popup("go on?", blocking=True)\ntextmsg("on")').log == ["on"]

    def test_modbus_reads_what_was_set_and_writes_what_programs_read(self):
        robot = VirtualRobot()
        client = robot.connect("modbus")
        client.send(modbus_client.frame(1, modbus_client.write(6, 256, 42)))
        robot.advance(TICK_S)
        client.send(modbus_client.frame(2, modbus_client.read(3, 256, 1)))
        robot.advance(TICK_S)
        answers = modbus_client.frames(client.receive())
        assert [(number, pdu) for number, _, pdu in answers] == [(1, b"\6\1\0\0\x2a"), (2, b"\3\2\0\x2a")]
        assert robot.run("textmsg(read_port_register(256))").log == ["42"]

    def test_modbus_clients_share_the_robot(self):
        robot = VirtualRobot()
        first, second = robot.connect("modbus"), robot.connect("modbus")
        for value in range(1, 30):
            request = modbus_client.frame(value, modbus_client.write(6, 256, value))
            first.send(request)
            assert first.expect(request) == request
            second.send(modbus_client.frame(value, modbus_client.read(3, 256, 1)))
            robot.advance(TICK_S)
            ((_, _, pdu),) = modbus_client.frames(second.receive())
            assert modbus_client.words(pdu) == [value]
            first, second = second, first

    def test_rtsi_in_lockstep(self):
        """Each package answers the inputs that were sent before it, as for a client that time waits for."""
        robot = VirtualRobot()
        client = robot.connect("rtsi")
        client.send(rtsi_client.message("V", b"\0\1") + rtsi_client.input_recipe(["input_int_register0"]))
        client.send(rtsi_client.output_recipe(250.0, ["timestamp", "output_int_register0"]))
        robot.advance(TICK_S)
        client.send(rtsi_client.message("S"))
        robot.advance(TICK_S)
        client.receive()
        robot.start(
            "while True:\n  write_output_integer_register(0, read_input_integer_register(0) * 2)\n  sync()\nend"
        )
        robot.advance(TICK_S)
        client.receive()
        answers = []
        for value in range(1, 6):
            client.send(rtsi_client.package(1, ["INT32"], [value]))
            robot.advance(TICK_S)
            ((letter, body),) = rtsi_client.messages(client.receive())
            assert letter == "U"
            answers.append(struct.unpack_from(">i", body, 9)[0])
        assert answers == [2, 4, 6, 8, 10]

    def test_rtsi_in_lockstep_goes_on_behind_a_run(self):
        robot = VirtualRobot()
        client = streaming(robot)
        client.send(rtsi_client.input_recipe(["input_int_register0"]))
        robot.run("sleep(0.1)")
        client.receive()
        client.send(rtsi_client.package(1, ["INT32"], [7]))
        robot.advance(TICK_S)
        assert [letter for letter, _ in rtsi_client.messages(client.receive())] == ["U"]
        assert robot.signals["input_int_register[0]"] == 7

    def test_a_refused_request_is_a_warning(self):
        robot = VirtualRobot()
        client = robot.connect("primary")
        run = robot.start("sleep(1)")
        client.send(b"set_standard_digital_out(99, True)\n")
        robot.advance(0.5)
        assert run.alarms or run.warnings


def test_a_device_of_a_world_uses_every_port():
    class Panel(TcpClient):
        service = "dashboard"
        connect_at_s = 0.1

        def opened(self):
            return "robotMode"

        def line_received(self, line):
            self.log(line.strip())

    class Sender(TcpClient):
        service = "primary"
        connect_at_s = 0.2

        def opened(self):
            return WAITING

        def received(self, data):
            return None

    robot = VirtualRobot(world=World(devices=[Panel(), Sender()]))
    run = robot.run("sleep(5)")
    said = [event.text for event in run.events if isinstance(event, DeviceNoted)]
    assert said[-1] == "robotMode: RUNNING"
    assert run.state == "stopped"
    assert run.time_s == pytest.approx(0.2, abs=0.02)
    assert robot.controller.task.name == "waiting"


def test_the_robot_without_its_own_clients_imports_no_port():
    robot = VirtualRobot()
    robot.run("sleep(1)")
    assert robot._kernel._handlers is None


def test_the_example_of_the_docstring_is_true():
    finder = doctest.DocTestFinder(recurse=False)
    (example,) = finder.find(VirtualRobot.connect, "connect", globs={"VirtualRobot": VirtualRobot})
    assert doctest.DocTestRunner(verbose=False).run(example).failed == 0


def test_a_robot_without_power_stays_so_until_a_client_asks_for_it():
    robot = VirtualRobot(power_on=False)
    robot.run("movej([0.3, -1.4, -1.7, -1.6, 1.57, 0])", until_s=1.0)
    assert robot.state.robot_mode.name == "POWER_OFF"
    assert robot.current is not None
    assert robot.current.state == "alarm"


def test_what_happens_between_two_ticks_reaches_a_client_with_the_next_one():
    robot = VirtualRobot()
    robot.run("sleep(2)")
    client = robot.connect("primary")
    robot.protective_stop("boo")
    robot.advance(0.5)
    assert b"boo" in client.receive()


@pytest.mark.parametrize("tick", [25, 26, 27, 30])
def test_what_watch_causes_reaches_a_client_at_every_tick(tick):
    robot = VirtualRobot()
    client = robot.connect("primary")

    def watch(robot):
        if robot.tick == tick:
            robot.protective_stop("boo")

    robot.run("for i in range(60):\n  sync()\nend\n", watch=watch)
    robot.advance(0.5)
    assert b"boo" in client.receive()


@pytest.mark.parametrize("port", ["dashboard", "primary", "rtsi"])
def test_a_silent_client_does_not_keep_a_stuck_program_alive(port):
    robot = VirtualRobot(speed=0.0)
    robot.connect(port)
    run = robot.run("movej([0.3, -1.4, -1.7, -1.6, 1.57, 0])", until_s=60)
    assert run.state == "stuck"
    assert robot.time_s < 2.0


def test_a_change_of_speed_between_two_ticks_is_shown_to_a_client_that_sends_next() -> None:
    robot = VirtualRobot("CS66")
    robot.start("def p():\n  movej([1, -1.5, -1.5, -1.5, 1.5, 0], 1, 1)\nend")
    robot.advance(0.5)
    client = robot.connect("primary")
    robot.set_speed(0.5)
    client.send(b"stopj(2)\n")
    robot.advance(0.1)
    assert client.receive()


@pytest.mark.parametrize("pace", [None, lambda tick: None], ids=["leaps", "every tick"])
def test_a_client_does_not_get_what_happened_before_it_came(pace) -> None:
    robot = VirtualRobot("CS66")
    robot.connect("primary").close()
    robot.start("def p():\n  sleep(0.1)\n  textmsg('before')\n  sleep(9)\nend")
    robot.advance(1.0, pace=pace)
    client = robot.connect("primary")
    robot.advance(0.2, pace=pace)
    assert b"before" not in client.receive()
