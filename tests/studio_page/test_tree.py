"""A graphical program in the page: its tree beside its script, linked with text and time, by accessible names."""

from __future__ import annotations

from typing import Any

from playwright.sync_api import Locator, Page, expect

from tests.studio_page.conftest import AXE, Open
from tests.studio_page.fake_source import Play, problem
from tests.studio_page.test_access import RULES

WIDE = (1300, 860)


def row(level: int, kind: str, name: str = "", summary: str = "", *, suppressed: bool = False) -> dict[str, Any]:
    return {"level": level, "kind": kind, "name": name, "summary": summary, "is_suppressed": suppressed}


def task() -> Play:
    """Return a program of eight nodes; its run is at the lines 4 and 6, and the other threads in line 9."""
    play = Play()
    lines = [0, 0, 0, 4, 3, 5, 5, 6, 8, 8, 2]
    places = ["", "1 Variables", "2 Main", "2 Main > 3 MoveJ", "3 MoveJ > 4 A", "3 MoveJ > 5 B", "2 Main > 6 Set"]
    play.text = "\n".join(f"line_{number}()" for number in range(1, len(lines) + 1))
    play.tree = {
        "rows": [
            row(0, "Initial variables"),
            row(0, "Main task", "", "once"),
            row(1, "MoveJ"),
            row(2, "Waypoint", "A", "joints [1, 2]"),
            row(2, "Waypoint", "B"),
            row(1, "Set", "", "digital_out[0] = high"),
            row(1, "Halt", "", "suppressed", suppressed=True),
            row(1, "Wait", "", "0.5 s"),
        ],
        "lines": lines,
        "places": [*places, "2 Main > 7 Halt", "2 Main > 8 Wait"],
    }
    play.marks = [(0.0, 2), (0.0, 3), (0.0, 4), (1.0, 5), (2.5, 5)]
    return play


def node(page: Page, name: str) -> Locator:
    return page.get_by_role("treeitem", name=name)


def now(page: Page) -> str | None:
    return page.get_by_role("region", name="Robot", exact=True).get_attribute("data-time")


def test_the_tree_is_linked_with_text_time_and_findings(open_page: Open) -> None:
    play = task()
    play.problems = [problem(8, 1)]
    page, source = open_page(play, size=WIDE)
    tree = page.get_by_role("tree", name="Program tree")
    expect(tree).to_be_visible()
    text = page.get_by_role("textbox", name="Program text")
    expect(text).to_be_visible()
    expect(text).to_have_attribute("aria-readonly", "true")
    expect(page.get_by_text("Read-only: the tree is the source.")).to_be_visible()
    expect(page.get_by_role("button", name="Save", exact=True)).to_be_disabled()
    # What never ran, what is suppressed, and what cannot run at all.
    expect(node(page, "8 Wait")).to_contain_text("not run")
    expect(tree.get_by_text("not run", exact=True)).to_have_count(1)
    # A finding stands at its node, and names it in its row.
    expect(page.get_by_role("region", name="Problems")).to_contain_text("2 Main > 6 Set: ")
    expect(page.get_by_role("region", name="Problems")).to_contain_text("(script line 8)")
    expect(node(page, "6 Set").locator(".tree-finding")).to_have_count(1)

    # A click shows the lines and the time; the next one goes to the next begin.
    node(page, "5 Waypoint B").click()
    expect(page.locator(".cm-node-line")).to_have_count(2)
    expect(page.locator(".cm-node-line").first).to_have_text("line_6()")
    assert now(page) == "1"
    expect(node(page, "5 Waypoint B")).to_have_attribute("aria-selected", "true")
    expect(node(page, "5 Waypoint B")).to_have_attribute("aria-current", "true")
    node(page, "5 Waypoint B").click()
    assert now(page) == "2.5"

    # The keyboard goes through the tree without moving the time; Enter does.
    tree.focus()
    for key in ("Home", "ArrowDown", "ArrowDown"):
        page.keyboard.press(key)
    expect(node(page, "3 MoveJ")).to_have_attribute("aria-selected", "true")
    assert now(page) == "2.5"
    page.keyboard.press("ArrowLeft")
    expect(node(page, "3 MoveJ")).to_have_attribute("aria-expanded", "false")
    expect(node(page, "5 Waypoint B")).to_have_count(0)
    # What runs in it is marked where it is folded.
    expect(node(page, "3 MoveJ")).to_have_attribute("aria-current", "true")
    for key in ("ArrowRight", "ArrowRight", "Enter"):
        page.keyboard.press(key)
    expect(node(page, "4 Waypoint A")).to_have_attribute("aria-selected", "true")
    assert now(page) == "0"

    # A place in the text leads to its node.
    page.get_by_text("line_10()").click()
    expect(node(page, "8 Wait")).to_have_attribute("aria-selected", "true")

    page.evaluate(AXE.read_text())
    found = page.evaluate(f"axe.run(document.querySelector('.region.program'), {RULES})")
    assert [rule["id"] for rule in found["violations"] if rule["impact"] in ("serious", "critical")] == []

    page.get_by_role("tab", name="Text").click()
    expect(tree).to_have_count(0)
    expect(text).to_be_visible()
    page.get_by_role("tab", name="Tree").click()
    expect(text).to_be_hidden()

    # Another tool breaks the file: the page says where.
    play.compiles = False
    play.problems = [problem(3, 7)]
    broken = {"rows": [], "lines": [], "places": [""]}
    source.say({"type": "file_changed", "name": "pick.script", "text": "<a>\n<b>\n</a>", "digest": "b", "tree": broken})
    region = page.get_by_role("group", name="pick.script cannot be read as a task")
    expect(region).to_contain_text("line 3, column 7")


def test_long_trees_have_few_rows_in_the_document(open_page: Open) -> None:
    play = task()
    rows = [row(0, "Main task"), *(row(1, "Waypoint", f"P{number}") for number in range(2, 5001))]
    play.tree = {"rows": rows, "lines": [0] * 11, "places": [""]}
    page, _ = open_page(play, size=(400, 800), locale="zh-CN")
    tree = page.get_by_role("tree", name="程序树")
    expect(tree).to_be_visible()
    expect(page.get_by_role("textbox", name="程序文本")).to_have_count(0)
    tree.focus()
    page.keyboard.press("End")
    expect(page.get_by_role("treeitem", name="5000 路点 P5000")).to_have_attribute("aria-posinset", "4999")
    assert page.get_by_role("treeitem").count() < 60
    page.get_by_role("textbox", name="查找节点").fill("P777")
    page.keyboard.press("Enter")
    expect(page.get_by_role("treeitem", name="777 路点 P777", exact=True)).to_have_attribute("aria-selected", "true")
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), "the page scrolls sideways"
