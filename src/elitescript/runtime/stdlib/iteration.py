"""Endless iterators: those of Python, with a checkpoint in front of each step.

A step itself is that of Python and has no checkpoint in its middle, so that threads can share an iterator.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from operator import itemgetter
from types import ModuleType
from typing import Any, Final

from elitescript.runtime.stdlib.loader import real
from elitescript.sealed import Sealed, hidden_slot, no_copy

_SHARED: Final = (
    "accumulate chain combinations combinations_with_replacement compress dropwhile filterfalse groupby islice"
    " pairwise permutations product starmap takewhile tee zip_longest"
)

Steps = Iterator[object]
"""Gives True without end. Each time it counts one unit of work, and may let other threads run."""
Copies = Callable[[], ModuleType]
"""Returns the module `copy` of the program."""


def itertools_names(steps: Steps, copies: Copies) -> dict[str, Any]:
    """Return the public names of `itertools` for one program."""
    host = real("itertools")
    names = {name: getattr(host, name) for name in (*_SHARED.split(), "batched") if hasattr(host, name)}
    endless = {name: _stepping(getattr(host, name), "itertools", name, steps, copies) for name in _ENDLESS}
    return {**names, **endless}


_ENDLESS: Final = ("count", "cycle", "repeat")


def iter_until(steps: Steps, copies: Copies) -> Callable[..., Any]:
    """Return `iter`; its form with two arguments has a checkpoint in each step."""
    calls = _stepping(iter, "builtins", "callable_iterator", steps, copies)

    def checked_iter(*args: Any) -> Any:
        return calls(*args) if len(args) == 2 else iter(*args)

    checked_iter.__name__ = checked_iter.__qualname__ = "iter"
    return checked_iter


_SECOND: Final = itemgetter(1)


def _stepping(make: Callable[..., Any], module: str, name: str, steps: Steps, copies: Copies) -> Any:
    """Return the class of the iterators that `make` makes, with a checkpoint in front of each step."""

    # `zip` takes one element of each of its iterators in turn, in C: first a checkpoint, then a step of the inner one.
    class Stepping(map, metaclass=Sealed):  # type: ignore[type-arg]
        __slots__ = ("_inner",)
        __module__ = module
        __qualname__ = name
        __reduce_ex__ = no_copy

        def __new__(cls, *args: Any, **options: Any) -> Any:
            return with_inner(cls, make(*args, **options))

        if make is not iter:

            def __repr__(self) -> str:
                return repr(inner_of(self))

        if hasattr(make, "__length_hint__"):

            def __length_hint__(self) -> int:
                hint: int = inner_of(self).__length_hint__()
                return hint

        def __copy__(self) -> Any:
            return with_inner(type(self), copies().copy(inner_of(self)))

        def __deepcopy__(self, memo: Any) -> Any:
            return with_inner(type(self), copies().deepcopy(inner_of(self), memo))

    def with_inner(kind: Any, inner: Any) -> Any:
        made = map.__new__(kind, _SECOND, zip(steps, inner, strict=False))
        set_inner(made, inner)
        return made

    type.__setattr__(Stepping, "__name__", name)
    slot = hidden_slot(Stepping, "_inner")
    inner_of, set_inner = slot.__get__, slot.__set__
    return Stepping
