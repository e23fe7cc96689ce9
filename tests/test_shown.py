"""Texts that others wrote, as reports, terminals, logs of CI runners and JSON have them; typed by hand."""

from __future__ import annotations

import json
import re

import pytest

from elitescript.shown import (
    continued,
    encodable,
    encodable_json,
    printable,
    printed,
    printed_json,
    shown,
    shown_word,
    visible,
    with_bytes,
)

SHOWN = {
    "the arm is at [0.44, 1.5]\t(m)": "the arm is at [0.44, 1.5]\t(m)",
    "中　é \U0001f468\u200d\U0001f52c": "中　é \U0001f468\u200d\U0001f52c",
    # What drives a terminal.
    "\x1b]0;title\x07": r"\x1b]0;title\x07",
    "\x1b[2J\x1b[H\x1bPq": r"\x1b[2J\x1b[H\x1bPq",
    "\x1b[32mfinished\x1b[0m": r"\x1b[32mfinished\x1b[0m",
    "\x9b31m": r"\x9b31m",
    "a\x08b\x7f\x00": r"a\x08b\x7f\x00",
    # What reverses a text.
    "\u202eabc\u202c \u2066x\u2069 \u200e\u200f\u061c": r"\u202eabc\u202c \u2066x\u2069 \u200e\u200f\u061c",
    # Line ends.
    "done\nfinished": "done\n| finished",
    "done\r\nfinished\rALARM": "done\\r\n| finished\\rALARM",
    "a\x0bb\x0cc\x85d\u2028e\u2029f\x1cg": r"a\x0bb\x0cc\x85d\u2028e\u2029f\x1cg",
    # Commands of runners.
    "::error::x": r":\x3aerror::x",
    "a\n  ::add-mask::b": "a\n|   :\\x3aadd-mask::b",
    "\u3000\xa0\u2003\t::x": "\u3000\xa0\u2003\t:\\x3ax",
    "\x0b\x85::x": r"\x0b\x85:\x3ax",
    "\ufeff:\u200d:x": "\ufeff:\u200d\\x3ax",
    "a::b c ::d": "a::b c ::d",
    "x ##[group]y": r"x #\x23[group]y",
    "##[[": r"#\x23[[",
    "###[a] ##[b]": r"##\x23[a] #\x23[b]",
    "##vso[task.setvariable variable=a]b": r"#\x23vso[task.setvariable variable=a]b",
    "##VSO[a ##teamcity[message": r"#\x23VSO[a #\x23teamcity[message",
    "#\ufe0f#\u200d[a ##v\xadso[b": "#\ufe0f\\x23\u200d[a #\\x23v\xadso[b",
    "## a heading [1] #[2] # #[3]": "## a heading [1] #[2] # #[3]",
    # Halves of surrogate pairs.
    "\ud83d \udce9": r"\ud83d \udce9",
}


@pytest.mark.parametrize("text", SHOWN, ids=ascii)
def test_nothing_in_a_shown_text_acts(text):
    assert shown(text) == SHOWN[text]


def test_a_name_stays_in_its_line():
    assert shown_word("a\nb\tc\r\n") == r"a\nb\tc\r\n"
    assert shown_word("a::b.script") == "a::b.script"
    assert shown_word("##[error]\x1b.script") == r"#\x23[error]\x1b.script"


@pytest.mark.parametrize("text", SHOWN, ids=ascii)
def test_what_is_printed_is_the_same_but_for_line_ends(text):
    alike = text.replace("\r\n", "\n")
    assert printed(alike).replace("\n", "\n| ") == shown(alike)
    assert printed(printed(text)) == printed(text)


def test_what_is_printed_has_no_commands_behind_marks_of_lines():
    assert printed("a\n| ::b\nE    ::c\n|::d") == "a\n| :\\x3ab\nE    :\\x3ac\n|::d"


def test_own_colours_and_line_ends_are_printed():
    text = "\x1b[1;31merror\x1b[0m\tx\r\ny\n"
    assert printed(text, has_colors=True) == text
    assert printed(text) == "\\x1b[1;31merror\\x1b[0m\tx\r\ny\n"
    assert printed("\x1b[8mhidden\x1b[31mx", has_colors=True) == r"\x1b[8mhidden\x1b[31mx"
    assert printed("a\rb") == r"a\rb"


def test_every_control_character_is_shown():
    for code in (*range(32), *range(127, 160)):
        assert re.fullmatch(r"\\x[0-9a-f]{2}|\\[rnt]", shown_word(chr(code))), code


@pytest.mark.parametrize("text", SHOWN, ids=ascii)
def test_json_has_the_same_values_and_nothing_in_it_acts(text):
    for line in (json.dumps({"text": text}), json.dumps({"text": text}, ensure_ascii=False)):
        out = printed_json(line)
        assert json.loads(out) == {"text": text}
        assert printed(out) == out


HALVES = {
    r'"\ud83d"': r'"\\ud83d"',
    r'"\uD83D\uDE00 \ud83d\ude00"': r'"\uD83D\uDE00 \ud83d\ude00"',
    r'"\ude00\ud83d"': r'"\\ude00\\ud83d"',
    r'"\ud83d\ud83d\ude00"': r'"\\ud83d\ud83d\ude00"',
    r'"\\ud83d \\\ud83d \"\ud83d"': r'"\\ud83d \\\\ud83d \"\\ud83d"',
    r'{"\udce9": ["\u00e9\uDFFF"]}': r'{"\\udce9": ["\u00e9\\uDFFF"]}',
    '"\udce9 é"': '"\\\\udce9 é"',
}


@pytest.mark.parametrize("text", HALVES, ids=ascii)
def test_halves_in_json_are_texts_of_it(text):
    assert encodable_json(text) == HALVES[text]
    json.dumps(json.loads(encodable_json(text)), ensure_ascii=False).encode()


def test_halves_are_escapes():
    assert encodable("a\ud83db\u4e2d\U0001f600") == "a\\ud83db\u4e2d\U0001f600"
    assert printable("a\nb\x1b\udce9\ufffe\u4e2d") == r"a\nb\x1b\udce9\ufffe" + "\u4e2d"


def test_names_of_files_come_back():
    name = "b\udce9\udc80 \u4e2d.script"
    assert with_bytes(encodable(name)) == name
    assert with_bytes(r"\ud83d \udc7f \u00e9") == r"\ud83d \udc7f \u00e9"


def test_texts_that_are_shown_elsewhere_keep_their_lines():
    assert visible("a\x1b\u202e\ud83d\r\nb\t") == "a\\x1b\\u202e\\ud83d\r\nb\t"
    assert continued("a\nb\x1b") == "a\n| b\x1b"
