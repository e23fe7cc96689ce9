"""The page by its accessible names: regions, buttons, what lists show, and that every row is a place in time."""

from __future__ import annotations

import re

from playwright.sync_api import Locator, Page, expect

from tests.studio_page.conftest import NARROW, Open
from tests.studio_page.fake_source import Play, problem

REGIONS = ("Program", "Robot", "Time line", "Problems", "Messages", "Signals", "Variables", "Threads", "Cycle time")
BUTTONS = ("Run", "Pause", "Step", "Step back", "Stop", "Save")


def region(page: Page, name: str) -> Locator:
    """Return a region by its exact name."""
    return page.get_by_role("region", name=name, exact=True)


def test_names_in_every_size(open_page: Open) -> None:
    page, _ = open_page()
    for size in ((1200, 720), (900, 800), NARROW):
        page.set_viewport_size({"width": size[0], "height": size[1]})
        for name in REGIONS:
            expect(region(page, name)).to_be_visible()
            assert page.get_by_role("region", name=name).count() == 1, f"another region is called like {name}"
        for name in BUTTONS:
            expect(page.get_by_role("button", name=name, exact=True)).to_be_visible()
            found = page.get_by_role("button", name=name).count()
            # Whoever looks for "Step" without saying exactly that finds "Step back" too; no other name gets in the way.
            assert found == (2 if name == "Step" else 1), f"another button is called like {name}"
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), "the page scrolls sideways"


def test_lists_of_a_run(open_page: Open) -> None:
    page, source = open_page()
    expect(page.locator(".state")).to_contain_text("finished in 4.0 s")
    expect(region(page, "Problems")).to_contain_text("No problems.")
    expect(region(page, "Messages")).to_contain_text("part 1")
    expect(region(page, "Variables")).to_contain_text("limit_mm")
    expect(region(page, "Threads").get_by_role("radio", name="Statements of watch")).to_be_visible()
    expect(region(page, "Signals")).to_contain_text("standard_digital_in[3]")
    cycle = region(page, "Cycle time").get_by_role("row")
    expect(cycle.nth(1)).to_contain_text("50.0 %")
    assert page.title() == "pick.script \N{EN DASH} elitescript studio"
    assert source.wait("program")["text"].startswith("# Pick")


def test_a_message_is_text_and_a_place_in_time(open_page: Open) -> None:
    page, source = open_page()
    row = region(page, "Messages").get_by_role("button", name=re.compile("<img src=x"))
    expect(row).to_be_visible()
    assert page.locator("img").count() == 0
    region(page, "Messages").get_by_role("button", name=re.compile("part 1")).click()
    assert source.wait("seek", lambda message: message["t"] == 2.0)
    expect(region(page, "Signals").get_by_role("row", name=re.compile(r"standard_digital_out\[0\]"))).to_contain_text(
        "1"
    )


def test_kinds_of_messages(open_page: Open) -> None:
    page, _ = open_page()
    messages = region(page, "Messages")
    messages.get_by_role("button", name="print", exact=True).click()
    expect(messages).not_to_contain_text("part 1")
    expect(messages).to_contain_text("begin")


def test_problems_and_their_fix(open_page: Open) -> None:
    play = Play()
    play.problems = [problem(8, 5, fix="pause")]
    play.compiles = False
    page, source = open_page(play)
    problems = region(page, "Problems")
    expect(problems).to_contain_text("line 8, column 5: error E304: sleep: unexpected argument")
    expect(problems).to_contain_text("take it out")
    expect(page.locator(".state")).to_contain_text("does not compile")
    play.problems, play.compiles = [], True
    problems.get_by_role("button", name="Fix", exact=True).click()
    assert "    pauseleep(0.5)" in source.wait("program", lambda message: message["version"] > 1)["text"]
    expect(problems).to_contain_text("No problems.")
    assert not re.search(r"line \d|\d+:\d+", problems.inner_text())


