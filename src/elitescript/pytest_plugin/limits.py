"""Default limits of the runs of a test: no forgotten `until_s` and no call that hangs keeps a session for ever.

Robot time counts where the test gives no `until_s`; wall time counts always. A run that goes on for longer is ended at
its next checkpoint, and its test fails. Where a timer of the system is free, it also ends calls of C that look for
signals (`re`, large numbers); one that looks for none is ended with the whole process, by `faulthandler`.
"""

from __future__ import annotations

import faulthandler
import os
import signal
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from threading import Timer, current_thread, main_thread
from time import monotonic
from typing import TYPE_CHECKING, Any, Final

import pytest

from elitescript.errors import UsageError
from elitescript.records import NamedTuple

if TYPE_CHECKING:
    from elitescript.robot import VirtualRobot
    from elitescript.run import Run

LIMIT: Final = "limit_s"
WALL_LIMIT: Final = "wall_limit_s"
SETTINGS: Final = (LIMIT, WALL_LIMIT)
"""Keywords of the marker; `elitescript_` before them makes the ini options."""

DEFAULTS: Final[Mapping[str, float]] = {LIMIT: 600.0, WALL_LIMIT: 60.0}
"""*Assumed*: longer than tests last, shorter than a CI job waits."""

LONGEST_S: Final = 1e8
"""Three years; timers of systems take no much longer time."""

AGAIN_S: Final = 2.0
"""Wall time between the limit and the next attempt, which raises an exception in whatever hangs."""
EXIT_S: Final = 30.0
"""Wall time behind the limit at which the process is ended."""
_REARM_S: Final = 5.0
"""The end of the process is put off by runs that begin, at most this often: it takes a thread."""


class Limits(NamedTuple):
    """Limits of a run; None for none.

    Attributes:
        robot_s: robot time, s.
        wall_s: wall time, s.
    """

    robot_s: float | None
    wall_s: float | None


class WallTimeLimit(BaseException):
    """Ends what hangs. No `except Exception` of a program catches it."""


def ini_name(setting: str) -> str:
    """Return the name of the ini option of a setting."""
    return f"elitescript_{setting}"


def limits_of(config: pytest.Config, settings: Mapping[str, Any]) -> Limits:
    """Return the limits of a test: those of its marker, else of the ini file, else the defaults.

    Raises:
        UsageError: one is no number of at least 0.
    """
    return Limits(*(_limit_of(config, name, settings.get(name)) for name in SETTINGS))


def _limit_of(config: pytest.Config, name: str, given: Any) -> float | None:
    if given is not None:
        return limit(given, f"@pytest.mark.elitescript({name}=)")
    text = config.getini(ini_name(name))
    try:
        # Only a file has numbers as texts.
        return limit(float(text) if text else DEFAULTS[name], ini_name(name))
    except ValueError:
        raise _refused(text, ini_name(name)) from None


def limit(value: Any, where: str) -> float | None:
    """Return a limit that users give, s; None for 0, which is none, and for what lasts longer than any test.

    Raises:
        UsageError: no number of at least 0; the text names the place, `where`.
    """
    try:
        number = -1.0 if isinstance(value, bool | str | bytes) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = -1.0
    if not number >= 0.0:
        raise _refused(value, where)
    return number if 0.0 < number < LONGEST_S else None


def _refused(value: Any, where: str) -> UsageError:
    return UsageError(f"{where}: write seconds, or 0 for no limit, not {value!r}")


