"""What a program gives away in its last tick arrives before its run returns."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elitescript import VirtualRobot
from elitescript.messages.events import DeviceNoted, Warned
from elitescript.testing.world import Device, Fault, SerialDevice, TcpServer, Wire, World

OPEN = 'socket_open("10.0.0.5", 5000)'
SERIAL = "serial_config(True, 9600, 0, 1, 8, 0)"


class Server(TcpServer):
    port = 5000

    def __init__(self, **settings):
        super().__init__(**settings)
        self.got = b""
        self.ends = 0

    def received(self, connection, data):
        self.got += data
        if b"done" in data:
            self.cell.set("standard_digital_in[3]", True)

    def closed(self, connection):
        self.ends += 1


class Listener(SerialDevice):
    line = "box"

    def __init__(self, **settings):
        super().__init__(**settings)
        self.got = b""

    def received(self, data):
        self.got += data


def program(*lines):
    return "def main():\n" + "".join(f"  {line}\n" for line in lines) + "end\n"


def cell(*devices, faults=(), **settings):
    return VirtualRobot(world=World(devices=devices, faults=faults), **settings)


class TestSockets:
    @pytest.mark.parametrize(
        ("last", "state"),
        [
            ("pass", "finished"),
            ("halt()", "stopped"),
            ("1 / 0", "alarm"),
            ("socket_close()", "finished"),
            ("raise SystemExit", "stopped"),
        ],
    )
    def test_the_last_line_arrives_however_the_program_ends(self, last, state):
        server = Server()
        run = cell(server).run(program(OPEN, "sleep(0.1)", 'socket_send_line("done")', last))
        assert (run.state, server.got, server.ends) == (state, b"done\n", 1)
        assert run.undelivered == []

    def test_the_record_is_that_of_the_program(self):
        server = Server()
        robot = cell(server)
        run = robot.run(program("global n", "n = 1", OPEN, "sleep(0.1)", 'socket_send_line("done")'))
        begin = run.time_s
        assert run.globals == {"n": 1}
        assert begin < robot.time_s <= begin + 0.05

    def test_a_program_that_gives_nothing_away_takes_no_time_after_its_end(self):
        robot = VirtualRobot()
        run = robot.run(program("sleep(1)"))
        assert robot.time_s == run.time_s == 1.0

    def test_what_a_device_does_at_once_has_happened(self):
        wire = Wire(when="standard_digital_in[3]", then="standard_digital_in[4]")
        robot = VirtualRobot(world=World(devices=[Server()], wires=[wire]))
        run = robot.run(program(OPEN, 'socket_send_line("done")'))
        assert run.signals["standard_digital_in[3]"] is True
        assert run.signals["standard_digital_in[4]"] is True
        assert robot.signals["standard_digital_in[4]"] is True

    def test_what_a_device_says_stands_in_the_record(self):
        class Talker(Server):
            def received(self, connection, data):
                self.log(f"got {data!r}")

        run = cell(Talker()).run(program(OPEN, 'socket_send_line("done")'))
        assert [event.text for event in run.events if isinstance(event, DeviceNoted)] == ["got b'done\\n'"]

    def test_a_device_that_acts_in_every_tick_does_not_keep_the_run(self):
        class Busy(Device):
            def started(self):
                self.after(0.004, self.started)

        robot = cell(Busy(), Server())
        run = robot.run(program(OPEN, 'socket_send_line("done")'))
        assert robot.time_s - run.time_s <= 0.05

    def test_a_program_that_is_cut_off_by_its_time_limit_has_sent_what_it_has_sent(self):
        server = Server()
        run = cell(server).run(program(OPEN, "sleep(0.092)", 'socket_send_line("done")', "sleep(9)"), until_s=0.1)
        assert (run.state, run.time_s, server.got) == ("time_limit", 0.1, b"done\n")

    def test_a_stuck_one_too(self):
        server = Server()
        run = cell(server).run(program(OPEN, 'socket_send_line("done")', "pause()"))
        assert (run.state, server.got) == ("stuck", b"done\n")

    def test_the_next_run_begins_without_leftovers(self):
        server = Server()
        robot = cell(server)
        robot.run(program(OPEN, 'socket_send_line("one")'))
        assert server.got == b"one\n"
        robot.run(program("sleep(1)"))
        assert (server.got, server.ends) == (b"one\n", 1)

    def test_a_program_that_is_stepped_leaves_none_either(self):
        server = Server()
        robot = cell(server)
        first = robot.start(program(OPEN, 'socket_send_line("one")', 'textmsg("end")'))
        while first.state == "":
            robot.advance(0.004)
        assert server.got == b""
        robot.start(program("sleep(1)"))
        assert (server.got, server.ends) == (b"one\n", 1)

    def test_a_trace_ends_with_the_program(self):
        def rows(*last):
            return cell(Server()).run(program(OPEN, 'socket_send_line("done")', *last), trace=True).trace

        assert len(rows()) < len(rows("sleep(0.1)"))
        assert rows()[-1].t <= 0.012


class TestSerial:
    def test_the_last_bytes_arrive_at_the_pace_of_the_line(self):
        device = Listener()
        robot = cell(device)
        run = robot.run(program(SERIAL, 'serial_write("x" * 96)'))
        assert run.undelivered == []
        assert device.got == b"x" * 96
        assert robot.time_s - run.time_s == pytest.approx(0.1, abs=0.01)


class TestBounds:
    def test_what_moves_is_waited_for_beyond_the_limit(self):
        device = Listener()
        run = cell(device, drain_s=0.5).run(program(SERIAL, 'serial_write("x" * 2000)'))
        assert (len(device.got), run.undelivered) == (2000, [])

    def test_what_does_not_move_is_given_up_dropped_and_said(self):
        server = Server()
        robot = cell(server, faults=[Fault("delay", on=5000, direction="to_device", delay_s=5.0)])
        run = robot.run(program(OPEN, 'socket_send_line("done")'))
        assert run.state == "finished"
        assert run.undelivered == ["5 bytes to 10.0.0.5:5000, which a fault delays"]
        said = [event for event in run.events if isinstance(event, Warned)]
        assert [(event.text, event.code) for event in said] == [("not delivered: " + run.undelivered[0], "W270")]
        assert run.warnings[-1] == said[0].text
        assert robot.time_s - run.time_s == pytest.approx(2.0, abs=0.1)
        robot.run(program("sleep(10)"))
        assert (server.got, server.ends) == (b"", 1)

    def test_the_limit_is_a_setting(self):
        server = Server()
        faults = [Fault("delay", on=5000, direction="to_device", delay_s=5.0)]
        run = cell(server, faults=faults, drain_s=6.0).run(program(OPEN, 'socket_send_line("done")'))
        assert (server.got, run.undelivered) == (b"done\n", [])

    def test_an_interruption_ends_the_wait(self):
        faults = [Fault("delay", on=5000, direction="to_device", delay_s=5.0)]
        robot = cell(Server(), faults=faults, drain_s=10.0)

        def watch(robot):
            if robot.current.state:
                robot.interrupt()

        run = robot.run(program(OPEN, 'socket_send_line("done")'), watch=watch)
        assert (run.state, len(run.undelivered)) == ("finished", 1)
        assert robot.run(program("sleep(1)")).state == "finished"

    def test_a_device_that_fails_meanwhile_ends_the_run_with_its_error(self):
        class Broken(Server):
            def received(self, connection, data):
                raise ValueError("no")

        robot = cell(Broken())
        with pytest.raises(Exception, match="no"):
            robot.run(program(OPEN, 'socket_send_line("done")'))
        assert robot.run(program("sleep(1)")).state == "finished"


STATEMENTS = st.lists(
    st.one_of(
        st.integers(0, 3).map(lambda n: f'socket_send_line("{"ab" * n}", 0, "s{n % 2}")'),
        st.integers(1, 40).map(lambda n: f'serial_write("{"z" * n}")'),
        st.integers(0, 5).map(lambda n: f"sleep({n * 0.004})"),
        st.integers(0, 1).map(lambda n: f'socket_close("s{n}")'),
        st.integers(0, 1).map(lambda n: f'socket_open("10.0.0.5", 5000, "s{n}")'),
        st.sampled_from(["sync()", "set_standard_digital_out(1, True)", "halt()"]),
    ),
    max_size=8,
)


@settings(max_examples=40, deadline=None)
@given(STATEMENTS, st.sampled_from([0.0, 0.004, 0.05]))
def test_bytes_arrive_whether_a_program_waits_at_its_end_or_not(statements, latency_s):
    def delivered(*last):
        devices = Server(latency_s=latency_s), Listener()
        run = cell(*devices).run(program(SERIAL, *statements, *last))
        assert run.undelivered == []
        return devices[0].got, devices[0].ends, devices[1].got

    assert delivered() == delivered("sleep(2)")


class TestLiveRecord:
    def test_a_run_that_is_stepped_says_where_it_is(self):
        robot = VirtualRobot()
        run = robot.start(
            program(
                "global n",
                "n = 1",
                "set_standard_digital_out(2, True)",
                "movej([0, -1.2, 1.2, -1.57, -1.57, 0], v=0.2)",
                "n = 2",
            )
        )
        home = robot.state.q_target
        assert (run.joints, run.time_s, run.globals, run.is_over) == (home, 0.0, {}, False)
        robot.advance(0.5)
        assert run.state == ""
        assert run.joints == robot.state.q_target != home
        assert run.tcp_pose == robot.state.tcp_pose_target
        assert (run.time_s, run.globals) == (0.5, {"n": 1})
        assert run.signals == {"standard_digital_out[2]": True}
        robot.advance(60.0)
        assert (run.state, run.globals) == ("finished", {"n": 2})
        assert run.time_s < 60.0
        end = run.joints, run.time_s, run.tcp_pose
        robot.run(program("movej([0.3, -1.2, 1.2, -1.57, -1.57, 0])"))
        assert (run.joints, run.time_s, run.tcp_pose) == end


class TestTiedOutputs:
    def test_an_unrelated_task_moves_nothing(self):
        robot = VirtualRobot()
        tie = "set_runstate_standard_digital_output_to_value"
        robot.run(
            program(
                f"{tie}(0, 1)",
                f"{tie}(1, 2)",
                f"{tie}(2, 3)",
                *(f"set_standard_digital_out({n}, {n == 0})" for n in range(2)),
            )
        )
        assert [robot.signals[f"standard_digital_out[{n}]"] for n in range(3)] == [False, True, False]
        run = robot.run(program("print([get_standard_digital_out(n) for n in range(3)])"))
        assert run.printed == ["[False, True, True]"]

    def test_a_write_without_effect_is_a_warning_once_for_each_output_and_program(self):
        robot = VirtualRobot()
        robot.run(program("set_runstate_standard_digital_output_to_value(2, 3)"))
        run = robot.run(program("set_standard_digital_out(2, True)", *["set_standard_digital_out(2, False)"] * 3))
        said = [event for event in run.events if isinstance(event, Warned)]
        assert [(event.line, event.thread, event.code) for event in said] == [(3, "main", "W271")]
        assert said[0].text == (
            "standard_digital_out[2] stays high: the write has no effect while the task runs, "
            "as the output is tied to that"
        )
        assert len(robot.run(program("set_standard_digital_out(2, False)")).warnings) == 1


class TestLeftLineEnd:
    class Sender(TcpServer):
        port = 5000

        def line_received(self, connection, line):
            return line

    ASK = 'socket_send_line("(1.5, 2)")'

    def run(self, *lines):
        return cell(self.Sender()).run(program(OPEN, self.ASK, *lines))

    def said(self, run):
        return [(event.line, event.code, event.text) for event in run.events if isinstance(event, Warned)]

    @pytest.mark.parametrize("last", ['socket_read_string(suffix="\\n")', "socket_read_string()"])
    def test_a_text_that_begins_with_it_is_a_warning_once(self, last):
        again = [self.ASK, "socket_read_ascii_float(2)", last]
        run = self.run("print(socket_read_ascii_float(2))", last, *again)
        assert run.printed == ["(2, 1.5, 2.0)"] or run.printed == ["[2, 1.5, 2.0]"]
        text = "the text read from socket 'socket_0' begins with the line end that socket_read_ascii_float has left"
        assert self.said(run) == [(5, "W272", text)]

    def test_the_answer_to_a_question_passes_over_it(self):
        class Server(self.Sender):
            def line_received(self, connection, line):
                return "x 7" if line == "GET x" else line

        lines = OPEN, self.ASK, "socket_read_ascii_float(2)", 'print(socket_get_var("x"))'
        run = cell(Server()).run(program(*lines))
        assert (run.printed, self.said(run)) == (["7"], [])

    def test_other_numbers_and_text_behind_a_mark_skip_it(self):
        run = self.run(
            "socket_read_ascii_float(2)", self.ASK, "print(socket_read_ascii_float(2))", 'socket_send_line("a:b")'
        )
        run = self.run(
            "socket_read_ascii_float(2)",
            'socket_send_line("a:b")',
            'print(socket_read_string("socket_0", "a:", "\\n"))',
        )
        assert (run.printed, self.said(run)) == (["b"], [])

    def test_it_can_be_read_away_without_a_second_word(self):
        lines = (
            'socket_read_string(suffix="\\n")',
            'socket_send_line("hello")',
            'print(socket_read_string(suffix="\\n"))',
        )
        run = self.run("socket_read_ascii_float(2)", *lines)
        assert (run.printed, len(self.said(run))) == (["hello"], 1)

    def test_an_empty_line_that_nobody_has_left_is_no_warning(self):
        run = self.run('socket_read_string(suffix="\\n")', 'socket_send_line("")', 'socket_read_string(suffix="\\n")')
        assert self.said(run) == []


class TestTextInGbk:
    class Camera(TcpServer):
        port = 5000

        def line_received(self, connection, line):
            connection.send({"停": "停止,1"}.get(line, "合格,1.5").encode("gbk") + b"\n")

    READ = 't = socket_read_string(suffix="\\n")'

    def run(self, *lines):
        return cell(self.Camera()).run(program(OPEN, *lines))

    @pytest.mark.parametrize(("asked", "reads"), [("x", "合格,1.5"), ("停", "停止,1")])
    def test_it_is_a_warning_once_a_connection_with_what_it_reads(self, asked, reads):
        ask = f'socket_send_line("{asked}")'
        run = self.run(ask, self.READ, ask, self.READ, "socket_close()", OPEN, ask, self.READ)
        warned = [event for event in run.events if isinstance(event, Warned) and event.severity != "note"]
        said = [(event.line, event.code) for event in warned]
        assert said == [(4, "W275"), (10, "W275")]
        assert f"as GBK it reads '{reads}'" in str(warned[0])

    @pytest.mark.parametrize("marks", ['prefix="合"', 'suffix="格"', 'suffix="\\r"'])
    def test_it_is_a_warning_where_the_mark_is_not_found(self, marks):
        run = self.run('socket_send_line("x")', f"print([socket_read_string({marks}, timeout=0.1)])")
        warned = [event for event in run.events if isinstance(event, Warned) and event.severity != "note"]
        assert [event.code for event in warned] == ["W275"]

    def test_bytes_that_are_read_as_bytes_are_none(self):
        run = self.run('socket_send_line("x")', "d = socket_read_byte_list(8)", 'print(bytes(d[1:]).decode("gbk"))')
        assert (run.printed, run.warnings) == (["合格,1.5"], [])
