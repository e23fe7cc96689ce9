"""Events on the time line."""

from elitescript.messages.events import Alarm, MotionEnded, MotionStarted, SignalChanged, TextMessage, Warned
from elitescript.messages.motion import MoveJ
from elitescript.plotting.happenings import CHANGES_MAX, MARKS_MAX, MOVES_MAX, SIGNALS_MAX, marks, moves, signals

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


def test_a_signal_begins_with_the_value_that_it_had():
    events = [SignalChanged(250, "standard_digital_out[1]", True), SignalChanged(500, "output_int_register[4]", 9)]
    (register, output), left_out = signals(events, 0.0)
    assert (output["name"], output["t"], output["v"]) == ("standard_digital_out[1]", [0.0, 1.0], [0, 1])
    assert (register["name"], register["t"], register["v"]) == ("output_int_register[4]", [0.0, 2.0], [0, 9])
    assert left_out == 0


def test_a_signal_that_changes_twice_in_a_tick_shows_the_last_value():
    events = [SignalChanged(5, "standard_digital_out[1]", True), SignalChanged(5, "standard_digital_out[1]", False)]
    ((output,), _) = signals(events, 0.0)
    assert (output["t"], output["v"]) == ([0.0, 0.02], [0, 0])


def test_outputs_come_before_inputs_and_count_in_numbers():
    names = ["standard_digital_in[0]", "standard_digital_out[10]", "standard_digital_out[9]"]
    found, _ = signals([SignalChanged(1, name, True) for name in names], 0.0)
    assert [signal["name"] for signal in found] == names[::-1]


def test_a_signal_with_too_many_changes_says_so():
    events = [SignalChanged(tick, "standard_digital_out[1]", tick % 2 == 1) for tick in range(1, 2 * CHANGES_MAX)]
    ((output,), _) = signals(events, 0.0)
    assert len(output["t"]) == len(output["v"]) <= CHANGES_MAX
    assert output["left_out"] == 2 * CHANGES_MAX - len(output["t"])


def test_what_is_left_out_is_counted():
    events = [SignalChanged(1, f"output_bool_register[{index}]", True) for index in range(SIGNALS_MAX + 5)]
    found, left_out = signals(events, 0.0)
    assert (len(found), left_out) == (SIGNALS_MAX, 5)
    texts = [TextMessage(k, "x" * 1000, "main", 2) for k in range(MARKS_MAX + 7)]
    alarm = Alarm(9999, "R100", "NameError", "no n", 3, 1, "main")
    shown, left_out = marks([*texts, Warned(9998, "late"), alarm])
    assert (len(shown), left_out) == (MARKS_MAX + 1, 8)
    assert shown[-1] == {"kind": "alarm", "t": 39.996, "text": "R100 NameError: no n", "line": 3}
    assert len(shown[0]["text"]) == 300
