"""What clients send that fails: told one by one as long as it is little."""

from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.events import Alarm, Event, Warned
from elitescript.messages.inputs import RunUnit
from elitescript.protocol.bursts import BURST_TICKS, REPORT_TICKS, REPORTED_MAX


def heard(kernel: Kernel, ticks: int, *lines: str, origin: str = "primary#1") -> list[Event]:
    """Send the same lines in each tick; what is said."""
    sent = [RunUnit(origin, "line", line) for line in lines]
    return [event for _ in range(ticks) for event in kernel.tick(sent).events]


def test_a_few_lines_are_told_one_by_one_and_a_flood_by_its_number():
    kernel = Kernel(RobotOptions())
    said = heard(kernel, 3 * REPORT_TICKS, "hello there", "no_such_thing()") + heard(kernel, BURST_TICKS)
    assert len([event for event in said if isinstance(event, Alarm)]) == REPORTED_MAX
    reports = [event.text for event in said if isinstance(event, Warned)]
    assert len(reports) == 3
    assert "primary#1 sent" in reports[0]
    assert "more lines that are no script" in reports[0]
    assert sum(int(text.split()[2]) for text in reports) == 6 * REPORT_TICKS - REPORTED_MAX
    assert heard(kernel, 2 * BURST_TICKS) == []


def test_every_client_and_every_burst_counts_for_itself():
    kernel = Kernel(RobotOptions())
    heard(kernel, 2 * REPORTED_MAX, "hello there")
    assert [type(event) for event in heard(kernel, 1, "hello there", origin="primary#2")] == [Alarm]
    heard(kernel, BURST_TICKS)
    assert [type(event) for event in heard(kernel, 1, "hello there")] == [Alarm]


def test_programs_and_lines_that_make_sense_are_none_of_it():
    kernel = Kernel(RobotOptions())
    heard(kernel, 2 * REPORTED_MAX, "hello there")
    program = [RunUnit("primary#1", "program", "def p():\n  x = = 1\nend\n")]
    assert any(isinstance(event, Alarm) for event in kernel.tick(program).events)
    assert not [event for event in heard(kernel, 3, "x = 1") if isinstance(event, Alarm | Warned)]
