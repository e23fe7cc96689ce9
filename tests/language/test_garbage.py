"""Reading, checking and compiling pause the garbage collector, and leave it as it was."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from threading import Event, Thread

import pytest

from elitescript.errors import ProgramError
from elitescript.language.compiler import compile_task
from elitescript.language.garbage import without_collection
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.profile import profile

LONG = SourceFile("long.script", "def job():\n" + "  a = [1, 2, 3]\n  textmsg(a)\n" * 500 + "end\n")
WRONG = SourceFile("wrong.script", "def job():\n  a = (1\nend\n")


@pytest.fixture(autouse=True)
def thresholds() -> Iterator[tuple[int, int, int]]:
    before, was_enabled = gc.get_threshold(), gc.isenabled()
    gc.enable()
    gc.set_threshold(50, 7, 8)
    yield (50, 7, 8)
    gc.set_threshold(*before)
    if not was_enabled:
        gc.disable()


def collections_of(step: Callable[[], object]) -> int:
    """How often the collector ran."""
    seen = []

    def note(phase: str, _: object) -> None:
        seen.append(phase)

    gc.collect()
    gc.callbacks.append(note)
    try:
        kept = step()
    finally:
        gc.callbacks.remove(note)
    del kept
    return seen.count("start")


def test_no_collection_begins_while_a_long_program_is_compiled_or_checked() -> None:
    for step in (lambda: compile_task(LONG), lambda: check_source(LONG, profile())):
        step()
        # When the pause ends, one may begin in each generation.
        assert collections_of(step) <= 3
    assert collections_of(lambda: [[] for _ in range(1000)]) > 3


@pytest.mark.parametrize("is_enabled", [True, False])
def test_the_thresholds_are_as_before_after_compiling_and_after_an_error(
    thresholds: tuple[int, int, int], is_enabled: bool
) -> None:
    if not is_enabled:
        gc.disable()
    compile_task(LONG)
    assert (gc.get_threshold(), gc.isenabled()) == (thresholds, is_enabled)
    with pytest.raises(ProgramError):
        compile_task(WRONG)
    assert check_source(WRONG, profile())
    assert (gc.get_threshold(), gc.isenabled()) == (thresholds, is_enabled)


def test_a_nested_call_goes_on_pausing(thresholds: tuple[int, int, int]) -> None:
    inner = without_collection(lambda: gc.get_threshold())

    @without_collection
    def outer() -> list[tuple[int, int, int]]:
        return [gc.get_threshold(), inner(), gc.get_threshold()]

    assert outer() == [(0, 7, 8)] * 3
    assert gc.get_threshold() == thresholds


@pytest.mark.parametrize("chosen", [(900, 7, 8), (0, 1, 1)])
def test_what_others_choose_meanwhile_stays(chosen: tuple[int, int, int]) -> None:
    @without_collection
    def changing() -> None:
        gc.disable()
        gc.set_threshold(*chosen)

    changing()
    assert (gc.get_threshold(), gc.isenabled()) == (chosen, False)


def test_a_user_without_collection_stays_without() -> None:
    gc.set_threshold(0, 3, 3)
    compile_task(LONG)
    assert gc.get_threshold() == (0, 3, 3)


@pytest.mark.parametrize("first_ends", ["first", "second"])
def test_calls_that_overlap_in_threads_leave_the_users_thresholds(
    thresholds: tuple[int, int, int], first_ends: str
) -> None:
    begun = {name: Event() for name in ("first", "second")}
    end = {name: Event() for name in begun}

    @without_collection
    def work(name: str) -> None:
        begun[name].set()
        end[name].wait(10)

    threads = {}
    for name in begun:
        threads[name] = Thread(target=work, args=(name,))
        threads[name].start()
        assert begun[name].wait(10)
    for name in sorted(threads, reverse=first_ends == "second"):
        end[name].set()
        threads[name].join()
    assert gc.get_threshold() == thresholds
