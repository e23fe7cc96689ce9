"""`threading` and `queue` of programs: private copies over our lock, in virtual time."""

import pytest

from tests.runtime.machine import Bench, run


def logged(body, **options):
    lines = "".join(f"  {line}\n" for line in body.strip("\n").split("\n"))
    bench = run(f"import threading\nimport queue\ndef job():\n{lines}job()\n", **options)
    assert bench.alarms == []
    return bench.log


class TestThread:
    def test_it_runs_beside_and_can_be_joined(self):
        body = """
def work(n, key):
  sleep(0.1)
  textmsg(n, key)
t = threading.Thread(target=work, args=(7,), kwargs={"key": "k"}, name="worker")
textmsg(t.is_alive())
t.start()
textmsg(t.is_alive(), t.name)
t.join(0.02)
textmsg(t.is_alive())
t.join()
textmsg(t.is_alive())
"""
        assert logged(body) == ["False", "Trueworker", "True", "7k", "False"]

    def test_a_class_of_its_own(self):
        body = """
class Worker(threading.Thread):
  def run(self):
    textmsg(self.name, threading.current_thread() is self)
w = Worker(name="w")
w.start()
w.join()
try:
  w.start()
except RuntimeError as e:
  textmsg(e)
"""
        assert logged(body) == ["wTrue", "threads can only be started once"]

    def test_the_main_thread_is_the_program_s_also_when_a_child_imports_first(self):
        bench = run("""
            def job():
              def child():
                import threading
                textmsg(threading.current_thread() is threading.main_thread())
                textmsg(threading.main_thread().name)
              join_thread(start_thread(child, ()))
              import threading
              textmsg(threading.current_thread() is threading.main_thread())
            end
        """)
        assert bench.log == ["False", "MainThread", "True"]

    def test_an_uncaught_exception_is_an_alarm_of_the_program(self):
        bench = run("""
            import threading
            def job():
              def bad():
                sleep(0.1)
                raise KeyError("x")
              threading.Thread(target=bad).start()
              sleep(5)
            job()
        """)
        (alarm,) = bench.alarms
        assert (alarm.class_name, alarm.line, alarm.thread, alarm.tick) == ("KeyError", 5, "Thread-1 (bad)", 25)

    @pytest.mark.parametrize("way", ["raise SystemExit", "exit()", "halt()"])
    def test_leaving_in_it_ends_the_program(self, way):
        bench = run(f"""
            import threading
            def job():
              def work():
                {way}
              threading.Thread(target=work).start()
              sleep(5)
            job()
        """)
        assert (bench.ends, bench.alarms, bench.machine.tick) == (["stopped"], [], 0)

    def test_it_ends_with_the_program_daemon_or_not(self):
        bench = run("""
            import threading
            def job():
              def late():
                sleep(1)
                textmsg("never")
              threading.Thread(target=late).start()
              threading.Thread(target=late, daemon=True).start()
              textmsg("bye")
            job()
        """)
        assert (bench.log, bench.ends, bench.machine.tick) == (["bye"], ["finished"], 0)

    def test_a_timer_fires_in_virtual_time(self):
        body = """
import time
def ring():
  textmsg("ring ", round(time.monotonic(), 3))
threading.Timer(1.5, ring).start()
threading.Timer(0.5, ring).start()
stopped = threading.Timer(1.0, ring)
stopped.start()
stopped.cancel()
sleep(3)
"""
        assert logged(body) == ["ring 0.5", "ring 1.5"]

    def test_each_has_its_own_local_values(self):
        body = """
class Own(threading.local):
  def __init__(self, start):
    self.n = start
own = Own(5)
own.n += 1
def work():
  textmsg(own.n)
  own.n = 50
t = threading.Thread(target=work)
t.start()
t.join()
textmsg(own.n)
plain = threading.local()
plain.x = 1
del plain.x
textmsg(hasattr(plain, "x"))
"""
        assert logged(body) == ["5", "6", "False"]

    def test_identities_are_the_handles(self):
        body = """
found = []
def work():
  found.append(threading.get_ident())
h = start_thread(work, ())
join_thread(h)
textmsg(found == [h])
t = threading.Thread(target=work)
t.start()
t.join()
textmsg(t.ident == found[1], t.ident > 0)
"""
        assert logged(body) == ["True", "TrueTrue"]


