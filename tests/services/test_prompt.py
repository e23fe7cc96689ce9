"""A future whose task goes on at once."""

from __future__ import annotations

import asyncio

import pytest

from elitescript.services.time.prompt import PromptFuture


def test_the_task_goes_on_within_the_callback_that_sets_the_result() -> None:
    async def test() -> None:
        said: list[str] = []

        async def wait() -> None:
            for name in ("first", "second"):
                futures.append(PromptFuture())
                await futures[-1]
                said.append(name)

        def ring() -> None:
            for _ in range(2):
                futures[-1].set_result(None)
                said.append("set")

        futures: list[PromptFuture] = []
        waiting = asyncio.create_task(wait())
        await asyncio.sleep(0)
        asyncio.get_running_loop().call_soon(ring)
        await waiting
        assert said == ["first", "set", "second", "set"]

    asyncio.run(test())


def test_it_does_not_go_on_in_the_middle_of_another_task() -> None:
    async def test() -> None:
        said: list[str] = []
        future = PromptFuture()

        async def wait() -> None:
            await future
            said.append("went on")

        waiting = asyncio.create_task(wait())
        await asyncio.sleep(0)
        future.set_result(None)
        said.append("set")
        await waiting
        assert said == ["set", "went on"]

    asyncio.run(test())


def test_what_is_done_already_is_not_waited_for() -> None:
    async def test() -> None:
        future = PromptFuture()
        future.set_result(None)
        await future

    asyncio.run(test())


def test_a_task_that_waits_can_be_cancelled() -> None:
    async def test() -> None:
        future = PromptFuture()
        waiting = asyncio.create_task(_wait(future))
        await asyncio.sleep(0)
        waiting.cancel()
        with pytest.raises(asyncio.CancelledError):
            await waiting
        assert future.cancelled()

    asyncio.run(test())


def test_what_a_task_raises_stays_in_the_task() -> None:
    async def test() -> None:
        future = PromptFuture()

        async def fail() -> None:
            await future
            raise ValueError("mine")

        waiting = asyncio.create_task(fail())
        await asyncio.sleep(0)
        asyncio.get_running_loop().call_soon(future.set_result, None)
        with pytest.raises(ValueError, match="mine"):
            await waiting

    asyncio.run(test())


async def _wait(future: PromptFuture) -> None:
    await future
