"""The child process: does numbered pieces of work, and says of each what came of it.

Started as `python -P -m elitescript.sweep.engines.worker JOB LIFE MEMORY`. Messages come on standard input and go to
what was standard output, as `frames`; what the work prints goes to standard error. The first message is the
description that the job gets. Then there come

    ["range", FIRST, STOP]   numbers FIRST to STOP - 1, one after the other
    ["about", NUMBER]        what is known of a number before it is done: asked for before a range of that number alone
    ["order", DATA]          one piece of work without a number

and go

    ["ready"]
    ["values", FIRST, VALUES, IS_DONE]   of numbers from FIRST on; IS_DONE with the last ones of the range
    ["about", VALUE]                     what the job says about that number; None if it says nothing about any
    ["value", VALUE]                     of an order
    ["error", KIND, TEXT]                the job refuses: KIND is `usage`, `program` or `fault`; the process ends
"""

from __future__ import annotations

import gc
import os
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any, Final

from elitescript.environment.process import end_with_parent, limit_memory
from elitescript.errors import ProgramError, UsageError
from elitescript.sweep.engines.frames import Frames, framed

FLUSH_S: Final = 0.05
"""Wall time after which values are sent though the range is not done."""

OBJECTS_MAX: Final = 50_000
"""Objects that a piece of work may leave behind before garbage is collected: some 10 MB."""

OUT_OF_MEMORY: Final = 3
"""Exit code after a piece of work that needs more memory than there is."""


_GONE: Final = object()
"""In the place of a description, which may be None."""


def _main(job: str, life: int, memory_bytes: int) -> None:
    end_with_parent(life)
    if memory_bytes:
        limit_memory(memory_bytes)
    answers = os.dup(1)
    os.dup2(2, 1)

    def send(*message: Any) -> None:
        data = memoryview(framed(message))
        while data:
            data = data[os.write(answers, data) :]

    try:
        _serve(job, send)
    except MemoryError:
        os._exit(OUT_OF_MEMORY)
    except BrokenPipeError:
        pass  # the parent has gone
    except UsageError as error:
        send("error", "usage", str(error))
    except ProgramError as error:
        send("error", "program", "\n".join(map(str, error.problems)))
    except Exception:
        send("error", "fault", traceback.format_exc())


def _messages() -> Iterator[Any]:
    frames = Frames()
    while data := os.read(0, 1 << 16):
        yield from frames.feed(data)


def _serve(job: str, send: Callable[..., None]) -> None:
    messages = _messages()
    description = next(messages, _GONE)
    if description is _GONE:
        # The parent has gone before it could say anything.
        return
    module, _, function = job.partition(":")
    work: Callable[[Any], Any] = getattr(import_module(module), function)(description)
    # What is there now stays; what a piece of work leaves behind is looked at between two of them.
    gc.collect()
    gc.freeze()
    gc.set_threshold(OBJECTS_MAX, 10, 10)
    send("ready")
    for message in messages:
        if message[0] == "order":
            send("value", work(message[1]))
        elif message[0] == "about":
            about = getattr(work, "about", None)
            send("about", None if about is None else about(message[1]))
        else:
            _, first, stop = message
            _work_through(range(first, stop), work, send)


def _work_through(numbers: range, work: Callable[[Any], Any], send: Callable[..., None]) -> None:
    first, values, sent_s = numbers[0], [], time.monotonic()
    for number in numbers:
        values.append(work(number))
        now_s = time.monotonic()
        if now_s - sent_s >= FLUSH_S or number == numbers[-1]:
            send("values", first, values, number == numbers[-1])
            first, values, sent_s = number + 1, [], now_s


if __name__ == "__main__":
    _main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
