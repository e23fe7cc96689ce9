"""The text of a program and its lines."""

from __future__ import annotations

from dataclasses import dataclass, field

from elitescript.errors import ProgramError

BOM = "\ufeff"


@dataclass(frozen=True, slots=True)
class SourceFile:
    """A text under a name.

    Line ends become LF and a leading byte order mark is dropped, so that a line is what an
    editor shows as one and columns count the characters that the author sees.
    """

    name: str
    text: str
    lines: tuple[str, ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        text = self.text.removeprefix(BOM)
        if "\r" in text:
            text = text.replace("\r\n", "\n").replace("\r", "\n")
        object.__setattr__(self, "text", text)
        object.__setattr__(self, "lines", tuple(text.split("\n")))

    @classmethod
    def from_bytes(cls, name: str, data: bytes) -> SourceFile:
        """Decode a file.

        Raises:
            ProgramError: E002 at the first byte that is not UTF-8.
        """
        try:
            return cls(name, data.decode("utf-8"))
        except UnicodeDecodeError as error:
            raise ProgramError((_bad_byte(data, error.start),)) from None

    def line(self, n: int) -> str:
        """Return the line `n`, counted from 1, without its line end; empty outside the text."""
        return self.lines[n - 1] if 1 <= n <= len(self.lines) else ""


def _bad_byte(data: bytes, position: int) -> object:
    from elitescript.language.diagnostics import diagnostic

    before = SourceFile("", data[:position].decode("utf-8"))
    line = len(before.lines)
    return diagnostic(
        "E002",
        line,
        len(before.lines[-1]) + 1,
        f"byte 0x{data[position]:02X} is not UTF-8 text",
        hint="save the file as UTF-8",
    )
