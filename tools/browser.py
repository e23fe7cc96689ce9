"""Find and start a Chromium: for pictures, and for the tests of the page. `CHROMIUM=...` names another one."""

from __future__ import annotations

import os
import shutil
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Playwright

NAMES: Final = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
NOT_FOUND: Final = f"no browser found ({', '.join(NAMES)}): install Chromium, or name one: CHROMIUM=/path/to/chromium"

_ARGUMENTS: Final = (
    "--no-sandbox",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--disable-quic",
)
"""WebGL in software, and nothing that reaches out of this computer."""


def found() -> str | None:
    """Return the path of a browser; None if there is none."""
    return os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)


def started(driver: Playwright) -> Browser:
    """Start the browser that `found` finds, without a window."""
    return driver.chromium.launch(executable_path=found(), args=list(_ARGUMENTS))
