"""Every command that talks to something outside, with everything that can go wrong there."""

from __future__ import annotations

import pytest

from elitescript import VirtualRobot
from elitescript.commands.catalogue import CATALOGUE
from elitescript.errors import UsageError
from elitescript.messages.events import TextMessage
from elitescript.messages.timing import TICKS_PER_S
from elitescript.testing.world import Fault, World
from tests.faults.scenes import SCENES
from tests.faults.table import Row, load

FAULTS, ROWS = load()
FAMILIES = ("socket", "rpc", "serial", "modbus_rtu", "modbus")

FAULT_S = 0.9
MARGIN_S = 0.05
"""More than a call takes that is over at once: connecting, the bytes on a line, trickling them."""


def fault_of(row: Row, name: str) -> Fault:
    """The fault of a column, where a row's command meets it; it is over when the command must have returned."""
    end_s = SCENES[row.scene].call_s + row.limit_s + 5.0
    settings = {"at_s": FAULT_S, **FAULTS[name]}
    settings.setdefault("for_s", end_s - settings["at_s"])
    return Fault(on=SCENES[row.scene].on, **settings)


def program(row: Row, *, catches: bool) -> str:
    """Make a call at 1 s, while something goes wrong, and once more when nothing does."""
    scene = SCENES[row.scene]
    call = f"textmsg({row.call})"
    if catches:
        call = f"try:\n  {call}\nexcept Exception as problem:\n  textmsg(problem)\nend"
    body = f"""
import time
begin = time.time()
def wait(until):
  sleep(until - (time.time() - begin))
end
wait({FAULT_S - 0.1})
{scene.before}
wait({scene.call_s})
textmsg("begin")
{call}
wait({scene.call_s + row.limit_s + 6.0})
{scene.again}
textmsg({row.call})
{scene.after}
"""
    return main(body)


def main(body: str) -> str:
    """A program of these lines."""
    return "def main():\n" + "".join(f"  {line}\n" for line in body.strip().split("\n")) + "end\n"


class Outcome:
    """What has come of one cell."""

    def __init__(self, row: Row, fault: Fault | None, *, catches: bool, steps: bool = False) -> None:
        self.device = SCENES[row.scene].device(row)
        self.world = World(devices=[self.device], faults=[] if fault is None else [fault])
        self.robot = VirtualRobot("CS66", world=self.world, firmware="2.14")
        pace = (lambda tick: None) if steps else None
        self.run = self.robot.run(program(row, catches=catches), until_s=500.0, pace=pace)
        said = [event for event in self.run.events if isinstance(event, TextMessage)]
        self.begin, *self.texts = [event.text for event in said]
        assert self.begin == "begin"
        self.took_s = (said[1].tick - said[0].tick) / TICKS_PER_S if len(said) > 1 else 0.0

    def assert_nothing_is_left(self, row: Row) -> None:
        """Nothing is open that the program has not left open on purpose."""
        after = SCENES[row.scene].after
        if after and self.run.state == "alarm":
            self.robot.run(main(after))
        self.robot.advance(7.0)  # what is late is closed late
        assert self.world.network.open_channels == 0
        assert self.robot._host.connections == {}
        assert getattr(self.device, "connections", ()) == ()
        assert getattr(self.device, "_link", None) is None, "the device has not seen the close"


ids = [row.title for row in ROWS]


@pytest.mark.parametrize("row", ROWS, ids=ids)
def test_without_a_fault(row: Row) -> None:
    done = Outcome(row, None, catches=False)
    assert (done.texts, done.run.state) == ([row.good, row.good], "finished")
    assert done.took_s <= 0.1 + MARGIN_S
    done.assert_nothing_is_left(row)


@pytest.mark.parametrize("name", FAULTS)
@pytest.mark.parametrize("row", ROWS, ids=ids)
def test_with_a_fault(row: Row, name: str) -> None:
    cell = row.cells[name]
    if cell == "refused":
        with pytest.raises(UsageError):
            World(devices=[SCENES[row.scene].device(row)], faults=[fault_of(row, name)])
        return
    done = Outcome(row, fault_of(row, name), catches=True)
    first, second = done.texts
    if cell.startswith("alarm "):
        assert cell.removeprefix("alarm ") in {event.code for event in stopped(row, name).run.alarms}
        assert first != row.good
    elif cell == "any":
        assert first != row.good
    else:
        assert first == row.outcome(name)
    assert second == row.good, "what went wrong is over"
    assert done.run.state == "finished"
    if cell == "time-out":
        assert row.limit_s <= done.took_s <= row.limit_s + MARGIN_S
    assert done.took_s <= (row.limit_s or 0.1) + MARGIN_S
    done.assert_nothing_is_left(row)
    hears(done, row, name)


def stopped(row: Row, name: str) -> Outcome:
    """The program that does not catch what is raised has ended there."""
    done = Outcome(row, fault_of(row, name), catches=False)
    assert (done.run.state, done.texts) == ("alarm", [])
    done.assert_nothing_is_left(row)
    return done


def hears(done: Outcome, row: Row, name: str) -> None:
    """What the device has got of a command that sends: of the first call what the fault leaves, all of the second."""
    if not row.gets:
        return
    whole = row.gets.encode("latin-1")
    heard = done.device.heard  # type: ignore[attr-defined]
    assert heard.endswith(whole)
    first = heard[: -len(whole)]
    kind = FAULTS[name]["kind"]
    if kind in ("silence", "drop") or row.outcome(name) == row.failed != row.good:
        assert first == b""
    elif kind == "duplicate":
        assert first == whole * 2
    elif kind == "corrupt":
        assert len(first) == len(whole) and first != whole
    elif kind != "disconnect" or name == "break":
        assert first == whole


def test_the_table_has_every_command() -> None:
    there = {row.command for row in ROWS}
    aliases = {name for command in CATALOGUE for name in command.aliases}
    assert there == {command.name for command in CATALOGUE if command.family in FAMILIES} - aliases
