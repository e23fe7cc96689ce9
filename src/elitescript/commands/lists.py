"""Lengths of lists, and lists of bits (manual 2.10 sections 2.2.4 to 2.2.7)."""

from __future__ import annotations

from typing import Annotated, Any, Final

from elitescript.commands.definition.quantities import Anything, Boolean, Count, Either, Integer, Text, Vector, Whole
from elitescript.commands.definition.registry import alias, command

_BITS: Final = 32

_AnyList = Vector(Anything(), None)


@command(family="math", manual="2.2.4")
def binary_list_to_integer(l: Annotated[tuple[bool, ...], Vector(Boolean(), None)]) -> Whole:  # noqa: E741
    """Return the whole number whose bits are given.

    Of more than 32 bits only the first 32 count; from 32 bits on the last one is the sign (for exactly 32 *assumed*).

    Args:
        l: bits, the least significant first.

    Returns:
        The number; 0 for an empty list.
    """
    number = sum(1 << index for index, bit in enumerate(l[:_BITS]) if bit)
    return number - (1 << _BITS) if number >> (_BITS - 1) else number


@command(family="math", manual="2.2.5")
def integer_to_binary_list(
    x: Annotated[int, Integer(-(2**31), 2**32 - 1)],
) -> Annotated[tuple[bool, ...], Vector(Boolean(), 32)]:
    """Return the 32 bits of a whole number.

    Args:
        x: the number: signed 32 bits, or unsigned 32 bits (*assumed*: the manual gives no range).

    Returns:
        The bits, the least significant first; of a negative number those of its two's complement.
    """
    return tuple(bool(x >> index & 1) for index in range(_BITS))


# The vendor renamed both commands twice; its support pages give 2.12.1 and 2.13.1.
alias("byte_list_to_integer", of="binary_list_to_integer", since="2.12")
alias("bit_list_to_integer", of="binary_list_to_integer", since="2.13")
alias("integer_to_byte_list", of="integer_to_binary_list", since="2.12")
alias("integer_to_bit_list", of="integer_to_binary_list", since="2.13")


@command(family="math", manual="2.2.6")
def get_list_length(v: Annotated[tuple[Any, ...], _AnyList]) -> Count:
    """Return the number of elements of a list.

    Args:
        v: the list.

    Returns:
        The number.
    """
    return len(v)


@command(family="math", manual="2.2.7")
def length(v: Annotated[Any, Either(Text(), _AnyList)]) -> Count:
    """Return the number of elements of a list or of characters of a text.

    Args:
        v: the list or text.

    Returns:
        The number.
    """
    return len(v)
