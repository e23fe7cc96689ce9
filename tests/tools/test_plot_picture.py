"""Pictures that the tool has reduced are compared with pixels worked out by hand."""

import struct
import zlib

import pytest

from tools.plot_picture import reduced


def png(width: int, height: int, lines: bytes, form: bytes = b"\x08\x02\x00\x00\x00") -> bytes:
    """A PNG file of filtered lines."""

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    header = struct.pack(">II", width, height) + form
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")


def lines_of(picture: bytes) -> bytes:
    """The lines of a picture whose data is one chunk behind the header."""
    start = picture.index(b"IDAT")
    (length,) = struct.unpack_from(">I", picture, start - 4)
    return zlib.decompress(picture[start + 4 : start + 4 + length])


FILTERED = {
    "none": (b"\x00" + bytes([8, 16, 24, 32, 40, 48]), [8, 16, 24, 32, 40, 48]),
    "left": (b"\x01" + bytes([8, 16, 24, 24, 24, 24]), [8, 16, 24, 32, 40, 48]),
    "left, over 255": (b"\x01" + bytes([248, 16, 24, 16, 24, 24]), [248, 16, 24, 8, 40, 48]),
}


@pytest.mark.parametrize("name", FILTERED)
def test_the_filter_of_the_first_line_is_undone(name: str) -> None:
    line, pixels = FILTERED[name]
    assert lines_of(reduced(png(2, 1, line))) == b"\0" + bytes(pixels)


@pytest.mark.parametrize(
    ("line", "pixels"),
    [
        (b"\x02" + bytes([8] * 6), [16, 24, 32, 40, 48, 56]),  # above
        (b"\x03" + bytes([4, 8, 4, 12, 12, 8]), [8, 16, 16, 32, 40, 40]),  # mean of left and above, rounded down
        (b"\x04" + bytes([8] * 6), [16, 24, 32, 40, 48, 56]),  # Paeth: above is nearest
    ],
    ids=["above", "mean", "Paeth"],
)
def test_the_filter_of_the_second_line_is_undone(line: bytes, pixels: list[int]) -> None:
    first = b"\x00" + bytes([8, 16, 24, 32, 40, 48])
    assert lines_of(reduced(png(2, 2, first + line))) == first + b"\0" + bytes(pixels)


def test_the_paeth_filter_takes_the_left_one_where_above_does_not_change() -> None:
    first = b"\x00" + bytes([8] * 6)
    assert lines_of(reduced(png(2, 2, first + b"\x04" + bytes([8] * 6)))) == first + b"\0" + bytes([16] * 3 + [24] * 3)


def test_colours_are_rounded_to_five_bits_and_white_stays_white() -> None:
    line = b"\x00" + bytes([255, 252, 251, 3, 4, 0])
    assert lines_of(reduced(png(2, 1, line))) == b"\0" + bytes([255, 255, 248, 0, 8, 0])


@pytest.mark.parametrize("bad", [b"GIF89a", png(1, 1, b"\0\0\0\0\0", b"\x08\x06\x00\x00\x00")], ids=["GIF", "RGBA"])
def test_another_format_is_refused(bad: bytes) -> None:
    with pytest.raises(ValueError, match="not a"):
        reduced(bad)
