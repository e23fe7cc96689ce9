"""The reference page of what commands return when something goes wrong, from the table that the tests read."""

from __future__ import annotations

from itertools import groupby
from typing import Any, Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.page import CHAPTERS
from elitescript.worlds.virtual.faults import FORMS, TABLE, Effect
from tests.faults.table import Row, load
from tools.markdown import NOTICE, cell

_AS_IF_NOTHING: Final = ("good", "untouched")


def faults_page() -> str:
    """Faults, then every command with all of them."""
    faults, rows = load()
    lines = [
        "# Commands and faults",
        "",
        NOTICE,
        "What each command that talks to something outside returns when something goes wrong there. Every line is a",
        "test. The fault begins on a connection that stands, 0.1 s before the call, and lasts until the call has",
        "returned; the device answers 0.1 s after it is asked. When the fault is over, the same call works again: after",
        "`socket_open` for a socket that was broken, by itself for everything else.",
        "",
        "No call takes longer than its time-out; *at the time-out* says that it takes all of it. An alarm ends the",
        "program unless it is caught with `try`. Nothing stays open but what outlives a program by design: serial ports",
        "that it has not closed, and MODBUS signals that it has not deleted.",
        "",
        "## Faults",
        "",
        "| in the tables | is | on a TCP connection | on a serial line |",
        "|---|---|---|---|",
    ]
    lines += [_fault_row(name, settings) for name, settings in faults.items()]
    lines += [
        "",
        "A wrong reply of a protocol is refused where the device speaks another one. Where a command sends and expects",
        "no answer, `text` and the like have nothing to replace.",
    ]
    for family, group in groupby(rows, _family):
        lines += ["", f"## {CHAPTERS[family]}", "", "| command | returns | with |", "|---|---|---|"]
        for row in group:
            lines += _command_rows(row)
    return "\n".join(lines) + "\n"


def _family(row: Row) -> str:
    command = CATALOGUE.get(row.command)
    assert command is not None, row.command
    return command.family


def _fault_row(name: str, settings: dict[str, Any]) -> str:
    shown = ", ".join(f"{key}={value!r}" for key, value in settings.items() if key != "at_s")
    if name == "break":
        shown += ", 0.05 s after the call has begun"
    form = settings.get("form")
    effects = FORMS[form] if form else TABLE[settings["kind"]]
    return f"| {name} | `{cell(shown)}` | {_effect(effects.tcp)} | {_effect(effects.line)} |"


def _effect(effect: Effect) -> str:
    return cell(effect.text) if effect.is_possible else f"refused: {cell(effect.text)}"


def _command_rows(row: Row) -> list[str]:
    """One row for each different result."""
    results: dict[str, list[str]] = {}
    for fault in row.cells:
        results.setdefault(_result(row, fault), []).append(fault)
    first = f"`{cell(row.call)}`"
    lines = []
    for result, faults in results.items():
        lines.append(f"| {first} | {result} | {', '.join(faults)} |")
        first = ""
    return lines


def _result(row: Row, fault: str) -> str:
    what = row.cells[fault]
    if what == "refused":
        return "*refused*"
    if what == "any":
        return "what the wrong bytes mean"
    if what.startswith("alarm "):
        return f"{what}"
    value = row.outcome(fault)
    shown = f"`{cell(value)}`" if value else "empty text"
    if what in _AS_IF_NOTHING:
        return f"{shown}, as without"
    return f"{shown} at the time-out" if what == "time-out" else shown
