"""Why a thread does not go on: the condition of its loop with its values, data that is there, the holder of a lock."""

from __future__ import annotations

import pytest

from elitescript import VirtualRobot
from elitescript.testing.world import ModbusDevice, Schedule, TcpServer, Wire, World

STILL = "(it has not changed and nothing here sets it)"


def states(text, world=(), until_s=1.0):
    run = VirtualRobot("CS66", world=World(list(world))).run(text, until_s=until_s)
    assert run.state in ("time_limit", "stuck")
    return {state.name: state for state in run.threads}


def program(*body):
    return "def f():\n" + "".join(f"  {line}\n" for line in body) + "end\n"


def because(*body, thread="main", world=()):
    return states(program(*body), world)[thread].because


CONDITIONS = {
    "input": (
        ["while not get_standard_digital_in(3): sync()"],
        f"`not get_standard_digital_in(3)` has been true since 0 s: standard_digital_in[3] is False {STILL}",
    ),
    "later": (
        ["sleep(0.1)", "while not get_standard_digital_in(3):", "  sleep(0.04)", "end"],
        "`not get_standard_digital_in(3)` in line 3 has been true since 0.1 s: "
        f"standard_digital_in[3] is False {STILL}",
    ),
    "register": (
        ["n = 2", "while read_input_integer_register(n) != 5:", "  sleep(0.1)", "end"],
        "`read_input_integer_register(n) != 5` in line 3 has been true since 0 s: "
        f"input_int_register[2] is 0 {STILL}, n is 2 (nothing changes it)",
    ),
    "line end": (
        ['cmd = "go\\r"', 'while cmd != "go": sync()'],
        "`cmd != \"go\"` has been true since 0 s: cmd is 'go\\r' (nothing changes it), "
        "'go\\r' and 'go' differ by a line end or blanks",
    ),
    "break": (
        ["while True:", "  if get_flag(2):", "    break", "  end", "  sync()", "end"],
        "`while True` in line 2 ends in line 3 when `get_flag(2)`, which has been false since 0 s: "
        f"flag[2] is False {STILL}",
    ),
    "halt in a try, in two conditions": (
        [
            "while True:",
            "  try:",
            "    if get_flag(1):",
            "      if get_flag(2): halt()",
            "    end",
            "  except: pass",
            "  sync()",
            "end",
        ],
        "`while True` in line 2 ends in line 5 when `get_flag(1) and get_flag(2)`, which has been false since 0 s: "
        f"flag[1] is False {STILL}, flag[2] is False {STILL}",
    ),
    "continue": (
        ["while True:", "  sync()", "  if not get_flag(1): continue", "  break", "end"],
        "`while True` in line 2 ends in line 5 when `get_flag(1)`, which has been false since 0 s: "
        f"flag[1] is False {STILL}",
    ),
    "for in a while": (
        ["while True:", "  if get_flag(1): break", "  for i in range(9):", "    sleep(0.3)", "  end", "end"],
        "`for i in range(9)` in line 4 is not finished: i is 3; `while True` in line 2 ends in line 3 when "
        f"`get_flag(1)`, which has been false since 0 s: flag[1] is False {STILL}",
    ),
    "no end": (["while True: sync()"], "`while True` in line 2 has no end"),
    "counter": (
        ["n = 0", "while n < 9000:", "  sync()", "  n = n + 1", "end"],
        "`n < 9000` in line 3 has been true since 0 s: n is 250 (line 5 of the loop sets it)",
    ),
    "for": (
        ["for i in range(1000):", "  sleep(0.1)", "end"],
        "`for i in range(1000)` in line 2 is not finished: i is 10",
    ),
    "elements": (
        ["q, i = [3, 5], 1", "while q[i] != 3: sync()"],
        "`q[i] != 3` has been true since 0 s: q[i] is 5, i is 1 (nothing changes it)",
    ),
    "length": (
        ["jobs = []", "while len(jobs) < 1: sync()"],
        "`len(jobs) < 1` has been true since 0 s: len(jobs) is 0",
    ),
    "pure command": (
        ["p = [1, 0, 0, 0, 0, 0]", "while point_dist(p, [0, 0, 0, 0, 0, 0]) > 0.1: sync()"],
        "`point_dist(p, [0, 0, 0, 0, 0, 0]) > 0.1` has been true since 0 s: point_dist(p, [0, 0, 0, 0, 0, 0]) is 1.0",
    ),
    "function": (
        ["def part(n):", "  return get_standard_digital_in(n)", "end", "while not part(3): sync()"],
        f"`not part(3)` has been true since 0 s: part(3) is False, standard_digital_in[3] is False {STILL}",
    ),
    "long function": (
        [
            "def part():",
            "  x = get_flag(3)",
            "  if x: return True",
            "  return False",
            "end",
            "while not part(): sync()",
        ],
        f"`not part()` has been true since 0 s: flag[3] is False {STILL}",
    ),
    "no waiting": (
        ["ready = False", "while not ready:", "  pass", "end"],
        "`not ready` has been true since 0 s: ready is False (nothing changes it)",
    ),
    "time": (["sleep(5)"], "`sleep(5)` goes on since 0 s and until 5 s"),
}


