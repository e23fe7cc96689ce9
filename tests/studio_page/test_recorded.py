"""The page of a recorded run, opened as a file: no server, no request, no script but its own."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest

from elitescript.cli.main import main
from elitescript.robot import VirtualRobot

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

PROGRAM: Final = """def job():
  global n
  n = 1
  movej([0.3, -1.5, -1.5, -1.6, 1.5, 0])
  set_standard_digital_out(2, True)
  n = 2
  textmsg("</script><b id='bold'>\\ud800 <!-- \\u2028")
  movej([0.0, -1.5, -1.5, -1.6, 1.5, 0])
end
"""

Make = Callable[..., "Page"]


@pytest.fixture
def show(context: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Page]:
    """Plot programs and open the page; whatever it asks for beside itself fails the test."""
    monkeypatch.chdir(tmp_path)

    def opened(*words: str, text: str = PROGRAM, **options: object) -> Page:
        (tmp_path / "job.script").write_text(text)
        main(["plot", "job.script", *words])
        page = context(**options)
        asked: list[str] = []
        page.on("request", lambda request: asked.append(request.url))
        page.goto((tmp_path / "job.plot.html").as_uri())
        page.get_by_role("region", name="Robot").wait_for()
        page.get_by_role("slider", name="Time").wait_for()
        assert [url for url in asked if not url.startswith("data:")] == [(tmp_path / "job.plot.html").as_uri()]
        return page

    return opened


def joints(page: Page) -> list[float]:
    return [float(q) for q in page.get_by_role("region", name="Robot").get_attribute("data-joints").split(",")]  # type: ignore[union-attr]


def test_it_shows_what_the_trace_has(show: Callable[..., Page]) -> None:
    from playwright.sync_api import expect

    page = show()
    slider = page.get_by_role("slider", name="Time")
    trace = VirtualRobot().run(PROGRAM, trace=True).trace
    slider.focus()
    for _ in range(10):
        slider.press("ArrowRight")
    page.wait_for_function("document.querySelector('[data-time=\"0.04\"]')")
    (row,) = [row for row in trace if abs(row.t - 0.04) < 1e-9]
    assert joints(page) == pytest.approx(row.q, abs=1e-6)
    variables = page.get_by_role("region", name="Variables")
    expect(variables.get_by_role("row", name="n 1 int")).to_be_visible()
    slider.press("End")
    page.wait_for_function("Math.abs(document.querySelector('[data-joints]').dataset.joints.split(',')[0]) < 1e-6")
    assert joints(page) == pytest.approx(trace[-1].q, abs=1e-6)
    expect(variables.get_by_role("row", name="n 2 int")).to_be_visible()
    assert "main" in page.get_by_role("region", name="Threads").inner_text()


def test_texts_are_texts_and_read_only(show: Callable[..., Page]) -> None:
    page = show()
    assert "</script><b id='bold'>" in page.get_by_role("region", name="Messages").inner_text()
    assert page.locator("#bold").count() == 0
    editor = page.get_by_role("textbox", name="Program text")
    assert editor.get_attribute("aria-readonly") == "true"
    assert page.get_by_role("button", name="Save", exact=True).count() == 0


def test_an_alarm_is_where_it_opens(show: Callable[..., Page]) -> None:
    page = show(text="movej([0.3, -1.5, -1.5, -1.6, 1.5, 0])\nmovel([3, 0, 0.3, 3.14, 0, 0])\n")
    page.wait_for_function("Number(document.querySelector('[data-time]').dataset.time) > 0.1")
    assert "line 2" in page.get_by_role("region", name="Problems").inner_text()


def test_two_arms_over_each_other(show: Callable[..., Page]) -> None:
    page = show("--compare-robot", "CS612")
    page.get_by_role("button", name="Compare", exact=True).click()
    panel = page.get_by_role("complementary", name="Compare runs")
    assert "job.script · CS612" in panel.inner_text()
    panel.get_by_role("combobox", name="Align by").select_option("visit")
    table = page.get_by_role("region", name="Cycle time")
    assert "difference" in table.inner_text()
    panel.get_by_role("button", name="End comparison").click()
    assert "difference" not in table.inner_text()


def test_no_script_of_another_runs_in_it(browser: Browser, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "job.script").write_text(PROGRAM)
    main(["plot", "job.script"])
    page = browser.new_page()
    page.goto((tmp_path / "job.plot.html").as_uri())
    page.get_by_role("slider", name="Time").wait_for()
    refused = page.evaluate(
        """() => new Promise((resolve) => {
          document.addEventListener("securitypolicyviolation", (event) => resolve(event.effectiveDirective));
          const script = document.createElement("script");
          script.textContent = "document.title = 'taken'";
          document.body.append(script);
        })"""
    )
    assert refused == "script-src-elem"
    assert page.title() != "taken"
    page.close()


def test_a_browser_that_cannot_unpack_says_so(context: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "job.script").write_text(PROGRAM)
    main(["plot", "job.script"])
    page = context()
    page.add_init_script("delete window.DecompressionStream")
    page.goto((tmp_path / "job.plot.html").as_uri())
    page.get_by_text("This browser cannot show the page: it needs Chrome").wait_for()
    assert json.dumps(page.locator("#page").inner_text()).count("Firefox") == 1
