"""Locks of script threads: the primitive and the re-entrant one.

Semantics are those of `_thread` in CPython, with three additions. A released lock is handed to the thread that
has waited longest. A thread that gets the lock in the tick of its timeout has got it. A stopped thread never waits: it
only pretends to take and release a lock that another thread holds, so that `with condition:` unwinds without disturbing
the owner. Code that no thread runs, such as `__del__` of an object that is collected late, ignores locks.
"""

from __future__ import annotations

import sys
from collections import deque
from typing import Any, Final

from elitescript.messages.timing import ticks_for
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import Strand
from elitescript.sealed import Sealed, hidden_slot, no_copy

A_LOCK: Final = "a lock"
"""Reason of a wait for a lock."""

TIMEOUT_MAX: Final = 9_223_372_036.0
"""Longest timeout, s; that of CPython on 64-bit systems."""


class _Claim:
    """A thread that waits for a lock."""

    __slots__ = ("is_granted", "strand")

    def __init__(self, strand: Strand) -> None:
        self.strand = strand
        self.is_granted = False


class _Mutex:
    """The state of a lock."""

    __slots__ = ("claims", "count", "is_locked", "owner", "scheduler")

    def __init__(self, scheduler: Scheduler) -> None:
        self.scheduler = scheduler
        self.is_locked = False
        self.owner: Strand | None = None
        self.count = 0
        """Number of times that the owner has taken it; for re-entrant locks."""
        self.claims: deque[_Claim] = deque()

    def take(self, timeout_s: float | None) -> bool:
        """Take it, waiting if necessary; return False after a timeout.

        Args:
            timeout_s: None waits for ever, 0 does not wait.
        """
        scheduler = self.scheduler
        strand = scheduler.current
        if strand is None:
            return True
        if not self.is_locked:
            self.is_locked = True
            self.owner = strand
            return True
        if timeout_s == 0.0:
            return False
        if strand.is_dying:
            scheduler.refuse_if_stopped()
            strand.owed[self] = strand.owed.get(self, 0) + 1
            return True
        claim = _Claim(strand)
        self.claims.append(claim)
        until = None if timeout_s is None else scheduler.now + max(1, ticks_for(timeout_s))
        try:
            scheduler.wait(A_LOCK, until)
        except BaseException:
            if claim.is_granted:
                self.give_on()
            else:
                self.claims.remove(claim)
            raise
        if not claim.is_granted:
            self.claims.remove(claim)
        return claim.is_granted

    def give_back(self) -> None:
        """Release it.

        Raises:
            RuntimeError: no thread holds it.
        """
        strand = self.scheduler.current
        if strand is None:
            return
        if strand.is_dying:
            owed = strand.owed.get(self, 0)
            if owed:
                strand.owed[self] = owed - 1
                return
            if not self.is_locked:
                return
        if not self.is_locked:
            raise RuntimeError("release unlocked lock")
        self.give_on()

    def give_on(self) -> None:
        """Hand it to the thread that has waited longest, or release it."""
        self.count = 0
        if self.claims:
            claim = self.claims.popleft()
            claim.is_granted = True
            self.owner = claim.strand
            self.scheduler.wake(claim.strand)
        else:
            self.is_locked = False
            self.owner = None


def holder_awaited(strand: Strand) -> Strand | None:
    """Return the thread that holds the lock for which a thread waits; None if it waits for none."""
    frame = strand.top_frame()
    while frame is not None and not strand.is_script_frame(frame):
        if frame.f_code is _Mutex.take.__code__:
            mutex: _Mutex = frame.f_locals["self"]
            return mutex.owner
        frame = frame.f_back
    return None


def _timeout(blocking: Any, timeout: Any) -> float | None:
    """Return the arguments of `acquire` as a timeout in s: None for ever, 0 without waiting.

    Raises:
        ValueError, OverflowError: as CPython's.
    """
    if not blocking:
        if timeout != -1:
            raise ValueError("can't specify a timeout for a non-blocking call")
        return 0.0
    if timeout == -1:
        return None
    if timeout < 0:
        raise ValueError("timeout value must be a non-negative number")
    if timeout > TIMEOUT_MAX:
        raise OverflowError("timeout value is too large")
    return float(timeout)


class lock(metaclass=Sealed):
    """A lock as scripts hold it."""

    __slots__ = ("__weakref__", "_mutex")
    __module__ = "_thread"
    __reduce_ex__ = no_copy

    def acquire(self, blocking: Any = True, timeout: Any = -1) -> bool:
        """Take the lock; see `threading.Lock.acquire`."""
        mutex: _Mutex = _mutex_of(self)
        return mutex.take(None if blocking is True and timeout == -1 else _timeout(blocking, timeout))

    def release(self) -> None:
        """Release the lock.

        Raises:
            RuntimeError: it is free.
        """
        _mutex_of(self).give_back()

    def locked(self) -> bool:
        """Return whether a thread holds it."""
        return bool(_mutex_of(self).is_locked)

    def __enter__(self) -> bool:
        return bool(_mutex_of(self).take(None))

    def __exit__(self, *details: object) -> None:
        _mutex_of(self).give_back()

    def __repr__(self) -> str:
        state = "locked" if self.locked() else "unlocked"
        return f"<{state} _thread.lock object at {id(self):#018x}>"


