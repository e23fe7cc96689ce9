import pytest

from elitescript.runtime.stdlib.locks import TIMEOUT_MAX, lock, new_lock, new_rlock, release_at_end
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import Stopped


class Bench:
    """Strands that use locks, and what they wrote."""

    def __init__(self):
        self.scheduler = Scheduler()
        self.seen = []

    def spawn(self, name, function):
        def body():
            try:
                function()
            except Stopped:
                self.seen.append((self.scheduler.now, f"{name} stopped"))

        return self.scheduler.spawn(name, body, {})

    def note(self, text):
        self.seen.append((self.scheduler.now, text))

    def sleep(self, ticks):
        self.scheduler.wait("time", self.scheduler.now + ticks)

    def run(self, until=1000):
        tick = self.scheduler.now
        while tick is not None and tick <= until:
            self.scheduler.begin_tick(tick)
            self.scheduler.run_ready()
            self.scheduler.end_tick()
            tick = self.scheduler.next_tick(tick)
        return self.seen


@pytest.fixture
def bench():
    return Bench()


@pytest.fixture(params=[new_lock, new_rlock])
def any_lock(request, bench):
    return request.param(bench.scheduler)


def test_it_keeps_others_out(bench, any_lock):
    def work(name):
        with any_lock:
            bench.note(f"{name} in")
            bench.sleep(5)
            bench.note(f"{name} out")

    bench.spawn("a", lambda: work("a"))
    bench.spawn("b", lambda: work("b"))
    assert bench.run() == [(0, "a in"), (5, "a out"), (5, "b in"), (10, "b out")]


def test_who_has_waited_longest_gets_it(bench, any_lock):
    def holder():
        with any_lock:
            bench.sleep(10)

    def waiter(name, delay):
        bench.sleep(delay)
        with any_lock:
            bench.note(name)

    bench.spawn("holder", holder)
    for name, delay in (("third", 3), ("first", 1), ("second", 2)):
        bench.spawn(name, lambda name=name, delay=delay: waiter(name, delay))
    assert bench.run() == [(10, "first"), (10, "second"), (10, "third")]


def test_nobody_overtakes_who_was_handed_the_lock(bench, any_lock):
    def holder():
        any_lock.acquire()
        bench.sleep(1)
        any_lock.release()
        bench.note(any_lock.acquire(False))

    bench.spawn("holder", holder)
    bench.spawn("waiter", lambda: (any_lock.acquire(), bench.sleep(5)))
    assert bench.run() == [(1, False)]


def test_a_time_out_ends_the_wait(bench, any_lock):
    bench.spawn("holder", lambda: (any_lock.acquire(), bench.sleep(100)))
    bench.spawn("waiter", lambda: bench.note(any_lock.acquire(timeout=0.02)))
    assert bench.run() == [(5, False)]


def test_a_short_time_out_takes_a_tick(bench, any_lock):
    bench.spawn("holder", lambda: (any_lock.acquire(), bench.sleep(100)))
    bench.spawn("waiter", lambda: bench.note(any_lock.acquire(timeout=1e-12)))
    assert bench.run() == [(1, False)]


@pytest.mark.parametrize("waiter_first", [True, False])
def test_a_hand_over_in_the_tick_of_the_time_out_counts(bench, any_lock, waiter_first):
    """Whoever of the two runs first: either the lock is free for the next one, or the waiter has it."""

    def holder():
        any_lock.acquire()
        bench.sleep(5)
        any_lock.release()
        bench.note("given back")

    def waiter():
        if waiter_first:
            bench.sleep(1)
            got = any_lock.acquire(timeout=0.016)
        else:
            got = any_lock.acquire(timeout=0.02)
        bench.note(got)
        if got:
            any_lock.release()

    if waiter_first:
        bench.spawn("waiter", waiter)
        bench.spawn("holder", holder)
    else:
        bench.spawn("holder", holder)
        bench.spawn("waiter", waiter)
    bench.spawn("last", lambda: (bench.sleep(9), bench.note(any_lock.acquire(False))))
    expected = {(5, "given back"), (5, not waiter_first), (9, True)}
    assert set(bench.run()) == expected


def test_one_that_does_not_wait_says_whether_it_got_it(bench, any_lock):
    bench.spawn("holder", lambda: (any_lock.acquire(), bench.sleep(5)))
    bench.spawn("other", lambda: bench.note((any_lock.acquire(False), any_lock.acquire(blocking=0))))
    assert bench.run() == [(0, (False, False))]


@pytest.mark.parametrize(
    ("args", "error"),
    [((False, 1), ValueError), ((True, -2), ValueError), ((True, TIMEOUT_MAX * 2), OverflowError)],
)
def test_arguments_are_checked_as_python_does(bench, any_lock, args, error):
    def work():
        with pytest.raises(error):
            any_lock.acquire(*args)
        bench.note("refused")

    bench.spawn("work", work)
    assert bench.run() == [(0, "refused")]


