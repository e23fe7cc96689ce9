"""What a page can order: the commands of a controller for it, and in which states."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from elitescript.errors import UsageError
from elitescript.messages.signals import Value, parse_signal_name
from elitescript.protocol.dashboard.connection import find_row
from elitescript.studio.connected.picture import Picture

DASHBOARD: Final[Mapping[str, tuple[str, tuple[str, ...]]]] = {
    "power_on": ("robotControl -on", ("Powering on",)),
    "power_off": ("robotControl -off", ("Powering off",)),
    "release_brakes": ("brakeRelease", ("Brake Releasing", "Brake is released")),
    "play": ("play", ("Starting task", "Starting program")),
    "resume": ("play", ("Starting task", "Starting program")),
    "pause": ("pause", ("Pausing task", "Pausing program")),
    "stop": ("stop", ("Stopping task", "Stopping program")),
    "unlock": ("unlockProtectiveStop", ("Protective stop unlocking",)),
    "close_popup": ("popup -c", ("Closing popup",)),
}
"""Dashboard command of each action, and how replies begin that are no refusal, older firmware included."""

STOPS: Final[Mapping[str, str]] = {"stop": "stop task", "robotControl -off": "power off"}
"""Dashboard commands that are always sent, whatever the state seems to be, and the same for the primary port."""

CTL: Final[Mapping[str, tuple[str, ...]]] = {
    "emergency_stop": ("estop",),
    "emergency_stop_release": ("release",),
    "safeguard_open": ("safeguard", "open"),
    "safeguard_close": ("safeguard", "closed"),
}
"""Words of `ctl` for each action that only a robot on this computer has."""

FAULTS: Final = frozenset({"disturb", "protective", "violation", "fault", "restart", "remote", "local"})
"""Verbs of `ctl` that the page may use for faults."""

SENT_NAME: Final = "studio"
"""Name of the program that a text of the editor becomes."""

GLOBALS_MAX: Final = 20
"""Variables that are asked for, once a second each."""

_OUTPUTS: Final[Mapping[str, str]] = {
    "standard_digital_out": "set_standard_digital_out({index}, {value})",
    "configurable_digital_out": "set_configurable_digital_out({index}, {value})",
    "tool_digital_out": "set_tool_digital({index}, {value})",
    "tool_voltage": "set_tool_voltage({value})",
    "output_bool_register": "write_output_boolean_register({index}, {value})",
    "output_int_register": "write_output_integer_register({index}, {value})",
    "output_float_register": "write_output_float_register({index}, {value})",
}
"""Statement that sets an output of each family."""


def refusal(line: str, picture: Picture) -> str:
    """Return why a dashboard command is refused in the present state, as the dashboard says it; empty if it is not."""
    found = find_row(line)
    if isinstance(found, str):
        return found
    guard = found[0].guard
    if guard is None:
        return ""
    return guard.refusal_in(picture.robot_mode, picture.safety_mode, picture.task_state, is_remote=picture.is_remote)


def output_program(name: str, value: Value) -> str:
    """Return the secondary program that sets an output; it runs beside whatever runs.

    Raises:
        UsageError: no such signal, or none that a program sets so.
    """
    signal, index = parse_signal_name(name)
    statement = _OUTPUTS.get(signal.name)
    if statement is None:
        what = (
            "an input: only a robot on this computer has inputs that can be set" if signal.is_input else "not settable"
        )
        raise UsageError(f"{name} is {what}")
    return f"sec studio_set():\n    {statement.format(index=index, value=value)}\nend\n"


def unit_of(text: str) -> tuple[str, int]:
    """Return the program that a controller takes for a text of the editor, and how many lines stand in front of it.

    A text that is one `def` with its `end` goes as it is; any other becomes the body of one, as on the pendant.
    """
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    flush = [line.rstrip() for line in lines if line[:1].strip() and not line.startswith("#")]
    if len(flush) == 2 and flush[0].startswith("def ") and flush[1] == "end":
        return "\n".join(lines).rstrip("\n") + "\n", 0
    inside = _lines_in_strings(text)
    body = "\n".join(line if number in inside else f"\t{line}" for number, line in enumerate(lines, 1))
    return f"def {SENT_NAME}():\n{body}\nend\n", 1


def _lines_in_strings(text: str) -> frozenset[int]:
    """Return the lines that begin within a string, which have to stay as they are."""
    from io import StringIO
    from tokenize import STRING, TokenError, generate_tokens

    found: set[int] = set()
    try:
        for token in generate_tokens(StringIO(text).readline):
            if token.type == STRING and token.end[0] > token.start[0]:
                found.update(range(token.start[0] + 1, token.end[0] + 1))
    except (TokenError, SyntaxError):
        # The controller says what is wrong with it.
        pass
    return frozenset(found)


def globals_of(text: str) -> tuple[str, ...]:
    """Return the names that a program declares `global`, in their order, at most `GLOBALS_MAX`."""
    found: dict[str, None] = {}
    for line in text.splitlines():
        word, _, names = line.strip().partition(" ")
        if word == "global":
            found |= dict.fromkeys(name.strip() for name in names.partition("#")[0].partition("=")[0].split(","))
    return tuple(name for name in found if name.isidentifier())[:GLOBALS_MAX]
