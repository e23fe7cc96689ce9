"""Makes damaged files of good ones: bytes turned, lines moved, values that no reader expects."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

VALUES = (
    *(b"[" * 200, b"{" * 200, b'{"a":' * 150, b"9" * 5000, b"-1", b"0", b"1e999", b"nan", b"inf", b"-inf", b"1e-400"),
    *(b"true", b"null", b'""', b"''", b"[]", b"{}", b"[[]]", b"2026-01-01", b"18446744073709551616", b"0x7fffffffffff"),
    *(b"\x00", b"\xff", b"\xed\xa0\x80", b'"\\ud800"', b'"\\u0000"', b"\x1b[2J", "\u202e".encode(), b"\xef\xbb\xbf"),
    *(b"\r", b"\r\n", b"\n\n", b'"""', b"'''", b"#", b"=", b".", b"a.b.c", b"x" * 70_000, b"../../../etc/passwd"),
    *(b"/dev/zero", b"9223372036854775807", b"-9223372036854775808", b"4294967296", b"1_000", b"0.1.2", b"[[box]]"),
)


def mutated(data: bytes, seed: int) -> bytes:
    """Return a damaged copy; the same for the same seed."""
    chance = Random(seed)
    found = bytearray(data)
    for _ in range(chance.choice((1, 1, 1, 2, 3, 8))):
        at = chance.randrange(len(found) + 1)
        match chance.randrange(9):
            case 0:
                if found:
                    found[at - 1] ^= 1 << chance.randrange(8)
            case 1:
                del found[at : at + chance.choice((1, 2, 10, 200))]
            case 2:
                found[at:at] = chance.choice(VALUES)
            case 3:
                del found[at:]
            case 4:
                begin = chance.randrange(len(found) + 1)
                found[at:at] = found[begin : begin + chance.choice((1, 8, 64, 1000))]
            case 5:
                lines = found.split(b"\n")
                chance.shuffle(lines)
                found = bytearray(b"\n".join(lines))
            case 6:
                words = list(_words(found))
                if words:
                    begin, end = chance.choice(words)
                    found[begin:end] = chance.choice(VALUES)
            case 7:
                lines = found.split(b"\n")
                lines.insert(chance.randrange(len(lines) + 1), chance.choice(lines))
                found = bytearray(b"\n".join(lines))
            case _:
                found[at : at + 4] = chance.randbytes(4)
    return bytes(found)


def _words(data: bytearray) -> Iterator[tuple[int, int]]:
    """Yield the places of words and numbers."""
    begin = -1
    for at, byte in enumerate(data[:20_000]):
        is_word = chr(byte).isalnum() or byte in b"_-+."
        if is_word and begin < 0:
            begin = at
        elif not is_word and begin >= 0:
            yield begin, at
            begin = -1
