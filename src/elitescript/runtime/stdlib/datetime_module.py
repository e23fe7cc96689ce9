"""`datetime` for scripts: the C classes of Python, with the robot's clock and UTC in place of the computer's.

`timedelta`, `timezone` and `tzinfo` are the classes of Python themselves, which no program can change. `date`, `time`
and `datetime` are subclasses that each program has of its own: methods that would read the clock or the zone of the
computer are replaced, and those that would give an object of the base class. Calls with wrong arguments are handed to
the base class, so that their errors have its texts.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any, Final

from elitescript.runtime.stdlib.loader import real
from elitescript.runtime.stdlib.time_module import ZONE, ClockPort

_SECONDS_FIELDS: Final = re.compile(r"%%|%[-_0^#]*[0-9]*[EO]?s")
_EPOCH_DAY: Final = 719163
"""Ordinal of 1970-01-01."""
_TIMES_DAY: Final = 693596
"""Ordinal of 1900-01-01, the date that `strftime` takes for times."""
_DAY_S: Final = 86400


def datetime_names(port: ClockPort, reader: Callable[[], Any]) -> dict[str, Any]:
    """Return the public names of `datetime` for one program.

    Args:
        port: the program.
        reader: gives the program's copy of `_strptime`.
    """
    host = real("datetime")
    utc = host.timezone.utc
    local = host.timezone(host.timedelta(0), ZONE)
    epoch = host.datetime(1970, 1, 1)

    def utc_moment(kind: Any, seconds: Any, zone: Any) -> Any:
        moment = host.datetime.fromtimestamp(seconds, utc)
        day = (moment.year, moment.month, moment.day)
        return kind(*day, moment.hour, moment.minute, moment.second, moment.microsecond, zone)

    def read(kind: str, *args: Any) -> Any:
        module = reader()
        # Since Python 3.14 there are three, as `date` and `time` have `strptime` too.
        function = getattr(module, f"_strptime_datetime_{kind}", None) or module._strptime_datetime
        return function(*args)

    class Date(host.date):  # type: ignore[misc,name-defined]
        __slots__ = ()
        __doc__ = host.date.__doc__
        __repr__ = _shown("date", host.date)
        strftime = _formatted(host.date)

        @classmethod
        def today(cls, *args: Any, **options: Any) -> Any:
            """Return the present date."""
            return super().today(*args, **options) if args or options else cls.fromtimestamp(port.timestamp_s())

        @classmethod
        def fromtimestamp(cls, *args: Any, **options: Any) -> Any:
            """Return the date of a time in seconds since 1970."""
            if len(args) != 1 or options:
                return super().fromtimestamp(*args, **options)
            (seconds,) = args
            if isinstance(seconds, float) and math.isfinite(seconds):
                seconds = math.floor(seconds)
            moment = host.datetime.fromtimestamp(seconds, utc)
            return cls(moment.year, moment.month, moment.day)

        if hasattr(host.date, "strptime"):

            @classmethod
            def strptime(cls, *args: Any, **options: Any) -> Any:
                """Read a date in a form of one's own."""
                return read("date", cls, *args) if _is_texts(args, options) else super().strptime(*args, **options)

    class Time(host.time):  # type: ignore[misc,name-defined]
        __slots__ = ()
        __doc__ = host.time.__doc__
        __repr__ = _shown("time", host.time)
        strftime = _formatted(host.time)

        if hasattr(host.time, "strptime"):

            @classmethod
            def strptime(cls, *args: Any, **options: Any) -> Any:
                """Read a time in a form of one's own."""
                return read("time", cls, *args) if _is_texts(args, options) else super().strptime(*args, **options)

    class Datetime(host.datetime, Date):  # type: ignore[misc,name-defined]
        __slots__ = ()
        __doc__ = host.datetime.__doc__
        __repr__ = _shown("datetime", host.datetime)

        @classmethod
        def now(cls, *args: Any, **options: Any) -> Any:
            """Return the present date and time, in a zone if one is given."""
            zone = args[0] if args else options.get("tz")
            if len(args) + len(options) > 1 or not options.keys() <= {"tz"} or not _is_zone(zone):
                return super().now(*args, **options)
            moment = utc_moment(cls, port.timestamp_s(), zone)
            return moment if zone is None else zone.fromutc(moment)

        @classmethod
        def today(cls, *args: Any, **options: Any) -> Any:
            """Return the present date and time."""
            return super().today(*args, **options) if args or options else cls.fromtimestamp(port.timestamp_s())

        @classmethod
        def utcnow(cls, *args: Any, **options: Any) -> Any:
            """Return the present date and time in UTC, without a zone."""
            return super().utcnow(*args, **options) if args or options else utc_moment(cls, port.timestamp_s(), None)

        @classmethod
        def fromtimestamp(cls, *args: Any, **options: Any) -> Any:
            """Return the date and time of seconds since 1970, in a zone if one is given."""
            named = dict(zip(("timestamp", "tz"), args, strict=False)) | options
            is_plain = len(args) + len(options) == len(named) and {"timestamp"} <= named.keys() <= {"timestamp", "tz"}
            if is_plain and named.get("tz") is None:
                return utc_moment(cls, named["timestamp"], None)
            return super().fromtimestamp(*args, **options)

        @classmethod
        def utcfromtimestamp(cls, *args: Any, **options: Any) -> Any:
            """Return the date and time of seconds since 1970 in UTC, without a zone."""
            if len(args) != 1 or options:
                return super().utcfromtimestamp(*args, **options)
            return utc_moment(cls, args[0], None)

        @classmethod
        def strptime(cls, *args: Any, **options: Any) -> Any:
            """Read a date and time in a form of one's own."""
            return read("datetime", cls, *args) if _is_texts(args, options) else super().strptime(*args, **options)

        def timestamp(self) -> float:
            """Return the seconds since 1970; a date and time without a zone is in UTC."""
            if self.utcoffset() is not None:
                return float(super().timestamp())
            since = host.datetime.__sub__(self, epoch)
            return float(since.days * _DAY_S + since.seconds + since.microseconds / 1e6)

        def astimezone(self, *args: Any, **options: Any) -> Any:
            """Return the same moment in another zone; that of the robot if none is given."""
            moment = self
            if self.utcoffset() is None:
                moment = host.datetime.replace(self, tzinfo=local)
            if (*args, *options.values()) in ((), (None,)) and options.keys() <= {"tz"}:
                args, options = (local,), {}
            return super(Datetime, moment).astimezone(*args, **options)

        def date(self) -> Any:
            """Return the date."""
            return Date(self.year, self.month, self.day)

        def time(self) -> Any:
            """Return the time of day without the zone."""
            return Time(self.hour, self.minute, self.second, self.microsecond, fold=self.fold)

        def timetz(self) -> Any:
            """Return the time of day with the zone."""
            return Time(self.hour, self.minute, self.second, self.microsecond, self.tzinfo, fold=self.fold)

    def plain(kind: Any, limit: Any) -> Any:
        fields = ("year", "month", "day", "hour", "minute", "second", "microsecond")
        return kind(*(getattr(limit, field) for field in fields if hasattr(limit, field)))

    kinds: dict[str, Any] = {"date": Date, "datetime": Datetime, "time": Time}
    for name, kind in kinds.items():
        kind.__name__ = kind.__qualname__ = name
        kind.__module__ = "datetime"
        for method in vars(kind).values():
            function = getattr(method, "__func__", method)
            if hasattr(function, "__qualname__"):
                function.__qualname__ = f"{name}.{function.__name__}"
        base = getattr(host, name)
        kind.min, kind.max = plain(kind, base.min), plain(kind, base.max)
    return {
        "MAXYEAR": host.MAXYEAR,
        "MINYEAR": host.MINYEAR,
        "UTC": utc,
        **kinds,
        "timedelta": host.timedelta,
        "timezone": host.timezone,
        "tzinfo": host.tzinfo,
    }


