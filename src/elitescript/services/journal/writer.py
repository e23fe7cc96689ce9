"""Journals: a session as a file, with everything that came in from outside, tick by tick, so that it can be replayed.

One JSON text a line:

    {"journal": 4, "version": ..., "python": ..., "hash_seed": ..., "metered": true, "options": {...}}
    {"tick": 812, "in": [...], "asked": [...], "cut": [29, 0, 0, 0]}  inputs, answers about files, how far programs came
                                                   before the share of the tick was used up (`messages.cut`); ticks
                                                   without any have no line
    {"digest": 999, "hash": "...", "ticks": "..."} digest of the outputs up to tick 999; a check sum for each tick since
                                                   the last such line, 8 digits each
    {"told": 1190, "events": [...], "said": [...]} what clients got at that tick while there was no robot; `said` has it
                                                   again, if there are texts with template and values, with these
    {"restart": 1200, "reason": ..., "state": [...], "lost": [...]}   a new robot goes on at that tick from there
    {"end": 2000}                                  the session ended before that tick

Lines are written by a thread (`file`), so what a killed process leaves behind lacks at most what happened
in the last moment before, and a full or slow disk ends the journal, not the session.
"""

from __future__ import annotations

import os
import platform
from collections.abc import Iterator, Sequence
from hashlib import blake2b
from pathlib import Path
from typing import Any, Final
from zlib import crc32

from elitescript import __version__
from elitescript.codec.json_text import to_text
from elitescript.codec.messages import shape_of
from elitescript.codec.values import CodecError, with_parts
from elitescript.errors import UsageError
from elitescript.kernel import RobotOptions
from elitescript.messages.cut import WHOLE, Cut
from elitescript.messages.events import Event, Warned
from elitescript.messages.inputs import Input
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import Snapshot
from elitescript.records import replace
from elitescript.said import said
from elitescript.services.journal import format2
from elitescript.services.journal.file import JournalFile
from elitescript.services.journal.format2 import Format2
from elitescript.services.journal.records import DIGEST_TICKS, RecordError, RecordReader
from elitescript.services.options_data import options_data, options_from_data
from elitescript.services.output_text import output_text
from elitescript.untrusted.files import lines_of, opened
from elitescript.untrusted.json_text import json_value

FORMAT: Final = 4
UNCUT_FORMAT: Final = 3
"""The format before: no tick was cut."""
FORMATS: Final = (format2.FORMAT, UNCUT_FORMAT, FORMAT)
"""Known ones. `FORMAT` is to be raised with every change of a record or of a message in one; options come and go."""
LINE_MAX: Final = 64 * 1024 * 1024
_NOTHING: Final = to_text([])


class Digest:
    """Keeps a running hash of outputs, and a check sum for each tick since the last mark."""

    __slots__ = ("_hash", "sums")

    def __init__(self) -> None:
        self._hash = blake2b(digest_size=16)
        self.sums: list[str] = []

    def add(self, text: bytes) -> None:
        """Count an output, as its JSON text."""
        self._hash.update(text)
        self.sums.append(f"{crc32(text):08x}")

    def mark(self) -> tuple[str, str]:
        """Return the hash of everything so far, and the check sums since the last mark."""
        sums, self.sums = "".join(self.sums), []
        return self._hash.hexdigest(), sums


