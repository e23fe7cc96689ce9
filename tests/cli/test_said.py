"""What programs say cannot pass for what commands say: commands x texts, from the calls of every command."""

from __future__ import annotations

import io
import json
import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from elitescript.cli import record, serve, shadow, sweep
from elitescript.cli.main import main
from elitescript.cli.output.report import LOGS, TextRunReport
from elitescript.cli.serve import ServeLog
from elitescript.messages.enums import SafetyMode, TaskState
from elitescript.messages.events import Event
from elitescript.records import replace
from elitescript.services.log import DEVICE, LogLine
from elitescript.shown import shown
from tests.cli.calls import Call, chosen, of, prepare

PLANTED = "     4.244 s  finished (robot time; 0.01 s on this computer)"
TEXTS = {
    "workflow commands": "a\n::add-mask::hello\n  ::error file=x::y\n\u3000::warning::z",
    "commands anywhere": "##[error]a ##vso[task.setvariable variable=b]c ##teamcity[d",
    "terminal": "\x1b[2J\x1b]0;title\x07 a\x08 \x9b31m \x7f",
    "own colours": "\x1b[32mfinished\x1b[0m",
    "carriage return": "a\rb\r\n",
    "direction": "a \u202e b \u2066 c \u200f",
    "false end": f"done\n{PLANTED}",
    "line ends": f"a\x0b{PLANTED}\x0c{PLANTED}\x85{PLANTED}\u2028{PLANTED}\u2029{PLANTED}\r{PLANTED}",
    "halves": "\ud83d \udce9",
    "plain": "the arm is at [0.44, 1.5] \u4e2d",
}
ALL = "\n".join(TEXTS.values())

HIDDEN = "[\x00-\x08\x0b\x0c\x0d\x0e-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u206f\ud800-\udfff]"
_HIDDEN = re.compile(HIDDEN)
_ACTS = re.compile(rf"{HIDDEN}|##\w*\[")


def harmless(out: str, *, is_github: bool = False) -> str:
    """Return what was printed; fail if anything in it acts or passes for a line of the command.

    A line that is a command of GitHub is looked at by nothing else of its runner.
    """
    found = (_HIDDEN if is_github else _ACTS).search(out)
    assert not found, ascii(out[max(0, found.start() - 60) : found.end() + 20])
    for line in out.split("\n"):
        assert is_github or not line.lstrip().startswith("::"), line
        assert not line.startswith(PLANTED), line
    return out


def hostile(program: str) -> str:
    """Return a program that says all texts, in words, as names of a thread and of a file, and stands in a comment."""
    head, _, rest = program.partition("\n")
    said = [f"textmsg({text!a})\n  print({text!a})" for text in TEXTS.values()]
    said.append(f"popup({ALL!a}, {ALL!a}, False, False)")
    return "\n  ".join([head, *said]) + f" # {_raw(ALL)}\n{rest}"


def _raw(text: str) -> str:
    """Return what can stand in a comment."""
    return re.sub("[\n\r\x0c\x00\ud800-\udfff]", " ", text)


def renamed(call: Call) -> Call:
    """Return a call whose programs, and what it writes, have names of a stranger."""
    names = {name: f"a\x1b[2J\n::error::##[x]\u202e\udce9{name}" for name in call.files if name.endswith(".script")}
    if "--case" in call.words:
        names = {}
    names |= {name: f"b\x1b[2J\n::error::##[x]\u202e\udce9{name}" for name in call.writes}
    words = tuple(names.get(word, word) for word in call.words)
    files = {names.get(name, name): text for name, text in call.files.items()}
    return call._replace(words=words, files=files)


SLOW = (
    "sweep",
    "sweep alarm",
    "audit --fit",
    "audit --page",
    "replay --trace",
    "sweep --out",
    "sweep --page",
    "sweep --minimise",
    "doctor",
    "doctor --json",
    "run --case",
)
"""Those that take longer and print what others print, too."""


