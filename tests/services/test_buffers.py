import itertools
import time

from elitescript.messages.events import TextMessage
from elitescript.messages.outputs import REPEAT_AFTER_S, TickResult
from elitescript.messages.timing import PERIOD_S
from elitescript.services.child.buffers import DELAY_MAX_TICKS, REPEAT_AFTER_TICKS, OutputBuffer
from tests.protocol.snapshots import output


def robot_ticks(buffer, arrivals):
    """The picture shown in each tick, when so many outputs have come in before each."""
    number, shown = 0, []
    for tick, count in enumerate(arrivals):
        for _ in range(count):
            buffer.add(output(number))
            number += 1
        shown.append(buffer.take(tick).snapshot.robot.tick)
    return shown


class TestOutputBuffer:
    def test_what_comes_in_time_leaves_at_once(self):
        assert robot_ticks(OutputBuffer(), [1] * 500) == list(range(500))

    def test_who_is_late_once_is_not_seen_to_be_late_again(self):
        assert robot_ticks(OutputBuffer(), [1, 1, 0, 2, 1, 0, 2, 0, 2, 1]) == [0, 1, 1, 2, 3, 4, 5, 6, 7, 8]

    def test_each_output_is_a_row_once_with_its_own_tick(self):
        buffer, number = OutputBuffer(), itertools.count()
        rows, counts = [], []
        for tick, arrivals in enumerate([1, 1, 0, 0, 3, 1, 0, 7, 1, 0, 0, 9]):
            for _ in range(arrivals):
                buffer.add(output(next(number)))
            found = buffer.take(tick)
            assert found.tick == tick
            rows += [(row.tick, row.snapshot.robot.tick) for row in found.rows]
            counts.append(len(found.rows))
        assert counts == [1, 1, 0, 0, 1, 1, 1, 6, 1, 1, 1, 7]
        assert rows == [(tick, tick) for tick in range(21)]

    def test_streams_repeat_their_row_when_there_was_none_for_long_by_ticks_and_by_the_clock(self, monkeypatch):
        now = [100.0]
        monkeypatch.setattr(time, "monotonic", lambda: now[0])
        buffer, tick = OutputBuffer(), itertools.count()

        def repeats(arrivals, period_s, ticks):
            found = []
            for _ in range(ticks):
                now[0] += period_s
                for _ in range(arrivals):
                    buffer.add(output(0))
                found.append(buffer.take(next(tick)).repeats)
            return found

        assert repeats(1, PERIOD_S, 50) == [False] * 50
        assert repeats(0, PERIOD_S, 40) == [False] * REPEAT_AFTER_TICKS + [True] * (40 - REPEAT_AFTER_TICKS)
        assert repeats(1, PERIOD_S, 1) == [False]
        # Ticks that are made up for follow one another at once.
        assert repeats(0, 0.0001, 125) == [False] * 125
        assert repeats(0, REPEAT_AFTER_S, 1) == [True]
        assert repeats(1, PERIOD_S, 1) == [False]
        # The computer was away.
        assert repeats(0, 3.0, 3) == [False] * 3
        # A tick may be waited for before it leaves.
        assert repeats(1, PERIOD_S, 1) == [False]
        buffer.note_lack()
        assert repeats(0, REPEAT_AFTER_S, 1) == [False]
        assert repeats(0, 0.0001, REPEAT_AFTER_TICKS) == [False] * (REPEAT_AFTER_TICKS - 1) + [True]

    def test_an_output_without_a_snapshot_is_a_row_with_the_one_before(self):
        buffer = OutputBuffer()
        buffer.add(output(0))
        assert buffer.take(0).rows[0].tick == 0
        assert buffer.take(1).rows == ()
        buffer.add(TickResult(1, (), (), ()))
        (row,) = buffer.take(2).rows
        assert (row.tick, row.snapshot.robot.tick) == (1, 0)

    def test_what_the_server_adds_leaves_with_the_tick_itself(self):
        buffer = OutputBuffer()
        buffer.add(output(5))
        buffer.add_own(TextMessage(5, "ours", "", 0))
        found = buffer.take(5)
        assert found.rows == (found,)
        assert [event.text for event in found.events] == ["ours"]

    def test_no_more_than_a_few_outputs_wait(self):
        shown = robot_ticks(OutputBuffer(), [1, *[0] * 20, 21, 1, 1])
        assert shown[-3:] == [21 - DELAY_MAX_TICKS, 22 - DELAY_MAX_TICKS, 23 - DELAY_MAX_TICKS]

    def test_a_delay_that_is_not_needed_is_undone(self):
        shown = robot_ticks(OutputBuffer(), [1, 0, 2, *[1] * 600])
        assert shown[10] == 9
        assert shown[-1] == len(shown) - 1

    def test_nothing_that_was_said_is_lost_or_out_of_order(self):
        buffer, said = OutputBuffer(), []
        for tick, count in enumerate([1, 0, 3, 0, 0, 5, 1, 0, 1, 9, 0, 0]):
            for number in range(count):
                buffer.add(output(tick, events=(TextMessage(tick, str(number), "main", 1),)))
            said += [(event.tick, event.text) for event in buffer.take(tick).events]
        assert said == sorted(said)
        assert len(said) == 20

    def test_what_is_added_comes_after_what_waits_when_all_is_let_go(self):
        buffer = OutputBuffer()
        for tick in range(3):
            buffer.add(output(tick, events=(TextMessage(tick, "theirs", "main", 1),)))
        buffer.add_own(TextMessage(9, "ours", "", 0))
        buffer.flush()
        assert [event.text for event in buffer.take(9).events] == ["theirs", "theirs", "theirs", "ours"]
        assert buffer.is_empty
        assert buffer.newest is buffer.take(10).snapshot