class Journal:
    """Writes a session to a file.

    Args:
        path: the file; one that is there is replaced.
        options: of the robot.
        is_metered: whether the ticks of the robot may be cut.

    Raises:
        UsageError: the file exists, or cannot be written.
    """

    __slots__ = ("_digest", "_file", "_inputs", "_is_over", "_is_told", "_last_tick")

    def __init__(self, path: Path, options: RobotOptions, *, is_metered: bool = False) -> None:
        self._inputs = shape_of(Input)
        self._digest = Digest()
        self._last_tick = options.first_tick - 1
        self._is_told = False
        self._is_over = False
        self._file = JournalFile(path)
        self._write(
            {
                "journal": FORMAT,
                "version": __version__,
                "python": platform.python_version(),
                "hash_seed": os.environ.get("PYTHONHASHSEED", "random"),
                "metered": is_metered,
                "options": options_data(options),
            }
        )

    @property
    def failure(self) -> str:
        """Why nothing more is written; empty while all is well."""
        return self._file.failure

    def tick(
        self,
        tick: int,
        inputs: Sequence[Input] | str,
        answers: Sequence[Any],
        output: Output | bytes,
        cut: Cut = WHOLE,
    ) -> None:
        """Write what a tick was given, and count its output.

        Args:
            tick: its number.
            inputs: what it was given, or the JSON text of it.
            answers: to questions about files in it.
            output: its output, or the JSON text of it.
            cut: how far programs came in it.
        """
        if self.failure or self._is_over:
            return
        given = inputs if isinstance(inputs, str) else to_text([self._inputs.encode(item) for item in inputs])
        if given != _NOTHING or answers or cut != WHOLE:
            asked = f',"asked":{to_text(list(answers))}' if answers else ""
            ended = f',"cut":[{",".join(map(str, cut))}]' if cut != WHOLE else ""
            self._file.put(f'{{"tick":{tick},"in":{given}{asked}{ended}}}\n'.encode())
        text = output if isinstance(output, bytes) else output_text(output).encode()
        self._digest.add(text)
        self._last_tick = tick
        if len(self._digest.sums) >= DIGEST_TICKS:
            self._mark()

    def restart(self, tick: int, reason: str, last: Snapshot, lost: Sequence[Input] = ()) -> None:
        """Write that a new robot goes on at `tick` from the last snapshot of the old one.

        Args:
            tick: the first of the new robot.
            reason: why the old one was replaced.
            last: its last snapshot.
            lost: inputs of the tick that it has not answered.
        """
        self._mark()
        state = shape_of(Snapshot).encode(last)
        self._write(
            {
                "restart": tick,
                "reason": reason,
                "state": state,
                "lost": [self._inputs.encode(item) for item in lost],
            }
        )

    def told(self, tick: int, events: Sequence[Event]) -> None:
        """Write the events that clients got at a tick, in the place of a robot that is gone."""
        self._mark()
        event = shape_of(Event)
        written = [event.encode(item) for item in events]
        parts = with_parts(written)
        self._write({"told": tick, "events": written} | ({"said": parts} if parts != written else {}))

    def take_warning(self, tick: int) -> tuple[Warned, ...]:
        """Return a warning that nothing more is written, once."""
        if not self.failure or self._is_told:
            return ()
        self._is_told = True
        return (Warned(tick, said("the journal ends here, it cannot be written: {reason}", reason=self.failure)),)

    def close(self) -> None:
        """Write the end of the session, and close the file."""
        if not self._is_over:
            self._is_over = True
            self._mark()
            self._write({"end": self._last_tick + 1})
            self._file.close()

    def _mark(self) -> None:
        if self._digest.sums:
            total, sums = self._digest.mark()
            self._write({"digest": self._last_tick, "hash": total, "ticks": sums})

    def _write(self, record: dict[str, Any]) -> None:
        self._file.put(to_text(record).encode() + b"\n")


class JournalReader:
    """Reads a journal, line by line.

    Args:
        path: the file.

    Attributes:
        options: of the robot at the start.
        header: the first line.
        is_metered: whether ticks of the robot may have been cut.
        old: translates what the journal has, if it is of format 2; None if it is of today's.
        note: what is wrong with the end of the file; empty if nothing is.
        place: file, line and byte of the record that was read last, for messages.

    Raises:
        UsageError: no journal, or one of another format.
    """

    __slots__ = ("_path", "header", "is_metered", "note", "old", "options", "place")

    def __init__(self, path: Path) -> None:
        self._path = path
        self.note = ""
        self.old: Format2 | None = None
        self.place = f"{path}: line 1"
        try:
            with opened(path) as file:
                first = next(lines_of(file, str(path), LINE_MAX), b"")
        except OSError as error:
            raise UsageError(f"cannot read {path}: {error.strerror or error}") from error
        try:
            # Shapes bound the nesting of what they read.
            self.header: dict[str, Any] = json_value(first, depth_max=None)
            found = self.header["journal"]
            if found == format2.FORMAT:
                self.old = Format2()
            elif found not in FORMATS:
                version = str(self.header.get("version", "unknown"))[:20]
                raise UsageError(
                    f"{path}: line 1: a journal of format {str(found)[:20]}, written by elitescript {version}; "
                    f"{format2.FORMAT} to {FORMAT} are known here: replay it with the version that wrote it"
                )
            self.is_metered = self.header.get("metered") is True
            if self.old is None:
                # Versions that did not write this option ran the script beside a tree.
                self.options = options_from_data({"reads_trees": False, **self.header["options"]})
            else:
                self.options = replace(self.old.options(self.header["config"]), reads_trees=False)
        except (ValueError, KeyError, TypeError, RecursionError) as error:
            at = getattr(error, "at", 0)
            raise UsageError(f"{path}: line 1, byte {at}: no journal of this program") from error
        except CodecError as error:
            raise UsageError(f"{path}: line 1: {error}") from error

    def records(self) -> Iterator[dict[str, Any]]:
        """Return every line but the first, with inputs and snapshots decoded.

        Raises:
            UsageError: a line that makes no sense; the text names file, line and byte.
        """
        reader = RecordReader(self.options.first_tick, self.old)
        last, has_end = self.options.first_tick - 1, False
        with opened(self._path) as file:
            lines = lines_of(file, str(self._path), LINE_MAX)
            start = len(next(lines, b""))
            for number, line in enumerate(lines, 2):
                if not line.endswith(b"\n"):
                    self.note = (
                        f"the journal was cut off behind tick {last}: line {number} is not complete and was left out"
                    )
                    return
                self.place = f"{self._path}: line {number}, byte {start}"
                try:
                    record = reader.read(line)
                except RecordError as error:
                    place = f"{self._path}: line {number}, byte {start + error.at}"
                    raise UsageError(f"{place}: {error}") from None
                last = max([last, *(record[key] for key in ("tick", "digest", "told") if key in record)])
                has_end = has_end or "end" in record
                yield record
                start += len(line)
        if not has_end:
            self.note = f"the journal was cut off behind tick {last}: it has no end mark"
