"""`make chaos`: plays random sessions for some time, and makes those that break something short.

    python -m tests.chaos --seconds 600 --seed 1        sessions of the seeds from 1 on
    python -m tests.chaos --session FILE                one again, as a file that was written or `seed:1234`

Each session is played twice, in leaps, and then in leaps that are cut at random ticks, tick by tick, or as before; both
must be the same to the last byte. Some are played in a process with another hash seed as well. A tick-interleaving is
a tick of a session that was run in the first of these plays, with whatever threads, clients, devices and people do in
it: ticks that were leapt over do not count, nor do the repetitions.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from elitescript.sweep.engines.executor import HUNG, Executor
from tests.chaos.sessions import Session, drawn
from tests.chaos.shorter import name_of, shortest

FOLDER = Path("build") / "chaos"
MAX_WALL_S = 120.0
"""Wall time of one session; it takes less than a second."""
ELSEWHERE = 40
"""Sessions that are played in a process with another hash seed."""
KINDS_MAX = 10
"""Kinds of failures that are made short."""


OTHER_HASH_SEED = "hash seed: a process with another one says something else"


def main() -> int:
    """Return 0 if everything held."""
    parser = argparse.ArgumentParser(prog="make chaos")
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--seed", type=int, default=int(time.time()) % 1_000_000 * 1000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--session", default="")
    options = parser.parse_args()
    with Executor("tests.chaos.job:job", options.seed, jobs=options.jobs, max_wall_s=MAX_WALL_S) as executor:
        if options.session:
            return again(executor, options.session)
        failures = play(executor, options)
    with Executor("tests.chaos.job:job", options.seed, jobs=1, max_wall_s=MAX_WALL_S) as executor:
        for name, (seed, _) in list(failures.items())[:KINDS_MAX]:
            if name != OTHER_HASH_SEED:
                shorten(executor, name, seed)
    return 1 if failures else 0


def play(executor: Executor, options: argparse.Namespace) -> dict[str, tuple[int, str]]:
    """Play sessions; return the seed and text of the first failure of each kind."""
    print(f"sessions from seed {options.seed} on, {options.seconds:g} s, {options.jobs} processes", flush=True)
    begun_s = time.monotonic()
    failures: dict[str, tuple[int, str]] = {}
    digests: dict[int, str] = {}
    sessions = failed = ticks = all_ticks = 0
    for results in executor.results([range(10**9)]):
        for number, value, lost in results:
            failure, first, every, digest = value or [f"{lost}: {lost}", 0, 0, ""]
            sessions, ticks, all_ticks = sessions + 1, ticks + first, all_ticks + every
            seed = options.seed + number
            if digest and len(digests) < ELSEWHERE:
                digests[seed] = digest
            if failure:
                failed += 1
                if name_of(failure) not in failures:
                    failures[name_of(failure)] = (seed, failure)
                    print(f"seed {seed}: {failure[:500]}", flush=True)
        if time.monotonic() - begun_s >= options.seconds:
            break
    wall_s = time.monotonic() - begun_s
    print(
        f"{sessions} sessions in {wall_s:.0f} s: {ticks:,} tick-interleavings ({all_ticks:,} ticks with the "
        f"repetitions), {60.0 * ticks / wall_s:,.0f} a minute; {failed} sessions broke something"
    )
    others = elsewhere(list(digests))
    for seed, digest in digests.items():
        if others[seed] != digest:
            print(f"seed {seed}: {OTHER_HASH_SEED}", flush=True)
            failures.setdefault(OTHER_HASH_SEED, (seed, OTHER_HASH_SEED))
    print(f"{len(digests)} sessions played in a process with another hash seed")
    return failures


def elsewhere(seeds: list[int]) -> dict[int, str]:
    """Return the digests of sessions that are played in a process whose strings have other hashes."""
    command = [sys.executable, "-m", "tests.chaos.job", *map(str, seeds)]
    done = subprocess.run(command, env={**os.environ, "PYTHONHASHSEED": "1"}, stdout=subprocess.PIPE, check=True)
    return dict(zip(seeds, json.loads(done.stdout), strict=True))


def shorten(executor: Executor, name: str, seed: int) -> None:
    """Make the session of a seed short, write it down and say where it is."""

    def breaks(session: Session) -> bool:
        _, value, lost = executor.result_of(session)
        return name_of(value[0] if value else f"{lost}: {lost}") == name

    # Each try of one that hangs would take its whole wall time.
    session = drawn(seed) if name.startswith(HUNG) else shortest(drawn(seed), breaks)
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{seed}.json"
    path.write_text(json.dumps(session, indent=2) + "\n", encoding="utf-8")
    print(f"{name}\n  python -m tests.chaos --session {path}", flush=True)
    show(session)


def show(session: Session) -> None:
    """Print a session."""
    print("  " + session["program"].replace("\n", "\n  "))
    for act in session["acts"]:
        print("  ", *act)


def again(executor: Executor, given: str) -> int:
    """Play one session again."""
    if given.startswith("seed:"):
        session: Any = drawn(int(given.removeprefix("seed:")))
    else:
        session = json.loads(Path(given).read_text(encoding="utf-8"))
    show(session)
    _, value, lost = executor.result_of(session)
    failure = value[0] if value else lost
    print(failure or "everything holds")
    return 1 if failure else 0


if __name__ == "__main__":
    sys.exit(main())
