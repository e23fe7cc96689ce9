"""The rows of a sweep while it goes on: a file that only grows, from which it is resumed after any end.

The first line says which plan it belongs to; each other one holds the rows of runs that follow each other. A line ends
with a checksum of what stands before it, so that one which was torn when the process or the computer died is found,
and dropped with all that follows it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import IO, Any, Final
from zlib import crc32

from elitescript.errors import InternalError, UsageError
from elitescript.kernel.options import OPTIONS
from elitescript.outputs.locking import locked
from elitescript.paths import why_no_file
from elitescript.sweep.plans.plan import Plan, Row
from elitescript.sweep.plans.plan_json import data_digest, plan_data, row_data, row_of
from elitescript.untrusted.json_text import json_value

LINE_MAX: Final = 1 << 28
"""Bytes of a line at most: those of 10,000 rows are some MB."""

JOURNAL_BEGIN: Final = b'{"journal":'
"""First bytes of every journal."""

_FORMAT: Final = 1


class Journal:
    """Keeps the rows of one sweep in a file.

    Args:
        path: of the file.
        plan: of the sweep.
        resumes: whether a file that is there is continued; if not, it is written anew.
        seed: writes the journal of a finished sweep into a file, where there is none to continue.

    Attributes:
        path: see above.

    Raises:
        UsageError: another sweep writes this file, or it belongs to another plan, or is no journal; the text names the
            first difference.
    """

    def __init__(
        self, path: Path, plan: Plan, *, resumes: bool, seed: Callable[[IO[bytes]], None] | None = None
    ) -> None:
        self.path = path
        self._places: dict[int, tuple[int, int]] = {}
        """Where the rows of a range begin, by its first number: offset in the file, and the number behind the last."""
        parts = plan_parts(plan)
        self._lock = _locked(path)
        try:
            end = self._read(parts) if resumes else 0
            if not end and seed is not None:
                with path.open("wb") as file:
                    seed(file)
                end = self._read(parts)
            self._file: IO[bytes] = path.open("r+b" if end else "w+b")
        except BaseException:
            self._lock.close()
            raise
        self._file.truncate(end)
        self._file.seek(end)
        if not end:
            self._write({"journal": _FORMAT, "digest": data_digest(parts), "plan": parts})

    def __enter__(self) -> Journal:
        return self

    def __exit__(self, *_: object) -> None:
        try:
            # What could not be written is no news.
            with suppress(OSError):
                self._file.close()
        finally:
            self._lock.close()

    def delete(self) -> None:
        """Close the file and delete it; it may be gone."""
        self.__exit__()
        self.path.unlink(missing_ok=True)

    @property
    def done(self) -> int:
        """Number of runs whose rows are here."""
        return sum(stop - first for first, (_, stop) in self._places.items())

    def missing(self, runs: int) -> list[range]:
        """Return the numbers below `runs` whose rows are not here, in their order."""
        found = []
        at = 0
        for first, (_, stop) in sorted(self._places.items()):
            if first > at:
                found.append(range(at, min(first, runs)))
            at = max(at, stop)
        if at < runs:
            found.append(range(at, runs))
        return [numbers for numbers in found if numbers]

    def add(self, rows: list[Row]) -> None:
        """Write down the rows of runs whose numbers follow each other.

        Raises:
            UsageError: they cannot be written; those before are kept.
            InternalError: the numbers do not follow each other.
        """
        first = rows[0].choices.run
        if [row.choices.run for row in rows] != list(range(first, first + len(rows))):
            raise InternalError(f"rows from {first} on are not those of runs that follow each other")
        offset = self._file.tell()
        self._write({"first": first, "rows": [row_data(row) for row in rows]})
        self._places[first] = (offset, first + len(rows))

    def rows(self, runs: int) -> Iterator[Row]:
        """Yield the rows of the runs below `runs` that are here, in the order of their numbers."""
        with self.path.open("rb") as file:
            for first, (offset, _) in sorted(self._places.items()):
                if first >= runs:
                    break
                file.seek(offset)
                for data in content_of(file.readline())["rows"]:
                    row = row_of(data)
                    if row.choices.run < runs:
                        yield row

    def rows_from(self, first: int, runs: int) -> Iterator[Row]:
        """Yield the rows from a number on, the first of a range that was added, up to the first that is missing.

        Args:
            first: the number.
            runs: no row of this number, or above, is yielded.
        """
        while first < runs and first in self._places:
            offset, stop = self._places[first]
            with self.path.open("rb") as file:
                file.seek(offset)
                rows = content_of(file.readline())["rows"]
            yield from map(row_of, rows[: runs - first])
            first = stop

    def _write(self, content: Any) -> None:
        try:
            self._file.write(line_of(content))
            self._file.flush()
        except OSError as error:
            raise UsageError(f"{self.path}: {error.strerror or error}; --resume goes on with what is there") from error

    def _read(self, parts: Mapping[str, Any]) -> int:
        """Take in what is in the file; return where its last complete line ends.

        Raises:
            UsageError: it is no journal, of another plan, or has a complete line that no sweep has written.
        """
        with self.path.open("rb") as file:
            line = file.readline(LINE_MAX)
            if not line.endswith(b"\n") and len(line) < LINE_MAX:
                # Torn before anything else was written.
                return 0
            known = parts_of_head(line)
            if known is None:
                raise UsageError(f"--resume: {self.path} is no journal of a sweep of this version; delete it")
            if why := difference(known, parts):
                raise UsageError(f"--resume: {self.path} was begun with other settings: {why}")
            head = line
            end = file.tell()
            number = 1
            while (content := content_of(line := file.readline(LINE_MAX))) is not None:
                number += 1
                # The same first line again changes nothing.
                if line != head:
                    self._take(content, end, number)
                end = file.tell()
        last = 0
        for first, (_, stop) in sorted(self._places.items()):
            if first < last:
                raise UsageError(f"{self.path}: run {first} is in it twice; delete the file")
            last = stop
        return end

    def _take(self, content: Any, offset: int, number: int) -> None:
        """Note where rows are, after a look at them.

        Raises:
            UsageError: they are no rows, or are there already.
        """
        try:
            rows = [row_of(data) for data in content["rows"]]
            runs = [row.choices.run for row in rows]
            first = content["first"]
            is_range = type(first) is int and first >= 0 and runs == list(range(first, first + len(rows)))
            if not rows or not is_range or first in self._places:
                raise ValueError
        except (UsageError, KeyError, TypeError, ValueError):
            raise UsageError(f"{self.path}: line {number} holds no rows that are new; delete the file") from None
        self._places[first] = (offset, first + len(rows))


def line_of(content: Any) -> bytes:
    """Return the line of what JSON can hold, with its checksum."""
    text = json.dumps(content, separators=(",", ":"), check_circular=False).encode("ascii")
    return b"%b %08x\n" % (text, crc32(text))


def content_of(line: bytes) -> Any:
    """Return what a line holds; None if it is torn, or there is none."""
    text, _, checksum = line.rpartition(b" ")
    if not line.endswith(b"\n") or checksum != b"%08x\n" % crc32(text):
        return None
    try:
        return json_value(text, depth_max=None)
    except (ValueError, RecursionError):
        return None


def parts_of_head(line: bytes) -> Mapping[str, Any] | None:
    """Return the parts of the plan in the first line of a journal; None if it is none."""
    head = content_of(line)
    if not isinstance(head, dict) or head.get("journal") != _FORMAT:
        return None
    plan = head.get("plan")
    return plan if isinstance(plan, dict) else None


def _locked(path: Path) -> IO[bytes]:
    """Return what keeps a file for this process until it is closed; it is made if there is none.

    Raises:
        UsageError: another process has it, or it cannot be opened.
    """
    if why := why_no_file(path):
        raise UsageError(f"{path} {why}")
    try:
        return locked(path)
    except BlockingIOError:
        raise UsageError(f"{path}: another sweep writes it; wait for it, or give --out another name") from None
    except OSError:
        # Some file systems of clusters have no locks.
        try:
            return path.open("ab")
        except OSError as error:
            raise UsageError(f"{path}: {error.strerror or error}") from error


# ---------------------------------------------------------------- plans compared

_SHOWN: Final = 60
_DIFFERENCES_MAX: Final = 5


def plan_parts(plan: Plan) -> dict[str, Any]:
    """Return what a plan is made of, by what a user calls it; texts and files as digests.

    What begins with `--` is an option with its value, what ends with `=` a keyword of Python.
    """
    data = plan_data(plan)
    parts = {_CALLED.get(name, f"--{name}"): value for name, value in data.items() if name not in _SEVERAL}
    parts["--vary"] = [f"{name}={kind}({', '.join(map(repr, values))})" for name, kind, values in data["variations"]]
    options = dict(data["options"])
    if text := options.pop("model_text", ""):
        parts["the arm file"] = data_digest(text)
    for name, value in options.items():
        row = OPTIONS.get(name)
        parts[row.flag if row is not None and "sweep" in row.commands else f"{name}="] = value
    if not data["chaos"].isidentifier() and data["chaos"]:
        parts["the chaos profile"] = data_digest(parts.pop("--chaos"))
    parts["the program"] = data_digest(data["program"])
    if data["world"]:
        parts["the world file"] = data_digest(data["world"])
    parts |= {f"{name} of the task folder": data_digest(text) for name, text in data["files"].items()}
    parts |= {name: data_digest(text) for name, text in data["python"].items()}
    return parts


_SEVERAL: Final = ("variations", "options", "program", "world", "files", "python")

_PROGRAM_NAME: Final = "the name of the program"
_VERSION: Final = "the version of elitescript"
_NAMES: Final = (_PROGRAM_NAME, _VERSION)
"""Parts that are shown with their value."""

_CALLED: Final = {
    "program_name": _PROGRAM_NAME,
    "world_name": "--world",
    "settings": "--set",
    "until_s": "--until",
    "measures": "--measure",
    "step_s": "--step",
    "has_margins": "--margins",
    "version": _VERSION,
}


def difference(old: Mapping[str, Any], new: Mapping[str, Any]) -> str:
    """Return the differences between the parts of two plans, in words; empty if there is none."""
    found = [_differs(name, old, new) for name in dict.fromkeys((*new, *old)) if _part(old, name) != _part(new, name)]
    more = len(found) - _DIFFERENCES_MAX
    return "; ".join(found[:_DIFFERENCES_MAX]) + (f"; and {more} more" if more > 0 else "")


def _part(parts: Mapping[str, Any], name: str) -> str | None:
    """Return a part as JSON has it: 1 and True are two things, a tuple and a list are not."""
    return json.dumps(parts[name], sort_keys=True) if name in parts else None


def _differs(name: str, old: Mapping[str, Any], new: Mapping[str, Any]) -> str:
    if name in _NAMES:
        return f"{name} is {_cut(str(new.get(name)))} now, and was {_cut(str(old.get(name)))}"
    if name.startswith("--") or name.endswith("="):
        now, then = _written(name, new.get(name)), _written(name, old.get(name))
        return f"{now or f'no {name}'} now, {then or 'not given'} then"
    return f"{name} {'is new' if name not in old else 'is gone' if name not in new else 'has changed'}"


def _written(name: str, value: Any) -> str:
    """Return an option as it is written with a value; empty if it is not given then."""
    if value is None or value is False or value == "" or value == [] or value == {}:
        return "" if name.startswith("--") or value is None else f"{name}{value!r}"
    if value is True:
        return name if name.startswith("--") else f"{name}True"
    if isinstance(value, dict):
        value = [f"{key}={item}" for key, item in value.items()]
    if isinstance(value, list):
        is_one = all(isinstance(item, int | float) for item in value)
        value = ",".join(map(str, value)) if is_one else f" {name} ".join(map(str, value))
    return f"{name} {_cut(str(value))}" if name.startswith("--") else f"{name}{_cut(str(value))}"


def _cut(text: str) -> str:
    return text if len(text) <= _SHOWN else text[:_SHOWN] + "..."