class Guard:
    """Holds the runs of one test to their limits.

    Args:
        limits: of each run.
        descriptor: where the stack is written when the process is ended: standard error, before it is captured.

    Attributes:
        limits_s: see above.
        is_guarding: whether a run is held.
        exceeded: why runs were ended, in words.
    """

    __slots__ = ("_armed_s", "_descriptor", "exceeded", "is_guarding", "limits_s")

    def __init__(self, limits: Limits, descriptor: int | None) -> None:
        self.limits_s = limits
        self._descriptor = descriptor
        self.is_guarding = False
        self._armed_s: float | None = None
        self.exceeded: list[str] = []

    def close(self) -> None:
        """Take back the end of the process."""
        if self._armed_s is not None:
            self._armed_s = None
            faulthandler.cancel_dump_traceback_later()

    def limits(self, robot: VirtualRobot, run: Run, until_s: float | None) -> AbstractContextManager[float | None]:
        """Hold one run to its limits while the body lets it go on; see `RunObserver.limits`."""
        if self.is_guarding:
            # A run within another one, as of a device: that one's limits count.
            return nullcontext(until_s)
        return _Held(self, robot, run, until_s)

    def fail(self, what: str, name: str, run: Run) -> None:
        """Let the test fail: a run was ended by the limit of this name."""
        __tracebackhide__ = True
        until = "; or run(..., until_s=SECONDS)" if name == LIMIT else f" ({run.time_s:.3f} s of robot time)"
        words = (
            f"{what}{until if name == WALL_LIMIT else ''}, the limit of a run in pytest; another one, or 0 for none: "
            f"@pytest.mark.elitescript({name}=SECONDS), or {ini_name(name)} in the ini file"
            f"{until if name == LIMIT else ''}"
        )
        self.exceeded.append(words)
        pytest.fail(words)

    @contextmanager
    def timer(self, late: Callable[[], None]) -> Iterator[None]:
        """Call `late` at the limit of wall time, by a timer of the system where that is free, else in a thread."""
        wall_s = self.limits_s.wall_s
        if wall_s is None:
            yield
            return
        self._put_off_exit(wall_s)
        if not self._has_timer():
            # Not after each tick: what watches a run changes when it is stuck, and takes time.
            thread = Timer(wall_s, late)
            thread.daemon = True
            thread.start()
            try:
                yield
            finally:
                thread.cancel()
                # Until it has ended it holds the robot.
                thread.join()
            return
        count = 0

        def ring(_number: int, _frame: object) -> None:
            nonlocal count
            count += 1
            late()
            # The first time the run may still come to its next checkpoint.
            if count > 1:
                raise WallTimeLimit("the run was ended by the limit of wall time of its test")

        signal.signal(signal.SIGALRM, ring)
        signal.setitimer(signal.ITIMER_REAL, wall_s, AGAIN_S)
        try:
            yield
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, signal.SIG_DFL)

    def _has_timer(self) -> bool:
        """Return whether the timer is there and free: pytest-timeout may have taken it."""
        if not _has_timers() or current_thread() is not main_thread():
            return False
        is_free = signal.getsignal(signal.SIGALRM) in (signal.SIG_DFL, None)
        return is_free and signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)

    def _put_off_exit(self, wall_s: float) -> None:
        now_s = monotonic()
        if self._descriptor is None or (self._armed_s is not None and now_s - self._armed_s < _REARM_S):
            return
        self._armed_s = now_s
        faulthandler.dump_traceback_later(wall_s + EXIT_S + _REARM_S, exit=True, file=self._descriptor)


class _Held:
    """Holds one run of a guard to its limits."""

    __slots__ = ("_guard", "_has_default", "_is_late", "_robot", "_run", "_timer", "_until_s")

    def __init__(self, guard: Guard, robot: VirtualRobot, run: Run, until_s: float | None) -> None:
        self._guard = guard
        self._robot = robot
        self._run = run
        self._has_default = until_s is None and guard.limits_s.robot_s is not None
        self._until_s = guard.limits_s.robot_s if self._has_default else until_s
        self._is_late = False
        self._timer = guard.timer(self._end)

    def _end(self) -> None:
        self._is_late = True
        self._robot.interrupt("time_limit")

    def __enter__(self) -> float | None:
        self._guard.is_guarding = True
        self._timer.__enter__()
        return self._until_s

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: object) -> None:
        __tracebackhide__ = True
        self._timer.__exit__(None, None, None)
        self._guard.is_guarding = False
        if error is not None and not isinstance(error, WallTimeLimit):
            return
        run, limits = self._run, self._guard.limits_s
        name = os.path.basename(run.unit.source.name)  # noqa: PTH119
        if self._is_late:
            self._guard.fail(f"{name} was still running after {limits.wall_s:g} s of wall time", WALL_LIMIT, run)
        if self._has_default and run.state == "time_limit" and run.time_s >= (self._until_s or 0.0):
            self._guard.fail(f"{name} was still running after {limits.robot_s:g} s of robot time", LIMIT, run)


def _has_timers() -> bool:
    return sys.platform != "win32" and hasattr(signal, "setitimer")
