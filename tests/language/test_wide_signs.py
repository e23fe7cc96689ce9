# ruff: noqa: RUF001 - wide signs are the subject
"""Signs of input methods: named, mended in code, left alone in strings and comments."""

import random
import time

import pytest

from elitescript.errors import ProgramError
from elitescript.language.compiler import compile_parsed
from elitescript.language.parser import parse
from elitescript.language.text.masked import lex
from elitescript.language.text.source import SourceFile, apply_fixes
from tests.language.random_programs import random_program

WIDE_OF = {
    **{sign: chr(ord(sign) + 0xFEE0) for sign in "!#%&()*+,-./0123456789:;<=>@[]^{|}~"},
    "[": "【",
    "]": "］",
    ",": "、",
}
"""By a plain sign, one that an input method types for it; typed by hand, beside the table of the product."""


def findings(text: str):
    return parse(SourceFile("f", text)).diagnostics


def mended(text: str) -> str:
    fixes = [problem.fix for problem in findings(text) if problem.fix is not None and problem.fix.safe]
    return apply_fixes(text, fixes)


def compiles(text: str) -> bool:
    try:
        compile_parsed(parse(SourceFile("f", text)))
    except ProgramError:
        return False
    return True


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ('textmsg("x"）', 'textmsg("x")'),
        ('textmsg(“完成")', 'textmsg("完成")'),
        ('textmsg("完成”)', 'textmsg("完成")'),
        ("textmsg（“你好，世界（一）：完成；”）", 'textmsg("你好，世界（一）：完成；")'),
        ('textmsg(“say "hi" now”)', "textmsg('say \"hi\" now')"),
        ('textmsg(“say "hi" don\'t”)', 'textmsg("""say "hi" don\'t""")'),
        ("textmsg(“他说“好””)", 'textmsg("他说“好”")'),
        ("textmsg(”a”)", 'textmsg("a")'),
        ("textmsg(“a“)", 'textmsg("a")'),
        ("x = ‘it’s’", "x = 'it’s'"),
        ("x = “““a”b\n c”””", 'x = """a”b\n c"""'),
        ("x = f“{1}”  ＃ 好，（", 'x = f"{1}"  # 好，（'),
        ("＃ 好，（", "# 好，（"),
        ("x = 【1、2】", "x = [1,2]"),
        ("x = ｛1：2｝", "x = {1:2}"),
        ("x = 1。5 ％ 2 ＆ ７", "x = 1.5 % 2 & 7"),
        ("x = 1 ！＝ 2", "x = 1 != 2"),
        ("x = 1 ≤ 2 ≥ 3 ≠ 4", "x = 1 <= 2 >= 3 != 4"),
        ("x = 3 ÷ 2 — 1 × 2", "x = 3 / 2 - 1 * 2"),
        ("x = 1 《 2", "x = 1 < 2"),
        ("x = ０ｘ１Ｆ", "x = 0x1F"),
        ("ｉｆ 1：\n  pass\nｅｎｄ\n", "if 1:\n  pass\nend\n"),
        ("get——it = 1", "get_it = 1"),
        ("x = [1，\n  2，\n  3］", "x = [1,\n  2,\n  3]"),
        (
            "def job():\n　　if 1:\n　　　　x = 1\n　　end\nend\n",
            "def job():\n    if 1:\n        x = 1\n    end\nend\n",
        ),
        ("def job():\n  x = 1\n　x = 2\nend\n", "def job():\n  x = 1\n  x = 2\nend\n"),
        ("x\u00a0=\u20021", "x = 1"),
        # fields of formatted strings are code, what is around them and how they are written is text
        ('x = f"{y，2}，{y：，.2f}："', 'x = f"{y,2}，{y:，.2f}："'),
        ('x = f"{ y【０】 ！r｝"', 'x = f"{ y[0] !r}"'),
        ('x = f"{{y，}} {y＋{1：2}[1]:{2＋3}}"', 'x = f"{{y，}} {y+{1:2}[1]:{2+3}}"'),
        ("x = f'{d[“好，”]，“（”}'", 'x = f\'{d["好，"],"（"}\''),
        ('x = f“{y，1}，{d["a，"]}”', "x = f'{y,1}，{d[\"a，\"]}'"),
        ('x = f"""\n{y，\n1}"""', 'x = f"""\n{y,\n1}"""'),
        # Traditional Chinese, Japanese
        ("x = 「完成，「好」」", 'x = "完成，「好」"'),
        ("x = 『完成』 ＋ ﹁好﹂ + 〝好〞", 'x = "完成" + "好" + "好"'),
        ("x = f「{y，1}：」", 'x = f"{y,1}："'),
        ("x = 「1、ー２」", "x = [1,-2]"),
        ("x = y「0」", "x = y[0]"),
        ("x = 1ー2 ー サーボ", "x = 1-2 - サーボ"),
        ("x = y〖0〗 ⁄ 2 ∗ 3 ‐ 1", "x = y[0] / 2 * 3 - 1"),
        ("——it = it——", "_it = it_"),
    ],
)
def test_signs_of_code_become_plain_ones(text, plain):
    problems = findings(text)
    assert problems
    assert {problem.code for problem in problems} == {"E001"}
    assert mended(text) == plain
    assert findings(plain) == ()


