"""Tables: the same rows in three formats, and names that clash."""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path

import pytest

from elitescript.errors import UsageError
from elitescript.sweep.plans.plan import Choices, Failure, Plan, Row, Variation
from elitescript.sweep.results.tables import columns, csv_line, format_of, write_table

PLAN = Plan(
    "",
    variations=(
        Variation("r", "uniform", (0, 1)),
        Variation("m", "choice", ("a", [1, 2])),
        Variation("n", "grid", (0, 2, 3)),
    ),
    measures={"top": "max_of(tcp[2])"},
    ensure=("time_s < 3, really",),
    has_margins=True,
)
ROWS = [
    Row(Choices(0, 17, {"r": 0.1, "m": 'say "a", b', "n": 0}), "finished", 2.5, {"top": 1e-17}, "ab", None, (0.5,)),
    Row(
        Choices(1, 18, {"r": 1.0, "m": [1, 2], "n": 1}), "hung", None, {}, "", Failure("time_s < 3, really", "hung"), ()
    ),
]
NAMES = ("run", "seed", "r", "m", "n", "state", "time_s", "top", "margin of time_s < 3, really", "failed", "digest")


def test_columns() -> None:
    assert columns(PLAN) == NAMES


@pytest.mark.parametrize("name", ["run", "state", "digest", "r"])
def test_names_that_clash_are_refused(name: str) -> None:
    plan = Plan("", variations=PLAN.variations, measures={name: "time_s"})
    with pytest.raises(UsageError, match=f"--measure {name}: the name is that of"):
        columns(plan)


def test_csv(tmp_path: Path) -> None:
    write_table(tmp_path / "out.csv", PLAN, ROWS)
    data = (tmp_path / "out.csv").read_bytes()
    assert data == (
        b'run,seed,r,m,n,state,time_s,top,"margin of time_s < 3, really",failed,digest\n'
        b'0,17,0.1,"say ""a"", b",0,finished,2.5,1e-17,0.5,,ab\n'
        b'1,18,1.0,"[1, 2]",1,hung,,,,"time_s < 3, really",\n'
    )
    assert [row["m"] for row in csv.DictReader(data.decode().splitlines())] == ['say "a", b', "[1, 2]"]
    assert csv_line([True, None, "a\nb", float("inf")]) == 'true,,"a\nb",inf\n'


def test_json_lines(tmp_path: Path) -> None:
    write_table(tmp_path / "out.jsonl", PLAN, ROWS)
    rows = [json.loads(line) for line in (tmp_path / "out.jsonl").read_text().splitlines()]
    assert [list(row) for row in rows] == [list(NAMES)] * 2
    assert rows[1]["time_s"] is None
    assert rows[0]["top"] == 1e-17


def test_parquet(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    write_table(tmp_path / "out.parquet", PLAN, ROWS)
    table = parquet.read_table(tmp_path / "out.parquet")
    assert tuple(table.column_names) == NAMES
    assert table.to_pylist()[1] == dict(
        zip(NAMES, (1, 18, 1.0, "[1, 2]", 1.0, "hung", None, None, None, "time_s < 3, really", ""), strict=True)
    )
    write_table(tmp_path / "none.parquet", PLAN, [])
    assert parquet.read_table(tmp_path / "none.parquet").num_rows == 0


def test_a_table_is_there_when_it_is_complete_and_not_before(tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    out.write_text("before\n")

    def rows() -> object:
        yield ROWS[0]
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_table(out, PLAN, rows())  # type: ignore[arg-type]
    assert [path.name for path in tmp_path.iterdir()] == ["out.csv"]
    assert out.read_text() == "before\n"


def test_formats(monkeypatch: pytest.MonkeyPatch) -> None:
    assert [format_of(Path(name)) for name in ("a.csv", "b.JSONL")] == ["csv", "jsonl"]
    with pytest.raises(UsageError, match=r"must end in \.csv, \.jsonl, \.parquet"):
        format_of(Path("out.xlsx"))
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(UsageError, match=r"pip install 'elitescript\[parquet\]'"):
        format_of(Path("out.parquet"))
