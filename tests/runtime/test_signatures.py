"""Signatures of classes beside those of `inspect`."""

from __future__ import annotations

import inspect
from collections import deque
from typing import Any, Optional

import pytest

from elitescript.runtime.stdlib.signatures import signature_of


class Plain:
    def __init__(self, a, b=2, /, c: int = 3, *rest: float, d, e: Any = "x", **others: Any) -> None:
        pass


class Simple:
    def __init__(self, x, y=None, *, z: object = ("x",)) -> None:
        pass


Simple.__init__.__annotations__.update(x=list[int], y=Optional[int], z=deque, **{"return": None})  # noqa: UP045


class Positional:
    def __init__(self, a, /) -> int:
        pass


class Keywords:
    def __init__(self, *, a=(1,), **b):
        pass


class Nothing:
    pass


class Inherits(Plain):
    pass


@pytest.mark.parametrize("kind", [Plain, Simple, Positional, Keywords, Nothing, Inherits])
def test_a_signature_is_written_as_inspect_does(kind: type) -> None:
    assert signature_of(kind) == str(inspect.signature(kind))


def test_a_class_that_is_not_written_in_python_has_none() -> None:
    with pytest.raises(ValueError, match="no signature"):
        signature_of(type("Error", (dict,), {}))
