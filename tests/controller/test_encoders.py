"""Counters of conveyors: ranges, counting, starting again, and what is known between two counts."""

from random import Random

import pytest

from elitescript.controller.controller import Controller
from elitescript.controller.motion.conveyor_encoders import GAP_TICKS, RANGES, CountLine, Encoder
from elitescript.errors import ArgumentRangeError, ScriptStateError
from elitescript.messages.enums import PulseDecoder
from elitescript.messages.machine import DecodePulses, PrepareEncoder, SetEncoderCount, WriteSignal
from elitescript.models.model import load_model

BOUNDS = [(-2147483648, 2147483647), (0, 255), (0, 65535), (0, 16777215), (0, 4294967295)]


def prepared(range_id, count=None, tick=0):
    encoder = Encoder(0)
    encoder.prepare(PrepareEncoder(0, range_id), tick)
    if count is not None:
        encoder.set_count(SetEncoderCount(0, count), tick)
    return encoder


def decoding(decoder, speed):
    encoder = Encoder(0)
    encoder.turn(speed, 0)
    encoder.decode(DecodePulses(0, decoder, 16, 17), 0)
    return encoder


@pytest.mark.parametrize("range_id", range(5))
class TestEveryRange:
    def test_has_the_bounds_of_the_manual(self, range_id):
        assert (RANGES[range_id].low, RANGES[range_id].high) == BOUNDS[range_id]

    def test_takes_its_bounds_and_nothing_beyond(self, range_id):
        encoder = prepared(range_id)
        low, high = BOUNDS[range_id]
        for count in (low, high):
            encoder.set_count(SetEncoderCount(0, float(count)), 0)
            assert encoder.count(0) == count
        for count in (low - 1, high + 1, high + 0.5):
            with pytest.raises(ArgumentRangeError, match=rf"count must be in \[{low}, {high}\]") as caught:
                encoder.set_count(SetEncoderCount(0, float(count)), 0)
            assert (caught.value.code, caught.value.argument, caught.value.unit) == ("R102", "count", "ticks")
        assert encoder.count(0) == high

    def test_counts_over_its_end_both_ways(self, range_id):
        low, high = BOUNDS[range_id]
        encoder = prepared(range_id, float(high))
        encoder.turn(250.0, 0)
        assert [encoder.count(tick) for tick in (0, 1, 2)] == [high, low, low + 1]
        encoder.turn(-250.0, 2)
        assert [encoder.count(tick) for tick in (2, 3, 4)] == [low + 1, low, high]

    def test_a_difference_over_its_end_is_put_right(self, range_id):
        low, high = BOUNDS[range_id]
        limits = RANGES[range_id]
        assert limits.unwound(float(low + 3) - (high - 5)) == 9.0
        assert limits.unwound(float(high - 5) - (low + 3)) == -9.0
        assert limits.unwound(100.0) == 100.0

    def test_what_goes_by_knows_no_end(self, range_id):
        low, high = BOUNDS[range_id]
        encoder = prepared(range_id, float(high - 10))
        before = encoder.line(0).at(0)
        encoder.set_count(SetEncoderCount(0, float(low + 20)), 5)
        assert encoder.line(5).at(5) - before == 31.0


def test_the_difference_of_the_manual():
    assert RANGES[2].unwound(-64666.0) == 870.0


def test_half_a_range_is_returned_as_it_is():
    assert [RANGES[1].unwound(delta) for delta in (128.0, -128.0, 129.0, -129.0)] == [128.0, -128.0, -127.0, 127.0]


def test_counts_at_any_tick_without_having_seen_those_before():
    encoder = Encoder(0)
    encoder.turn(1000.0, 0)
    assert encoder.count(10**9) == RANGES[0].wrapped(4e9)
    assert [encoder.count(tick) for tick in (0, 1, 250)] == [0.0, 4.0, 1000.0]


def test_changes_of_speed_add_up_exactly():
    generator = Random(11)
    encoder, expected, tick, speed = Encoder(0), 0, 0, 0
    for _ in range(200):
        tick_next = tick + generator.randrange(0, 500)
        expected += speed * (tick_next - tick)
        tick, speed = tick_next, generator.randrange(-40, 40)
        encoder.turn(speed * 250.0, tick)
    assert encoder.count(tick) == expected


