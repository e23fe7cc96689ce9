import pytest

from elitescript.errors import ScriptStateError
from elitescript.messages.events import Alarm
from tests.runtime.machine import Bench, run

ENDLESS = """
def main():
  global beats
  beats = 0
  while True:
    beats += 1
    sync()
  end
end
"""


class TestEnd:
    def test_a_program_that_is_over_has_finished(self):
        bench = run('def a():\n  textmsg("hello")\n  sleep(1)\nend\n')
        assert (bench.log, bench.ends, bench.machine.tick) == (["hello"], ["finished"], 250)
        assert bench.host.is_idle and not bench.host.is_running
        assert bench.host.result == "finished"

    def test_its_threads_end_with_it_in_the_same_tick(self):
        bench = run("""
            def a():
              def late():
                sync()
                textmsg("never")
              start_thread(late, ())
              textmsg("bye")
            end
        """)
        assert (bench.log, bench.machine.tick) == (["bye"], 0)

    def test_what_was_printed_without_a_line_end_is_not_lost(self):
        assert run('print("half", end="")\n').printed == ["half"]

    def test_an_uncaught_exception_is_an_alarm(self):
        bench = run("def a():\n  sleep(0.1)\n  x = 1 / 0\nend\n")
        assert bench.ends == ["alarm"]
        (alarm,) = bench.alarms
        assert (alarm.code, alarm.class_name, alarm.line, alarm.thread) == ("R100", "ZeroDivisionError", 3, "main")
        assert alarm.source_line == "  x = 1 / 0"
        assert bench.host.alarm is alarm

    def test_an_exception_in_a_thread_ends_all(self):
        bench = run("""
            def a():
              def bad():
                sleep(0.02)
                nothing_like_it()
              start_thread(bad, ())
              sleep(1)
              textmsg("never")
            end
        """)
        assert (bench.log, bench.ends, bench.machine.tick) == ([], ["alarm"], 5)
        assert (bench.alarms[0].line, bench.alarms[0].thread) == (4, "bad")

    def test_only_the_first_of_two_exceptions_counts(self):
        bench = run("""
            def a():
              def bad():
                raise ValueError("first")
              end
              def worse():
                raise TypeError("second")
              end
              start_thread(bad, ())
              start_thread(worse, ())
              sleep(1)
            end
        """)
        assert [alarm.class_name for alarm in bench.alarms] == ["ValueError"]

    @pytest.mark.parametrize("way", ["halt()", "exit()", "quit(1)", "import sys; sys.exit(3)", "raise SystemExit"])
    def test_halt_and_its_like_stop_the_program(self, way):
        bench = run(f'def a():\n  textmsg(1)\n  {way}\n  textmsg("never")\nend\n')
        assert (bench.log, bench.ends) == (["1"], ["stopped"])
        assert len(bench.warnings) == (way != "halt()")

    def test_halt_in_a_thread_stops_the_program(self):
        bench = run("""
            def a():
              def t():
                sleep(0.1)
                halt()
              start_thread(t, ())
              while True:
                pass
            end
        """)
        assert (bench.ends, bench.machine.tick) == (["stopped"], 25)

    def test_halt_passes_every_handler(self):
        bench = run("""
            def a():
              try:
                halt()
              except:
                textmsg("caught")
              end
              textmsg("after")
            end
        """)
        assert (bench.log, bench.ends) == ([], ["stopped"])

    def test_the_globals_stay_readable(self):
        bench = run("def a():\n  global x\n  x = [1, 2]\nend\n")
        assert bench.host.monitor() == {"x": [1, 2]}

    def test_a_second_program_is_refused_while_one_runs_and_starts_afterwards(self):
        bench = Bench().start(ENDLESS)
        bench.run(until=10)
        with pytest.raises(ScriptStateError, match="stop it first"):
            bench.start(ENDLESS)
        bench.host.stop("replaced")
        bench.run(until=20)
        bench.start('textmsg("second")\n').run()
        assert (bench.ends, bench.log) == (["stopped", "finished"], ["second"])
        assert bench.host.monitor() == {}


