import pickle

import pytest

from elitescript import VirtualRobot
from elitescript.controller.views.trace_signals import TraceSignals
from elitescript.errors import UsageError
from elitescript.messages.signals import SIGNALS

PROGRAM = """def main():
  sleep(0.02)
  set_standard_digital_out(1, True)
  sleep(0.02)
  set_standard_analog_out(0, 0.25)
  sleep(0.02)
  set_standard_digital_out(1, False)
end
"""


def test_every_row_has_the_signals_that_are_not_at_their_default():
    rows = VirtualRobot("CS66").run(PROGRAM, trace=True).trace
    assert [dict(rows[tick].signals) for tick in (0, 4, 5, 9, 10, 14, 15)] == [
        {},
        {},
        {"standard_digital_out[1]": True},
        {"standard_digital_out[1]": True},
        {"standard_digital_out[1]": True, "standard_analog_out[0]": 2.5},
        {"standard_digital_out[1]": True, "standard_analog_out[0]": 2.5},
        {"standard_analog_out[0]": 2.5},
    ]
    assert rows[0].signals["standard_digital_in[3]"] is False
    with pytest.raises(UsageError):
        rows[0].signals["standard_digital_in[99]"]


def test_rows_share_a_mapping_until_something_changes():
    rows = VirtualRobot("CS66").run(PROGRAM, trace=True).trace
    assert len({id(row.signals) for row in rows}) == 4


def test_signals_that_are_asked_for_are_in_every_row_and_no_others():
    rows = (
        VirtualRobot("CS66")
        .run(PROGRAM, trace=True, trace_signals=["standard_digital_out[1]", "output_int_register[4]"])
        .trace
    )
    assert rows[0].signals == {"standard_digital_out[1]": False, "output_int_register[4]": 0}
    assert rows[12].signals == {"standard_digital_out[1]": True, "output_int_register[4]": 0}
    assert len({id(row.signals) for row in rows}) == 3
    with pytest.raises(KeyError):
        rows[12].signals["standard_analog_out[0]"]


def test_families_and_all():
    assert TraceSignals("tool_digital_in").names == tuple(f"tool_digital_in[{index}]" for index in range(4))
    assert TraceSignals("standard_digital_in[2], standard_digital_in[2]").names == ("standard_digital_in[2]",)
    assert len(TraceSignals("all").names) == sum(row.size for row in SIGNALS.values())
    with pytest.raises(UsageError, match="standard_digital_inn"):
        TraceSignals("standard_digital_inn[0]")


def test_leaping_cannot_be_told_from_stepping():
    leaping = VirtualRobot("CS66").run(PROGRAM, trace=True).trace
    stepping = VirtualRobot("CS66").run(PROGRAM, trace=True, pace=lambda tick: None).trace
    assert leaping == stepping


def test_levels_are_values_that_nobody_can_change():
    one, other = (VirtualRobot("CS66").run(PROGRAM, trace=True).trace for _ in range(2))
    assert len({*one, *other}) == len(one)
    assert pickle.loads(pickle.dumps(one[12])) == one[12]
    with pytest.raises(TypeError):
        one[12].signals["standard_digital_out[1]"] = False
