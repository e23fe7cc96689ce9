from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        (
            "def late():",
            "  sleep(5)",
            "  set_standard_digital_out(0, True)",
            "end",
            "start_thread(late, ())",
            "sleep(1)",
        ),
        ("def late():", "  sleep(0.5)", "  movel([0.4, 0, 0.3, 3.14, 0, 0])", "end", "start_thread(late, ())"),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["N222"]


@pytest.mark.parametrize(
    "lines",
    [
        (
            "def late():",
            "  sleep(5)",
            "  set_standard_digital_out(0, True)",
            "end",
            "t = start_thread(late, ())",
            "join_thread(t)",
        ),
        (
            "def soon():",
            "  sleep(0.5)",
            "  set_standard_digital_out(0, True)",
            "end",
            "start_thread(soon, ())",
            "sleep(1)",
        ),
        (
            "def blink():",
            "  while True:",
            "    set_standard_digital_out(0, True)",
            "    sleep(1)",
            "  end",
            "end",
            "start_thread(blink, ())",
            "sleep(0.1)",
        ),
        (
            "def late():",
            "  sleep(5)",
            "  set_standard_digital_out(0, True)",
            "end",
            "start_thread(late, ())",
            "movel([0.4, 0, 0.3, 3.14, 0, 0])",
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "N222" not in [problem.split()[0] for problem in body(*lines)]
