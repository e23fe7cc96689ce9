"""Each program with a mistake is told of what its marks say, at these lines, and of nothing else."""

from __future__ import annotations

import pytest

from tests.mistakes.told_cases import CASES, outcome


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.page}: {case.title}")
def test_what_is_told(case, tmp_path):
    told = outcome(case, tmp_path)
    assert (told.check, told.run) == (case.check, case.run)
    assert told.state == case.end
    assert all(text in told.why for text in case.why)


def test_every_case_has_a_mark():
    assert [
        case.title for case in CASES if not (case.check or case.run or case.why or case.is_silent or case.is_sound)
    ] == []
    assert [case.title for case in CASES if case.is_sound and (case.check or case.run or case.end != "finished")] == []
