"""Runs the programs of pyperformance on a virtual robot and by CPython: the same output, and how much slower.

A program is taken as it is, but for its import of `pyperf` and lines like `__author__ = ...`. What it measures with is
replaced by `RUNNER`, which calls once and notes the result. Those that the language policy refuses are named.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import exp, log
from pathlib import Path
from typing import Final

from tests.foreign.comparing import plain
from tests.foreign.running import Outcome, run_all
from tests.foreign.sources import words_of

NAMES: Final[dict[str, tuple[int, str]]] = {
    "barnes_hut": (1, ""),
    "chaos": (2, ""),
    "comprehensions": (30, "[str(widget) for widget in make_some_widgets()][:3]"),
    "decimal_factorial": (1, ""),
    "decimal_pi": (1, ""),
    "deepcopy": (1, ""),
    "deltablue": (30, ""),
    "fannkuch": (1, "fannkuch(7)"),
    "float": (2, ""),
    "generators": (2, ""),
    "go": (3, ""),
    "hexiom": (10, ""),
    "json_loads": (200, ""),
    "mdp": (1, ""),
    "meteor_contest": (2, ""),
    "nbody": (3, "report_energy()"),
    "nqueens": (3, "list(n_queens(5))"),
    "pidigits": (1, ""),
    "raytrace": (1, ""),
    "regex_dna": (1, ""),
    "regex_effbot": (3, ""),
    "richards": (4, ""),
    "richards_super": (4, ""),
    "scimark": (1, ""),
    "spectral_norm": (2, "[eval_A(i, 3) for i in range(9)]"),
    "typing_runtime_protocols": (10, ""),
    "unpack_sequence": (300, ""),
}
"""Programs: how often each is called, and an expression whose value is noted after it where it shows little itself."""
ANOTHER: Final = "another output"
ROUNDS: Final = 3
CPU_S: Final = 120
WALL_S: Final = 400.0
TIMED_S: Final = 0.05
"""A program that CPython runs in less is not timed."""
RUNNER: Final = """
global foreign_end, foreign_notes
foreign_notes = []
foreign_end = []
class foreign_Arguments:
    def __init__(self):
        self.benchmark = None
        self.filename = None
        self.force_bytes = False
        self.cases = None
    def add_argument(self, name, *names, **options):
        setattr(self, name.strip("-").replace("-", "_"), options.get("default"))
class foreign_Runner:
    def __init__(self, **options):
        self.metadata = {}
        self.argparser = foreign_Arguments()
    def parse_args(self):
        return self.argparser
    def bench_func(self, name, function, *arguments, **options):
        for number in range(LOOPS):
            value = function(*arguments)
        foreign_notes.append([name, repr(value)[:500]])
    def bench_time_func(self, name, function, *arguments, **options):
        function(LOOPS, *arguments)
        foreign_notes.append([name])
class foreign_Pyperf:
    def __init__(self):
        self.Runner = foreign_Runner
    def perf_counter(self):
        return 0.0
pyperf = foreign_Pyperf()
"""
FUTURE: Final = "from __future__ import annotations\n"


@dataclass(frozen=True, slots=True)
class Timed:
    """One program.

    Attributes:
        python_s, robot_s: processor time of the run, s; the best of some.
        why: what differs, or why it was not run; empty if it gives the same output.
    """

    name: str
    python_s: float
    robot_s: float
    why: str = ""

    @property
    def ratio(self) -> float | None:
        """How much slower; None for what was not run or is too short."""
        return self.robot_s / self.python_s if not self.why and self.python_s > TIMED_S else None


def program_of(text: str, loops: int = 1, noted: str = "") -> str:
    """Return a program of pyperformance as one that runs by itself."""
    tree = ast.parse(text)
    lines = text.split("\n")
    for node in tree.body:
        is_left_out = (isinstance(node, ast.Import) and node.names[0].name in ("pyperf", "six")) or (
            isinstance(node, ast.Assign)
            and isinstance(node.targets[0], ast.Name)
            and node.targets[0].id.startswith("__")
        )
        if is_left_out or (isinstance(node, ast.ImportFrom) and node.module == "__future__"):
            lines[node.lineno - 1 : node.end_lineno] = [""] * ((node.end_lineno or node.lineno) - node.lineno + 1)
        elif isinstance(node, ast.If) and "__name__" in ast.unparse(node.test):
            lines[node.lineno - 1] = "if True:"
    last = f"foreign_notes.append(['noted', repr({noted})])\n" if noted else ""
    first = FUTURE if FUTURE in text else ""
    shared = ", ".join(sorted(words_of(text).declared | {"foreign_end", "foreign_notes"}))
    runner = f"global {shared}{RUNNER.replace('LOOPS', str(loops))}"
    return f"{first}{runner}{chr(10).join(lines)}\n{last}foreign_end.append(['passed', '', ''])\n"


def timed(folder: Path, width: int = 1) -> Iterator[Timed]:
    """Run the programs below the folder of pyperformance."""
    for name, (loops, noted) in NAMES.items():
        file = folder / "pyperformance" / "data-files" / "benchmarks" / f"bm_{name}" / "run_benchmark.py"
        if not file.is_file():
            yield Timed(name, 0.0, 0.0, "pyperformance does not have it")
            continue
        text = program_of(file.read_text(encoding="utf-8"), loops, noted)
        jobs = [((side, number), side, text) for number in range(ROUNDS) for side in ("python", "robot")]
        found: dict[str, list[Outcome]] = {"python": [], "robot": []}
        for (side, _), outcome in run_all(jobs, width, CPU_S, WALL_S):
            found[side].append(outcome)
        yield judged(name, found["python"], found["robot"])


def judged(name: str, python: list[Outcome], robot: list[Outcome]) -> Timed:
    """Return the row of a program."""
    first, other = python[0], robot[0]
    why = ""
    if first.end != "passed":
        why = f"CPython: {first.end} {first.kind}: {first.text}"
    elif other.end != "passed":
        why = f"{other.end} {other.kind}: {other.text}"
    elif [list(map(plain, note)) for note in first.notes] != [list(map(plain, note)) for note in other.notes]:
        why = ANOTHER
    return Timed(name, min(each.cpu_s for each in python), min(each.cpu_s for each in robot), why)


def summary(rows: Sequence[Timed]) -> tuple[int, float, float]:
    """Return how many programs give the same output, and mean and worst ratio of those that are long enough."""
    ratios = [row.ratio for row in rows if row.ratio is not None]
    mean = exp(sum(map(log, ratios)) / len(ratios)) if ratios else 0.0
    return sum(not row.why for row in rows), mean, max(ratios, default=0.0)
