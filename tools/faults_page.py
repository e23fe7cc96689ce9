"""The reference page of what commands return when something goes wrong, from the table that the tests read."""

from __future__ import annotations

import tomllib
from itertools import groupby
from pathlib import Path
from typing import Any, Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.page import CHAPTERS
from elitescript.devices.channels.faults import FORMS, TABLE, FaultEffect
from tests.faults.table import Row, load
from tools.markdown import NOTICE, cell

INPUTS: Final = Path(__file__).resolve().parent.parent / "tests" / "faults" / "inputs.toml"

_REMARKS: Final = {
    "good": ", as without",
    "untouched": ": nothing waits for the device",
    "time-out": " at the time-out",
}


def faults_page() -> str:
    """Faults, then every command with all of them."""
    faults, rows = load()
    lines = [
        "# Commands and faults",
        "",
        NOTICE,
        "What each command that talks to something outside returns when something goes wrong there. Every line is a",
        "test. The fault begins on a connection that stands, 0.1 s before the call (2.1 s before, for the signals of",
        "MODBUS TCP, whose watchdog is 0.5 s there), and lasts until the call has returned; the device answers 0.1 s",
        "after it is asked. When the fault is over, the same call works again: after `socket_open` for a socket that",
        "was broken, by itself for everything else.",
        "",
        "No call takes longer than its time-out; *at the time-out* says that it takes all of it. An alarm ends the",
        "program unless it is caught with `try`. Nothing stays open but what outlives a program by design: serial",
        "ports that it has not closed, and MODBUS signals that it has not deleted.",
        "",
        "What the manuals leave open is *assumed*: the empty list of a MODBUS-RTU read that fails; that a call of a",
        "procedure that fails raises; 110 for a MODBUS answer that does not come and 9 for one of another unit; that a",
        "slave on a serial line bears a pause of one control period in a request.",
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
        chapter = list(group)
        nowhere = [name for name in faults if all(row.cells[name] == "refused" for row in chapter)]
        lines += ["", f"## {CHAPTERS[family]}", "", f"There is no {', '.join(nowhere)} here: they are refused.", ""]
        lines += ["| command | returns | with |", "|---|---|---|"]
        for row in chapter:
            lines += _command_rows(row, nowhere)
    return "\n".join([*lines, *_inputs()]) + "\n"


def _inputs() -> list[str]:
    """What inputs read, from the table that the tests read."""
    lines = [
        "",
        "## Inputs",
        "",
        "What an input reads while something goes wrong with it. Devices, wires, schedules, clients, `--set` and",
        "Python set the level that is *applied*; programs and clients read another one while a fault acts. A fault",
        "begins before what is applied in its first control period, and ends before what is applied in the period",
        "after its last. A change is put down to the fault (`by` is `fault`) if the level is not the applied one, or",
        "comes back to it without anything new being applied. Several faults of one input act one after the other.",
        "",
        "Every line is a test. Numbers are control periods of 4 ms; the fault acts from 10 to 29, unless it has",
        "a `for_s` of its own.",
        "",
        "| case | fault | applied | reads |",
        "|---|---|---|---|",
    ]
    for title, case in tomllib.loads(INPUTS.read_text(encoding="utf-8")).items():
        fault = ", ".join(f"{key}={value!r}" for key, value in case["fault"].items())
        applied = "; ".join(f"{tick}: {_level(value)}" for tick, value in case["applied"])
        reads = "; ".join(
            f"{tick}: {_level(value)}{' (fault)' if by == 'fault' else ''}" for tick, value, by in case["reads"]
        )
        lines.append(f"| {cell(title)} | `{cell(fault)}` | {applied} | {reads} |")
    return lines


def _level(value: bool | float) -> str:
    return ("low", "high")[value] if isinstance(value, bool) else f"{value:g}"


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


def _effect(effect: FaultEffect) -> str:
    return cell(effect.text) if effect.is_possible else f"refused: {cell(effect.text)}"


def _command_rows(row: Row, nowhere: list[str]) -> list[str]:
    """One row for each different result."""
    results: dict[str, list[str]] = {}
    for fault in row.cells:
        if fault not in nowhere:
            results.setdefault(_result(row, fault), []).append(fault)
    first = f"`{cell(row.call)}`"
    if len(results) == 1:
        return [f"| {first} | {next(iter(results))} | all of them |"]
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
        return what
    value = row.outcome(fault)
    shown = f"`{cell(value)}`" if value else "empty text"
    return shown + _REMARKS.get(what, "")
