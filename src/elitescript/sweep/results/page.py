"""Writes the page of a sweep: one HTML file with its summary, a sample of its rows, and its failures.

The data is gzip of `u32` length of the head, the head (JSON), and the columns of the rows one after the other, little
endian. `web/src/sweep/data.ts` reads it. Texts go to the page as text, never as markup.
"""

from __future__ import annotations

import gzip
import html
import json
import math
import struct
import sys
from array import array
from base64 import b64encode
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

from elitescript import page as built
from elitescript.messages.signals import Value
from elitescript.plotting.packing import shown_text
from elitescript.records import field, record
from elitescript.shown import encodable_json
from elitescript.sweep.plans.plan import Plan, Row
from elitescript.sweep.results.summary import Kind, Summary
from elitescript.sweep.results.totals import KINDS_MAX, OTHERS, Kept, Totals, name_of

FORMAT: Final = 1

PAGE_SAMPLE: Final = 50_000
"""Rows that hold, and as many that fail, which a page shows at most: the `sample` of its `Totals`."""

LABELS_MAX: Final = 1000
"""Different texts in one column; the rest are shown as one."""

REPLAYS: Final = ".replays"
"""End of the name of the folder with the replays."""

KINDS_SHOWN: Final = 100
"""Kinds of failures in the table."""

_TITLE: Final = b"@@title@@"
_DATA: Final = b"@@recording@@"


@record
class Replay:
    """How one run can be looked at again.

    Attributes:
        page: address of its page beside that of the sweep; empty without one.
        command: line that plays it again; empty without one of its own.
    """

    page: str = ""
    command: str = ""


@record
class PageTexts:
    """What a page says beside the numbers.

    Attributes:
        title: of the page.
        command: line of the sweep.
        run_command: line that makes the replay of a run, with `{run}` for its number; empty if there is none.
        stories: words about the first failure of a kind, by the number of its run.
        replays: by number of run.
        smallest: of the smallest run of a kind, by the number of its first run.
    """

    title: str
    command: str = ""
    run_command: str = ""
    stories: Mapping[int, Sequence[str]] = field(default_factory=dict)
    replays: Mapping[int, Replay] = field(default_factory=dict)
    smallest: Mapping[int, Replay] = field(default_factory=dict)


def sweep_page(plan: Plan, totals: Totals, summary: Summary, texts: PageTexts) -> str:
    """Return the text of the HTML file.

    Raises:
        UsageError: the front end is not built.
    """
    begin, end = built.built(built.SWEEP).split(_DATA)
    title = html.escape(shown_text(texts.title))
    head = begin.decode().replace(_TITLE.decode(), title, 1)
    return head + b64encode(packed(plan, totals, summary, texts)).decode() + end.decode()


def packed(plan: Plan, totals: Totals, summary: Summary, texts: PageTexts) -> bytes:
    """Return the data of a page."""
    rows = sorted([*totals.holding_sample, *totals.failing_sample], key=lambda kept: kept.run)
    columns = list(_columns(totals, rows))
    head = {
        "format": FORMAT,
        "title": shown_text(texts.title),
        "command": shown_text(texts.command, 2000),
        "run_command": shown_text(texts.run_command, 2000),
        "version": plan.version,
        "seed": plan.seed,
        "runs": summary.runs,
        "failed": summary.failed,
        "interval": None if summary.interval is None else list(summary.interval),
        "cycle_s": _cycle_of(summary),
        "lines": [shown_text(line, 500) for line in summary.lines()],
        "rows": len(rows),
        "holding": [len(totals.holding_sample), totals.holding_sample.one_in],
        "failing": [len(totals.failing_sample), totals.failing_sample.one_in],
        "columns": [column for column, _ in columns],
        "kinds": [_kind(kind, place, texts) for place, kind in enumerate(summary.kinds[:KINDS_SHOWN])],
        "kinds_left_out": max(0, len(summary.kinds) - KINDS_SHOWN) + (summary.other_kinds > 0),
        "nearest": [
            {"property": shown_text(text), "margin": nearest.margin, **_run(row, texts)}
            for text, nearest, row in zip(totals.properties, totals.nearest, totals.nearest_rows, strict=True)
            if nearest is not None and row is not None
        ],
    }
    text = encodable_json(json.dumps(head, ensure_ascii=True, separators=(",", ":"), allow_nan=False)).encode()
    return gzip.compress(struct.pack("<I", len(text)) + text + b"".join(data for _, data in columns), 6, mtime=0)


