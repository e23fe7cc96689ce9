"""What the lines of a journal may hold."""

from __future__ import annotations

import json
from typing import Any

import pytest

from elitescript.codec.messages import shape_of
from elitescript.codec.values import with_parts
from elitescript.messages.events import Event, Warned
from elitescript.said import said
from elitescript.services.journal.records import DIGEST_TICKS, RecordError, RecordReader, check_answer

TICK = {"tick": 3, "in": []}
DIGEST = {"digest": 3, "hash": "", "ticks": "00000000"}


def read(*records: Any, first_tick: int = 0) -> list[dict[str, Any]]:
    reader = RecordReader(first_tick)
    return [reader.read(json.dumps(record).encode() + b"\n") for record in records]


def refusal(*records: Any) -> str:
    with pytest.raises(RecordError) as caught:
        read(*records)
    return str(caught.value)


TEXT = said("{n} times", n=3)
WRITTEN = shape_of(Event).encode(Warned(90, TEXT))


def test_texts_of_events_may_have_their_parts():
    told = {"told": 90, "events": [WRITTEN]}
    (plain,) = read(told)
    (whole,) = read(told | {"said": with_parts([WRITTEN])})
    assert plain["events"] == whole["events"] == [Warned(90, TEXT)]
    assert whole["events"][0].text.template == "{n} times"
    other = with_parts([shape_of(Event).encode(Warned(90, said("{n} days", n=3)))])
    assert "texts of the events" in refusal(told | {"said": other})
    assert "a list is expected" in refusal(told | {"said": 5})


def test_lines_in_their_order_pass():
    assert len(read(TICK, DIGEST, {"told": 90, "events": []}, {"tick": 4, "in": []}, {"end": 5})) == 5


@pytest.mark.parametrize(
    ("record", "why"),
    [
        ([], "no record"),
        ({}, "one of the keys tick, digest, told, restart, end"),
        ({"tick": "3", "in": []}, "tick must be a whole number, not str '3'"),
        ({"tick": True, "in": []}, "tick must be a whole number"),
        ({"tick": 3}, "in must be a list, not NoneType"),
        ({"tick": 3, "in": [["Dance"]]}, "Dance"),
        ({"tick": 3, "in": [], "asked": 5}, "asked must be a list"),
        ({"digest": 3, "hash": 1, "ticks": ""}, "hash must be a text"),
        ({"digest": 3, "hash": "", "ticks": "1234"}, "8 digits for each tick"),
        ({"restart": 3, "reason": "x", "state": {}, "lost": []}, "state must be a list"),
        ({"told": 3}, "events must be a list"),
        ({"told": 3, "events": [["Dance"]]}, "Dance"),
        ({"end": None}, "end must be a whole number"),
    ],
)
def test_a_line_of_another_form_is_refused(record: Any, why: str):
    assert why in refusal(record)


@pytest.mark.parametrize(
    "later", [{"tick": 3, "in": []}, {"tick": -1, "in": []}, {"digest": 2, "hash": "", "ticks": ""}]
)
def test_time_does_not_go_back(later: Any):
    assert "comes too late: the lines before reach up to tick 3" in refusal(TICK, later)


def test_a_gap_without_a_digest_is_refused_at_once():
    assert "comes too early" in refusal({"tick": 10**15, "in": []})
    assert "that of tick 4 is missing" in refusal(TICK, DIGEST, {"end": 4 + DIGEST_TICKS + 1})
    assert read(TICK, DIGEST, {"end": 4 + DIGEST_TICKS})


def test_the_place_of_a_mistake_is_told():
    reader = RecordReader(0)
    for line, at in ((b'{"tick": 3, in}\n', 12), (b'{"\xff": 3}\n', 2), (b"[]\n", 0)):
        with pytest.raises(RecordError) as caught:
            reader.read(line)
        assert caught.value.at == at


@pytest.mark.parametrize(
    ("question", "answer", "fits"),
    [
        (["kind", "x"], ["ok", "file"], True),
        (["kind", "x"], ["ok", 3], False),
        (["kind", "x"], ["error", "os", 2, "no such file", "x"], True),
        (["kind", "x"], ["error", "os", 2], False),
        (["kind", "x"], [], False),
        (["kind", "x"], "ok", False),
        (["read", 1, 0, 3], ["ok", "YWJj"], True),
        (["read", 1, 0, 2], ["ok", "YWJj"], False),
        (["read", 1, 0, 3], ["ok", "?"], False),
        (["write", 1, 0, "YQ=="], ["ok", [1, 1]], True),
        (["write", 1, 0, "YQ=="], ["ok", [1]], False),
        (["names", "x"], ["ok", ["a"]], True),
        (["names", "x"], ["ok", [1]], False),
        (["close", 1], ["ok", None], True),
    ],
)
def test_answers_about_files_fit_their_question(question: list[Any], answer: Any, fits: bool):
    if fits:
        check_answer(question, answer)
    else:
        with pytest.raises(RecordError, match="is no answer to"):
            check_answer(question, answer)
