"""The time line: the slider and its keys, the field, what the pointer and the tools do, and the events as a table."""

from __future__ import annotations

import re

from playwright.sync_api import expect

from tests.studio_page.conftest import Open


def test_slider_and_field(open_page: Open) -> None:
    page, source = open_page()
    slider = page.get_by_role("slider", name="Time", exact=True)
    expect(slider).to_have_attribute("aria-valuemin", "0")
    expect(slider).to_have_attribute("aria-valuemax", "4")
    slider.focus()
    for key, shown in (
        ("End", "4.000 s, line 11"),
        ("Home", "0.000 s, line 4"),
        ("ArrowRight", "0.004 s, line 4"),
        ("PageUp", "1.004 s, line 6"),
        ("ArrowLeft", "1.000 s, line 6"),
        ("]", "2.000 s, line 8"),
        ("[", "1.000 s, line 6"),
    ):
        page.keyboard.press(key)
        expect(slider).to_have_attribute("aria-valuetext", shown)
    assert source.wait("seek", lambda message: message["t"] == 1.0)
    field = page.get_by_role("textbox", name="Time in seconds")
    field.fill("2500 ms")
    field.press("Enter")
    expect(slider).to_have_attribute("aria-valuenow", "2.5")
    field.fill("soon")
    field.press("Enter")
    expect(field).to_have_attribute("aria-invalid", "true")
    field.press("Escape")
    expect(field).to_have_value("2.500 s")
    expect(
        page.get_by_role("img", name=re.compile(r"^Signals, 2\.500 s\. standard_digital_out\[0\]: 1"))
    ).to_be_visible()


def test_pointer_zoom_and_table(open_page: Open) -> None:
    page, source = open_page()
    expect(page.locator(".state")).to_contain_text("finished")
    slider = page.get_by_role("slider", name="Time", exact=True)
    timeline = page.get_by_role("region", name="Time line", exact=True)
    # With all lanes the places in it do not move any more.
    page.get_by_role("img", name=re.compile(r"^Signals, 0\.000 s")).wait_for()
    box = timeline.get_by_role("img", name=re.compile("^Lines of the threads")).bounding_box()
    assert box is not None
    # The canvas is 8 px wider than the run on both sides.
    x, y = box["x"] + 8 + (box["width"] - 16) * 2.2 / 4, box["y"] + 12
    page.mouse.move(x, y)
    expect(timeline.locator(".hover-time")).to_have_text(re.compile(r"2\.(19|20)\d s"))
    expect(timeline.locator(".timeline-tip")).to_contain_text("line 8  sleep(0.5)")
    expect(slider).to_have_attribute("aria-valuenow", "0")
    page.mouse.click(x, y)
    expect(slider).to_have_attribute("aria-valuetext", re.compile(r"2\.(196|200|204) s, line 8"))
    page.mouse.dblclick(x, y)
    asked = source.wait("detail")
    assert asked["from_s"] <= 2.0
    assert asked["to_s"] >= 2.5
    timeline.get_by_role("button", name="Show all").click()
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 200, y, steps=3)
    page.mouse.up()
    timeline.get_by_role("button", name="Loop the selected stretch").click()
    expect(timeline.get_by_role("button", name="Loop the selected stretch")).to_have_attribute("aria-pressed", "true")
    timeline.get_by_text(re.compile("^Events as a table")).click()
    rows = timeline.get_by_role("table").get_by_role("row")
    expect(rows).to_have_count(1 + 6 + 3)
    expect(rows.nth(9)).to_contain_text("<img src=x")
    rows.get_by_role("button", name="2.500 s").last.click()
    expect(slider).to_have_attribute("aria-valuenow", "2.5")
