"""What the commands of encoders and conveyors ask of the machine, and what they refuse."""

import pytest

from elitescript.errors import ArgumentRangeError, ArgumentTypeError
from elitescript.messages.enums import PulseDecoder
from elitescript.messages.machine import DecodePulses, PrepareEncoder, SetEncoderCount
from elitescript.messages.motion import StopTracking, TrackCircular, TrackLinear


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("encoder_enable_set_tick_count(0, 4)", PrepareEncoder(0, 4)),
        ("encoder_set_tick_count(1, 1234)", SetEncoderCount(1, 1234.0)),
        ("encoder_enable_pulse_decode(0, 1, 16, 17)", DecodePulses(0, PulseDecoder.QUADRATURE, 16, 17)),
        ("encoder_enable_pulse_decode(1, 2, 18, 0)", DecodePulses(1, PulseDecoder.EDGES, 18, 0)),
        ("encoder_enable_pulse_decode(0, 3, 16, 16)", DecodePulses(0, PulseDecoder.RISING, 16, 16)),
        ("encoder_enable_pulse_decode(0, 4, 19, 0)", DecodePulses(0, PulseDecoder.FALLING, 19, 0)),
        ("track_conveyor_linear([1, 0, 0, 0, 0, 0], 1000.0)", TrackLinear((1.0, 0.0, 0.0), 1000.0, 0)),
        ("track_conveyor_linear([0, 0, -3, 9, 9, 9], -20, 1)", TrackLinear((0.0, 0.0, -3.0), -20.0, 1)),
        (
            "track_conveyor_circular([0.5, 0.5, 0, 0, 0, 0], 500.0, False)",
            TrackCircular((0.5, 0.5, 0.0, 0.0, 0.0, 0.0), 500.0, False, 0),
        ),
        (
            "track_conveyor_circular([0, 0, 0, 0, 0, 0], 500, True, encoder_index=1)",
            TrackCircular((0.0,) * 6, 500.0, True, 1),
        ),
        ("stop_conveyor_tracking()", StopTracking()),
    ],
)
def test_asks_for(script, robot, text, wanted):
    assert script(text) is None
    assert robot.asked == [wanted]


def test_reads_the_count_and_unwinds_with_the_range_of_the_encoder(script, robot):
    assert script("encoder_get_tick_count(1)") == 865.0
    assert script("encoder_unwind_delta_tick_count(0, -64666)") == 870.0
    assert robot.asked == []


@pytest.mark.parametrize(
    ("text", "argument", "message"),
    [
        ("encoder_enable_set_tick_count(2, 0)", "encoder_index", "must be one of 0, 1, got 2"),
        ("encoder_get_tick_count(-1)", "encoder_index", "must be one of 0, 1, got -1"),
        ("track_conveyor_linear([1, 0, 0, 0, 0, 0], 1000, 2)", "encoder_index", "must be one of 0, 1, got 2"),
        ("encoder_enable_set_tick_count(0, 5)", "range_id", r"must be in \[0, 4\], got 5"),
        ("encoder_enable_pulse_decode(0, 0, 16, 17)", "decoder_type", r"must be in \[1, 4\], got 0"),
        ("encoder_enable_pulse_decode(0, 1, 15, 17)", "A", r"must be in \[16, 19\], got 15"),
        ("encoder_enable_pulse_decode(0, 1, 16, 16)", "B", r"must be another input than A \(16\)"),
        ("encoder_enable_pulse_decode(0, 1, 16, 0)", "B", r"must be another input than A \(16\)"),
        ("track_conveyor_linear([0, 0, 0, 1, 0, 0], 1000)", "direction", "must have a length"),
        ("track_conveyor_linear([1, 0, 0, 0, 0, 0], 0)", "ticks_per_meter", "must not be 0"),
        ("track_conveyor_circular([0, 0, 0, 0, 0, 0], 0.0)", "ticks_per_revolution", "must not be 0"),
    ],
)
def test_refuses_out_of_range(script, robot, text, argument, message):
    with pytest.raises(ArgumentRangeError, match=message) as caught:
        script(text)
    assert (caught.value.code, caught.value.argument) == ("R102", argument)
    assert caught.value.command == text.partition("(")[0]
    assert robot.asked == []


def test_refuses_what_is_no_direction(script):
    with pytest.raises(ArgumentTypeError, match=r"direction must have 6 elements \[x, y, z, 0, 0, 0\], got 3"):
        script("track_conveyor_linear([1, 0, 0], 1000)")