def test_shows_whole_counts():
    encoder = Encoder(0)
    encoder.turn(100.0, 0)
    assert [encoder.count(tick) for tick in range(6)] == [0.0, 0.0, 0.0, 1.0, 1.0, 2.0]
    assert encoder.line(3).at(3) == pytest.approx(1.2)


def test_shows_what_was_set_even_between_two_counts():
    assert prepared(2, 12.25).count(9) == 12.25


def test_quadrature_counts_both_ways():
    assert decoding(PulseDecoder.QUADRATURE, 400.0).count(250) == 400.0
    assert decoding(PulseDecoder.QUADRATURE, -400.0).count(250) == -400.0


@pytest.mark.parametrize(
    ("decoder", "count"), [(PulseDecoder.EDGES, 200.0), (PulseDecoder.RISING, 100.0), (PulseDecoder.FALLING, 100.0)]
)
def test_one_channel_sees_fewer_edges_and_no_direction(decoder, count):
    assert decoding(decoder, 400.0).count(250) == count
    assert decoding(decoder, -400.0).count(250) == count


def test_setting_up_begins_at_zero_and_is_no_way_of_the_conveyor():
    encoder = Encoder(1)
    encoder.turn(1000.0, 0)
    encoder.decode(DecodePulses(1, PulseDecoder.QUADRATURE, 18, 19), 50)
    assert encoder.count(50) == 0.0
    assert encoder.line(50).at(50) == 200.0


def test_a_count_needs_an_encoder_that_takes_it():
    for encoder in (Encoder(1), decoding(PulseDecoder.QUADRATURE, 0.0)):
        with pytest.raises(ScriptStateError, match="does not take its count from the program") as caught:
            encoder.set_count(SetEncoderCount(0, 5.0), 0)
        assert caught.value.code == "R122"
        assert "encoder_enable_set_tick_count" in caught.value.hint


class TestBetweenCountsThatAreSet:
    def test_the_first_count_only_says_where_the_counter_stands(self):
        encoder = prepared(2, 30000.0)
        assert encoder.line(0) == CountLine(0, 0.0, 0.0)
        assert encoder.count(0) == 30000.0

    def test_an_even_stream_is_a_straight_line(self):
        encoder = prepared(2, 65530.0)
        for k in range(1, 100):
            encoder.set_count(SetEncoderCount(0, (65530.0 + 4 * k) % 65536), 5 * k)
            for tick in range(5 * k, 5 * k + 5):
                assert encoder.line(tick).at(tick) == pytest.approx(0.8 * tick, abs=1e-9)

    def test_whole_counts_of_a_slow_belt_do_not_make_its_speed_jump(self):
        encoder = prepared(0, 0.0)
        rates = []
        for k in range(1, 200):
            encoder.set_count(SetEncoderCount(0, float(int(0.37 * 5 * k))), 5 * k)
            rates.append(encoder.line(5 * k).rate)
        assert max(abs(rate - 92.5) for rate in rates[20:]) < 8.0

    def test_without_another_count_it_stands_where_it_was_seen_last(self):
        encoder = prepared(0, 0.0)
        encoder.set_count(SetEncoderCount(0, 10.0), 5)
        assert encoder.line(14).rate == 500.0
        assert encoder.line(15) == CountLine(5, 10.0, 0.0)

    def test_counts_long_apart_say_nothing_about_a_speed(self):
        encoder = prepared(0, 0.0)
        encoder.set_count(SetEncoderCount(0, 10.0), GAP_TICKS + 1)
        assert encoder.line(GAP_TICKS + 1).rate == 0.0

    def test_the_last_count_of_a_tick_counts(self):
        encoder = prepared(0, 0.0)
        for count in (1.0, 2.0, 3.0):
            encoder.set_count(SetEncoderCount(0, count), 5)
        assert encoder.line(5) == CountLine(5, 3.0, 150.0)


def test_both_encoders_are_apart():
    controller = Controller(load_model("CS66"), epoch_s=0.0, on_event=lambda event: None)
    controller.request(PrepareEncoder(1, 1))
    controller.request(SetEncoderCount(1, 7.0))
    controller.request(WriteSignal("encoder_speed", 0, 250.0))
    controller.leap(3)
    assert (controller.encoder_count(0), controller.encoder_count(1)) == (3.0, 7.0)