def called(call: Call, folder: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Any:
    """Run a call in this process; return what it printed."""
    prepare(call, folder)
    monkeypatch.chdir(folder)
    with io.TextIOWrapper(io.BytesIO(call.input.encode())) as stdin:
        monkeypatch.setattr("sys.stdin", stdin)
        main(list(call.words))
    return capfd.readouterr()


@pytest.mark.parametrize(
    "call",
    [
        pytest.param(call, id=call.name, marks=[*marks, *([pytest.mark.slow] if call.name in SLOW else [])])
        for param in chosen(lambda call: call.ends == "itself" and not call.beside)
        for call, marks in [(param.values[0], param.marks)]
    ],
)
def test_nothing_that_a_command_prints_acts(call, tmp_path, monkeypatch, capfd):
    call = renamed(call)
    texts = {name: hostile(text) for name, text in call.files.items() if isinstance(text, str) and ".script" in name}
    call = call._replace(files={**call.files, **texts}, input=hostile(call.input) if call.input else "")
    done = called(call, tmp_path, monkeypatch, capfd)
    harmless(done.err)
    # What `fmt -` prints is the program itself.
    if "-" not in call.words[1:] or call.command != "fmt":
        harmless(done.out, is_github="github" in call.words)


@pytest.mark.parametrize("is_json", [False, True], ids=["text", "json"])
def test_a_text_is_shown_whole(is_json, tmp_path, monkeypatch, capfd):
    said = "".join(f"  textmsg({text!a})\n" for text in TEXTS.values())
    call = of("run --json" if is_json else "run")._replace(files={"moves.script": f"def p():\n{said}end\n"})
    out = harmless(called(call, tmp_path, monkeypatch, capfd).out)
    if is_json:
        rows = [json.loads(line) for line in out.splitlines()]
        assert [row["text"] for row in rows if row["type"] == "log"] == [*TEXTS.values()]
    else:
        lines = "".join(f"     0.000 s  {shown(text)}\n" for text in TEXTS.values())
        assert out.startswith(f"{lines}     0.000 s  finished")


# ---------------------------------------------------------------- every event, every line of `serve`


def filled(kind: Any, text: str) -> Any:
    """Return a record all of whose texts are one."""
    values: dict[str, Any] = {}
    for field in fields(kind):
        plain = {"str": text, "int": 1, "bool": True, "float": 1.0, "tuple[str, ...]": (text,)}.get(str(field.type))
        if plain is None and str(field.type).startswith(("dict[str", "Mapping[str")):
            plain = {"hint": text, "hints": [text]}
        values[field.name] = text if str(field.type) == "Value" else plain
    return kind(**values)


@pytest.mark.parametrize("kind", Event.__args__, ids=lambda kind: kind.__name__)
def test_no_text_of_an_event_acts(kind):
    for text in (ALL, *TEXTS.values()):
        event = filled(kind, text)
        if kind.__name__ == "SafetyModeChanged":
            event = replace(event, mode=SafetyMode.NORMAL)
        if kind.__name__ == "TaskStateChanged":
            event = replace(event, state=TaskState.STOPPED)
        out = io.StringIO()
        TextRunReport(out, out, LOGS).event(event)
        for names in (["one"], ["one", text]):
            log = ServeLog(out, out, names, is_json=False, logs=LOGS)
            log._held = None
            log.take(names[-1], event)
        harmless(out.getvalue())


@pytest.mark.parametrize("kind", [DEVICE, "client"])
def test_no_text_about_a_client_or_a_robot_acts(kind):
    out = io.StringIO()
    log = ServeLog(out, out, [ALL, "two"], is_json=False)
    log._held = None
    log.take(ALL, LogLine(ALL, 1, kind, ALL, kind != DEVICE))
    log.library(ALL)
    log.studio(ALL, "")
    log.studio(ALL, ALL)
    assert len(harmless(out.getvalue()).split("\n")) == 1 + 4 * ALL.count("\n") + 4 + ALL.count("\n")


@pytest.mark.parametrize("say", [record._say, shadow._say, sweep._note, serve._warn], ids=lambda say: say.__module__)
def test_no_text_of_a_note_acts(say, capsys):
    say(ALL)
    assert harmless(capsys.readouterr().err).count("\n| ") == ALL.count("\n")