@pytest.mark.parametrize("name", CONDITIONS)
def test_a_loop(name):
    body, expected = CONDITIONS[name]
    assert because(*body) == expected


def test_what_goes_by_is_time_is_never_the_whole_answer():
    for body, expected in CONDITIONS.values():
        for state in states(program(*body)).values():
            assert "time to go by" not in state.doing
            assert expected[:8] in state.doing


def test_a_wait_in_a_helper_is_that_of_the_loop_around_its_call():
    body = ["def rest():", "  sleep(0.1)", "end", "while not get_flag(1): rest()"]
    assert because(*body) == f"`not get_flag(1)` has been true since 0 s: flag[1] is False {STILL}"


class TestVariables:
    def test_that_another_thread_sets_have_its_condition(self):
        found = because(
            *("global ready", "ready = False", "def w():", "  global ready", "  while True:"),
            *("    if get_flag(1): ready = True", "    sync()", "  end", "end", "start_thread(w, ())"),
            "while not ready: sync()",
        )
        assert found == (
            "`not ready` has been true since 0 s: ready is False (line 7 sets it when `get_flag(1)`, "
            f"which is false now: flag[1] is False {STILL})"
        )

    def test_whose_function_no_thread_runs(self):
        body = ["global ready", "ready = False", "def w():", "  global ready", "  ready = True", "end"]
        found = because(*body, "while not ready: sync()")
        assert found.endswith("ready is False (line 6 sets it, in w, which no thread runs now)")

    def test_that_a_function_has_of_its_own(self):
        found = because("ready = False", "def w():", "  ready = True", "end", "w()", "while not ready: sync()")
        assert found.endswith("ready is False (nothing changes it: line 4 sets a variable of its own)")


class TestSignals:
    def test_that_have_changed(self):
        body = ["set_standard_digital_out(1, True)", "while get_standard_digital_out(1): sync()"]
        assert because(*body).endswith(
            "standard_digital_out[1] is True (it has not changed since 0 s, by line 2 and line 2 sets it)"
        )

    def test_of_a_wire(self):
        wire = Wire(name="door", when="standard_digital_out[1]", then="standard_digital_in[3]")
        assert because("while not get_standard_digital_in(3): sync()", world=[wire]).endswith(
            "(it has not changed and door sets it when `standard_digital_out[1]`, which is false now)"
        )

    def test_of_a_schedule(self):
        plan = Schedule(name="shift", signal="standard_digital_in[3]", at=[(5.0, True)])
        assert because("while not get_standard_digital_in(3): sync()", world=[plan]).endswith(
            "(it has not changed and shift sets it next at 5 s)"
        )

    def test_that_are_set_later(self):
        robot = VirtualRobot("CS66")
        robot.at(7.0, "standard_digital_in[3]", True)
        run = robot.run(program("while not get_standard_digital_in(3): sync()"), until_s=1.0)
        assert run.threads[0].because.endswith("(it has not changed and it is set at 7 s)")

    def test_of_a_device_that_may_set_any(self):
        found = because("while not get_standard_digital_in(3): sync()", world=[Device()])
        assert found.endswith("standard_digital_in[3] is False (it has not changed)")

    def test_of_modbus(self):
        class Plc(ModbusDevice):
            port = 502
            input_registers = (7,)

        add = 'modbus_add_signal("192.168.1.50", 255, 0, 2, "ready")'
        body = [add, 'while modbus_get_signal_status("ready") != 1: sleep(0.1)']
        assert because(*body, world=[Plc()]).endswith("the MODBUS signal 'ready' is 7")
        assert because(*body).endswith("the MODBUS signal 'ready' is 0 (the device has not answered)")


