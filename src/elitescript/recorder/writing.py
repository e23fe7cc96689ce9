"""Recordings as MCAP files, which other viewers open: one file, and a whole recording at once.

A chunk is closed at 1 MB and at every `flush`, so what was flushed can be read whatever happens to the process.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO, Final, cast

from elitescript import __version__
from elitescript.errors import UsageError
from elitescript.extras import require
from elitescript.outputs.writing import opened_new
from elitescript.paths import what_became_of
from elitescript.protocol.binary import Number
from elitescript.recorder.channels import LISTS, PACKAGE, ROW, ROWS, SCHEMAS, TALKING, columns_by_variable, encoded
from elitescript.recorder.protobuf import DOUBLE, RowField, RowLayout
from elitescript.recorder.recording import Recording
from elitescript.shown import encodable

FORMAT: Final = "1"
"""Of our channels and metadata."""
CHUNK_BYTES: Final = 1 << 20
ABOUT: Final = "elitescript"
"""Name of the metadata record with what holds for the whole file."""
FACTS: Final = "facts"
"""Name of the metadata record with facts as JSON."""

_MEDIA_TYPES: Final = {".toml": "application/toml", ".json": "application/json"}


def _encodable(texts: Mapping[str, str]) -> dict[str, str]:
    """Return metadata as a file holds them: names of files may have bytes that are no UTF-8."""
    return {name: encodable(text) for name, text in texts.items()}


class RecordingFile:
    """One MCAP file that is being written.

    Args:
        path: of a file that does not exist.
        about: what is known at the begin: `host`, `begin_ns` (UTC, ns since 1970) and others, as texts.

    Raises:
        UsageError: the extra is missing, the file exists already, or its folder does not.
    """

    def __init__(self, path: Path, about: Mapping[str, str]) -> None:
        require("mcap")
        from mcap.writer import CompressionType, Writer

        self.path = path
        self._file = _Output(_created(path))
        # In one write for each chunk: what the system has is there, even if this process is killed.
        self._writer: Any = Writer(
            cast("BinaryIO", self._file), chunk_size=CHUNK_BYTES, compression=CompressionType.ZSTD
        )
        self._channels: dict[str, int] = {}
        self._layout: RowLayout | None = None
        self._rows = 0
        self._writer.start(profile="", library=f"elitescript {__version__}")
        self._writer.add_metadata(ABOUT, _encodable({"format": FORMAT, "elitescript": __version__, **about}))

    @property
    def size(self) -> int:
        """Bytes written so far."""
        return self._file.tell()

    def fate(self) -> str:
        """Return what became of the file, as `what_became_of`; everything must have been flushed."""
        return what_became_of(self.path, self._file.descriptor, self._file.tell())

    def attach(self, name: str, data: bytes, time_ns: int) -> None:
        """Add a file of the user: a program, a world, an arm."""
        kind = _MEDIA_TYPES.get(Path(name).suffix, "text/plain")
        self._writer.add_attachment(create_time=0, log_time=time_ns, name=encodable(name), media_type=kind, data=data)

    def note(self, name: str, data: Mapping[str, str]) -> None:
        """Add a metadata record."""
        self._writer.add_metadata(name, _encodable(data))

    def begin_rows(self, layout: RowLayout) -> None:
        """Say of what the rows are that follow."""
        if self._layout is not None and self._layout.fields == layout.fields:
            return
        self._layout = layout
        schema = self._writer.register_schema(f"{PACKAGE}.{ROW}", "protobuf", layout.descriptor(PACKAGE, ROW))
        lists = {field.name: field.length for field in layout.fields if field.length > 1}
        self._rows = self._writer.register_channel(ROWS, "protobuf", schema, {LISTS: json.dumps(lists)})

    def row(self, numbers: tuple[Number, ...], arrived_ns: int, time_ns: int) -> None:
        """Add a row.

        Args:
            numbers: one for each column of the layout.
            arrived_ns: when it came, UTC.
            time_ns: of the controller.
        """
        assert self._layout is not None
        self._writer.add_message(self._rows, arrived_ns, self._layout.pack(numbers), max(time_ns, 0))

    def message(self, channel: str, data: Mapping[str, Any], arrived_ns: int, time_ns: int) -> None:
        """Add a record to a channel of `SCHEMAS`; times as of a row."""
        ident = self._channels.get(channel)
        if ident is None:
            name, schema = SCHEMAS[channel]
            kind = self._writer.register_schema(name, "jsonschema", encoded(schema))
            ident = self._channels[channel] = self._writer.register_channel(channel, "json", kind)
        self._writer.add_message(ident, arrived_ns, encoded(data), max(time_ns, 0))

    def flush(self) -> None:
        """Hand everything to the system, which keeps it when this process dies."""
        self._writer.flush()

    def close(self) -> None:
        """Write the index, and close the file."""
        try:
            self._writer.finish()
        finally:
            self._file.close()

    def abandon(self) -> None:
        """Close the file as it is, without an index: nothing more can be written. Readers take what is there."""
        # What is in its buffer may not fit either.
        with suppress(OSError):
            self._file.close()


class _Output:
    """Counts what is written to a file that only grows: with a size of its own, whatever others make of the file."""

    __slots__ = ("_file", "_size")

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._size = 0

    @property
    def descriptor(self) -> int:
        return self._file.fileno()

    def write(self, data: bytes) -> int:
        """Write all of it."""
        self._size += len(data)
        return self._file.write(data)

    def tell(self) -> int:
        """Return how much was written."""
        return self._size

    def flush(self) -> None:
        """Hand it to the system."""
        self._file.flush()

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def write_recording(path: Path, recording: Recording) -> None:
    """Write a recording to one MCAP file; `read_recording` makes an equal one of it.

    Raises:
        UsageError: the extra is missing, the file exists already, or its folder does not.
    """
    begin_ns = int(recording.facts.get("begin_ns", 0))
    about = {
        "begin_ns": str(begin_ns),
        "rate_hz": repr(recording.rate_hz),
        "host": str(recording.facts.get("host", "")),
    }
    file = RecordingFile(path, about)
    for name, data in recording.attachments.items():
        file.attach(name, data, begin_ns)
    file.note(FACTS, {name: json.dumps(value) for name, value in recording.facts.items()})
    columns = recording.columns
    fields = [RowField(name, DOUBLE, len(parts)) for name, parts in columns_by_variable(columns).items()]
    if "timestamp" not in columns:
        fields.insert(0, RowField("timestamp", DOUBLE))
    layout = RowLayout(fields)
    file.begin_rows(layout)
    series = [recording.t if name == "timestamp" else columns[name] for name in layout.columns]
    waiting = list(reversed(recording.messages))
    names = {short: channel for channel, short in TALKING.items()}
    for arrived_s, t, numbers in zip(recording.arrived_s, recording.t, zip(*series, strict=True), strict=True):
        while waiting and waiting[-1].arrived_s < arrived_s:
            said = waiting.pop()
            at_ns = begin_ns + round(said.arrived_s * 1e9)
            file.message(names[said.channel], said.data, at_ns, round(said.t * 1e9))
        file.row(numbers, begin_ns + round(arrived_s * 1e9), round(t * 1e9))
    for said in reversed(waiting):
        file.message(names[said.channel], said.data, begin_ns + round(said.arrived_s * 1e9), round(said.t * 1e9))
    file.close()


def _created(path: Path) -> BinaryIO:
    try:
        return os.fdopen(opened_new(path), "wb")
    except FileExistsError:
        raise UsageError(f"{path} exists already; a recording is never written over") from None
    except FileNotFoundError:
        raise UsageError(f"{path}: there is no folder {path.parent}") from None
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror or error}") from None
