"""What takes the rows and messages of a session: a file, or what follows the arm live."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from elitescript.client.rtsi_messages import OutputLayout
from elitescript.errors import ElitescriptError
from elitescript.protocol.binary import Number


class StorageError(ElitescriptError):
    """What was recorded cannot be kept; the text says why, and what is there."""


class Sink(Protocol):
    """Takes what a session hears, in the order of arrival. Errors of `StorageError` end the session.

    Times of arrival are UTC, ns since 1970, by a clock that does not jump.
    """

    def begin_rows(self, layout: OutputLayout) -> None:
        """Say how the packages of the rows that follow are read; again after each connection."""

    def row(self, t: float, flat: tuple[Number, ...], arrived_ns: int) -> None:
        """Take a row.

        Args:
            t: time of the controller, s.
            flat: the numbers of its package, as `OutputLayout.flat` returns them.
            arrived_ns: when it came.
        """

    def message(self, channel: str, data: Mapping[str, Any], arrived_ns: int) -> None:
        """Take a record of one of the other channels of `recorder.channels`."""

    def tick(self, now_ns: int) -> None:
        """Called once a second, whatever comes."""
