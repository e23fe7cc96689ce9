"""Damaged files of every kind are read, or refused in one sentence, soon; nothing else happens."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import pytest

from elitescript.audit.fit.pairs import points_of_file
from elitescript.commands.micro_file import read_points
from elitescript.conversation.messages import MessageError, ask_of, read_message
from elitescript.dap.framing import Decoder, Malformed
from elitescript.environment.program_file import source_of
from elitescript.environment.state_file import StateFile
from elitescript.errors import ProgramError, ScriptError, UsageError
from elitescript.kernel import RobotOptions
from elitescript.language.parser import parse
from elitescript.models.model import load_model_file
from elitescript.plotting.trace_reader import read_trace
from elitescript.recorder.mcap_file import read_recording
from elitescript.recorder.writing import write_recording
from elitescript.robot import VirtualRobot
from elitescript.services.journal.replay import Replay
from elitescript.services.journal.writer import JournalReader
from elitescript.shown import shown
from elitescript.sweep.chaos.profile import read_profile
from elitescript.sweep.failures.cases import read_case
from elitescript.untrusted.escaping import markdown_text
from elitescript.untrusted.files import PROFILE, read_text
from elitescript.world_file import load_world_file
from tests.recorder.test_mcap_file import recording
from tests.untrusted.mutations import mutated

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
JOURNALS = Path(__file__).resolve().parents[1] / "services" / "journals"

REFUSALS = (UsageError, ProgramError, ScriptError, MessageError)
SHORT, LONG = 10, 400
LONGEST_S = 0.5
"""CPU time for one file."""

CASE = b"""program = "a.script"
digest = "0123456789abcdef"
run = 3
seed = 4
until_s = 60.0
settings = ["standard_digital_in[3]=true"]
[options]
robot = "CS66"
[set]
height = 0.3
[[fault]]
kind = "delay"
on = "camera"
at_s = 1.0
for_s = 2.0
[expect]
property = "state == 'finished'"
state = "alarm"
code = "R100"
line = 4
text = "x"
"""
PROFILE_TEXT = b"most = 3\n[rates]\ndelay = 0.5\nbreak = 0.1\n"
STATE = b'{"format": "elitescript state", "version": 1, "signals": {"output_int_register[5]": 3}}'
POINTS = b'[{"q": [0, -1.5, -1.6, -1.5, 1.5, 0], "pose": [0.4, 0.2, 0.3, 3.1, 0, 0], "tcp": [0, 0, 0.1, 0, 0, 0]}]'
MICRO = b"# points\n0 0 0 0 0 0\n0.1, 0, 0, 0, 0, 0\n" * 20
REQUEST = b'{"type": "run", "ask": 3, "text": "movej([0,0,0,0,0,0])", "options": {"model": "CS66", "seed": 3}}'
FRAME = b'Content-Length: 60\r\n\r\n{"seq": 1, "type": "request", "command": "x", "arguments": {}}'


def read_journal(path: Path) -> None:
    reader = JournalReader(path)
    for _ in Replay(reader, 50).outputs():
        pass


def read_state(path: Path) -> None:
    StateFile(path).load()


def read_text_of_program(path: Path) -> None:
    source = source_of(path)
    assert "\x1b" not in shown(source.text)
    markdown_text(source.text)
    parse(source)


def read_request(path: Path) -> None:
    data = path.read_bytes()
    ask_of(data)
    read_message(data)


def read_frame(path: Path) -> None:
    for found in Decoder().feed(path.read_bytes()):
        assert isinstance(found, dict | Malformed)


Reader = Callable[[Path], object]

KINDS: dict[str, tuple[str, bytes | str, Reader]] = {
    "world": ("w.toml", "camera_picking.toml", lambda path: load_world_file(path, is_trusted=False)),
    "world of solids": ("w.toml", "tray_cell.toml", lambda path: load_world_file(path, is_trusted=False)),
    "arm": ("a.toml", "my_arm.toml", load_model_file),
    "case": ("a.case.toml", CASE, read_case),
    "profile": ("p.toml", PROFILE_TEXT, lambda path: read_profile(read_text(path, PROFILE), "p.toml")),
    "state": ("s.json", STATE, read_state),
    "points": ("p.json", POINTS, lambda path: points_of_file(read_text(path, PROFILE), "p.json")),
    "points of lines": (
        "p.csv",
        b"q1,q2\n" + b"0,-1.5,-1.6,-1.5,1.5,0,0.4,0.2,0.3,3.1,0,0\n" * 3,
        lambda path: points_of_file(read_text(path, PROFILE), "p.csv"),
    ),
    "path": ("p.txt", MICRO, lambda path: read_points(path.read_bytes(), "p.txt", is_cartesian=False, is_degrees=True)),
    "program": ("p.script", "tray_cell.script", read_text_of_program),
    "request of a page": ("r.json", REQUEST, read_request),
    "message of a debugger": ("r.json", FRAME, read_frame),
    "journal": ("j", "", read_journal),
    "recording": ("r.mcap", "", read_recording),
    "trace": ("t.csv", "", read_trace),
    "trace of records": ("t.jsonl", "", read_trace),
}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """Files that the product writes."""
    from elitescript.cli.main import main

    folder = tmp_path_factory.mktemp("made")
    program = folder / "p.script"
    program.write_text("movej([0,-1.5,-1.6,-1.5,1.5,0])\n")
    traces = {}
    for name in ("t.csv", "t.jsonl"):
        assert main(["run", str(program), "--trace", str(folder / name), "--step", "0.5"]) == 0
        traces[name] = (folder / name).read_bytes()
    write_recording(folder / "r.mcap", recording(120))
    journal = next(JOURNALS.iterdir()).read_bytes().split(b"\n")
    return {
        "trace": traces["t.csv"],
        "trace of records": traces["t.jsonl"],
        "recording": (folder / "r.mcap").read_bytes(),
        "journal": b"\n".join([*journal[:12], b""]),
    }


def good(kind: str, made: dict[str, bytes]) -> bytes:
    content = KINDS[kind][1]
    if isinstance(content, bytes):
        return content
    return (EXAMPLES / content).read_bytes() if content else made[kind]


@pytest.mark.parametrize(
    "seeds", [range(SHORT), pytest.param(range(SHORT, SHORT + LONG), marks=pytest.mark.slow)], ids=["some", "many"]
)
@pytest.mark.parametrize("kind", KINDS)
def test_a_damaged_file_is_read_or_refused(
    kind: str, seeds: range, made: dict[str, bytes], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name, _, read = KINDS[kind]
    data = good(kind, made)
    path = tmp_path / name
    wrong = []
    for seed in seeds:
        path.write_bytes(mutated(data, seed))
        begin = time.process_time()
        try:
            read(path)
        except REFUSALS as error:
            words = str(error)
            if not words or len(words) > 5_000 or "set_int_max" in words:
                wrong.append(f"seed {seed}: {words[:300]!r}")
        except Exception as error:
            wrong.append(f"seed {seed}: {type(error).__name__}: {error!s:.200}")
        if (took := time.process_time() - begin) > LONGEST_S:
            wrong.append(f"seed {seed}: {took:.1f} s")
    assert wrong == []


def test_the_good_files_are_read(made: dict[str, bytes], tmp_path: Path) -> None:
    """Else nothing is tried but a first refusal."""
    for kind in (
        "world",
        "world of solids",
        "arm",
        "state",
        "points",
        "points of lines",
        "path",
        "program",
        "recording",
    ):
        name, _, read = KINDS[kind]
        (tmp_path / name).write_bytes(good(kind, made))
        read(tmp_path / name)
    assert VirtualRobot(world=str(EXAMPLES / "part_counter.toml")) is not None
    assert RobotOptions() is not None
