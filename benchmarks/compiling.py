"""Long programs: what reading, checking and compiling takes, by step, and how soon a served robot begins them.

Steps are measured in a process of their own for each text, garbage collection paused as the compiler pauses it; memory
is the peak of that process. Served, a text is sent to the primary port of an `elitescript serve`: the wall time until
its first line has run, or until it is refused, and the longest gap of a 250 Hz stream meanwhile. `COMPILING_LINES` sets
the length of the texts, 50,000 lines.
"""

from __future__ import annotations

import gc
import json
import os
import selectors
import socket
import subprocess
import sys
from collections.abc import Callable
from itertools import pairwise
from time import perf_counter
from typing import Any

from benchmarks.measure import ROOT, environment, time_of
from benchmarks.serving import Stream, message, served
from benchmarks.table import Row, Time, print_rows, timed_row

LINES = int(os.environ.get("COMPILING_LINES", "50000"))
TEXTS: dict[str, str] = {
    "`a = 1`": "  a = 1\n",
    "`movej([...], a=1.2, v=0.8)`": "  movej([0.{k:03}, -1.4, -1.7, -1.6, 1.57, 0.0], a=1.2, v=0.8)\n",
    "`movel([...], v=0.25, r=0.0004)`": "  movel([0.4, -0.2, 0.{k:03}, 3.14, 0.0, 0.0], v=0.25, r=0.0004)\n",
}
"""Lines of the measured texts, by what they are called."""
REFUSED = "  a = 1\n" * 250_000
BEGUN = 4711
"""What the first line of a served text writes into an output register."""
PIECE_LINES = 100


def text_of(name: str, lines: int = LINES) -> str:
    """Return the text of a program of so many lines."""
    body = "".join(TEXTS[name].format(k=100 + k % 400) for k in range(lines))
    return f"def job():\n  write_output_integer_register(0, {BEGUN})\n{body}end\n"


def steps(name: str, lines: int) -> list[list[Any]]:
    """Return name, wall and CPU time (s) of each step, in this process; then the peak of its memory in MB."""
    from elitescript.kernel.compiling import Job, compiled_job
    from elitescript.language.parser import syntax_tree
    from elitescript.language.probes import ATTACH_PROBES
    from elitescript.language.text.dialect import translate
    from elitescript.language.text.source import SourceFile
    from elitescript.messages.profile import profile
    from elitescript.models.model import load_model
    from elitescript.services.compiler.loading import Loading
    from elitescript.services.compiler.packing import packed

    text = text_of(name, lines)
    source = SourceFile("<client>", text)
    # A debugger may come to a served robot, so its statements are numbered.
    job = Job(1, "<client>", text, "program", False, ATTACH_PROBES, 1, ())
    compiled_job(job._replace(text=text_of(name, 100)), profile(), load_model("CS66"))
    found: dict[str, Time] = {}
    made: dict[str, Any] = {}

    def step(what: str, run: Callable[[], Any]) -> None:
        def keep() -> None:
            made[what] = run()

        gc.collect()
        gc.disable()
        found[what] = time_of(keep)
        gc.enable()

    step("read, check and compile, all together", lambda: compiled_job(job, profile(), load_model("CS66")))
    step("write the code for its way", lambda: b"".join(packed(made["read, check and compile, all together"])))
    step("read the code", lambda: Loading(source).feed(made["write the code for its way"]))
    python = translate(source).text
    step("one call of Python's parser", lambda: syntax_tree(python))
    tree = made["one call of Python's parser"]
    step("one call of Python's compiler", lambda: compile(tree, "<elitescript>", "exec", dont_inherit=True))
    made.clear()
    rows = python.split("\n")[1:-2]
    pieces = ["if 1:\n" + "\n".join(rows[at : at + PIECE_LINES]) for at in range(0, len(rows), PIECE_LINES)]
    gc.disable()
    times = [time_of(lambda piece=piece: syntax_tree(piece)) for piece in pieces]  # type: ignore[misc]
    longest = max(times, key=lambda time: time.cpu_s)
    found[f"Python's parser in pieces of {PIECE_LINES} lines, the longest piece"] = longest
    return [[what, *time] for what, time in found.items()]


def step_rows(name: str) -> list[Row]:
    """Return the rows of the steps of a text."""
    command = [sys.executable, "-m", "benchmarks.compiling", name, str(LINES)]
    out = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, cwd=ROOT, env=environment()).stdout
    found = json.loads(out)
    title = f"{LINES:,} lines of {name}"
    rows = [timed_row(f"{title}: {what}", Time(wall_s, cpu_s), "s") for what, wall_s, cpu_s in found["steps"]]
    return [*rows, Row(f"{title}: memory", "MB", value=found["peak_mb"])]


def served_row(what: str, text: str, *, is_refused: bool = False) -> Row:
    """Send a text to a served robot, and return how long it takes to begin or to be refused."""
    with served() as (ports, _):
        stream = Stream(ports["rtsi"], "timestamp,output_int_register0")
        stream.socket.sendall(message("S"))
        primary = socket.create_connection(("127.0.0.1", ports["primary"]))
        selector = selectors.DefaultSelector()
        selector.register(stream.socket, selectors.EVENT_READ, stream.read)
        said = bytearray()
        selector.register(primary, selectors.EVENT_READ, lambda: said.extend(primary.recv(1 << 16)))
        end = perf_counter() + 1.0
        while perf_counter() < end:
            for key, _ in selector.select(0.1):
                key.data()
        stream.times.clear()
        said.clear()
        began, is_over = perf_counter(), False
        with socket.create_connection(("127.0.0.1", ports["primary"])) as sender:
            sender.sendall(text.encode())
            # What it is told is read below; it sends nothing more.
            sender.shutdown(socket.SHUT_WR)
        while not is_over:
            for key, _ in selector.select(0.1):
                key.data()
            register = int.from_bytes(stream.package[12:16]) if len(stream.package) >= 16 else 0
            is_over = b"at most" in said if is_refused else register == BEGUN
            if perf_counter() - began > 120.0:
                raise RuntimeError(f"{what}: nothing within 120 s")
        wall_s = perf_counter() - began
        arrivals = [arrived for _, arrived, _ in stream.times]
        gaps = [later - earlier for earlier, later in pairwise(arrivals)]
        primary.close()
        stream.socket.close()
    outcome = "refused" if is_refused else "its first line has run"
    gap = f"longest gap of a stream {max(gaps) * 1e3:.0f} ms"
    return Row(f"served, {what}: {outcome}", "s", wall_s=wall_s, words=gap)


def rows() -> list[Row]:
    """The rows of this module."""
    found = [row for name in TEXTS for row in step_rows(name)]
    found += [served_row(f"{LINES:,} lines of {name}", text_of(name)) for name in TEXTS]
    lines = REFUSED.count("\n")
    return [*found, served_row(f"{lines:,} lines of `a = 1`", f"def job():\n{REFUSED}end\n", is_refused=True)]


if __name__ == "__main__":
    if len(sys.argv) > 2:
        from resource import RUSAGE_SELF, getrusage

        taken = steps(sys.argv[1], int(sys.argv[2]))
        print(json.dumps({"steps": taken, "peak_mb": getrusage(RUSAGE_SELF).ru_maxrss / 1024}))
    else:
        print_rows(rows())
