"""Cases are read and written as TOML that people can edit; what makes no sense is refused with its line."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from elitescript.errors import UsageError
from elitescript.sweep.failures.cases import (
    Case,
    case_of,
    digest_of,
    is_case,
    read_case,
    text_of,
    toml_value,
    write_case,
)
from elitescript.sweep.plans.plan import Choices, Disturbance, Failure

CASE = Case(
    "../cell.script",
    Failure("never_stuck", "time_limit", "", 12, text='waits for "ok"\nfor ever'),
    "0123456789abcdef",
    17,
    9241874192837412,
    {"box.0.x": 0.41, "standard_digital_in[3]": True, "mode": "fast", "parts": 3},
    (
        Disturbance("drop", 5000, 3.0, None, {"count": 1, "direction": "to_robot"}),
        Disturbance("safeguard_stop", "", 4.0, 1.5),
        Disturbance("no_part", "standard_digital_in[3]", 5.0, 2.0),
        Disturbance("slider", "", 6.0, 2.0, {"fraction": 0.2}),
    ),
    "cell.toml",
    "",
    {"model": "CS66", "speed": 0.5, "joints": [0.0, -1.5, 1.5, -1.5, -1.5, 0.0]},
    ("standard_digital_in[1]=true",),
    60.0,
    0.04,
    {"box.0.x": 0.4, "standard_digital_in[3]": False, "mode": "slow", "parts": 3},
    7,
)


def test_what_is_written_is_read_again() -> None:
    text = text_of(CASE, ["the program waited for ever", "", "  in line 12"])
    assert case_of(text, "CASE.toml") == CASE
    assert text.startswith("# the program waited for ever\n#\n#   in line 12\n")


def test_a_case_has_the_sections_of_a_world_file_for_its_faults() -> None:
    tables = tomllib.loads(text_of(CASE))
    assert tables["fault"] == [{"kind": "drop", "on": 5000, "at_s": 3.0, "count": 1, "direction": "to_robot"}]
    assert [row["kind"] for row in tables["stop"]] == ["safeguard_stop", "slider"]
    assert [row["kind"] for row in tables["person"]] == ["no_part"]
    assert tables["set"]["box.0.x"] == 0.41
    assert (tables["expect"]["property"], tables["expect"]["line"]) == ("never_stuck", 12)


def test_choices_are_those_of_the_run() -> None:
    assert CASE.choices == Choices(17, 9241874192837412, CASE.values, CASE.disturbances)


def test_disturbances_come_in_the_order_of_time() -> None:
    text = 'program = "p"\n[[stop]]\nkind = "pause"\nat_s = 5.0\nfor_s = 1\n'
    text += '[[fault]]\nkind = "drop"\non = 5000\nat_s = 1\n'
    text += "[[stop]]\nkind = 'pause'\nfor_s = 0.5\n[expect]\nproperty = 'never_stuck'\n"
    assert [(item.kind, item.at_s) for item in case_of(text, "c").disturbances] == [
        ("pause", 0.0),
        ("drop", 1),
        ("pause", 5.0),
    ]


def test_the_digest_does_not_depend_on_line_ends() -> None:
    assert digest_of("a\nb\n") == digest_of("a\r\nb\r\n")
    assert digest_of("a\nb\n") != digest_of("a\nc\n")
    assert len(digest_of("")) == 16


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("CASE.toml", True),
        ("CASE-2.case.toml", True),
        ("cell.1.case.toml", True),
        ("cell.toml", False),
        ("case.toml", False),
    ],
)
def test_cases_have_names(name: str, expected: bool) -> None:
    assert is_case(name) is expected


@pytest.mark.parametrize("value", [True, 3, 0.1, 1e-9, 1e300, 'a "b" \\ \n\t\x07 ü 🙂', [1, "x"], [0.5, True]])
def test_values_are_read_back_by_toml(value: object) -> None:
    assert tomllib.loads(f"x = {toml_value(value)}")["x"] == value


HEAD = 'program = "p.script"\n'
END = '[expect]\nproperty = "no_alarm"\n'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("program = \n", r"1: the [a-z]* is not TOML"),
        (HEAD, r"1: expect: is missing"),
        (END, r"1: program: is missing"),
        (HEAD + "sed = 3\n" + END, r"2: sed: is not known; .*'seed'\?"),
        (HEAD + "seed = 1.5\n" + END, r"2: seed: must be a whole number"),
        (HEAD + "until_s = -1\n" + END, r"2: until_s: must be a number in \[0, 1e\+09\], got -1"),
        (HEAD + "settings = ['a']\n" + END, r"2: settings: a: write NAME=VALUE"),
        (HEAD + "[options]\nmodell = 'CS66'\n" + END, r"3: options.modell: is not known; .*'model'\?"),
        (HEAD + "[set]\nx = [1]\n" + END, r"3: set.x: must be a number, true, false or a text"),
        (HEAD + "fault = 3\n" + END, r"2: fault: must be a list of tables"),
        (HEAD + "[[fault]]\non = 5000\n" + END, r"2: fault\[0\].kind: is missing"),
        (HEAD + "[[fault]]\nkind = 'dropp'\n" + END, r"3: fault\[0\].kind: 'dropp' is not known; .*'drop'\?"),
        (HEAD + "[[fault]]\nkind = 'pause'\n" + END, r"3: fault\[0\].kind: pause belongs into \[\[stop\]\]"),
        (HEAD + "[[fault]]\nkind = 'drop'\n" + END, r"2: fault\[0\]: on: is missing"),
        (
            HEAD + "[[fault]]\nkind = 'drop'\non = 5000\ncount = 0\n" + END,
            r"5: fault\[0\].count: must be a whole number",
        ),
        (HEAD + "[[stop]]\nkind = 'slider'\nfraction = 3\n" + END, r"4: stop\[0\].fraction: must be in \[0, 1\]"),
        (HEAD + "[expect]\nproprety = 'x'\n", r"3: expect.proprety: is not known; .*'property'\?"),
        (HEAD + "[expect]\nproperty = 3\n", r"3: expect.property: must be a text, got 3"),
    ],
)
def test_what_makes_no_sense_is_refused_with_its_line(text: str, message: str) -> None:
    with pytest.raises(UsageError, match=f"^c.toml:{message}"):
        case_of(text, "c.toml")


def test_a_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"^cannot read .*none\.toml: No such file"):
        read_case(tmp_path / "none.toml")
    (tmp_path / "latin.toml").write_bytes(b"program = 'x'\n# \xff\n")
    with pytest.raises(UsageError, match=r"latin\.toml:2: the case is not UTF-8"):
        read_case(tmp_path / "latin.toml")


def test_a_case_is_a_file(tmp_path: Path) -> None:
    write_case(tmp_path / "a.case.toml", CASE, ["story"])
    assert read_case(tmp_path / "a.case.toml") == CASE
    with pytest.raises(UsageError, match="none"):
        write_case(tmp_path / "none" / "a.case.toml", CASE)
