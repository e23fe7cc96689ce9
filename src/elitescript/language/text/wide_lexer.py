"""Reads texts in whose code signs of an input method stand, as if they were the plain ones."""

from __future__ import annotations

from elitescript.language.text.lexer import STRING_FILL, LogicalLine, StringToken, TextScanner, WideSign, is_in_word
from elitescript.language.text.strings import prefix_start
from elitescript.language.text.wide_signs import (
    CORNERS,
    DASHES,
    WIDE_BLANK,
    blank_with_wide_signs,
    plain_of,
    plain_of_mark,
    plain_word,
    stand_in,
    structure_with_wide_signs,
)
from elitescript.language.text.wide_strings import corner_brackets, wide_closer, wide_in_fields, wide_string_end


class WideScanner(TextScanner):
    """See `TextScanner`."""

    __slots__ = ("corners",)

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.corners: set[int] = set()
        """Offsets of corner brackets that close a list."""
        self.blank = blank_with_wide_signs().match
        self.search = structure_with_wide_signs().search
        # What is plain is not known before a line is read.
        self.plain = lambda text, position: None

    def _begins(self, logical: LogicalLine, position: int) -> None:
        before = self.text[position : logical.start]
        if not before.isascii():
            self.signs.append(WideSign(position, logical.start, _plain_indentation(before)))
        logical.word = plain_word(logical.word)

    def _notes_comment(self, at: int) -> bool:
        self.signs.append(WideSign(at, at + 1, "#"))
        return True

    def _code_size(self, code: str) -> int:
        size = len(code)
        while size and stand_in(code[size - 1]) in " \t\f\\\n":
            size -= 1
        return size

    def _closed(self, quote: str, body: int, end: int, is_formatted: bool) -> int:
        closer = wide_closer(self.text, body, end, quote) if len(quote) == 1 else -1
        if is_formatted and (closer >= 0 or end >= 0):
            self.signs += wide_in_fields(self.text, body, closer if closer >= 0 else end - len(quote), quote)
        if closer >= 0:
            self.signs.append(WideSign(closer, closer + 1, quote))
            return closer + 1
        return end

    def _ends(self) -> None:
        if self.signs:
            self.lexed.wide_signs = self.signs
            self.lexed.text = self._plain_text()

    def _wide(self, mark: str, at: int, depth_at_line_start: int) -> tuple[str, int]:
        """See `TextScanner`."""
        end = at + len(mark)
        plain = plain_of_mark(mark)
        if mark == DASHES:
            if not _is_in_word(self.text, at, end):
                return self._uncertain(at, end)
            self._sign(at, end, plain, "__")
            return "", end
        if plain == mark:
            return "", end
        if len(mark) > 1:
            self._sign(at, end, plain, plain)
            return "", end
        if mark in CORNERS:
            return self._corner(at, depth_at_line_start)
        if plain in "'\"":
            return "", self._wide_string(at, depth_at_line_start)
        if plain in "#\\":
            self.signs.append(WideSign(at, end, plain))
            return plain, end
        self._sign(at, end, plain, stand_in(mark))
        return (plain if plain in "()[]{}" else ""), end

    def _corner(self, at: int, depth_at_line_start: int) -> tuple[str, int]:
        plain = "]" if at in self.corners else ""
        if not plain:
            closer, plain = corner_brackets(self.text, at)
            if plain == '"':
                return "", self._wide_string(at, depth_at_line_start)
            if not plain:
                return self._uncertain(at, max(closer, at) + 1)
            self.corners.add(closer)
        self._sign(at, at + 1, plain, plain)
        return plain, at + 1

    def _uncertain(self, at: int, end: int) -> tuple[str, int]:
        self.signs.append(WideSign(at, end, ""))
        self.broken = True
        self._fill(at, end, STRING_FILL)
        return "", end

    def _wide_string(self, at: int, depth_at_line_start: int) -> int:
        text = self.text
        start = prefix_start(text, at)
        closer, end, quote = wide_string_end(text, at)
        if end < 0:
            line_end = text.find("\n", at)
            end = len(text) if line_end < 0 else line_end
            self.signs.append(WideSign(at, at + 1, ""))
            self.broken = True
            del self.stack[depth_at_line_start:]
        else:
            body = at + end - closer
            self.signs.append(WideSign(at, body, quote))
            if quote and "f" in text[start:at].lower():
                self.signs += wide_in_fields(text, body, closer, quote)
            self.signs.append(WideSign(closer, end, quote))
            if not quote:
                self.broken = True
            elif "\\" in text[body:closer] and "r" not in text[start:at].lower():
                self.lexed.strings.append(StringToken(start, body, end))
            self.line += text.count("\n", at, end)
        self._fill(start, end, STRING_FILL)
        return end

    def _sign(self, start: int, end: int, plain: str, fill: str) -> None:
        self.signs.append(WideSign(start, end, plain))
        for at, character in enumerate(fill, start):
            self._fill(at, at + 1, character)

    def _plain_text(self) -> str:
        parts = []
        position = 0
        for start, end, plain in self.signs:
            parts.append(self.text[position:start])
            old = self.text[start:end]
            if len(plain) == end - start and (plain[0] not in "'\"" or len(plain) == 1):
                parts.append(plain)
            else:
                parts.append("".join(map(stand_in, old)) if plain else old)
            position = end
        parts.append(self.text[position:])
        return "".join(parts)


def _is_in_word(text: str, start: int, end: int) -> bool:
    before, behind = text[start - 1 : start], text[end : end + 1]
    return any(sign.isalnum() or is_in_word(sign) for sign in (before, behind))


def _plain_indentation(blank: str) -> str:
    """Return blanks and tabs of the same width as the blanks of an input method."""
    return "".join("  " if sign == WIDE_BLANK else plain_of(sign) for sign in blank)
