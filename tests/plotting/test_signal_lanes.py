"""Lanes of signals: from events, and from the columns of a trace."""

from math import inf

from elitescript.controller.views.trace_signals import SignalLevels
from elitescript.messages.events import SignalChanged
from elitescript.plotting.packing import undo_deltas
from elitescript.plotting.signal_lanes import (
    CHANGES_MAX,
    OTHERS_MAX,
    SIGNALS_MAX,
    signal_lanes,
    signal_lanes_of_rows,
)
from tests.plotting.recordings import row


def times(lane):
    return undo_deltas(lane["t"])


def test_a_signal_begins_with_the_value_that_it_had():
    events = [SignalChanged(250, "standard_digital_out[1]", True), SignalChanged(500, "output_int_register[4]", 9)]
    output, register = signal_lanes(events, 0.0)["lanes"]
    assert (output["name"], times(output), output["v"]) == ("standard_digital_out[1]", [0, 1000], [0, 1])
    assert (register["name"], times(register), register["v"]) == ("output_int_register[4]", [0, 2000], [0, 9])


def test_a_level_says_what_caused_it():
    events = [
        SignalChanged(1, "standard_digital_out[1]", True, "program", 12),
        SignalChanged(2, "standard_digital_in[0]", True, "wire"),
        SignalChanged(3, "standard_digital_out[1]", False, "program", 12),
    ]
    found = signal_lanes(events, 0.0)
    causes = [[found["causes"][index] for index in lane["by"]] for lane in found["lanes"]]
    assert causes == [[["", 0], ["program", 12], ["program", 12]], [["", 0], ["wire", 0]]]


def test_a_signal_that_changes_twice_in_a_tick_shows_the_last_value():
    events = [
        SignalChanged(5, "standard_digital_out[1]", True),
        SignalChanged(5, "standard_digital_out[1]", False, "x"),
    ]
    found = signal_lanes(events, 0.0)
    (output,) = found["lanes"]
    assert (times(output), output["v"], found["causes"][output["by"][1]]) == ([0, 20], [0, 0], ["x", 0])


def test_terminals_come_before_registers_and_count_in_numbers():
    names = ["output_int_register[0]", "standard_digital_in[0]", "standard_digital_out[10]", "standard_digital_out[9]"]
    lanes = signal_lanes([SignalChanged(1, name, 1) for name in names], 0.0)["lanes"]
    assert [lane["name"] for lane in lanes] == names[::-1]


def test_a_signal_with_too_many_changes_says_so():
    events = [SignalChanged(tick, "standard_digital_out[1]", tick % 2 == 1) for tick in range(1, 2 * CHANGES_MAX)]
    (output,) = signal_lanes(events, 0.0)["lanes"]
    assert len(output["t"]) == len(output["v"]) == len(output["by"]) <= CHANGES_MAX
    assert output["left_out"] == 2 * CHANGES_MAX - len(output["t"])


def test_signals_without_a_lane_are_named_and_their_changes_kept():
    names = [f"output_bool_register[{index}]" for index in range(SIGNALS_MAX + 5)]
    events = [SignalChanged(tick, name, tick % 2 == 1) for tick in range(1, 51) for name in names]
    found = signal_lanes(events, 0.0)
    assert len(found["lanes"]) == SIGNALS_MAX
    assert found["others"] == names[SIGNALS_MAX:]
    assert found["other_changes"][0] == [0.004, f"{names[SIGNALS_MAX]} = True", 0]
    assert len(found["other_changes"]) == OTHERS_MAX
    assert found["other_changes_left_out"] == 5 * 50 - OTHERS_MAX


def test_a_level_that_is_not_finite_is_no_number():
    events = [SignalChanged(1, "output_float_register[0]", inf), SignalChanged(2, "output_float_register[0]", 2.5)]
    (lane,) = signal_lanes(events, 0.0)["lanes"]
    assert lane["v"] == [0.0, None, 2.5]


def test_the_columns_of_a_trace_are_lanes():
    low = SignalLevels({"standard_digital_out[0]": False, "flag[3]": False})
    high = SignalLevels({"standard_digital_out[0]": True, "flag[3]": False})
    rows = [row(0.004 * k)._replace(signals=high if 2 <= k < 4 else low) for k in range(6)]
    output, flag = signal_lanes_of_rows(rows)["lanes"]
    assert (output["name"], times(output), output["v"]) == ("standard_digital_out[0]", [0, 8, 16], [0, 1, 0])
    assert (flag["name"], times(flag), flag["v"]) == ("flag[3]", [0], [0])


def test_of_many_columns_those_that_change_are_lanes():
    names = [f"output_bool_register[{index}]" for index in range(SIGNALS_MAX + 5)]
    low = SignalLevels(dict.fromkeys(names, False))
    high = SignalLevels({**low, names[-1]: True})
    found = signal_lanes_of_rows([row(0.0)._replace(signals=low), row(0.004)._replace(signals=high)])
    assert [lane["name"] for lane in found["lanes"]] == [names[-1]]
    assert found["others"] == []


def test_a_trace_without_signals_has_no_lanes():
    assert signal_lanes_of_rows([row(0.0), row(0.004)])["lanes"] == []
