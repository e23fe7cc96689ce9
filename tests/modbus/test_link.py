"""One connection: what goes wrong, and how signals tell."""

from __future__ import annotations

import pytest

from elitescript.messages.enums import ChannelError
from elitescript.messages.inputs import ChannelClosed, ChannelData
from elitescript.messages.outputs import CHANNEL_WINDOW
from elitescript.modbus.frames import pdu
from elitescript.modbus.frames.tcp import TcpFrame, tcp_frame
from elitescript.modbus.master.signals import SignalKind
from tests.modbus.bench import HOST, Bench, Device

S = 250


def test_a_signal_connects_first() -> None:
    bench = Bench()
    bench.add("x")
    assert bench.master.codes("x") == (-2, 0)
    bench.run(1)
    assert bench.master.codes("x") == (-1, 0)
    bench.run(1)
    assert bench.master.codes("x") == (-1, 0)
    bench.run(1)
    assert bench.master.codes("x") == (0, 0)


@pytest.mark.parametrize(
    ("end", "code"),
    [
        (ChannelClosed(1), 104),
        (ChannelClosed(1, "connection reset by peer", ChannelError.RESET), 104),
        (ChannelClosed(1, "broken pipe", ChannelError.BROKEN_PIPE), 32),
        (ChannelClosed(1, "connection timed out", ChannelError.TIMED_OUT), 110),
        (ChannelClosed(1, "no route to host", ChannelError.HOST_UNREACHABLE), 113),
        (ChannelClosed(1, "network is unreachable", ChannelError.NETWORK_UNREACHABLE), 101),
        (ChannelClosed(1, "host is down", ChannelError.HOST_DOWN), 112),
        (ChannelClosed(1, "something new", ChannelError.OTHER), 5),
    ],
)
def test_a_broken_connection_has_the_number_of_its_error(end: ChannelClosed, code: int) -> None:
    bench = Bench()
    bench.add("x")
    bench.run(10)
    del bench.network.devices[502]
    bench.network.say(end)
    bench.run(1)
    assert bench.master.codes("x") == (-2, code)
    assert bench.master.find("x").fault_tick == 11
    assert bench.master.find("x").ok_tick == 3


def test_a_refused_connection_is_tried_again_after_pauses_that_grow() -> None:
    bench = Bench()
    bench.add("x", port=503)
    bench.run(15 * S)
    ticks = [tick for tick, _ in bench.network.opened]
    assert ticks == [1, 2 + 125, 128 + 250, 379 + 500, 880 + 1000, 1881 + 1000, 2882 + 1000 - 131][: len(ticks)]
    assert bench.master.codes("x") == (-2, 111)
    assert bench.warnings == ["MODBUS at 10.0.0.9:503: connection refused"]


def test_an_attempt_without_an_end_is_given_up_after_2_s() -> None:
    bench = Bench()
    bench.network.dead.add(503)
    bench.add("x", port=503)
    bench.run(500)
    assert bench.master.codes("x") == (-1, 0)
    bench.run(1)
    assert bench.master.codes("x") == (-2, 110)
    assert bench.network.closed == [1]


def test_a_good_connection_that_breaks_is_made_anew_at_once() -> None:
    bench = Bench()
    bench.add("x", hertz=250)
    bench.run(20)
    bench.network.say(ChannelClosed(1))
    bench.run(1)
    assert bench.master.codes("x") == (-2, 104)
    bench.run(4)
    assert bench.master.codes("x") == (0, 0)
    assert len(bench.network.opened) == 2
    assert bench.master.find("x").fault_tick is None


def test_a_connection_that_breaks_before_any_answer_is_not_made_anew_at_once() -> None:
    bench = Bench()
    bench.device.breaks_after = 0
    bench.add("x", hertz=250)
    bench.run(4 * S)
    assert len(bench.network.opened) == 4


def test_a_world_without_a_network_is_said_and_not_asked_again() -> None:
    bench = Bench()
    bench.network.is_there = False
    bench.add("x")
    bench.master.request(HOST, 502, 1, b"\x41", is_once=True)
    bench.run(10 * S)
    assert bench.master.codes("x") == (-2, 101)
    assert bench.warnings == [
        "MODBUS at 10.0.0.9:502: this run has no network",
        "a MODBUS request to 10.0.0.9:502, slave 1: not sent, this run has no network",
    ]
    assert bench.master.next_tick(bench.tick, is_running=True) is None


# ------------------------------------------------------------------------------------------------- the device's errors


