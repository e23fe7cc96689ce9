"""Probes count statements and sides of branches, and change nothing."""

from __future__ import annotations

from random import Random

import pytest

from elitescript.language.compiler import compile_unit
from elitescript.language.options import Options
from elitescript.language.text.source import SourceFile
from elitescript.records import replace
from elitescript.robot import VirtualRobot
from elitescript.runtime import probe as seam
from tests.debugger.random_programs import random_program
from tests.invariants.cases import CASES


class Counter:
    """A probe that counts; `log` holds the numbers of statements in the order in which they ran."""

    def __init__(self, kind: str) -> None:
        self.kind = kind
        self.size = 0
        self.hits: list[int] = []
        self.entries: list[object] = []
        self.log: list[int] = []

    def options(self, options, source):
        return replace(options, probes=self.kind, first_probe=self.size)

    def compiled(self, unit):
        self.size += unit.probes.size
        self.hits += [0] * unit.probes.size
        self.entries += [bool] * unit.probes.size

    def hooks(self):
        return {"@hits": self.hits, "@steps": self.entries, "@step": self.step}

    def step(self, number):
        self.log.append(number)
        return (1).__bool__


PROGRAM = """def job():
  global total
  "a comment"
  total = 0
  def add(n):
    "adds"
    global total
    total = total + n
  end
  def nothing():
    "does nothing"
  end
  for n in range(10):
    add(n)
    if n > 20:
      total = -1
    end
  end
  while total > 40:
    total = total - 1
  end
  if total == 40:
    pass
  elif total == 41:
    nothing()
  end
  match total:
    case 1:
      nothing()
  end
  nothing()
end
"""


def compiled(text, kind, **options):
    return compile_unit(SourceFile("job.script", text), Options(probes=kind, **options))


@pytest.mark.parametrize("last", ["_ as other", "2 | _", "1 | (_ as other)", "(other)", "(2 | (3 | _))"])
def test_a_last_case_that_takes_all_needs_no_other_side(last):
    if "other" in last and "|" in last:
        last = last.replace("1 ", "(1 as other) ")
    text = f"def job():\n  match 1:\n    case 0:\n      pass\n    case {last}:\n      pass\n  end\nend\n"
    assert [side.line for side in compiled(text, "coverage").probes.branches] == [4, 6]


def test_statements_by_hand():
    table = compiled(PROGRAM, "steps").statements
    assert [(row.line, row.column, row.end_line, row.end_column, row.function) for row in table] == [
        (4, 3, 4, 12, ""),
        (5, 3, 5, 14, ""),
        (8, 5, 8, 22, "add"),
        (10, 3, 10, 17, ""),
        (13, 3, 13, 21, ""),
        (14, 5, 14, 11, ""),
        (15, 5, 15, 14, ""),
        (16, 7, 16, 17, ""),
        (19, 3, 19, 19, ""),
        (20, 5, 20, 22, ""),
        (22, 3, 22, 17, ""),
        (23, 5, 23, 9, ""),
        (24, 3, 24, 19, ""),
        (25, 5, 25, 14, ""),
        (27, 3, 27, 14, ""),
        (29, 7, 29, 16, ""),
        (31, 3, 31, 12, ""),
    ]
    assert [row.number for row in table] == list(range(17))


def test_coverage_by_hand():
    probe = Counter("coverage")
    robot = VirtualRobot(probe=probe)
    unit = robot.compile(PROGRAM)
    robot.run(unit)
    lines = {row.line: probe.hits[row.number] for row in unit.statements}
    assert lines == {
        4: 1,
        5: 1,
        8: 10,
        10: 1,
        13: 1,
        14: 10,
        15: 10,
        16: 0,
        19: 1,
        20: 5,
        22: 1,
        23: 1,
        24: 0,
        25: 0,
        27: 1,
        29: 0,
        31: 1,
    }
    line_of = {row.number: row.line for row in unit.statements}
    branches = [(line_of[side.statement], side.line, probe.hits[side.number]) for side in unit.probes.branches]
    assert branches == [
        *[(13, 14, 10), (13, 13, 1)],
        *[(15, 16, 0), (15, 15, 10)],
        *[(19, 20, 5), (19, 19, 1)],
        *[(22, 23, 1), (22, 24, 0)],
        *[(24, 25, 0), (24, 24, 0)],
        *[(27, 29, 0), (27, 27, 1)],
    ]
    functions = [(row.name, row.line, row.end_line, probe.hits[row.number]) for row in unit.probes.functions]
    assert functions == [("add", 5, 8, 10), ("nothing", 10, 11, 1)]


