"""Journals of earlier formats: a session that was written down then comes out the same today.

`journals/format-2.journal` has a task with a connection, faults of connections and inputs, Modbus writes, variables,
queries, interpreter mode and a restart.
"""

from __future__ import annotations

import platform
from pathlib import Path
from typing import Any

import pytest

from elitescript.codec.json_text import from_text
from elitescript.codec.values import CodecError
from elitescript.errors import UsageError
from elitescript.messages.events import Printed, Warned
from elitescript.services.journal.format2 import Format2
from elitescript.services.journal.replay import Replay
from elitescript.services.journal.writer import JournalReader
from tests.protocol.snapshots import output

FOLDER = Path(__file__).with_name("journals")
TICKS = 800
IS_OTHER = (platform.system(), platform.machine()) != ("Linux", "x86_64")
OTHER = "other C libraries give other last bits"


@pytest.mark.skipif(IS_OTHER, reason=OTHER)
def test_format_2_comes_out_the_same():
    reader = JournalReader(FOLDER / "format-2.journal")
    session = Replay(reader)
    outputs = list(session.outputs())
    assert session.difference is None
    assert session.checked_ticks == TICKS
    assert reader.note == ""
    assert sum(len(output.replies) for output in outputs) == 39


def test_warnings_of_format_2_are_read_and_written_without_what_came_later():
    old = Format2()
    fields = [1, "[SEC] Exception: x", "sec", 2, "", "", 0, "warning"]
    assert old.event(["Warned", *fields]) == Warned(*fields)
    text = old.output_text(output(1, events=(Warned(*fields, is_exception=True), Printed(1, "a", "main", 1))))
    assert from_text(text)[1] == [["Warned", *fields], ["Printed", 1, "a", "main", 1]]
    with pytest.raises(CodecError):
        old.event(["Warned", *fields, True, True])


@pytest.mark.parametrize(
    ("data", "number"),
    [
        (["ChannelOpened", 1, False, "no answer within 2 s"], 110),
        (["ChannelOpened", 1, False, "Connection refused"], 111),
        (["ChannelOpened", 1, False, "Name or service not known"], 113),
        (["ChannelOpened", 1, False, "nothing is connected"], -1),
        (["ChannelOpened", 1, True, ""], 104),
        (["ChannelClosed", 1, ""], 104),
        (["ChannelClosed", 1, "broken pipe"], 32),
        (["ChannelClosed", 1, "something new"], 5),
    ],
)
def test_reasons_of_format_2_get_their_number(data: list[Any], number: int):
    assert Format2().input(data).error == number


def record_of(tmp_path: Path, old: str, new: str) -> Path:
    """The same journal with one text replaced."""
    text = (FOLDER / "format-2.journal").read_text()
    assert old in text
    path = tmp_path / "a.journal"
    path.write_text(text.replace(old, new, 1))
    return path


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ('"CS66","",', '"CS66",', "line 1: the options of format 2 have 22 fields"),
        (r"\"kind\": \"delay\", ", "", "line 1: no fault: kind: is missing"),
        ('["{', '["[{', "line 1: no fault: "),
        (
            r'"{\"kind\": \"corrupt\"',
            r'"{\"kind\": \"spoil\"',
            "line 6, byte .*: no fault: kind: there is no fault 'spoil'",
        ),
        ('["Query","query#1/1","7","1 + 1"]', '["Query","query#1/1",7,"1 + 1"]', "Query: 2 fields are expected"),
        ('"told":750,"events":[["Alarm",750', '"told":750,"events":[["Alarm","750"', "Alarm.tick: a whole number"),
    ],
)
def test_a_damaged_journal_of_format_2_is_refused_with_its_place(tmp_path: Path, old: str, new: str, why: str):
    with pytest.raises(UsageError, match=why):
        list(Replay(JournalReader(record_of(tmp_path, old, new))).outputs())


@pytest.mark.parametrize(
    ("old", "new", "tick"),
    [
        ('["Query","query#1/1","7","1 + 1"]', '["Query","query#1/1","6","1 + 1"]', 120),
        (r"\"delay_s\": 0.02", r"\"delay_s\": 0.04", 25),
        (r"\"settle_s\": 0.04", r"\"settle_s\": 0.02", 32),
        ('["SetVariable","dashboard#1/8","b","[1, 2]"]', '["SetVariable","dashboard#1/8","b","[1, 3]"]', 771),
    ],
)
@pytest.mark.skipif(IS_OTHER, reason=OTHER)
def test_a_difference_in_a_journal_of_format_2_is_found(tmp_path: Path, old: str, new: str, tick: int):
    session = Replay(JournalReader(record_of(tmp_path, old, new)))
    list(session.outputs())
    assert session.difference is not None
    assert session.difference.tick == tick
