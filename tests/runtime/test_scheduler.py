from contextlib import suppress

import pytest

from elitescript.runtime.threads.scheduler import WORK_PER_ACTIVATION, Scheduler
from elitescript.runtime.threads.strand import ENDED, Stopped


def run_tick(scheduler, tick):
    scheduler.begin_tick(tick)
    scheduler.run_ready()
    scheduler.end_tick()


def guarded(function):
    """A strand's body as the host makes it: a stop ends there."""

    def body():
        with suppress(Stopped):
            function()

    return body


class Bench:
    """A scheduler and what its strands wrote."""

    def __init__(self, **options):
        self.seen = []
        self.scheduler = Scheduler(**options)

    def spawn(self, name, function, **options):
        return self.scheduler.spawn(name, guarded(function), {}, **options)

    def note(self, text):
        self.seen.append((self.scheduler.now, text))

    def checkpoints(self, count):
        tick, checkpoint = self.scheduler.fuel.pop, self.scheduler.checkpoint
        for _ in range(count):
            tick() or checkpoint()

    def run(self, until=1000):
        tick = self.scheduler.now
        while tick is not None and tick <= until:
            run_tick(self.scheduler, tick)
            tick = self.scheduler.next_tick(tick)
        return self.seen


@pytest.mark.parametrize("portion", [1, 30, 77, 500])
@pytest.mark.parametrize("sizes", [[1], [8], [33, 1, 90], [79], [80], [81]])
def test_work_paid_at_once_counts_like_work_in_steps(portion, sizes):
    def ticks(pays):
        bench = Bench(work_per_tick=100, portion=portion)
        scheduler = bench.scheduler

        def work():
            for number in range(200):
                size = sizes[number % len(sizes)]
                if not (pays and scheduler.pay(size)):
                    bench.checkpoints(size)
                bench.checkpoints(1)
                bench.note(number)

        bench.spawn("work", work)
        return bench.run()

    assert ticks(True) == ticks(False)


def test_a_strand_without_fuel_cannot_pay():
    bench = Bench(work_per_tick=100)
    bench.spawn("work", lambda: bench.note(bench.scheduler.pay(1)))
    assert bench.run() == [(0, False)]
    assert not bench.scheduler.pay(1)


def test_strands_run_in_the_order_of_their_start():
    bench = Bench()

    def say(name):
        for _ in range(2):
            bench.note(name)
            bench.scheduler.wait("time", bench.scheduler.now + 1)

    for name in "abc":
        bench.spawn(name, lambda name=name: say(name))
    assert bench.run() == [(tick, name) for tick in (0, 1) for name in "abc"]


def test_equal_time_outs_end_in_the_order_of_start_whatever_the_order_of_waiting():
    bench = Bench()
    first = bench.spawn("first", lambda: (bench.scheduler.wait("time", 3), bench.note("first")))
    bench.spawn("second", lambda: (bench.scheduler.wait("time", 5), bench.note("second")))
    bench.run(until=0)
    bench.scheduler.wake(first)
    first_again = bench.scheduler.spawn("third", guarded(lambda: None), {})
    assert first_again.order == 2
    assert bench.run() == [(0, "first"), (5, "second")]


def test_a_woken_strand_runs_in_the_same_tick():
    bench = Bench()
    sleeper = bench.spawn("sleeper", lambda: bench.note(bench.scheduler.wait("a bell")))
    bench.spawn("waker", lambda: (bench.scheduler.wake(sleeper), bench.note("rang")))
    assert bench.run() == [(0, "rang"), (0, True)]


def test_a_time_out_says_that_it_was_one():
    bench = Bench()
    bench.spawn("sleeper", lambda: bench.note(bench.scheduler.wait("a bell", 4)))
    assert bench.run() == [(4, False)]


def test_nothing_is_due_while_all_wait_for_somebody():
    bench = Bench()
    bench.spawn("sleeper", lambda: bench.scheduler.wait("a bell"))
    run_tick(bench.scheduler, 0)
    assert bench.scheduler.next_tick(0) is None


