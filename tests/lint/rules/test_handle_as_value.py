from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ("def w():", "  return 0.25", "end", "h = start_thread(w, ())", "set_standard_analog_out(0, h)"),
        ("def w():", "  return 0.25", "end", "h = start_thread(w, ())", "textmsg(h + 1)"),
        (
            "def w():",
            "  return 0.25",
            "end",
            "h = start_thread(w, ())",
            "movel(pose_add(get_target_tcp_pose(), [0, 0, h, 0, 0, 0]))",
        ),
        ("def w():", "  return 0.25", "end", "h = start_thread(w, ())", "if h:", "  halt()", "end"),
        ("def w():", "  return 0.25", "end", "h = start_thread(w, ())", "if h == True:", "  halt()", "end"),
        ("def w():", "  return 0.25", "end", "h = start_thread(w, ())", "if h > 0.2:", "  halt()", "end"),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W254"]


@pytest.mark.parametrize(
    "lines",
    [
        ("def w():", "  sync()", "end", "h = start_thread(w, ())", "join_thread(h)"),
        (
            "def w():",
            "  sync()",
            "end",
            "h = start_thread(w, ())",
            'textmsg("handle ", h)',
            "if h == 0:",
            "  halt()",
            "end",
            "stop_thread(h)",
        ),
        (
            "def w():",
            "  sync()",
            "end",
            "h = -1040206272",
            "if get_flag(0):",
            "  h = start_thread(w, ())",
            "end",
            "textmsg(h + 1)",
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W254" not in [problem.split()[0] for problem in body(*lines)]
