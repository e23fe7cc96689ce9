"""Children that misbehave, as processes: each is replaced and reported, and nothing of it is left."""

from __future__ import annotations

import asyncio
import gc
import os
import signal
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

from elitescript.codec.json_text import to_text
from elitescript.codec.messages import shape_of
from elitescript.errors import ElitescriptError
from elitescript.kernel import RobotOptions
from elitescript.messages.events import Alarm
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import RobotDescription
from elitescript.services.child import process as child_process
from elitescript.services.child import supervision
from elitescript.services.child.link import ChildLink
from tests.protocol.snapshots import description, output

LIMIT_S = 60.0
MARK = 987654321
SMALL_CHILD = Path(__file__).with_name("small_child.py")

pytestmark = pytest.mark.skipif(os.name != "posix", reason="children inherit a socket, as POSIX has it")


@pytest.fixture
def small(monkeypatch, tmp_path):
    """Children that are small, and misbehave as the test says."""
    texts = tmp_path / "description.json", tmp_path / "output.json"
    texts[0].write_text(to_text(shape_of(RobotDescription).encode(description())))
    texts[1].write_text(to_text(shape_of(Output).encode(output(MARK))))

    def choose(how: str) -> None:
        command = (sys.executable, "-I", "-S", str(SMALL_CHILD), how, *map(str, texts))
        monkeypatch.setattr(child_process, "COMMAND", command)

    return choose


def with_link(body: Callable[[ChildLink], Awaitable[None]]) -> None:
    async def run() -> None:
        link = ChildLink(RobotOptions(), is_jailed=False)
        await link.open()
        try:
            await body(link)
        finally:
            await link.close()

    asyncio.run(asyncio.wait_for(run(), LIMIT_S))


async def replaced(link: ChildLink) -> Alarm:
    """Go on until the child has been replaced; return how that was reported."""
    known = link.restarts
    while link.restarts == known:
        found = await link.tick(())
        await asyncio.sleep(0.001)
    (alarm,) = [event for event in found.events if isinstance(event, Alarm)]
    return alarm


@pytest.mark.parametrize(
    ("how", "why"),
    [
        ("exit", "it has ended (exit code 3)"),
        ("abort", f"it has ended (killed by signal {int(signal.SIGABRT)})"),
        ("questions", "a question before the answer"),
        ("garbage", "a message of 4294967295 bytes"),
    ],
)
def test_a_child_that_misbehaves_is_reported_in_one_line(small, how, why):
    small(how)

    async def body(link):
        small("")
        alarm = await replaced(link)
        assert alarm.code == "R132"
        assert why in alarm.text
        assert "\n" not in alarm.text

    with_link(body)


def test_a_child_that_does_not_come_up_says_why(small):
    small("boot")

    async def run() -> None:
        link = ChildLink(RobotOptions(), is_jailed=False)
        try:
            with pytest.raises(ElitescriptError, match="did not come up: it has ended") as caught:
                await link.open()
            assert "it does not come up" in str(caught.value)
        finally:
            await link.close()

    asyncio.run(asyncio.wait_for(run(), LIMIT_S))


def test_a_child_that_floods_its_output_keeps_nothing_waiting(small):
    small("flood")

    async def body(link):
        for _ in range(20):
            assert (await link.tick(())).snapshot is not None
            await asyncio.sleep(0.001)
        assert len(link._transport.process.log) <= child_process.LOG_MAX

    with_link(body)


@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="what a process has open is not known here")
def test_replaced_children_leave_nothing_behind(small, monkeypatch):
    monkeypatch.setattr(supervision, "PAUSES_TICKS", (0,))
    small("exit")

    children = Path(f"/proc/self/task/{os.getpid()}/children")
    before = set(children.read_text().split()) if children.exists() else set()

    async def body(link):
        for _ in range(5):
            await replaced(link)
        gc.collect()
        files, blocks = len(os.listdir("/proc/self/fd")), sys.getallocatedblocks()  # noqa: PTH208
        for _ in range(30):
            await replaced(link)
        gc.collect()
        assert sys.getallocatedblocks() - blocks < 300
        assert len(os.listdir("/proc/self/fd")) == files  # noqa: PTH208
        if children.exists():
            assert len(set(children.read_text().split()) - before) <= 2

    with_link(body)


def test_the_signals_that_end_a_whole_group_leave_the_child_to_its_parent():
    """`timeout`, a service manager and a terminal send them to every process at once."""

    async def body(link: ChildLink) -> None:
        before = link.pid
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            os.kill(before, number)
        for _ in range(3):
            assert not (await link.tick(())).events
        assert (link.pid, link.restarts) == (before, 0)

    with_link(body)
