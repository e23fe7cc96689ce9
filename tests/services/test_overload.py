"""What the log says of a robot whose ticks come late."""

from __future__ import annotations

from elitescript.services.time.overload import FIRST_TICKS, NEXT_TICKS, Overload, Report


def said(late_share: float, left_out_share: float, minutes: float) -> list[tuple[float, Report]]:
    """Reports and when they came, s, while such shares of every 100 ticks of the wall clock are late or left out."""
    overload, found = Overload(), list[tuple[float, Report]]()
    late = left_out = 0.0
    for number in range(round(minutes * 60 * 250 / 100)):
        late, left_out = late + 100 * late_share, left_out + 100 * left_out_share
        overload.pass_on(round(100 * (1 - left_out_share)))
        if (report := overload.due(round(late), round(left_out), 12.5)) is not None:
            found.append((0.4 * (number + 1), report))
    return found


def test_nothing_is_said_of_a_robot_that_keeps_its_time() -> None:
    assert said(0.0, 0.0, 10) == []


def test_an_overloaded_robot_is_named_after_ten_seconds_and_then_once_a_minute() -> None:
    found = said(0.12, 0.02, 5)
    assert [round(at_s) for at_s, _ in found] == [10, 70, 130, 190, 250]
    assert all(report.is_problem for _, report in found)
    _, second = found[1]
    assert str(second) == (
        "overloaded: 14 % of the robot's time was late or left out: 1800 of 14700 ticks began late, by 12.5 ms at "
        "most, and 300 (1.2 s) were left out, so that robot time passed at 98.0 %"
    )


def test_one_that_runs_at_a_tenth_is_named_as_soon_by_the_wall_clock() -> None:
    found = said(0.05, 0.9, 2)
    assert [round(at_s) for at_s, _ in found] == [10, 70]


def test_a_few_late_ticks_are_no_problem() -> None:
    found = said(0.004, 0.0, 0.5)
    assert [(report.is_problem, str(report)) for _, report in found] == 3 * [
        (False, f"10 of {FIRST_TICKS} ticks began late, by 12.5 ms at most: the computer is busy")
    ]


def test_ticks_that_are_left_out_are_named_at_once_only_if_no_report_has_them() -> None:
    overload = Overload()
    assert overload.names_left_out()
    assert not overload.names_left_out()
    overload.pass_on(FIRST_TICKS)
    assert overload.due(0, 100, 400.0) is not None
    assert not overload.names_left_out(), "the next report will count them"
    overload.pass_on(NEXT_TICKS)
    assert overload.due(0, 100, 0.0) is None
    assert overload.names_left_out()
