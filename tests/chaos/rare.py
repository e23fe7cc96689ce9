"""Sessions that are played in a way of their own: journals that are replayed, debuggers that go back and forth."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

from elitescript.environment.memory import MemoryFiles
from elitescript.messages.inputs import Input, RunUnit
from elitescript.services.journal.replay import RecordedRobot, Replay
from elitescript.services.journal.writer import Journal, JournalReader
from tests.chaos.programs import PROGRAMS
from tests.debugger.test_walks import walk
from tests.invariants.test_served_leaping import random_inputs, random_options

TICKS = 500


class Differs(Exception):
    """What is played again is not what was."""


def drawn(seed: int, kind: str) -> dict[str, Any]:
    """Return a session: the inputs of a journal are its acts."""
    acts = [[tick, "input", number] for number, (tick, _) in enumerate(_inputs(seed))] if kind == "journal" else []
    return {"seed": seed, "kind": kind, "program": "", "options": {}, "acts": acts}


def _inputs(seed: int) -> list[tuple[int, Input]]:
    chance = Random(f"journal {seed}")
    given = random_inputs(chance)
    if chance.random() < 0.7:
        program = PROGRAMS[chance.choice(("presses", "raises", "shifts", "interpreted", "belts"))](chance)
        given.setdefault(3, []).insert(0, RunUnit("primary#1", "program", program))
    return [(tick, item) for tick in sorted(given) for item in given[tick] if tick < TICKS]


def journal(session: dict[str, Any]) -> int:
    """Record a served robot and replay its journal; return the ticks."""
    inputs = _inputs(session["seed"])
    given: dict[int, list[Input]] = {}
    for tick, _, number in session["acts"]:
        given.setdefault(tick, []).append(inputs[number][1])
    options = random_options(Random(f"options {session['seed']}"))
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.journal"
        written = Journal(path, options)
        robot = RecordedRobot(options, MemoryFiles({}), written)
        outputs = [robot.tick(given.get(tick, ())).with_snapshot(robot.snapshot()) for tick in range(TICKS)]
        written.close()
        replay = Replay(JournalReader(path))
        played = list(replay.outputs())
    if replay.difference is not None or played != outputs:
        raise Differs(f"journal: {replay.difference}")
    return TICKS


def walked(session: dict[str, Any]) -> int:
    """Go back and forth in a program with the debugger; it counts no ticks."""
    walk(session["seed"])
    return 0


KINDS: dict[str, Callable[[dict[str, Any]], int]] = {"journal": journal, "walk": walked}
