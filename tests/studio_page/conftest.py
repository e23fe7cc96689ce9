"""A browser for the tests of the page: one for all of them, a fresh context for each page.

Without Chromium, Playwright or the built page these tests are skipped, or fail where ELITESCRIPT_BROWSER is `required`.
"""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NoReturn

import pytest

from elitescript import page as built
from tests.studio_page.fake_source import FakeSource, Play
from tools import browser as chromium

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

WIDE: Final = (1200, 720)
NARROW: Final = (400, 800)
"""Sizes of the window; small ones, as pictures in software cost time."""

WAIT_MS: Final = 15_000

Open = Callable[..., "tuple[Page, FakeSource]"]


def _missing() -> str:
    if chromium.found() is None:
        return chromium.NOT_FOUND
    try:
        import playwright.sync_api  # noqa: F401
    except ImportError:
        return "no Playwright: make .venv/.browser-ready"
    return "" if built.is_built() else built.NOT_BUILT


class _Unavailable(pytest.Module):
    """A module of these tests where they cannot run; it imports what is missing."""

    def collect(self) -> NoReturn:
        if os.environ.get("ELITESCRIPT_BROWSER") == "required":
            pytest.fail(_missing(), pytrace=False)
        pytest.skip(_missing(), allow_module_level=True)


def pytest_pycollect_makemodule(module_path: Path, parent: pytest.Collector) -> pytest.Module | None:
    """Collect nothing of these tests where they cannot run."""
    return _Unavailable.from_parent(parent, path=module_path) if _missing() else None


class Loan:
    """The browser of all tests, for a while.

    Its loop counts as running between the calls of Playwright. Other tests run loops of their own in this thread, so
    that is so for the while alone.
    """

    def __init__(self, browser: Browser) -> None:
        self._browser = browser
        self._loop = asyncio.get_running_loop()

    @contextmanager
    def of_browser(self) -> Iterator[Browser]:
        """Lend it."""
        asyncio._set_running_loop(self._loop)
        try:
            yield self._browser
        finally:
            asyncio._set_running_loop(None)


@pytest.fixture(scope="session")
def loan() -> Iterator[Loan]:
    """Start a browser; it ends with the last test."""
    from playwright.sync_api import expect, sync_playwright

    # Assertions have their own limit, a shorter one: a busy computer opens a page more slowly than that.
    expect.set_options(timeout=WAIT_MS)
    with ExitStack() as stack:
        driver = stack.enter_context(sync_playwright())
        browser = chromium.started(driver)
        loan = Loan(browser)
        asyncio._set_running_loop(None)
        yield loan
        # Its end belongs to the loop too.
        with loan.of_browser():
            browser.close()
            stack.close()


@pytest.fixture
def browser(loan: Loan) -> Iterator[Browser]:
    """Lend the browser to one test."""
    with loan.of_browser() as browser:
        yield browser


@pytest.fixture
def context(browser: Browser) -> Iterator[Callable[..., Page]]:
    """Make pages of a size, with what `new_context` takes; a message on the console or an exception fails the test."""
    with ExitStack() as stack:

        def make(size: tuple[int, int] = WIDE, **options: Any) -> Page:
            given = {"locale": "en-US", "color_scheme": "light", "reduced_motion": "reduce", **options}
            context = browser.new_context(viewport={"width": size[0], "height": size[1]}, **given)
            stack.callback(context.close)
            page = context.new_page()
            page.set_default_timeout(WAIT_MS)
            wrong: list[str] = []
            page.on("pageerror", lambda error: wrong.append(str(error)))
            page.on("console", lambda said: wrong.append(said.text) if said.type in {"error", "warning"} else None)
            stack.callback(lambda: _expect_nothing(wrong))
            return page

        yield make


def _expect_nothing(wrong: list[str]) -> None:
    # A link that a test cuts, and the software that draws, are said to the console by the browser itself.
    left = [
        text
        for text in wrong
        if not any(part in text for part in ("WebSocket connection", "GPU stall", "WEBGL_lose_context", "swiftshader"))
    ]
    assert left == []


@pytest.fixture
def open_page(context: Callable[..., Page]) -> Iterator[Open]:
    """Open pages of fake sources, and wait until the first run has ended."""
    with ExitStack() as stack:

        def make(play: Play | None = None, size: tuple[int, int] = WIDE, **options: Any) -> tuple[Page, FakeSource]:
            source = stack.enter_context(FakeSource(play or Play()))
            page = context(size, **options)
            page.goto(source.address)
            page.get_by_role("region", name="Robot" if options.get("locale", "en")[:2] == "en" else "机器人").wait_for()
            return page, source

        yield make


AXE: Final = Path(__file__).parents[2] / "web" / "node_modules" / "axe-core" / "axe.min.js"
