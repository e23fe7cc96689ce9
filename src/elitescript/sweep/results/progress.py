"""The line of progress of a sweep: a bar, the rate, failures so far, time left. Pure: times are given."""

from __future__ import annotations

from typing import Final

INTERVAL_S: Final = 0.25
"""Least wall time between two lines."""

_CELLS: Final = 20
_WINDOW_S: Final = 4.0
"""The rate is that of this much wall time at least, so that it follows what the runs cost now."""


class Meter:
    """Makes the text of the line.

    Args:
        runs: how many there will be.
        now_s: wall time at the start, s.
        done: rows that are there already, from a sweep that is gone on with.
    """

    __slots__ = ("_next_s", "_rate_done", "_rate_s", "_runs")

    def __init__(self, runs: int, now_s: float, done: int = 0) -> None:
        self._runs = runs
        self._rate_s = self._next_s = now_s
        self._rate_done = done

    def text(self, done: int, failed: int, now_s: float) -> str | None:
        """Return the line to show; None less than `INTERVAL_S` after the last one.

        Args:
            done: rows that are there.
            failed: how many of them failed.
            now_s: wall time, s.
        """
        if now_s < self._next_s:
            return None
        self._next_s = now_s + INTERVAL_S
        passed_s = now_s - self._rate_s
        rate = (done - self._rate_done) / passed_s if passed_s > 0.0 else 0.0
        if passed_s >= _WINDOW_S:
            # Half of the past counts on.
            self._rate_s += 0.5 * passed_s
            self._rate_done += (done - self._rate_done) // 2
        share = done / self._runs if self._runs else 1.0
        filled = int(share * _CELLS)
        bar = "#" * filled + "-" * (_CELLS - filled)
        left = f", {duration((self._runs - done) / rate)} left" if rate > 0.0 and done < self._runs else ""
        failures = f", {failed:,} fail" if failed else ""
        return (
            f"[{bar}] {int(100 * share):3d} %  {done:,} of {self._runs:,} runs{failures}, {rate:,.0f} runs/s{left}"
            "  (Ctrl-C keeps what is there)"
        )


def duration(seconds: float) -> str:
    """Return a duration in its two largest units."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    if whole < 86400:
        return f"{whole // 3600} h {whole % 3600 // 60:02d} min"
    return f"{whole // 86400} d {whole % 86400 // 3600} h"
