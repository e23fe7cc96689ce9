"""The process that compiles one text: `python -m elitescript.services.compiler FD`.

It locks itself in as the process of a robot does, before it sees the text, and ends with it. It runs nothing of the
text.
"""

from __future__ import annotations

import faulthandler
import os
import sys
import traceback
from typing import Final

from elitescript.codec.json_text import from_text, to_text
from elitescript.environment import stop_signals
from elitescript.errors import UsageError
from elitescript.kernel.arm import model_of
from elitescript.kernel.compiling import compiled_job
from elitescript.kernel.options import RobotOptions
from elitescript.language.garbage import without_collection
from elitescript.messages.profile import profile
from elitescript.services.child import frames
from elitescript.services.child.jail import enter_jail
from elitescript.services.compiler.jobs import read_job, read_portion
from elitescript.services.compiler.packing import packed
from elitescript.services.options_data import options_from_data

NICENESS: Final = 5
"""Robots come first."""
CODE_BYTES: Final = 128 * 1024
"""Bytes of a program in one message."""


def serve(line: frames.BlockingLine) -> None:
    """Carry out the messages of the parent, until it goes."""
    options: RobotOptions | None = None
    text = bytearray()
    while True:
        letter, content = line.receive()
        if letter == frames.LOCK_IN:
            is_jailed, memory_max = from_text(content)
            layers = enter_jail(memory_max=memory_max) if is_jailed else ()
            line.send(frames.LOCKED_IN, to_text([list(layer) for layer in layers]))
        elif letter == frames.BEGIN:
            options = options_from_data(from_text(content))
        elif letter == frames.TEXT and options is not None:
            _, is_last, data = read_portion(content)
            text += data
            if is_last:
                compile_text(line, options, bytes(text))
        else:
            raise UsageError(f"no message {letter!r} is expected here")


@without_collection
def compile_text(line: frames.BlockingLine, options: RobotOptions, data: bytes) -> None:
    """Compile a text, and send what has come of it."""
    result = compiled_job(read_job(data), profile(options.firmware), model_of(options), options.ignored)
    waiting = bytearray()
    for piece in packed(result):
        waiting += piece
        while len(waiting) >= CODE_BYTES:
            line.send(frames.CODE, bytes(waiting[:CODE_BYTES]))
            del waiting[:CODE_BYTES]
    line.send(frames.CODE, bytes(waiting))
    line.send(frames.COMPILED, b"")


def main(descriptor: int) -> None:
    """Serve at the inherited socket; never returns."""
    faulthandler.enable(all_threads=False)
    stop_signals.ignore()
    os.nice(NICENESS)
    line = frames.BlockingLine(descriptor)
    try:
        serve(line)
    except (EOFError, ConnectionError, BrokenPipeError):
        os._exit(0)
    except MemoryError:
        line.send(frames.FAILED, b"memory")
    except BaseException as error:
        text = "".join(traceback.format_exception(error))[-frames.FAILURE_MAX :]
        line.send(frames.FAILED, text.encode("utf-8", "replace"))
    os._exit(1)


if __name__ == "__main__":
    main(int(sys.argv[1]))