class TestSynchronisation:
    def test_an_event_wakes_all(self):
        body = """
event = threading.Event()
def work(n):
  event.wait()
  textmsg(n)
for n in range(3):
  start_thread(work, (n,))
sleep(0.1)
event.set()
sleep(0.1)
textmsg(event.is_set())
"""
        assert logged(body) == ["0", "1", "2", "True"]

    def test_a_condition_notifies_one_by_one(self):
        body = """
condition = threading.Condition()
def work(n):
  with condition:
    textmsg(n, condition.wait(1))
for n in range(3):
  start_thread(work, (n,))
sleep(0.1)
with condition:
  condition.notify()
sleep(0.1)
with condition:
  condition.notify_all()
sleep(0.1)
"""
        assert logged(body) == ["0True", "1True", "2True"]

    def test_wait_for_waits_for_what_it_says(self):
        body = """
condition = threading.Condition()
items = []
def feed():
  for n in range(3):
    sleep(0.1)
    with condition:
      items.append(n)
      condition.notify()
start_thread(feed, ())
with condition:
  textmsg(condition.wait_for(lambda: len(items) >= 2, 5), items)
  textmsg(condition.wait_for(lambda: False, 0.5))
"""
        assert logged(body) == ["True[0, 1]", "False"]

    def test_a_semaphore_lets_so_many_in(self):
        body = """
gate = threading.BoundedSemaphore(2)
inside = [0]
def work():
  with gate:
    inside[0] += 1
    textmsg(inside[0])
    sleep(0.1)
    inside[0] -= 1
for n in range(4):
  start_thread(work, ())
sleep(1)
try:
  gate.release()
except ValueError as e:
  textmsg(e)
"""
        assert logged(body) == ["1", "2", "2", "2", "Semaphore released too many times"] or logged(body)[:2] == [
            "1",
            "2",
        ]

    def test_a_barrier_waits_for_all(self):
        body = """
barrier = threading.Barrier(3)
def work(n):
  sleep(0.1 * n)
  barrier.wait()
  textmsg("through")
for n in range(3):
  start_thread(work, (n,))
sleep(0.15)
textmsg("two wait")
sleep(1)
"""
        assert logged(body) == ["two wait", "through", "through", "through"]


class TestQueue:
    @pytest.mark.parametrize(
        ("kind", "order"), [("Queue", "[3, 1, 2]"), ("LifoQueue", "[2, 1, 3]"), ("PriorityQueue", "[1, 2, 3]")]
    )
    def test_the_kinds_keep_their_order(self, kind, order):
        body = f"""
box = queue.{kind}()
for n in (3, 1, 2):
  box.put(n)
textmsg([box.get() for n in range(3)])
"""
        assert logged(body) == [order]

    def test_a_full_one_holds_up_who_puts(self):
        body = """
box = queue.Queue(2)
def feed():
  for n in range(4):
    box.put(n)
    textmsg("put ", n)
start_thread(feed, ())
sleep(0.1)
textmsg("got ", box.get())
sleep(0.1)
textmsg(box.full(), box.qsize())
"""
        assert logged(body) == ["put 0", "put 1", "got 0", "put 2", "True2"]

    @pytest.mark.parametrize("timeout_s", [0.004, 0.1, 0.3, 1, 2, 3.3, 7.7, 10])
    @pytest.mark.parametrize("begin", [0, 1, 7, 12345])
    def test_a_time_out_takes_exactly_its_ticks(self, timeout_s, begin):
        bench = Bench().start(f"""
            import queue
            def job():
              try:
                queue.Queue().get(timeout={timeout_s})
              except queue.Empty:
                textmsg("empty")
            job()
        """)
        bench.machine.tick = begin
        bench.run()
        assert bench.log == ["empty"]
        assert bench.machine.tick - begin == round(timeout_s * 250 + 0.4999)

    def test_not_waiting_says_so(self):
        body = """
box = queue.Queue(1)
for call in (box.get_nowait, lambda: (box.put(1), box.put_nowait(2))):
  try:
    call()
  except (queue.Empty, queue.Full) as e:
    textmsg(type(e).__name__)
"""
        assert logged(body) == ["Empty", "Full"]

    def test_join_waits_until_all_is_done(self):
        body = """
box = queue.Queue()
def work():
  while True:
    textmsg(box.get())
    sleep(0.1)
    box.task_done()
start_thread(work, ())
for n in range(2):
  box.put(n)
box.join()
textmsg("all done")
"""
        assert logged(body) == ["0", "1", "all done"]

    def test_a_class_of_its_own_may_use_its_insides(self):
        """As real programs do: a queue that drops the oldest, with the lock of the base class."""
        body = """
class Latest(queue.Queue):
  def push(self, item):
    with self.mutex:
      if self.maxsize and self._qsize() >= self.maxsize:
        self._get()
      self._put(item)
      self.unfinished_tasks += 1
      self.not_empty.notify()
  def peek(self, timeout):
    with self.not_empty:
      while not self._qsize():
        if not self.not_empty.wait(timeout):
          return None
      return self.queue[0]
box = Latest(2)
textmsg(box.peek(0.1))
for n in range(5):
  box.push(n)
textmsg(box.peek(0.1), [box.get(), box.get()])
"""
        assert logged(body) == ["None", "3[3, 4]"]

    def test_a_simple_queue_is_there(self):
        body = """
box = queue.SimpleQueue()
def feed():
  sleep(0.1)
  box.put("x")
start_thread(feed, ())
textmsg(box.get(), box.empty())
"""
        assert logged(body) == ["xTrue"]

    def test_a_patch_hurts_the_program_alone(self):
        import queue

        before = queue.Queue.put
        assert logged("queue.Queue.put = lambda self, item: textmsg('patched')\nqueue.Queue().put(1)") == ["patched"]
        assert queue.Queue.put is before
        assert logged("queue.Queue().put(1)\ntextmsg('whole')") == ["whole"]
