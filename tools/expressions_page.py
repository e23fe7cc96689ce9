"""The reference page of expressions: names and functions from their tables, each with an example that is run here."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from elitescript import VirtualRobot
from elitescript.errors import UsageError
from elitescript.properties.checks import Checks
from elitescript.properties.functions import EXPONENT_MAX, FUNCTIONS
from elitescript.properties.names import ALARM, CONTACT, OVER_TIME, RECORD
from elitescript.properties.over_time import FUNCTIONS_OVER_TIME
from elitescript.properties.parsing import parse_measure, parse_property
from elitescript.run import Run
from elitescript.values.plain import DEPTH_MAX, TEXT_MAX
from tools.markdown import NOTICE, cell, code

PROGRAM: Final = """\
def place():
  global parts
  parts = 0
  movej([0, -1.5, -1.6, -1.5, 1.5, 0], 1.4, 1.05)
  pose = get_target_tcp_pose()
  pose[2] -= 0.1
  movel(pose, 1.2, 0.25)
  set_standard_digital_out(0, True)
  sleep(0.008)
  set_standard_digital_out(0, False)
  parts += 1
  textmsg("placed ", parts)
end
"""
"""What the examples are tried on."""

OF_RECORD: Final = {
    "time_s": "time_s < 20",
    "state": 'state in ["finished", "stopped"]',
    "globals": 'globals["parts"] == 1',
    "signals": 'not signals["standard_digital_out[0]"]',
    "joints": "degrees(joints[4]) > 80",
    "tcp_pose": "tcp_pose[2] > 0.3",
    "alarms": 'len(alarms) == 0 or alarms[0]["code"] != "R102"',
    "log": '"placed 1" in log',
    "printed": "len(printed) == 0",
    "warnings": "len(warnings) == 0",
    "findings": "findings.error == 0 and findings.warning == 0",
    "contacts": "len(contacts) == 0",
    "clearance": "clearance > 0.02",
}
OF_TIME: Final = {
    "t": "always(t < 4)",
    "q": "always(max(q) < 1.6)",
    "qd": "max_of(abs(qd[1]))",
    "tcp": "min_of(tcp.z)",
    "tcp_speed": "max_of(tcp_speed) < 0.5",
    "line": "first(line == 7)",
}
OF_FUNCTIONS: Final = {
    "abs": "abs(tcp_pose[5]) < 3.2",
    "min": "min(joints)",
    "max": "max(joints[0], joints[1], 0.5)",
    "sum": "sum(joints)",
    "round": "round(time_s, 1)",
    "sqrt": "sqrt(tcp_pose[0] * tcp_pose[0] + tcp_pose[1] * tcp_pose[1])",
    "hypot": "hypot(tcp_pose[0] - 0.4, tcp_pose[1] + 0.1) < 0.5",
    "degrees": "degrees(joints[1])",
    "radians": "joints[0] < radians(30)",
    "sin": "sin(joints[4])",
    "cos": "cos(joints[4])",
}
OVER: Final = {
    "always": "always(tcp.z > 0.4)",
    "eventually": "eventually(standard_digital_out[0])",
    "before": 'before(tcp[2] < 0.45, signal("standard_digital_out[0]"))',
    "max_of": "max_of(hypot(tcp[0], tcp[1])) < 0.9",
    "min_of": "min_of(tcp[2])",
    "first": 'first(signal("standard_digital_out[0]"))',
    "duration": 'duration(signal("standard_digital_out[0]"))',
    "count": "count(tcp_speed > 0.2)",
}


INTRODUCTION: Final = """\
# Expressions

{notice}
`sweep --ensure EXPRESSION` asks whether something holds of each run, and `--measure NAME=EXPRESSION` writes a
number of each run into its row. They look like Python, but only what stands on this page is possible, and
nothing of them is run as Python: no calls of anything else. Names of signals, and of the globals of
the program, are checked before the first run. In Python they are `elitescript.properties`.

An expression has numbers, texts, lists of these, `pi`, `+ - * / // %`, `**` with a literal from -{exponent} to
{exponent}, `< <= > >= == !=` (also `0 < x < 1`), `in`, `is None`, `and or not`, `a if c else b`, and parts such as
`joints[0]` with a literal in the brackets. Elements have names too: `tcp.z` (x, y, z, rx, ry, rz) and `q.base` (base,
shoulder, elbow, wrist1, wrist2, wrist3). A signal is written as in world files and in the debugger:
`standard_digital_out[0]`. It has {length:,} characters at most, nested {depth} deep.

The outcomes on this page are those of this program:
"""

THE_RECORD: Final = """\
## The record

Names of the run at its end. The entries of `alarms` are {alarm};
those of `contacts` are {contact}.
"""

OVER_A_RUN: Final = """\
## Over time

