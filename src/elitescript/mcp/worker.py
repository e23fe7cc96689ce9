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

from elitescript.environment.process import end_with_parent, limit_memory
from elitescript.errors import ElitescriptError, ProgramError
from elitescript.mcp import runs
from elitescript.mcp.steps import Steps
from elitescript.shown import encodable_json

MEMORY_BYTES: Final = 2 * 1024**3
"""Memory that a worker may have, where the system can limit it."""

Request = Callable[[Mapping[str, Any]], dict[str, Any]]


def requests() -> dict[str, Request]:
    """Return what a worker does, by the names of the requests."""
    steps = Steps()
    return {
        "check": runs.check,
        "run": runs.run,
        "trace": runs.trace,
        "debug_start": steps.start,
        "debug_go": steps.go,
        "debug_breakpoints": steps.breakpoints,
        "debug_evaluate": steps.evaluate,
        "debug_history": steps.history,
    }


def answer_to(line: str, known: Mapping[str, Request]) -> dict[str, Any]:
    """Return the answer to a request: `{"result": ...}`, or `{"error": text}` with a text for the caller."""
    request = json.loads(line)
    try:
        return {"result": known[request["do"]](request)}
    except ProgramError as error:
        return {"error": "\n".join(map(str, error.problems))}
    except ElitescriptError as error:
        return {"error": str(error)}
    except MemoryError:
        return {"error": f"it needs more than {MEMORY_BYTES // 1024**2} MiB of memory"}


def _main() -> None:
    end_with_parent(int(sys.argv[1]))
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    limit_memory(MEMORY_BYTES)
    known = requests()
    for line in sys.stdin:
        text = json.dumps(answer_to(line, known), ensure_ascii=True, allow_nan=False)
        print(encodable_json(text), file=answers, flush=True)


if __name__ == "__main__":
    _main()
