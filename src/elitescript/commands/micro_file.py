"""Reads the text of a point file: one point a line, six numbers.

Numbers are separated by blanks, tabs or commas, also several blanks around a comma. Blank lines, and what stands
after a `#`, are skipped; a comma at the end of a line too. A byte order mark and any line end are accepted. All of
this is *assumed*: the manual does not say what a file looks like.
"""

from __future__ import annotations

from array import array
from itertools import chain, compress
from math import isfinite, pi
from typing import Final

from elitescript.errors import InvalidValueError
from elitescript.said import said

POINTS_MAX: Final = 1_000_000
"""Points of one file (*assumed*); more than an hour at 4 ms."""

BYTES_MAX: Final = 256 * POINTS_MAX
"""Bytes of one file; six numbers of any sensible length and a comment fit in 256."""

_COUNT: Final = 6
_COUNTS: Final = {0, _COUNT}

_BATCH: Final = 500
"""Lines whose words are held at a time: of a whole file they would take three times as much memory as all else."""

_SHOWN: Final = 24
"""Characters of a wrong number that a message repeats."""

_DEGREE: Final = pi / 180.0


def read_points(data: bytes, name: str, *, is_cartesian: bool, is_degrees: bool) -> tuple[bytes, bytes]:
    """Read a file.

    Args:
        data: its content, UTF-8.
        name: of the file, for messages.
        is_cartesian: the points are poses, else joint positions.
        is_degrees: joints are in deg, positions of poses in mm (orientations stay in rad); else all is in rad and m.

    Returns:
        Six doubles for each point in SI units, and the line of each point, from 1, as unsigned 32-bit numbers.

    Raises:
        InvalidValueError: with file, line and column of what is wrong.
    """
    text = _text(data, name)
    blank = text.replace(" ", "").replace("\t", "") if "," in text else ""
    if "_" in text or ",," in blank or "\n," in blank or blank.startswith(","):
        # Rarely right, and wrong in ways that the quick reading below does not detect.
        _refuse_bad_line(text.split("\n"), name)
    numbers, file_lines = array("d"), array("I")
    lines = _separated(text)
    for first in range(0, len(lines), _BATCH):
        rows = list(map(str.split, lines[first : first + _BATCH]))
        counts = set(map(len, rows))
        if not counts <= _COUNTS:
            _refuse(text, lines, name)
        here = range(first + 1, first + 1 + len(rows))
        file_lines.extend(here if 0 not in counts else compress(here, rows))
        try:
            numbers.extend(map(float, chain.from_iterable(rows)))
        except ValueError:
            _refuse(text, lines, name)
            raise
    _check_count(len(file_lines), name)
    if not isfinite(sum(numbers)) and not all(map(isfinite, numbers)):
        _refuse_bad_line(text.split("\n"), name)
    if is_degrees and is_cartesian:
        for axis in range(3):
            numbers[axis::_COUNT] = array("d", [length * 1e-3 for length in numbers[axis::_COUNT]])
    elif is_degrees:
        numbers = array("d", [angle * _DEGREE for angle in numbers])
    return numbers.tobytes(), file_lines.tobytes()


def _text(data: bytes, name: str) -> str:
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        from elitescript.text_encoding import decoded_from

        line = data.count(b"\n", 0, error.start) + 1
        other = decoded_from(data)
        hint = None if other is None else said("it looks like {other}; save it as UTF-8", other=other[1])
        raise InvalidValueError(
            said("{name}, line {line}: the text is not UTF-8", name=name, line=line), value=name, hint=hint
        ) from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _separated(text: str) -> list[str]:
    """Return the lines without comments, with blanks in place of commas."""
    if "," in text:
        text = text.replace(",", " ")
    lines = text.split("\n")
    return [line.partition("#")[0] for line in lines] if "#" in text else lines


def _check_count(count: int, name: str) -> None:
    if count == 0:
        raise InvalidValueError(said("{name} holds no point; each line has to hold six numbers", name=name), value=name)
    if count > POINTS_MAX:
        raise InvalidValueError(
            said(
                "{name} holds {count} points; at most {points_max} are allowed",
                name=name,
                count=count,
                points_max=POINTS_MAX,
            ),
            value=count,
            limit=f"<= {POINTS_MAX}",
        )


def _refuse(text: str, lines: list[str], name: str) -> None:
    """Raise the error of a file with a bad line, or with too many points; a wrong count of numbers comes first."""
    counts = [len(line.split()) for line in lines]
    if _COUNTS.issuperset(counts):
        _check_count(len(counts) - counts.count(0), name)
    _refuse_bad_line(text.split("\n"), name)


def _refuse_bad_line(lines: list[str], name: str) -> None:
    """Raise the error of the first line that holds no point and is not blank."""
    for line_number, line in enumerate(lines, 1):
        content = line.partition("#")[0]
        if content.strip():
            _check_line(content, name, line_number)


def _check_line(content: str, name: str, line_number: int) -> None:
    found: list[str] = []
    place = 0
    pieces = content.split(",")
    if len(pieces) > 1 and not pieces[-1].strip():
        pieces.pop()
    for piece in pieces:
        words = piece.split()
        if not words:
            raise InvalidValueError(
                said(
                    "{name}, line {line_number}, column {place}: a number is missing next to the comma",
                    name=name,
                    line_number=line_number,
                    place=place + 1,
                ),
                value=piece,
            )
        start = 0
        for word in words:
            start = piece.index(word, start)
            _check_number(
                word,
                said(
                    "{name}, line {line_number}, column {place}",
                    name=name,
                    line_number=line_number,
                    place=place + start + 1,
                ),
            )
            start += len(word)
        found += words
        place += len(piece) + 1
    if len(found) != _COUNT:
        hint = "one point a line: x, y, z, Rx, Ry, Rz or six joint positions"
        if len(found) == 2 * _COUNT and "," in content:
            hint = "decimals are written with a point, 0.5, not with a comma"
        raise InvalidValueError(
            said(
                "{name}, line {line_number}: six numbers are needed, there are {count}",
                name=name,
                line_number=line_number,
                count=len(found),
            ),
            value=len(found),
            limit="6",
            hint=hint,
        )


def _check_number(word: str, place: str) -> None:
    shown = repr(word if len(word) <= _SHOWN else word[: _SHOWN - 3] + "...")
    try:
        number = float("-" if "_" in word else word)
    except ValueError:
        hint = "separate numbers by blanks or commas, and write nothing else before a #"
        raise InvalidValueError(
            said("{place}: {shown} is not a number", place=place, shown=shown), value=word[:_SHOWN], hint=hint
        ) from None
    if not isfinite(number):
        raise InvalidValueError(
            said("{place}: {shown} is not a finite number", place=place, shown=shown), value=word[:_SHOWN]
        )
