"""The page of `elitescript studio` itself: programs are typed, run, stepped, stopped and saved."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from elitescript import VirtualRobot
from tests.studio.page_client import studio

PROGRAM = """\
global count
movej([0.1, -1.2, 1.2, -1.5, -1.57, 0.2])
count = 1
sleep(0.5)
movej([0.4, -1.2, 1.2, -1.5, -1.57, 0.2])
textmsg("there")
"""


def test_a_program_from_text_to_file(context: Callable[..., Page], tmp_path: Path) -> None:
    file = tmp_path / "move.script"
    file.write_text(PROGRAM)
    with studio(file, state=tmp_path / "state") as address:
        page = context()
        page.goto(address)
        state, robot = page.locator(".state"), page.get_by_role("region", name="Robot")
        problems = page.get_by_role("region", name="Problems")
        text = page.get_by_role("textbox", name="Program text")
        expect(state).to_contain_text("finished")
        expect(page.locator(".cm-bar.ran")).not_to_have_count(0)

        text.click()
        page.keyboard.press("Control+End")
        page.keyboard.type("sleep 0.25")
        expect(problems).to_contain_text(re.compile(r"line 7, column \d+: error E"))
        expect(state).to_contain_text("before line 7")
        for _ in range(5):
            page.keyboard.press("Backspace")
        page.keyboard.type("(0.25")
        expect(problems).to_contain_text(re.compile(r"No problems\. \d\d+ rules were checked\."))
        expect(state).to_contain_text("finished")
        typed = f"{PROGRAM}sleep(0.25)"
        assert file.read_text() == PROGRAM

        ran = VirtualRobot().run(typed)
        page.get_by_role("slider", name="Time").press("End")
        expect(robot).to_have_attribute("data-time", re.compile(rf"^{ran.time_s:.3f}0*$"))
        shown = [float(number) for number in (robot.get_attribute("data-joints") or "").split(",")]
        assert shown == pytest.approx(ran.joints, abs=1e-6)
        expect(page.get_by_role("region", name="Variables")).to_contain_text("count")

        # A comment costs no new run: its lines move, and what it wrote is there once.
        text.focus()
        page.keyboard.press("Control+Home")
        page.keyboard.type("# once\n")
        typed = f"# once\n{typed}"
        rows = page.get_by_role("region", name="Messages").get_by_role("listitem")
        expect(rows).to_have_count(1)
        expect(rows).to_contain_text("line 7")

        page.get_by_role("button", name="Stop", exact=True).click()
        expect(robot).to_have_attribute("data-time", "0")
        for _ in range(2):
            page.get_by_role("button", name="Step", exact=True).click()
        expect(page.get_by_role("region", name="Threads")).to_contain_text(re.compile(r"main\s*[345]"))

        page.get_by_role("button", name="Save").click()
        expect(page).to_have_title(re.compile("^move.script"))
        assert file.read_text().rstrip("\n") == typed


def test_the_first_click_into_an_empty_program_writes_and_does_not_take_an_example(
    context: Callable[..., Page], tmp_path: Path
) -> None:
    with studio(tmp_path / "new.script", state=tmp_path / "state") as address:
        page = context()
        page.goto(address)
        text, program = page.get_by_role("textbox", name="Program text"), page.get_by_role("region", name="Program")
        expect(program.get_by_role("listitem")).to_have_count(5)
        text.click()
        page.keyboard.type("sleep(0.5)")
        expect(program.get_by_role("listitem")).to_have_count(0)
        expect(page.locator(".state")).to_contain_text("finished in 0.5")


def test_a_program_typed_with_its_own_indentation_and_ends_is_that_program(
    context: Callable[..., Page], tmp_path: Path
) -> None:
    program = "def a():\n  b = [\n    0,\n  ]\n  for c in b:\n    sleep(0.1)\n  end\nend\n"
    file = tmp_path / "typed.script"
    with studio(file, state=tmp_path / "state") as address:
        page = context()
        page.goto(address)
        page.get_by_role("textbox", name="Program text").click()
        page.keyboard.type(program)
        expect(page.locator(".state")).to_contain_text("finished")
        page.get_by_role("button", name="Save").click()
        expect(page).to_have_title(re.compile("^typed.script"))
        assert file.read_text().rstrip() == program.rstrip()


def test_undo_stays_in_the_file_that_was_opened(context: Callable[..., Page], tmp_path: Path) -> None:
    for name in ("first", "second"):
        (tmp_path / f"{name}.script").write_text(f"textmsg('{name}')\n")
    with studio(tmp_path, state=tmp_path / "state") as address:
        page = context()
        page.goto(address)
        text = page.get_by_role("textbox", name="Program text")
        expect(text).to_contain_text("first")
        page.get_by_label("File name").fill("second.script")
        page.keyboard.press("Enter")
        expect(text).to_contain_text("second")
        text.click()
        page.keyboard.press("ControlOrMeta+z")
        page.keyboard.press("Control+Home")
        page.keyboard.type("# ")
        expect(text).to_contain_text("# textmsg('second')")
        expect(page).to_have_title(re.compile("second.script"))
