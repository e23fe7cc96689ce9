"""What `make stops` calls late: the limits, the packages of all actions together, and what is never measured."""

from __future__ import annotations

import pytest

from tests.stops.__main__ import Row, quantile, summary, verdict

IN_TIME = (1.0,) * 200


def row(action: str = "stop", **changes) -> Row:
    found = Row("sin accepted", action, 8.0, IN_TIME, IN_TIME, 1.0, "")
    return found._replace(**changes)


def test_the_limits_are_20_ms_for_an_action_10_for_packages_and_1_percent_of_robot_time():
    assert verdict([row()]).holds
    assert verdict([row(acted_ms=20.0, late_ms=(10.0,) * 200, share=0.9901)]).holds
    assert not verdict([row(), row(acted_ms=20.1)]).holds
    assert not verdict([row(late_ms=(10.1,) * 200)]).holds
    assert not verdict([row(), row(share=0.989)]).holds
    assert not verdict([row(), row(share=1.011)]).holds
    assert not verdict([row(), row(acted_ms=None)]).holds


def test_an_alarm_on_a_line_is_an_answer_for_streams_and_time_and_none_for_a_stop():
    late = row(late_ms=(50.0,) * 200, share=0.9, alarm="R135:4")
    assert verdict([row(), late]).holds
    assert not verdict([late._replace(acted_ms=25.0)]).holds


def test_packages_of_all_actions_count_together():
    hiccup = row("estop", late_ms=(1.0,) * 195 + (40.0,) * 5)
    assert not verdict([hiccup]).holds
    assert verdict([hiccup, row(), row("pause"), row("replace")]).late_p99_ms == 1.0


@pytest.mark.parametrize(("part", "value"), [(0.5, 50.0), (0.99, 99.0), (1.0, 99.0)])
def test_a_quantile_is_a_value_that_was_measured(part, value):
    assert quantile(map(float, range(100)), part) == value


def test_nothing_has_no_quantile():
    assert quantile((), 0.99) == 0.0


def test_the_summary_tells_what_held_when_measured_again_from_what_never_did():
    good, late = verdict([row()]), verdict([row(acted_ms=30.0)])
    text = summary({"a": [good], "b": [late, good], "c": [late, late, late]}, [row(), row(acted_ms=30.0)])
    assert "3 programs, 2 runs: 1 hold, of the others 1 when measured again; 1 never" in text
    assert "1 of 2 beyond 20" in text
