"""A recording read back, and how small it is."""

from __future__ import annotations

import gzip
import json
import math
from array import array
from itertools import accumulate
from random import Random

import pytest

from elitescript.conversation.recording import RecordedRun, recording
from elitescript.errors import UsageError
from tests.conversation.conversations import JOB, made


def read(data):
    """Return the runs of a recording, with columns by name; written from its description, not from its code."""
    raw = gzip.decompress(data)
    size = int.from_bytes(raw[:4], "little")
    head, place = json.loads(raw[4 : 4 + size]), 4 + size
    assert head["format"] == 1
    for run in head["runs"]:
        count, columns = run["rows"]["count"], {}
        for column in run["rows"]["columns"]:
            if column["step"] == 0:
                columns[column["name"]] = list(array("d", raw[place : place + 8 * count]))
                place += 8 * count
                continue
            planes = [raw[place + plane * count : place + (plane + 1) * count] for plane in range(4)]
            place += 4 * count
            folded = [a | b << 8 | c << 16 | d << 24 for a, b, c, d in zip(*planes, strict=True)]
            whole = [value // 2 if value % 2 == 0 else -(value + 1) // 2 for value in folded]
            for _ in range(column["order"]):
                whole = list(accumulate(whole))
            columns[column["name"]] = [value * column["step"] for value in whole]
        run["columns"] = columns
    assert place == len(raw)
    return head["runs"]


def test_rows_are_there_to_a_millionth():
    run = made(JOB)
    (found,) = read(recording([run]))
    assert found["columns"].pop("tick") == list(run.ticks)
    assert found["columns"].keys() == run.columns.keys()
    for name, values in run.columns.items():
        assert max(abs(a - b) for a, b in zip(found["columns"][name], values, strict=True)) <= 1e-6, name
    assert found["said"] == [json.loads(json.dumps(message)) for message in run.said]


def test_globals_and_waits_are_there_at_every_change():
    (found,) = read(recording([made(JOB)]))
    (n,) = found["globals"]
    assert (n["name"], n["value"], n["type"]) == ("n", ["1", "2"], ["int"] * 2) or n["value"][-2:] == ["1", "2"]
    assert [entry["thread"] for entry in found["waits"]] == ["main", "other"]
    assert found["first"]["t"] <= 0.004


@pytest.mark.parametrize("value", [1e9, -1e9, math.inf, math.nan], ids=str)
def test_numbers_that_are_too_large_stay_exact(value):
    columns = {"q1": [0.0, value, 0.5]}
    (found,) = read(recording([RecordedRun([], [0, 1, 5], columns)]))
    assert json.dumps(found["columns"]["q1"]) == json.dumps([0.0, value, 0.5])
    assert found["columns"]["tick"] == [0, 1, 5]


def test_jumps_between_the_largest_numbers():
    chance = Random(3)
    values = [chance.choice((-26.8, 26.8)) for _ in range(200)]
    (found,) = read(recording([RecordedRun([], range(200), {"q1": values, "rz": values})]))
    assert found["columns"]["q1"] == pytest.approx(values, abs=1e-6)
    assert found["columns"]["rz"] == pytest.approx(values, abs=1e-6)


def test_a_smooth_motion_takes_less_than_a_byte_for_each_number():
    count = 5000
    columns = {f"q{joint}": [math.sin(0.004 * joint * k) for k in range(count)] for joint in range(1, 7)}
    assert len(recording([RecordedRun([], range(count), columns)])) < 0.8 * 6 * count


def test_the_same_run_gives_the_same_bytes():
    assert recording([made(JOB)]) == recording([made(JOB)])


def test_hostile_texts_come_back():
    text = "</script><!-- \u2028 \ud800 \x00 \U0001f916"
    said = [{"type": "notice", "severity": "error", "text": text}]
    (found,) = read(recording([RecordedRun(said, [], {})]))
    assert found["said"] == [{**said[0], "text": "</script><!-- \u2028 \\ud800 \x00 \U0001f916"}]


@pytest.mark.parametrize("columns", [{"q9": [0.0]}, {"q1": [0.0, 1.0]}])
def test_a_column_that_makes_no_sense(columns):
    with pytest.raises(UsageError, match="cannot be recorded"):
        recording([RecordedRun([], [0], columns)])
