"""The same program does the same: twice, tick by tick or in leaps, whatever the size of a portion of fuel."""

from __future__ import annotations

import random
import re
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elitescript.runtime.threads import scheduler
from tests.runtime.machine import Bench

ROOT = Path(__file__).resolve().parents[2]

ACTIONS = (
    'textmsg(me, " ", n)',
    "sync()",
    "sleep(0.01 * (n % 4))",
    "box.put((me, n))",
    "note(box)",
    "with lock:\n        sync()",
    "with condition:\n        condition.notify()",
    "with condition:\n        condition.wait(0.02)",
    "event.set()",
    "event.wait(0.012)\n      event.clear()",
    "for k in range(300):\n        total[0] += k",
    "stop_thread(handles[n % len(handles)])",
    "join_thread(handles[(n + 1) % len(handles)] if n % 3 == 0 else 0)",
    "textmsg(random.randint(0, 99))",
    "semaphore.acquire(timeout=0.008)",
    "semaphore.release()",
    "try:\n        lock.acquire(timeout=0.004) and lock.release()\n      finally:\n        total[0] += 1",
    'textmsg(sorted({me: n, "k": total[0] % 7}))',
)


@st.composite
def programs(draw):
    """A program of a few threads that share a queue, locks and an event."""
    threads = []
    for index in range(draw(st.integers(1, 5))):
        steps = draw(st.lists(st.sampled_from(ACTIONS), min_size=1, max_size=5))
        loops = draw(st.integers(1, 6))
        body = "\n".join(f"      {step}" for step in steps)
        threads.append(f"""
  def thread{index}(me):
    for n in range({loops}):
{body}
    textmsg(me, " done")
""")
    starts = "\n".join(f'  handles.append(start_thread(thread{i}, ("t{i}",)))' for i in range(len(threads)))
    return f"""
import queue
import threading
import random
def job():
  box = queue.Queue(3)
  lock = threading.Lock()
  condition = threading.Condition()
  event = threading.Event()
  semaphore = threading.Semaphore(1)
  total = [0]
  handles = []
  def note(box):
    try:
      textmsg(box.get(timeout=0.02))
    except queue.Empty:
      textmsg("empty")
{"".join(threads)}
{starts}
  for h in list(handles):
    join_thread(h)
  textmsg(total)
job()
"""


def trace(text, portion=scheduler.PORTION, **options):
    bench = Bench(work_per_tick=500, **options)
    bench.host._scheduler._portion = [True] * portion
    bench.start(text).run(until=600)
    bench.host.stop("end of the test")
    bench.run(until=bench.machine.tick + 1)
    assert bench.host.is_idle
    return bench.trace, bench.ends


@settings(max_examples=60)
@given(programs())
def test_a_program_of_threads_does_the_same_twice_and_in_single_steps(text):
    first = trace(text)
    assert trace(text) == first
    assert trace(text, steps=True) == first


@settings(max_examples=30)
@given(programs())
def test_the_portion_of_fuel_shows_nowhere(text):
    assert trace(text, portion=7) == trace(text)


PROGRAM = """
import random
import threading
class Part:
  def bound(self):
    pass
  end
end
class Plain:
  def __init__(self, n):
    self.n = n
  end
end
class Numbered(Plain):
  def __hash__(self):
    return object.__hash__(self)
  end
end
def job():
  textmsg(Part(), " ", job, " ", threading.Lock(), " ", sleep, " ", object())
  textmsg(id(Part), " ", id(job), " ", id(Part))
  textmsg([kind.__name__ for kind in {Part, Plain, Numbered, threading.Thread}], hash(None), hash(job))
  textmsg([part.n for part in {Numbered(n) for n in range(40)}], [part.n for part in {Plain(n) for n in range(40)}])
  textmsg(threading.Event(), " ", threading.Barrier(2), " ", Part().bound)
  textmsg(random.random(), " ", random.Random().random(), " ", threading.get_ident())
  print(Part)
  print([Part()])
  raise ValueError(Part())
end
job()
"""


def test_no_address_shows_in_what_a_program_says():
    bench = Bench().start(PROGRAM).run()
    assert not re.search("0x[0-9a-f]{6}", "".join(bench.log + bench.printed + [bench.alarms[0].text]))
    assert bench.trace == Bench().start(PROGRAM).run().trace


@pytest.mark.parametrize("seed", ["0", "1"])
def test_another_process_says_the_same(seed):
    """Memory addresses, process numbers and hash seeds differ there."""
    program = (
        "from tests.runtime.machine import Bench; from tests.runtime.test_determinism import PROGRAM;"
        "print(Bench().start(PROGRAM).run().trace)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=ROOT,
        env={"PYTHONPATH": f"{ROOT / 'src'}:{ROOT}", "PYTHONHASHSEED": seed},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == str(Bench().start(PROGRAM).run().trace)


def test_another_seed_draws_other_numbers():
    text = "import random\ntextmsg(random.random())\n"
    logs = {tuple(Bench(seed=seed).start(text).run().log) for seed in range(5)}
    assert len(logs) == 5
    assert Bench(seed=3).start(text).run().log == [str(random.Random(3).random())]


def test_the_command_and_the_module_draw_from_one_sequence():
    bench = (
        Bench(seed=3)
        .start("global x\nx = random()\ndef f():\n  import random\n  textmsg(x)\n  textmsg(random.random())\nf()\n")
        .run()
    )
    generator = random.Random(3)
    assert bench.log == [str(generator.random()), str(generator.random())]


def test_the_depth_of_recursion_does_not_depend_on_who_calls():
    text = """
        def job():
          def f(n):
            try:
              return f(n + 1)
            except RecursionError:
              return n
          textmsg(f(0))
        job()
    """

    def depth_from(calls):
        return depth_from(calls - 1) if calls else int(Bench().start(text).run().log[0])

    limit = sys.getrecursionlimit()
    assert depth_from(0) == depth_from(300) > 900
    assert sys.getrecursionlimit() == limit