def test_a_free_one_cannot_be_given_back(bench, any_lock):
    def work():
        with pytest.raises(RuntimeError):
            any_lock.release()
        bench.note("refused")

    bench.spawn("work", work)
    assert bench.run() == [(0, "refused")]


class TestPlainLock:
    def test_another_thread_may_give_it_back(self, bench):
        mutex = new_lock(bench.scheduler)
        bench.spawn("taker", lambda: (mutex.acquire(), mutex.acquire(), bench.note("again")))
        bench.spawn("giver", lambda: (bench.sleep(3), mutex.release()))
        assert bench.run() == [(3, "again")]
        assert mutex.locked()

    def test_it_shows_its_state(self, bench):
        mutex = new_lock(bench.scheduler)
        assert repr(mutex).startswith("<unlocked _thread.lock object at 0x")

    def test_it_is_released_at_the_end_of_what_it_stands_for(self, bench):
        mutex = new_lock(bench.scheduler)
        release_at_end(mutex)
        bench.spawn("taker", mutex.acquire)
        bench.run()
        assert mutex.locked()
        release_at_end(mutex)
        assert not mutex.locked()

    def test_one_made_by_hand_is_none(self):
        with pytest.raises(AttributeError):
            lock().acquire()


class TestReentrantLock:
    def test_its_owner_can_take_it_again(self, bench):
        rlock = new_rlock(bench.scheduler)

        def owner():
            with rlock, rlock:
                bench.note(rlock._recursion_count())
                bench.sleep(3)
                rlock.acquire()
            rlock.release()

        bench.spawn("owner", owner)
        bench.spawn("other", lambda: (bench.sleep(1), rlock.acquire(), bench.note("other")))
        assert bench.run() == [(0, 2), (3, "other")]

    def test_only_its_owner_can_give_it_back(self, bench):
        rlock = new_rlock(bench.scheduler)

        def other():
            with pytest.raises(RuntimeError, match="un-acquired"):
                rlock.release()
            bench.note("refused")

        bench.spawn("owner", lambda: (rlock.acquire(), bench.sleep(3)))
        bench.spawn("other", other)
        assert bench.run() == [(0, "refused")]

    def test_a_condition_can_save_and_restore_it(self, bench):
        rlock = new_rlock(bench.scheduler)

        def work():
            rlock.acquire()
            rlock.acquire()
            saved = rlock._release_save()
            bench.note((saved, rlock._is_owned()))
            rlock._acquire_restore(saved)
            bench.note((rlock._recursion_count(), rlock._is_owned()))

        bench.spawn("work", work)
        assert bench.run() == [(0, (2, False)), (0, (2, True))]


class TestDying:
    """A thread that is stopped unwinds through its `with` blocks and leaves the locks of others alone."""

    def test_it_gives_back_what_it_holds(self, bench, any_lock):
        def work():
            with any_lock:
                bench.sleep(100)

        strand = bench.spawn("work", work)
        bench.run(until=5)
        bench.scheduler.kill(strand)
        bench.spawn("next", lambda: bench.note(any_lock.acquire(False)))
        assert bench.run() == [(0, "work stopped"), (0, True)]

    def test_a_lock_that_it_cannot_have_is_taken_in_pretence(self, bench, any_lock):
        def work():
            try:
                bench.sleep(100)
            finally:
                with any_lock:
                    bench.note("unwinds")

        strand = bench.spawn("work", work)
        bench.spawn("owner", lambda: (any_lock.acquire(), bench.sleep(50)))
        bench.run(until=5)
        bench.scheduler.kill(strand)
        assert bench.seen == [(0, "unwinds"), (0, "work stopped")]
        bench.spawn("next", lambda: bench.note(any_lock.acquire(False)))
        assert bench.run(until=20)[-1][1] is False

    def test_one_that_is_stopped_while_it_waits_leaves_the_queue(self, bench, any_lock):
        bench.spawn("owner", lambda: (any_lock.acquire(), bench.sleep(10), any_lock.release()))
        strand = bench.spawn("waiter", any_lock.acquire)
        bench.run(until=5)
        bench.scheduler.kill(strand)
        bench.spawn("next", lambda: bench.note(any_lock.acquire()))
        assert bench.run()[-1] == (10, True)

    def test_one_that_is_stopped_just_when_it_gets_it_hands_it_on(self, bench, any_lock):
        waiter = []

        def owner():
            any_lock.acquire()
            bench.sleep(3)
            any_lock.release()
            bench.scheduler.kill(waiter[0])

        bench.spawn("owner", owner)
        waiter.append(bench.spawn("waiter", lambda: (any_lock.acquire(), bench.note("never"))))
        bench.spawn("next", lambda: (bench.sleep(1), bench.note(any_lock.acquire())))
        assert bench.run() == [(3, "waiter stopped"), (3, True)]


def test_left_over_code_runs_alone(bench, any_lock):
    """No thread runs it, so no lock can be held against it."""
    with any_lock:
        assert any_lock.acquire()
    any_lock.release()
