"""Take the pictures of docs/tutorials/studio.md and of the README again: `make studio-pictures`.

The texts are those of the page, typed key by key into `elitescript studio` in a headless Chromium, as the page tells
its reader to do it. So a step that does not work any more ends the tool.
"""

from __future__ import annotations

import re
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Final

from tools import browser
from tools.plot_picture import reduced
from tools.studio_picture import REST_MS, ROOT, WAIT_MS, studio

if TYPE_CHECKING:
    from playwright.sync_api import Page

TUTORIAL: Final = ROOT / "docs" / "tutorials" / "studio.md"
IMAGES: Final = ROOT / "docs" / "images"
SIZE: Final = {"width": 1280, "height": 730}
PICTURE_MAX: Final = 120_000
"""Size of a picture, bytes."""
BLOCK: Final = re.compile(r'^```\w+ title="([^"]+)"[^\n]*\n(.*?)^```$', re.MULTILINE | re.DOTALL)

CONTACT: Final = "gripper and fence touch"
NO_PROBLEMS: Final = "No problems."


def main() -> int:
    """Write the pictures; return 0, 1 if one is too large, or 2 if there is no browser."""
    if browser.found() is None:
        print(browser.NOT_FOUND, file=sys.stderr)
        return 2
    from playwright.sync_api import sync_playwright

    texts: dict[str, str] = dict(BLOCK.findall(TUTORIAL.read_text(encoding="utf-8")))
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        home = Path(folder)
        (home / "cell.toml").write_text(texts["cell.toml"])
        chromium = browser.started(driver)
        with studio(home / "pallet.script", "--world", str(home / "cell.toml")) as address:
            page = chromium.new_page(viewport=SIZE, color_scheme="light", locale="en-US", reduced_motion="reduce")
            page.set_default_timeout(WAIT_MS)
            page.goto(address)
            page.locator(".dot.good, .dot.warning").first.wait_for()
            large = [name for name, step in STEPS.items() if _take(page, name, step, texts["pallet.script"])]
        chromium.close()
    return 1 if large else 0


def _take(page: Page, name: str, step: Callable[[Page, str], None], text: str) -> bool:
    """Do a step and take its picture; return whether the picture is too large."""
    step(page, text)
    page.wait_for_timeout(REST_MS)
    path = IMAGES / f"studio-{name}.png"
    path.write_bytes(reduced(page.screenshot()))
    size = path.stat().st_size
    print(f"{path.relative_to(ROOT)}: {size / 1000:.0f} kB")
    return size > PICTURE_MAX


def empty(page: Page, text: str) -> None:
    """Show the page without a program."""
    page.get_by_role("region", name="Program", exact=True).get_by_role("listitem").first.wait_for()


def completion(page: Page, text: str) -> None:
    """Type the beginning of a command."""
    page.get_by_role("textbox", name="Program text").click()
    page.keyboard.type("def pallet():\n  set_t", delay=30)
    page.locator(".cm-completionInfo").wait_for()


def contact(page: Page, text: str) -> None:
    """Type the program, and drag time to where the gripper is deep in the fence."""
    page.keyboard.press("Escape")
    page.keyboard.press("Control+A")
    page.keyboard.press("Delete")
    page.keyboard.type(text)
    problems = page.get_by_role("region", name="Problems", exact=True)
    problems.get_by_text(CONTACT).first.wait_for()
    field = page.get_by_role("textbox", name="Time in seconds")
    field.fill("3.05")
    field.press("Enter")
    # Where line 16 is, in the text; the exact state of that time has come.
    problems.get_by_text(CONTACT).first.scroll_into_view_if_needed()
    page.get_by_role("region", name="Variables", exact=True).get_by_text("boxes").wait_for()


def mended(page: Page, text: str) -> None:
    """Type a larger approach height."""
    _replace(page, "0.06  ", "0.12  ")
    page.get_by_role("region", name="Problems", exact=True).get_by_text(NO_PROBLEMS).wait_for()


def alarm(page: Page, text: str) -> None:
    """Type a place out of reach, and look at the alarm."""
    _replace(page, "[0.36", "[0.86")
    page.get_by_role("region", name="Problems", exact=True).get_by_text("alarm").first.click()


STEPS: Final[dict[str, Callable[[Page, str], None]]] = {
    step.__name__: step for step in (empty, completion, contact, mended, alarm)
}


def _replace(page: Page, old: str, new: str) -> None:
    """Replace a text with the search of the editor."""
    page.get_by_role("textbox", name="Program text").press("Control+F")
    panel = page.locator(".cm-search")
    panel.get_by_role("textbox", name="Find").fill(old)
    panel.get_by_role("textbox", name="Replace").fill(new)
    panel.get_by_role("button", name="replace all").click()
    page.keyboard.press("Escape")


if __name__ == "__main__":
    raise SystemExit(main())