class TestWork:
    def test_a_loop_costs_one_tick_for_its_work_per_tick(self):
        bench = Bench(work_per_tick=1000)
        bench.spawn("busy", lambda: (bench.checkpoints(4500), bench.note("done")))
        assert bench.run() == [(4, "done")]

    def test_the_size_of_a_portion_shows_nowhere(self):
        def trace(portion):
            bench = Bench(work_per_tick=200, portion=portion)

            def work(name, step):
                for count in range(6):
                    bench.checkpoints(step)
                    bench.note(f"{name}{count}")
                    if count % 2:
                        bench.scheduler.wait("time", bench.scheduler.now + 1)

            bench.spawn("a", lambda: work("a", 97))
            bench.spawn("b", lambda: work("b", 150))
            return bench.run()

        assert trace(1) == trace(7) == trace(64) == trace(10_000)

    def test_each_strand_has_its_own(self):
        bench = Bench(work_per_tick=1000)
        bench.spawn("busy", lambda: (bench.checkpoints(2500), bench.note("busy")))
        bench.spawn("brief", lambda: (bench.checkpoints(10), bench.note("brief")))
        assert bench.run() == [(0, "brief"), (2, "busy")]

    def test_strands_that_only_wake_each_other_use_up_the_tick(self):
        bench = Bench(work_per_tick=WORK_PER_ACTIVATION * 10)
        strands = {}

        def play(other):
            while True:
                if other in strands:
                    bench.scheduler.wake(strands[other])
                bench.note(other)
                bench.scheduler.wait("the other")

        strands["a"] = bench.spawn("a", lambda: play("b"))
        strands["b"] = bench.spawn("b", lambda: play("a"))
        seen = bench.run(until=3)
        per_tick = [sum(1 for tick, _ in seen if tick == number) for number in range(4)]
        assert per_tick == [20, 20, 20, 20]

    def test_the_books_survive_an_interruption(self):
        def ends_at(interrupts):
            bench = Bench(work_per_tick=1000)

            def work():
                for _ in range(3):
                    bench.checkpoints(700)
                    if interrupts:
                        bench.scheduler.interrupt()
                bench.note("done")

            bench.spawn("busy", work)
            tick = 0
            while not bench.seen:
                bench.scheduler.begin_tick(tick)
                bench.scheduler.run_ready()
                interrupted = bool(bench.scheduler._ready)
                bench.scheduler.end_tick()
                tick += not interrupted
            return bench.seen

        # Coming back costs an activation, and nothing else.
        assert ends_at(False) == ends_at(True) == [(2, "done")]

    def test_a_checkpoint_that_cannot_be_called_leaves_the_next_one_whole(self):
        """At the recursion limit the fuel says that it is used up, and the call that would fill it fails."""
        bench = Bench(work_per_tick=1000)

        def work():
            for _ in range(50):
                assert bench.scheduler.fuel.pop() is False
            bench.checkpoints(900 - 50)
            bench.note("in this tick")
            bench.checkpoints(100)
            bench.note("in the next one")

        bench.spawn("deep", work)
        assert bench.run() == [(0, "in this tick"), (1, "in the next one")]

    def test_an_interruption_brings_control_back_at_the_next_checkpoint(self):
        bench = Bench()

        def work():
            while True:
                bench.checkpoints(1)
                bench.note("pass")
                if len(bench.seen) == 3:
                    bench.scheduler.interrupt()

        bench.spawn("busy", work)
        run_tick(bench.scheduler, 0)
        assert len(bench.seen) == 3