def test_an_alarm_says_where_and_the_limit(open_page: Open) -> None:
    play = Play()
    alarm = {"t": 3.2, "line": 6, "column": 5, "code": "R310", "text": "joint 3 is out of range", "hints": ["lower it"]}
    play.ended = {"state": "alarm", "alarm": {**alarm, "limit": "q: 3.2 rad, allowed 3.05 rad"}}
    play.contacts = [
        {"start_s": 1.0, "end_s": 1.2, "line": 6, "first": "wrist 2", "second": "box", "distance_m": -0.004, "t": 1.1}
        | {"is_contact": True},
    ]
    page, source = open_page(play)
    problems = region(page, "Problems")
    expect(page.locator(".state")).to_contain_text("alarm at 3.2 s, line 6")
    expect(problems).to_contain_text("line 6, column 5: alarm R310 at 3.200 s: joint 3 is out of range")
    expect(problems).to_contain_text("allowed 3.05 rad")
    expect(problems).to_contain_text("line 6: wrist 2 and box touch at 1.000 s, 4.0 mm deep")
    problems.get_by_role("button", name=re.compile("alarm R310")).click()
    assert source.wait("seek", lambda message: message["t"] == 3.2)


def test_a_signal_points_at_the_change_behind_its_value(open_page: Open) -> None:
    page, _ = open_page()
    signals = region(page, "Signals")
    signals.get_by_role("button", name="standard_digital_out").first.hover()
    expect(page.locator(".cm-outlined")).to_have_count(1)
    expect(page.locator(".hover-line")).to_be_visible()
    expect(signals.get_by_role("columnheader")).to_have_count(2)
    page.mouse.move(0, 0)
    expect(page.locator(".cm-outlined")).to_have_count(0)


def test_inputs_are_a_schedule_with_undo(open_page: Open) -> None:
    page, source = open_page()
    signals = region(page, "Signals")
    signals.get_by_label("Set an input").fill("standard_analog_in[1]")
    page.keyboard.press("Enter")
    signals.get_by_role("textbox", name="standard_analog_in[1]").fill("4.2 V")
    page.keyboard.press("Enter")
    given = source.wait("program", lambda message: bool(message["options"].get("inputs")))["options"]["inputs"]
    assert given == [{"name": "standard_analog_in[1]", "value": 4.2, "at_s": 0}]
    signals.get_by_role("switch", name="standard_digital_in[3]").click()
    chips = signals.get_by_role("list", name="Inputs that are set").get_by_role("listitem")
    expect(chips).to_have_count(2)
    source.forget()
    signals.get_by_role("button", name=re.compile(r"Remove standard_analog_in\[1\]")).click()
    expect(chips).to_have_count(1)
    assert [row["name"] for row in source.wait("program")["options"]["inputs"]] == ["standard_digital_in[3]"]
    page.locator("body").press("Control+z")
    expect(chips).to_have_count(2)
    signals.get_by_role("textbox", name="standard_analog_in[1]").fill("40")
    page.keyboard.press("Enter")
    expect(signals.get_by_role("alert")).to_contain_text("from 0 to 10")


def test_long_lists_are_windows(open_page: Open) -> None:
    page, source = open_page()
    expect(page.locator(".state")).to_contain_text("finished")
    many = [{"type": "print", "t": 4.0, "text": f"row {index}", "line": 11} for index in range(20_000)]
    source.say({"type": "events", "run": 1, "list": many})
    messages = region(page, "Messages")
    expect(messages.get_by_role("listitem").first).to_have_attribute("aria-setsize", "20004")
    messages.get_by_role("group", name="Rows of messages").press("End")
    expect(messages.get_by_role("button", name=re.compile("row 19999"))).to_be_focused()
    assert messages.get_by_role("listitem").count() <= 200
    page.keyboard.press("ArrowUp")
    expect(messages.get_by_role("button", name=re.compile("row 19998"))).to_be_focused()
