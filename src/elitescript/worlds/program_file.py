"""Program texts: from a file, or as they are."""

from __future__ import annotations

from pathlib import Path

from elitescript.errors import UsageError
from elitescript.language.source import SourceFile
from elitescript.messages.paths import why_no_file


def source_of(program: str | Path) -> SourceFile:
    """The source of a program: a path, or a text.

    A str is a path if it is a single line that ends in `.script`; everything else is program text.

    Raises:
        UsageError: the file cannot be read.
        ProgramError: the file is not UTF-8.
    """
    if isinstance(program, str) and ("\n" in program or not program.strip().endswith(".script")):
        return SourceFile("<program>", program)
    path = Path(program)
    if why := why_no_file(path, is_stream_allowed=True):
        raise UsageError(f"cannot read {path}: it {why}")
    try:
        data = path.read_bytes()
    except OSError as error:
        raise UsageError(f"cannot read {path}: {error.strerror or error}") from error
    return SourceFile.from_bytes(str(path), data)
