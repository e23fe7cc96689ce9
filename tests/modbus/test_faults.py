"""Whatever a device does: nothing breaks, nothing piles up, and a device that is good again works again."""

from __future__ import annotations

import random
from typing import Any

import pytest

from elitescript.messages.inputs import ChannelClosed, ChannelData
from elitescript.modbus.frames import pdu
from elitescript.modbus.frames.tcp import TcpFrame, tcp_frame
from elitescript.modbus.master.exchange import WINDOW_MAX
from elitescript.modbus.master.signals import SignalKind
from tests.modbus.bench import HOST, Bench

S = 250


def _plausible(frame: TcpFrame, answer: bytes) -> bytes:
    return tcp_frame(frame.transaction, frame.unit, answer)


def _faults(chance: random.Random) -> list[Any]:
    """Ways to answer wrongly."""
    return [
        _plausible,
        lambda frame, answer: tcp_frame(frame.transaction, frame.unit, pdu.exception(answer[0] & 0x7F, 6)),
        lambda frame, answer: tcp_frame(chance.randrange(65536), frame.unit, answer),
        lambda frame, answer: tcp_frame(frame.transaction, chance.randrange(256), answer),
        lambda frame, answer: tcp_frame(frame.transaction, frame.unit, answer) * 2,
        lambda frame, answer: tcp_frame(frame.transaction, frame.unit, chance.randbytes(chance.randint(1, 253))),
        lambda frame, answer: tcp_frame(frame.transaction, frame.unit, answer)[: chance.randint(0, 9)],
        lambda frame, answer: chance.randbytes(chance.randint(0, 300)),
        lambda frame, answer: b"\0\0\0\7" + answer,
    ]


def history(seed: int, ticks: int) -> list[Any]:
    """What comes of a device and a program that do anything."""
    chance = random.Random(seed)
    bench = Bench()
    device = bench.device
    faults = _faults(chance)
    seen: list[Any] = []
    for number in range(chance.randint(1, 40)):
        kind = SignalKind(chance.randint(0, 4))
        bench.add(
            str(number),
            kind,
            chance.randrange(400),
            chance.randint(1, 20),
            unit=chance.choice([0, 1, 255, 255]),
            hertz=chance.choice([1, 10, 100, 250, 250]),
            is_sequential=chance.random() < 0.2,
            write_count=5,
        )
    for _ in range(ticks // 50):
        device.alter = chance.choice(faults) if chance.random() < 0.7 else _plausible
        device.latency = chance.choice([0, 1, 2, 30, 300])
        device.per_segment = chance.choice([None, None, 1, 5])
        device.is_silent = chance.random() < 0.1
        device.breaks_after = chance.choice([None, None, None, 0, 2])
        bench.network.is_there = True
        what = chance.randrange(6)
        if what == 0 and bench.network.opened:
            bench.network.say(ChannelClosed(len(bench.network.opened), chance.choice(["", "broken pipe", "what?"])))
        elif what == 1 and bench.network.opened:
            bench.network.say(ChannelData(len(bench.network.opened), chance.randbytes(chance.randint(1, 50))))
        elif what == 2:
            bench.link().reset(bench.tick)
        elif what == 3:
            bench.is_running = not bench.is_running
        elif what == 4:
            name = chance.choice(list(bench.master.signals))
            signal = bench.master.find(name)
            if signal.is_output:
                bench.master.set(name, [chance.randint(0, 1)] * chance.randint(1, signal.writable))
        else:
            bench.master.request(HOST, 502, 1, b"\x06\0\1\0\1", is_once=True)
        for _ in range(50):
            bench.run(1)
            exchange = bench.link().exchange
            assert exchange.window <= WINDOW_MAX
            assert len(exchange._flight) <= WINDOW_MAX
            assert len(exchange._queue) <= len(bench.master.signals) + 64
        seen.append((bench.tick, [(bench.master.codes(name), bench.value(name)) for name in bench.master.signals]))
    assert len(bench.warnings) <= 100 * (1 + ticks // 50)
    device.alter, device.latency, device.per_segment = _plausible, 1, None
    device.is_silent, device.breaks_after = False, None
    bench.network.say(ChannelClosed(len(bench.network.opened)))
    bench.run(12 * S)
    assert {bench.master.codes(name) for name in bench.master.signals} == {(0, 0)}
    assert all(signal.fault_tick is None for signal in bench.master.signals.values())
    bench.master.close()
    assert bench.listeners == {}
    return [seen, device.requests, bench.network.opened, bench.warnings]


@pytest.mark.parametrize("seed", range(12))
def test_a_device_may_do_anything(seed: int) -> None:
    history(seed, 2000)


def test_the_same_faults_have_the_same_history() -> None:
    assert history(99, 1500) == history(99, 1500)


@pytest.mark.invariants
@pytest.mark.slow
def test_many_devices_may_do_anything() -> None:
    for seed in range(1000, 1300):
        history(seed, 4000)
