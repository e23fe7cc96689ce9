"""Reads texts in whose code signs of an input method stand, as if they were the plain ones."""

from __future__ import annotations

from elitescript.language.text.lexer import STRING_FILL, LogicalLine, StringToken, TextScanner, WideSign
from elitescript.language.text.strings import prefix_start
from elitescript.language.text.wide_signs import (
    WIDE_BLANK,
    blank_with_wide_signs,
    plain_of,
    plain_word,
    stand_in,
    structure_with_wide_signs,
    wide_closer,
    wide_string_end,
)


class WideScanner(TextScanner):
    """See `TextScanner`."""

    __slots__ = ()

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.blank = blank_with_wide_signs().match
        self.search = structure_with_wide_signs().search

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

    def _closed(self, quote: str, body: int, end: int) -> int:
        if len(quote) == 1 and (closer := wide_closer(self.text, body, end, quote)) >= 0:
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
        if mark[0].isalnum() or mark[0] == "_" or mark[0] == "\uff3f":
            if (plain := plain_word(mark)) != mark:
                self._sign(at, end, plain, plain)
            return "", end
        if len(mark) == 2:
            # An input method types the two dashes for the underscore.
            self._sign(at, end, "_", "__")
            return "", end
        plain = plain_of(mark)
        if plain in "'\"":
            return "", self._wide_string(at, depth_at_line_start)
        if plain in "#\\":
            self.signs.append(WideSign(at, end, plain))
            return plain, end
        self._sign(at, end, plain, stand_in(mark))
        return (plain if plain in "()[]{}" else ""), end

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
            self.signs += (WideSign(at, body, quote), WideSign(closer, end, quote))
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


def _plain_indentation(blank: str) -> str:
    """Return blanks and tabs of the same width as the blanks of an input method."""
    return "".join("  " if sign == WIDE_BLANK else plain_of(sign) for sign in blank)