Inside these functions, and only there, stand the names of the next table. A [signal](signals.md) has its level of the
moment there, outside that at the end of the run; `signal("NAME")` is the same. Names of the record do not stand
inside, nor one function over time in another.
"""

MOMENTS: Final = """\
- Time runs from the start to the end of the run, tick by tick (4 ms). At a tick a signal has the level that it
  has after everything that happened in it, and the arm is where the motion of that tick has brought it, as in
  the rows of `--trace`. A pulse of one tick is seen.
- What depends on signals and lines alone costs nothing while nothing changes; what depends on the arm is
  computed in each tick in which the arm moves. A step of 0.04 s looks at the moving arm every 40 ms only: signals
  and lines stay exact, and the least and greatest values of the arm are those at these moments.
- `always` over nothing is true, `eventually` false. `before(a, b)` holds if a and b begin in the same tick, and if
  b never holds; it does not if b holds and a never did. `first` has no value if it never holds.

## Functions of numbers

Also `len(x)` of a text, list or table.
"""

MEANING: Final = """\
## Units

Times are in s, lengths in m, angles in rad. What has different units is neither compared nor added:
`always(q[0] > tcp[0])` is refused. Numbers that are written, registers and globals fit to any unit.

## Margins

A comparison of numbers has a *margin*: how far its sides are apart, negative if it does not hold. `and` has the
smallest of its parts, `or` the largest, `not` the opposite, `always` the smallest over time and `eventually`
the largest. So a margin says how near a run was to the other answer, and its time says when. Parts without
numbers count as if their margin were infinite. `before` has the time between the two. Margins of different
units are never compared with each other: each is told by itself. So it is with registers and globals, whose
units are not known.

## What has no value

A division by zero, a global that was never set, an alarm that did not come, the root of a negative number: an
expression that comes to such a part has no value. Then the property does not hold, with the reason, and the
measure is empty. `and` and `or` go from left to right and stop once the answer is certain, as in
`len(alarms) == 0 or alarms[0]["line"] > 10`.

## Functions of your own

`--ensure checks.py:is_stacked` calls a function of a Python file with the finished `Run` of each run; it
returns True or False (of `--measure` a number). If it raises an exception, the property does not hold, and
file and line are the reason. The file is loaded anew for each run.
"""


def expressions_page() -> str:
    """What `--ensure` and `--measure` take."""
    return "\n".join(
        (
            *INTRODUCTION.format(notice=NOTICE, exponent=EXPONENT_MAX, length=TEXT_MAX, depth=DEPTH_MAX).splitlines(),
            "",
            "```elitescript",
            *PROGRAM.splitlines(),
            "```",
            "",
            *THE_RECORD.format(alarm=_names(ALARM), contact=_names(CONTACT)).splitlines(),
            "",
            *_table("name", ((name, row.summary, OF_RECORD[name]) for name, row in RECORD.items())),
            "",
            *OVER_A_RUN.splitlines(),
            "",
            *_table(
                "function",
                (
                    (f"{name}({'e' if row.arguments == 1 else 'a, b'})", row.summary, OVER[name])
                    for name, row in FUNCTIONS_OVER_TIME.items()
                ),
            ),
            "",
            *_table("name", ((name, row.summary, OF_TIME[name]) for name, row in OVER_TIME.items())),
            "",
            *MOMENTS.splitlines(),
            "",
            *_table("function", ((name, row.summary, OF_FUNCTIONS[name]) for name, row in FUNCTIONS.items())),
            "",
            *MEANING.splitlines(),
            "",
        )
    )


def _names(names: Iterable[str]) -> str:
    return ", ".join(map(code, names))


def _table(head: str, rows: Iterable[tuple[str, str, str]]) -> list[str]:
    rows = list(rows)
    return [
        f"| {head} | is | example | comes to |",
        "|---|---|---|---|",
        *(
            f"| `{name}` | {cell(summary)} | {code(example)} | {cell(outcome(example))} |"
            for name, summary, example in rows
        ),
    ]


def outcome(text: str) -> str:
    """Return what an expression comes to, with the program of the page."""
    is_number = not _is_property(text)
    checks = Checks([] if is_number else [parse_property(text)], {"x": parse_measure(text)} if is_number else {})
    watching = checks.watch()
    results = watching.results(_run(watching.trace))
    if is_number:
        value = results.measures["x"]
        return f"{value:.4g}" if value is not None else f"no value: {results.reasons['x']}"
    verdict = results.verdicts[0]
    margin = "" if verdict.margin is None else f", margin {verdict.margin:.4g} {verdict.unit}".rstrip()
    when = "" if verdict.t is None else f" at {verdict.t:g} s"
    return f"{'holds' if verdict.holds else 'does not hold'}{margin}{when}" + (
        f": {verdict.words}" if not verdict.holds and verdict.margin is None else ""
    )


def _is_property(text: str) -> bool:
    try:
        parse_property(text)
    except UsageError:
        return False
    return True


def _run(trace: object) -> Run:
    return VirtualRobot("CS66").run(PROGRAM, trace=trace)  # type: ignore[arg-type]
