"""The end of commands that listen to a controller."""

from __future__ import annotations

import asyncio
import os
import signal

import pytest

from elitescript.cli.listening import ended
from elitescript.recorder.session import Session, Target


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_ctrl_c_before_the_wait_begins_is_the_end_of_it():
    async def listen() -> None:
        end = ended(Session(Target("127.0.0.1", {}, 250.0), [], print), None)
        os.kill(os.getpid(), signal.SIGINT)
        await asyncio.wait_for(end, 20.0)

    asyncio.run(listen())
