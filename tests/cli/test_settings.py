import pytest

from elitescript.cli.settings import parse_epoch, parse_joints, parse_size
from elitescript.errors import UsageError


def test_joints_take_six_numbers_with_or_without_brackets():
    assert parse_joints("0,-1.57, 1,2,3,4") == parse_joints("[0,-1.57,1,2,3,4]") == (0.0, -1.57, 1.0, 2.0, 3.0, 4.0)


@pytest.mark.parametrize("text", ["", "1,2,3", "1,2,3,4,5,6,7", "a,b,c,d,e,f"])
def test_other_joints_are_refused(text):
    with pytest.raises(UsageError, match="six numbers"):
        parse_joints(text)


@pytest.mark.parametrize("text", ["1704067200", "2024-01-01T00:00:00Z", "2024-01-01", "2024-01-01T01:00:00+01:00"])
def test_an_epoch_is_seconds_or_a_date(text):
    assert parse_epoch(text) == 1_704_067_200.0


def test_another_epoch_is_refused():
    with pytest.raises(UsageError, match="2024-01-01"):
        parse_epoch("yesterday")


@pytest.mark.parametrize(
    ("text", "size"),
    [
        ("0", 0),
        ("5000", 5000),
        ("12B", 12),
        ("100MB", 100_000_000),
        ("1.5 GiB", 1_610_612_736),
        ("2kb", 2000),
        ("1KiB", 1024),
    ],
)
def test_a_size_has_a_unit_or_none(text, size):
    assert parse_size(text, "--task-dir-limit") == size


@pytest.mark.parametrize("text", ["", "MB", "-1", "inf", "nan", "10 TB", "1e400", "ten", "5iB", "5 M B"])
def test_another_size_is_refused(text):
    with pytest.raises(UsageError, match=r"--task-dir-limit .*: write a number of bytes such as 5000, 100MB or 2GiB"):
        parse_size(text, "--task-dir-limit")