@pytest.mark.parametrize(
    ("code", "device"), [(1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (6, 6), (7, 7), (8, 8), (10, 10), (11, 11), (77, 9)]
)
def test_an_exception_is_the_code_of_the_device(code: int, device: int) -> None:
    bench = Bench()
    bench.device.alter = lambda frame, answer: tcp_frame(frame.transaction, frame.unit, pdu.exception(3, code))
    bench.add("x")
    bench.run(S)
    assert bench.master.codes("x") == (device, 0)
    assert bench.master.find("x").fault_tick == 0
    assert len(bench.warnings) == 1
    assert f"exception {code}" in bench.warnings[0]


@pytest.mark.parametrize(
    "wrong",
    [
        lambda frame, answer: tcp_frame(frame.transaction, frame.unit ^ 1, answer),
        lambda frame, answer: tcp_frame(frame.transaction, frame.unit, b"\4" + answer[1:]),
        lambda frame, answer: tcp_frame(frame.transaction, frame.unit, answer[:-1]),
        lambda frame, answer: tcp_frame(frame.transaction, frame.unit, answer + b"\0"),
    ],
)
def test_an_answer_of_the_wrong_slave_function_or_length_is_code_9(wrong) -> None:  # type: ignore[no-untyped-def]
    bench = Bench()
    bench.add("x", count=2)
    bench.run(10)
    bench.device.alter = wrong
    bench.run(30)
    assert bench.master.codes("x") == (9, 0)
    assert bench.value("x") == (100, 101)
    assert len(bench.network.opened) == 1


def test_a_signal_works_again_as_soon_as_its_device_does() -> None:
    bench = Bench()
    good = bench.device.alter
    bench.device.alter = lambda frame, answer: tcp_frame(frame.transaction, frame.unit, pdu.exception(3, 6))
    bench.add("x")
    bench.run(S)
    bench.device.alter = good
    bench.run(30)
    assert bench.master.codes("x") == (0, 0)
    assert bench.master.find("x").fault_tick is None


def test_no_answer_within_1_s_is_a_time_out_and_3_s_of_silence_a_new_connection() -> None:
    bench = Bench()
    bench.add("x")
    bench.add("y", first=1)
    bench.run(10)
    bench.device.is_silent = True
    bench.run(25 + S)
    assert bench.master.codes("x") == (0, 110)
    assert bench.warnings[0] == "MODBUS signal 'x' to 10.0.0.9:502, slave 255: no answer within 1 s"
    bench.run(3 * S)
    assert len(bench.network.opened) == 2
    assert bench.network.closed == [1]
    bench.device.is_silent = False
    bench.run(2 * S)
    assert bench.master.codes("x") == bench.master.codes("y") == (0, 0)


def test_late_and_repeated_answers_and_those_to_nothing_are_left_out() -> None:
    bench = Bench()
    bench.device.alter = lambda frame, answer: tcp_frame(frame.transaction, frame.unit, answer) * 2
    bench.add("x")
    bench.run(S - 5)
    assert bench.link().exchange.strays == len(bench.device.requests)
    bench.device.alter = lambda frame, answer: tcp_frame(frame.transaction + 1000, frame.unit, answer)
    bench.run(S + 30)
    assert bench.master.codes("x") == (0, 110)
    assert len(bench.network.opened) == 1


def test_a_slow_device_is_asked_at_its_own_speed() -> None:
    bench = Bench()
    bench.device.latency = 100
    bench.add("x", hertz=250)
    bench.run(10 * S)
    assert bench.master.codes("x") == (0, 0)
    assert bench.master.find("x").fault_tick is None


def test_an_answer_after_its_time_is_dropped() -> None:
    bench = Bench()
    bench.device.latency = S + 10
    bench.add("x", hertz=1)
    bench.run(6 * S)
    assert bench.master.codes("x") == (0, 110)
    assert bench.value("x") == (0,)
    assert bench.link().exchange.strays > 2


@pytest.mark.parametrize(
    "noise", [b"HTTP/1.1 200 OK\r\n\r\n", bytes.fromhex("0001000000010103"), bytes.fromhex("00010000ffff0103")]
)
def test_what_is_no_modbus_ends_the_connection(noise: bytes) -> None:
    bench = Bench()
    bench.add("x")
    bench.run(10)
    bench.network.say(ChannelData(1, noise))
    bench.run(1)
    assert bench.network.closed == [1]
    assert bench.master.codes("x") == (-2, 5)
    assert bench.warnings == ["MODBUS at 10.0.0.9:502: what the device sends is no MODBUS"]
    bench.run(10)
    assert bench.master.codes("x")[1] == 0


def test_frames_of_another_protocol_do_no_harm() -> None:
    bench = Bench()
    bench.add("x")
    bench.run(10)
    bench.network.say(ChannelData(1, bytes.fromhex("0001000700030101aa")))
    bench.run(S)
    assert bench.master.codes("x") == (0, 0)


def test_answers_in_single_bytes_are_put_together() -> None:
    bench = Bench()
    bench.device.is_silent = True
    bench.add("x", hertz=1)
    bench.run(5)
    for byte in tcp_frame(1, 255, pdu.registers_read(3, [7])):
        bench.network.say(ChannelData(1, bytes((byte,))))
        bench.run(1)
    assert bench.value("x") == (7,)


# ------------------------------------------------------------------------------------------------- reset


def test_a_reset_connects_anew() -> None:
    bench = Bench()
    bench.add("x")
    bench.run(10)
    bench.link().reset(bench.tick)
    assert not bench.link().is_settled
    assert bench.network.closed == [1]
    assert bench.master.codes("x") == (-2, 0)
    bench.run(2)
    assert bench.link().is_settled
    bench.run(30)
    assert bench.master.codes("x") == (0, 0)
    assert bench.warnings == []


def test_a_reset_that_fails_is_settled_too() -> None:
    bench = Bench()
    bench.add("x", port=503, hertz=0)
    bench.run(10)
    bench.link(503).reset(bench.tick)
    bench.run(2)
    assert bench.link(503).is_settled
    assert bench.master.codes("x") == (-2, 111)


# ------------------------------------------------------------------------------------------------- the window


def test_one_request_at_a_time_while_nobody_misses_a_turn() -> None:
    bench = Bench()
    for number in range(20):
        bench.add(str(number), first=number)
    bench.run(4 * S)
    assert set(bench.device.segments) == {1}
    assert bench.link().exchange.window == 1
    assert len(bench.device.requests) >= 20 * 39


def test_the_window_grows_while_signals_miss_turns_and_the_device_answers_all() -> None:
    bench = Bench()
    for number in range(200):
        bench.add(str(number), first=number, hertz=250)
    bench.run(60)
    assert bench.device.segments[:20].count(2) >= 1
    assert max(bench.device.segments) == 200
    assert bench.link().exchange.window == 256
    before = sum(signal.missed for signal in bench.master.signals.values())
    bench.run(S)
    assert sum(signal.missed for signal in bench.master.signals.values()) == before


@pytest.mark.parametrize("latency", [2, 3])
def test_more_signals_than_a_slow_device_can_serve_take_turns(latency: int) -> None:
    bench = Bench()
    bench.device.latency = latency
    for number in range(200):
        bench.add(str(number), first=number, hertz=250)
    bench.run(S)
    rate = len([tick for tick, _, _ in bench.device.requests if tick > S // 2]) / (S / 2)
    assert rate == pytest.approx(min(200, 256 / latency), rel=0.03)
    asked = {n: sum(request[2] == n for _, _, request in bench.device.requests) for n in range(200)}
    assert max(asked.values()) - min(asked.values()) <= 2


def test_a_device_that_works_off_one_request_after_the_other_is_not_asked_for_more_than_helps() -> None:
    bench = Bench()
    bench.device.ticks_each = 1.25
    for number in range(100):
        bench.add(str(number), first=number, hertz=250)
    bench.run(8 * S)
    assert bench.link().exchange.window == 8
    assert bench.warnings == []
    rate = len([tick for tick, _, _ in bench.device.requests if tick > 4 * S]) / (4 * S)
    assert rate == pytest.approx(1 / 1.25, rel=0.1)


def test_200_signals_at_250_hz_on_four_connections_miss_nothing() -> None:
    bench = Bench()
    for port in range(502, 506):
        bench.network.devices[port] = Device()
    for number in range(200):
        bench.add(str(number), first=number, hertz=250, port=502 + number % 4)
    bench.run(60)
    before = sum(signal.missed for signal in bench.master.signals.values())
    asked = sum(len(device.requests) for device in bench.network.devices.values())
    bench.run(S)
    assert sum(signal.missed for signal in bench.master.signals.values()) == before
    assert sum(len(device.requests) for device in bench.network.devices.values()) - asked == 200 * S


@pytest.mark.parametrize("per_segment", [1, 2, 3, 7])
def test_a_device_that_answers_part_of_a_segment_gets_one_at_a_time_for_good(per_segment: int) -> None:
    bench = Bench()
    bench.device.per_segment = per_segment
    for number in range(40):
        bench.add(str(number), first=number, hertz=250)
    bench.run(2 * S)
    exchange = bench.link().exchange
    assert (exchange.is_single, exchange.window) == (True, 1)
    assert bench.warnings == []
    assert all(signal.fault_tick is None for signal in bench.master.signals.values())
    bursts = len([size for size in bench.device.segments if size > per_segment])
    assert bursts == 1
    bench.run(4 * S)
    asked = {n: sum(request[2] == n for _, _, request in bench.device.requests) for n in range(40)}
    assert max(asked.values()) - min(asked.values()) <= 3
    # It is remembered when the connection is made anew, and when nobody has used it for a while.
    bench.link().reset(bench.tick)
    bench.run(S)
    assert exchange.window == 1
    for name in list(bench.master.signals):
        bench.master.delete(name)
    bench.run(2)
    assert bench.master.links == {}
    bench.add("x")
    assert bench.link().exchange.is_single


def test_a_device_that_breaks_off_at_a_burst_is_not_in_error_for_it() -> None:
    bench = Bench()
    bench.device.breaks_after = 1
    for number in range(10):
        bench.add(str(number), first=number, hertz=250)
    bench.run(2 * S)
    assert bench.link().exchange.is_single
    assert len(bench.network.opened) == 2
    assert bench.warnings == []
    assert all(signal.fault_tick is None for signal in bench.master.signals.values())


def test_a_device_that_answers_nothing_of_a_burst_gets_one_at_a_time() -> None:
    bench = Bench()
    bench.device.per_segment = 1
    bench.device.alter = lambda frame, answer: (
        b"" if bench.device.segments[-1] > 1 else tcp_frame(frame.transaction, frame.unit, answer)
    )
    for number in range(10):
        bench.add(str(number), first=number, hertz=250)
    bench.run(2 * S)
    assert bench.link().exchange.is_single
    assert bench.warnings == []
    assert sum(size > 1 for size in bench.device.segments) == 1


def test_a_device_that_is_silent_at_a_burst_and_afterwards_is_only_in_error() -> None:
    bench = Bench()
    for number in range(10):
        bench.add(str(number), first=number, hertz=250)

    def until_a_burst(frame: TcpFrame, answer: bytes) -> bytes:
        bench.device.is_silent |= bench.device.segments[-1] > 1
        return b"" if bench.device.is_silent else tcp_frame(frame.transaction, frame.unit, answer)

    good, bench.device.alter = bench.device.alter, until_a_burst
    bench.run(2 * S)
    assert bench.device.is_silent
    assert not bench.link().exchange.is_single
    bench.device.is_silent, bench.device.alter = False, good
    bench.run(4 * S)
    assert not bench.link().exchange.is_single
    assert bench.link().exchange.window > 1
    assert {bench.master.codes(name) for name in bench.master.signals} == {(0, 0)}


def test_what_is_sent_once_takes_no_part_in_a_burst() -> None:
    bench = Bench()
    bench.device.per_segment = 1
    for number in range(10):
        bench.add(str(number), first=number, hertz=250)
    for number in range(30):
        bench.master.request(HOST, 502, 1, b"\x06\0" + bytes((number, 0, 5)), is_once=True)
    bench.run(2 * S)
    assert [request[2] for request in bench.device.writes()] == list(range(30))


def test_a_device_that_falls_silent_in_a_large_window_is_in_error() -> None:
    bench = Bench()
    for number in range(100):
        bench.add(str(number), first=number, hertz=250)
    bench.run(S)
    bench.device.is_silent = True
    bench.run(S + 10)
    assert {bench.master.codes(name) for name in bench.master.signals} >= {(0, 110)}
    bench.run(3 * S)
    bench.device.is_silent = False
    bench.run(4 * S)
    assert {bench.master.codes(name) for name in bench.master.signals} == {(0, 0)}


def test_a_broadcast_and_other_requests_do_not_meet_in_one_segment_of_a_single_device() -> None:
    bench = Bench()
    bench.device.per_segment = 1
    for number in range(4):
        bench.add(str(number), first=number, unit=0 if number % 2 else 255, hertz=25)
        bench.master.set(str(number), [number])
    bench.run(S)
    assert set(bench.device.segments) == {1}
    assert bench.device.tables.holding_registers[:4] == [0, 1, 2, 3]


def test_no_more_is_sent_than_the_channel_takes_and_what_is_read_is_credited() -> None:
    bench = Bench()
    for number in range(60):
        bench.add(str(number), SignalKind.REGISTER_OUTPUT, 100, 123, hertz=250)
    bench.run(2 * S)
    answers = len(bench.device.requests) * (9 + 246)
    assert 0 <= answers - bench.network.credited < 2 * CHANNEL_WINDOW // 4
    bench.network.gives_credit = False
    sent = sum(bench.device.segments)
    bench.run(S // 2)
    assert (sum(bench.device.segments) - sent) * 12 in range(CHANNEL_WINDOW - 12 * 120, CHANNEL_WINDOW)
    assert {bench.master.codes(name) for name in bench.master.signals} == {(0, 0)}
