"""Why a thread does not go on: the condition of its loop with its values, data that is there, the holder of a lock."""

import pytest

from elitescript import VirtualRobot
from elitescript.testing.world import TcpServer, World


def because(*body, thread="main", world=()):
    text = "def f():\n" + "".join(f"  {line}\n" for line in body) + "end\n"
    run = VirtualRobot("CS66", world=World(list(world))).run(text, until_s=1.0)
    assert run.state in ("time_limit", "stuck")
    (found,) = (state.because for state in run.threads if state.name.startswith(thread))
    return found


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (
            ["while not get_standard_digital_in(3): sync()"],
            "`while not get_standard_digital_in(3)` in line 2 goes on: get_standard_digital_in(3) is False",
        ),
        (
            ["n = 2", "while read_input_integer_register(n) != 5:", "  sleep(0.1)", "end"],
            "`while read_input_integer_register(n) != 5` in line 3 goes on: "
            "read_input_integer_register(n) is 0, n is 2",
        ),
        (
            ['cmd = "go\\r"', 'while cmd != "go": sync()'],
            "`while cmd != 'go'` in line 3 goes on: cmd is 'go\\r', 'go\\r' and 'go' differ by a line end or blanks",
        ),
        (
            ["while True:", "  if get_flag(2):", "    break", "  end", "  sync()", "end"],
            "`while True` in line 2 is left in line 3 when `get_flag(2)`: get_flag(2) is False",
        ),
        (["while True: sync()"], "`while True` in line 2 has no end"),
        (
            ["n = 0", "while n < 9000:", "  sync()", "  n = n + 1", "end"],
            "`while n < 9000` in line 3 goes on: n is 250",
        ),
        (
            ["q, i = [3, 5], 1", "while q[i] != 3: sync()"],
            "`while q[i] != 3` in line 3 goes on: q[i] is 5, i is 1",
        ),
        (["jobs = []", "while len(jobs) < 1: sync()"], "`while len(jobs) < 1` in line 3 goes on: len(jobs) is 0"),
        (
            ["d = {'cmd': 'go '}", "while d['cmd'] != 'go': sync()"],
            "`while d['cmd'] != 'go'` in line 3 goes on: d['cmd'] is 'go ', 'go ' and 'go' differ by a line end or "
            "blanks",
        ),
        (
            [
                "class Cell:",
                "  def __init__(self):",
                "    self.state = 2",
                "  end",
                "end",
                "c = Cell()",
                "while c.state < 3: sync()",
            ],
            "`while c.state < 3` in line 8 goes on: c.state is 2",
        ),
        (["while socket_read_string() == 'x' or True: sync()"], None),
        (["sleep(5)"], ""),
    ],
)
def test_a_loop(body, expected):
    found = because(*body)
    if expected is None:
        assert "socket_read_string() == 'x'" in found
        assert found.endswith("goes on")
    else:
        assert found == expected


def test_a_wait_in_a_helper_is_that_of_the_loop_around_its_call():
    body = ["def rest():", "  sleep(0.1)", "end", "while not get_flag(1): rest()"]
    assert because(*body) == "`while not get_flag(1)` in line 5 goes on: get_flag(1) is False"


def test_a_variable_names_the_lines_that_could_set_it():
    body = ["global ready", "ready = False", "def w():", "  global ready", "  if get_flag(1): ready = True", "end"]
    found = because(*body, "while not ready: sync()")
    assert found == "`while not ready` in line 8 goes on: ready is False (set in line 6)"


class Device(TcpServer):
    port = 5000
    address = "10.0.0.7"

    def line_received(self, connection, line):
        return b"12.5\n"


@pytest.mark.parametrize(
    ("read", "expected"),
    [
        ('socket_read_string(suffix="\\r\\n", timeout=0)', "'12.5\\n' is there, its suffix '\\r\\n' has not come"),
        ("socket_read_ascii_float(3, timeout=0)", "'12.5\\n' is there, its parenthesis '(' has not come"),
        ("socket_read_byte_list(9, timeout=0)", "'12.5\\n' is there, 5 of 9 bytes"),
    ],
)
def test_data_that_is_there(read, expected):
    assert (
        because('socket_open("10.0.0.7", 5000)', 'socket_send_line("x")', f"s = {read}", world=[Device()]) == expected
    )


def test_who_holds_a_lock():
    text = "import threading\nlock = threading.Lock()\nlock.acquire()\nlock.acquire()\n"
    run = VirtualRobot().run(text)
    assert [state.because for state in run.threads] == ["it holds the lock itself"]
    assert run.alarms[0].text.endswith("waits for a lock: it holds the lock itself")
