"""The commands of SSH clients as a pure function, against a table written by hand."""

from __future__ import annotations

import pytest

from elitescript.services.ssh.commands import FindBridge, Kill, Refuse, Say, StartBridge, read_command

SOCAT = (
    "bash -lc 'socat tcp-l:{port},reuseaddr,fork,nodelay file:{device},nonblock,raw,waitlock=/var/run/{lock} "
    "> /dev/null 2>&1 &'"
)
TOOL = SOCAT.format(port=54321, device="/dev/ttyTCI0", lock="tty0")


@pytest.mark.parametrize(
    ("command", "action"),
    [
        ("printenv PATH", Say("/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin\n")),
        ("bash -lc 'printenv RT_ROBOT_DATA_PATH'", Say("/opt/elite/data/\n")),
        ("ps| grep \"[s]ocat tcp-l:54321\" | awk '{print $1}'", FindBridge(54321)),
        (TOOL, StartBridge(54321, "tool")),
        (SOCAT.format(port=54322, device="/dev/ttyBoard", lock="tty1"), StartBridge(54322, "/dev/ttymxc0")),
        ("kill 2001", Kill(2001)),
    ],
)
def test_what_the_vendors_client_sends_is_known(command: str, action: object) -> None:
    assert read_command(command) == action


@pytest.mark.parametrize(
    "command",
    [
        "",
        "sh",
        "id",
        "printenv",
        "printenv HOME",
        "printenv PATH; id",
        "printenv PATH && id",
        "printenv PATH\nid",
        "printenv PATH\n",
        " printenv PATH",
        "printenv $(id)",
        "bash -lc 'printenv RT_ROBOT_DATA_PATH; id'",
        "bash -lc 'printenv RT_ROBOT_DATA_PATH' | sh",
        "bash -lc 'id'",
        "kill -9 2001",
        "kill 2001 1",
        "kill 0",
        "kill -1",
        "kill $$",
        "kill 99999999999999999999",
        "kill \uff12\uff10\uff10\uff11",
        TOOL.replace("/dev/ttyTCI0", "/etc/passwd"),
        TOOL.replace("/dev/ttyTCI0", "/dev/ttyTCI0/../sda"),
        TOOL.replace("file:/dev/ttyTCI0,nonblock", "exec:sh,nonblock"),
        TOOL.replace("tcp-l:54321", "tcp-l:54321,bind=0.0.0.0"),
        TOOL.replace("54321", "0"),
        TOOL.replace("/var/run/tty0", "/var/run/tty0;id"),
        TOOL.replace("> /dev/null", "> /etc/passwd"),
        TOOL + " id",
        "scp -t /tmp/x",
        "sftp-server",
        "x" * 5000,
    ],
)
def test_everything_else_is_refused_with_a_text(command: str) -> None:
    action = read_command(command)
    assert isinstance(action, Refuse)
    assert "no command here" in action.text or "1000 characters at most" in action.text
    assert len(action.text) < 600
