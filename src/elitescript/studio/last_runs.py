"""Gathers what editors show of the last run from the messages about it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from elitescript.assist.last_run import LastRun, LineTime, RunAlarm, ShortenedBlend
from elitescript.messages.motion import shortened_radius


class LastRuns:
    """Listens to the messages of a source.

    Args:
        ran: takes what is known of each run that has ended.
    """

    __slots__ = ("_blends", "_cycle", "_moves", "_ran", "_run", "_text", "_version", "_waiting")

    def __init__(self, ran: Callable[[LastRun], None]) -> None:
        self._ran = ran
        self._version, self._waiting = -1, ""
        """Number and text of the newest program."""
        self._run = -1
        self._text: str | None = None
        """Text of the run; None if it is not known any more."""
        self._cycle: list[Mapping[str, Any]] = []
        self._moves: dict[int, LineTime] = {}
        self._blends: dict[int, ShortenedBlend] = {}

    def program(self, version: int, text: str) -> None:
        """Take a text that is to run."""
        self._version, self._waiting = version, text

    def take(self, message: Mapping[str, Any]) -> None:
        """Take a message of the source; those that say nothing of a run are left out."""
        match message["type"]:
            case "run_began":
                self._run = message["run"]
                self._text = self._waiting if message["version"] == self._version else None
                self._cycle, self._moves, self._blends = [], {}, {}
            case "cycle" if message["run"] == self._run:
                self._cycle = message["table"]
            case "moves" if message["run"] == self._run:
                for move in message["list"]:
                    times, total_s = self._moves.get(move["line"], (0, 0.0))
                    self._moves[move["line"]] = LineTime(times + 1, total_s + move["end_s"] - move["start_s"])
            case "events" if message["run"] == self._run:
                for event in message["list"]:
                    if event["type"] == "warning" and (radii := shortened_radius(event.get("text", ""))):
                        self._blends[event["line"]] = ShortenedBlend(*radii)
            case "run_ended" if message["run"] == self._run and self._text is not None:
                self._ran(self._last_run(self._text, message))

    def _last_run(self, text: str, ended: Mapping[str, Any]) -> LastRun:
        rows = self._cycle
        moment, alarm = ended["moment"], ended.get("alarm")
        return LastRun(
            text=text,
            duration_s=moment["t"],
            moves=self._moves,
            lines={row["line"]: LineTime(row["visits"], row["moving_s"] + row["standing_s"]) for row in rows},
            values={"": {row["name"]: row["value"] for row in moment["globals"]}},
            blends=self._blends,
            alarms=() if alarm is None else (RunAlarm(alarm["line"], alarm["code"], alarm["text"]),),
        )
