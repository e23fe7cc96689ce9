from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ("while True:", "  try:", "    movel([2.0, 0, 0.3, 3.14, 0, 0])", "  except:", "    pass", "  end", "end"),
        (
            "n = 0",
            "while True:",
            "  try:",
            "    movej(get_inverse_kin(get_target_tcp_pose()))",
            "  except Exception:",
            "    n = n + 1",
            "  end",
            "end",
        ),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W261"]


@pytest.mark.parametrize(
    "lines",
    [
        (
            "while True:",
            "  try:",
            "    movel([2.0, 0, 0.3, 3.14, 0, 0])",
            "  except Exception as e:",
            "    textmsg(e)",
            "  end",
            "end",
        ),
        ("while True:", "  try:", "    movel([2.0, 0, 0.3, 3.14, 0, 0])", "  except:", "    break", "  end", "end"),
        (
            "while True:",
            "  try:",
            "    sleep(0.1)",
            "    movel([2.0, 0, 0.3, 3.14, 0, 0])",
            "  except:",
            "    pass",
            "  end",
            "end",
        ),
        (
            "while True:",
            "  try:",
            "    movel([2.0, 0, 0.3, 3.14, 0, 0])",
            "  except:",
            "    pass",
            "  end",
            "  sleep(0.1)",
            "end",
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W261" not in [problem.split()[0] for problem in body(*lines)]
