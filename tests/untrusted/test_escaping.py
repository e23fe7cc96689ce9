"""Texts that others wrote, as editors show them."""

from __future__ import annotations

import pytest

from elitescript.untrusted.escaping import code_block, code_span, markdown_text

ATTACKS = {
    "[click](command:workbench.action.terminal.new)": r"\[click\](command:workbench.action.terminal.new)",
    "<command:x>": r"\<command:x\>",
    '<img src=x onerror="alert(1)">': r'\<img src=x onerror="alert(1)"\>',
    "![x](http://a.b/c.png)": r"!\[x\](http\://a.b/c.png)",
    "see www.example.com or a@b.c": r"see www\.example.com or a\@b.c",
    "&#x3c;script&#x3e;": r"\&#x3c;script\&#x3e;",
    "# head\n- list\n  + list\n1. one\n===\n---": "\\# head\n\\- list\n  \\+ list\n1\\. one\n\\===\n\\---",
    "`code` *a* __b__ ~~c~~ a|b \\[x]": r"\`code\` \*a\* \_\_b\_\_ \~\~c\~\~ a\|b \\\[x\]",
    "[a]: javascript:x": r"\[a\]: javascript:x",
    "a\u202eb\x1b[2J": r"a\\u202eb\\x1b\[2J",
}


@pytest.mark.parametrize("text", ATTACKS)
def test_no_mark_of_a_text_is_one_of_markdown(text: str) -> None:
    assert markdown_text(text) == ATTACKS[text]


def test_plain_words_stay_as_they_are() -> None:
    text = "Move to the pose (0.3, -0.2) of line 3, then wait: 1.5 s.\n\nSecond paragraph - with a dash, 中文　全角."
    assert markdown_text(text) == text


def test_code_cannot_be_left() -> None:
    assert code_span("a`b``c") == "```a`b``c```"
    assert code_span("`x`") == "`` `x` ``"
    assert code_span("a\nb") == "`a b`"
    assert code_block("x\n```\n[y](command:z)", "elitescript") == "````elitescript\nx\n```\n[y](command:z)\n````"
