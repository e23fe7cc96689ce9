"""Random programs that talk to devices on which anything goes wrong at any time.

Nothing takes longer than its time-out, nothing ends the program but what the program does, nothing stays open, and the
same seed gives the same record to the last event, in leaps or in steps.
A fifth of `ELITESCRIPT_INVARIANTS` says how many are tried, at least 20.
"""

from __future__ import annotations

import re
from random import Random

import pytest

from elitescript import VirtualRobot
from elitescript.messages.enums import TaskState
from elitescript.messages.events import Alarm, Event, TextMessage
from elitescript.messages.timing import TICKS_PER_S
from tests.findings import Finding
from tests.invariants.cases import CASES
from tests.invariants.random_devices import (
    CLEANUP,
    NEVER,
    RPC_S,
    random_fault,
    random_secondary,
    random_talk,
    random_world,
)

COUNT = max(20, CASES // 5)
FEW = 12

MARGIN_S = 0.1
RAISED = (
    "RpcError",
    "ScriptStateError",
    "InvalidValueError",
    "ArgumentRangeError",
)


class Session:
    """One run of one seed."""

    def __init__(self, seed: int, *, steps: bool) -> None:
        chance = Random(f"talk {seed}")
        self.world = random_world(chance, seed)
        self.program, self.limits = random_talk(chance)
        self.robot = VirtualRobot("CS66", firmware="2.14", seed=seed, world=self.world, rpc_timeout_s=RPC_S)
        self.paused_s = 0.0
        self.events: list[Event] = []
        pace = (lambda tick: None) if steps else None
        run = self.robot.start(self.program)
        is_paused = False
        for _ in range(chance.randrange(9)):
            duration_s = chance.uniform(0.0, 0.4)
            self.robot.advance(duration_s, pace=pace)
            self.paused_s += duration_s if is_paused else 0.0
            act = chance.choice(
                ("pause", "resume", "resume", "secondary", "secondary", "stop" if chance.random() < 0.3 else "")
            )
            is_running = self.robot.controller.task_state is TaskState.PLAYING
            if act == "pause" and is_running:
                self.robot.pause()
                is_paused = True
            elif act == "resume" and is_paused:
                self.robot.resume()
                is_paused = False
            elif act == "fault":
                self.world.add_fault(random_fault(chance, self.world.agenda.time_s))
            elif act == "stop or so" and is_running and chance.random() < 0.3:
                self.robot.stop()
            elif act == "secondary":
                self.robot.submit_secondary(random_secondary(chance))
        if is_paused:
            self.robot.resume()
        # Long enough for every call to take all of its time; then whatever still waits for ever is stopped.
        whole_s = 3.0 * sum(limit_s for limit_s in self.limits.values() if limit_s != NEVER) + len(self.limits)
        end_s = self.robot.time_s + whole_s
        while run.state == "" and self.robot.time_s < end_s:
            self.robot.advance(2.0, pace=pace)
        self.was_over = run.state != ""
        if not self.was_over:
            self.robot.stop()
        self.robot.advance(0.1, pace=pace)
        self.state = run.state
        self.events = list(run.events)
        self.run = run

    def clean_up(self) -> None:
        """End what outlives a program by design."""
        self.robot.run("def clean():\n  " + CLEANUP.replace("\n", "\n  ") + "\nend\n")
        self.robot.advance(60.0)  # what is late or trickles is closed behind it


def check(seed: int) -> Session:
    """A seed holds all that is promised."""
    session = Session(seed, steps=False)
    again, stepped = Session(seed, steps=False), Session(seed, steps=True)
    assert (session.state, session.events) == (again.state, again.events), f"seed {seed}: the rerun is another one"
    assert (session.state, session.events) == (stepped.state, stepped.events), f"seed {seed}: steps are not leaps"
    alarms = [event for event in session.events if isinstance(event, Alarm)]
    assert not alarms, (seed, alarms)
    assert session.state in ("finished", "stopped"), (seed, session.state)
    waits_for_ever = any(limit_s == NEVER for limit_s in session.limits.values())
    assert session.was_over or waits_for_ever, f"seed {seed}: it hangs: {session.robot.threads()}"
    _check_times(seed, session)
    session.clean_up()
    assert session.world.network.open_channels == 0, seed
    assert session.robot._host.connections == {}, seed
    assert (session.world._faulty._channels, session.world._faulty._by_inner) == ({}, {}), seed
    for device in session.world.devices:
        assert getattr(device, "connections", ()) == (), seed
    return session


def _check_times(seed: int, session: Session) -> None:
    begun: dict[str, int] = {}
    for event in session.events:
        if not isinstance(event, TextMessage):
            continue
        what, _, number = event.text.partition(" ")
        if what == "begin":
            begun[number] = event.tick
        elif what == "end":
            took_s = (event.tick - begun[number]) / TICKS_PER_S
            assert took_s <= session.limits[int(number)] + session.paused_s + MARGIN_S, (seed, number, took_s)
        elif what == "raised":
            kind = re.match(r"\w*", number)
            assert kind and kind.group() in RAISED, (seed, event.text)


@pytest.mark.parametrize("seed", range(FEW))
def test_whatever_goes_wrong_the_program_goes_on(seed: int) -> None:
    check(seed)


@pytest.mark.invariants
@pytest.mark.slow
@pytest.mark.timeout(600 + 5 * COUNT)
def test_whatever_goes_wrong_many_programs_go_on(finding: Finding) -> None:
    calls = stopped = raised = 0
    for seed in range(FEW, FEW + COUNT):
        session = check(seed)
        texts = [event.text for event in session.events if isinstance(event, TextMessage)]
        calls += sum(text.startswith("begin ") for text in texts)
        raised += sum(text.startswith("raised ") for text in texts)
        stopped += session.state == "stopped"
    assert calls > COUNT
    assert raised and stopped
    finding(
        "programs that talk to faulty devices",
        f"{COUNT} programs, {calls} calls, {raised} raised, {stopped} programs stopped; each twice and in steps",
        "no call beyond its time-out, nothing left open, the same record to the last event",
    )
