"""How long a run waits for what its program gave away, whether every tick is looked at or not."""

from __future__ import annotations

import pytest

from elitescript.devices.drain import REACTION_TICKS, Drain

ARRIVES = 20


class Background:
    channels = ()

    def pending(self):
        return ()

    def give_up(self):
        return ()


class Channels:
    """Bytes are under way until a tick."""

    tick = 0

    def pending(self, _ignoring):
        return ("3 bytes",) if self.tick < ARRIVES else ()

    def give_up(self, _ignoring):
        return ()


class BusyDevices:
    def next_tick(self, tick):
        return tick + 1


def end_of(ticks):
    """Return the tick at which a drain is over that is asked in these ticks."""
    channels = Channels()
    drain = Drain(0, channels, Background(), BusyDevices(), 2.0)
    for tick in ticks:
        channels.tick = tick
        if drain.is_over(tick):
            return tick
    return None


@pytest.mark.parametrize("ticks", [range(100), [0, *range(ARRIVES, 100)], [0, 7, *range(ARRIVES, 100)]])
def test_devices_may_react_for_as_long_whether_the_wait_is_leapt_over_or_not(ticks):
    assert end_of(ticks) == ARRIVES - 1 + REACTION_TICKS