@pytest.mark.parametrize(
    "text",
    [
        'x = f"（{1}，{{，：}}「」"',
        "サーボ = ｘ = 1",
        "x = '（，）“”'  # “说”，：",
        'x = """\n　（\n"""',
        "x = r'“' f'{1}：'  # ＃",
        "ｘ１ = 1",
        "set＿x = 1",
        'x = "a”, “b"',
    ],
)
def test_texts_that_python_reads_are_left_alone(text):
    assert findings(text) == ()


def test_one_line_has_one_finding_at_its_first_sign():
    (one, two) = findings("f（1，2）\nf(3，4)")
    assert (one.line, one.column, two.line, two.column) == (1, 2, 2, 4)
    assert one.text == "`（` (U+FF08) is a full-width sign of an input method, not `(`"


def test_wide_indentation_is_one_finding():
    (one,) = findings("def job():\n　　x = 1\n　　y = 2\nend\n")
    assert (one.line, one.column) == (2, 1)
    assert one.text.startswith("2 lines are indented with full-width blanks (U+3000)")


def test_a_string_that_nothing_closes_has_no_repair_of_its_own():
    (one,) = findings("textmsg(“完成）")
    assert "not certain where its string ends" in one.text
    assert one.fix is None


@pytest.mark.parametrize(
    "text",
    [
        "x = “a\\”",
        "x = “'\"'''\"\"\"”",
        'x = “a" + "b”',
        "x = 「a」",
        "x = 「」",
        "x = 「1",
        "x = 1 —— 1",
        'x = "他说：“好”',
    ],
)
def test_what_is_not_certain_is_not_mended(text):
    assert findings(text)
    assert mended(text) == text


def planted(text: str, rng: random.Random) -> str:
    """The text with wide signs in its code; its strings and comments as they are, but for the quotation marks."""
    masked = lex(text).masked
    new = list(text)
    for at, sign in enumerate(masked):
        word = text[:at][-1:].isalnum() or text[:at][-1:] == "_"
        if text[at] == sign and sign in WIDE_OF and not (sign.isdigit() and word) and rng.random() < 0.3:
            new[at] = WIDE_OF[sign]
    return "".join(new)


@pytest.mark.parametrize("seed", range(60))
def test_planted_signs_are_mended_to_the_same_text(seed):
    rng = random.Random(seed)
    text = random_program(rng)
    wide = planted(text, rng)
    if wide != text:
        assert mended(wide) == text
        assert not compiles(wide)
    assert compiles(text)


@pytest.mark.parametrize("seed", range(30))
def test_strings_of_any_signs_in_wide_marks_keep_their_text(seed):
    rng = random.Random(seed)
    for _ in range(20):
        inside = "".join(rng.choice("好，。（）：；！a 1'‘’") for _ in range(rng.randrange(12)))
        comment = "".join(rng.choice("好，。（）“”‘’'\" ") for _ in range(rng.randrange(8)))
        text = f'x = [1, "{inside}"]  # {comment}\n'
        assert findings(text) == ()
        wide = text.replace('"', "“", 1).replace('"', "”", 1).replace("[", "【", 1)
        assert mended(wide) == text
        assert mended(f"y（1）；{text}") == f"y(1);{text}"


@pytest.mark.parametrize(
    "text",
    ["x" * 40_000 + "（", "ー" * 40_000, "x = [" + "“a”，" * 10_000, "“" + '" , ' * 10_000, '"”)' * 10_000]
    + ['f"' + field * 8_000 + '，"' for field in ("{x，", "{x:", "{x，}", "{x：{y}}")],
)
def test_a_long_line_takes_time_as_its_length(text):
    began = time.process_time()
    lex(text)
    assert time.process_time() - began < 2.0
