"""A worker process: one request on each line of standard input, one answer on each line of standard output, as JSON.

The server ends it when an answer takes too long. Calls of programs must not reach standard output, so the answers go
through a descriptor of their own.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Mapping
from typing import Any, Final

from elitescript.environment.process import limit_memory
from elitescript.errors import ElitescriptError
from elitescript.mcp import runs

MEMORY_BYTES: Final = 2 * 1024**3
"""Memory that a worker may have, where the system can limit it."""

REQUESTS: Final[dict[str, Callable[[Mapping[str, Any]], dict[str, Any]]]] = {
    "check": runs.check,
    "run": runs.run,
    "trace": runs.trace,
}


def answer_to(line: str) -> dict[str, Any]:
    """Return the answer to a request: `{"result": ...}`, or `{"error": text}` with a text for the caller."""
    request = json.loads(line)
    try:
        return {"result": REQUESTS[request["do"]](request)}
    except ElitescriptError as error:
        return {"error": str(error)}
    except MemoryError:
        return {"error": f"it needs more than {MEMORY_BYTES // 1024**2} MiB of memory"}


def _main() -> None:
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    limit_memory(MEMORY_BYTES)
    for line in sys.stdin:
        print(json.dumps(answer_to(line), ensure_ascii=True, allow_nan=False), file=answers, flush=True)


if __name__ == "__main__":
    _main()
