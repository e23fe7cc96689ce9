"""Rows that a child sends ahead, from its answer to their ticks; what it announces and does not send."""

from __future__ import annotations

import pytest

from elitescript.codec.values import CodecError
from elitescript.messages.outputs import Output, SendChannel
from elitescript.messages.snapshot_parts import ALL_PARTS, JOINTS, POSES, TIME
from elitescript.services.child.rows_ahead import RowsAhead
from tests.protocol.snapshots import snapshot


def row(tick: int) -> Output:
    return Output(tick, (), (), (), snapshot(tick), JOINTS | TIME)


def announced(count: int, *, is_newest: bool = True) -> RowsAhead:
    """Rows of the ticks from 11 on."""
    rows = RowsAhead()
    rows.announce(10, count, JOINTS, due=99, is_newest=is_newest)
    return rows


def test_rows_are_known_before_they_have_come() -> None:
    rows = announced(3)
    assert [rows.knows(tick, JOINTS | TIME) for tick in (11, 13, 14)] == [True, True, False]
    assert not rows.knows(11, POSES)
    assert rows.take(11) is None
    assert rows.add(row(11))
    assert rows.take(11) == row(11)
    assert rows.due == 99


def test_rows_of_ticks_that_are_leapt_over_are_forgotten() -> None:
    rows = announced(3)
    for tick in (11, 12, 13):
        assert rows.add(row(tick))
    assert rows.take(13) == row(13)
    assert rows.take(12) is None


def test_no_row_is_used_of_a_tick_that_is_sent_and_of_later_ones() -> None:
    rows = announced(4)
    rows.add(row(11))
    rows.add(row(12))
    rows.end_before(12)
    assert [rows.knows(tick, TIME) for tick in (11, 12, 13)] == [True, False, False]
    # Those that were under way still come.
    assert [rows.add(row(tick)) for tick in (13, 14)] == [False, False]
    rows.announce(12, 1, JOINTS, due=99, is_newest=True)
    assert rows.add(row(13))


def test_rows_after_an_answer_that_is_not_the_newest_are_not_used() -> None:
    rows = announced(2, is_newest=False)
    assert not rows.knows(11, TIME)
    assert not rows.add(row(11))


def test_other_rows_than_those_announced_are_refused() -> None:
    for tick in (10, 12):
        with pytest.raises(CodecError, match="not announced"):
            announced(3).add(row(tick))
    with pytest.raises(CodecError, match="not announced"):
        RowsAhead().add(row(0))
    rows = announced(1)
    with pytest.raises(CodecError, match="tick 11 is missing"):
        rows.announce(11, 1, ALL_PARTS, due=99, is_newest=True)


def test_a_row_in_which_something_happens_is_refused() -> None:
    happens = Output(11, (), (SendChannel(1, b"x"),), (), snapshot(11))
    with pytest.raises(CodecError, match="something happens"):
        announced(1).add(happens)
