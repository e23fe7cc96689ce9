"""The master: what it asks, how often, and what becomes of it."""

from __future__ import annotations

import random
from itertools import pairwise

import pytest

from elitescript.errors import InvalidValueError, ScriptStateError
from elitescript.modbus.frames import pdu
from elitescript.modbus.master.master import SIGNALS_MAX
from elitescript.modbus.master.signals import SignalKind
from tests.modbus.bench import HOST, Bench, Device

S = 250


@pytest.mark.parametrize(
    ("kind", "count", "request_bytes", "values"),
    [
        (SignalKind.DIGITAL_INPUT, 1, pdu.read(2, 3, 1), (0,)),
        (SignalKind.DIGITAL_OUTPUT, 2, pdu.read(1, 3, 2), (0, 0)),
        (SignalKind.REGISTER_INPUT, 1, pdu.read(4, 3, 1), (3,)),
        (SignalKind.REGISTER_OUTPUT, 3, pdu.read(3, 3, 3), (103, 104, 105)),
    ],
)
def test_each_type_reads_with_its_function(
    kind: SignalKind, count: int, request_bytes: bytes, values: tuple[int, ...]
) -> None:
    bench = Bench()
    bench.add("x", kind, 3, count)
    assert bench.value("x") == (0,) * count
    bench.run(10)
    assert bench.device.requests == [(2, 255, request_bytes)]
    assert bench.value("x") == values
    assert bench.master.codes("x") == (0, 0)


@pytest.mark.parametrize(
    ("kind", "count", "values", "request_bytes"),
    [
        (SignalKind.DIGITAL_OUTPUT, 1, [1], pdu.write_coil(3, 1)),
        (SignalKind.DIGITAL_OUTPUT, 3, [1, 0, 1], pdu.write_coils(3, [1, 0, 1])),
        (SignalKind.REGISTER_OUTPUT, 1, [77], pdu.write_register(3, 77)),
        (SignalKind.REGISTER_OUTPUT, 2, [77, 78], pdu.write_registers(3, [77, 78])),
    ],
)
def test_an_output_is_read_until_it_is_set_and_written_from_then_on(
    kind: SignalKind, count: int, values: list[int], request_bytes: bytes
) -> None:
    bench = Bench()
    bench.add("x", kind, 3, count)
    bench.run(S)
    assert bench.device.writes() == []
    bench.master.set("x", values)
    bench.run(S)
    assert bench.device.writes() == [request_bytes] * 10
    assert bench.value("x") == tuple(values)