def test_a_condition_of_while_is_a_statement_each_time():
    probe = Counter("steps")
    robot = VirtualRobot(probe=probe)
    unit = robot.compile("n = 2\nwhile n > 0:\n  n = n - 1\nend\ntextmsg(n)\n")
    robot.run(unit)
    assert [unit.statements[number].line for number in probe.log] == [1, 2, 3, 2, 3, 2, 5]


@pytest.mark.parametrize("work", [10_000, 25])
def test_both_copies_of_a_short_loop_count(work):
    probe = Counter("steps")
    robot = VirtualRobot(probe=probe, work_per_tick=work)
    unit = robot.compile("def f():\n  for k in range(10):\n    a = k\n  end\nend\nf()\n")
    robot.run(unit)
    assert [unit.statements[number].line for number in probe.log] == [1, 6, 2, *[3] * 10]
    assert (robot.tick > 0) == (work == 25)  # there only the copy with checkpoints can be paid for


def test_secondary_programs_and_clients_count_and_eval_does_not():
    probe = Counter("coverage")
    robot = VirtualRobot(probe=probe)
    robot.submit_secondary("sec one():\n  set_standard_digital_out(1, True)\nend\n")
    primary = robot.connect("primary")
    primary.send(b"def job():\n  exec('a = 1')\n  eval('1 + 1')\n  sync()\nend\n")
    robot.advance(0.1)
    assert probe.hits == [1, 1, 1, 1]


def test_a_default_probe_counts_in_every_robot():
    probe = Counter("coverage")
    seam.set_default(lambda: probe)
    try:
        VirtualRobot().run("a = 1\n")
        VirtualRobot().run("a = 1\nb = 2\n")
    finally:
        seam.set_default(None)
    VirtualRobot().run("a = 1\n")
    assert probe.hits == [1, 1, 1]


def test_nothing_is_inserted_that_nobody_asks_for():
    unit = compile_unit(SourceFile("job.script", PROGRAM))
    assert unit.statements == () and unit.probes.size == 0
    names = {name for code in _codes(unit.code) for name in code.co_names}
    assert not names & {"@steps", "@step", "@hits"}


def _codes(code):
    yield code
    for item in code.co_consts:
        if isinstance(item, type(code)):
            yield from _codes(item)


@pytest.mark.parametrize("text", ["a = ", "def f(:\n", "x = 1\n  y = 2\n", "while True:\nend\n", "nonlocal a\n"])
@pytest.mark.parametrize("kind", ["steps", "coverage"])
def test_mistakes_are_reported_alike(text, kind):
    def problems(**options):
        try:
            return compile_unit(SourceFile("a.script", text), Options(**options)).diagnostics
        except Exception as error:
            return error.problems

    assert problems() == problems(probes=kind)


def outcome(text, seed, probe):
    robot = VirtualRobot(probe=probe, seed=seed, work_per_tick=150, joints=[0, -1.57, 1.57, -1.57, 1.57, 0])
    robot.at(0.5, "standard_digital_in[0]", True)
    run = robot.run(text, until_s=60)
    return run.state, robot.tick, run.events, run.joints, {**run.globals}


def test_random_programs_do_the_same_with_and_without():
    ends = set()
    for seed in range(max(8, CASES // 4)):
        text = random_program(Random(seed))
        plain = outcome(text, seed, None)
        ends.add(plain[0])
        steps, coverage = Counter("steps"), Counter("coverage")
        assert outcome(text, seed, steps) == plain, seed
        assert outcome(text, seed, coverage) == plain, seed
        assert len(steps.log) > 10 and sum(coverage.hits) > 10
    assert "alarm" in ends and "finished" in ends


@pytest.mark.parametrize("kind", ["steps", "coverage"])
def test_the_recursion_limit_is_where_it_was(kind):
    text = "def job():\n  global n\n  n = 0\n  def f():\n    global n\n    n = n + 1\n    f()\n  end\n  f()\nend\n"
    probe = Counter(kind)
    robot = VirtualRobot(probe=probe)
    unit = robot.compile(text)
    steps = [True] * 10_000
    probe.entries[:] = [steps.pop] * len(probe.entries)
    plain, counted = VirtualRobot().run(text), robot.run(unit)
    assert plain.alarms[0].class_name == "RecursionError"
    assert counted.globals == plain.globals and counted.events == plain.events
