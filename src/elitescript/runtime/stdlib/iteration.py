"""Endless iterators with a checkpoint in each step."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any, Final

from elitescript.runtime.stdlib.loader import real

_SHARED: Final = (
    "accumulate chain combinations combinations_with_replacement compress dropwhile filterfalse groupby islice"
    " pairwise permutations product starmap takewhile tee zip_longest"
)

_MISSING: Final = object()
Step = Callable[[], object]
"""Counts one unit of work; may let other threads run."""


def itertools_names(step: Step) -> dict[str, Any]:
    """Return the public names of `itertools` for one program."""
    host = real("itertools")

    def count(start: Any = 0, step_by: Any = 1, **options: Any) -> Iterator[Any]:
        """Return numbers from `start` on."""
        step_by = options.pop("step", step_by)
        if options:
            raise TypeError(f"count() got an unexpected keyword argument {next(iter(options))!r}")
        return _count(step, start, step_by)

    def cycle(values: Iterable[Any]) -> Iterator[Any]:
        """Return the values, over and over."""
        return _cycle(step, iter(values))

    def repeat(value: Any, times: Any = None) -> Iterator[Any]:
        """Return a value, over and over or some times."""
        return _repeat(step, value, times)

    names = {name: getattr(host, name) for name in (*_SHARED.split(), "batched") if hasattr(host, name)}
    return {**names, "count": count, "cycle": cycle, "repeat": repeat}


def iter_until(step: Step) -> Callable[..., Iterator[Any]]:
    """Return `iter`; its form with two arguments has a checkpoint in each step."""

    def checked_iter(source: Any, sentinel: Any = _MISSING) -> Iterator[Any]:
        if sentinel is _MISSING:
            return iter(source)
        if not callable(source):
            raise TypeError("iter(v, w): v must be callable")
        return _calls(step, source, sentinel)

    checked_iter.__name__ = checked_iter.__qualname__ = "iter"
    return checked_iter


def _calls(step: Step, function: Callable[[], Any], sentinel: Any) -> Iterator[Any]:
    while True:
        step()
        value = function()
        if value == sentinel:
            return
        yield value


def _count(step: Step, start: Any, step_by: Any) -> Iterator[Any]:
    while True:
        step()
        yield start
        start = start + step_by


def _cycle(step: Step, values: Iterator[Any]) -> Iterator[Any]:
    kept = []
    for value in values:
        step()
        yield value
        kept.append(value)
    while kept:
        for value in kept:
            step()
            yield value


def _repeat(step: Step, value: Any, times: int | None) -> Iterator[Any]:
    left = times
    while left is None or left > 0:
        step()
        yield value
        if left is not None:
            left -= 1