class Device(TcpServer):
    name = "plc"
    port = 5000
    address = "10.0.0.7"

    def line_received(self, connection, line):
        if line == "state?":
            self.warn("has no reply to 'state?'")
            return None
        return "go\r" if line == "cmd?" else b"12.5\n"


OPEN = 'socket_open("10.0.0.7", 5000)'


class TestData:
    @pytest.mark.parametrize(
        ("read", "expected"),
        [
            ('socket_read_string(suffix="\\r\\n", timeout=0)', "'12.5\\n' is there, its suffix '\\r\\n' has not come"),
            ("socket_read_ascii_float(3, timeout=0)", "'12.5\\n' is there, its parenthesis '(' has not come"),
            ("socket_read_byte_list(9, timeout=0)", "'12.5\\n' is there, 5 of 9 bytes"),
        ],
    )
    def test_that_is_there(self, read, expected):
        assert because(OPEN, 'socket_send_line("x")', f"s = {read}", world=[Device()]) == expected

    def test_that_does_not_come(self):
        found = because(OPEN, 'socket_send_line("state?")', "s = socket_read_string(timeout=0)", world=[Device()])
        assert found == ("nothing has come since 0.008 s; 'state?' was sent at 0.004 s, plc has no reply to 'state?'")

    def test_that_was_read_last(self):
        body = [OPEN, 'while socket_read_string(suffix="\\n", timeout=0.1) != "go":', '  socket_send_line("cmd?")']
        found = because(*body, "  sleep(0.3)", "end", world=[Device()])
        assert "gave 'go\\r' last" in found
        assert "'go\\r' and 'go' differ by a line end or blanks" in found

    def test_before_the_first_has_come(self):
        assert because(OPEN, "while socket_read_string() != 'x': sync()", world=[Device()]) == (
            "nothing has come since 0.004 s; `while socket_read_string() != 'x'` goes on since 0.004 s"
        )


class TestLocks:
    def test_of_the_thread_itself(self):
        text = "import threading\nlock = threading.Lock()\nlock.acquire()\nlock.acquire()\n"
        run = VirtualRobot().run(text)
        assert [state.because for state in run.threads] == ["it holds the lock `lock` itself"]
        assert run.alarms[0].text.endswith("waits for a lock: it holds the lock `lock` itself")

    def test_of_another_one(self):
        text = (
            "import threading\na = threading.Lock()\nb = threading.Lock()\ndef w():\n  b.acquire()\n  sleep(0.1)\n"
            "  a.acquire()\nend\nstart_thread(w, ())\na.acquire()\nsleep(0.1)\nb.acquire()\n"
        )
        found = states(text)
        assert found["main"].because == "w holds the lock `b` and is in line 7, waiting for a lock"
        assert found["w"].because == "main holds the lock `a` and is in line 12, waiting for a lock"

    @pytest.mark.parametrize("wait", ["threading.Event().wait()", "queue.Queue().get()"])
    def test_of_the_library(self, wait):
        text = f"import threading\nimport queue\n{wait}\n"
        assert states(text)["main"].because == "no thread has ended that wait"


def test_a_pause_that_nothing_ends():
    assert because("pause()") == "nothing here resumes it"


def test_what_keeps_the_arm_from_moving():
    robot = VirtualRobot("CS66")

    def act(robot):
        if robot.tick == 5:
            robot.set_speed(0)

    text = "def w():\n  while True: sync()\nend\nstart_thread(w, ())\nmovej([0, -1.5, 1.5, -1.5, 1.5, 0])\n"
    run = robot.run(text, until_s=1.0, watch=act)
    assert run.why.startswith("main is in line 5, waiting for the end of its move: the speed percentage is 0; w is in")
    robot = VirtualRobot("CS66")
    text = "while True:\n  sleep(0.1)\nend\n"
    run = robot.run(text, until_s=1.0, watch=lambda robot: robot.pause() if robot.tick == 25 else None)
    assert "main (line 2) is held: the program is paused, and nothing here resumes it" in run.why


def test_looking_is_no_reading_of_the_program():
    """A MODBUS signal that was only looked at has no warning of a reading before its first answer."""
    body = ['modbus_add_signal("192.168.1.50", 255, 0, 2, "ready")', "while True:"]
    body += ['  if get_flag(1) and modbus_get_signal_status("ready"): break', "  sync()", "end"]
    run = VirtualRobot("CS66", world=World()).run(program(*body), until_s=0.1)
    assert "the MODBUS signal 'ready' is 0" in run.threads[0].because
    assert "W285" not in [row.code for row in run.findings]