def _cycle_of(summary: Summary) -> list[float] | None:
    finished = summary.times.get("finished")
    return None if finished is None else [finished.least, finished.median, finished.most]


def _kind(kind: Kind, number: int, texts: PageTexts) -> dict[str, Any]:
    first = kind.first
    runs = [row.choices.run for row in kind.rows]
    smallest = next((texts.smallest[run] for run in runs if run in texts.smallest), Replay())
    story = next((texts.stories[run] for run in runs if run in texts.stories), ())
    return {
        "number": number,
        "title": shown_text(kind.title(), 500),
        "property": shown_text(first.expression),
        "state": first.state,
        "code": first.code,
        "line": first.line,
        "text": shown_text(first.text, 1000),
        "story": [shown_text(line, 1000) for line in story],
        "smallest": {"page": smallest.page, "command": shown_text(smallest.command, 2000)},
        "region": "" if kind.region is None else shown_text(kind.region.words()),
        "count": kind.count,
        "runs": [_run(row, texts) for row in kind.rows],
    }


def _run(row: Row, texts: PageTexts) -> dict[str, Any]:
    replay = texts.replays.get(row.choices.run, Replay())
    return {
        "run": row.choices.run,
        "page": replay.page,
        "disturbances": [
            shown_text(f"{disturbance.at_s:.3f} s: {name_of(disturbance)}") for disturbance in row.choices.disturbances
        ],
    }


def _columns(totals: Totals, rows: Sequence[Kept]) -> Iterator[tuple[dict[str, Any], bytes]]:
    """Give what the head says of each column, and its bytes."""
    yield {"name": "run", "role": "run", "type": "i32"}, _bytes("i", [kept.run for kept in rows])
    yield {"name": "kind", "role": "kind", "type": "i16"}, _bytes("h", _places_of_kinds(totals, rows))
    for index, variation in enumerate(totals.variations):
        yield _column(variation.name, "varied", [kept.values[index] for kept in rows])
    yield _column("time_s", "time", [kept.time_s for kept in rows])
    for index, name in enumerate(totals.measures):
        yield _column(name, "measure", [kept.measures[index] for kept in rows])
    for index, text in enumerate(totals.properties):
        margins = [kept.margins[index] if index < len(kept.margins) else None for kept in rows]
        if any(margin is not None for margin in margins):
            yield _column(text, "margin", margins)
    yield _column("state", "state", [kept.state for kept in rows])
    if any(kept.disturbances for kept in rows):
        yield _column("disturbances", "disturbances", [", ".join(kept.disturbances) for kept in rows])


def _places_of_kinds(totals: Totals, rows: Sequence[Kept]) -> list[int]:
    """Return for each row the place of its kind in the summary; -1 if it holds."""
    places = {group.number: place for place, groups in enumerate(totals.alike()) for group in groups}
    return [-1 if kept.kind < 0 else places.get(kept.kind, KINDS_MAX) for kept in rows]


def _column(name: str, role: str, values: Sequence[Value | str | None]) -> tuple[dict[str, Any], bytes]:
    """Pack numbers as floats of 32 bits, NaN for what is missing; anything else as numbers of its labels."""
    head = {"name": shown_text(name), "role": role}
    known = [value for value in values if value is not None]
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in known):
        numbers = [math.nan if value is None else _single(float(value)) for value in values]
        return {**head, "type": "f32"}, _bytes("f", numbers)
    words = ["" if value is None else str(value).lower() if isinstance(value, bool) else str(value) for value in values]
    counts = Counter(words)
    labels = sorted(sorted(counts), key=lambda word: -counts[word])[:LABELS_MAX]
    numbered = {word: index for index, word in enumerate(labels)}
    places = [numbered.get(word, len(labels)) for word in words]
    if len(counts) > len(labels):
        labels.append(OTHERS)
    return {**head, "type": "i16", "labels": [shown_text(label) for label in labels]}, _bytes("h", places)


def _single(value: float) -> float:
    """Return a number that 32 bits can hold: what is too large becomes infinite."""
    return value if abs(value) <= 3.4028234663852886e38 or not math.isfinite(value) else math.copysign(math.inf, value)


def _bytes(code: str, values: Sequence[float]) -> bytes:
    packed = array(code, values)
    if sys.byteorder == "big":
        packed.byteswap()
    return packed.tobytes()
