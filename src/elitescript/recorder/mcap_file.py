"""Recordings from MCAP files: all files of one recording, however its end was.

The file is read record by record, and rows are unpacked by hundreds into arrays: an hour has 900,000. A file whose
recorder was killed ends within a record, or without its index; what is in front of that is read.
"""

from __future__ import annotations

import re
import struct
from array import array
from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from io import BytesIO
from itertools import chain
from math import nan
from pathlib import Path
from statistics import median
from typing import Any, BinaryIO, Final

from elitescript.errors import UsageError, did_you_mean
from elitescript.extras import require
from elitescript.protocol.rtsi.variables import OUTPUTS
from elitescript.recorder.channels import CHANGES, LISTS, PACKAGE, ROW, ROWS, SLOW, TALKING, TIME, columns_of
from elitescript.recorder.facts import facts_of
from elitescript.recorder.protobuf import RowLayout, layout_of
from elitescript.recorder.recording import Message, Recording
from elitescript.recorder.writing import ABOUT, FACTS, FORMAT
from elitescript.shown import shown_word
from elitescript.untrusted.files import opened
from elitescript.untrusted.json_text import JsonError, json_value

_MAGIC: Final = b"\x89MCAP0\r\n"
_RECORD: Final = struct.Struct("<BQ")
_MESSAGE: Final = struct.Struct("<HIQQ")
"""Channel, sequence, log time, publish time."""
_HEADER, _FOOTER, _SCHEMA, _CHANNEL, _MESSAGE_CODE, _CHUNK = 1, 2, 3, 4, 5, 6
_ATTACHMENT, _METADATA, _DATA_END = 9, 12, 15
_ROWS_AT_ONCE: Final = 500
_PERIODS: Final = 2000
"""Pairs of rows whose median distance is the period."""
_SLACK: Final = 1.5
"""Periods from which on the time between two rows is a gap."""
_NS: Final = 1e-9
GIVEN: Final = ("host", "program", "world", "robot")
"""Facts that the call of the recorder has given."""


def read_recording(path: str | Path, columns: Collection[str] | None = None) -> Recording:
    """Return a recording with all of its files: `RUN.mcap`, `RUN.0001.mcap` and so on.

    Args:
        path: of the first file; of a later one for that one alone.
        columns: variables, or single columns such as `actual_joint_positions.0`, to keep; None for all but the
            registers and settings that were 0 all the time. Variables that the recording does not have are left out.

    Raises:
        UsageError: the extra is missing; no such file; no MCAP file, or one without rows of a controller; a file that
            is damaged before its end; an unknown column. Says which and where.
    """
    require("mcap")
    first = Path(path)
    if columns is not None:
        _check_columns(columns)
    reading = _Reading(columns)
    for file in files_of(first):
        # The recorder may have been ended as it began a further file.
        if file == first or file.stat().st_size:
            reading.take_file(file)
    return reading.recording()


def files_of(first: Path) -> list[Path]:
    """Return the files of a recording in their order, beginning with the given one; one in between may be missing."""
    name = re.compile(rf"{re.escape(first.stem)}\.(\d{{4,}}){re.escape(first.suffix)}", re.ASCII)
    further: list[tuple[int, Path]] = []
    # Without the folder there is no file either, which the reader says.
    with suppress(OSError):
        further = [(int(its[1]), path) for path in first.parent.iterdir() if (its := name.fullmatch(path.name))]
    return [first, *(path for _, path in sorted(further))]


def rotated(first: Path, number: int) -> Path:
    """Return the name of a further file of a recording."""
    return first.with_name(f"{first.stem}.{number:04}{first.suffix}")


def _check_columns(columns: Collection[str]) -> None:
    known = {column for name, row in OUTPUTS.items() for column in (name, *columns_of(name, row.type))}
    for name in columns:
        if name not in known:
            raise UsageError(f"there is no column {name!r}{did_you_mean(name, known)}")


class _Rows:
    """How the rows of one channel are read into columns."""

    __slots__ = ("layout", "names", "unpack", "wanted")

    def __init__(self, layout: RowLayout, wanted: Collection[str] | None) -> None:
        self.layout = layout
        self.names = [
            name
            for name in layout.columns
            if wanted is None or name == TIME or name in wanted or name.partition(".")[0] in wanted
        ]
        self.unpack = layout.reader(self.names).unpack


