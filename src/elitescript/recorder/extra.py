"""Asks for the library that reads and writes MCAP."""

from __future__ import annotations

from elitescript.errors import UsageError


def check_mcap() -> None:
    """Import the library.

    Raises:
        UsageError: it, or one that it needs, is not installed; says how to install it.
    """
    try:
        import mcap.stream_reader
        import mcap.writer  # noqa: F401
    except ModuleNotFoundError as error:
        raise UsageError(
            f"the package {error.name!r} is missing; install it with: pip install 'elitescript[mcap]'"
        ) from error
