"""What the lines of a journal may hold: a file that was damaged or edited is refused where it is wrong."""

from __future__ import annotations

from base64 import b64decode
from collections.abc import Callable
from typing import Any, Final

from elitescript.codec.messages import shape_of
from elitescript.codec.values import CodecError, check_list, shown
from elitescript.messages.cut import LOOKS_MAX, WHOLE, Cut
from elitescript.messages.events import Event
from elitescript.messages.inputs import Input
from elitescript.messages.snapshot import Snapshot
from elitescript.services.journal.format2 import Format2
from elitescript.untrusted.json_text import JsonError, json_value

DIGEST_TICKS: Final = 250
"""Ticks between two digests, one second."""

FIELDS: Final[dict[str, dict[str, type]]] = {
    "tick": {"tick": int, "in": list},
    "digest": {"digest": int, "hash": str, "ticks": str},
    "told": {"told": int, "events": list},
    "restart": {"restart": int, "reason": str, "state": list, "lost": list},
    "end": {"end": int},
}
"""Every kind of line by its first key, with the type of each value; a `tick` may have `asked` and `cut` besides, and
`told` may have `said`."""

_WORDS: Final = {int: "a whole number", str: "a text", list: "a list"}
_CHECK_SUM_DIGITS: Final = 8
_ANSWERS: Final[dict[str, type]] = {
    "open": int,
    "read": str,
    "write": list,
    "truncate": int,
    "end": int,
    "kind": str,
    "size": int,
    "names": list,
}
"""What is answered to a question about files, by its verb; see `remote_files`."""


class RecordError(Exception):
    """A line makes no sense.

    Args:
        text: why.
        at: byte of the line where it shows, from 0.
    """

    def __init__(self, text: str, at: int = 0) -> None:
        super().__init__(text)
        self.at = at


class RecordReader:
    """Reads the lines behind the first one, in their order.

    Args:
        first_tick: of the session.
        old: decodes inputs of a journal of format 2.
    """

    __slots__ = ("_event", "_input", "_next_tick", "_snapshot", "_unmarked_tick")

    def __init__(self, first_tick: int, old: Format2 | None = None) -> None:
        self._event: Callable[[Any], Event] = shape_of(Event).decode if old is None else old.event
        self._input: Callable[[Any], Input] = shape_of(Input).decode if old is None else old.input
        self._snapshot = shape_of(Snapshot)
        self._next_tick = first_tick
        self._unmarked_tick = first_tick
        """The first tick that no digest covers yet."""

    def read(self, line: bytes) -> dict[str, Any]:
        """Return one line, with inputs and snapshots decoded.

        Raises:
            RecordError: it makes no sense.
        """
        record = _json(line)
        kind = next((kind for kind in FIELDS if kind in record), "")
        if not kind:
            raise RecordError(f"a record of a journal has one of the keys {', '.join(FIELDS)}")
        for key, wanted in FIELDS[kind].items():
            if type(record.get(key)) is not wanted:
                raise RecordError(f"{key} must be {_WORDS[wanted]}, not {shown(record.get(key))}")
        self._check_tick(kind, record[kind])
        try:
            self._decode(record)
        except (CodecError, ValueError, TypeError, RecursionError) as error:
            raise RecordError(str(error)) from None
        return record

    def _decode(self, record: dict[str, Any]) -> None:
        for key in ("in", "lost"):
            if key in record:
                record[key] = [self._input(item) for item in record[key]]
        if "events" in record:
            record["events"] = [self._event(item) for item in record["events"]]
        if "said" in record:
            check_list(record["said"], -1)
            if (events := [self._event(item) for item in record["said"]]) != record["events"]:
                raise CodecError("said does not have the texts of the events")
            record["events"] = events
        if "state" in record:
            record["state"] = self._snapshot.decode(record["state"])
        if "cut" in record:
            record["cut"] = _cut(record["cut"])
        if type(record.get("asked", [])) is not list:
            raise CodecError(f"asked must be a list, not {shown(record['asked'])}")
        if len(record.get("ticks", "")) % _CHECK_SUM_DIGITS:
            raise CodecError(f"ticks must have {_CHECK_SUM_DIGITS} digits for each tick")

    def _check_tick(self, kind: str, tick: int) -> None:
        if kind == "told":
            # Clients' time goes on while there is no robot.
            return
        if tick < self._next_tick - (kind == "digest"):
            raise RecordError(f"{kind} {tick} comes too late: the lines before reach up to tick {self._next_tick - 1}")
        if kind != "restart" and tick > self._unmarked_tick + DIGEST_TICKS:
            raise RecordError(
                f"{kind} {tick} comes too early: there is a digest every {DIGEST_TICKS} ticks, "
                f"and that of tick {self._unmarked_tick} is missing"
            )
        self._next_tick = tick + (kind in ("tick", "digest"))
        if kind in ("digest", "restart"):
            self._unmarked_tick = self._next_tick


def _cut(value: Any) -> Cut:
    if type(value) is not list or len(value) != len(WHOLE) or any(type(item) is not int for item in value):
        raise CodecError(f"cut must be {len(WHOLE)} whole numbers, not {shown(value)}")
    if not all(0 <= item <= LOOKS_MAX for item in value):
        raise CodecError(f"cut must have numbers from 0 to {LOOKS_MAX}, not {shown(value)}")
    return Cut(*value)


def _json(line: bytes) -> dict[str, Any]:
    try:
        # Shapes bound the nesting of what they read.
        record = json_value(line, depth_max=None)
    except JsonError as error:
        raise RecordError(f"no JSON: {error}", error.at) from None
    if type(record) is not dict:
        raise RecordError("no record")
    return record


def check_answer(question: list[Any], answer: Any) -> None:
    """Let an answer about files pass that fits its question.

    Raises:
        RecordError: it does not.
    """
    if not _fits(question, answer):
        raise RecordError(f"{shown(answer)} is no answer to {question[0]!r} about files")


def _fits(question: list[Any], answer: Any) -> bool:
    if type(answer) is not list or not answer:
        return False
    if answer[0] != "ok":
        return bool(answer[0] == "error") and [type(item) for item in answer[1:]] == [str, int, str, str]
    verb = question[0]
    wanted = _ANSWERS.get(verb)
    if len(answer) != 2 or (wanted is not None and type(answer[1]) is not wanted):
        return False
    value = answer[1]
    if verb == "read":
        try:
            return bool(len(b64decode(value, validate=True)) <= question[3])
        except ValueError:
            return False
    if verb == "write":
        return [type(item) for item in value] == [int, int]
    return bool(verb != "names") or all(type(item) is str for item in value)
