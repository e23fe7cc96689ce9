"""The process that holds a robot and its programs, and owns nothing: `python -m elitescript.services.child FD`.

It speaks `frames` over one socket that it inherits. Before it makes the robot, which is before it sees any program, it
locks itself in. It opens no file for a program, but asks its parent.
"""

from __future__ import annotations

import faulthandler
import gc
import os
import signal
import sys
import time
import traceback
from typing import Any, Final

from elitescript.codec.json_text import from_text, to_text
from elitescript.codec.messages import shape_of
from elitescript.environment import stop_signals
from elitescript.environment.request_channels import RequestEnvironment
from elitescript.errors import ElitescriptError, UsageError
from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.inputs import RunUnit
from elitescript.messages.snapshot import RobotDescription
from elitescript.runtime.threads.meter import ClockMeter
from elitescript.services.child import frames
from elitescript.services.child.answers import TickAnswers
from elitescript.services.child.jail import enter_jail
from elitescript.services.child.output_changes import OutputWriter
from elitescript.services.child.remote_files import RemoteFiles
from elitescript.services.compiler.remote import RemoteWorkshop
from elitescript.services.debugging import debugging
from elitescript.services.options_data import options_from_data

SMALL_PROGRAM: Final = """def spare():
  textmsg("ready")
  q = get_actual_joint_positions()
  p = get_actual_tcp_pose()
  get_inverse_kin(p, q)
  set_standard_digital_out(0, get_standard_digital_in(0))
  movej(q)
  movel(p)
  sync()
end
"""
"""What a spare child runs: commands that most programs have."""
SMALL_PROGRAM_TICKS: Final = 4


def serve(line: frames.BlockingLine) -> None:
    """Carry out the messages of the parent, until it goes."""
    meter = ClockMeter(time.monotonic_ns, time.thread_time_ns)

    def ask(question: list[Any]) -> list[Any]:
        began_ns = time.monotonic_ns()
        line.send(frames.QUESTION, to_text(question))
        answer = list(from_text(line.receive_answer(frames.ANSWER)))
        meter.spend(time.monotonic_ns() - began_ns)
        return answer

    ticks: TickAnswers | None = None
    workshop = RemoteWorkshop(line)
    while True:
        letter, text = line.receive()
        if letter == frames.TICK and ticks is not None:
            for answer in ticks.answers(text):
                line.send_frames(answer)
            workshop.pump()
            continue
        if letter == frames.CODE:
            workshop.code(text)
            continue
        data = from_text(text)
        if letter == frames.LOCK_IN:
            is_jailed, memory_max = data
            layers = enter_jail(memory_max=memory_max) if is_jailed else ()
            line.send(frames.LOCKED_IN, to_text([list(layer) for layer in layers]))
        elif letter == frames.PREPARE:
            _prepare(options_from_data(data), RequestEnvironment(RemoteFiles(ask)))
        elif letter == frames.BEGIN:
            environment = RequestEnvironment(RemoteFiles(ask))
            made = options_from_data(data)
            kernel = Kernel(made, environment, debugging=debugging(), workshop=workshop, meter=meter)
            ticks = TickAnswers(kernel)
            # What is there now stays; the collector need not look at it in every round.
            gc.collect()
            gc.freeze()
            line.send(frames.DESCRIBED, to_text(shape_of(RobotDescription).encode(kernel.description)))
        else:
            raise UsageError(f"no message {letter!r} is expected here")


def _prepare(options: RobotOptions, environment: RequestEnvironment) -> None:
    """Load what a robot and its programs need."""
    kernel = Kernel(options, environment, debugging=debugging())
    kernel.tick([RunUnit("spare", "program", SMALL_PROGRAM)])
    for _ in range(SMALL_PROGRAM_TICKS):
        kernel.tick()
        OutputWriter().message(kernel.tick_and_snapshot())
    _ = kernel.description
    kernel.host.forget_threads()


def main(descriptor: int, coverage: int | None = None) -> None:
    """Serve at the inherited socket, and count in the inherited file if there is one; never returns."""
    # The parent asks with this signal where a program is that does not answer. Not even a call into C delays it.
    faulthandler.register(signal.SIGUSR1, all_threads=False)
    # A crash leaves the same trace.
    faulthandler.enable(all_threads=False)
    stop_signals.ignore()
    if coverage is not None:
        from elitescript.services.coverage import count_programs_in

        count_programs_in(coverage)
    line = frames.BlockingLine(descriptor)
    try:
        serve(line)
    except (EOFError, ConnectionError, BrokenPipeError):
        os._exit(0)
    except BaseException as error:
        kind = "usage" if isinstance(error, ElitescriptError | MemoryError) else "bug"
        if isinstance(error, MemoryError):
            text = "the program has used up the memory that the robot's process may have"
        else:
            text = str(error) if kind == "usage" else "".join(traceback.format_exception(error))[-frames.FAILURE_MAX :]
        line.send(frames.FAILED, to_text([kind, text]))
        # No destructor of a program's object is to run now.
        os._exit(1)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
