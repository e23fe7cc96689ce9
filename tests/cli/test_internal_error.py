"""A defect of this program is told in one sentence, with exit code 2: 1 is what came of a command."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from elitescript import __version__
from elitescript.cli import main as command_line
from elitescript.cli.internal_error import sentence


def raised(error: BaseException) -> BaseException:
    try:
        raise error
    except BaseException as caught:
        return caught


def test_it_has_class_text_and_places_in_one_line() -> None:
    said = sentence(raised(ValueError("a limit\nof two lines")))
    assert said.startswith("internal error, please report it: ValueError: a limit\\nof two lines (")
    assert f"{Path(__file__).name}:" in said
    assert said.endswith(f"; elitescript {__version__}, Python {'.'.join(map(str, sys.version_info[:3]))})")


def test_places_are_innermost_first_and_few() -> None:
    def deeper(depth: int) -> None:
        if depth:
            deeper(depth - 1)
        else:
            raise KeyError("x")

    with pytest.raises(KeyError) as caught:
        deeper(50)
    assert sentence(caught.value).count(" from ") == 11


@pytest.mark.parametrize("error", [MemoryError(), ImportError("x.so: failed to map segment from shared object")])
def test_memory_is_no_defect(error: Exception) -> None:
    assert sentence(raised(error)) == (
        "there is not enough memory: raise the limit of the shell (`ulimit -v`) or of the computer"
    )


def test_nor_is_a_thread_that_the_system_does_not_give() -> None:
    assert sentence(raised(RuntimeError("can't start new thread"))).startswith("no thread can be started: raise the")


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (RuntimeError("oops"), "elitescript commands: internal error, please report it: RuntimeError: oops ("),
        (MemoryError(), "elitescript commands: there is not enough memory: "),
        (OSError(28, "No space left on device", "x.csv"), "elitescript commands: x.csv: No space left on device"),
    ],
)
def test_a_process_ends_with_the_sentence(
    error: Exception, said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fails(*_: object, **__: object) -> int:
        raise error

    monkeypatch.setattr(command_line, "_dispatch", fails)
    assert command_line._run(["commands"], is_process=True) == 2
    err = capsys.readouterr().err
    assert err.startswith(said)
    assert err.count(os.linesep) == 1


def test_callers_from_python_get_the_exception(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object, **__: object) -> int:
        raise RuntimeError("oops")

    monkeypatch.setattr(command_line, "_dispatch", fails)
    with pytest.raises(RuntimeError, match="oops"):
        command_line.main(["commands"])
