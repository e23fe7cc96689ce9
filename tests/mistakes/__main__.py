"""Plants mistakes into sound programs, sees which are told, and writes docs/explanation/mistakes.md.

`python -m tests.mistakes` does all of it (`make mistakes`); `--count` and `--seed` plant others, and then nothing is
written. `--list FILE` leaves what was planted and told, one JSON record a line.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path

from tests.mistakes.judging import Told, judge
from tests.mistakes.kinds import arguments, names, order, units, values  # noqa: F401  (registers the kinds)
from tests.mistakes.page import COUNT, PAGE, SEED, Result, page
from tests.mistakes.planting import Mistake, plant
from tests.mistakes.sources import Sound, everything, written_for_it


def main() -> None:
    """Plant, judge and report."""
    parser = argparse.ArgumentParser(prog="python -m tests.mistakes", description=__doc__)
    parser.add_argument("--count", type=int, default=COUNT, help="how many mistakes")
    parser.add_argument("--seed", type=int, default=SEED, help="which ones")
    parser.add_argument("--own", action="store_true", help="without the programs of the specification")
    parser.add_argument("--list", type=Path, help="file for what was planted and told")
    options = parser.parse_args()
    sounds = written_for_it() if options.own else everything()
    rows, same = judged(sounds, options.count, options.seed)
    result = Result.of(rows, len(sounds), same)
    if options.list is not None:
        with options.list.open("w", encoding="utf-8") as out:
            for mistake, told in rows:
                print(record(mistake, told), file=out)
    for mistake, told in rows:
        if not told.is_told:
            what = "another line is blamed" if told.is_wrong else "not told"
            print(f"{what}: {mistake.kind}: {mistake.program}:{min(mistake.lines)}: {mistake.was} -> {mistake.now}")
            if told.finding:
                print(f"    {told.finding[:200]}")
    print(result.summary)
    if (options.count, options.seed, options.own) == (COUNT, SEED, False):
        PAGE.write_text(page(result), encoding="utf-8")
        print(f"written: {PAGE.name}")


def judged(sounds: tuple[Sound, ...], count: int, seed: int) -> tuple[list[tuple[Mistake, Told]], int]:
    """Plant mistakes and see what is told of them; return also how many changes make no difference."""
    by_name = {sound.program.name: sound for sound in sounds}
    mistakes, same = plant([sound.program for sound in sounds], count, seed)
    rows = []
    for mistake in mistakes:
        sound = by_name[mistake.program]
        rows.append((mistake, judge(mistake, sound.setting, sound.run)))
    return rows, same


def record(mistake: Mistake, told: Told) -> str:
    """Return a row of the list."""
    row = asdict(mistake) | asdict(told) | {"is_told": told.is_told, "is_wrong": told.is_wrong}
    return json.dumps(row, default=sorted)


if __name__ == "__main__":
    main()