class TestStop:
    @pytest.mark.parametrize(
        "wait",
        [
            "sleep(1000)",
            "sync()\n    while True:\n      pass",
            "lock.acquire()",
            "box.get()",
            "condition_wait()",
            "event.wait()",
            "event.wait(500)",
            "semaphore.acquire()",
            "barrier.wait()",
            "movej([0, 0, 0, 0, 0, 0])",
            "stopj(1)",
            "join_thread(own)",
            "threading.Thread(target=event.wait).start()\n    event.wait()",
            "import time\n    time.sleep(500)",
            "sorted([1, 2], key=lambda v: sleep(9))",
            "list(map(slow, [1, 2]))",
            "sum(slow(n) for n in [1, 2])",
            "[slow(n) for n in [1, 2]]",
            "Slow() == Slow()",
            "Slow().value",
            "str(Slow())",
            "next(generate())",
            "for n in generate():\n      pass",
            "with Slow():\n      pass",
            "max([1, 2], key=slow)",
            "'{0}'.format(Slow())",
            "f'{Slow()}'",
            "recurse(1)",
            "import itertools\n    max(itertools.count())",
            "list(iter(int, 1))",
        ],
    )
    @pytest.mark.parametrize("how", ["stop_thread", "host"])
    def test_it_ends_every_wait_and_gives_locks_back(self, wait, how):
        text = f"""
import threading
import queue
def body():
  global own, unwound
  own = 0
  unwound = False
  lock = threading.Lock()
  lock.acquire()
  mine = threading.RLock()
  box = queue.Queue()
  condition = threading.Condition()
  event = threading.Event()
  semaphore = threading.Semaphore(0)
  barrier = threading.Barrier(2)
  def condition_wait():
    with condition:
      condition.wait()
  def slow(n):
    sleep(1000)
    return n
  def generate():
    try:
      yield slow(1)
    finally:
      unwound = True
  def recurse(n):
    return recurse(n + 1) if n < 200 else sleep(1000)
  class Slow:
    def __eq__(self, other):
      sleep(1000)
    def __str__(self):
      sleep(1000)
    def __format__(self, spec):
      sleep(1000)
    @property
    def value(self):
      sleep(1000)
    def __enter__(self):
      pass
    def __exit__(self, *details):
      sleep(1000)
  end
  def waits():
    global unwound
    try:
      with mine:
        {wait.replace(chr(10), chr(10) + "    ")}
    finally:
      unwound = True
  own = start_thread(waits, ())
  sleep(0.1)
  stop_thread(own)
  join_thread(own)
  if mine.acquire(False) and condition.acquire(False):
    textmsg("free")
body()
"""
        if how == "host":
            text = text.replace("  stop_thread(own)\n  join_thread(own)\n", "  sleep(1000)\n")
        if wait.startswith("join_thread"):
            text = text.replace("join_thread(own)", "join_thread(start_thread(lambda: sleep(9999), ()))", 1)
        bench = Bench(move_ticks=10_000).start(text)
        bench.run(until=24)
        assert bench.alarms == [] and bench.log == []
        if how == "host":
            bench.host.stop("test")
            bench.run(until=30)
            assert bench.ends == ["stopped"]
        else:
            bench.run(until=30)
            assert (bench.log, bench.alarms) == (["free"], [])
        assert bench.host.monitor()["unwound"] is True

    def test_it_brakes_the_move_that_the_thread_waits_for(self):
        bench = Bench().start("""
            def a():
              def t():
                movej([0, 0, 0, 0, 0, 0])
                textmsg("never")
              h = start_thread(t, ())
              sleep(0.1)
              stop_thread(h)
              stopj(2)
              textmsg("stands")
            end
        """)
        bench.run()
        assert bench.machine.cancelled == [1]
        assert [type(request[1]).__name__ for request in bench.machine.requests] == ["MoveJ", "StopJ"]
        assert bench.log == ["stands"]

    def test_the_end_of_the_program_brakes_moves_of_its_threads(self):
        bench = run("def a():\n  def t():\n    movej([0,0,0,0,0,0])\n  start_thread(t, ())\n  sync()\nend\n")
        assert (bench.machine.cancelled, bench.ends) == ([1], ["finished"])

    def test_from_the_controller_it_comes_with_the_next_tick(self):
        bench = Bench().start(ENDLESS)
        bench.run(until=10)
        bench.host.stop("button")
        assert bench.host.next_tick(10) == 11
        bench.run(until=50)
        assert bench.ends == ["stopped"]
        assert bench.host.next_tick(50) is None

    def test_from_inside_a_command_it_comes_at_the_next_checkpoint(self):
        bench = Bench()
        bench.machine.cancel_move = lambda move: None
        bench.machine.write = lambda *point: bench.host.stop("power")
        bench.start('def a():\n  set_flag(1, True)\n  for n in [1]:\n    textmsg("never")\nend\n').run()
        assert (bench.log, bench.ends) == ([], ["stopped"])

    def test_a_paused_program_can_be_stopped(self):
        bench = Bench().start(ENDLESS)
        bench.run(until=5)
        bench.host.pause()
        bench.run(until=8)
        bench.host.stop("button")
        bench.run(until=12)
        assert (bench.ends, bench.host.is_paused, bench.host.next_tick(12)) == (["stopped"], False, None)

    def test_finally_blocks_may_use_commands_that_do_not_wait(self):
        bench = run("""
            def a():
              try:
                halt()
              finally:
                for n in range(8):
                  set_standard_digital_out(n, False)
                textmsg("outputs are off")
                sleep(1)
                textmsg("never")
            end
        """)
        assert (bench.log, bench.ends, bench.machine.tick) == (["outputs are off"], ["stopped"], 0)
        assert len(bench.machine.requests) == 8

    def test_commands_are_refused_after_a_stop_was_swallowed(self):
        bench = run("""
            def a():
              def swallow():
                try:
                  halt()
                finally:
                  return 1
              swallow()
              set_standard_digital_out(1, True)
              textmsg("never")
            end
        """)
        assert (bench.log, bench.ends, bench.machine.requests) == ([], ["stopped"], [])

    @pytest.mark.parametrize(
        "body",
        [
            "while True:\n      try:\n        sync()\n      finally:\n        continue",
            "while True:\n      try:\n        sync()\n      except BaseException:\n        pass",
            "def f():\n      try:\n        return f()\n      finally:\n        return f()\n    f()",
            "while True:\n      with Swallow():\n        sync()",
            "while True:\n      with Swallow():\n        while True:\n          with Swallow():\n            sync()",
            "try:\n      sync()\n    finally:\n      while True:\n        pass",
        ],
    )
    def test_nothing_swallows_it_for_good(self, body):
        bench = run(
            f"""
def a():
  class Swallow:
    def __enter__(self):
      pass
    def __exit__(self, *details):
      return True
  def stubborn():
    {body}
  h = start_thread(stubborn, ())
  sleep(0.05)
  stop_thread(h)
  join_thread(h)
  textmsg("stopped")
end
""",
            work_per_tick=500,
        )
        assert bench.log == ["stopped"]
        assert bench.alarms == []


