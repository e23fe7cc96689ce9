from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        'socket_open("1.2.3.4", 80)\ns = socket_read_string(timeout=2000)\ntextmsg(s)',
        "movej([0, -1.5, -1.5, -1.5, 1.5, 0], t=1500)",
        "t_s = 500\nb = serial_read(4, True, t_s)\ntextmsg(b)",
        "servoj([0, -1.5, -1.5, -1.5, 1.5, 0], t=8)",
        'for wait in [500, 1000]:\n  s = socket_read_string("a", "", "", wait)\n  textmsg(s)\nend',
    ],
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines.split("\n"))] == ["W244"]


@pytest.mark.parametrize(
    "lines",
    [
        "movej([0, -1.5, -1.5, -1.5, 1.5, 0], t=99)",
        "sleep(60)",
        "servoj([0, -1.5, -1.5, -1.5, 1.5, 0], t=0.008)",
        "s = socket_read_string(timeout=60)\ntextmsg(s)",
        "s = socket_read_string(timeout=0)\ntextmsg(s)",
    ],
)
def test_what_almost_is_one_is_not_found(lines):
    assert body(*lines.split("\n")) == []
