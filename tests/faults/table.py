"""The table of what commands return when something goes wrong; see `outcomes.toml`."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

PATH: Final = Path(__file__).with_name("outcomes.toml")

_SECTIONS: Final = ("faults", "likes")


@dataclass(frozen=True, slots=True)
class Row:
    """One command.

    Attributes:
        title: its name, with more words if it stands in the table more than once.
        scene: what is there and stands when it is called.
        call: how it is called.
        good: what it returns, as `textmsg` writes it.
        failed: what it returns when it fails; None if nothing that can happen makes it fail.
        limit_s: how long it may take at most.
        sends: what the device sends by itself.
        gets: what the device gets from it.
        cells: for each fault, what comes of it.
    """

    title: str
    scene: str
    call: str
    good: str
    failed: str | None
    limit_s: float
    sends: str
    gets: str
    cells: dict[str, str]

    @property
    def command(self) -> str:
        """Name of the command."""
        return self.title.partition(",")[0]

    def outcome(self, fault: str) -> str:
        """What a cell means: a value, `refused`, `any`, or the code of an alarm."""
        cell = self.cells[fault]
        if cell in ("good", "untouched"):
            return self.good
        if cell in ("failed", "time-out"):
            assert self.failed is not None, (self.title, fault)
            return self.failed
        return cell.removeprefix("=")


def load() -> tuple[dict[str, dict[str, Any]], list[Row]]:
    """The faults by name, and all rows."""
    tables = tomllib.loads(PATH.read_text(encoding="utf-8"))
    faults, likes = tables["faults"], tables["likes"]
    rows = []
    for title, table in tables.items():
        if title not in _SECTIONS:
            cells = {**likes.get(table.get("like"), {}), **{name: table[name] for name in faults if name in table}}
            rows.append(
                Row(
                    title,
                    table["scene"],
                    table["call"],
                    table["good"],
                    table.get("failed"),
                    table.get("limit_s", 0.0),
                    table.get("sends", ""),
                    table.get("gets", ""),
                    {name: cells[name] for name in faults},
                )
            )
    return faults, rows