class _Reading:
    """What was read so far.

    Args:
        wanted: see `read_recording`.
    """

    def __init__(self, wanted: Collection[str] | None) -> None:
        self._wanted = None if wanted is None else frozenset(wanted)
        self._columns: dict[str, array[float]] = {}
        self._arrived = array("d")
        self._t = array("d")
        self._steps: dict[str, list[tuple[int, float, float]]] = {}
        """Of variables that are written down where they change: number of rows before, time, value from there on."""
        self._waiting: list[bytes] = []
        self._rows: _Rows | None = None
        """Of the rows that wait."""
        self._messages: list[tuple[int, Message]] = []
        """With the number of rows before each."""
        self._attachments: dict[str, bytes] = {}
        self._facts: dict[str, Any] = {}
        self._begin_ns: int | None = None
        self._rate_hz: float | None = None
        self._path = Path()
        self._is_first = True
        self._is_cut_off = False
        self._schemas: dict[int, Any] = {}
        self._channels: dict[int, Any] = {}
        self._kinds: dict[int, Any] = {}

    # ---------------------------------------------------------------- files

    def take_file(self, path: Path) -> None:
        """Read one file behind what was read before."""
        from mcap.data_stream import ReadDataStream
        from mcap.records import Attachment, Chunk, Metadata
        from mcap.stream_reader import get_chunk_data_stream

        self._path = path
        self._schemas, self._channels, self._kinds = {}, {}, {}
        self._is_cut_off = True
        with opened(path) as file:
            for at, code, body in _records(file, path):
                if code == _DATA_END:
                    self._is_cut_off = False
                    break
                try:
                    if code == _CHUNK:
                        stream, size = get_chunk_data_stream(Chunk.read(ReadDataStream(BytesIO(body))), True)
                        self._take_chunk(stream.read(size), at)
                    elif code in (_SCHEMA, _CHANNEL, _MESSAGE_CODE):
                        self._take(code, body, at)
                    elif code == _METADATA:
                        metadata = Metadata.read(ReadDataStream(BytesIO(body)))
                        self._take_metadata(metadata.name, metadata.metadata)
                    elif code == _ATTACHMENT:
                        attachment = Attachment.read(ReadDataStream(BytesIO(body)))
                        self._attachments[attachment.name] = attachment.data
                except UsageError:
                    raise
                except Exception as error:
                    what = "chunk" if code == _CHUNK else "record"
                    why = str(error) or error.__class__.__name__
                    raise UsageError(f"{path}: the {what} at byte {at:,} is damaged ({why})") from None
        self._store()
        has_rows = any(isinstance(kind, _Rows) for kind in self._kinds.values())
        if not has_rows and self._begin_ns is None:
            topics = shown_word(", ".join(sorted(channel.topic for channel in self._channels.values()))) or "none"
            raise UsageError(f"{path} is no recording of a controller: no channel {ROWS} (channels: {topics})")
        self._is_first = False

    def _take_metadata(self, name: str, data: Mapping[str, str]) -> None:
        if name == ABOUT:
            if data.get("format") != FORMAT:
                by = data.get("elitescript", "another version")
                raise UsageError(
                    f"{self._path} has the format {data.get('format')!r} of {by}; this version reads {FORMAT!r}"
                )
            if self._begin_ns is None:
                self._facts["begin_ns"] = self._begin_ns = int(data.get("begin_ns", "0"))
                self._rate_hz = float(data["rate_hz"]) if "rate_hz" in data else None
                self._facts.update({name: data[name] for name in GIVEN if data.get(name)})
            elif int(data.get("begin_ns", "0")) != self._begin_ns:
                raise UsageError(f"{self._path} is of another recording than the file before it; move one of them away")
        elif name == FACTS:
            self._facts.update({key: json_value(value) for key, value in data.items()})

    def _take_chunk(self, data: bytes, at: int) -> None:
        """Read the records of a chunk; rows without a call for each."""
        kinds = self._kinds
        place, end = 0, len(data)
        head, message = _RECORD.unpack_from, _MESSAGE.unpack_from
        while end - place >= _RECORD.size:
            code, size = head(data, place)
            begin = place + _RECORD.size
            place = begin + size
            if place > end:
                raise UsageError(f"{self._path}: a record of the chunk at byte {at:,} is longer than the chunk")
            if code == _MESSAGE_CODE:
                number, _, log_ns, _ = message(data, begin)
                kind = kinds.get(number)
                if kind is None:
                    self._take(code, data[begin:place], at)
                elif kind.__class__ is _Rows:
                    if kind is not self._rows:
                        self._store()
                        self._rows = kind
                    body = data[begin + _MESSAGE.size : place]
                    if len(body) != kind.layout.size:
                        raise self._no_row(at)
                    self._waiting.append(body)
                    self._arrived.append((log_ns - (self._begin_ns or 0)) * _NS)
                    if len(self._waiting) >= _ROWS_AT_ONCE:
                        self._store()
                elif kind:
                    self._take_message(kind, data[begin + _MESSAGE.size : place], log_ns, at)
            else:
                self._take(code, data[begin:place], at)

    def _take(self, code: int, body: bytes, at: int) -> None:
        """Read one record that is not in the fast path."""
        from mcap.data_stream import ReadDataStream
        from mcap.records import Channel, Schema

        if code == _SCHEMA:
            schema = Schema.read(ReadDataStream(BytesIO(body)))
            self._schemas[schema.id] = schema
        elif code == _CHANNEL:
            channel = Channel.read(ReadDataStream(BytesIO(body)))
            self._channels[channel.id] = channel
            self._kinds[channel.id] = self._kind_of(channel)
        elif code == _MESSAGE_CODE:
            number = _MESSAGE.unpack_from(body)[0]
            if number not in self._kinds:
                raise UsageError(f"{self._path}: a message at byte {at:,} is of channel {number}, which is not there")
            self._take_chunk(_RECORD.pack(code, len(body)) + body, at)

    def _kind_of(self, channel: Any) -> Any:
        """Return how messages of a channel are read: `_Rows`, the name of a JSON channel, or empty for none."""
        schema = self._schemas.get(channel.schema_id)
        if channel.topic == ROWS and schema is not None and schema.name == f"{PACKAGE}.{ROW}":
            try:
                layout = layout_of(schema.data, json_value(channel.metadata.get(LISTS, "{}")))
            except ValueError as error:
                raise UsageError(f"{self._path}: the rows of channel {channel.topic} cannot be read: {error}") from None
            if TIME not in layout.columns:
                raise UsageError(f"{self._path}: the rows of channel {channel.topic} have no {TIME}")
            return _Rows(layout, self._wanted)
        if channel.topic in (CHANGES, SLOW, *TALKING) and channel.message_encoding == "json":
            return channel.topic
        return ""

    def _no_row(self, at: int) -> UsageError:
        index = len(self._t) + len(self._waiting)
        return UsageError(f"{self._path}: row {index:,}, in the chunk at byte {at:,}, does not fit its schema")

    # ---------------------------------------------------------------- rows and messages

    def _store(self) -> None:
        """Put the rows that wait into the columns."""
        waiting, rows = self._waiting, self._rows
        if not waiting or rows is None:
            return
        if not rows.layout.fits(waiting[0]):
            raise self._no_row(0)
        names, unpack = rows.names, rows.unpack
        flat = array("d", chain.from_iterable(map(unpack, waiting)))
        count, width = len(self._t), len(names)
        for place, name in enumerate(names):
            column = self._columns.get(name)
            if column is None:
                column = self._columns[name] = array("d")
            if len(column) < count:
                column.extend(array("d", (nan,)) * (count - len(column)))
            column.extend(flat[place::width])
        self._t.extend(flat[names.index(TIME) :: width])
        waiting.clear()

    def _take_message(self, channel: str, body: bytes, log_ns: int, at: int) -> None:
        try:
            data = json_value(body)
        except JsonError as error:
            raise UsageError(f"{self._path}: a message of {channel} at byte {at:,} is no JSON ({error})") from None
        if not isinstance(data, dict):
            raise UsageError(f"{self._path}: a message of {channel} at byte {at:,} is no record")
        if channel in (CHANGES, SLOW):
            self._take_values(data)
            return
        if data.pop("repeated", False) and not self._is_first:
            return
        arrived_s = (log_ns - (self._begin_ns or 0)) * _NS
        self._messages.append((len(self._t) + len(self._waiting), Message(0.0, arrived_s, TALKING[channel], data)))

    def _take_values(self, data: dict[str, Any]) -> None:
        """Note values that hold from now on."""
        t = data.pop(TIME, None)
        since_s = float(t) if isinstance(t, int | float) else nan
        count = len(self._t) + len(self._waiting)
        for name, value in data.items():
            parts = value if isinstance(value, list) else [value]
            for place, part in enumerate(parts):
                column = f"{name}.{place}" if isinstance(value, list) else name
                if self._wanted is None or column in self._wanted or name in self._wanted:
                    number = nan if part is None else float(part)
                    steps = self._steps.setdefault(column, [])
                    if not steps or steps[-1][2] != number:
                        steps.append((count, since_s, number))

    # ---------------------------------------------------------------- the whole

    def recording(self) -> Recording:
        """Return all that was read."""
        t = self._t
        count = len(t)
        columns = self._columns
        for column in columns.values():
            if len(column) < count:
                column.extend(array("d", (nan,)) * (count - len(column)))
        for name, steps in self._steps.items():
            if self._wanted is not None or any(value != 0.0 for _, _, value in steps):
                columns[name] = _expanded(steps, t)
        if self._wanted is not None and TIME not in self._wanted:
            columns.pop(TIME, None)
        period_s = _period_of(t) or (1.0 / self._rate_hz if self._rate_hz else 0.004)
        gaps, restarts = _interruptions(t, period_s)
        messages = tuple(
            Message(t[max(rows - 1, 0)] if count else 0.0, said.arrived_s, said.channel, said.data)
            for rows, said in self._messages
        )
        return Recording(
            t,
            self._arrived,
            columns,
            round(1.0 / period_s, 3),
            gaps,
            restarts,
            messages,
            {**facts_of(messages), **self._facts},
            self._attachments,
            self._is_cut_off,
        )


