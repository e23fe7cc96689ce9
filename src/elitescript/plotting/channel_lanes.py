"""Lanes of connections to the outside: what was opened, sent, received, closed, refused, or timed out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from elitescript.messages.events import ChannelActivity, Event
from elitescript.messages.timing import seconds
from elitescript.plotting.packing import milliseconds, shown_text

KINDS: Final = ("socket", "rpc", "modbus", "serial")
WHATS: Final = ("open", "sent", "received", "closed", "refused", "timeout")

CHANNELS_MAX: Final = 40
"""Channels with a lane of their own: those that were active first. The others share one."""

ENTRIES_MAX: Final = 300
"""Marks of one lane."""

ENTRIES_IN_ALL: Final = 1500
"""Marks of all lanes together."""

_Entry = tuple[int, ChannelActivity]
"""How many entries a mark stands for, and the first of them."""


def channel_lanes(events: Sequence[Event]) -> dict[str, Any]:
    """Return lanes of the channels.

    A lane with too many entries keeps, for each of many short stretches of time and for each kind of activity, the
    first entry and how many it stands for.

    Returns:
        `lanes`: for each channel `name`, `kind`, `total` (entries), times `t` (whole ms, each as the difference to the
        one before), `what` (indices into `WHATS`), `data` (indices into `texts`), `line` and `count` (entries that a
        mark stands for; absent if all are 1). `texts`: what was carried. `others`: how many channels share the last
        lane, whose `kind` is empty.
    """
    found: dict[tuple[str, str], list[ChannelActivity]] = {}
    for event in events:
        if isinstance(event, ChannelActivity):
            found.setdefault((event.kind, event.channel), []).append(event)
    named = list(found.items())
    texts: dict[str, int] = {}
    most = max(2 * len(WHATS), min(ENTRIES_MAX, ENTRIES_IN_ALL // max(1, min(len(named), CHANNELS_MAX + 1))))
    lanes = [_lane(kind, name, entries, most, texts) for (kind, name), entries in named[:CHANNELS_MAX]]
    others = named[CHANNELS_MAX:]
    if others:
        merged = sorted((event for _, entries in others for event in entries), key=lambda event: event.tick)
        lanes.append(_lane("", f"{len(others)} more channels", merged, most, texts))
    return {"lanes": lanes, "texts": list(texts), "whats": list(WHATS), "others": len(others)}


def _lane(kind: str, name: str, found: list[ChannelActivity], most: int, texts: dict[str, int]) -> dict[str, Any]:
    kept = _thinned(found, most)
    lane = {
        "name": shown_text(name),
        "kind": kind,
        "total": len(found),
        "t": milliseconds([seconds(event.tick) for _, event in kept]),
        "what": [WHATS.index(event.what) for _, event in kept],
        "data": [texts.setdefault(_text(event, is_shared=not kind), len(texts)) for _, event in kept],
        "line": [event.line for _, event in kept],
    }
    if len(kept) < len(found):
        lane["count"] = [count for count, _ in kept]
    return lane


def _text(event: ChannelActivity, *, is_shared: bool) -> str:
    return shown_text(f"{event.kind} {event.channel}: {event.data}" if is_shared else event.data)


def _thinned(found: list[ChannelActivity], most: int) -> list[_Entry]:
    """Return at most `most` marks, in the order of time, though at least one for each kind of activity."""
    if len(found) <= most:
        return [(1, event) for event in found]
    first, last = found[0].tick, found[-1].tick
    stretches = most
    while True:
        marks: dict[tuple[int, str], _Entry] = {}
        for event in found:
            key = ((event.tick - first) * stretches // (last - first + 1), event.what)
            count, kept = marks.get(key, (0, event))
            marks[key] = (count + 1, kept)
        # One stretch has a mark for each kind of activity, so the loop ends.
        if len(marks) <= most or stretches == 1:
            return sorted(marks.values(), key=lambda entry: entry[1].tick)
        stretches = max(1, stretches * 3 // 4)
