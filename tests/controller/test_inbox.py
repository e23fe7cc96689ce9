import pytest

from elitescript.controller import inbox as inbox_module
from elitescript.controller.inbox import Inbox
from elitescript.errors import UsageError
from elitescript.messages.machine import SetSpeedScale


def test_entries_come_out_at_their_tick_in_the_order_of_arrival():
    inbox = Inbox()
    for tick, fraction in ((5, 0.1), (2, 0.2), (5, 0.3), (2, 0.4)):
        inbox.put(tick, SetSpeedScale(fraction))
    assert inbox.next_tick == 2
    assert inbox.due(1) is None
    taken = []
    for tick in (2, 5):
        while (request := inbox.due(tick)) is not None:
            taken.append(request.fraction)
    assert taken == [0.2, 0.4, 0.1, 0.3]
    assert inbox.next_tick is None


def test_a_full_inbox_refuses_the_newcomer(monkeypatch):
    monkeypatch.setattr(inbox_module, "CAPACITY", 2)
    inbox = Inbox()
    inbox.put(0, SetSpeedScale(0.1))
    inbox.put(0, SetSpeedScale(0.2))
    with pytest.raises(UsageError, match="full"):
        inbox.put(0, SetSpeedScale(0.3))
    assert inbox.due(0) == SetSpeedScale(0.1)
