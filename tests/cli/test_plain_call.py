"""Calls that are read without argparse give what argparse gives."""

from __future__ import annotations

import random

import pytest

from elitescript.cli import main
from elitescript.cli.arguments import COMMANDS
from elitescript.cli.plain_call import PlainCall

SEEDS = 300
VALUES = (
    "a.script",
    "b",
    "5",
    "1.5",
    "x=1",
    "CS66",
    "2.14",
    "auto",
    "json",
    "rtsi",
    "-",
    "-1",
    "--",
    "--until",
    "-x",
    "",
    "a b",
)
OTHERS = ("--help", "-h", "--unti", "--json=1", "--nothing", "-oX", "--robot=", "--set=a=b", "--until=3")


def plainly(words: list[str]) -> dict[str, object] | None:
    call = PlainCall()
    COMMANDS[words[0]][1](call)
    found = call.read(words[1:])
    return None if found is None else {**vars(found), "command": words[0]}


def by_argparse(words: list[str]) -> dict[str, object] | None:
    """Return the options that argparse reads; None if it ends the process."""
    parser, _ = main._parser(words[0])
    try:
        return vars(parser.parse_args(words))
    except SystemExit:
        return None


def flags_of(name: str) -> list[str]:
    _, subparsers = main._parser(name)
    return [flag for action in subparsers.choices[name]._actions for flag in action.option_strings]


@pytest.mark.parametrize("name", COMMANDS)
def test_random_calls_are_left_to_argparse_or_read_as_it_does(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    flags, plain, both = flags_of(name), 0, 0
    for seed in range(SEEDS):
        random_ = random.Random(f"{name} {seed}")
        words = [name]
        for _ in range(random_.randrange(7)):
            kind = random_.random()
            words.append(random_.choice(VALUES if kind < 0.55 else flags if kind < 0.92 else OTHERS))
        found = plainly(words)
        if found is not None:
            plain += 1
            assert found == by_argparse(words), words
        both += by_argparse(words) is not None
    # Few calls that argparse accepts are left to it.
    assert plain > 0.5 * both > 10


@pytest.mark.parametrize(
    "words",
    [
        "run p.script",
        "run p.script --until 5 --json",
        "run --robot CS612 p.script --set a=1 --set b=2 --world=w.toml",
        "check a.script b.script --strict --format github",
        "check --explain E303",
        "plot p.script -o out.html",
        "serve --robot CS66 --robot CS63 --port all=0",
        "ctl --json set standard_digital_in[3] 1",
        "commands",
        "commands movej --json",
    ],
)
def test_ordinary_calls_need_no_argparse(words: str) -> None:
    assert plainly(words.split()) == by_argparse(words.split()) is not None


@pytest.mark.parametrize(
    "words",
    [
        "run a b",
        "run p.script --until",
        "run p.script --until x",
        "run p.script --until -1",
        "run p.script --unti 5",
        "run p.script --color red",
        "run p.script --json=1",
        "run --help",
        "run p.script --nothing",
        "run -- p.script",
        "check a --strict b",
        "plot p.script -oout.html",
        "plot p.script -o=out.html",
    ],
)
def test_other_calls_are_left_to_argparse(words: str) -> None:
    assert plainly(words.split()) is None
