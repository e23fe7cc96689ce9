"""Random programs with threads, locks, moves, secondary programs, recursion, short and long loops, and alarms."""

from __future__ import annotations

from random import Random

FUNCTIONS = """
  def climb(n):
    if n <= 0:
      return 0
    end
    below = climb(n - 1)
    return below + 1
  end
  def poll(name):
    tries = 0
    while not get_standard_digital_in(0) and tries < 4:
      tries = tries + 1
      sync()
    end
    return tries
  end
  def squares(n):
    found = []
    for k in range(12):
      found.append(k * k)
      if k % 3 == n % 3:
        found.append(k)
      end
    end
    return found
  end
  def risky(n):
    global shared
    try:
      with lock:
        shared = shared + 1
        return 10 / (n % 4)
    except ZeroDivisionError:
      shared = shared + 100
      return -1
    finally:
      shared = shared + 1000
    end
  end
  def numbers(n):
    for k in range(n):
      yield k * 2
    end
  end
"""

ACTIONS = (
    "total = climb({n})",
    "total = len(squares({n}))",
    "total = risky({n})",
    "total = sum(numbers({n}))",
    'total = poll("x")',
    "sync()",
    "sleep(0.01 * {n})",
    "set_standard_digital_out({n} % 8, {n} % 2 == 0)",
    "shared = shared + {n}",
    'textmsg("total ", total, " shared ", shared)',
    "for k in range(10):\n  total = total + k\nend",
    "for k in range(150):\n  total = total + 1\nend",
    "while total > {n}:\n  total = total - 7\nend",
    "with lock:\n  shared = shared + 1\n  sync()",
    "items.append(total)",
    "total = random.randint(0, 9)",
    'exec("shared_by_exec = 1")',
    "total = eval('total + 1')",
    "match {n} % 3:\n  case 0:\n    total = 0\n  case 1:\n    total = 1\nend",
    "@MOVE",
)
MOVES = (
    "movej([{a}, -1.57, {b}, -1.57, 1.57, 0], a=4, v=2)",
    "movej([{a}, -1.57, {b}, -1.57, 1.57, 0], a=4, v=2, r=0.01)",
    "movel(pose_trans(get_target_tcp_pose(), [0, 0, {c}, 0, 0, 0]), a=1, v=0.5)",
    "servoj([{a} / 10, -1.57, 1.57, -1.57, 1.57, 0], t=0.02)",
)
ENDINGS = ("", "", "", "total = 1 / 0", 'raise ValueError("enough")', "halt()", "total = [1][5]")


def random_program(rng: Random) -> str:
    """Return a program; only its main thread moves."""
    rows = [
        "def job():",
        "  global shared",
        "  import random",
        "  import threading",
        "  lock = threading.Lock()",
        "  items = []",
        "  shared = 0",
        *FUNCTIONS.strip("\n").split("\n"),
    ]
    threads = rng.randrange(0, 4)
    for index in range(threads):
        rows += [f"  def work{index}():", "    global shared", "    total = 1"]
        rows += [f"    for n in range({rng.randrange(1, 4)}):", *_actions(rng, 6, moves=False), "    end", "  end"]
    rows += ["  total = 2", "  movej([0, -1.57, 1.57, -1.57, 1.57, 0], a=8, v=3)"]
    rows += [f"  handle{index} = start_thread(work{index}, ())" for index in range(threads)]
    rows += [f"  for n in range({rng.randrange(1, 4)}):", *_actions(rng, 4, moves=True), "  end"]
    rows += [f"  join_thread(handle{index})" for index in range(threads) if rng.random() < 0.7]
    ending = rng.choice(ENDINGS)
    rows += [f"  {ending}"] if ending else []
    return "\n".join([*rows, "end", ""])


def _actions(rng: Random, indent: int, *, moves: bool) -> list[str]:
    rows = []
    for _ in range(rng.randrange(1, 6)):
        action = rng.choice(ACTIONS)
        if action == "@MOVE":
            action = rng.choice(MOVES) if moves else "sync()"
        a, b, c = rng.uniform(-0.3, 0.3), rng.uniform(1.2, 1.6), rng.uniform(-0.05, 0.05)
        text = action.format(n=rng.randrange(1, 6), a=f"{a:.3f}", b=f"{b:.3f}", c=f"{c:.3f}")
        rows += [" " * indent + row for row in text.split("\n")]
    return rows
