"""Pauses Python's garbage collector while a text is read, checked and compiled.

The tree of a program is an object for each few characters, and all of them live until the code is made. The collector
goes through everything that lives each time that has grown by a quarter, and frees nothing: half of the time of
compiling 100,000 lines.
"""

from __future__ import annotations

import gc
from functools import wraps

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import ParamSpec, TypeVar

    P = ParamSpec("P")
    R = TypeVar("R")


def without_collection(function: Callable[P, R]) -> Callable[P, R]:
    """Make a function during which no collection begins by itself.

    The process may be the user's own: the thresholds are put back however the function ends, unless somebody else has
    changed them; `gc.enable` and `gc.disable` are left alone. Calls may be nested, and may overlap in threads: then
    collection begins again when the first of them ends, and no call takes the threshold of another for the user's.
    """

    @wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        before = gc.get_threshold()
        if before[0] == 0:
            return function(*args, **kwargs)
        paused = (0, *before[1:])
        try:
            gc.set_threshold(*paused)
            return function(*args, **kwargs)
        finally:
            if gc.get_threshold() == paused:
                gc.set_threshold(*before)

    return call