class TestStop:
    def test_it_ends_a_waiting_strand_where_it_stands(self):
        bench = Bench()

        def work():
            try:
                bench.scheduler.wait("a bell")
            finally:
                bench.note("unwound")

        strand = bench.spawn("work", work)
        bench.run()
        bench.scheduler.kill(strand)
        assert (bench.seen, strand.state) == ([(0, "unwound")], ENDED)

    def test_a_strand_that_stops_another_goes_on_when_that_one_has_unwound(self):
        bench = Bench()

        def work():
            try:
                bench.scheduler.wait("a bell")
            finally:
                bench.note("unwound")

        strand = bench.spawn("work", work)
        bench.spawn("stopper", lambda: (bench.scheduler.kill(strand), bench.note("goes on")))
        assert bench.run() == [(0, "unwound"), (0, "goes on")]

    def test_a_strand_that_stops_itself_does_not_come_back(self):
        bench = Bench()
        bench.spawn("self", lambda: (bench.scheduler.kill(bench.scheduler.current), bench.note("never")))
        assert bench.run() == []

    def test_a_strand_that_has_not_begun_never_does(self):
        bench = Bench()
        strand = bench.spawn("late", lambda: bench.note("never"))
        bench.scheduler.kill(strand)
        assert strand.state == ENDED
        assert bench.run() == []

    def test_it_undoes_what_the_strand_waits_for_at_once(self):
        bench = Bench()

        def work():
            bench.scheduler.current.cancel = lambda: bench.note("braked")
            bench.scheduler.wait("a move")

        strand = bench.spawn("work", work)
        bench.run()
        bench.scheduler.kill(strand)
        assert bench.seen == [(0, "braked")]

    def test_who_joins_goes_on(self):
        bench = Bench()
        strand = bench.spawn("work", lambda: bench.scheduler.wait("a bell"))
        bench.spawn("joiner", lambda: bench.note(bench.scheduler.join(strand)))
        bench.spawn("stopper", lambda: (bench.scheduler.wait("time", 7), bench.scheduler.kill(strand)))
        assert bench.run() == [(7, True)]

    def test_a_join_that_timed_out_leaves_no_bell_behind(self):
        bench = Bench()
        strand = bench.spawn("work", lambda: bench.scheduler.wait("time", 10))

        def join():
            bench.note(bench.scheduler.join(strand, 5))
            bench.note(bench.scheduler.wait("time", 20))

        bench.spawn("joiner", join)
        assert bench.run() == [(5, False), (20, False)]

    def test_finally_blocks_may_work_a_little_but_not_wait(self):
        bench = Bench()

        def work():
            try:
                bench.scheduler.wait("a bell")
            finally:
                bench.checkpoints(500)
                bench.note("cleaned up")
                bench.scheduler.wait("time", 5)
                bench.note("never")

        strand = bench.spawn("work", work)
        bench.run()
        bench.scheduler.kill(strand)
        assert bench.seen == [(0, "cleaned up")]

    def test_an_endless_finally_block_is_cut_off(self):
        bench = Bench()

        def work():
            try:
                bench.scheduler.wait("a bell")
            finally:
                while True:
                    bench.checkpoints(1)

        strand = bench.spawn("work", work)
        bench.run()
        bench.scheduler.kill(strand)
        assert strand.state == ENDED and not strand.is_abandoned

    def test_a_stop_that_is_swallowed_comes_again_at_the_next_checkpoint(self):
        bench = Bench()

        def swallow():
            try:
                bench.scheduler.wait("a bell")
            except Stopped:
                bench.note("swallowed")

        def work():
            while True:
                bench.checkpoints(1)
                swallow()

        strand = bench.spawn("work", work)
        bench.run()
        bench.scheduler.kill(strand)
        assert (bench.seen, strand.state) == ([(0, "swallowed")], ENDED)

    def test_a_strand_that_swallows_everything_is_given_up(self):
        given_up = []
        bench = Bench(on_abandoned=given_up.append)

        def work():
            while True:
                try:
                    bench.checkpoints(1)
                    bench.scheduler.wait("a bell")
                except Stopped:
                    pass

        strand = bench.spawn("work", work)
        bench.run()
        bench.scheduler.kill(strand)
        assert given_up == [strand]
        assert strand.state == ENDED and bench.scheduler.strands == []

    def test_commands_are_refused_once_the_stop_was_swallowed(self):
        bench = Bench()

        def work():
            try:
                bench.scheduler.wait("a bell")
            except Stopped:
                bench.scheduler.refuse_if_stopped()
                bench.note("allowed while it passes")
            bench.scheduler.refuse_if_stopped()
            bench.note("never")

        strand = bench.spawn("work", work)
        bench.run()
        bench.scheduler.kill(strand)
        assert bench.seen == [(0, "allowed while it passes")]

    def test_code_that_no_strand_runs_is_cut_off(self):
        bench = Bench()
        with pytest.raises(Stopped):
            while True:
                bench.checkpoints(1)
        with pytest.raises(Stopped):
            bench.scheduler.refuse_if_stopped()


