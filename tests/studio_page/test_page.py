"""What the page does: keys, panes, files and their conflicts, the link, languages, settings."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import expect

from tests.studio_page.conftest import NARROW, Open
from tests.studio_page.fake_source import PROGRAM, Play


def test_keys(open_page: Open) -> None:
    page, source = open_page()
    expect(page.locator(".state")).to_contain_text("finished")
    page.keyboard.press("]")
    source.wait("seek", lambda message: message["t"] == 1.0)
    page.keyboard.press(".")
    step = source.wait("step")
    assert (step["by"], step["thread"], step["t"]) == (1, "main", 1.0)
    page.keyboard.press("?")
    keys = page.get_by_role("complementary", name="Keys")
    expect(keys).to_contain_text("step back")
    page.keyboard.press("Escape")
    expect(keys).to_have_count(0)
    # In the editor the same keys are letters.
    page.get_by_role("textbox", name="Program text").click()
    page.keyboard.type("?.")
    assert "?." in source.wait("program", lambda message: "?." in message["text"])["text"]
    expect(keys).to_have_count(0)


def test_the_thread_that_is_chosen_is_stepped(open_page: Open) -> None:
    page, source = open_page()
    page.get_by_role("radio", name="Statements of watch").check()
    page.get_by_role("button", name="Step", exact=True).click()
    assert source.wait("step")["thread"] == "watch"


def test_panes_are_sized_by_keyboard_and_remembered(open_page: Open) -> None:
    page, source = open_page()
    divider = page.get_by_role("separator", name="Size of Program")
    program = page.get_by_role("region", name="Program")
    before = program.bounding_box()
    for _ in range(5):
        divider.press("ArrowRight")
    after = program.bounding_box()
    assert before is not None and after is not None
    assert after["width"] == pytest.approx(before["width"] + 0.1 * 1200, abs=2)
    # A slow page may send one of the sizes in between first.
    source.wait("settings", lambda message: message["values"].get("sizes") == {"left": 0.44})
    divider.dblclick()
    assert program.bounding_box() == before


def test_what_is_remembered_is_there_again(open_page: Open) -> None:
    play = Play()
    play.settings = {
        "language": "zh",
        "theme": "dark",
        "angle": "rad",
        "sizes": {"left": 0.5},
        "open": {"wide.cycle": False},
    }
    page, _ = open_page(play, locale="zh-CN")
    assert page.evaluate("document.documentElement.dataset.theme") == "dark"
    expect(page.get_by_role("button", name="运行", exact=True)).to_be_visible()
    expect(page.get_by_role("button", name="节拍时间")).to_have_attribute("aria-expanded", "false")


def test_language_and_colours_change_in_place(open_page: Open) -> None:
    page, source = open_page()
    page.get_by_role("button", name="Options").click()
    page.get_by_role("combobox", name="Colours").select_option("dark")
    assert page.evaluate("getComputedStyle(document.body).colorScheme") == "dark"
    page.get_by_role("combobox", name="Language").select_option("zh")
    expect(page.get_by_role("region", name="程序", exact=True)).to_be_visible()
    assert source.wait("settings", lambda message: message["values"].get("language") == "zh")


def test_options_are_typed_with_units(open_page: Open) -> None:
    page, source = open_page()
    page.get_by_role("button", name="Options").click()
    limit = page.get_by_role("textbox", name="Limit")
    limit.fill("2.5 min")
    limit.press("Enter")
    source.wait("program", lambda message: message["options"].get("until_s") == 150)
    limit.fill("soon")
    limit.press("Enter")
    expect(page.get_by_role("alert")).to_contain_text("not a number")
    limit.press("Escape")
    expect(limit).to_have_value("150 s")
    joints = page.get_by_role("textbox", name="Joints at the start")
    joints.fill("0, -90, 0, 0, 90, 0 deg")
    joints.press("Enter")
    given = source.wait("program", lambda message: "joints" in message["options"])["options"]["joints"]
    assert given == pytest.approx([0, -1.5707963, 0, 0, 1.5707963, 0])


def test_save_and_a_conflict(open_page: Open) -> None:
    page, source = open_page()
    page.get_by_role("textbox", name="Program text").click()
    page.keyboard.press("Control+Home")
    page.keyboard.type("# mine\n")
    assert page.title().startswith("●")
    source.play.refusal = {
        "type": "refused",
        "text": "changed",
        "conflict": {"text": f"# theirs\n{PROGRAM}", "digest": "other"},
    }
    page.keyboard.press("Control+s")
    conflict = page.get_by_role("complementary", name="Two texts of one file")
    expect(conflict).to_contain_text("\N{MINUS SIGN} # theirs")
    expect(conflict).to_contain_text("+ # mine")
    conflict.get_by_role("button", name="Keep the text here").click()
    expect(conflict).to_have_count(0)
    source.play.refusal = None
    page.get_by_role("button", name="Save").click()
    saved = source.wait("save", lambda message: message["seen"] == "other")
    assert saved["text"].startswith("# mine")
    expect(page).to_have_title(re.compile("^pick.script"))


def test_a_draft_is_shown_and_can_be_dropped(open_page: Open) -> None:
    play = Play()
    play.draft = {"text": "# a draft\n", "seen": "first", "at": "12:03"}
    page, source = open_page(play)
    expect(page.get_by_text("Text of 12:03 that was not saved is shown")).to_be_visible()
    page.get_by_role("button", name="Show the file").click()
    assert source.wait("program", lambda message: message["version"] > 1)["text"] == PROGRAM


def test_a_lost_link_comes_back_with_the_text(open_page: Open) -> None:
    page, source = open_page()
    expect(page.locator(".state")).to_contain_text("finished")
    source.lose()
    expect(page.get_by_role("alert")).to_contain_text("The link to the studio is lost")
    page.get_by_role("textbox", name="Program text").click()
    page.keyboard.press("Control+Home")
    page.keyboard.type("# typed meanwhile\n")
    source.forget()
    source.come_back()
    assert source.wait("program")["text"].startswith("# typed meanwhile\n")
    expect(page.get_by_text("The link to the studio is lost")).to_have_count(0)
    expect(page.get_by_role("textbox", name="Program text")).to_contain_text("# typed meanwhile")


def test_connections_are_allowed_by_a_button(open_page: Open) -> None:
    play = Play()
    play.ended = {"state": "finished", "refused_connections": ["camera at 10.0.0.5:5000"]}
    page, source = open_page(play)
    expect(page.get_by_role("region", name="Problems")).to_contain_text("no connection to camera at 10.0.0.5:5000")
    page.get_by_role("button", name="Allow connections").click()
    source.wait("program", lambda message: message["options"].get("may_connect") is True)
    page.get_by_role("button", name="Allow connections").click()
    source.wait("program", lambda message: message["version"] > 2 and "may_connect" not in message["options"])


def test_buttons_stay_at_the_top_of_a_narrow_window(open_page: Open) -> None:
    page, _ = open_page(size=NARROW)
    page.evaluate("scrollTo(0, document.body.scrollHeight)")
    box = page.get_by_role("button", name="Run", exact=True).bounding_box()
    assert box is not None and 0 <= box["y"] < 50
    page.get_by_role("button", name="Cycle time").click()
    expect(page.get_by_role("region", name="Cycle time")).to_contain_text("50.0 %")


def test_an_empty_program_is_a_beginning(open_page: Open) -> None:
    play = Play()
    page, source = open_page(play)
    expect(page.locator(".state")).to_contain_text("finished")
    version = source.wait("program")["version"]
    page.get_by_role("textbox", name="Program text").click()
    page.keyboard.press("Control+A")
    play.empties = True
    page.keyboard.press("Delete")
    source.wait("program", lambda message: message["version"] > version and message["text"] == "")
    expect(page.locator(".state")).to_have_text(re.compile("no program yet"))
    expect(page.get_by_role("region", name="Problems")).to_contain_text("There is no program yet to check.")
    expect(page.get_by_role("region", name="Time line", exact=True)).to_contain_text("No run yet")
    begin = page.get_by_role("group", name="No program yet. Three ways to begin:")
    expect(begin).to_contain_text("Example: First moves")
    expect(begin).to_contain_text("elitescript studio FOLDER")
    play.empties = False
    begin.get_by_role("button", name="Write: ").click()
    source.wait("program", lambda message: message["text"].startswith("def program():"))
    expect(page.locator(".state")).to_contain_text("finished")
    expect(begin).to_have_count(0)
