"""A studio that is killed while texts come: what was typed is there again, whole, and nothing else is left behind."""

from __future__ import annotations

import os
import random
import signal
from pathlib import Path
from time import monotonic, sleep

import pytest

from tests.studio.page_client import Page, process

pytestmark = [pytest.mark.slow, pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")]

KILLS = 10
SETTLED_S = 3.0
"""A text that stood so long is kept."""


def typed(number: int, length: int) -> str:
    """Return a text that says which one it is at both ends."""
    return f"# {number}\n" + "sleep(0.004)\n" * length + f"# {number}\n"


def text_of(path: Path) -> str:
    """Return what a file holds; nothing if it was removed meanwhile."""
    try:
        return path.read_text()
    except FileNotFoundError:
        return ""


def children_of(pid: int) -> list[int]:
    listed = Path(f"/proc/{pid}/task/{pid}/children")
    return [int(child) for child in listed.read_text().split()] if listed.exists() else []


@pytest.mark.timeout(600)
def test_a_draft_survives_kills_at_any_moment(tmp_path: Path) -> None:
    program, state = tmp_path / "a.script", tmp_path / "state"
    program.write_text("sleep(1)\n")
    draw = random.Random(5)
    newest = 0
    for kill in range(KILLS):
        with process(program, state=state) as (started, address), Page(address) as page:
            opened = page.wait("file")
            assert opened["text"] == "sleep(1)\n", "the file itself is never written"
            if kill:
                draft = opened["draft"]["text"]
                found = int(draft.split("\n", 1)[0].removeprefix("# "))
                assert draft == typed(found, len(draft.splitlines()) - 2), "half a text"
                assert found >= newest, "an older text than was kept"
            first = (newest + 1000) // 1000 * 1000
            page.send("program", version=1, text=typed(first, 10))
            end = monotonic() + SETTLED_S
            # Until the text is kept: then the next ones may be lost, this one not.
            while not any(f"# {first}\\n" in text_of(path) for path in state.rglob("*.json")):
                assert monotonic() < end + 20
                sleep(0.02)
            newest = first
            for number in range(1, draw.randrange(1, 40)):
                page.send("program", version=1 + number, text=typed(first + number, draw.randrange(1, 3000)))
                sleep(draw.uniform(0, 0.05))
            workers = children_of(started.pid)
            os.kill(started.pid, signal.SIGKILL)
            started.wait()
        for worker in workers:
            end = monotonic() + 10
            while Path(f"/proc/{worker}").exists() and monotonic() < end:
                sleep(0.01)
            assert not Path(f"/proc/{worker}").exists(), "a process stays"
    left = [path for path in state.rglob("*") if path.is_file()]
    assert len(left) < KILLS, left