class TestPause:
    def test_time_goes_on_and_waits_last_longer(self):
        bench = Bench().start("def a():\n  sleep(0.4)\n  textmsg(round(controller_timestamp() - 1704067200, 3))\nend\n")
        bench.run(until=50)
        bench.host.pause()
        bench.machine.tick = 60
        bench.run(until=400)
        assert bench.log == []
        bench.host.resume()
        bench.machine.tick = 500
        bench.run()
        assert bench.log == [str((500 + 40) / 250)]

    def test_the_command_waits_for_somebody_to_resume(self):
        bench = Bench().start("def a():\n  textmsg(1)\n  pause()\n  textmsg(2)\nend\n")
        bench.run(until=100)
        assert (bench.log, bench.host.is_paused) == (["1"], True)
        assert bench.host.threads()[0].doing == "waiting for somebody to resume the program"
        bench.host.resume()
        bench.run()
        assert (bench.log, bench.ends) == (["1", "2"], ["finished"])

    def test_a_move_that_ends_meanwhile_is_noticed_afterwards(self):
        bench = Bench(move_ticks=50).start('def a():\n  movej([0,0,0,0,0,0])\n  textmsg("there")\nend\n')
        bench.run(until=10)
        bench.host.pause()
        bench.machine.tick = 11
        bench.run(until=100)
        assert bench.log == []
        bench.host.resume()
        bench.machine.tick = 100
        bench.run()
        assert bench.log == ["there"]


