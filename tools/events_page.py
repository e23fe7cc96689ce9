"""The reference page of events, from their dataclasses and from the table of `--json` records."""

from __future__ import annotations

import ast
import inspect
from dataclasses import MISSING, Field, fields
from textwrap import dedent
from typing import Final, get_args

from elitescript.json_records import jsonlines
from elitescript.json_records.events import record_of
from elitescript.messages import events
from elitescript.messages.enums import SafetyMode
from elitescript.messages.events import Event
from elitescript.run import RECORDS_MAX
from elitescript.said import said
from tools.markdown import NOTICE, cell, code

COMMON: Final = {
    "tick": "When: ticks of 4 ms since the robot's start. In `--json` it is `t`, in s.",
    "text": "What is said.",
    "thread": "Name of the thread; empty if it was none of the program's.",
    "line": "Line of the program; 0 if there is none.",
}
"""Fields that mean the same in every kind of event, unless one says otherwise."""

EXAMPLES: Final[tuple[Event, ...]] = (
    events.TextMessage(301, "part 3 of 20", "main", 12),
    events.Printed(301, "part 3", "main", 13),
    events.Popup(301, "Insert a part", "Box", "info", True, True, "main", 14),
    events.Warned(
        301,
        said("{command}: {name} is {value:g} rad/s, more than any arm does", command="movej", name="v", value=60.0),
        "main",
        15,
        "W232",
        said("{value:g} looks like deg/s: d2r({value:g}) is {meant:.4f} rad/s", value=60.0, meant=1.0472),
    ),
    events.DeviceNoted(301, "camera", "trigger 4 is ignored: a picture is being taken", True),
    events.Alarm(
        301,
        "R101",
        "TypeError",
        said(
            "{command}: {name} must be a number, not {kind} {value!r}", command="sleep", name="t", kind="str", value="a"
        ),
        16,
        3,
        "main",
        '  sleep("a")',
        {
            "command": "sleep",
            "argument": "t",
            "value": "a",
            "limit": "a number",
            "unit": "s",
            "hint": "it is called as sleep(t)",
        },
    ),
    events.SignalChanged(301, "standard_digital_out[0]", True, "program", 17),
    events.ChannelActivity(301, "camera", "socket", "received", "12.5,80.0\n", 39, "main"),
    events.SafetyModeChanged(301, SafetyMode.PROTECTIVE_STOP, "the arm has met an obstacle"),
)
"""One of each kind that `--json` has."""


def events_page() -> str:
    """Every kind of event, field by field."""
    kinds = get_args(Event)
    lines = [
        "# Events",
        "",
        NOTICE,
        "What happened in a run, in order: `run.events` and `on_event` of `VirtualRobot` in Python, dataclasses of",
        "`elitescript.messages.events`; the lines of `run --json`, `serve --json` and `replay --json`. A terminal",
        "shows messages, warnings and alarms; `--log signals,channels` adds the rest. `run.events` keeps the last",
        f"{RECORDS_MAX:,} at least.",
        "",
        "Texts of warnings, alarms, devices and safety, and hints, are English. In `--json` `template` is the text",
        "with `{name}` in place of its values; `values` has them by name, as they are shown: texts and whole numbers.",
        "A text within a text is an object with `text`, `template` and `values` of its own. `hint_template` and",
        "`hint_values` are those of the hint. Braces that stand for themselves are doubled in a template. In Python",
        "such a text is a `str` with `template` and `values` (`elitescript.said.Said`); one that a program has written",
        "is a plain `str`, and its own template. `check --json` has the same for each finding.",
        "",
        "",
        "| event | is | `--json` |",
        "|---|---|---|",
    ]
    for kind in kinds:
        example = _example(kind)
        record = None if example is None else record_of(example)
        shown = "only in `run.events`" if record is None else f"`{record['type']}`"
        lines.append(f"| [`{kind.__name__}`](#{kind.__name__.lower()}) | {cell(_summary(kind)[0])} | {shown} |")
    for kind in kinds:
        first, more = _summary(kind)
        lines += ["", f"## {kind.__name__}", "", first, *(["", more] if more else [])]
        lines += ["", "| field | type | default | meaning |", "|---|---|---|---|"]
        texts = field_texts(kind)
        for field in fields(kind):
            lines.append(
                f"| `{field.name}` | {code(str(field.type))} | {_default(field)} | {cell(texts[field.name])} |"
            )
        example = _example(kind)
        if example is not None:
            lines += ["", "```json", jsonlines.line(record_of(example)), "```"]
    return "\n".join(lines) + "\n"


def field_texts(kind: type) -> dict[str, str]:
    """What each field of an event means: the text below it, or what such a field means in every kind.

    Raises:
        LookupError: nobody has said what a field means.
    """
    body = ast.parse(dedent(inspect.getsource(kind))).body[0]
    assert isinstance(body, ast.ClassDef)
    texts: dict[str, str] = {}
    name = ""
    for node in body.body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            name = node.target.id
            texts[name] = COMMON.get(name, "")
        elif name and isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            texts[name] = " ".join(str(node.value.value).split())
    for name, text in texts.items():
        if not text:
            raise LookupError(f"{kind.__name__}.{name} has no text that says what it means")
    return texts


def _summary(kind: type) -> tuple[str, str]:
    """The first sentence of an event's text, and the rest."""
    first, _, more = inspect.cleandoc(kind.__doc__ or "").partition("\n\n")
    return " ".join(first.split()), more


def _example(kind: type) -> Event | None:
    return next((event for event in EXAMPLES if type(event) is kind), None)


def _default(field: Field[object]) -> str:
    if field.default_factory is not MISSING:
        return f"`{field.default_factory()!r}`"
    return "" if field.default is MISSING else f"`{field.default!r}`"
