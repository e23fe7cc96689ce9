from elitescript.runtime.threads.strand import READY, WAITING, Strand
from elitescript.runtime.threads.timers import Timers


def waiting(name, *, is_secondary=False):
    strand = Strand(0, name, lambda: None, {}, is_secondary=is_secondary)
    strand.state = WAITING
    return strand


def names(strands):
    return [strand.name for strand in strands]


def test_the_earliest_comes_first_and_equal_ones_in_their_order():
    timers = Timers()
    for name, until in [("c", 9), ("a", 5), ("b", 5)]:
        timers.set(waiting(name), until)
    assert timers.next_tick() == 5
    assert names(timers.due(4)) == []
    assert names(timers.due(9)) == ["a", "b", "c"]
    assert timers.next_tick() is None


def test_a_wait_that_is_over_has_no_time_out():
    timers = Timers()
    strand = waiting("a")
    timers.set(strand, 5)
    strand.ticket += 1
    assert timers.next_tick() is None
    timers.set(strand, 7)
    strand.state = READY
    assert names(timers.due(10)) == []


def test_held_waits_last_longer_by_the_hold():
    timers = Timers()
    timers.set(waiting("a"), 100)
    timers.hold(30)
    assert timers.next_tick() is None
    timers.release(1000)
    assert timers.next_tick() == 1070


def test_waits_of_secondary_programs_are_not_held():
    timers = Timers()
    timers.set(waiting("sec", is_secondary=True), 8)
    timers.set(waiting("main"), 6)
    timers.hold(0)
    assert names(timers.due(100)) == ["sec"]


def test_a_wait_that_begins_during_a_hold_counts_from_its_end():
    timers = Timers()
    timers.hold(0)
    timers.set_held(waiting("a"), 5)
    assert timers.due(100) == []
    timers.release(100)
    assert timers.next_tick() == 105


def test_forgotten_waits_do_not_come_back():
    timers = Timers()
    timers.set(waiting("a"), 5)
    timers.hold(0)
    timers.forget_held()
    timers.release(9)
    assert timers.next_tick() is None
