"""Take pictures of the studio in its states, wide and narrow, light and dark: `python -m tools.studio_picture`.

The pages are those of `elitescript studio` itself, shown by a headless Chromium through Playwright
(`make .venv/.browser-ready`). Each state is what a person would do: keys, clicks, typed text.

    python -m tools.studio_picture --folder /tmp/pictures
    python -m tools.studio_picture --state alarm --size narrow --theme dark
    python -m tools.studio_picture --file examples/camera_picking.script --state middle
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Final

from tools import browser

if TYPE_CHECKING:
    from playwright.sync_api import Page

ROOT = Path(__file__).resolve().parent.parent
EXAMPLE: Final = ROOT / "examples" / "pick_and_place.script"
SIZES: Final = {"wide": (1440, 900), "medium": (900, 800), "narrow": (400, 800)}
THEMES: Final = ("light", "dark")
WAIT_MS: Final = 30_000
REST_MS: Final = 700
"""Until what was asked for is drawn."""

ALARM: Final = "\nmovej([0, -1.57, 7.5, -1.57, -1.57, 0])\n"
"""Ends a run with a target out of reach of joint 3."""


def begin(page: Page) -> None:
    """Show the program as it is opened."""


def middle(page: Page) -> None:
    """Show the middle of the run."""
    slider = page.get_by_role("slider", name="Time", exact=True)
    slider.press("Home")
    for _ in range(20):
        slider.press("PageUp")


def end(page: Page) -> None:
    """Show the end of the run."""
    page.get_by_role("slider", name="Time", exact=True).press("End")


def error(page: Page) -> None:
    """Type something that does not compile."""
    _type(page, "\nsleep 0.5\n")
    page.locator(".problems-list").wait_for()


def alarm(page: Page) -> None:
    """Type a move that ends in an alarm, and look at it."""
    _type(page, ALARM)
    page.get_by_role("region", name="Problems").get_by_role("button").first.click()


def keys(page: Page) -> None:
    """Show the list of keys, and the options."""
    page.get_by_role("button", name="Options", exact=True).click()
    page.get_by_role("button", name="Keys", exact=True).click()


def inputs(page: Page) -> None:
    """Set two inputs."""
    field = page.get_by_label("Set an input: type its name")
    if not field.is_visible():
        page.get_by_role("button", name="Signals", exact=True).click()
    for name in ("standard_digital_in[0]", "standard_analog_in[1]"):
        field.fill(name)
        field.press("Enter")
    page.get_by_role("switch", name="standard_digital_in[0]").click()


def chinese(page: Page) -> None:
    """Speak Chinese."""
    page.get_by_role("button", name="Options", exact=True).click()
    page.get_by_role("combobox", name="Language").select_option("zh")


STATES: Final[dict[str, Callable[[Page], None]]] = {
    state.__name__: state for state in (begin, middle, end, error, alarm, keys, inputs, chinese)
}


def main(words: list[str] | None = None) -> int:
    """Write the pictures; return 0, or 2 with a message if there is no browser."""
    parser = argparse.ArgumentParser(prog="studio_picture", description="Take pictures of the studio in its states.")
    parser.add_argument("--file", type=Path, default=EXAMPLE, help="program to show")
    parser.add_argument("--folder", type=Path, default=Path("pictures"), help="where to write them")
    parser.add_argument("--state", choices=sorted(STATES), action="append", help="only these states")
    parser.add_argument("--size", choices=sorted(SIZES), action="append", help="only these sizes")
    parser.add_argument("--theme", choices=THEMES, action="append", help="only these themes")
    given = parser.parse_args(words)
    if browser.found() is None:
        print(browser.NOT_FOUND, file=sys.stderr)
        return 2
    from playwright.sync_api import sync_playwright

    given.folder.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as driver:
        chromium = browser.started(driver)
        for state in given.state or STATES:
            for size in given.size or ("wide", "narrow"):
                for theme in given.theme or THEMES:
                    width, height = SIZES[size]
                    look = {"viewport": {"width": width, "height": height}, "color_scheme": theme, "locale": "en-US"}
                    with studio(given.file) as address:
                        context = chromium.new_context(**look, reduced_motion="reduce")
                        page = context.new_page()
                        page.set_default_timeout(WAIT_MS)
                        page.goto(address)
                        page.locator(".dot.good, .dot.error, .dot.warning").first.wait_for()
                        STATES[state](page)
                        page.wait_for_timeout(REST_MS)
                        page.screenshot(path=given.folder / f"{state}-{size}-{theme}.png")
                        context.close()
        chromium.close()
    return 0


def _type(page: Page, text: str) -> None:
    page.get_by_role("textbox", name="Program text").click()
    page.keyboard.press("Control+End")
    page.keyboard.type(text)
    page.wait_for_timeout(REST_MS)


@contextmanager
def studio(file: Path, *words: str) -> Iterator[str]:
    """Start the studio with nothing remembered; yield its address."""
    with tempfile.TemporaryDirectory() as state:
        started = subprocess.Popen(
            [sys.executable, "-m", "elitescript", "studio", str(file), "--no-browser", *words],
            env={**os.environ, "XDG_STATE_HOME": state},
            stdout=subprocess.PIPE,
            text=True,
        )
        try:
            assert started.stdout is not None
            yield started.stdout.readline().split(" ", 1)[1].strip()
        finally:
            started.terminate()
            started.wait()


if __name__ == "__main__":
    raise SystemExit(main())
