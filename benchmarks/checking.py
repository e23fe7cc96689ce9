"""Checks of long texts: all of it, the evaluation of values in it, and the rules that take longest.

`python -m benchmarks.growth checks` measures how each kind of text grows.
"""

from __future__ import annotations

import gc
from functools import partial
from itertools import cycle
from time import process_time

from benchmarks.measure import best_in_turn
from benchmarks.table import Row, Time, timed_row

STATEMENTS = 5_000
ROUNDS = 5
SHOWN_RULES = 8

MIXED = (
    "  x = {n} * 0.001 + get_standard_analog_in(0)\n",
    "  movej([0.{d}, -1.57, 1.2, -1.0, -1.57, 0], a=1.4, v=1.05)\n",
    "  if x > 0.5 and get_standard_digital_in({d}):\n    set_standard_digital_out({d}, True)\n  end\n",
    "  p = pose_add(get_target_tcp_pose(), [0, 0, 0.0{d}, 0, 0, 0])\n",
    "  write_output_integer_register({d}, {n})\n",
)
"""Statements of a text in which nothing repeats: arithmetic, moves, conditions, poses, registers."""

KINDS: dict[str, tuple[str, tuple[str, ...]]] = {
    "mixed statements": ("  x = 0\n", MIXED),
    "straight moves": ("", ("  movel([0.4, 0.{d}, 0.{n:05}, 3.14, 0, 0], a=1.2, v=0.25, r=0.001)\n",)),
    "functions": (
        "  def part(x, y):\n    return x\n  end\n",
        (
            "  def part{n}(x, y):\n    z = x + y * {d}\n    if z > 3:\n      set_standard_digital_out({d}, True)\n"
            "      return z\n    end\n    return part(x, 1)\n  end\n  textmsg(part{n}({d}, 1))\n",
        ),
    ),
    "threads": (
        "",
        (
            "  def watch{n}():\n    global go{n}\n    while True:\n      go{n} = get_standard_digital_in({d})\n"
            "      sync()\n    end\n  end\n  t{n} = start_thread(watch{n}, ())\n",
        ),
    ),
    "nested branches": (
        "  x = 0\n  y = 0\n",
        (
            "  if get_standard_digital_in({d}):\n    x = {n}\n    if x > y:\n      y = x\n    elif get_flag(1):\n"
            "      y = 3\n    else:\n      for k in range(3):\n        y = y + k\n      end\n    end\n  end\n",
        ),
    ),
    "lists that change": (
        "  parts = []\n",
        ("  q = get_actual_joint_positions()\n  q[0] = q[0] + 0.{d}\n  a = q\n  parts.append(a)\n",),
    ),
    "globals": ("  global count\n  count = 0\n", ("  def set{n}():\n    global count\n    count = {n}\n  end\n",)),
    "blends and outputs": (
        "",
        (
            "  movel([0.4, 0.{d}, 0.4, 3.14, 0, 0], v=0.1, r=0.01)\n  set_standard_digital_out({d}, True)\n"
            "  movel([0.5, 0.{d}, 0.4, 3.14, 0, 0], v=0.1)\n",
        ),
    ),
}
"""Kinds of texts: what stands in front, and the parts that repeat; `n` counts them, `d` is a digit."""


def text_of(kind: str, lines: int) -> str:
    """Return a text of about so many lines."""
    head, parts = KINDS[kind]
    text, length = ["def job():\n", head], head.count("\n") + 2
    for number, part in enumerate(cycle(parts)):
        text.append(part.format(n=number, d=number % 8))
        length += part.count("\n")
        if length >= lines:
            break
    return "".join([*text, "end\n"])


def mixed(statements: int) -> str:
    """Return a text of so many statements of the kinds of `MIXED`."""
    return "".join(
        [
            "def job():\n  x = 0\n",
            *(MIXED[n % len(MIXED)].format(n=n % 1000, d=n % 8) for n in range(statements)),
            "end\n",
        ]
    )


def rows() -> list[Row]:
    """Check a text of 5,000 statements."""
    from elitescript.language.options import Options
    from elitescript.language.parser import parse
    from elitescript.language.text.source import SourceFile
    from elitescript.lint.engine import check_source
    from elitescript.lint.program import AnalysedProgram
    from elitescript.lint.registry import rules_for
    from elitescript.messages.profile import profile

    source = SourceFile("long.script", mixed(STATEMENTS))
    parsed = parse(source, Options())
    steps = {
        "all of it": partial(check_source, source, profile()),
        "read the text": partial(parse, source, Options()),
        "scopes and nodes": partial(AnalysedProgram, parsed, profile()),
        "scopes, nodes and values of expressions": lambda: AnalysedProgram(parsed, profile()).values,
    }
    times = dict(zip(steps, best_in_turn(list(steps.values()), ROUNDS), strict=True))
    rules: dict[str, float] = {}
    # As in a check.
    gc.disable()
    for _ in range(ROUNDS):
        program = AnalysedProgram(parsed, profile())
        assert program.values.is_known
        for rule in rules_for(source.text):
            began = process_time()
            list(rule.check(program))
            rules[rule.code] = min(process_time() - began, rules.get(rule.code, 1e9))
    gc.enable()
    title = f"check of {STATEMENTS:,} statements"
    found = [timed_row(f"{title}: {what}", time) for what, time in times.items()]
    found.append(timed_row(f"{title}: all rules", Time(sum(rules.values()), sum(rules.values()))))
    slowest = sorted(rules, key=lambda code: -rules[code])[:SHOWN_RULES]
    found += [timed_row(f"{title}: {code}", Time(rules[code], rules[code])) for code in slowest]
    return found