class TestPause:
    def sleepers(self):
        bench = Bench()
        bench.spawn("main", lambda: (bench.scheduler.wait("time", 10), bench.note("main")))
        bench.spawn("sec", lambda: (bench.scheduler.wait("time", 12), bench.note("sec")), is_secondary=True)
        run_tick(bench.scheduler, 0)
        return bench

    def test_waits_last_longer_by_it_and_secondary_programs_run(self):
        bench = self.sleepers()
        bench.scheduler.pause()
        run_tick(bench.scheduler, 4)
        assert bench.scheduler.next_tick(4) == 12
        run_tick(bench.scheduler, 12)
        assert bench.scheduler.next_tick(12) is None
        bench.scheduler.resume()
        assert bench.scheduler.next_tick(99) == 100
        run_tick(bench.scheduler, 100)
        assert bench.scheduler.next_tick(100) == 106
        bench.run()
        run_tick(bench.scheduler, 106)
        assert bench.seen == [(12, "sec"), (106, "main")]

    def test_a_pause_that_is_taken_back_before_a_tick_changes_nothing(self):
        bench = self.sleepers()
        bench.scheduler.pause()
        bench.scheduler.resume()
        assert bench.scheduler.next_tick(0) == 10

    def test_a_resume_that_is_taken_back_before_a_tick_changes_nothing(self):
        bench = self.sleepers()
        bench.scheduler.pause()
        run_tick(bench.scheduler, 4)
        bench.scheduler.resume()
        bench.scheduler.pause()
        run_tick(bench.scheduler, 50)
        bench.scheduler.resume()
        run_tick(bench.scheduler, 60)
        assert bench.scheduler.next_tick(60) == 66

    def test_a_strand_that_pauses_goes_on_when_resumed(self):
        bench = Bench()

        def work():
            bench.scheduler.pause()
            bench.scheduler.give_way("somebody")
            bench.note("resumed")

        bench.spawn("main", work)
        bench.spawn("second", lambda: bench.note("second"))
        run_tick(bench.scheduler, 0)
        assert bench.seen == [] and bench.scheduler.next_tick(0) is None
        bench.scheduler.resume()
        run_tick(bench.scheduler, 30)
        assert bench.seen == [(30, "resumed"), (30, "second")]

    def test_a_paused_strand_can_be_stopped(self):
        bench = self.sleepers()
        bench.scheduler.pause()
        run_tick(bench.scheduler, 4)
        main = bench.scheduler.strands[0]
        bench.scheduler.kill(main)
        assert main.state == ENDED


def test_handles_look_like_thread_ids_and_differ():
    bench = Bench()
    handles = [bench.spawn("work", lambda: None).handle for _ in range(2000)]
    assert len(set(handles)) == 2000
    assert all(0 < handle < 2**31 for handle in handles)


def test_attention_brings_control_back():
    bench = Bench()

    def work():
        bench.scheduler.call_attention()
        bench.checkpoints(1)
        bench.note("later")

    bench.spawn("work", work)
    bench.scheduler.begin_tick(0)
    bench.scheduler.run_ready()
    assert bench.seen == []
    bench.scheduler.needs_attention = False
    bench.scheduler.run_ready()
    assert bench.seen == [(0, "later")]
