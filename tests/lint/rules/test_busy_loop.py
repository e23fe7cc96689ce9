from __future__ import annotations

import pytest

from tests.lint.checking import body, found, marked, only


def test_an_endless_loop_without_a_wait_is_found():
    assert body("while True:", "  pass") == ["W204 2:3"]
    assert marked("def job():\n  while True:   # for ever\n    x = 1\n  end\nend\n").startswith("while True:")


@pytest.mark.parametrize(
    "lines",
    [
        ("while not get_standard_digital_in(0):", "  pass"),
        ("while get_standard_analog_in(0) < 2.5 and not get_flag(1):", "  textmsg('waiting')"),
        ("while True:", "  if get_standard_digital_in(3):", "    break"),
        ("while 1:", "  if get_flag(0):", "    if get_flag(1):", "      return"),
        ("while read_input_integer_register(0) == 0:", "  set_standard_digital_out(1, True)"),
        ("began = controller_timestamp()", "while controller_timestamp() - began < 2:", "  pass"),
        ("import time", "began = time.time()", "while time.time() - began < 2:", "  pass"),
        ("while get_actual_tcp_pose()[2] > 0.1:", "  x = [n * n for n in range(3)]"),
        ("def ready():", "  return get_flag(0)", "while not ready():", "  pass"),
        ("def look():", "  textmsg(get_flag(0))", "while True:", "  look()"),
        ("$ LINE: (1, 'loop')", "while True:", "  $ LINE: (2, 'nothing')"),
        ("lines = []", "while True:", "  lines.append('x'.upper())"),
        ("while True:", "  try:", "    x = int('3')", "  except ValueError:", "    textmsg('no number')"),
        ("while True:", "  import math", "  x = math.pi"),
    ],
    ids=str,
)
def test_loops_that_only_the_outside_can_end_are_found(lines):
    line = next(number for number, text in enumerate(lines, 2) if text.startswith("while"))
    assert body(*lines) == [f"W204 {line}:3"]


def test_a_global_that_another_thread_sets_is_the_outside():
    text = """
    def job():
      global done
      done = False
      def worker():
        global done
        sleep(1)
        done = True
      end
      start_thread(worker, ())
      while not done:
        pass
      end
    end
    """
    assert found(text) == ["W204 10:3"]


@pytest.mark.parametrize(
    "lines",
    [
        ("while True:", "  sync()"),
        ("while True:", "  sleep(0.1)"),
        ("while not get_standard_digital_in(0):", "  sync()"),
        ("while True:", "  movej([0, 0, 0, 0, 0, 0])"),
        ("while True:", "  if get_flag(0):", "    sleep(1)"),
        ("while True:", "  socket_read_string()"),
        ("import queue", "box = queue.Queue()", "while True:", "  textmsg(box.get())"),
        ("import time", "while True:", "  time.sleep(1)"),
        ("import threading", "lock = threading.Lock()", "while True:", "  with lock:", "    x = 1"),
        ("def rest():", "  sleep(1)", "while True:", "  rest()"),
        ("def rest():", "  sleep(1)", "def work():", "  rest()", "while True:", "  work()"),
        ("def f(wait):", "  while True:", "    wait()", "f(sync)"),
        ("def f():", "  while True:", "    yield 1", "textmsg(f)"),
        ("gripper = rpc_factory('xmlrpc', 'http://127.0.0.1:9')", "while True:", "  gripper.poll()"),
        ("while True:", "  if get_flag(0):", "    halt()"),
        ("while True:", "  try:", "    x = int('3')", "  except ValueError:", "    sleep(1)"),
        ("while True:", "  try:", "    x = next(iter([]))", "  except StopIteration:", "    break"),
    ],
    ids=str,
)
def test_a_loop_that_may_wait_is_left_alone(lines):
    assert body(*lines) == []


@pytest.mark.parametrize(
    "lines",
    [
        ("n = 0", "while n < 3:", "  n += 1"),
        ("n = 0", "while True:", "  n += 1", "  if n > 2:", "    break"),
        ("parts = [1, 2]", "while parts:", "  parts.pop()"),
        ("parts = []", "while len(parts) < 3:", "  parts.append(1)"),
        ("while True:", "  break"),
        ("while False:", "  pass"),
        ("def f(n):", "  while n > 1:", "    n = n / 2", "f(8)"),
        ("n = [3]", "while n[0] > 0:", "  n[0] -= 1"),
        ("n = [3]", "def less():", "  n[0] = n[0] - 1", "while n[0] > 0:", "  less()"),
        ("def less(box):", "  box[0] = 0", "n = [3]", "while n[0] > 0:", "  less(n)"),
        ("global n", "n = 3", "def less():", "  global n", "  n = n - 1", "while n > 0:", "  less()"),
        ("global n", "n = 3", "def left():", "  return n", "while left() > 0:", "  n = n - 1"),
        ("items = iter([1, 2])", "try:", "  while True:", "    x = next(items)", "except StopIteration:", "  pass"),
        ("items = [1, 2]", "n = 0", "try:", "  while True:", "    x = items[n]", "except IndexError:", "  pass"),
        ("while random() < 0.9:", "  pass"),
        ("while True:", "  for n in range(3):", "    if n == 2:", "      return"),
        ("for n in range(1000):", "  pass"),
    ],
    ids=str,
)
def test_a_loop_that_ends_by_what_it_does_is_left_alone(lines):
    assert body(*lines) == []


def test_methods_of_the_programs_own_classes_may_wait():
    lines = ("class Log:", "  def append(self, x):", "    sleep(1)", "log1 = Log()", "while True:", "  log1.append(1)")
    assert body(*lines) == []


def test_functions_that_call_each_other_do_not_loop_the_check():
    lines = ("def a1():", "  b1()", "def b1():", "  a1()", "while True:", "  a1()")
    assert body(*lines) == ["W204 6:3"]


def test_nothing_is_said_about_a_text_with_errors():
    assert body("while True:", "  sleep(") == ["E001 3:10"]


def test_the_hint_says_what_to_put_in():
    assert only("def job():\n  while True:\n    pass\nend\n").hint == "put sync() or sleep(0.01) into it"


@pytest.mark.parametrize(
    "lines",
    [
        ("n = 0", "while not get_standard_digital_in(4) and n < 100:", "  n = n + 1"),
        ("n = 0", "while get_standard_digital_in(4) != True and n < 2.0:", "  n += 0.1"),
        (
            "def on():",
            "  return get_flag(1)",
            "end",
            "n = 0",
            "while not on():",
            "  n = n + 1",
            "  if n > 9:",
            "    break",
        ),
    ],
    ids=str,
)
def test_loops_that_ask_for_one_moment_until_a_counter_ends_them_are_found(lines):
    line = next(number for number, text in enumerate(lines, 2) if text.startswith("while"))
    assert body(*lines) == [f"W204 {line}:3"]


@pytest.mark.parametrize(
    "lines",
    [
        ("n = 0", "while not get_standard_digital_in(4) and n < 100:", "  n = n + 1", "  sync()"),
        ("n = 0", "while not get_standard_digital_in(n) and n < 15:", "  n = n + 1"),
        ("n = 0", "while n < 100:", "  n = n + 1"),
        ("n = 0", "while get_flag(1) and n < 9:", "  n = n + 1", "  set_standard_digital_out(n, True)"),
    ],
    ids=str,
)
def test_loops_that_count_something_else_are_not_found(lines):
    assert body(*lines) == []
