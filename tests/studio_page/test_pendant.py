"""The pendant: what is there with and without control, holding to move, message windows, teaching."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.studio_page.conftest import AXE, NARROW, WIDE, Open
from tests.studio_page.fake_source import FakeSource, Message, Play, moment
from tests.studio_page.test_access import RULES

CONTROLS = ("Power on", "Power off", "Release brakes", "Play", "Unlock", "Emergency stop", "Freedrive", "Teach point")
STATE: dict[str, Any] = {
    "link": "connected",
    "address": "10.0.0.7:30001",
    "model": "CS66",
    "firmware": "2.14.0.0",
    "serial": "1",
    "robot_mode": "RUNNING",
    "safety_mode": "NORMAL",
    "task_state": "STOPPED",
    "program": "pick.task",
    "speed_fraction": 0.5,
    "operation_mode": "remote",
}


class Connected(Play):
    """A controller as a source; what the page asks for is done, but for `refusals`, by action."""

    def __init__(self, *more: str) -> None:
        super().__init__()
        self.mode = "connected"
        self.abilities = ["live", "services", "edit", "save", *more]
        self.refusals: dict[str, str] = {}

    def first(self) -> list[Message]:
        began = {"type": "run_began", "run": 1, "version": 0, "same_until_s": 0.0, "options": {}}
        return [*super().first(), began, state()]

    def run(self) -> Iterable[Message | bytes]:
        return ()

    def answer(self, message: dict[str, Any]) -> Iterable[Message | bytes]:
        if message["type"] not in {"control", "speed", "load", "send_program", "fault"}:
            yield from super().answer(message)
        elif text := self.refusals.get(message.get("action", "")):
            yield {"type": "refused", "ask": message["ask"], "text": text}
        else:
            yield {"type": "done", "ask": message["ask"]}


def state(t: float = 1.0, **changes: Any) -> Message:
    return {"type": "moment", "moment": moment(t), "controller": {**STATE, **changes}}


def connected(open_page: Open, *abilities: str, **options: Any) -> tuple[Page, FakeSource]:
    page, source = open_page(Connected(*abilities), **options)
    page.locator(".pendant-state").wait_for()
    return page, source


def button(page: Page, name: str) -> Any:
    return page.get_by_role("button", name=name, exact=True)


def sent(source: FakeSource, *kinds: str) -> list[dict[str, Any]]:
    return [message for message in source.heard if message["type"] in kinds]


def test_without_control_it_only_shows(open_page: Open) -> None:
    page, source = connected(open_page)
    for name in CONTROLS:
        expect(button(page, name)).to_have_count(0)
    pendant = page.get_by_role("region", name="Pendant", exact=True)
    expect(pendant).to_contain_text("running")
    expect(pendant).to_contain_text("Start it with --control")
    expect(page.locator(".target")).to_contain_text("CS66 · 10.0.0.7:30001")
    expect(page).to_have_title(re.compile("^pick.script . CS66 · 10.0.0.7:30001 "))
    source.say(state(link="lost"))
    expect(pendant).to_contain_text("No connection to 10.0.0.7:30001")
    expect(page.locator(".target")).to_contain_text("lost")


def test_buttons(open_page: Open) -> None:
    page, source = connected(open_page, "control")
    source.play.refusals["play"] = "power on first"  # type: ignore[attr-defined]
    for name, action in (
        ("Power on", "power_on"),
        ("Power off", "power_off"),
        ("Release brakes", "release_brakes"),
        ("Unlock", "unlock"),
        ("Emergency stop", "emergency_stop"),
        ("Pause", "pause"),
        ("Stop", "stop"),
        ("Play", "play"),
    ):
        button(page, name).click()
        source.wait("control", lambda message, action=action: message["action"] == action)
    expect(page.locator(".notice")).to_contain_text("power on first")
    description = re.compile("Not a safety function: use the red button")
    expect(button(page, "Emergency stop")).to_have_accessible_description(description)
    expect(button(page, "Open safeguard")).to_have_count(0)
    page.get_by_role("slider", name="Speed of programs").fill("25")
    assert source.wait("speed")["fraction"] == 0.25
    slider = page.get_by_role("slider", name="Speed of programs")
    box = slider.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    source.say(state(2.0, speed_fraction=0.5, program="other.task"))
    expect(page.get_by_label("Loaded program: type another one to load it")).to_have_value("other.task")
    expect(slider).to_have_value("0")
    page.mouse.up()
    assert source.wait("speed", lambda message: message["fraction"] < 0.25)["fraction"] == 0
    button(page, "Send the text").click()
    assert source.wait("send_program")["text"].startswith("# Pick")


def test_a_robot_of_this_computer_has_faults(open_page: Open) -> None:
    page, source = connected(open_page, "control", "signals", "faults")
    page.get_by_text("Faults").click()
    button(page, "Open safeguard").click()
    source.wait("control", lambda message: message["action"] == "safeguard_open")
    source.say(state(safety_mode="ROBOT_EMERGENCY_STOP"))
    expect(button(page, "Emergency stop")).to_have_attribute("aria-pressed", "true")
    button(page, "Release button").click()
    source.wait("control", lambda message: message["action"] == "emergency_stop_release")


def held(source: FakeSource) -> None:
    """Wait until a jog was repeated."""
    source.wait("jog", lambda _: len(sent(source, "jog")) >= 3)


def released(page: Page, source: FakeSource) -> list[dict[str, Any]]:
    """Wait for the end of a jog, which is the last word; return the jogs before it."""
    source.wait("jog_end")
    page.wait_for_timeout(200)
    *jogs, end = sent(source, "jog", "jog_end")
    source.forget()
    assert end == {"type": "jog_end"}
    return jogs


def test_holding(open_page: Open) -> None:
    page, source = connected(open_page, "control")
    plus = button(page, "Jog joint 3 plus")
    plus.hover()
    page.mouse.down()
    held(source)
    expect(plus).to_have_attribute("aria-pressed", "true")
    page.mouse.move(5, 5)
    page.mouse.up()
    expected = {"type": "jog", "frame": "joint", "axis": 2, "direction": 1, "speed": 0.3}
    assert all(jog == expected for jog in released(page, source))
    expect(plus).to_have_attribute("aria-pressed", "false")
    plus.hover()
    page.mouse.down()
    held(source)
    page.mouse.down(button="right")
    page.mouse.up()
    released(page, source)
    page.mouse.up(button="right")
    page.get_by_role("radio", name="tool").check()
    for key in ("Space", "Enter"):
        button(page, "Jog Z minus").focus()
        page.keyboard.down(key)
        held(source)
        page.keyboard.up(key)
        expected = {"type": "jog", "frame": "tool", "axis": 2, "direction": -1, "speed": 0.3}
        assert all(jog == expected for jog in released(page, source))


def test_a_release_that_is_lost(open_page: Open) -> None:
    page, source = connected(open_page, "control")
    minus = button(page, "Jog joint 1 minus")
    for lose in (
        "document.activeElement.blur()",
        "window.dispatchEvent(new Event('blur'))",
        "window.dispatchEvent(new Event('pagehide'))",
    ):
        minus.focus()
        page.keyboard.down("Space")
        held(source)
        page.evaluate(lose)
        released(page, source)
        page.keyboard.up("Space")
    minus.focus()
    page.keyboard.down("Space")
    held(source)
    source.lose()
    expect(minus).to_have_attribute("aria-pressed", "false")
    source.forget()
    source.come_back()
    source.wait("program")
    page.wait_for_timeout(200)
    assert sent(source, "jog") == []


def test_a_window_of_the_robot_and_a_taught_point(open_page: Open) -> None:
    page, source = connected(open_page, "control")
    popup = {"title": "Part?", "text": "<img src=x onerror=alert(1)> go on?", "level": "warning", "id": 1}
    source.say(state(popup=popup, task_state="PLAYING"))
    window = page.get_by_role("alertdialog", name="Part?")
    expect(window).to_contain_text("<img src=x onerror=alert(1)> go on?")
    assert page.locator("img").count() == 0
    window.get_by_role("button", name="Continue").click()
    source.wait("control", lambda message: message["action"] == "close_popup")
    window.get_by_role("button", name="End the program").click()
    source.wait("control", lambda message: message["action"] == "stop")
    source.say(state())
    expect(window).to_have_count(0)
    page.get_by_role("textbox", name="Program text").click()
    page.keyboard.press("Control+End")
    source.say(state(2.0))
    expect(page.locator(".jog-axis output").first).to_have_text("40.11")
    button(page, "Teach point").click()
    line = "movej([0.7, -1.38894, 1.5708, -1.61241, -1.5708, 0.2])"
    assert source.wait("program", lambda message: line in message["text"])


@pytest.mark.parametrize(
    ("size", "scheme", "locale"),
    [(WIDE, "light", "en-US"), (NARROW, "dark", "zh-CN")],
    ids=["wide-light-en", "narrow-dark-zh"],
)
def test_axe_finds_nothing_serious(open_page: Open, size: tuple[int, int], scheme: str, locale: str) -> None:
    page, source = connected(open_page, "control", "signals", "faults", size=size, color_scheme=scheme, locale=locale)
    popup = {"title": "Part?", "text": "go on?", "level": "error", "id": 1}
    source.say(state(popup=popup, task_state="PAUSED", safety_mode="ROBOT_EMERGENCY_STOP", robot_mode="POWER_OFF"))
    page.get_by_role("alertdialog").wait_for()
    page.locator(".pendant-faults summary").click()
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), "the page scrolls sideways"
    page.evaluate(AXE.read_text())
    found = page.evaluate(f"axe.run(document.querySelector('.pendant'), {RULES})")["violations"]
    serious = [
        f"{rule['id']}: {rule['help']}: {node['html'][:200]}"
        for rule in found
        if rule["impact"] in {"serious", "critical"}
        for node in rule["nodes"]
    ]
    assert serious == []
