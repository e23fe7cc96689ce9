from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ("ready = False", "while not ready:", "  sleep(0.1)", "end"),
        ("go = get_standard_digital_in(0)", "while not go:", "  sleep(0.1)", "end"),
        ("def until(x):", "  while not x:", "    sync()", "  end", "end", "until(get_standard_digital_in(0))"),
        ("v = read_input_integer_register(0)", "while v < 5:", "  sync()", "end"),
        ("waited = 0", "while not get_flag(0) and waited < 2:", "  sleep(0.1)", "end"),
        ("left = 9", "while left > 0 and get_flag(0) != True:", "  sync()", "  movej([0, 0, 0, 0, 0, 0])", "end"),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W259"]


@pytest.mark.parametrize(
    "lines",
    [
        ("x = 0", "while x != 2:", "  x = x + 0.5", "  sleep(0.1)", "end"),
        ("x = 0", "while x < 1:", "  x = x + 0.1", "  sleep(0.1)", "end"),
        ("n = 0", "while n < 5:", "  n = n + 1", "  sync()", "end"),
        ("while not get_standard_digital_in(0):", "  sync()", "end"),
        ("running = True", "while running:", "  sleep(1)", "end"),
        ("debug = False", "while debug:", "  sleep(1)", "end"),
        ("waited = 0", "while not get_flag(0) and waited < 2:", "  waited = waited + 0.1", "  sleep(0.1)", "end"),
        ("n = 0", "PARTS = 9", "while not get_flag(0) and PARTS > n:", "  n = n + 1", "  sync()", "end"),
        ("MODE = 3", "while not get_flag(0) and MODE > 2:", "  sync()", "end"),
        (
            "ready = False",
            "def w():",
            "  nonlocal ready",
            "  ready = True",
            "end",
            "start_thread(w, ())",
            "while not ready:",
            "  sync()",
            "end",
        ),
        ("ready = False", "while not ready:", "  sleep(0.1)", "  if get_flag(0):", "    break", "  end", "end"),
        ("q = [0]", "def w():", "  q[0] = 1", "end", "start_thread(w, ())", "while q[0] == 0:", "  sync()", "end"),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W259" not in [problem.split()[0] for problem in body(*lines)]


def test_a_number_that_steps_never_meet_exactly_is_found():
    lines = ("x = 0.0", "while x != 1.0:", "  x = x + 0.1", "  sleep(0.1)", "end")
    assert body(*lines) == ["W259 3:9"]
    assert body("x = 1.0", "while x != 0:", "  x -= 0.1", "  sleep(0.1)", "end") == ["W259 3:9"]
