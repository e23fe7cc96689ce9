"""Options of a robot on the command line: each flag, and what it gives."""

from __future__ import annotations

import pytest

from elitescript.cli.main import _parsed, _parser, main
from elitescript.cli.robot_options import add_options, options_from
from elitescript.errors import UsageError

BY_HAND = {
    "run": {
        *("--robot", "--firmware", "--strict", "--seed", "--joints", "--speed", "--epoch", "--rpc-timeout"),
        *("--network", "--controller-version", "--ignore"),
    },
    "plot": {"--robot", "--firmware", "--seed", "--joints", "--speed", "--network", "--ignore"},
    "check": {"--robot", "--firmware", "--strict", "--network", "--ignore"},
    "serve": {
        *("--robot", "--firmware", "--strict", "--seed", "--joints", "--speed", "--rpc-timeout"),
        *("--power-on", "--local", "--query-form", "--controller-version", "--ignore"),
    },
}


@pytest.mark.parametrize("command", BY_HAND)
def test_a_command_has_these_flags_and_no_others(command: str) -> None:
    parser = type(_parser(command)[0])(add_help=False)
    add_options(parser, command)
    assert {flag for action in parser._actions for flag in action.option_strings} == BY_HAND[command]


def test_nothing_is_given_unless_it_stands_there() -> None:
    assert options_from(_parsed(["run", "p.script"])) == {}


def test_every_flag_gives_an_option() -> None:
    words = "--robot CS63 --firmware 2.10 --strict --seed 3 --joints 0,1,2,3,4,5 --speed 0.5 --rpc-timeout 0.25"
    given = {
        "model": "CS63",
        "firmware": "2.10",
        "strict": True,
        "seed": 3,
        "joints": (0.0, 1.0, 2.0, 3.0, 4.0, 5.0),
        "speed": 0.5,
        "rpc_timeout_s": 0.25,
    }
    assert options_from(_parsed(["run", "p.script", *words.split(), "--epoch", "1970-01-01T00:01:00Z"])) == {
        **given,
        "epoch_s": 60.0,
    }
    served = options_from(_parsed(["serve", *words.split(), "--power-on", "--local"]))
    del given["model"]  # `serve` has a list of them
    assert served == {**given, "power_on": True, "remote": False}


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--speed", "1.5"], "--speed must be in [0, 1], got 1.5"),
        (["--rpc-timeout", "nan"], "--rpc-timeout must be finite, in s, got nan"),
        (["--joints", "1,2"], "--joints 1,2: write six numbers in rad, separated by commas"),
        (["--epoch", "soon"], "--epoch soon: write seconds since 1970, or a time such as 2024-01-01T00:00:00Z"),
    ],
)
def test_a_value_that_makes_no_sense_is_refused_by_the_name_of_its_flag(words: list[str], text: str) -> None:
    with pytest.raises(UsageError) as caught:
        options_from(_parsed(["run", "p.script", *words]))
    assert str(caught.value) == text


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["run"], "--firmware {2.10,2.14}"),
        (["run"], "--joints Q1,...,Q6    joint positions at the start, rad (default: the model's home)"),
        (["run"], "--epoch TIME          controller clock at the start: seconds since 1970 or ISO 8601"),
        (["run"], "how long a remote procedure call waits for its answer; 0 waits for ever (default 60)"),
        (["serve"], "--speed 0..1          speed slider as a fraction (default 1)"),
        (["serve"], "(default CS66); repeat it"),
        (["serve"], "--local               begin in local control: clients may only look"),
        (["plot"], "--robot MODEL         arm whose limits are drawn, or its file (default CS66)"),
        (["check"], "--strict              refuse what only warns otherwise"),
    ],
)
def test_help_says_what_an_option_means(
    words: list[str], text: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    with pytest.raises(SystemExit):
        main([*words, "--help"])
    assert text in capsys.readouterr().out


def test_options_of_a_program_do_not_go_with_a_trace(tmp_path, capsys) -> None:
    trace = tmp_path / "t.csv"
    trace.write_text("t\n")
    assert main(["plot", str(trace), "--speed", "0.5"]) == 2
    assert "--speed goes with a program" in capsys.readouterr().err
