from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        (
            "movel([0.4, 0, 0.4, 3.14, 0, 0], r=0.02)",
            "set_standard_digital_out(0, True)",
            "movel([0.5, 0, 0.4, 3.14, 0, 0])",
        ),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["N223"]


@pytest.mark.parametrize(
    "lines",
    [
        ("movel([0.4, 0, 0.4, 3.14, 0, 0])", "set_standard_digital_out(0, True)", "movel([0.5, 0, 0.4, 3.14, 0, 0])"),
        ("movel([0.4, 0, 0.4, 3.14, 0, 0], r=0.02)", "set_standard_digital_out(0, True)"),
        (
            "movel([0.4, 0, 0.4, 3.14, 0, 0], r=0.02)",
            "movel([0.5, 0, 0.4, 3.14, 0, 0])",
            "set_standard_digital_out(0, True)",
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "N223" not in [problem.split()[0] for problem in body(*lines)]
