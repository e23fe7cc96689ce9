"""`typing` for scripts: annotations mean nothing while a program runs, so most names stand for nothing.

The real module evaluates annotations in text form, which would bypass the compiler.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from elitescript.runtime.sealed import Sealed, no_copy
from elitescript.runtime.stdlib.typing_records import record_names

_FORMS: Final = (
    "AbstractSet Annotated Any AnyStr Callable ClassVar Collection Concatenate Counter DefaultDict Deque Dict"
    " Final FrozenSet Generator Hashable IO Iterable Iterator List Literal LiteralString Mapping Match"
    " MutableMapping MutableSequence MutableSet Never NoReturn NotRequired Optional OrderedDict Pattern Required"
    " Self Sequence Set Sized Text Tuple Type TypeAlias Union"
)


class TypingForm(metaclass=Sealed):
    """A word of an annotation. It can be subscripted, joined with `|` and extended, and does nothing."""

    __slots__ = ("_name",)
    __module__ = "typing"
    __reduce_ex__ = no_copy

    def __init__(self, name: str) -> None:
        self._name = name

    def __getitem__(self, parameters: Any) -> TypingForm:
        return self

    def __or__(self, other: Any) -> TypingForm:
        return self

    __ror__ = __or__

    def __mro_entries__(self, bases: tuple[Any, ...]) -> tuple[type, ...]:
        return ()

    def __copy__(self) -> TypingForm:
        return self

    def __deepcopy__(self, memo: Any) -> TypingForm:
        return self

    def __repr__(self) -> str:
        return f"typing.{self._name}"


def typing_names(namedtuple: Callable[..., Any]) -> dict[str, Any]:
    """Return the public names of `typing` for one program.

    Args:
        namedtuple: `collections.namedtuple` of that program.
    """

    def identity(value: Any = None, *rest: Any, **options: Any) -> Any:
        """Return the value, as it is."""
        return value

    def cast(kind: Any, value: Any) -> Any:
        """Return the value, as it is."""
        return value

    def variable(name: str, *bounds: Any, **options: Any) -> TypingForm:
        """Return a name for a type that varies."""
        return TypingForm(str(name))

    def new_type(name: str, kind: Any) -> Any:
        """Return a function that returns its argument."""
        return identity

    return {
        **{name: TypingForm(name) for name in (*_FORMS.split(), "Generic", "Protocol")},
        **record_names(namedtuple),
        "NewType": new_type,
        "ParamSpec": variable,
        "TYPE_CHECKING": False,
        "TypeVar": variable,
        "cast": cast,
        "final": identity,
        "no_type_check": identity,
        "overload": identity,
        "runtime_checkable": identity,
    }