def test_what_a_short_list_leaves_out_keeps_what_was_read() -> None:
    bench = Bench()
    bench.add("x", SignalKind.REGISTER_OUTPUT, 3, 3)
    bench.run(10)
    bench.master.set("x", [7])
    bench.run(S // 10)
    assert bench.device.tables.holding_registers[3:6] == [7, 104, 105]
    bench.master.set("x", [8, 9])
    bench.run(S // 10)
    assert bench.device.tables.holding_registers[3:6] == [8, 9, 105]


def test_what_a_short_list_leaves_out_is_not_touched_before_it_was_ever_read() -> None:
    bench = Bench()
    bench.add("x", SignalKind.REGISTER_OUTPUT, 3, 3)
    bench.master.set("x", [7])
    bench.run(S)
    assert bench.device.tables.holding_registers[3:6] == [7, 104, 105]
    assert bench.value("x") == (7, 0, 0)


def test_what_a_short_list_leaves_out_may_change_in_the_device() -> None:
    bench = Bench()
    bench.add("x", SignalKind.DIGITAL_OUTPUT, 3, 3)
    bench.run(10)
    bench.master.set("x", [1])
    bench.device.tables.coils[4] = 1
    bench.run(S)
    assert bench.device.tables.coils[3:6] == [1, 1, 0]


def test_a_read_write_signal_reads_with_3_and_then_with_23() -> None:
    bench = Bench()
    bench.add("x", SignalKind.READ_WRITE, 0, 3, write_first=1, write_count=2)
    bench.run(10)
    assert bench.device.requests[-1][2] == pdu.read(3, 0, 3)
    bench.master.set("x", [9])
    bench.run(S // 10)
    assert bench.device.requests[-1][2] == pdu.read_write_registers(0, 3, 1, [9])
    assert bench.value("x") == (100, 9, 102)
    bench.master.set("x", [8, 7])
    bench.run(S // 10)
    assert bench.device.requests[-1][2] == pdu.read_write_registers(0, 3, 1, [8, 7])


@pytest.mark.parametrize("hertz", [1, 3, 7, 10, 60, 99, 125, 249, 250])
def test_a_signal_is_asked_for_as_often_as_its_frequency_says(hertz: int) -> None:
    bench = Bench()
    bench.device.latency = 0
    bench.add("x", hertz=hertz)
    bench.run(10)
    before = len(bench.device.requests)
    bench.run(4 * S)
    assert abs(len(bench.device.requests) - before - 4 * hertz) <= 1
    gaps = [b[0] - a[0] for a, b in zip(bench.device.requests[2:], bench.device.requests[3:], strict=False)]
    assert not gaps or max(gaps) - min(gaps) <= 1


def test_signals_have_frequencies_of_their_own() -> None:
    bench = Bench()
    bench.add("slow", first=1, hertz=2)
    bench.add("fast", first=2, hertz=50)
    bench.run(4 * S)
    asked = [request[2] for _, _, request in bench.device.requests]
    assert asked.count(1) in (8, 9)
    assert asked.count(2) in (200, 201)


def test_without_a_frequency_a_signal_is_asked_once_and_written_when_it_is_set() -> None:
    bench = Bench()
    bench.add("x", hertz=0)
    bench.run(S)
    assert len(bench.device.requests) == 1
    bench.master.set("x", [5])
    bench.master.set("x", [6])
    bench.run(S)
    assert bench.device.writes() == [pdu.write_register(0, 6)]
    bench.master.retime("x", 10)
    bench.run(S)
    assert len(bench.device.writes()) == 11


def test_sequential_signals_go_one_after_the_other_in_the_order_in_which_they_were_added() -> None:
    bench = Bench()
    bench.device.latency = 3
    for number in (5, 3, 9, 1):
        bench.add(str(number), first=number, is_sequential=True)
    bench.run(10 * S)
    asked = [request[2] for _, _, request in bench.device.requests]
    assert asked == ([5, 3, 9, 1] * 200)[: len(asked)]
    ticks = [tick for tick, _, _ in bench.device.requests]
    assert min(b - a for a, b in pairwise(ticks)) >= 3


def test_a_sequential_signal_waits_where_others_need_not() -> None:
    bench = Bench()
    bench.device.latency = 2
    for number in range(8):
        bench.add(f"c{number}", first=number, hertz=250, is_sequential=True)
        bench.add(f"f{number}", first=100 + number, hertz=250)
    bench.run(2 * S)
    chain = [tick for tick, _, request in bench.device.requests if request[2] < 100]
    free = [tick for tick, _, request in bench.device.requests if request[2] >= 100]
    assert min(b - a for a, b in pairwise(chain)) >= 2
    assert len(free) > 4 * len(chain)
    counts = {n: sum(r[2] == n for _, _, r in bench.device.requests) for n in range(8)}
    assert max(counts.values()) - min(counts.values()) <= 1


def test_signals_of_one_device_share_a_connection() -> None:
    bench = Bench()
    bench.network.devices[503] = Device()
    for number in range(5):
        bench.add(f"a{number}", first=number)
        bench.add(f"b{number}", first=number, port=503, unit=number + 1)
    bench.run(S)
    assert sorted(port for _, port in bench.network.opened) == [502, 503]
    assert {unit for _, unit, _ in bench.network.devices[503].requests} == {1, 2, 3, 4, 5}


def test_a_name_that_is_used_again_replaces_the_signal() -> None:
    bench = Bench()
    bench.add("x", first=1)
    bench.run(10)
    bench.add("x", first=2)
    bench.run(S)
    assert bench.value("x") == (102,)
    assert {request[2] for tick, _, request in bench.device.requests if tick > 10} == {2}
    assert len(bench.master.signals) == 1


def test_a_connection_without_signals_is_closed() -> None:
    bench = Bench()
    bench.add("x")
    bench.run(10)
    bench.master.delete("x")
    bench.run(2)
    assert bench.network.closed == [1]
    assert bench.listeners == bench.master.links == {}


def test_there_are_200_signals_and_no_more() -> None:
    bench = Bench()
    for number in range(SIGNALS_MAX):
        bench.add(str(number), first=number)
    bench.add("0", first=7)
    with pytest.raises(ScriptStateError, match="200 MODBUS signals already"):
        bench.add("one more")
    with pytest.raises(ScriptStateError, match="200 MODBUS signals already"):
        bench.master.request(HOST, 502, 1, b"\x08\0\0", is_once=False)
    bench.master.delete("5")
    bench.add("one more")


def test_an_unknown_name_is_refused_with_those_that_there_are() -> None:
    bench = Bench()
    bench.add("known")
    for call in (bench.master.find, bench.master.delete, bench.master.codes):
        with pytest.raises(InvalidValueError, match="no MODBUS signal 'x'") as caught:
            call("x")
        assert caught.value.hint == "there are 'known'"


# ------------------------------------------------------------------------------------------------- broadcast, custom


def test_a_broadcast_waits_for_no_answer() -> None:
    bench = Bench()
    bench.add("x", unit=0, hertz=50)
    bench.run(S)
    assert bench.device.requests == []
    bench.master.set("x", [5])
    bench.run(S)
    assert len(bench.device.writes()) == 50
    assert bench.master.codes("x") == (0, 0)
    assert bench.master.find("x").fault_tick is None
    assert bench.device.tables.holding_registers[0] == 5


def test_a_custom_request_is_sent_once_and_the_connection_ends_with_it() -> None:
    bench = Bench()
    bench.master.request(HOST, 502, 103, pdu.custom(6, bytes([0, 17, 2, 88])), is_once=True)
    bench.run(S)
    assert bench.device.requests == [(2, 103, pdu.write_register(17, 600))]
    assert bench.master.links == {}
    assert bench.warnings == []


def test_a_repeated_custom_request_goes_on_until_the_program_ends() -> None:
    bench = Bench()
    bench.master.request(HOST, 502, 1, b"\x41ab", is_once=False)
    bench.run(S)
    bench.master.request(HOST, 502, 1, b"\x41cd", is_once=False)
    bench.run(S)
    sent = [request for _, _, request in bench.device.requests]
    assert set(sent[:11]) == {b"\x41ab"}
    assert set(sent[11:]) == {b"\x41cd"}
    assert 20 <= len(sent) <= 22
    bench.is_running = False
    bench.run(S)
    assert [request for _, _, request in bench.device.requests] == sent
    assert bench.master.links == {}


def test_a_custom_request_that_fails_is_a_warning() -> None:
    bench = Bench()
    bench.master.request(HOST, 502, 1, b"\x41", is_once=True)
    bench.master.request(HOST, 503, 1, b"\x41", is_once=True)
    bench.run(S)
    assert bench.warnings == [
        "MODBUS at 10.0.0.9:503: connection refused",
        "a MODBUS request to 10.0.0.9:503, slave 1: not sent, connection refused",
        "a MODBUS request to 10.0.0.9:502, slave 1: exception 1: illegal function",
    ]
    assert bench.master.links == {}


def test_single_requests_do_not_pile_up() -> None:
    bench = Bench()
    for _ in range(64):
        bench.master.request(HOST, 502, 1, b"\x06\0\0\0\0", is_once=True)
    with pytest.raises(ScriptStateError, match=r"64 requests to 10\.0\.0\.9:502 wait already"):
        bench.master.request(HOST, 502, 1, b"\x06\0\0\0\0", is_once=True)


# ------------------------------------------------------------------------------------------------- programs


@pytest.mark.parametrize(
    ("choice", "running", "stopped"),
    [(0, 1, 1), (1, 1, 0), (2, 0, 1), (3, 1, 0)],
)
def test_a_choice_ties_an_output_to_the_program(choice: int, running: int, stopped: int) -> None:
    bench = Bench()
    bench.add("x", SignalKind.DIGITAL_OUTPUT, 4)
    bench.master.set("x", [running])
    bench.master.choose("x", choice)
    bench.run(S)
    assert bench.device.tables.coils[4] == running
    bench.is_running = False
    bench.run(S)
    assert bench.device.tables.coils[4] == stopped
    bench.is_running = True
    bench.run(S)
    assert bench.device.tables.coils[4] == running


def test_an_output_that_was_never_set_is_only_read_while_a_program_runs() -> None:
    bench = Bench()
    bench.add("x", SignalKind.DIGITAL_OUTPUT, 4, 2)
    bench.master.choose("x", 2)
    bench.run(S)
    assert bench.device.writes() == []
    bench.is_running = False
    bench.run(S)
    assert bench.device.tables.coils[4:6] == [1, 1]


def test_a_tied_output_without_a_frequency_is_written_when_the_program_ends() -> None:
    bench = Bench()
    bench.add("x", SignalKind.DIGITAL_OUTPUT, 4, hertz=0)
    bench.master.set("x", [1])
    bench.master.choose("x", 1)
    bench.run(S)
    bench.is_running = False
    bench.run(10)
    assert bench.device.writes() == [pdu.write_coil(4, 1), pdu.write_coil(4, 0)]


def test_closing_tells_tied_outputs_and_forgets_everything() -> None:
    bench = Bench()
    bench.add("x", SignalKind.DIGITAL_OUTPUT, 4)
    bench.add("y", SignalKind.DIGITAL_OUTPUT, 5)
    bench.master.set("x", [1])
    bench.master.set("y", [1])
    bench.master.choose("x", 1)
    bench.run(S)
    bench.master.close()
    assert bench.device.tables.coils[4:6] == [0, 1]
    assert bench.network.closed == [1]
    assert bench.master.links == bench.master.signals == bench.listeners == {}
    assert bench.master.next_tick(bench.tick, is_running=True) is None


# ------------------------------------------------------------------------------------------------- time


def test_nothing_is_due_without_signals() -> None:
    bench = Bench()
    assert bench.master.next_tick(5, is_running=True) is None
    assert bench.master.next_tick(5, is_running=False) == 6


def test_leaping_is_the_same_as_stepping() -> None:
    for seed in range(12):
        histories = []
        for leaps in (False, True):
            chance = random.Random(seed)
            bench = Bench(leaps=leaps)
            bench.device.latency = chance.randint(1, 40)
            bench.device.per_segment = chance.choice([None, None, 1, 3])
            bench.network.dead.add(504)
            for number in range(chance.randint(1, 30)):
                kind = SignalKind(chance.randint(0, 3))
                bench.add(
                    str(number),
                    kind,
                    chance.randint(0, 490),
                    chance.randint(1, 9),
                    hertz=chance.choice([0, 1, 9, 10, 60, 250]),
                    is_sequential=chance.random() < 0.3,
                    port=chance.choice([502, 502, 502, 503, 504]),
                    unit=chance.choice([0, 1, 255]),
                )
            for _ in range(12):
                bench.run(chance.randint(1, 300))
                name = str(chance.randint(0, 5))
                what = chance.randint(0, 6)
                if what == 0 and name in bench.master.signals:
                    bench.master.delete(name)
                elif what == 1 and name in bench.master.signals and bench.master.find(name).is_output:
                    bench.master.set(name, [1])
                elif what == 2:
                    bench.is_running = not bench.is_running
                elif what == 3:
                    bench.device.is_silent = chance.random() < 0.5
                elif what == 4 and (HOST, 502) in bench.master.links:
                    bench.link().reset(bench.tick)
                elif what == 5:
                    bench.master.request(HOST, 502, 1, b"\x06\0\1\0\2", is_once=True)
            histories.append(
                (
                    bench.device.requests,
                    bench.network.opened,
                    bench.warnings,
                    [(s.name, s.values, s.missed, s.fault_tick, s.ok_tick) for s in bench.master.signals.values()],
                )
            )
        assert histories[0] == histories[1], seed


def test_time_leaps_to_the_next_turn() -> None:
    bench = Bench(leaps=True)
    bench.add("x", hertz=1)
    bench.run(20 * S)
    assert len(bench.device.requests) == 21
    assert bench.visited < 100


@pytest.mark.parametrize("is_silent", [True, False])
def test_a_device_that_is_not_there_is_not_looked_for_once_its_last_signal_is_deleted(is_silent: bool) -> None:
    bench = Bench()
    del bench.network.devices[502]
    if is_silent:
        bench.network.dead.add(502)
    bench.add("x")
    bench.run(S)
    bench.master.delete("x")
    bench.run(2)
    assert bench.master.links == {}
    attempts = len(bench.network.opened)
    bench.run(60 * S)
    assert len(bench.network.opened) == attempts > 0
    assert bench.master.next_tick(bench.tick, is_running=True) is None


def test_a_repeated_request_to_a_device_that_is_not_there_ends_with_its_program() -> None:
    bench = Bench()
    del bench.network.devices[502]
    bench.master.request(HOST, 502, 255, pdu.write_register(0, 1), is_once=False)
    bench.run(S)
    bench.is_running = False
    bench.run(2)
    assert bench.master.links == {}
