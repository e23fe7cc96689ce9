import pytest

from elitescript.controller import request_queue as inbox_module
from elitescript.controller.request_queue import RequestQueue
from elitescript.errors import UsageError
from elitescript.messages.machine import SetSpeedScale


def delivered(inbox, tick):
    taken = []
    inbox.deliver(tick, lambda request, by: taken.append((request.fraction, by)), lambda warning: None)
    return taken


def test_entries_come_out_at_their_tick_in_the_order_of_arrival():
    inbox = RequestQueue()
    for tick, fraction in ((5, 0.1), (2, 0.2), (5, 0.3), (2, 0.4)):
        inbox.put(tick, SetSpeedScale(fraction), f"source of {fraction}")
    assert inbox.next_tick == 2
    assert delivered(inbox, 1) == []
    assert delivered(inbox, 2) == [(0.2, "source of 0.2"), (0.4, "source of 0.4")]
    assert delivered(inbox, 5) == [(0.1, "source of 0.1"), (0.3, "source of 0.3")]
    assert inbox.next_tick is None


def test_a_full_inbox_refuses_the_newcomer(monkeypatch):
    monkeypatch.setattr(inbox_module, "CAPACITY", 2)
    inbox = RequestQueue()
    inbox.put(0, SetSpeedScale(0.1), "client")
    inbox.put(0, SetSpeedScale(0.2), "client")
    with pytest.raises(UsageError, match="full"):
        inbox.put(0, SetSpeedScale(0.3), "client")
    assert delivered(inbox, 0) == [(0.1, "client"), (0.2, "client")]
