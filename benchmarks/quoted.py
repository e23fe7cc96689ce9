"""`python -m benchmarks --quoted`: every measured figure that README and docs quote, beside what is measured now.

A place is a line of a page, found by words in it that no measurement changes. A test asks for every line that names a
benchmark.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from benchmarks.compiling import LINES
from benchmarks.measure import ROOT
from benchmarks.table import HEAD, Row, print_table

SPEED = "docs/explanation/speed.md"
RECORDS = "docs/explanation/decisions/"
MODBUS = RECORDS + "0004-own-modbus.md"
KINEMATICS = RECORDS + "0007-own-kinematics.md"
ARGPARSE = RECORDS + "0008-argparse.md"
RECORDING = "docs/how-to/record.md"
DEPENDENCIES = RECORDS + "0012-dependencies.md"
NO_FIGURE = (
    (SPEED, "`make bench` prints these rows"),
    (SPEED, "`python -m benchmarks --against CHECKOUT NAME`"),
    (SPEED, "`SERVING_SECONDS=600 python -m benchmarks.serving`"),
    (SPEED, "`python -m benchmarks growth` tabulates"),
    (RECORDS + "0030-growth.md", "`python -m benchmarks.growth checks straight`"),
    (RECORDS + "0030-growth.md", "`python -m benchmarks observed --against CHECKOUT`"),
    (SPEED, "`GROWTH_HOURS=240 python -m benchmarks growth`"),
    (SPEED, "`python -m benchmarks rules` measures"),
    (SPEED, "- **Serving.**"),
    (RECORDS + "0005-the-jail.md", "- A tick costs a way to the child and back"),
    (RECORDS + "0006-no-pickle.md", "- Text costs time."),
    (DEPENDENCIES, "Sizes are those of the package alone"),
    ("docs/how-to/cluster.md", "Figures of `python -m benchmarks cluster`"),
    (RECORDS + "0020-engines.md", "`python -m benchmarks cluster` runs"),
    ("docs/explanation/inside.md", "cost (`python -m benchmarks language_loop`)"),
    (RECORDS + "0015-pygls.md", "| import (`python -m benchmarks choices`)"),
    (RECORDS + "0017-debugger.md", "`python -m benchmarks debugger` measures it."),
    (RECORDS + "0014-start.md", "Both processes of a run together"),
    (RECORDS + "0013-msgspec.md", "`python -m benchmarks ticks` prints what writing"),
    (SPEED, "robots of one `serve` on two cores"),
    (SPEED, "the same while every arm moves"),
    (SPEED, "| a tick of `serve`, one client at 250 Hz, the arm rests"),
    (SPEED, "| 16 robots in children, a client at 250 Hz each"),
    (SPEED, "| pick and place with a trace row every 4 ms, 119 s"),
    (SPEED, "| a tick of `servoj` |"),
    ("docs/explanation/jail.md", "one client floods a port, 25 kinds"),
    ("docs/how-to/ssh.md", "`python -m benchmarks.floods ssh`"),
    (RECORDS + "0025-compiler.md", "Measured, processor time"),
    (RECORDS + "0039-no-compiled-extension.md", "`python -m benchmarks programs` and"),
)
"""Lines that name a benchmark without a figure of it, or one that serves robots for minutes by a call of its own."""


class Quote(NamedTuple):
    """A line with measured figures."""

    page: str
    words: str
    """In that line alone."""
    module: str
    row: str
    """What the name of the row begins with; several may."""

    @property
    def line(self) -> str:
        """Return the line as it stands in the page."""
        lines = (ROOT / self.page).read_text(encoding="utf-8").splitlines()
        (found,) = [line for line in lines if self.words in line]
        return found


QUOTES = (
    Quote("README.md", "robot time in ", "programs", "pick and place, free run"),
    Quote("README.zh.md", "机器人时间 119 s", "programs", "pick and place, free run"),
    Quote(SPEED, "| start to exit, one-line program |", "programs", "start to exit, one-line program"),
    Quote(SPEED, "| a run of 10 s on a new robot, the same text again |", "programs", "a run of 10 s on a new robot"),
    Quote(SPEED, "| pick and place, 119 s of robot time |", "programs", "pick and place, free run"),
    Quote(SPEED, "| the same with a trace row every 4 ms |", "programs", "the same with a trace row"),
    Quote(SPEED, "| picking from a moving belt |", "programs", "picking from a moving belt"),
    Quote(SPEED, "| a day of pick and place |", "programs", "24 h of pick and place"),
    Quote(SPEED, "| an hour of it with a tracking error,", "programs", "1 h of it with a lag"),
    Quote(SPEED, "| a minute of `servoj`,", "streams", "60 s of servoj"),
    Quote(SPEED, "| a minute of `speedl`,", "streams", "60 s of speedl"),
    Quote(SPEED, "| language loops, mean of eight |", "language_loop", "language loops"),
    Quote(SPEED, "| forward kinematics |", "kinematics", "forward kinematics"),
    Quote(SPEED, "| inverse kinematics, all eight solutions |", "kinematics", "inverse kinematics, all eight"),
    Quote(SPEED, "| plan `movel` over 0.2 m and sample", "motion", "movel 0.2 m: plan and 50 samples"),
    Quote(SPEED, "| ten RTSI clients at 250 Hz,", "serving", "10 RTSI clients, 250 Hz, idle"),
    Quote(SPEED, "| the same while a program runs", "serving", "10 RTSI clients, 250 Hz, a program burns CPU:"),
    Quote(SPEED, "| a served robot in lockstep", "serving", "lockstep with one client"),
    Quote(SPEED, "| 200 MODBUS signals at 250 Hz,", "devices", "200 MODBUS signals at 250 Hz, 4 connections"),
    Quote(SPEED, "| a thread of a program that writes", "programs", "a thread with 14 "),
    Quote(SPEED, "| 200 lines of 1.5 mm,", "motion", "200 lines of 1.5 mm"),
    Quote(SPEED, "| findings in an editor of 5,000 lines,", "editor", "5000 lines, functions, last of 12 keys"),
    Quote(SPEED, "| `check` of 5,000 statements,", "checking", "check of 5,000 statements: all of it"),
    Quote(SPEED, "- **Starting.**", "programs", "start to exit, one-line program"),
    Quote(RECORDS + "0001-greenlets.md", "| there and back", "choices", "a thread of a program: there and back"),
    Quote(RECORDS + "0001-greenlets.md", "| slowdown of the language", "language_loop", "language loops"),
    Quote(RECORDS + "0002-leaping-in-time.md", "- A day of pick and place takes", "programs", "24 h of pick and place"),
    Quote(RECORDS + "0002-leaping-in-time.md", "- A day of pick and place takes", "programs", "1 h of it with a lag"),
    Quote(RECORDS + "0003-trapezoid-profiles.md", "`python -m benchmarks motion`", "motion", "movej: plan"),
    Quote(MODBUS, "| 200 signals at 250 Hz", "devices", "200 MODBUS signals"),
    Quote(MODBUS, "| requests a second,", "devices", "200 MODBUS signals at 250 Hz, 4 connections"),
    Quote(RECORDS + "0005-the-jail.md", "| jail through `ctypes`", "choices", "enter the jail"),
    Quote(KINEMATICS, "| forward |", "kinematics", "forward kinematics"),
    Quote(KINEMATICS, "| inverse, all eight |", "kinematics", "inverse kinematics, all eight"),
    Quote(KINEMATICS, "| Jacobian |", "kinematics", "Jacobian"),
    Quote(KINEMATICS, "| forward kinematics in floats,", "choices", "forward kinematics of one"),
    Quote(KINEMATICS, "| import |", "choices", "import numpy"),
    Quote(ARGPARSE, "`elitescript run` of a one-line", "programs", "start to exit, one-line program"),
    Quote(ARGPARSE, "| | import", "choices", "import "),
    Quote(ARGPARSE, "| argparse |", "choices", "import argparse"),
    Quote(ARGPARSE, "| click 8 |", "choices", "import click"),
    Quote(RECORDS + "0009-tuples-of-floats.md", "- Small: no attribute", "choices", "forward kinematics of one"),
    Quote(RECORDS + "0010-asyncio.md", "`python -m benchmarks serving`", "serving", "10 RTSI clients, 250 Hz, idle"),
    Quote(RECORDS + "0010-asyncio.md", "- asyncio is imported by", "choices", "import asyncio"),
    Quote(RECORDS + "0025-compiler.md", "| read, check and compile,", "compiling", f"{LINES:,} lines of"),
    Quote(RECORDS + "0025-compiler.md", "| one call of Python's parser", "compiling", f"{LINES:,} lines of"),
    Quote(RECORDS + "0025-compiler.md", "| the same in pieces of", "compiling", f"{LINES:,} lines of"),
    Quote(RECORDS + "0025-compiler.md", "| one call of Python's compiler", "compiling", f"{LINES:,} lines of"),
    Quote(RECORDS + "0025-compiler.md", "| until the first line has run,", "compiling", "served, "),
    Quote(RECORDS + "0026-cut-by-the-clock.md", "a refused `movel` takes", "metered", "a refused "),
    Quote(RECORDS + "0026-cut-by-the-clock.md", "- A pass of a loop costs", "metered", "a "),
    *(Quote(RECORDING, "Recording takes", "record", row) for row in ("a package", "an hour", "a row")),
    Quote(RECORDS + "0021-properties.md", "- A property of the arm", "sweep", "a run of 10 s"),
    Quote(RECORDS + "0021-properties.md", "- A property of the arm", "sweep", "with a property of the arm"),
    *(Quote(RECORDS + "0022-recordings.md", "- A package costs", "record", row) for row in ("a package", "an hour")),
    Quote(DEPENDENCIES, "| greenlet 3 |", "choices", "import greenlet"),
    Quote(DEPENDENCIES, "| pyserial 3.5,", "choices", "import serial"),
    Quote(DEPENDENCIES, "| asyncssh 2,", "choices", "import asyncssh"),
    Quote(DEPENDENCIES, "| pygls 2,", "choices", "import pygls.lsp.server"),
    Quote(DEPENDENCIES, "| distributed 2026,", "choices", "import distributed"),
    Quote(DEPENDENCIES, "| optuna 5,", "choices", "import optuna"),
    Quote(DEPENDENCIES, "| pyarrow 26,", "choices", "import pyarrow"),
    Quote("docs/how-to/cluster.md", "| a run of ten moves,", "cluster", "a run of a sweep"),
    Quote("docs/how-to/cluster.md", "| the same through Dask,", "cluster", "the same on Dask"),
    Quote("docs/how-to/cluster.md", "| a task, whatever", "cluster", "a Dask task without work"),
    Quote("docs/how-to/cluster.md", "| a row to the client", "cluster", "a row on its way"),
    Quote(DEPENDENCIES, "| mcap 1,", "choices", "import mcap.writer"),
    Quote(DEPENDENCIES, "| mcp 2,", "choices", "import mcp.server.mcpserver"),
    Quote(DEPENDENCIES, "| numpy | floats", "choices", "import numpy"),
)


def print_quotes(rows: Iterable[Row]) -> int:
    """Print each line that quotes figures, and below it what is measured now; return 1 if a row is missing."""
    rows = list(rows)
    missing = 0
    for page, words in dict.fromkeys((quote.page, quote.words) for quote in QUOTES):
        quotes = [quote for quote in QUOTES if (quote.page, quote.words) == (page, words)]
        found = [row for quote in quotes for row in rows if row.what.startswith(quote.row)]
        missing += not found
        print(f"\n{page}: {quotes[0].line.strip()}")
        print_table(HEAD, (row.cells for row in found))
    return int(missing > 0)
