"""Lets script threads wait for the ends of their moves."""

from __future__ import annotations

from elitescript.commands.definition.context import Machine
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import Strand


class MoveWaits:
    """The threads of one host that wait for moves: each for its own, or for one that it brakes.

    Args:
        machine: the controller.
        scheduler: runs the threads.
    """

    __slots__ = ("_abortable", "_machine", "_scheduler", "_waiting")

    def __init__(self, machine: Machine, scheduler: Scheduler) -> None:
        self._machine = machine
        self._scheduler = scheduler
        self._waiting: dict[int, list[Strand]] = {}
        self._abortable: set[int] = set()

    @property
    def is_empty(self) -> bool:
        """Whether no thread waits for a move."""
        return not self._waiting

    def wait(self, move: int, strand: Strand, reason: str, *, is_abortable: bool) -> None:
        """Let a thread wait until a move is over; the move is braked when the thread is stopped.

        Args:
            move: number of the move.
            strand: the thread, which runs.
            reason: what it waits for.
            is_abortable: whether `abort` ends the move.
        """
        machine, waiting = self._machine, self._waiting
        strand.cancel = lambda: machine.cancel_move(move)
        waiting.setdefault(move, []).append(strand)
        if is_abortable:
            self._abortable.add(move)
        try:
            while not machine.is_move_done(move):
                self._scheduler.wait(reason)
        finally:
            waiting[move].remove(strand)
            if not waiting[move]:
                del waiting[move]
                self._abortable.discard(move)
            strand.cancel = None

    def ended(self, move: int) -> None:
        """Wake the threads that wait for a move: it is over."""
        for strand in self._waiting.get(move, ()):
            self._scheduler.wake(strand)

    def abort(self) -> None:
        """End the moves that can be aborted, in the order of their numbers."""
        for move in sorted(self._abortable):
            self._machine.cancel_move(move)
