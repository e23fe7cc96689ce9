"""`python -m tests.mistakes`: plants mistakes, sees which are told, and writes docs/explanation/mistakes.md."""

from __future__ import annotations

import argparse
import json
from collections import Counter
from pathlib import Path

from tests.mistakes.judging import Told, judge
from tests.mistakes.kinds import arguments, names, order, units, values  # noqa: F401  (registers the kinds)
from tests.mistakes.planting import Mistake, plant
from tests.mistakes.sources import everything, written_for_it


def main() -> None:
    """Plant, judge and report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--own", action="store_true", help="without the programs of the specification")
    parser.add_argument("--list", type=Path, help="file for what was planted and told, as JSON lines")
    options = parser.parse_args()
    sounds = {sound.program.name: sound for sound in (written_for_it() if options.own else everything())}
    print(len(sounds), "sound programs")
    mistakes, same = plant([sound.program for sound in sounds.values()], options.count, options.seed)
    rows: list[tuple[Mistake, Told]] = []
    for mistake in mistakes:
        sound = sounds[mistake.program]
        rows.append((mistake, judge(mistake, sound.setting, sound.run)))
    report(rows, same)
    if options.list is not None:
        with options.list.open("w", encoding="utf-8") as out:
            for mistake, told in rows:
                print(json.dumps(record(mistake, told)), file=out)


def record(mistake: Mistake, told: Told) -> dict[str, object]:
    """Return a row of the list."""
    return {
        "kind": mistake.kind,
        "program": mistake.program,
        "lines": sorted(mistake.lines),
        "names": sorted(mistake.names),
        "was": mistake.was,
        "now": mistake.now,
        "check": told.by_check,
        "run": told.by_run,
        "finding": told.finding,
        "others": told.others,
        "state": told.state,
        "same": told.is_same,
        "told": told.is_told,
        "wrong": told.is_wrong,
        "text": mistake.text,
    }


def report(rows: list[tuple[Mistake, Told]], same: int) -> None:
    by_kind: dict[str, Counter[str]] = {}
    for mistake, told in rows:
        count = by_kind.setdefault(mistake.kind, Counter())
        count["all"] += 1
        count["check"] += bool(told.by_check in ("at", "arrives"))
        count["told"] += told.is_told
        count["wrong"] += told.is_wrong
        count["same"] += told.is_same and not told.is_told
    for kind, count in by_kind.items():
        print(
            f"{kind:62} {count['all']:4} check {count['check']:4} told {count['told']:4} wrong {count['wrong']:3} silent&same {count['same']:3}"
        )
    total = sum((count for count in by_kind.values()), Counter())
    print(dict(total), "left out:", same)


if __name__ == "__main__":
    main()
