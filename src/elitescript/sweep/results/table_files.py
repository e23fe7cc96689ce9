"""The files of a table: the table, the journal while its sweep goes on, and what stays beside it when it is finished.

A table belongs to the settings of its sweep. `NAME.sweep` says which these are, with all rows as the journal has them,
so that `--resume` knows a finished table, refuses that of other settings, and goes on with more runs.
"""

from __future__ import annotations

import gzip
from collections.abc import Iterator, Mapping
from hashlib import sha256
from pathlib import Path
from shutil import copyfileobj
from typing import IO, Any, Final, cast
from zlib import error as zlib_error

from elitescript.errors import UsageError
from elitescript.outputs.writing import Output
from elitescript.paths import why_no_file
from elitescript.records import record
from elitescript.sweep.plans.plan import Plan
from elitescript.sweep.results.journal import (
    JOURNAL_BEGIN,
    LINE_MAX,
    Journal,
    content_of,
    difference,
    line_of,
    parts_of_head,
    plan_parts,
)
from elitescript.sweep.results.tables import FORMATS

PART: Final = ".part"
"""Behind the name of the table: the journal of a sweep that goes on, or was ended."""

KEPT: Final = ".sweep"
"""Behind the name of the table: settings and rows of a finished one."""

_FORMAT: Final = 1
_GZIP_BEGIN: Final = b"\x1f\x8b"
_LEVEL: Final = 3
"""Of compression: less costs more bytes, more costs time."""
_BLOCK: Final = 1 << 20


@record
class Finished:
    """What is known of a finished table.

    Attributes:
        digest: SHA-256 of the table, hexadecimal.
        runs: rows that are in it.
        failed: how many of them failed.
    """

    digest: str
    runs: int
    failed: int


class TableFiles:
    """The three files of one table.

    Args:
        table: path of the table.

    Attributes:
        table: see above.
        part: the journal.
        kept: what stays beside a finished table.
    """

    __slots__ = ("kept", "part", "table")

    def __init__(self, table: Path) -> None:
        self.table = table
        self.part = table.with_name(table.name + PART)
        self.kept = table.with_name(table.name + KEPT)

    def __iter__(self) -> Iterator[Path]:
        return iter((self.table, self.part, self.kept))

    def check(self) -> None:
        """Refuse what is no file, such as a named pipe, before anything is read.

        Raises:
            UsageError: the text names the path.
        """
        for path in self:
            if why := why_no_file(path):
                raise UsageError(f"--out: {path} {why}")
        for path, begin in ((self.part, JOURNAL_BEGIN), (self.kept, _GZIP_BEGIN)):
            if not begin.startswith(_first_bytes(path, len(begin))):
                raise UsageError(f"--out: {path} is there, and is none of a sweep; give --out another name, or move it")

    def finished(self, plan: Plan) -> Finished | None:
        """Return what is known of the table, if a sweep with these settings has finished it; None if there is none.

        A journal goes before: the sweep that writes it has begun after the table.

        Raises:
            UsageError: the table belongs to other settings, has been changed since, or nothing says what it belongs to.
        """
        if self._is_begun():
            return None
        if not self.kept.exists():
            if self.table.exists():
                raise UsageError(
                    f"--resume: {self.table} is there, but no {self.kept.name} beside it that says which settings it "
                    "belongs to; give --out another name, or leave out --resume, which replaces it"
                )
            return None
        found, parts = self._head()
        if why := difference(parts, plan_parts(plan)):
            raise UsageError(
                f"--resume: {self.table} was made with other settings: {why}; give --out another name, or leave out "
                "--resume, which replaces it"
            )
        if self.table.exists() and _digest(self.table) != found.digest:
            raise UsageError(
                f"--resume: {self.table} has been changed since its sweep has written it; give --out another name, or "
                "leave out --resume, which replaces it"
            )
        return found

    def journal(self, plan: Plan, *, resumes: bool) -> Journal:
        """Open the journal.

        Args:
            plan: of the sweep.
            resumes: whether to go on with the journal that is there, else with the rows of the finished table;
                `finished` has accepted them.

        Raises:
            UsageError: see `Journal`.
        """
        seed = self._copy_rows if resumes and self.kept.exists() else None
        return Journal(self.part, plan, resumes=resumes, seed=seed)

    def finish(self, journal: Journal, failed: int) -> None:
        """Keep settings and rows beside the table, which has been written.

        Args:
            journal: of the sweep; it stays.
            failed: runs that failed.

        Raises:
            UsageError: they cannot be written; the journal goes on to say what the table belongs to.
        """
        head = {"table": _FORMAT, "digest": _digest(self.table), "runs": journal.done, "failed": failed}
        try:
            with (
                Output(self.kept) as file,
                cast("IO[bytes]", gzip.GzipFile("", "wb", _LEVEL, file, 0)) as packed,
                journal.path.open("rb") as rows,
            ):
                packed.write(line_of(head))
                copyfileobj(rows, packed, _BLOCK)
        except OSError as error:
            raise UsageError(f"{self.table} is complete; {self.kept}: {error.strerror or error}") from error

    def forget(self) -> None:
        """Delete what is known of the table: something else than a sweep has written it."""
        self.kept.unlink(missing_ok=True)

    def _is_begun(self) -> bool:
        """Return whether the journal has its first line; one that was torn before says nothing."""
        if not self.part.exists():
            return False
        with self.part.open("rb") as file:
            return file.readline(LINE_MAX).endswith(b"\n")

    def _head(self) -> tuple[Finished, Mapping[str, Any]]:
        """Return what is known of the table, and the parts of its plan."""
        try:
            with gzip.open(self.kept, "rb") as packed:
                head, parts = content_of(packed.readline(LINE_MAX)), parts_of_head(packed.readline(LINE_MAX))
            if head["table"] != _FORMAT or parts is None:
                raise ValueError
            return Finished(str(head["digest"]), int(head["runs"]), int(head["failed"])), parts
        except (OSError, EOFError, ValueError, TypeError, KeyError, zlib_error) as error:
            why = error.strerror if isinstance(error, OSError) and error.strerror else "it is damaged"
            raise UsageError(
                f"--resume: {self.kept}: {why}, so nothing says which settings {self.table.name} belongs to; give "
                "--out another name, or leave out --resume, which replaces it"
            ) from error

    def _copy_rows(self, file: IO[bytes]) -> None:
        """Write the journal of the finished table into a file."""
        try:
            with gzip.open(self.kept, "rb") as packed:
                packed.readline(LINE_MAX)
                copyfileobj(packed, file, _BLOCK)
        except (EOFError, gzip.BadGzipFile, zlib_error):
            pass  # what is torn is dropped, and run again


def _first_bytes(path: Path, count: int) -> bytes:
    """Return the first bytes of a file; none if there is no file, or it cannot be read."""
    try:
        with path.open("rb") as file:
            return file.read(count)
    except OSError:
        return b""


def is_of_sweep(name: str) -> bool:
    """Return whether a file is beside the table of a sweep, by its name."""
    return name.endswith(tuple(f"{suffix}{end}" for suffix in FORMATS for end in (PART, KEPT)))


def _digest(path: Path) -> str:
    """Return the SHA-256 of a file, hexadecimal.

    Raises:
        UsageError: it cannot be read.
    """
    found = sha256()
    try:
        with path.open("rb") as file:
            while block := file.read(_BLOCK):
                found.update(block)
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror or error}") from error
    return found.hexdigest()
