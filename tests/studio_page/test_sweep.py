"""The page of a sweep, opened as a file: no server, no request, no script but its own."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from elitescript.sweep.plans.plan import Plan, Row
from elitescript.sweep.results.page import PageTexts, Replay, sweep_page
from elitescript.sweep.results.summary import summary_of
from tests.studio_page.conftest import AXE, NARROW, WIDE
from tests.sweep.made import BOX, row, swept

if TYPE_CHECKING:
    from playwright.sync_api import Page

EVIL = "<img src=x onerror=alert(1)>"


def written(path: Path) -> Path:
    """Write the page of 300 runs, some of which fail in one corner."""

    def made(run: int, v: dict[str, Any], _: object) -> Row:
        bad = v["part_x"] > 0.5 and v["part_y"] < 0.0
        return row(run, v, "always(ok)" if bad else "", 10.0 - v["part_x"], line=12, text=EVIL, margins=(0.5,))

    totals = swept(300, made)
    first = next(iter(totals.groups.values())).rows[0].choices.run
    texts = PageTexts(
        "cell.script",
        "elitescript sweep cell.script",
        stories={first: ["The part lies too far away.", EVIL]},
        run_command="elitescript sweep cell.script --only {run}",
        replays={first: Replay(f"sweep.replays/run-{first}.html")},
        smallest={first: Replay(f"sweep.replays/run-{first}-smallest.html", "elitescript run --case CASE.toml")},
    )
    path.write_text(sweep_page(Plan("", variations=BOX), totals, summary_of(totals), texts), encoding="utf-8")
    return path


def test_a_failing_run_is_found_and_leads_to_its_replay(context: Callable[..., Page], tmp_path: Path) -> None:
    from playwright.sync_api import expect

    file = written(tmp_path / "sweep.html")
    page = context(WIDE)
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(file.as_uri())
    failures = page.get_by_role("region", name="Failures")
    expect(failures).to_contain_text("always(ok) in line 12")
    expect(failures).to_contain_text(EVIL)
    expect(failures).to_contain_text("with part_x > ")
    expect(failures.get_by_role("link", name="Replay of the smallest")).to_have_count(1)
    expect(failures).to_contain_text("elitescript run --case CASE.toml")
    link = failures.get_by_role("link").last
    assert (link.get_attribute("href") or "").startswith("sweep.replays/run-")
    run = page.get_by_role("region", name="Run", exact=True)
    run.get_by_role("button", name="Next failure").press("Enter")
    expect(run).to_contain_text("always(ok) in line 12")
    expect(run.get_by_role("link", name="Open the replay")).to_have_attribute("href", link.get_attribute("href") or "")
    expect(run).to_contain_text("elitescript sweep cell.script --only ")
    run.get_by_label("Show the run of a number").fill("4000")
    run.get_by_label("Show the run of a number").press("Enter")
    expect(run).to_contain_text("Run 4000 is not among the rows")
    # A click into the corner where runs fail chooses one of them.
    scatter = page.get_by_role("region", name="Two quantities")
    over = scatter.locator(".u-over")
    box = over.bounding_box()
    assert box is not None
    over.click(position={"x": box["width"] * 0.85, "y": box["height"] * 0.75})
    expect(run).to_contain_text("always(ok) in line 12")
    scatter.get_by_label("Up").select_option(label="time, s")
    expect(scatter.get_by_role("img")).to_have_attribute(
        "aria-label", f"time, s over part_x: 300 runs, {sum_failed(page)} of them fail"
    )
    page.evaluate(AXE.read_text())
    wrong = page.evaluate("async () => (await axe.run()).violations.map(({id, nodes}) => id + ' ' + nodes[0].html)")
    assert wrong == []
    assert [url for url in asked if not url.startswith("data:")] == [file.as_uri()]
    assert page.evaluate("document.images.length") == 0


def sum_failed(page: Page) -> str:
    """Return the number of failing runs in the head of the page."""
    return page.locator(".numbers dd.error").inner_text()


def test_it_is_narrow_dark_and_chinese(context: Callable[..., Page], tmp_path: Path) -> None:
    page = context(NARROW, locale="zh-CN", color_scheme="dark")
    page.goto(written(tmp_path / "sweep.html").as_uri())
    page.get_by_role("region", name="失败").wait_for()
    assert page.evaluate("document.documentElement.dataset.theme") == "dark"
    assert page.evaluate("document.documentElement.scrollWidth") <= NARROW[0]
    page.evaluate(AXE.read_text())
    wrong = page.evaluate("async () => (await axe.run()).violations.map(({id, nodes}) => id + ' ' + nodes[0].html)")
    assert wrong == []
    page.get_by_role("button", name="English").click()
    page.get_by_role("region", name="Failures").wait_for()