class TestThreads:
    def test_they_say_where_they_are_and_what_they_wait_for(self):
        bench = Bench(move_ticks=999_999).start("""
            def a():
              import queue, threading
              box = queue.Queue()
              lock = threading.Lock()
              lock.acquire()
              def getting():
                box.get()
              end
              def locked():
                lock.acquire()
              end
              def moving():
                movej([0, 0, 0, 0, 0, 0])
              end
              def busy():
                while True:
                  pass
                end
              end
              def sleeping():
                sleep(100)
              end
              for f in [getting, locked, moving, busy, sleeping]:
                h = start_thread(f, ())
              end
              join_thread(h)
            end
        """)
        bench.run(until=3)
        assert [(*thread,)[:3] for thread in bench.host.threads()] == [
            ("main", 26, "the end of thread 'sleeping'"),
            ("getting", 7, "a lock in queue.Queue.get()"),
            ("locked", 10, "a lock"),
            ("moving", 13, "the end of its move"),
            ("busy", 16, ""),
            ("sleeping", 21, "time to go by, until 100.000 s"),
        ]
        assert bench.host.threads()[4].doing == "running"
        assert bench.host.line == 26

    def test_a_deadlock_is_known_by_nothing_being_due(self):
        bench = Bench().start("""
            def a():
              import threading
              lock = threading.Lock()
              lock.acquire()
              lock.acquire()
            end
        """)
        bench.run()
        assert bench.host.next_tick(bench.machine.tick) is None
        assert bench.host.is_running
        assert bench.host.threads()[0].waits_for == "a lock"


class TestInterrupt:
    def test_control_comes_back_from_an_endless_loop(self):
        bench = Bench(work_per_tick=10**9)
        bench.start("def a():\n  n = 0\n  while True:\n    n += 1\n    if n == 1000:\n      set_flag(1, True)\nend\n")
        bench.machine.write = lambda *point: bench.host.interrupt()
        bench.host.run_tick(0)
        assert bench.host.is_running
        bench.host.stop("interrupted")
        bench.host.run_tick(0)
        assert bench.ends == ["stopped"]


class TestStarvation:
    def test_an_endless_loop_cannot_freeze_time(self):
        bench = Bench(work_per_tick=100).start("""
            def a():
              global n
              n = 0
              def other():
                sleep(0.1)
                textmsg("still here")
              start_thread(other, ())
              while True:
                n += 1
            end
        """)
        bench.run(until=30)
        assert bench.log == ["still here"]
        assert 31 * 70 < bench.host.monitor()["n"] < 31 * 100

    def test_threads_that_only_feed_each_other_let_time_move(self):
        bench = Bench(work_per_tick=400).start("""
            def a():
              import queue
              ping, pong = queue.Queue(), queue.Queue()
              def player():
                while True:
                  pong.put(ping.get())
              start_thread(player, ())
              while True:
                ping.put(1)
                pong.get()
            end
        """)
        bench.run(until=100)
        assert bench.machine.tick == 101


def test_a_recursion_that_is_caught_many_times_does_no_harm():
    """In the last calls before the limit not even a checkpoint can be called."""
    bench = Bench()
    bench.host._scheduler._portion = [True]
    bench.start("""
        def a():
          global calls
          calls = 0
          def f():
            global calls
            calls += 1
            if calls < 3000:
              try:
                f()
              finally:
                f()
          try:
            f()
          except RecursionError:
            pass
          textmsg("alive")
        end
    """).run()
    assert (bench.log, bench.alarms) == (["alive"], [])


def test_the_stop_of_a_thread_that_cannot_be_stopped_is_reported(monkeypatch):
    bench = Bench().start("def a():\n  sleep(1)\nend\n")
    bench.run(until=5)
    strand = bench.host._scheduler.strands[0]
    bench.host._strand_abandoned(strand)
    (alarm,) = [event for event in bench.machine.events if isinstance(event, Alarm)]
    assert (alarm.code, alarm.thread) == ("R131", "main")
