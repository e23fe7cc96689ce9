"""The page in Chinese: no sentence of ours stays English, wherever it comes from."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

import pytest
from playwright.sync_api import expect

from elitescript.conversation.describe import notice
from tests.studio_page.conftest import Open
from tests.studio_page.fake_source import Play

TEXT: Final = Path(__file__).parents[2] / "web" / "src" / "text"
VALUE: Final = r'"((?:[^"\\]|\\.)*)"'


def english() -> list[str]:
    """Return the parts between the values of all sentences of the page, and of those that sources say, in English."""
    own = re.findall(rf"^  \w+: {VALUE}", (TEXT / "en.ts").read_text(encoding="utf-8"), re.MULTILINE)
    of_sources = re.findall(rf"^  \[{VALUE}, ", (TEXT / "said.ts").read_text(encoding="utf-8"), re.MULTILINE)
    assert len(own) > 300
    assert len(of_sources) > 100
    parts = [part.strip(" .,:;") for text in (*own, *of_sources) for part in re.split(r"\{\w+\}", text)]
    return sorted({part for part in parts if len(re.findall(r"[A-Za-z]{2,}", part)) >= 2})


@pytest.mark.parametrize("mode", ["run", "empty", "alarm"])
def test_no_sentence_of_ours_is_english(open_page: Open, mode: str) -> None:
    play = Play()
    play.empties = mode == "empty"
    if mode == "alarm":
        play.ended = {
            "state": "killed",
            "killed": "line 4 does not return: the run was ended after 0.7 s in which no time went by",
        }
    page, source = open_page(play, locale="zh-CN", size=(1440, 900))
    source.wait("program")
    source.say(notice("warning", "the process that starts runs had ended and was started again"))
    expect(page.locator(".notice")).to_contain_text("启动运行的进程曾结束")
    if mode == "run":
        expect(page.get_by_role("region", name="线程", exact=True)).to_contain_text("其运动结束，直到 2.500 s")  # noqa: RUF001
        expect(page.get_by_role("region", name="线程", exact=True)).to_contain_text("套接字 'plc' 上的数据")
        expect(page.get_by_role("region", name="时间线", exact=True)).to_contain_text("套接字 plc")
        page.get_by_text(re.compile("^事件表")).click()
        expect(page.get_by_role("table").filter(has_text="套接字 plc")).to_contain_text(
            "套接字 plc 打开: 192.168.1.5:5000"
        )
    if mode == "empty":
        expect(page.locator(".program-empty")).to_contain_text("有三种方式开始")
    if mode == "alarm":
        expect(page.locator(".state")).to_contain_text("第 4 行不返回")
    labels = "[...document.querySelectorAll('[aria-label], [title], [placeholder]')].flatMap((e) => "
    labels += "[e.ariaLabel, e.title, e.placeholder]).filter(Boolean)"
    shown = [page.locator("body").inner_text(), *page.evaluate(labels)]
    allowed = (play.text, "elitescript studio")
    assert [
        part for part in english() if any(part in text for text in shown) and not any(part in text for text in allowed)
    ] == []


def test_the_parts_of_the_editor_are_chinese(open_page: Open) -> None:
    page, _ = open_page(locale="zh-CN")
    page.locator(".cm-content").click()
    page.keyboard.press("Control+f")
    panel = page.locator(".cm-search")
    panel.wait_for()
    shown = panel.inner_text() + "".join(
        page.locator(".cm-search input").evaluate_all("e => e.map((f) => f.placeholder)")
    )
    assert "查找" in shown
    assert not re.search(r"[A-Za-z]", shown)