def _expanded(steps: list[tuple[int, float, float]], t: array[float]) -> array[float]:
    """Return a column from the changes of its value; each holds from the first row that is not older."""
    column = array("d")
    value = nan
    for index, since_s, following in steps:
        # Rows of the same and of later ticks may have come before; not more than those of a second.
        while index > 0 and 0.0 <= t[index - 1] - since_s < 1.0:
            index -= 1
        if index > len(column):
            column.extend(array("d", (value,)) * (index - len(column)))
        else:
            del column[index:]
        value = following
    column.extend(array("d", (value,)) * (len(t) - len(column)))
    return column


def _period_of(t: array[float]) -> float:
    """Return the time between two rows, s; 0 if it is not known."""
    step = max(1, len(t) // _PERIODS)
    found = [t[index + 1] - t[index] for index in range(0, len(t) - 1, step)]
    rising = [length for length in found if length > 0.0]
    # The controller counts in ticks; what is left of rounding goes.
    return round(median(rising), 6) if rising else 0.0


def _interruptions(t: array[float], period_s: float) -> tuple[tuple[tuple[float, float], ...], tuple[int, ...]]:
    """Return gaps, and indices at which the time begins anew."""
    longest_s = _SLACK * period_s
    gaps: list[tuple[float, float]] = []
    restarts: list[int] = []
    before = t[0] if t else 0.0
    for index, now in enumerate(t):
        if not 0.0 <= now - before <= longest_s:
            if now < before:
                restarts.append(index)
            else:
                gaps.append((before, now))
        before = now
    return tuple(gaps), tuple(restarts)


def _records(file: BinaryIO, path: Path) -> Iterator[tuple[int, int, bytes]]:
    """Yield offset, code and body of each whole record; one that ends behind the file is left out."""
    begin = file.read(len(_MAGIC))
    if not begin:
        raise UsageError(f"{path} is empty: its recorder was ended within its first second")
    if begin != _MAGIC:
        raise UsageError(f"{path} is no MCAP file")
    at = len(_MAGIC)
    size = path.stat().st_size
    while True:
        head = file.read(_RECORD.size)
        if len(head) < _RECORD.size:
            return
        code, length = _RECORD.unpack(head)
        if code == 0 or at + _RECORD.size + length > size:
            # A killed recorder, or a file whose end never reached the disk.
            return
        yield at, code, file.read(length)
        at += _RECORD.size + length
        if code == _FOOTER:
            return
