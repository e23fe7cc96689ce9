"""Texts that others wrote, as terminals, editors and GitHub show them."""

from __future__ import annotations

import re

import pytest

from elitescript.untrusted.escaping import code_block, code_span, github_text, markdown_text, terminal_text, visible

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


TERMINAL = {
    "\x1b]0;title\x07": r"\x1b]0;title\x07",
    "\x1b[2J\x1b[H": r"\x1b[2J\x1b[H",
    "\x9b31m": r"\x9b31m",
    "done\rALARM": r"done\rALARM",
    "a\x08b\x7f": r"a\x08b\x7f",
    "\x1b[8mhidden": r"\x1b[8mhidden",
    "\x1bPq": r"\x1bPq",
    "\u202eabc": r"\u202eabc",
    "\x1b[1;31merror\x1b[0m\tx\r\ny\n中　é": "\x1b[1;31merror\x1b[0m\tx\r\ny\n中　é",
}


@pytest.mark.parametrize("text", TERMINAL)
def test_no_sign_of_a_text_drives_a_terminal(text: str) -> None:
    assert terminal_text(text) == TERMINAL[text]


def test_every_control_character_is_shown() -> None:
    signs = [chr(code) for code in (*range(32), *range(127, 160)) if chr(code) not in "\t\n"]
    assert all(re.fullmatch(r"\\x[0-9a-f]{2}|\\r", terminal_text(sign)) for sign in signs)
    assert visible("\r\n\t") == "\r\n\t"


def test_workflow_commands_are_texts() -> None:
    text = "0.000 s  a\n::error file=x::y\n  ::stop-commands::t\n##[group]g\na::b"
    assert github_text(text) == "0.000 s  a\n\\::error file=x::y\n  \\::stop-commands::t\n\\##[group]g\na::b"
