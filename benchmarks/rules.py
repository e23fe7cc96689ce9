"""How the time of each rule of the checker grows with the text, alone: 1 is linear, 2 quadratic.

The texts are the rule's own example, again and again: in functions of one program, and in one body. What is known of a
text before its rules, the values of its expressions among it, is made before. `RULES_LINES=2000,40000` are the sizes,
`python -m benchmarks.rules W202 E304` measures some rules.
"""

from __future__ import annotations

import gc
import os
import re
import sys
from collections.abc import Iterator
from math import log
from textwrap import indent
from time import process_time

from benchmarks.table import Row, print_rows

LINES = tuple(int(size) for size in os.environ.get("RULES_LINES", "2000,10000,40000").split(","))
LEAST_S = 0.5e-3
"""Times below are too short to say how they grow."""
STEEP = 1.15
ROUNDS = 3


def texts(example: str, lines: int) -> Iterator[tuple[str, str]]:
    """Yield the ways in which an example is repeated, and texts of about so many lines."""
    body = "\n".join(row for row in example.split("\n") if row.strip())
    found = re.match(r"def (\w+)\(\):[^\n]*\n(.*)\nend\b", body, re.DOTALL)
    if found is not None:
        count = max(1, lines // (body.count("\n") + 2))
        part = indent(body, "  ")
        parts = "".join(
            f"{part.replace(f'def {found[1]}()', f'def {found[1]}{n}()', 1)}\n  {found[1]}{n}()\n" for n in range(count)
        )
        yield "functions", f"def program():\n{parts}end\n"
        yield "one body", f"def program():\n{(found[2] + chr(10)) * count}end\n"


def rows(codes: tuple[str, ...] = ()) -> list[Row]:
    """Return one row for each rule and way, the steepest first."""
    from elitescript.lint.registry import all_rules

    measured = []
    for rule in all_rules():
        if codes and rule.code not in codes:
            continue
        example = "\n".join(row[4:] for row in rule.explanation.split("\n") if row.startswith("    "))
        times: dict[str, list[float]] = {}
        for lines in LINES:
            for way, text in texts(example, lines):
                times.setdefault(way, []).append(_time(rule.code, text))
        measured += [(rule.code, way, found) for way, found in times.items()]
    shown = [_row(*found) for found in measured]
    return sorted(shown, key=lambda row: -(row.value or 0.0))


def _time(code: str, text: str) -> float:
    """Return the CPU time of one rule, s."""
    from elitescript.language.options import Options
    from elitescript.language.parser import parse
    from elitescript.language.text.source import SourceFile
    from elitescript.lint.program import AnalysedProgram
    from elitescript.lint.registry import all_rules
    from elitescript.messages.profile import profile

    rule = next(rule for rule in all_rules() if rule.code == code)
    parsed = parse(SourceFile("long.script", text), Options())
    best = 1e9
    gc.collect()
    gc.disable()
    for _ in range(ROUNDS):
        program = AnalysedProgram(parsed, profile())
        assert program.values.symbols is program.symbols
        began = process_time()
        list(rule.check(program))
        best = min(best, process_time() - began)
    gc.enable()
    return best


def _row(code: str, way: str, times: list[float]) -> Row:
    said = ", ".join(f"{1e3 * time:.3g} ms of {lines:,} lines" for lines, time in zip(LINES, times, strict=True))
    exponent = 0.0
    if len(times) > 1 and times[-1] > LEAST_S:
        exponent = log(max(times[-1], LEAST_S / 10) / max(times[-2], LEAST_S / 10)) / log(LINES[-1] / LINES[-2])
    return Row(f"growth of {code}, {way}", value=exponent, words=said + ("; steep" if exponent > STEEP else ""))


if __name__ == "__main__":
    print_rows(rows(tuple(sys.argv[1:])))
