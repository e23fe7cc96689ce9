"""Walks everything that a program can read, and finds nothing that it must not have."""

from __future__ import annotations

import os

import pytest

from elitescript.environment.memory import MemoryEnvironment
from elitescript.language.hooks import HOOKS
from elitescript.language.modules import AVAILABLE
from tests.runtime.crawler import Crawl
from tests.runtime.machine import Bench

COLLECTS = """
def job():
  import threading, queue, subprocess, collections, enum, datetime, random, re, itertools, functools, time, sys, os
  import dataclasses, decimal, fractions, statistics, json, struct, signal, typing, hashlib, string, textwrap
  global things
  things = []
  def keep(*values):
    for value in values:
      things.append(value)
  def work(*args):
    pass
  class Own:
    def __enter__(self):
      pass
    def __exit__(self, kind, error, trace):
      keep(kind, error)
      return True
    def method(self):
      pass
  class Queue(queue.Queue):
    pass
  class Colour(enum.Enum):
    RED = 1
  class Flags(enum.IntFlag):
    A = 1
  class Local(threading.local):
    pass
  @dataclasses.dataclass
  class Point:
    x: int = 1
  t = threading.Thread(target=work)
  t.start()
  t.join()
  keep(t, threading.current_thread(), threading.main_thread(), *threading.enumerate())
  h = start_thread(lambda: keep(threading.current_thread()), ())
  join_thread(h)
  lock = threading.Lock()
  rlock = threading.RLock()
  rlock.acquire()
  condition = threading.Condition()
  keep(lock, rlock, condition, threading.Event(), threading.Semaphore(), threading.Barrier(2), threading.Timer(1, work))
  keep(queue.Queue(), queue.LifoQueue(), queue.SimpleQueue(), Queue(), Local(), threading.local())
  keep(rlock._release_save())
  keep(subprocess.run(["ps"], stdout=subprocess.PIPE), subprocess.Popen(["socat", "a", "b"]))
  keep(Colour.RED, Colour, Flags.A, Flags, Point(), Point, dataclasses.fields(Point()))
  keep(datetime.datetime.now(), datetime.date.today(), datetime.timedelta(1), datetime.timezone.utc)
  keep(random.Random(), re.compile("x"), re.match("x", "x"), re.I, itertools.count(), itertools.cycle([1]))
  keep(functools.partial(work), functools.lru_cache(work), time.gmtime(), sys.stdout)
  keep(open("points"), open("points", "rb"))
  keep(decimal.Decimal(1), decimal.getcontext(), fractions.Fraction(1), statistics.NormalDist(), json.JSONEncoder())
  keep(struct.Struct("i"), hashlib.md5(b""), string.Template("$a"), textwrap.TextWrapper(), typing.List[int])
  keep(collections.OrderedDict(), collections.Counter(), collections.namedtuple("P", "a b")(1, 2))
  keep("{}".format, str.format, "{}".format_map, iter(int, 1), iter([]), map(work, []), (n for n in []), type, object())
  keep(Own, Own(), Own().method, work, sleep, textmsg, movej, copy, elicopy, eval, exec, getattr, print, open, super)
  for call in [lambda: sin("x"), lambda: open("/etc"), lambda: nothing, lambda: [].nothing, lambda: {}["k"],
               lambda: 1 / 0, lambda: json.loads("{"), lambda: json.loads('"'), lambda: getattr(1, "__globals__"),
               lambda: open("none"),
               lambda: subprocess.run(["rm"]), lambda: os.system, lambda: start_thread(1), lambda: eval("1 +"),
               lambda: lock.release(), lambda: queue.Queue().get_nowait(), lambda: int("x"), lambda: b"\\xff".decode(),
               lambda: "{0.__class__}".format(1), lambda: next(iter([])), lambda: decimal.Decimal(1) / 0]:
    try:
      call()
    except Exception as e:
      keep(e, e.args)
  with Own():
    raise ValueError("in a with block")
  keep(things)
end
"""


@pytest.fixture(scope="module")
def bench():
    bench = Bench(world=MemoryEnvironment({"points": b"1,2\n"})).start(COLLECTS)
    bench.run()
    assert bench.alarms == []
    assert len(bench.host.monitor()["things"]) > 120
    return bench


def roots_of(bench):
    program = bench.host._program
    for name in program.bindings.known():
        program.bindings.bind_name(name)
    facades = {name: program.shelf.facade(name) for name in sorted(AVAILABLE)}
    visible = {name: value for name, value in program.builtins.items() if name not in HOOKS and name[:2] != "__"}
    return {"things": bench.host.monitor()["things"], **facades, **visible}


def test_nothing_forbidden_can_be_reached(bench):
    crawl = Crawl(bench, roots_of(bench))
    assert crawl.reached > 2000
    assert crawl.found == []


SHARED_ERRORS = {
    "Clamped", "ConversionSyntax", "DecimalException", "DivisionByZero", "DivisionImpossible", "DivisionUndefined",
    "Error", "FloatOperation", "Inexact", "Incomplete", "InvalidContext", "InvalidOperation", "JSONDecodeError",
    "Overflow", "PatternError", "Rounded", "Subnormal", "Underflow", "error",
}  # fmt: skip
"""Exception classes that C code raises, so that programs must get the installed ones."""

SHARED_INTERNALS = {
    "_CacheInfo": "result of cache_info(), a tuple",
    "Integral": "abstract base of fractions", "Number": "abstract base", "Rational": "abstract base",
    "Random": "base of the program's own class", "struct_time": "result of time.gmtime(), a tuple",
    "ABCMeta": "class of abstract classes", "_abc_data": "inside of abstract classes, empty",
    "Generic": "made by Python's own C code since 3.12, which takes no other",
    "Sealed": "class of our sealed classes", "_Shown": "class of the errors of commands",
    "type": "class of `type` as scripts see it",
}  # fmt: skip


def test_no_class_that_programs_reach_is_shared_and_can_be_patched(bench):
    """Two programs reach the same immutable classes, and no mutable ones but those that are named above."""
    other = Bench(world=MemoryEnvironment({"points": b""})).start(COLLECTS).run()
    first = Crawl(bench, roots_of(bench)).classes
    second = {id(kind) for kind in Crawl(other, roots_of(other)).classes.values()}
    shared = {kind.__name__: path for path, kind in first.items() if id(kind) in second}
    assert set(shared) - SHARED_ERRORS - set(SHARED_INTERNALS) == set(), shared


class Leaky:
    """A class as it must not be written: the scheduler is an attribute."""

    def __init__(self, scheduler):
        self.kernel = scheduler


@pytest.mark.parametrize("plant", ["module", "kernel", "frame", "function of the computer"])
def test_a_planted_leak_is_found(bench, plant):
    import sys

    planted = {
        "module": {"hidden": [{"deep": (os,)}]},
        "kernel": Leaky(bench.host._scheduler),
        "frame": [sys._getframe()],
        "function of the computer": {"f": os.system},
    }[plant]
    crawl = Crawl(bench, {"planted": planted})
    assert len(crawl.found) >= 1
