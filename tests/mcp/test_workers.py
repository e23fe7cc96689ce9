"""Processes of the server: what becomes of them when one of both is killed."""

import asyncio
import os
import subprocess
import sys

import pytest

from elitescript.errors import UsageError
from elitescript.mcp.workers import Worker

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")

CHECK = {"do": "check", "name": "<text>", "text": "def a():\nend\n"}


def test_a_worker_that_was_killed_takes_no_more_requests():
    async def asked():
        worker = Worker(20.0)
        await worker.ask(CHECK)
        worker._process.kill()
        await worker._process.wait()
        with pytest.raises(UsageError, match="has ended"):
            await worker.ask(CHECK)
        return worker.is_alive

    assert asyncio.run(asked()) is False


def test_a_process_ends_with_its_parent_whatever_it_does():
    parent = (
        "import subprocess, sys, time; from elitescript.environment.process import Life; life = Life();"
        "child = subprocess.Popen([sys.executable, '-c', 'import sys; from elitescript.environment.process import"
        " end_with_parent; end_with_parent(int(sys.argv[1])); print(1, flush=True); sum(range(10 ** 12))',"
        " str(life.descriptor)], **life.options); life.started(); time.sleep(60)"
    )
    process = subprocess.Popen([sys.executable, "-c", parent], stdout=subprocess.PIPE)
    assert process.stdout.readline() == b"1\n"
    process.kill()
    process.wait(10)
    # The other process has the same output: its end is when that has ended.
    assert process.communicate(timeout=10)[0] == b""