_mutex = hidden_slot(lock, "_mutex")
_mutex_of = _mutex.__get__


class RLock(metaclass=Sealed):
    """A lock that its owner can take again."""

    __slots__ = ("__weakref__", "_mutex")
    __module__ = "_thread"
    __reduce_ex__ = no_copy

    def acquire(self, blocking: Any = True, timeout: Any = -1) -> bool:
        """Take the lock; see `threading.RLock.acquire`."""
        mutex: _Mutex = _rmutex_of(self)
        timeout_s = None if blocking is True and timeout == -1 else _timeout(blocking, timeout)
        if mutex.owner is not None and mutex.owner is mutex.scheduler.current:
            mutex.count += 1
            return True
        return _retake(mutex, timeout_s, 1)

    def release(self) -> None:
        """Release the lock once.

        Raises:
            RuntimeError: the calling thread does not hold it.
        """
        mutex: _Mutex = _rmutex_of(self)
        if mutex.owner is None or mutex.owner is not mutex.scheduler.current:
            _give_back_unowned(mutex)
            return
        mutex.count -= 1
        if mutex.count == 0:
            mutex.give_on()

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *details: object) -> None:
        self.release()

    if sys.version_info >= (3, 14):

        def locked(self) -> bool:
            """Return whether a thread holds the lock."""
            return bool(_rmutex_of(self).is_locked)

    def _is_owned(self) -> bool:
        mutex: _Mutex = _rmutex_of(self)
        strand = mutex.scheduler.current
        return strand is not None and (mutex.owner is strand or strand.owed.get(mutex, 0) > 0)

    def _recursion_count(self) -> int:
        return _rmutex_of(self).count if self._is_owned() else 0

    def _release_save(self) -> int:
        mutex: _Mutex = _rmutex_of(self)
        if mutex.owner is None or mutex.owner is not mutex.scheduler.current:
            _give_back_unowned(mutex)
            return 1
        count = mutex.count
        mutex.give_on()
        return count

    def _acquire_restore(self, count: int) -> None:
        _retake(_rmutex_of(self), None, count)

    def __repr__(self) -> str:
        mutex: _Mutex = _rmutex_of(self)
        state = "locked" if mutex.is_locked else "unlocked"
        owner = mutex.owner.handle if mutex.owner is not None else 0
        return f"<{state} _thread.RLock object owner={owner} count={mutex.count} at {id(self):#018x}>"


_rmutex = hidden_slot(RLock, "_mutex")
_rmutex_of = _rmutex.__get__


def _retake(mutex: _Mutex, timeout_s: float | None, count: int) -> bool:
    if not mutex.take(timeout_s):
        return False
    if mutex.owner is not None and mutex.owner is mutex.scheduler.current:
        mutex.count = count
    return True


def _give_back_unowned(mutex: _Mutex) -> None:
    """Release by a thread that does not own it, allowed for a stopped one."""
    strand = mutex.scheduler.current
    if strand is None:
        return
    if not strand.is_dying:
        raise RuntimeError("cannot release un-acquired lock")
    owed = strand.owed.get(mutex, 0)
    if owed:
        strand.owed[mutex] = owed - 1


def new_lock(scheduler: Scheduler) -> lock:
    """Return a lock for the threads of one scheduler."""
    result = lock()
    _mutex.__set__(result, _Mutex(scheduler))
    return result


def new_rlock(scheduler: Scheduler) -> RLock:
    """Return a re-entrant lock for the threads of one scheduler."""
    result = RLock()
    _rmutex.__set__(result, _Mutex(scheduler))
    return result


def is_lock(value: object) -> bool:
    """Return whether a value is a lock of a program, plain or re-entrant."""
    return type(value) in (lock, RLock)


def holder_of(value: object) -> Strand | None:
    """Return the thread that has taken a lock last; None if it is free."""
    return _state_of(value).owner


def waits_at(strand: Strand, value: object) -> bool:
    """Return whether a thread waits for a lock."""
    return any(claim.strand is strand for claim in _state_of(value).claims)


def _state_of(value: object) -> _Mutex:
    mutex: _Mutex = _mutex_of(value) if type(value) is lock else _rmutex_of(value)
    return mutex


def release_at_end(lock_: lock) -> None:
    """Release a lock that represents a thread which has ended."""
    mutex: _Mutex = _mutex_of(lock_)
    if mutex.is_locked:
        mutex.give_on()
