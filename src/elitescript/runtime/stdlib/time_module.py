"""`time` for scripts and for copies of the standard library: the clock is the robot's, and stands still between ticks.

The zone is always UTC (*assumed*), so that a program prints the same everywhere; format fields of the zone are filled
in before C functions are called.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, Protocol

from elitescript.errors import ScriptStateError
from elitescript.messages.timing import seconds, ticks_for
from elitescript.runtime.stdlib.loader import real

COPY_GAIN_S: Final = 1e-9
"""Gain per tick of the clock of the copies over that of the robot.

`threading` and `queue` compute an end from a sum of floats and wait again while the difference to it is above 0.
The gain is more than the rounding of such sums and less than any wait, so a wait of n ticks is over after n ticks.
"""


class ClockPort(Protocol):
    """Lists the members of the context that the module uses."""

    @property
    def is_secondary(self) -> bool:
        """Whether the caller is a secondary program."""

    @property
    def now(self) -> int:
        """The present tick."""

    def timestamp_s(self) -> float:
        """Return the controller's clock, seconds since 1970."""

    def wait_ticks(self, count: int) -> None:
        """Let `count` ticks go by."""


ZONE: Final = "UTC"
"""The zone of every robot."""
_CYCLE_S: Final = 146097 * 86400
"""Seconds in 400 years."""
_ZONE_FIELDS: Final = r"%%|%[-_0^#]*[0-9]*[EO]?([sZz])"


def clock_names(port: ClockPort, reader: Callable[[], Any] | None = None) -> dict[str, Any]:
    """Return the public names of `time` for one program.

    Args:
        port: the program.
        reader: gives the program's copy of `_strptime`; without one there is no `strptime`.
    """
    host = real("time")

    def time() -> float:
        """Return the controller's clock, seconds since 1970."""
        return port.timestamp_s()

    def time_ns() -> int:
        """Return the controller's clock, nanoseconds since 1970."""
        return round(port.timestamp_s() * 1000) * 1_000_000

    def monotonic() -> float:
        """Seconds since the robot was switched on."""
        return seconds(port.now)

    def monotonic_ns() -> int:
        """Nanoseconds since the robot was switched on."""
        return port.now * 4_000_000

    def sleep(secs: float) -> None:
        """Let the calling thread wait; others go on."""
        if port.is_secondary:
            raise ScriptStateError(
                "time.sleep waits, which a secondary program (sec) may not do", code="R120", command="time.sleep"
            )
        if not isinstance(secs, (int, float)):
            raise TypeError(f"{type(secs).__name__!r} object cannot be interpreted as a number of seconds")
        if secs < 0:
            raise ValueError("sleep length must be non-negative")
        port.wait_ticks(ticks_for(secs))

    def gmtime(secs: float | None = None) -> Any:
        """Return a time as year, month, day, ... in UTC; the present one by default."""
        return host.struct_time((*host.gmtime(time() if secs is None else secs)[:9], ZONE, 0))

    def ctime(secs: float | None = None) -> str:
        """Return a time as a text; the present one by default."""
        return str(host.asctime(gmtime(secs)))

    def asctime(parts: Any = None) -> str:
        """Return year, month, day, ... as a text; the present time by default."""
        return str(host.asctime(gmtime() if parts is None else parts))

    def strftime(template: str, parts: Any = None) -> str:
        """Return year, month, day, ... in a form of one's own; the present time by default."""
        if parts is None:
            parts = gmtime()
        if not isinstance(template, str):
            return str(host.strftime(template, parts))

        def filled(field: Any) -> str:
            kind = field[1]
            if kind == "s":
                return str(round(mktime(parts)))
            if kind == "Z":
                return str(getattr(parts, "tm_zone", None) or ZONE).replace("%", "%%")
            return _offset(getattr(parts, "tm_gmtoff", None) or 0) if kind == "z" else "%%"

        return str(host.strftime(real("re").sub(_ZONE_FIELDS, filled, template), parts))

    def mktime(parts: Any) -> float:
        """Return the seconds since 1970 of year, month, day, ... in UTC."""
        host.mktime(parts)  # for its errors; what it returns depends on the zone of the computer
        year, month, day, hour, minute, second = parts[:6]
        year, month = year + (month - 1) // 12, (month - 1) % 12 + 1
        # `calendar` knows the years 1 to 9999; the calendar repeats after 400 years.
        cycles, year = divmod(year - 1, 400)
        count_s = real("calendar").timegm((year + 1, month, day, hour, minute, second))
        return float(count_s + cycles * _CYCLE_S)

    def strptime(text: str, template: str = "%a %b %d %H:%M:%S %Y") -> Any:
        """Read a time in a form of one's own."""
        assert reader is not None
        return host.struct_time(reader()._strptime(text, template)[0])

    functions: tuple[Callable[..., Any], ...] = (
        asctime,
        ctime,
        gmtime,
        mktime,
        monotonic,
        monotonic_ns,
        sleep,
        strftime,
        time,
        time_ns,
    )
    return {
        **{function.__name__: function for function in functions},
        "altzone": 0,
        "daylight": 0,
        "localtime": gmtime,
        "perf_counter": monotonic,
        "perf_counter_ns": monotonic_ns,
        "process_time": monotonic,
        "process_time_ns": monotonic_ns,
        **({} if reader is None else {"strptime": strptime}),
        "struct_time": host.struct_time,
        "thread_time": monotonic,
        "timezone": 0,
        "tzname": (ZONE, ZONE),
    }


def _offset(offset_s: int) -> str:
    """Return an offset east of UTC as hours and minutes."""
    minutes = abs(offset_s) // 60
    return f"{'-' if offset_s < 0 else '+'}{minutes // 60:02}{minutes % 60:02}"


def copy_clock(port: ClockPort) -> Callable[[], float]:
    """Return `monotonic` for the copies; see `COPY_GAIN_S`."""

    def monotonic() -> float:
        tick = port.now
        return seconds(tick) + tick * COPY_GAIN_S

    return monotonic
