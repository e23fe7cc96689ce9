"""Random walks back and forth: the same position shows the same, and nothing ever hangs."""

from __future__ import annotations

import os
from random import Random

import pytest

from elitescript.debugger.api import AT_END, DataBreakpoint, FunctionBreakpoint, LineBreakpoint
from elitescript.errors import DebugError
from tests.debugger.random_programs import random_program
from tests.debugger.sessions import debugging, everything
from tests.invariants.cases import CASES

WALKS = max(CASES // 4, 10)
"""10 for `make test`; `ELITESCRIPT_INVARIANTS=8000` tries 2,000."""
STEPS = 14

CONDITIONS = ("", "", "shared > 3", "n == 1", "nothing_there")
HITS = ("", "", "2", ">= 2", "% 2")
DATA = ("shared", "standard_digital_out[1]", "tcp.z < 0.4", "robot mode", "shared > 5", "joints[0] > 0.1")


def walk(seed: int, *, forks: bool = False) -> int:
    rng = Random(seed)
    text = random_program(rng)
    rows = text.count("\n")
    seen: dict[object, object] = {}
    with debugging(text, seed=seed, work_per_tick=rng.choice([150, 10_000]), until_s=20, forks=forks) as session:
        stop = session.start(stop_on_entry=True)
        for _ in range(STEPS):
            shown = everything(session)
            assert seen.setdefault(stop.position, shown) == shown, stop
            stop = _move(session, rng, rows)
            assert stop == session.stop and not session.furthest.is_before(stop.position)
    return len(seen)


def _move(session, rng, rows):
    threads = [thread.id for thread in session.threads()] or [1]
    thread = rng.choice(threads)
    choice = rng.randrange(14)
    if choice == 0:
        requests = [
            LineBreakpoint(rng.randrange(1, rows + 1), 0, rng.choice(CONDITIONS), rng.choice(HITS)) for _ in range(3)
        ]
        session.set_breakpoints(requests)
    elif choice == 1:
        session.set_data_breakpoints([DataBreakpoint(rng.choice(DATA), "", rng.choice(HITS))])
    elif choice == 2:
        session.set_function_breakpoints([FunctionBreakpoint(rng.choice(["climb", "movej", "sync"]))])
        session.set_exception_filters(rng.choice([(), ("alarm",), ("alarm", "warning")]))
    moves = {
        3: session.resume,
        4: session.reverse,
        5: session.reverse,
        6: lambda: session.run_to_time(rng.uniform(0, 3)),
        7: lambda: session.last_pass(rng.randrange(1, rows)),
        8: lambda: session.step_in(thread),
        9: lambda: session.step_out(thread),
        10: lambda: session.step_back(thread),
        11: lambda: session.step_back(thread),
    }
    try:
        return moves.get(choice, lambda: session.next(thread))()
    except DebugError:
        return session.stop


@pytest.mark.parametrize("seed", range(WALKS))
def test_the_same_position_shows_the_same_whichever_way_it_is_reached(seed):
    walk(seed)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
@pytest.mark.parametrize("seed", range(max(2, WALKS // 6)))
def test_snapshots_show_the_same(seed, monkeypatch):
    monkeypatch.setattr("elitescript.debugger.snapshots.EACH_S", 0.03)
    walk(seed, forks=True)


@pytest.mark.parametrize("seed", range(max(2, WALKS // 6)))
def test_all_the_way_back_are_the_stops_of_the_way_there(seed):
    text = random_program(Random(seed))
    with debugging(text, seed=seed, until_s=20) as session:
        session.set_breakpoints([LineBreakpoint(line) for line in range(1, text.count("\n"), 9)])
        session.set_data_breakpoints([DataBreakpoint("shared"), DataBreakpoint("tcp.z < 0.4")])
        there = [session.start()]
        while there[-1].position.kind != AT_END and len(there) < 20:
            there.append(session.resume())
        back = [there[-1]]
        while back[-1].reason != "entry" and len(back) < 30:
            back.append(session.reverse())
        assert [stop.position for stop in reversed(back[:-1])] == [stop.position for stop in there]
        assert back[-1].position.statement == 1
