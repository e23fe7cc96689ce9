"""The journal: torn at any byte it gives back whole ranges, and it goes on with its own plan alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from elitescript.errors import InternalError, UsageError
from elitescript.records import replace
from elitescript.sweep.plans.plan import Choices, Disturbance, Failure, Plan, Row, Variation
from elitescript.sweep.results.journal import Journal, difference, plan_parts

PLAN = Plan("def p():\nend\n", variations=(Variation("r", "uniform", (0, 1)),), options={"model": "CS66"}, seed=13)


def row(run: int) -> Row:
    failure = Failure("never_stuck", "stuck", "R130", 4, "drop", "it waits", 1.5, -0.25) if run % 3 == 0 else None
    happened = (Disturbance("drop", 5000, 1.0, None, {"count": 1}),)
    choices = Choices(run, run * 7, {"r": run / 8, "m": "\u00e9\n"}, happened)
    return Row(choices, "finished", None if run == 4 else 2.5, {"m": None, "n": 1e-17}, "d1", failure, (None, 0.5))


def test_rows_come_back_in_their_order(tmp_path: Path) -> None:
    with Journal(tmp_path / "out.csv.part", PLAN, resumes=False) as journal:
        for first in (4, 0, 6):
            journal.add([row(first), row(first + 1)])
        assert journal.missing(10) == [range(2, 4), range(8, 10)]
        assert journal.missing(5) == [range(2, 4)]
        assert list(journal.rows(10)) == [row(run) for run in (0, 1, 4, 5, 6, 7)]
        assert list(journal.rows(5)) == [row(run) for run in (0, 1, 4)]
        assert list(journal.rows_from(4, 10)) == [row(run) for run in (4, 5, 6, 7)]
        assert list(journal.rows_from(4, 7)) == [row(run) for run in (4, 5, 6)]
        assert list(journal.rows_from(2, 10)) == []
    with Journal(journal.path, PLAN, resumes=True) as journal:
        assert journal.done == 6
        journal.add([row(2), row(3)])
        assert list(journal.rows_from(0, 10)) == [row(run) for run in range(8)]
    with Journal(journal.path, PLAN, resumes=False) as journal:
        assert journal.missing(3) == [range(3)]


def test_rows_that_do_not_follow_each_other_are_refused(tmp_path: Path) -> None:
    with Journal(tmp_path / "out.csv.part", PLAN, resumes=False) as journal:
        for runs in ((1, 0), (0, 2), (0, 0)):
            with pytest.raises(InternalError, match="are not those of runs that follow each other"):
                journal.add([row(run) for run in runs])
        assert journal.done == 0


def test_a_journal_belongs_to_one_sweep_at_a_time(tmp_path: Path) -> None:
    path = tmp_path / "out.csv.part"
    with Journal(path, PLAN, resumes=False) as journal:
        journal.add([row(0)])
        for resumes in (False, True):
            with pytest.raises(UsageError, match="another sweep writes it"):
                Journal(path, PLAN, resumes=resumes)
        journal.add([row(1)])
        assert list(journal.rows(2)) == [row(0), row(1)]
    with Journal(path, PLAN, resumes=True) as journal:
        assert journal.done == 2
        journal.delete()
    assert not path.exists()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full")
def test_a_disk_that_is_full_is_said(tmp_path: Path) -> None:
    with Journal(tmp_path / "out.csv.part", PLAN, resumes=False) as journal:
        journal.add([row(0)])
        journal._file.close()
        journal._file = Path("/dev/full").open("wb")  # noqa: SIM115
        with pytest.raises(UsageError, match=r"out\.csv\.part: No space left .*; --resume goes on with what is there"):
            journal.add([row(1)])
        assert list(journal.rows(2)) == [row(0)]


def test_a_torn_line_and_what_follows_it_are_dropped(tmp_path: Path) -> None:
    path = tmp_path / "out.csv.part"
    with Journal(path, PLAN, resumes=False) as journal:
        journal.add([row(0)])
        journal.add([row(1)])
    whole = path.read_bytes()
    ends = [at + 1 for at in range(len(whole)) if whole[at : at + 1] == b"\n"]
    for cut in [*range(ends[0], len(whole), 9), len(whole) - 1]:
        path.write_bytes(whole[:cut])
        with Journal(path, PLAN, resumes=True) as journal:
            assert journal.done == sum(end <= cut for end in ends) - 1
            journal.add([row(5)])
            assert list(journal.rows(9))[-1] == row(5)
    # One bit on the disk has changed.
    broken = bytearray(whole)
    broken[ends[0] + 20] ^= 1
    path.write_bytes(broken)
    with Journal(path, PLAN, resumes=True) as journal:
        assert journal.done == 0


def test_a_journal_without_its_first_line_begins_anew(tmp_path: Path) -> None:
    path = tmp_path / "out.csv.part"
    with Journal(path, PLAN, resumes=False):
        pass
    path.write_bytes(path.read_bytes()[:-10])
    with Journal(path, PLAN, resumes=True) as journal:
        assert journal.missing(2) == [range(2)]
    path.write_text("run,seed\n1,2\n")
    with pytest.raises(UsageError, match="is no journal of a sweep"):
        Journal(path, PLAN, resumes=True)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"seed": 11}, "--seed 11 now, --seed 13 then"),
        ({"program": "def p():\n  sleep(1)\nend\n"}, "the program has changed"),
        ({"variations": ()}, "no --vary now, --vary r=uniform(0, 1) then"),
        ({"options": {"model": "CS66", "speed": 0.5}}, "--speed 0.5 now, not given then"),
        ({"version": "9"}, f"the version of elitescript is 9 now, and was {PLAN.version}"),
        ({"files": {"a.txt": "YQ=="}}, "a.txt of the task folder is new"),
    ],
)
def test_another_plan_is_refused_by_its_first_difference(
    changes: dict[str, object], words: str, tmp_path: Path
) -> None:
    other = replace(PLAN, **changes)
    assert difference(plan_parts(PLAN), plan_parts(other)).startswith(words)
    with Journal(tmp_path / "out.part", PLAN, resumes=False):
        pass
    with pytest.raises(UsageError) as caught:
        Journal(tmp_path / "out.part", other, resumes=True)
    assert words in str(caught.value)
