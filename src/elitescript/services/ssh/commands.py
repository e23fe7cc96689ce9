"""The commands that SSH clients may send: exact forms in a table. There is no shell, and nothing here reaches one."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Final

from elitescript.records import NamedTuple

COMMAND_MAX: Final = 1000
"""Characters of a command."""

NO_SUCH_COMMAND: Final = 127
"""Exit status of what is not in the table, as of a shell that finds no program."""

PATH: Final = "/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin"
"""Value of the variable PATH (*assumed*)."""

DATA_PATH: Final = "/opt/elite/data/"
"""Value of RT_ROBOT_DATA_PATH (*assumed*); clients put the path of the log behind it without a slash."""

DEVICES: Final = {"/dev/ttyTCI0": "tool", "/dev/ttyBoard": "/dev/ttymxc0"}
"""Serial ports of the robot, by the devices that the vendor's client bridges."""


class Say(NamedTuple):
    """Answer with a text."""

    text: str


class FindBridge(NamedTuple):
    """Say the process number of the bridge at a TCP port; nothing if there is none."""

    port: int


class StartBridge(NamedTuple):
    """Carry a serial port at a TCP port."""

    port: int
    device: str
    """Of the robot: see `DEVICES`."""


class Kill(NamedTuple):
    """End a bridge."""

    number: int


class Refuse(NamedTuple):
    """Answer with an error text and `NO_SUCH_COMMAND`."""

    text: str


Action = Say | FindBridge | StartBridge | Kill | Refuse


class SshCommand(NamedTuple):
    """One form of a command."""

    pattern: re.Pattern[str]
    """Matches the whole command."""
    action: Callable[[re.Match[str]], Action]
    form: str
    """As documentation shows it."""
    effect: str
    """What it does, in words."""


_NUMBER: Final = r"([1-9][0-9]{0,6})"

COMMANDS: Final = (
    SshCommand(re.compile("printenv PATH"), lambda _: Say(PATH + "\n"), "printenv PATH", "prints the value"),
    SshCommand(
        re.compile("bash -lc 'printenv RT_ROBOT_DATA_PATH'"),
        lambda _: Say(DATA_PATH + "\n"),
        "bash -lc 'printenv RT_ROBOT_DATA_PATH'",
        "prints the value",
    ),
    SshCommand(
        re.compile(r'ps ?\| ?grep "\[s\]ocat tcp-l:' + _NUMBER + r"\" \| awk '\{print \$1\}'"),
        lambda match: FindBridge(int(match[1])),
        "ps| grep \"[s]ocat tcp-l:PORT\" | awk '{print $1}'",
        "prints the number of the bridge at that port",
    ),
    SshCommand(
        re.compile(
            "bash -lc 'socat tcp-l:" + _NUMBER + r"(?:,[a-z]{1,20}){0,8} file:(/dev/ttyTCI0|/dev/ttyBoard)"
            r"(?:,[a-z0-9=/]{1,40}){0,8}(?: > /dev/null 2>&1)? &'"
        ),
        lambda match: StartBridge(int(match[1]), DEVICES[match[2]]),
        "bash -lc 'socat tcp-l:PORT,... file:/dev/ttyTCI0|/dev/ttyBoard,... &'",
        "carries the serial port of the tool or of the control box at that TCP port",
    ),
    SshCommand(re.compile("kill " + _NUMBER), lambda match: Kill(int(match[1])), "kill NUMBER", "ends a bridge"),
)


def read_command(command: str) -> Action:
    """Return what a command asks for; nothing is done."""
    if len(command) > COMMAND_MAX:
        return Refuse(f"a command has {COMMAND_MAX} characters at most, not {len(command)}\n")
    for row in COMMANDS:
        if match := row.pattern.fullmatch(command):
            return row.action(match)
    shown = command if len(command) <= 80 else command[:80] + "..."
    return Refuse(
        f"elitescript: {shown!r} is no command here. This is no shell; see docs/how-to/ssh.md for what there is.\n"
    )
