"""What a browser makes of the studio's port: the page of a tab can be loaded again, another tab is refused."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from elitescript import page
from elitescript.studio.outbox import Outbox
from elitescript.studio.server import Door

if TYPE_CHECKING:
    from playwright.sync_api import Browser

HTML = (
    '<!doctype html><meta charset=utf-8><link rel="icon" href="data:,"><script type="module" src="studio.js"></script>'
)
CODE = """
const token = new URLSearchParams(location.search).get("token");
history.replaceState(null, "", location.pathname);
sessionStorage.setItem("elitescript-token", token);
const socket = new WebSocket(`ws://${location.host}/socket?token=${token}`);
socket.onmessage = ({ data }) => { document.body.textContent = data; };
"""


class Greeting:
    """A conversation that only begins."""

    async def take(self, text: str | bytes) -> None:
        pass

    async def close(self) -> None:
        pass


@contextmanager
def opened(door: Door) -> Iterator[None]:
    """Open a door in another thread: this one belongs to Playwright's loop."""
    is_open, loop, end = threading.Event(), asyncio.new_event_loop(), asyncio.Event()

    async def serve() -> None:
        await door.open(0)
        is_open.set()
        await end.wait()
        await door.close()

    thread = threading.Thread(target=loop.run_until_complete, args=(serve(),))
    thread.start()
    try:
        assert is_open.wait(10.0)
        yield
    finally:
        loop.call_soon_threadsafe(end.set)
        thread.join()
        loop.close()


async def greet(outbox: Outbox) -> Greeting:
    outbox.put({"type": "hello"})
    return Greeting()


def test_the_page_of_a_tab_can_be_loaded_again(browser: Browser, tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "studio.html").write_text(HTML)
    (tmp_path / "studio.js").write_text(CODE)
    monkeypatch.setattr(page, "_BUILT", tmp_path)
    door = Door(greet)
    with opened(door):
        tab, other = browser.new_page(), browser.new_page()
        address = f"http://127.0.0.1:{door.port}/"
        tab.goto(door.ticket_address())
        for _ in range(2):
            tab.get_by_text('{"type":"hello"}').wait_for()
            assert tab.url == address
            tab.reload()
        answer = other.goto(address)
        assert answer is not None and answer.status == 403
        assert "open the address that `elitescript studio` has printed" in other.inner_text("body")
        tab.close()
        other.close()
