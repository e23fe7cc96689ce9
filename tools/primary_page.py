"""The reference page of the primary port, from its tables."""

from __future__ import annotations

from collections.abc import Sequence

from elitescript.protocol.binary import Field
from elitescript.protocol.primary import connection as primary
from elitescript.protocol.primary import messages as primary_messages
from elitescript.protocol.primary.commands import COMMANDS
from elitescript.protocol.primary.messages import HEAD, KINDS, MAX_TEXT_BYTES, MessageKind
from elitescript.protocol.primary.packets import STATE_SIZE, SUB_MESSAGES, SubMessage
from tools.markdown import NOTICE, anchor, cell


def primary_page() -> str:
    """Ports, messages and commands of the primary port and its relatives."""
    lines = [
        "# Primary port",
        "",
        NOTICE,
        "Robot state and messages go out, programs and plain commands come in. Numbers are big-endian. `@` is the",
        "offset in bytes from the first byte of the message or sub-message, its head included.",
        "",
        "*documented*: in the vendor's client code or pages; *observed*: in other public clients; *assumed*: decided",
        "here.",
        "",
        "## Ports",
        "",
        "| port | name | states in a second | messages | programs | evidence | what it does |",
        "|---:|---|---:|---|---|---|---|",
    ]
    for port in primary.PORTS:
        does = " | ".join("yes" if what else "no" for what in (port.sends_messages, port.takes_programs))
        lines.append(f"| {port.number} | {port.name} | {port.rate} | {does} | {port.evidence} | {port.summary} |")
    lines += [
        "",
        "The first state comes at once, the others on ticks that all clients share. Robot messages leave at least",
        f"{primary.SPACING_TICKS} ticks apart, in their order. {primary_messages.WAITING_MAX} may wait for a client;",
        f"errors, starts and ends may until {primary_messages.VITAL_MAX} wait. What comes then is left out, and a text",
        "in its place says how many messages are missing.",
        "",
        "## Robot state",
        "",
        f"A head of 5 bytes (length, type 16), then {len(SUB_MESSAGES)} sub-messages in this order; {STATE_SIZE} bytes",
        "together.",
        "",
        "| sub-message | type | bytes | evidence for the type |",
        "|---|---:|---:|---|",
    ]
    lines += [
        f"| [{part.name}](#{anchor(part.name)}) | {part.number} | {part.size} | {part.evidence} |"
        for part in SUB_MESSAGES
    ]
    for part in SUB_MESSAGES:
        lines += _sub_message_section(part)
    lines += [
        "",
        "## Robot messages",
        "",
        "Type 20. All begin with the same head. The last text of a message goes to its end, is cut at",
        f"{MAX_TEXT_BYTES} bytes, and has a zero byte behind it (*assumed*); a text before it has its length in front,",
        "one byte.",
        "",
        *_field_table(HEAD, 0),
    ]
    for kind in KINDS:
        lines += _message_section(kind)
    lines += [
        "",
        "## What comes in",
        "",
        "A text stream. `def name():` to `end` at the start of a line is a program and replaces the one that runs;",
        "`sec name():` to `end` runs beside it; any other line is a program of its own or one of the plain commands",
        "below. Nothing is answered but what goes wrong. An `end` or a line without a line feed counts after",
        f"{primary.SILENCE_TICKS} ticks without a byte, or when the client closes; a program that is still open then",
        "is refused. Of what replaces a program one begins in a tick; it runs to its first wait or the end of its",
        "share of the tick before the next one replaces it (*assumed*), so that no line is lost. Commands and",
        f"secondary programs come by {primary.UNITS_PER_TICK} in a tick. A command waits behind the lines that its own",
        "client has sent before it; the stop of another client, such as the dashboard, acts at once, and the log names",
        "what it keeps from running. In local control everything is refused (*assumed*).",
        "A program without its end is a script exception for the client and a line",
        "of the log. What is refused for another reason is a warning: a line of the log, and a robot error of level 1",
        "for every client (*assumed*). Bytes that cannot be script are thrown away, with one warning for each burst",
        "that says how many there were.",
        "",
        "| plain command | what the vendor's client watches afterwards |",
        "|---|---|",
    ]
    for command in COMMANDS:
        argument = " F" if command.takes_fraction else ""
        lines.append(f"| `{command.words}{argument}` | {command.confirmation} |")
    return "\n".join([*lines, "", "F is a fraction from 0 to 1, such as 0.50."]) + "\n"


def _sub_message_section(part: SubMessage) -> list[str]:
    lines = ["", f"### {part.name.capitalize()}", "", f"Type {part.number}, {part.size} bytes."]
    if part.repeats > 1:
        record = (part.size - 5) // part.repeats
        lines += ["", f"{part.repeats} records of {record} bytes, one for each joint; offsets are those of the first."]
    return [*lines, "", *_field_table([row.field for row in part.rows], part.offsets()[0])]


def _message_section(kind: MessageKind) -> list[str]:
    own = kind.fields.fields[len(HEAD) :]
    lines = [
        "",
        f"### {kind.name.capitalize()}",
        "",
        f"Kind {kind.number}, {kind.evidence}. Sent for: {kind.summary}.",
        "",
    ]
    if own:
        lines += [*_field_table(own, kind.fields.offsets()[len(HEAD)]), ""]
    return [*lines, f"Then: {', '.join(kind.texts)}."]


def _field_table(fields: Sequence[Field], first: int) -> list[str]:
    lines = ["| @ | type | field | unit | evidence | |", "|---:|---|---|---|---|---|"]
    at = first
    for field in fields:
        cells = (at, field.type.name, field.name, field.unit, field.evidence, cell(field.summary))
        lines.append("| " + " | ".join(map(str, cells)) + " |")
        at += field.type.size
    return lines
