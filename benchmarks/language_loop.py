"""What checkpoints cost: programs that only compute, against the same text as plain Python.

Ours is compiled code with the cheapest possible hooks, `fuel.pop() or cp()` and payments of short loops, as the runtime
has them; nothing is scheduled. Both run in turn, and the best of several runs counts.
"""

from __future__ import annotations

import builtins
from collections.abc import Callable
from math import prod
from typing import Any

from benchmarks.measure import best_in_turn
from benchmarks.table import Row, print_rows, timed_row
from elitescript.language.compiler import compile_unit
from elitescript.language.hooks import ATTRIBUTE, CHECKPOINT, LINE, LOOP, MAIN, PAY, RANGE, STOP, TICK
from elitescript.language.text.dialect import translate
from elitescript.language.text.source import SourceFile

RUNS = 15
FUEL = 10_000

PROGRAMS = {
    "for loop, nearly empty body": """
def job():
  total = 0
  for i in range(60000):
    total += i
  end
end
""",
    "while loop, arithmetic": """
def job():
  x = 0.0
  n = 0
  while n < 30000:
    x = x * 0.5 + n
    n = n + 1
  end
end
""",
    "while loop, global variables": """
def job():
  global n, level
  n = 0
  level = 0
  while n < 20000:
    level = level + n % 7
    n = n + 1
  end
end
""",
    "recursive function": """
def job():
  def fib(n):
    if n < 2:
      return n
    end
    return fib(n - 1) + fib(n - 2)
  end
  fib(17)
end
""",
    "lists, dicts, text": """
def job():
  counts = {}
  for i in range(4000):
    key = "k%d" % (i % 50)
    if key in counts:
      counts[key].append(i)
    else:
      counts[key] = [i]
    end
  end
  parts = [str(len(v)) for v in counts.values()]
  line = ",".join(parts)
end
""",
    "4x4 matrix products": """
def job():
  a = [[1.0, 0.1, 0.0, 0.2], [0.0, 1.0, 0.3, 0.1], [0.2, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
  c = a
  for n in range(150):
    d = []
    for i in range(4):
      row = []
      for j in range(4):
        s = 0.0
        for k in range(4):
          s += c[i][k] * a[k][j]
        end
        row.append(s)
      end
      d.append(row)
    end
    c = d
  end
end
""",
    "method calls": """
def job():
  class Counter:
    def __init__(self):
      self.value = 0
    end
    def add(self, n):
      self.value += n
    end
  end
  counter = Counter()
  for i in range(15000):
    counter.add(i)
  end
end
""",
    "comprehensions": """
def job():
  for n in range(300):
    squares = [i * i for i in range(50)]
    total = sum(v for v in squares if v % 2)
  end
end
""",
}


def rows() -> list[Row]:
    """Each program beside plain Python, and the mean of their ratios."""
    table = []
    ratios = []
    for what, text in PROGRAMS.items():
        ours, plain = best_in_turn([_instrumented(text), _plain(text)], RUNS)
        ratios.append(ours.cpu_s / plain.cpu_s)
        table.append(timed_row(what, ours, other=plain.cpu_s, beside="a plain Python loop"))
    mean = prod(ratios) ** (1 / len(ratios))
    words = f"geometric mean; {min(ratios):.2f} to {max(ratios):.2f}"
    return [*table, Row("language loops", "x plain Python", value=mean, words=words)]


def _instrumented(text: str) -> Callable[[], object]:
    fuel: list[bool] = []

    def refill() -> bool:
        fuel[:] = [False] + [True] * FUEL
        return True

    def pay(count: int) -> bool:
        if len(fuel) <= count:
            return False
        del fuel[-count:]
        return True

    def nothing(*_: object) -> None: ...

    refill()
    hooks = {
        TICK: fuel.pop,
        CHECKPOINT: refill,
        PAY: pay,
        RANGE: range,
        STOP: KeyboardInterrupt,
        LINE: nothing,
        LOOP: bool,
    }
    hooks[ATTRIBUTE] = getattr
    namespace: dict[str, Any] = {"__builtins__": {**vars(builtins), **hooks}}
    exec(compile_unit(SourceFile("benchmark", text)).code, namespace)
    program: Callable[[], object] = namespace[MAIN]
    return program


def _plain(text: str) -> Callable[[], object]:
    namespace: dict[str, Any] = {}
    exec(compile(translate(SourceFile("benchmark", text)).text, "benchmark", "exec"), namespace)
    program: Callable[[], object] = namespace["job"]
    return program


if __name__ == "__main__":
    print_rows(rows())
