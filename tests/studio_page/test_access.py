"""What axe-core finds in the page: nothing serious, light and dark, wide and narrow, in both languages."""

from __future__ import annotations

import pytest

from tests.studio_page.conftest import AXE, NARROW, WIDE, Open
from tests.studio_page.fake_source import Play, problem

RULES = "{resultTypes: ['violations'], runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice']}"


@pytest.mark.parametrize(
    ("size", "scheme", "locale"),
    [(WIDE, "light", "en-US"), (WIDE, "dark", "zh-CN"), (NARROW, "dark", "en-US"), (NARROW, "light", "zh-CN")],
    ids=["wide-light-en", "wide-dark-zh", "narrow-dark-en", "narrow-light-zh"],
)
def test_axe_finds_nothing_serious(open_page: Open, size: tuple[int, int], scheme: str, locale: str) -> None:
    play = Play()
    play.problems = [problem(8, 5, fix="s")]
    play.contacts = [
        {"start_s": 1.0, "end_s": 1.2, "line": 6, "first": "wrist 2", "second": "box", "distance_m": -0.004, "t": 1.1}
        | {"is_contact": True},
    ]
    page, source = open_page(play, size, color_scheme=scheme, locale=locale)
    page.locator(".dot.good").wait_for()
    assert page.evaluate("document.documentElement.lang") == locale[:2]
    assert page.evaluate("document.documentElement.dataset.theme") == scheme
    source.say({"type": "notice", "severity": "warning", "text": "a notice"})
    source.say({"type": "file_changed", "name": "pick.script", "text": play.text + "# more\n", "digest": "other"})
    page.locator(".notice").first.wait_for()
    while (closed := page.locator("button[aria-expanded=false]")).count():
        closed.first.click()
    # The policy of the page lets no other script in; what the browser evaluates itself is not of the page.
    page.evaluate(AXE.read_text())
    found = page.evaluate(f"axe.run(document, {RULES})")["violations"]
    serious = [
        f"{rule['id']}: {rule['help']}: {node['html'][:200]} {node.get('failureSummary', '')[:300]}"
        for rule in found
        if rule["impact"] in {"serious", "critical"}
        for node in rule["nodes"]
    ]
    assert serious == []
