"""A table belongs to the settings of its sweep: what `--resume` says of a finished one, and what it does."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from elitescript.errors import UsageError
from elitescript.records import replace
from elitescript.sweep.plans.plan import Choices, Plan, Row, Variation
from elitescript.sweep.results import table_files
from elitescript.sweep.results.journal import Journal, line_of
from elitescript.sweep.results.table_files import Finished, TableFiles, is_of_sweep
from elitescript.sweep.results.tables import write_table

PLAN = Plan("def p():\nend\n", variations=(Variation("r", "uniform", (0, 1)),), options={"model": "CS66"}, seed=13)


def row(run: int) -> Row:
    return Row(Choices(run, run * 7, {"r": run / 8}), "finished", 2.5, {}, "d1")


def finished(folder: Path, name: str = "out.csv", runs: int = 6) -> TableFiles:
    """Write the table of a sweep that has come to its end."""
    files = TableFiles(folder / name)
    with files.journal(PLAN, resumes=False) as journal:
        for first in range(0, runs, 2):
            journal.add([row(first), row(first + 1)])
        write_table(files.table, PLAN, journal.rows(runs))
        files.finish(journal, 1)
        journal.delete()
    return files


@pytest.mark.parametrize("name", ["out.csv", "out.jsonl", "out.parquet"])
def test_a_finished_table_is_known(name: str, tmp_path: Path) -> None:
    if name.endswith("parquet"):
        pytest.importorskip("pyarrow")
    files = finished(tmp_path, name)
    assert not files.part.exists()
    found = files.finished(PLAN)
    assert found is not None
    assert (found.runs, found.failed) == (6, 1)
    # The settings and the rows are the same bytes each time.
    kept = files.kept.read_bytes()
    assert finished(tmp_path, name).kept.read_bytes() == kept


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"seed": 11}, "--seed 11 now, --seed 13 then; give"),
        ({"seed": 11, "until_s": 5.0}, "--seed 11 now, --seed 13 then; --until 5.0 now, not given then"),
        ({"program": "def p():\n  sleep(1)\nend\n"}, "the program has changed"),
        ({"program_name": "q.script"}, "the name of the program is q.script now, and was program.script"),
        ({"world": "a = 1\n", "world_name": "w.toml"}, "--world w.toml now, not given then; the world file is new"),
        ({"variations": (Variation("r", "uniform", (0, 2)),)}, "--vary r=uniform(0, 2) now, --vary r=uniform(0, 1) th"),
        (
            {"variations": (Variation("r", "uniform", (0, 1.0)),)},
            "--vary r=uniform(0, 1.0) now, --vary r=uniform(0, 1)",
        ),
        ({"variations": ()}, "no --vary now, --vary r=uniform(0, 1) then"),
        ({"options": {"model": "CS63"}}, "--robot CS63 now, --robot CS66 then"),
        ({"options": {"model": "CS66", "speed": 0.5}}, "--speed 0.5 now, not given then"),
        ({"options": {"model": "CS66", "strict": True}}, "--strict now, not given then"),
        ({"options": {"model": "CS66", "rpc_timeout_s": 0.0}}, "--rpc-timeout 0.0 now, not given then"),
        ({"options": {"model": "CS66", "joints": [0, 0.5]}}, "--joints 0,0.5 now, not given then"),
        ({"options": {"model": "CS66", "confirms_popups": False}}, "confirms_popups=False now, not given then"),
        ({"options": {}}, "no --robot now, --robot CS66 then"),
        ({"options": {"model": "CS66", "model_text": "base = 1"}}, "the arm file is new"),
        ({"ensure": ("time_s < 3", "x")}, "--ensure time_s < 3 --ensure x now, not given then"),
        ({"measures": {"m": "time_s"}}, "--measure m=time_s now, not given then"),
        ({"settings": ("a=1",)}, "--set a=1 now, not given then"),
        ({"chaos": "channels"}, "--chaos channels now, not given then"),
        ({"chaos": "[channels]\nrate = 2\n"}, "the chaos profile is new"),
        ({"step_s": 0.04}, "--step 0.04 now, not given then"),
        ({"has_margins": True}, "--margins now, not given then"),
        ({"files": {"a.txt": "YQ=="}}, "a.txt of the task folder is new"),
        ({"python": {"checks.py": "1"}}, "checks.py is new"),
        ({"version": "9"}, "the version of elitescript is 9 now, and was"),
    ],
)
def test_other_settings_are_refused_and_nothing_is_written(
    changes: dict[str, object], words: str, tmp_path: Path
) -> None:
    files = finished(tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    with pytest.raises(UsageError) as caught:
        files.finished(replace(PLAN, **changes))
    assert "out.csv was made with other settings: " in str(caught.value)
    assert words in str(caught.value)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_many_differences_are_counted(tmp_path: Path) -> None:
    files = finished(tmp_path)
    other = replace(PLAN, files={f"{name}.txt": "" for name in "abcdefg"})
    with pytest.raises(UsageError, match=r"a\.txt of the task folder .*; and 2 more; give --out another name"):
        files.finished(other)


def test_a_table_without_settings_is_told_as_such(tmp_path: Path) -> None:
    files = finished(tmp_path)
    files.forget()
    with pytest.raises(UsageError, match=r"out\.csv is there, but no out\.csv\.sweep beside it"):
        files.finished(PLAN)
    files.table.unlink()
    assert files.finished(PLAN) is None


def test_a_table_that_has_been_changed_is_not_replaced(tmp_path: Path) -> None:
    files = finished(tmp_path)
    files.table.write_text(files.table.read_text() + "6,42,0.75,finished,2.5,,d1\n")
    with pytest.raises(UsageError, match="has been changed since its sweep has written it"):
        files.finished(PLAN)


def test_a_table_that_was_deleted_is_written_again_from_its_rows(tmp_path: Path) -> None:
    files = finished(tmp_path)
    table = files.table.read_bytes()
    files.table.unlink()
    assert files.finished(PLAN) is not None
    with files.journal(PLAN, resumes=True) as journal:
        assert journal.missing(8) == [range(6, 8)]
        write_table(files.table, PLAN, journal.rows(6))
    assert files.table.read_bytes() == table


def test_a_journal_goes_before_the_table(tmp_path: Path) -> None:
    files = finished(tmp_path)
    other = replace(PLAN, seed=14)
    with files.journal(other, resumes=False) as journal:
        journal.add([row(0)])
    assert files.finished(other) is None
    with files.journal(other, resumes=True) as journal:
        assert journal.missing(3) == [range(1, 3)]
    # One whose first line was torn says nothing.
    files.part.write_bytes(files.part.read_bytes()[:20])
    with pytest.raises(UsageError, match="--seed 14 now, --seed 13 then"):
        files.finished(other)
    assert files.finished(PLAN) is not None


def test_without_resume_all_is_begun_anew(tmp_path: Path) -> None:
    files = finished(tmp_path)
    with files.journal(replace(PLAN, seed=1), resumes=False) as journal:
        assert journal.missing(2) == [range(2)]


@pytest.mark.parametrize("share", [0.0, 0.02, 0.5, 0.9, 0.999])
def test_a_damaged_file_of_settings_is_said(share: float, tmp_path: Path) -> None:
    files = finished(tmp_path)
    whole = files.kept.read_bytes()
    files.kept.write_bytes(whole[: int(share * len(whole))])
    try:
        found = files.finished(PLAN)
    except UsageError as error:
        assert "it is damaged, so nothing says which settings out.csv belongs to" in str(error)
    else:
        # The settings are whole, some rows are not: they are run again.
        assert found is not None
        with files.journal(PLAN, resumes=True) as journal:
            assert [numbers.stop for numbers in journal.missing(6)] == [6]


def test_every_bit_of_the_settings_that_has_changed_is_said_or_changes_nothing(tmp_path: Path) -> None:
    files = finished(tmp_path)
    whole = files.kept.read_bytes()
    for at in range(0, len(whole), 7):
        files.kept.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :])
        try:
            found = files.finished(PLAN)
            assert found is None or isinstance(found, Finished)
            with files.journal(PLAN, resumes=True) as journal:
                assert list(journal.rows(6)) == [row(run) for run in range(journal.done)]
                journal.delete()
        except UsageError:
            files.part.unlink(missing_ok=True)


def test_lines_that_no_sweep_has_written_are_refused_by_their_number(tmp_path: Path) -> None:
    path = tmp_path / "out.csv.part"
    with Journal(path, PLAN, resumes=False) as journal:
        journal.add([row(0), row(1)])
    head, rows = path.read_bytes().splitlines(keepends=True)
    # The header twice, as two sweeps on a file system without locks leave it.
    path.write_bytes(head + head + rows + head)
    with Journal(path, PLAN, resumes=True) as journal:
        assert list(journal.rows(4)) == [row(0), row(1)]
    other = line_of({"first": 1, "rows": []})
    for text in (rows, other, line_of(3), line_of({"first": -1, "rows": []}), line_of({"first": "0", "rows": [[]]})):
        path.write_bytes(head + rows + text)
        with pytest.raises(UsageError, match=r"out\.csv\.part: line 3 holds no rows that are new; delete the file"):
            Journal(path, PLAN, resumes=True)
    with Journal(tmp_path / "two.part", PLAN, resumes=False) as journal:
        journal.add([row(1), row(2)])
    path.write_bytes(head + rows + (tmp_path / "two.part").read_bytes().splitlines(keepends=True)[1])
    with pytest.raises(UsageError, match="run 1 is in it twice"):
        Journal(path, PLAN, resumes=True)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
def test_what_is_no_file_is_refused_before_it_is_opened(tmp_path: Path) -> None:
    files = TableFiles(tmp_path / "out.csv")
    for path in files:
        os.mkfifo(path)
        with pytest.raises(UsageError, match=f"{path.name} is a named pipe, not a file"):
            files.check()
        path.unlink()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full")
def test_a_full_disk_leaves_the_journal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    files = TableFiles(tmp_path / "out.csv")
    with files.journal(PLAN, resumes=False) as journal:
        journal.add([row(0)])
        write_table(files.table, PLAN, journal.rows(1))
        monkeypatch.setattr(table_files, "gzip", _FullDisk())
        with pytest.raises(UsageError, match=r"out\.csv is complete; .*out\.csv\.sweep: No space left on device"):
            files.finish(journal, 0)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.csv", "out.csv.part"]


class _FullDisk:
    """Compresses into a disk that is full."""

    def GzipFile(self, *_: object) -> object:
        return Path("/dev/full").open("wb", buffering=0)


def test_what_is_beside_a_table_is_not_given_to_programs() -> None:
    assert all(is_of_sweep(name) for name in ("a.csv.part", "a.jsonl.sweep", "b.parquet.sweep"))
    assert not any(is_of_sweep(name) for name in ("a.csv", "a.part", "a.sweep", "parts.txt"))
