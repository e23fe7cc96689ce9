"""What axe-core finds in the page: nothing serious, light and dark, wide and narrow, in both languages."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page

from tests.studio_page.conftest import AXE, NARROW, Open
from tests.studio_page.fake_source import Play, problem

RULES = (
    "{resultTypes: ['violations'], runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice']}"
)


@pytest.mark.parametrize(("scheme", "locale"), [("light", "en-US"), ("dark", "zh-CN")], ids=["light-en", "dark-zh"])
def test_axe_finds_nothing_serious(open_page: Open, scheme: str, locale: str) -> None:
    play = Play()
    play.problems = [problem(8, 5, fix="s")]
    play.contacts = [
        {"start_s": 1.0, "end_s": 1.2, "line": 6, "first": "wrist 2", "second": "box", "distance_m": -0.004, "t": 1.1}
        | {"is_contact": True},
    ]
    page, source = open_page(play, color_scheme=scheme, locale=locale)
    # The program has findings, so its end does not look good.
    page.locator(".dot.warning, .dot.error").wait_for()
    assert page.evaluate("document.documentElement.lang") == locale[:2]
    assert page.evaluate("document.documentElement.dataset.theme") == scheme
    source.say({"type": "notice", "severity": "warning", "text": "a notice"})
    # What the browser evaluates for a test is not bound by the policy of the page.
    page.evaluate(AXE.read_text())
    _expect_nothing_serious(page)

    page.set_viewport_size({"width": NARROW[0], "height": NARROW[1]})
    page.get_by_role("textbox", name="Program text" if locale == "en-US" else "程序文本").focus()
    page.keyboard.type("# mine")
    source.say({"type": "file_changed", "name": "pick.script", "text": play.text + "# more\n", "digest": "other"})
    page.locator(".conflict").wait_for()
    _expect_nothing_serious(page)


def _expect_nothing_serious(page: Page) -> None:
    """Open all that is closed, and let axe look at it."""
    while (closed := page.locator("button[aria-expanded=false]")).count():
        closed.first.click()
    found = page.evaluate(f"axe.run(document, {RULES})")["violations"]
    serious = [
        f"{rule['id']}: {rule['help']}: {node['html'][:200]} {node.get('failureSummary', '')[:300]}"
        for rule in found
        if rule["impact"] in {"serious", "critical"}
        for node in rule["nodes"]
    ]
    assert serious == []
