"""Taking turns, in virtual time."""

from __future__ import annotations

from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.turns import Turns


def scene(*bodies, until=50):
    """Run threads side by side; each is called with the turns and a list for what it has to say."""
    scheduler = Scheduler()
    turns, said = Turns(scheduler), []
    strands = [
        scheduler.spawn(str(number), lambda body=body: body(scheduler, turns, said), {})
        for number, body in enumerate(bodies)
    ]
    for tick in range(until):
        scheduler.begin_tick(tick)
        scheduler.run_ready()
        scheduler.end_tick()
    assert scheduler.strands == []
    return strands, said


def worker(name, ticks, until=None):
    """Holds a turn for some ticks."""

    def body(scheduler, turns, said):
        if turns.take("its turn", until):
            said.append((name, "from", scheduler.now))
            scheduler.wait("work", scheduler.now + ticks)
            turns.give()
        else:
            said.append((name, "gave up", scheduler.now))

    return body


def test_they_come_in_the_order_in_which_they_asked():
    _, said = scene(worker("a", 3), worker("b", 2), worker("c", 1))
    assert said == [("a", "from", 0), ("b", "from", 3), ("c", "from", 5)]


def test_who_gives_up_holds_nobody_up():
    _, said = scene(worker("a", 5), worker("b", 1, until=2), worker("c", 1))
    assert said == [("a", "from", 0), ("b", "gave up", 2), ("c", "from", 5)]


def test_a_turn_that_comes_in_the_last_tick_counts():
    _, said = scene(worker("a", 5), worker("b", 1, until=5))
    assert said == [("a", "from", 0), ("b", "from", 5)]


def test_who_is_stopped_while_waiting_holds_nobody_up():
    def killer(scheduler, turns, said):
        scheduler.wait("a while", 2)
        scheduler.kill(next(strand for strand in scheduler.strands if strand.name == "1"))

    _, said = scene(worker("a", 5), worker("b", 1), worker("c", 1), killer)
    assert said == [("a", "from", 0), ("c", "from", 5)]


def test_who_is_stopped_as_its_turn_comes_gives_it_away():
    def a(scheduler, turns, said):
        turns.take("its turn", None)
        scheduler.wait("work", 3)
        turns.give()
        scheduler.kill(next(strand for strand in scheduler.strands if strand.name == "1"))

    _, said = scene(a, worker("b", 1), worker("c", 1))
    assert said == [("c", "from", 3)]


def test_who_has_ended_without_a_word_has_no_turn():
    def rude(scheduler, turns, said):
        turns.take("its turn", None)

    def patient(scheduler, turns, said):
        scheduler.wait("a while", 2)
        worker("b", 1)(scheduler, turns, said)

    assert scene(rude, patient)[1] == [("b", "from", 2)]