def _shown(name: str, base: Any) -> Callable[[Any], str]:
    """Return a `__repr__` that names the module, as that of Python does for its own classes."""

    def __repr__(self: Any) -> str:
        text: str = base.__repr__(self)
        kind = type(self)
        return f"datetime.{text}" if kind.__module__ == "datetime" and kind.__qualname__ == name else text

    return __repr__


def _is_texts(args: tuple[Any, ...], options: dict[str, Any]) -> bool:
    return len(args) == 2 and not options and isinstance(args[0], str) and isinstance(args[1], str)


def _is_zone(zone: Any) -> bool:
    return zone is None or isinstance(zone, real("datetime").tzinfo)


def _formatted(base: Any) -> Callable[..., str]:
    """Return a `strftime` that fills in the seconds since 1970 (`%s`), for which C takes the zone of the computer."""

    def strftime(self: Any, *args: Any, **options: Any) -> str:
        """Return the date or time in a form of one's own."""

        def seconds(field: re.Match[str]) -> str:
            return "%%" if field[0] == "%%" else str(_seconds_of(self))

        def filled(value: Any) -> Any:
            return _SECONDS_FIELDS.sub(seconds, value) if isinstance(value, str) and "s" in value else value

        text: str = base.strftime(self, *map(filled, args), **{name: filled(item) for name, item in options.items()})
        return text

    return strftime


def _seconds_of(moment: Any) -> int:
    days = moment.toordinal() if hasattr(moment, "toordinal") else _TIMES_DAY
    clock_s = moment.hour * 3600 + moment.minute * 60 + moment.second if hasattr(moment, "hour") else 0
    return int((days - _EPOCH_DAY) * _DAY_S + clock_s)
