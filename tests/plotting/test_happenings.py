"""Events on the time line."""

from elitescript.messages.events import Alarm, DeviceNoted, MotionEnded, MotionStarted, TextMessage, Warned
from elitescript.messages.motion import MoveJ
from elitescript.plotting.events import MARKS_MAX, MOVES_MAX, marks, moves

Q = (0.0,) * 6


def move(tick, duration_s=1.0):
    return MotionStarted(tick, MoveJ(Q, 1.0, 1.0), 7, "main", duration_s)


def test_a_move_lasts_until_it_ends_or_the_run_does():
    events = [move(0), MotionEnded(250, True), move(250, 0.0), MotionEnded(251, True), move(500)]
    assert moves(events, 2.5) == [[0.0, 1.0, "movej", 7], [2.0, 2.5, "movej", 7]]


def test_very_many_moves_become_fewer_over_the_same_time():
    events = [move(tick) for tick in range(4 * MOVES_MAX)]
    found = moves(events, 0.004 * 4 * MOVES_MAX)
    assert len(found) <= MOVES_MAX
    assert (found[0][0], found[-1][1]) == (0.0, 0.004 * 4 * MOVES_MAX)


def test_what_is_left_out_is_counted():
    texts = [TextMessage(k, "x" * 1000, "main", 2) for k in range(MARKS_MAX + 7)]
    alarm = Alarm(9999, "R100", "NameError", "no n", 3, 1, "main")
    shown, left_out = marks([*texts, Warned(9998, "late"), alarm])
    assert (len(shown), left_out) == (MARKS_MAX + 1, 8)
    assert shown[-1] == {"kind": "alarm", "t": 39.996, "text": "R100 NameError: no n", "line": 3}
    assert len(shown[0]["text"]) == 300


def test_an_alarm_has_its_hints_and_the_thread_it_was_in():
    details = {"hint": "did you mean 'sleep'?", "hints": ["a", ""]}
    ((mark,), _) = marks([Alarm(5, "R100", "NameError", "no slep", 3, 1, "camera", details=details)])
    assert (mark["hints"], mark["thread"]) == (["did you mean 'sleep'?", "a"], "camera")
    ((mark,), _) = marks([Alarm(5, "R100", "NameError", "no slep", 3, 1, "main")])
    assert "hints" not in mark
    assert "thread" not in mark


def test_a_warning_has_its_code_and_hint():
    ((mark,), _) = marks([Warned(5, "limited to 3 s", "main", 3, "W216", "give less")])
    assert (mark["text"], mark["hints"]) == ("W216 limited to 3 s", ["give less"])
    ((mark,), _) = marks([Warned(5, "limited to 3 s")])
    assert mark["text"] == "limited to 3 s"


def test_what_devices_report_is_among_the_messages():
    found, _ = marks([DeviceNoted(1, "camera", "ready"), DeviceNoted(2, "camera", "trigger lost", is_warning=True)])
    assert [(mark["kind"], mark["text"]) for mark in found] == [
        ("device", "camera: ready"),
        ("warning", "camera: trigger lost"),
    ]
