"""A worker process: carries out one request, and reports on its link; it may be killed at any time.

It is a copy of the keeper (`keeper`), or, where processes cannot be copied, one that was started ahead with its link as
standard input and output. Nothing but the simulation can be reached from it, and the network if the request lets it
connect.
"""

from __future__ import annotations

import os
import sys
from typing import Any, Final

from elitescript.environment.process import end_with_parent
from elitescript.services.child.jail import enter_jail, own_modules
from elitescript.studio.live.detail import sample
from elitescript.studio.live.jobs import files_of, job_of
from elitescript.studio.live.link import Link
from elitescript.studio.live.looking import look
from elitescript.studio.live.recording import record_run
from elitescript.studio.live.running import run_program

MEMORY_BYTES: Final = 1 << 30

_REQUESTS: Final = {"run": run_program, "detail": sample, "look": look, "record": record_run}


def serve(link: Link) -> None:
    """Carry out the request that comes first."""
    try:
        request = link.receive()
        _REQUESTS[request["do"]](link, request, lambda: _lock_in(request))
    except (EOFError, BrokenPipeError):
        # Nobody asks or reads any more.
        pass


def _lock_in(request: dict[str, Any]) -> None:
    job = request["job"]
    if job["may_connect"]:
        enter_jail(memory_max=MEMORY_BYTES, may_connect=True)
    elif request["do"] == "look":
        # It makes robots again and again, and copies of itself.
        folders = [str(path.parent) for path in files_of(job_of(job))]
        enter_jail([*own_modules(), *folders], MEMORY_BYTES, may_copy=True)
    else:
        enter_jail(memory_max=MEMORY_BYTES)


def main() -> None:
    """Serve one request on standard input and output."""
    end_with_parent(int(sys.argv[1]))
    link = Link(os.dup(0), os.dup(1))
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)
    serve(link)
    # No destructor of a program's object is to run now.
    os._exit(0)


if __name__ == "__main__":
    main()
