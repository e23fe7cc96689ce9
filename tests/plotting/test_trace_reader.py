"""Traces read back, and what is said about those that are none."""

import json

import pytest

from elitescript import PlantConfig
from elitescript.cli.main import main
from elitescript.cli.output.trace_file import TraceFile
from elitescript.controller.views.trace import TRACE_COLUMNS
from elitescript.errors import UsageError
from elitescript.outputs.writing import Output
from elitescript.plotting.trace_reader import read_trace
from tests.plotting.recordings import PROGRAM, recorded

HEADER = ",".join(TRACE_COLUMNS)
ROW = ",".join(["0.0", "1", *["0"] * 18, "playing"])
LATER = ROW.replace("0.0", "0.004", 1)


@pytest.mark.parametrize("suffix", [".csv", ".jsonl"])
def test_what_run_writes_is_read_back_to_the_last_bit(tmp_path, capsys, suffix):
    program, trace = tmp_path / "job.script", tmp_path / f"out{suffix}"
    program.write_text(PROGRAM)
    assert main(["run", str(program), "--trace", str(trace)]) == 0
    capsys.readouterr()
    assert read_trace(trace) == recorded().rows


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("", 1, "no column t, line, q1"),
        ("a,b\n1,2\n", 1, "not a trace: no column t,"),
        (HEADER.replace("qd3,", "") + "\n", 1, "no column qd3"),
        (HEADER + "\n", 1, "the trace has no rows"),
        (f"{HEADER}\n{ROW}\n1,2\n", 3, "2 cells, but the header has 21"),
        (
            f"{HEADER}\n{ROW}\n\n{LATER.replace('0,playing', 'abc,playing')}\n",
            4,
            "rz: needs a finite number, has 'abc'",
        ),
        (f"{HEADER}\n{ROW.replace('0,playing', 'nan,playing')}\n", 2, "rz: needs a finite number, has 'nan'"),
        (f"{HEADER}\n{ROW.replace('0.0,1,', '0.0,1.5,')}\n", 2, "line: needs a line number"),
        (f"{HEADER}\n{ROW}\n{ROW}\n", 3, "t = 0 s does not come after the 0 s before it"),
    ],
)
def test_a_csv_file_that_is_wrong_is_told_where(tmp_path, text, place, words):
    path = tmp_path / "out.csv"
    path.write_text(text)
    with pytest.raises(UsageError) as caught:
        read_trace(path)
    assert str(caught.value).startswith(f"{path}:{place}: ")
    assert words in str(caught.value)


GOOD = dict(zip(TRACE_COLUMNS, [0.0, 1, *[0.0] * 18, "playing"], strict=True))


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("{\n", 1, "not JSON"),
        ("[" * 100_000, 1, "not JSON"),
        ("[1]\n", 1, "needs an object"),
        (json.dumps(GOOD) + '\n{"t": 1}\n', 2, "no column line"),
        (json.dumps(GOOD | {"q4": None}), 1, "q4: needs a finite number, has None"),
        (json.dumps(GOOD | {"q4": True}), 1, "q4: needs a finite number, has True"),
        ("", 1, "no rows"),
    ],
)
def test_a_json_file_that_is_wrong_is_told_where(tmp_path, text, place, words):
    path = tmp_path / "out.jsonl"
    path.write_text(text)
    with pytest.raises(UsageError) as caught:
        read_trace(path)
    assert str(caught.value).startswith(f"{path}:{place}: ")
    assert words in str(caught.value)


def test_a_spreadsheet_may_have_added_a_mark_columns_and_its_line_ends(tmp_path):
    path = tmp_path / "out.csv"
    path.write_bytes(b"\xef\xbb\xbf" + f"note,{HEADER}\r\nhello,{ROW}\r\n".encode())
    (only,) = read_trace(path)
    assert (only.t, only.line, only.state) == (0.0, 1, "playing")


def test_other_bytes_and_missing_files_are_errors(tmp_path):
    path = tmp_path / "out.csv"
    path.write_bytes(HEADER.encode() + b"\n\xff\n")
    with pytest.raises(UsageError, match=r"out\.csv:2: the trace is not UTF-8"):
        read_trace(path)
    with pytest.raises(UsageError, match="cannot read"):
        read_trace(tmp_path / "none.csv")


@pytest.mark.parametrize("suffix", [".csv", ".jsonl"])
def test_measured_positions_come_back_too(tmp_path, suffix):
    rows = recorded(plant=PlantConfig(lag_s=0.02, noise_rad=1e-5)).rows
    with TraceFile(Output(tmp_path / f"out{suffix}"), has_actual=True) as file:
        for each in rows:
            file.write(each)
    assert read_trace(tmp_path / f"out{suffix}") == rows
    assert rows[20].q_actual != rows[20].q


def test_measured_positions_are_numbers(tmp_path):
    path = tmp_path / "out.csv"
    names = ",".join(f"qa{joint}" for joint in range(1, 7))
    path.write_text(f"{HEADER},{names}\n{ROW},0,0,0,0,0,x\n")
    with pytest.raises(UsageError, match=r"out\.csv:2: qa6: needs a finite number, has 'x'"):
        read_trace(path)


def test_some_of_the_measured_positions_are_columns_beyond(tmp_path):
    path = tmp_path / "out.csv"
    path.write_text(f"{HEADER},qa1\n{ROW},0\n")
    assert read_trace(path)[0].q_actual is None
