"""The reference page of the world file and of faults, from the classes and tables that read them."""

from __future__ import annotations

import inspect
import re
from importlib import import_module
from typing import Any

from elitescript.devices.channels.faults import FORMS, INPUTS, TABLE, Fault, FaultEffect
from elitescript.devices.device import setting_names
from elitescript.devices.scenario import KINDS
from elitescript.solids import cell as cells
from tools.markdown import NOTICE, cell


def devices_page() -> str:
    """Sections of a world file, and faults."""
    lines = [
        "# World files and faults",
        "",
        NOTICE,
        "What the sections of a world file may hold ([how to write one](../how-to/devices.md)). Each is a list: write",
        "`[[tcp]]` once for every device. `name` is what messages call it.",
        "",
        "`[world]` has `seed`, a whole number, and `network`, `virtual` or `real`.",
    ]
    for section, kind in KINDS.items():
        if kind.declared:
            lines += ["", f"## [[{section}]]", "", "| key | default | |", "|---|---|---|"]
            found = _loaded(kind.declared)
            texts = _attributes(found)
            if found is Fault:
                rows = [(name, "" if name in ("kind", "on") else field.default) for name, field in _fields()]
            else:
                rows = [(name, getattr(found, name, "")) for name in setting_names(found)]
            lines += [f"| `{name}` | {_default(value)} | {cell(texts.get(name, ''))} |" for name, value in rows]
        else:
            lines += ["", f"## [[{section}]]", "", "Anything else: `class` names it, such as `cell.py:Button`."]
        if kind.base:
            lines += ["", 'With `class = "cell.py:Name"` the other keys are settings of that class.']
    lines += _solids()
    head = "on a TCP connection | on a serial line | keys of its own |"
    lines += ["", "## Faults", "", f"| kind | {head}", "|---|---|---|---|"]
    lines += [_row(row.name, row.tcp, row.line, row.takes) for row in TABLE.values() if not row.is_of_inputs]
    lines += ["", f"| `form` of `wrong_reply` | {head}", "|---|---|---|---|"]
    lines += [_row(form.name, form.tcp, form.line, form.takes) for form in FORMS.values()]
    lines += [
        "",
        "A reply that is wrong in the way of a protocol is refused where the device speaks another one.",
        "What each command returns with each fault: [faults.md](faults.md).",
        "",
        f"Inputs that can be disturbed: {', '.join(f'`{name}`' for name in INPUTS)}.",
        "",
        "| kind | at a digital input | at an analog input | keys of its own |",
        "|---|---|---|---|",
        *(_row(row.name, row.digital, row.analog, row.takes) for row in TABLE.values() if row.is_of_inputs),
        "",
        "The level that is applied is kept: it is read again when the fault is over. Which changes are put down to a",
        "fault, and what an input reads tick by tick, is in [faults.md](faults.md#inputs). What real inputs do is",
        "*assumed*.",
    ]
    return "\n".join(lines) + "\n"


def _solids() -> list[str]:
    """Things beside the robot and solids on its flange."""
    kinds = [f"`{kind}` has {' and '.join(f'`{key}`' for key in keys)}" for kind, keys in cells.KINDS.items()]
    return [
        "",
        "## Solids: " + ", ".join(f"[[{kind}]]" for kind in cells.KINDS) + " and [tool]",
        "",
        "What stands around the arm, and what is on its flange: the studio draws it, and `run` and `check` warn of",
        "[contacts](../how-to/contacts.md). `[tool]` and `[tool.payload]` have lists of the same solids, such as",
        "`[[tool.box]]`; `name`, `color` and `ignore` of the table hold for all of them.",
        "",
        f"Sizes: {', '.join(kinds)}.",
        "",
        "| key | |",
        "|---|---|",
        *(f"| `{key}` | {cell(text)} |" for key, text in cells.KEYS.items()),
    ]


def _row(name: str, tcp: FaultEffect, line: FaultEffect, takes: tuple[str, ...]) -> str:
    return f"| `{name}` | {_effect(tcp)} | {_effect(line)} | {', '.join(f'`{key}`' for key in takes)} |"


def _effect(effect: FaultEffect) -> str:
    return cell(effect.text) if effect.is_possible else f"refused: {cell(effect.text)}"


def _default(value: Any) -> str:
    if value in ("", None, ()) or value == {}:
        return ""
    return f"`{value!r}`" if not isinstance(value, bool) else f"`{str(value).lower()}`"


def _fields() -> list[tuple[str, Any]]:
    from dataclasses import fields

    return [(field.name, field) for field in fields(Fault)]


def _loaded(name: str) -> Any:
    module, _, attribute = name.partition(":")
    return getattr(import_module(module), attribute)


def _attributes(found: type) -> dict[str, str]:
    """What the docstrings of a class and of those below it say about attributes."""
    texts: dict[str, str] = {}
    for owner in reversed(found.__mro__):
        text = inspect.cleandoc(owner.__doc__ or "")
        _, _, rest = text.partition("Attributes:\n")
        block = re.split(r"\n\S", rest, maxsplit=1)[0]
        for entry in re.split(r"\n {4}(?=\S)", "\n" + block):
            names, colon, words = entry.partition(":")
            if colon:
                for name in names.split(","):
                    texts[name.strip()] = " ".join(words.split())
    return texts
