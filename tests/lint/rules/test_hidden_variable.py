from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        (
            "ready = False",
            "def watch():",
            "  ready = True",
            "end",
            "start_thread(watch, ())",
            "while not ready:",
            "  sync()",
            "end",
        ),
        (
            "done = 0",
            "def w():",
            "  done = 1",
            "end",
            "h = start_thread(w, ())",
            "while True:",
            "  if done:",
            "    break",
            "  end",
            "  sleep(0.1)",
            "end",
            "stop_thread(h)",
        ),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W258"]


@pytest.mark.parametrize(
    "lines",
    [
        (
            "ready = False",
            "def watch():",
            "  nonlocal ready",
            "  ready = True",
            "end",
            "start_thread(watch, ())",
            "while not ready:",
            "  sync()",
            "end",
        ),
        (
            "speed = 0.1",
            "def f():",
            "  speed = 0.2",
            "  movel(get_target_tcp_pose(), v=speed)",
            "end",
            "f()",
            "textmsg(speed)",
        ),
        ("n = 0", "def f():", "  n = 1", "end", "f()", "textmsg(n)"),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W258" not in [problem.split()[0] for problem in body(*lines)]
