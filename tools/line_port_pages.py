"""Reference pages of the ports that speak lines: dashboard shell, interpreter mode, query port."""

from __future__ import annotations

from collections.abc import Iterable
from textwrap import wrap
from typing import Any

from elitescript.controller.modes import REALISTIC
from elitescript.kernel.interpreter_logs import (
    DELAY_TICKS,
    EXECUTION_NAME,
    OLD_SUFFIX,
    RECEIVED_NAME,
    SIZE_MAX,
)
from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from elitescript.messages.outcomes import ShownValue, StatementAccepted, StatementDiscarded
from elitescript.messages.profile import PLAIN
from elitescript.messages.timing import TICKS_PER_S
from elitescript.protocol import interpreter, query
from elitescript.protocol.dashboard import answers as dashboard_answers
from elitescript.protocol.dashboard import connection as dashboard
from elitescript.protocol.dashboard import guards as dashboard_guards
from elitescript.protocol.dashboard.verbs import VERBS
from tools.markdown import NOTICE, cell, code

WIDTH = 118
"""Characters of a line of prose."""
INTERPRETER_NOTES = (
    "Every line gets one reply: `ack` or `discard`, or the `state` it asks for; `skipbuffer`, `abort` and empty lines "
    "get none. A statement that was accepted may be discarded later, for one of the last three reasons. Replies come "
    "in the order of the lines; what waits for `clear_interpreter()` is answered after it.",
    "**Exceptions.** An exception that a statement does not catch leaves `interpreter_mode()` at the place of its "
    "call, and the session is over. Usually that stops the program: port 30001 gets a script exception with the line "
    "of the call and the text of the error, statements that wait get `discard: Cleaned up after end`, later ones "
    "`discard: Task is in an invalid state`. A program that catches it with `try` around the call goes on. *Assumed.*",
    "**Restart.** A statement that holds the controller up, a call into Python's own functions that does not come "
    "back, ends with it: the controller is restarted, lines that had no reply by then get the one they would get "
    "without a program, and statements that were accepted are gone without another word.",
    f"**Logs.** The task folder gets two of them: `{RECEIVED_NAME}`, every line that came with what its client was "
    f"told, and `{EXECUTION_NAME}`, the number and text of each statement when it is begun and how it ended: done, "
    f"failed, stopped with its program, or skipped. They are at most {DELAY_TICKS / TICKS_PER_S:g} s behind. One "
    f"that has reached {SIZE_MAX // 1024} KiB gets `{OLD_SUFFIX}` at the end of its name, in the place of an older "
    "one, and a new one begins. Two logs are documented; their names, form and size are assumed.",
)


def dashboard_page() -> str:
    """Commands of the dashboard shell, and the states that refuse them."""
    rows = [row for verb in VERBS.values() for row in verb]
    lines = [
        "# Dashboard shell, port 29999",
        "",
        NOTICE,
        "One command a line, ended by a line feed (a carriage return before it is tolerated); one reply each, in",
        "order, ended by CR LF and sent as one piece. On connecting, a greeting of three lines comes as one piece.",
        "",
        f"- A command has at most {dashboard.LINE_LIMIT} bytes of UTF-8. An empty line is not answered.",
        "- Commands that load, start, read or set a variable, or unlock are answered when the robot has done it or",
        f"  refused to, after {dashboard.ANSWER_TICKS // TICKS_PER_S} s at the latest; the commands behind them wait,",
        f"  at most {dashboard.WAITING_LIMIT}.",
        "- All other replies come at once; what takes long goes on and is watched with `robotMode`, `safety -s` and",
        "  `task -s`.",
        f"- `status`, and `help` and `usage` of one command, have at most {dashboard_answers.REPLY_LIMIT} bytes:",
        "  clients take one read.",
        "- `robotControl -on` with the power on, `brakeRelease` with the brakes released, `unlockProtectiveStop`",
        "  while the arm may move and `closeSafetyDialog` without a dialog have their usual reply, and nothing",
        "  happens.",
        f"- Powering on takes {REALISTIC.power_on_s + REALISTIC.boot_s:g} s ({REALISTIC.power_on_s:g} s POWER_ON, then"
        f" {REALISTIC.boot_s:g} s BOOTING),",
        f"  releasing the brakes {REALISTIC.release_s:g} s (*assumed*); clients wait 30 s for each.",
        "- `stop` stops a program that came from a port too, and `play` goes on with a paused one.",
        "",
        "Evidence: *client*, the vendor's client compares the reply with this text; *documented*, the vendor describes",
        "the command; *observed*, other clients use it; *assumed*, decided here. Refusals, help texts and the order of",
        "the lines of `status` are assumed.",
        "",
        "| command | what it does | reply | evidence |",
        "|---|---|---|---|",
        *(f"| `{cell(row.usage)}` | {cell(row.summary)} | `{cell(row.reply)}` | {row.evidence} |" for row in rows),
        "",
        "## When a command is refused",
        "",
        "The reply is the text below, a colon and the reason. Commands that are not listed are never refused. Under",
        f'local control the reason is "{dashboard_guards.LOCAL}".',
        "",
        "| command | text | robot modes that take it | safety modes that take it | task states that take it |",
        "|---|---|---|---|---|",
    ]
    for row in rows:
        if row.guard is not None:
            guard = row.guard
            states = (
                _states(guard.modes, dashboard_guards.ALL_MODES, RobotMode),
                _states(guard.safety, dashboard_guards.ALL_SAFETY, SafetyMode),
                _states(guard.tasks, dashboard_guards.ALL_TASKS, TaskState),
            )
            lines.append(f"| `{cell(row.usage)}` | {guard.failure} | {' | '.join(states)} |")
    return "\n".join(lines) + "\n"


