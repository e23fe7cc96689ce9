"""Runs over each other in the studio, and the run as one file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Page, expect

from tests.studio.page_client import studio

PROGRAM = "movej([0.1, -1.2, 1.2, -1.5, -1.57, 0.2])\nsleep(0.5)\n"


def test_versions_files_and_the_page_of_a_run(context: Callable[..., Page], tmp_path: Path) -> None:
    (tmp_path / "move.script").write_text(PROGRAM)
    with studio(tmp_path / "move.script", state=tmp_path / "state") as address:
        page = context()
        page.goto(address)
        state = page.locator(".state")
        expect(state).to_contain_text("finished")
        page.get_by_role("textbox", name="Program text").click()
        page.keyboard.press("Control+Home")
        page.keyboard.type("sleep(1.25)\n")
        expect(page.get_by_role("region", name="Cycle time")).to_contain_text("1.25")

        page.get_by_role("button", name="Compare", exact=True).click()
        panel = page.get_by_role("complementary", name="Compare runs")
        panel.get_by_role("button", name="Last saved version").click()
        expect(panel).to_contain_text("1.252 s longer")
        expect(page.get_by_role("region", name="Cycle time")).to_contain_text("+1.25")
        panel.get_by_role("combobox", name="Align by").select_option("visit")

        with page.expect_download() as saved:
            page.get_by_role("button", name="Export page").click()
        file = tmp_path / saved.value.suggested_filename
        assert file.name == "move.plot.html"
        saved.value.save_as(file)
        panel.get_by_label("File …").set_input_files(file)
        expect(panel).to_contain_text("same time")

        (tmp_path / "no.html").write_text("<p>")
        panel.get_by_label("File …").set_input_files(tmp_path / "no.html")
        expect(page.get_by_text("no.html is not compared")).to_be_visible()
    page.goto(file.as_uri())
    expect(page.locator(".state")).to_contain_text("finished")
