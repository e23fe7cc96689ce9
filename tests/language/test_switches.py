"""Programs that a debugger may look at later: the same as without, and every statement is seen once somebody looks."""

from __future__ import annotations

from random import Random
from typing import Any

import pytest

from elitescript.language.compiler import compile_unit
from elitescript.language.options import Options
from elitescript.language.text.source import SourceFile
from elitescript.robot import VirtualRobot
from tests.debugger.random_programs import random_program
from tests.invariants.cases import CASES
from tests.language.test_probes import Counter

ATTACH = Options(probes="attach")


class Silent(Counter):
    """Compiles for a debugger that may come."""

    def __init__(self) -> None:
        super().__init__("attach")

    def hooks(self) -> dict[str, object]:
        return {}


def seen(text: str, *, work: int = 10_000, kind: str = "attach") -> list[int]:
    """The lines of the statements that a watcher sees, in their order."""
    probe: Any = Silent() if kind == "attach" else Counter(kind)
    robot = VirtualRobot(probe=probe, work_per_tick=work)
    unit = robot.compile(text)
    robot._kernel.host.scheduler.watch(lambda strand, number: probe.log.append(number))
    robot.run(unit, until_s=20)
    return [unit.statements[number].line for number in probe.log]


TEXTS = {
    "a loop that only computes": "n = 0\nwhile n < 3:\n  n = n + 1\n  if n == 2:\n    n = n\n  end\nend\nm = n\n",
    "a loop with a wait": "for k in range(2):\n  a = k\n  b = a\n  sync()\n  c = b\nend\n",
    "a loop that waits at once": "for k in range(2):\n  sync()\n  c = k\nend\n",
    "a loop that pays at its start": "n = 0\nfor k in range(10):\n  n += k\nend\nn = 1\n",
    "loops in loops": "for k in range(2):\n  a = k\n  for j in range(2):\n    b = j\n  end\n  c = 1\nend\n",
    "functions": "def f(n):\n  'doc'\n  global g\n  g = n\n  if n < 1:\n    return 0\n  end\n"
    "  return f(n - 1)\nend\nf(3)\n",
    "an empty function": "def f():\n  pass\nend\nf()\n",
    "a generator": "def g():\n  for k in range(2):\n    yield k\n  end\nend\nfor v in g():\n  w = v\nend\n",
    "exceptions": "for k in range(2):\n  try:\n    a = 1 / k\n  except ZeroDivisionError:\n    b = 1\n  else:\n"
    "    c = 1\n  finally:\n    d = 1\n  end\nend\n",
    "match": "for k in range(3):\n  match k:\n    case 0:\n      a = 1\n    case _:\n      b = 1\n  end\nend\n",
    "a class": "class A:\n  x = 1\n  def f(self):\n    self.y = 1\n  end\nend\na = A()\na.f()\n",
    "with": "import threading\nlock = threading.Lock()\nfor k in range(2):\n  with lock:\n    a = k\n  end\nend\n",
    "else of loops": "for k in range(2):\n  a = k\nelse:\n  b = 1\nend\n"
    "n = 2\nwhile n:\n  n = n - 1\nelse:\n  c = 1\nend\n",
    "break": "n = 0\nwhile True:\n  n = n + 1\n  if n > 2:\n    break\n  end\nend\nm = n\n",
}


@pytest.mark.parametrize("work", [10_000, 25])
@pytest.mark.parametrize("name", TEXTS)
def test_a_watcher_sees_each_statement_that_a_counter_counts(name: str, work: int) -> None:
    assert seen(TEXTS[name], work=work) == seen(TEXTS[name], work=work, kind="steps") != []


def test_a_continue_leaves_out_the_condition_behind_it() -> None:
    text = "n = 0\nwhile n < 2:\n  n = n + 1\n  continue\nend\n"
    assert seen(text) == [1, 2, 3, 4, 3, 4]
    assert seen(text, kind="steps") == [1, 2, 3, 4, 2, 3, 4, 2]


def test_a_watcher_that_comes_later_sees_all_from_then_on() -> None:
    probe = Silent()
    robot = VirtualRobot(probe=probe)
    text = "n = 0\nwhile n < 50:\n  n = n + 1\n  sync()\n  a = n\n  b = a\nend\n"
    robot.start(robot.compile(text))
    robot.advance(0.1)
    assert probe.log == []
    robot._kernel.host.scheduler.watch(lambda strand, number: probe.log.append(number))
    robot.advance(0.008)
    robot._kernel.host.scheduler.watch(None)
    robot.advance(0.1)
    assert [number + 1 for number in probe.log] == [5, 6, 2, 3, 4, 5, 6, 2, 3, 4]


def outcome(text: str, seed: int, probe: Any, log: list[int] | None = None) -> Any:
    """What a program does; `log` gets the statements that a watcher sees."""
    robot = VirtualRobot(probe=probe, seed=seed, work_per_tick=150, joints=[0, -1.57, 1.57, -1.57, 1.57, 0])
    robot.at(0.5, "standard_digital_in[0]", True)
    unit = robot.compile(text)
    if log is not None:
        robot._kernel.host.scheduler.watch(lambda strand, number: log.append(number))
    run = robot.run(unit, until_s=60)
    return run.state, robot.tick, run.events, run.joints, {**run.globals}


def test_random_programs_do_the_same() -> None:
    for seed in range(max(8, CASES // 4)):
        text = random_program(Random(seed))
        plain, steps, log = outcome(text, seed, None), Counter("steps"), []
        assert outcome(text, seed, Silent()) == plain, seed
        assert outcome(text, seed, Silent(), log) == plain, seed
        assert outcome(text, seed, steps) == plain, seed
        assert log == steps.log, seed


def test_the_recursion_limit_is_where_it_was() -> None:
    text = "def job():\n  global n\n  n = 0\n  def f():\n    global n\n    n = n + 1\n    f()\n  end\n  f()\nend\n"
    probe = Silent()
    robot = VirtualRobot(probe=probe)
    plain, ours = VirtualRobot().run(text), robot.run(robot.compile(text))
    assert plain.alarms[0].class_name == "RecursionError"
    assert ours.globals == plain.globals and ours.events == plain.events


def test_a_loop_that_only_computes_calls_nothing_before_somebody_looks() -> None:
    text = "def job():\n  n = 0\n  while n < 9:\n    n = n + 1\n    if n > 5:\n      n = n + 1\n    end\n  end\nend\n"
    unit = compile_unit(SourceFile("job", text), ATTACH)
    codes = [code for code in unit.code.co_consts if hasattr(code, "co_code")]
    plain = compile_unit(SourceFile("job", text))
    assert "@at" in codes[0].co_names
    assert unit.probes.size == 5 and plain.probes.size == 0


@pytest.mark.parametrize("text", ["a = ", "def f(:\n", "x = 1\n  y = 2\n", "nonlocal a\n", "a = 1\nglobal a\n"])
def test_mistakes_are_reported_alike(text: str) -> None:
    def problems(options: Options) -> Any:
        try:
            return compile_unit(SourceFile("a.script", text), options).diagnostics
        except Exception as error:
            return error.problems  # type: ignore[attr-defined]

    assert problems(Options()) == problems(ATTACH)


def test_events_cost_a_watched_program_as_much_of_its_tick() -> None:
    text = "for k in range(500):\n  textmsg(k)\nend\n"
    ticks = outcome(text, 0, None)[1]
    assert ticks > 10
    assert abs(outcome(text, 0, Silent(), [])[1] - ticks) <= ticks // 20