def _states(taken: frozenset[Any], every: frozenset[Any], kind: Iterable[Any]) -> str:
    if taken == every:
        return "all"
    if len(taken) > len(every) / 2:
        return f"all but {', '.join(state.name for state in kind if state not in taken)}"
    return ", ".join(state.name for state in kind if state in taken)


def interpreter_page() -> str:
    """Interpreter mode and the query port."""
    lines = [
        "# Interpreter mode, port 30020, and the query port 40011",
        "",
        NOTICE,
        "Lines and replies end with a line feed; a carriage return before it is tolerated in what a client sends.",
        "Every reply is sent as one piece, to the client that asked and to no other.",
        "",
        "## Interpreter mode",
        "",
        "A program that calls `interpreter_mode()` stands still while statements from this port run in its place. A",
        f"line is a statement, or several parted by `;`, of at most {interpreter.LINE_LIMIT} bytes; at most",
        f"{interpreter.QUEUE_LIMIT} wait. A line with the header of a function alone begins a statement that goes on",
        "up to an `end` at the start of a line; it has one reply, and a compile error names its line (*assumed*: a",
        "sample of the vendor sends it, the manual knows one line only).",
        "",
        *(line for paragraph in INTERPRETER_NOTES for line in (*wrap(paragraph, WIDTH), "")),
        "| reply | when | evidence |",
        "|---|---|---|",
        f"| `{interpreter.reply_text(StatementAccepted(1, 'STATEMENT'))}` |"
        " The statement is accepted; numbers count from 1. | documented; the first number assumed |",
    ]
    for row in interpreter.REASONS:
        form = interpreter.reply_text(StatementDiscarded(row.reason, "STATEMENT", "TRACE"))
        lines.append(f"| `{form}` | {row.summary} | {row.evidence} |")
    lines += [
        "",
        "Words that do not wait their turn:",
        "",
        "| word | what it does | reply | evidence |",
        "|---|---|---|---|",
    ]
    for word in interpreter.WORDS.values():
        lines.append(f"| `{word.name}` | {word.summary} | {code(word.reply)} | {word.evidence} |")
    lines += [
        "",
        "## Query port",
        "",
        "`req ID STATEMENT` evaluates a quick function call by the rules of a secondary program, without disturbing",
        f"the program that runs. The id has at most {query.ID_DIGITS} digits, the blank behind it may be missing, a",
        f"line has at most {query.LINE_LIMIT} bytes; at most {query.WAITING_LIMIT} requests of a client wait.",
        "",
        "| reply | when | evidence |",
        "|---|---|---|",
        f"| `{query.reply_text('ID', ShownValue('VALUE'))}` | The value as `repr` writes it,"
        " but floats in digits alone. | observed |",
        f"| `{query.reply_text('ID', query.NOT_PARSED)}` | The statement does not compile, or is missing. |"
        " words documented, brackets assumed |",
        f"| `{query.reply_text('ID', query.NOT_EXECUTED)}` | It raised an exception, is not allowed or took too long,"
        " or too many wait. The log has the reason. | words documented, brackets assumed |",
        f"| `{query.reply_text(query.UNREADABLE_ID, query.NOT_PARSED)}` | The line is not a request. | assumed |",
        "",
        "`--query-form plain` (`query_form` in world files and in Python) is the form of version 0.1.0 and of the",
        f"vendor's article: `{query.reply_text('ID', ShownValue('VALUE'), PLAIN)}`, with floats as `repr` writes them,",
        "such as `-6.1e-17`.",
    ]
    return "\n".join(lines) + "\n"
