"""`elitescript ctl`: operates a robot that `elitescript serve` serves on this computer."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from elitescript.cli.output.remedies import with_verbs
from elitescript.environment.start_values import parse_settings
from elitescript.errors import UsageError, did_you_mean
from elitescript.json_records import jsonlines
from elitescript.services.control.channel import PLAY, address_of, ask
from elitescript.services.control.verbs import VERBS
from elitescript.shown import shown

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

REFUSED = 1
"""Exit code when the robot refuses."""


def ctl(options: argparse.Namespace) -> int:
    """Send a verb to a served robot; return the exit code."""
    if options.verb == "help":
        print(help_text())
        return 0
    verb = VERBS.get(options.verb)
    if verb is None:
        raise UsageError(
            f"there is no verb {options.verb!r}{did_you_mean(options.verb, VERBS)}; there are {', '.join(VERBS)}"
        )
    if options.wait and verb.name != PLAY:
        raise UsageError(f"--wait goes with {PLAY}, not with {verb.name}")
    _check_count(verb.usage, verb.argument, options.arguments)
    arguments: list[str] = list(options.arguments)
    values: dict[str, Any] = {}
    if verb.name == "set":
        values, presets = parse_settings(arguments, "set")
        if presets:
            raise UsageError(f"{min(presets)!r} is no signal; `elitescript ctl get` shows names")
        arguments = []
    path = Path(options.socket) if options.socket else address_of(options.instance)
    answer = ask(path, verb.name, arguments, values, waits=options.wait)
    if options.json:
        print(jsonlines.line(answer))
    elif answer["ok"]:
        for line in answer_lines(answer):
            print(shown(line))
    else:
        print(f"elitescript ctl: {shown(with_verbs(answer['error']))}", file=sys.stderr)
    return 0 if answer["ok"] else REFUSED


def answer_lines(answer: dict[str, Any]) -> list[str]:
    """Return an answer as lines of text."""
    if "result" not in answer:
        return [str(answer.get("text", "done"))]
    result: dict[str, Any] = answer["result"]
    lines = []
    for name, value in result.items():
        if isinstance(value, dict) and isinstance(clients := value.get("clients"), list):
            peers = ", ".join(f"{client['origin']} from {client['peer']}" for client in clients)
            lines.append(f"{name} {value['port']}: {peers or 'no clients'}")
        else:
            lines.append(f"{name} = {_text(value)}")
    return lines or ["everything is at its default"]


def help_text() -> str:
    """Return the list of verbs."""
    width = max(len(verb.usage) for verb in VERBS.values())
    lines = []
    for verb in VERBS.values():
        lines.append(f"{verb.usage:<{width}}  {verb.summary}")
        lines += [f"{'':<{width}}  {line}" for line in verb.details()]
    return "\n".join(lines)


def _check_count(usage: str, argument: str, given: list[str]) -> None:
    if given and not argument:
        raise UsageError(f"{usage} takes no argument, but {given[0]!r} follows")
    if not given and argument and not argument.startswith("["):
        raise UsageError(f"write {usage}")


def _text(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        return "[" + ", ".join(_text(item) for item in value) + "]"
    if isinstance(value, dict):
        return ", ".join(f"{name} {_text(item)}" for name, item in value.items())
    return str(value).lower() if isinstance(value, bool) else str(value) or "-"
