"""Random programs that write signals: each change is an event with its value and line, whoever reads the events.

The program is written together with the changes that it must make. They are compared with those of a run that nothing
listens to, whose events are made when they are read, and of runs in which something needs each event at once.
`ELITESCRIPT_INVARIANTS` sets how many are tried (10 if unset).
"""

from __future__ import annotations

from random import Random

import pytest

from elitescript import VirtualRobot
from elitescript import run as run_module
from elitescript.messages.events import SignalChanged, TextMessage
from tests.invariants.cases import CASES

pytestmark = pytest.mark.invariants

POINTS = {
    "standard_digital_out": ("set_standard_digital_out", (False, True)),
    "output_bool_register": ("write_output_boolean_register", (False, True)),
    "output_int_register": ("write_output_integer_register", (0, 1, 7)),
    "output_float_register": ("write_output_float_register", (0, 0.5, 2)),
    "flag": ("set_flag", (False, True)),
}
"""Command and values, by family."""


class Program:
    """A program of one thread, and what it must do: texts, and names, values and lines of changes."""

    def __init__(self, seed: int) -> None:
        self._random = Random(seed)
        self._lines = ["def job():"]
        self._levels: dict[str, object] = {}
        self._helpers = [(self._helper(number), f"helper{number}") for number in range(2)]
        self.expected: list[tuple[object, ...]] = []
        for number in range(self._random.randrange(4, 25)):
            self._statement(number)
        self._add("end")
        self.text = "\n".join(self._lines) + "\n"

    def _add(self, line: str) -> int:
        self._lines.append(line)
        return len(self._lines)

    def _write(self) -> tuple[str, str, object]:
        """A random point, the call that writes it, and the value."""
        family = self._random.choice(list(POINTS))
        command, values = POINTS[family]
        index, value = self._random.randrange(3), self._random.choice(values)
        return f"{family}[{index}]", f"{command}({index}, {value})", value

    def _helper(self, number: int) -> list[tuple[str, object, int]]:
        self._add(f"  def helper{number}():")
        writes = []
        for _ in range(self._random.randrange(1, 4)):
            name, call, value = self._write()
            writes.append((name, value, self._add(f"    {call}")))
        self._add("  end")
        return writes

    def _does(self, name: str, value: object, line: int) -> None:
        if self._levels.get(name, 0) != value:
            self._levels[name] = value
            self.expected.append((name, value, line))

    def _statement(self, number: int) -> None:
        kind = self._random.choice(("write", "write", "helper", "loop", "eval", "text", "sync", "many"))
        name, call, value = self._write()
        if kind == "write":
            self._does(name, value, self._add(f"  {call}"))
        elif kind == "helper":
            writes, helper = self._random.choice(self._helpers)
            self._add(f"  {helper}()")
            for write in writes:
                self._does(*write)
        elif kind == "loop":
            self._add("  for i in range(40):")
            toggled = self._add("    write_output_integer_register(20, i)")
            repeated = self._add(f"    {call}")
            self._add("  end")
            for i in range(40):
                self._does("output_int_register[20]", i, toggled)
                self._does(name, value, repeated)
        elif kind == "eval":
            self._does(name, value, self._add(f"  eval('{call}')"))
        elif kind == "many":
            line = self._add(f"  {call}; [write_output_integer_register(21, i) for i in [3, 4, 4, {number}]]")
            self._does(name, value, line)
            for i in (3, 4, 4, number):
                self._does("output_int_register[21]", i, line)
        elif kind == "text":
            self._add(f"  textmsg('{number}')")
            self.expected.append((f"{number}",))
        else:
            self._add("  sync()")


def done(events):
    """What of the events the program writes down before it runs."""
    return [
        (event.text,) if isinstance(event, TextMessage) else (event.name, event.value, event.line)
        for event in events
        if isinstance(event, TextMessage | SignalChanged)
    ]


@pytest.mark.parametrize("seed", range(CASES))
def test_changes_are_events_with_value_and_line_whoever_reads_them(seed, monkeypatch):
    program = Program(seed)
    # So little work fits into a tick that what an event costs decides in which tick the next one happens.
    options = {"work_per_tick": Random(seed).choice((100, 500, 100_000))}
    alone = VirtualRobot("CS66", **options).run(program.text).check()
    assert done(alone.events) == program.expected

    heard, held = [], []
    listening = VirtualRobot("CS66", on_event=heard.append, **options).run(program.text).check()
    assert heard == listening.events == alone.events

    def hold(robot):
        if not held:
            held.append(robot.current.events)

    robot = VirtualRobot("CS66", **options)
    reading = robot.run(program.text, watch=hold).check()
    assert held[0] == alone.events
    assert held[0] is reading.events

    robot = VirtualRobot("CS66", **options)
    robot.connect("dashboard")
    assert robot.run(program.text).check().events == alone.events

    robot = VirtualRobot("CS66", on_event=lambda event: None, **options)
    robot.reports_signals = False
    assert robot.run(program.text).check().events == alone.events

    monkeypatch.setattr(run_module, "RECORDS_MAX", 20)
    monkeypatch.setattr(run_module, "_SURPLUS_FROM", 22)
    robot = VirtualRobot("CS66", **options)
    long = robot.run(program.text).check()
    watched = VirtualRobot("CS66", **options).run(program.text, watch=lambda robot: robot.current.events).check()
    for run in (long, watched):
        assert run.events == alone.events[run.events_dropped :]
        assert (len(run.events) <= 22, len(run.events) >= min(20, len(alone.events))) == (True, True)
    assert long.events_dropped == watched.events_dropped
