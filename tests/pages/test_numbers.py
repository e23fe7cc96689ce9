"""Numbers of the code that pages repeat: each sentence is made of the constants, and stands on its page."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from elitescript.client import connecting, primary, rtsi
from elitescript.conversation import limits as page_limits
from elitescript.language.limits import LINES_MAX, LONG_TEXT, MAX_UNIT_BYTES, SYMBOLS_MAX
from elitescript.messages.timing import TICKS_PER_S
from elitescript.pytest_plugin import limits as run_limits
from elitescript.runtime.environment import READ_MAX
from elitescript.runtime.threads.meter import SHARE_NS
from elitescript.runtime.threads.said import TEXT_MAX, TEXT_PER_TICK
from elitescript.services import capacity
from elitescript.services.child.supervision import HANG_LIMIT_S
from elitescript.services.child.urgent import STOP_S
from elitescript.services.clients import listener, shares, tcp
from elitescript.services.compiler import desk
from elitescript.services.control import channel
from elitescript.services.journal import writer
from elitescript.services.ssh import files as ssh_files
from elitescript.sweep.failures.shrinking import BUDGET
from elitescript.untrusted import files, json_text, toml_text

PAGES = Path(__file__).parents[2] / "docs"

_WORDS = {5: "five", 20: "twenty"}


def _mb(count: float) -> str:
    return f"{count / 1e6:g} MB"


def _mib(count: int) -> str:
    return f"{count >> 20} MiB"


SENTENCES = [
    ("explanation/jail.md", f"Programs of {LONG_TEXT:,} characters or more are compiled in a second locked process"),
    ("explanation/jail.md", f"with {desk.MEMORY_MAX >> 30} GiB of memory; it runs nothing of the text"),
    ("explanation/jail.md", f"for {shares.SHARE_NS / 1e6:g} ms of processor time in each tick of 4 ms"),
    (
        "explanation/jail.md",
        f"{_mb(files.WORLD.bytes_max)}, an arm and a profile {_mb(files.ARM.bytes_max)}; {toml_text.LINES_MAX:,} "
        f"lines, {toml_text.TOKENS_MAX:,} words and signs; {toml_text.DEPTH_MAX} brackets within each other, "
        f"{toml_text.PARTS_MAX} parts of a name, texts of {toml_text.STRING_MAX:,} and numbers of {toml_text.WORD_MAX} "
        "characters",
    ),
    (
        "explanation/jail.md",
        f"lists and objects {json_text.DEPTH_MAX} deep, numbers of {sys.int_info.default_max_str_digits:,} digits",
    ),
    (
        "explanation/jail.md",
        f"| {_mb(files.PROGRAM.bytes_max)}, {_mb(files.TRACE.bytes_max)}, {_mb(files.POINTS.bytes_max)}, "
        f"{_mib(files.MESH.bytes_max)} |",
    ),
    ("explanation/jail.md", f"a line of a journal {_mib(writer.LINE_MAX)}"),
    ("explanation/jail.md", f"`read()` without a size takes {_mib(READ_MAX)} at most"),
    ("explanation/decisions/0025-compiler.md", f"A text of {LONG_TEXT:,} characters or more"),
    ("explanation/decisions/0026-cut-by-the-clock.md", f"when its share, {SHARE_NS / 1e6:g} ms, is used up"),
    (
        "explanation/studio-source.md",
        f"a run gives a page {page_limits.EVENTS_MAX:,} events or {page_limits.BYTES_MAX >> 20} MB; of what comes "
        f"after them the alarms and the last {page_limits.LAST_EVENTS} events ({page_limits.LAST_BYTES >> 20} MB)",
    ),
    ("explanation/studio-source.md", f"a text has {page_limits.TEXT_MAX} characters at most"),
    (
        "explanation/studio-source.md",
        f"a moment has {page_limits.VARIABLES_MAX} globals of {page_limits.VARIABLES_BYTES_MAX >> 10} kB in all, and "
        f"{page_limits.THREADS_MAX} threads",
    ),
    (
        "explanation/studio-source.md",
        f"more than {primary.MESSAGES_PER_S:.0f} messages or {_mb(primary.BYTES_PER_S)} a second (primary port), "
        f"{rtsi.MESSAGES_PER_S:,.0f} or {_mb(rtsi.BYTES_PER_S)} (RTSI)",
    ),
    ("explanation/studio-source.md", f"for longer than {connecting.BURST_S:g} s, is closed"),
    ("how-to/chaos.md", f"`--shrink-runs N` ({BUDGET})"),
    ("how-to/pytest.md", f"| {run_limits.DEFAULTS[run_limits.LIMIT]:g} s |"),
    ("how-to/pytest.md", f"| {run_limits.DEFAULTS[run_limits.WALL_LIMIT]:g} s |"),
    (
        "how-to/serve.md",
        f"one object of JSON in a line of {channel.LINE_MAX >> 10} KiB at most, nested {json_text.DEPTH_MAX}",
    ),
    ("how-to/serve.md", f"leaves with {_mb(TEXT_PER_TICK * TICKS_PER_S)} a second at most"),
    ("how-to/serve.md", "A text of more than a million characters is an alarm" if TEXT_MAX == 10**6 else "changed"),
    ("how-to/serve.md", f"is ended after {HANG_LIMIT_S:g} s of processor time"),
    ("how-to/serve.md", f"the process is ended for the stop after {STOP_S * 1e3:g} ms"),
    ("how-to/serve.md", f"A program of {LONG_TEXT:,} characters or more is compiled in another locked process"),
    (
        "how-to/serve.md",
        f"Programs of up to {_mb(MAX_UNIT_BYTES)}, {LINES_MAX:,} lines and {SYMBOLS_MAX:,} words and signs are taken",
    ),
    (
        "how-to/serve.md",
        f"{_WORDS[capacity.ROBOTS_PER_CORE]} for each core in children, {_WORDS[capacity.ROBOTS_IN_PROCESS]} with "
        "`--in-process`",
    ),
    ("how-to/ssh.md", f"| clients that have not logged in | {listener.GUESTS_MAX};"),
    (
        "how-to/ssh.md",
        f"| files that clients have made | {_mib(ssh_files.BYTES_MAX)}, {ssh_files.ENTRIES_MAX} files and folders |",
    ),
    ("how-to/ssh.md", f"After {tcp.STALLED_TICKS // TICKS_PER_S} s in which it takes nothing it is cut off"),
]


@pytest.mark.parametrize(("page", "sentence"), SENTENCES)
def test_a_page_has_the_numbers_of_the_code(page: str, sentence: str) -> None:
    assert sentence in " ".join((PAGES / page).read_text("utf-8").split())


def test_the_page_of_ssh_has_the_numbers_of_the_port() -> None:
    server = pytest.importorskip("elitescript.services.ssh.server", exc_type=ImportError)
    text = (PAGES / "how-to" / "ssh.md").read_text("utf-8")
    for row in (
        f"| clients that have logged in | {server.CLIENTS_MAX};",
        f"| passwords | {server.ATTEMPTS_MAX} of a connection, a wrong one is answered after one second; "
        f"{server.LOGIN_S} s to log in |",
        f"| sessions of a client (commands, SFTP, SCP) | {server.SESSIONS_MAX} |",
        f"| open files, and open folders | {server.OPEN_MAX} of each for a client, {ssh_files.OPEN_MAX} files in all |",
        f"| bytes of one read | {server.READ_MAX >> 10} KiB;",
    ):
        assert row in text
