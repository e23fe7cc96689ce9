"""Halves of surrogate pairs, which no encoding has: outputs x texts that hold them."""

from __future__ import annotations

import gzip
import json
import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from elitescript.cli.main import main
from elitescript.cli.output.trace_file import TraceFile
from elitescript.codec.json_text import to_text
from elitescript.conversation.recording import RecordedRun, recording
from elitescript.conversation.rows import COLUMNS
from elitescript.coverage.cobertura import cobertura
from elitescript.coverage.html_pages import html_pages
from elitescript.coverage.json_report import json_report
from elitescript.coverage.lcov import lcov
from elitescript.coverage.model import Function, Handler, ProgramCoverage
from elitescript.coverage.terminal import table
from elitescript.coverage.unmet import Unmet
from elitescript.dap.framing import framed
from elitescript.outputs.writing import Output, write_file
from elitescript.recorder.channels import PRIMARY, encoded
from elitescript.robot import VirtualRobot
from elitescript.shown import encodable
from elitescript.studio.live.link import framed as framed_for_studio
from elitescript.sweep.plans.plan import Choices, Plan, Row, Variation
from elitescript.sweep.results.tables import write_table

HALVES = {"of a program": "x \ud83d y", "the other one": "\ude00\ud83d", "byte of a name": "b\udce9d.script"}


def texts(value: Any) -> Iterable[str]:
    """Yield the texts of a value of JSON."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for name, item in value.items():
            yield from (name, *texts(item))
    elif isinstance(value, list):
        for item in value:
            yield from texts(item)


def in_json(data: str | bytes) -> str:
    """Return the texts of JSON, which must all have an encoding."""
    found = "\n".join(texts(json.loads(data)))
    assert found.encode()
    return found


def program(text: str) -> ProgramCoverage:
    return ProgramCoverage(
        text, (f"def {text}():", f"  # {text}"), {1: 1}, (), (Function(text, 1, 2, 1),), (Handler(1, text, 0),)
    )


def sweep_table(suffix: str) -> Callable[[str, Path], str]:
    def written(text: str, folder: Path) -> str:
        plan = Plan("", variations=(Variation("m", "choice", (text, "b")),), measures={})
        row = Row(Choices(0, 17, {"m": text}), text, 2.5, {}, text, None, ())
        path = folder / f"out{suffix}"
        write_table(path, plan, [row])
        if suffix == ".parquet":
            from pyarrow.parquet import read_table

            return str(read_table(path).to_pylist()[0]["m"])
        data = path.read_bytes()
        return in_json(data) if suffix == ".jsonl" else data.decode()

    return written


def page(text: str, folder: Path) -> str:
    write_file(folder / "x.html", text)
    return (folder / "x.html").read_bytes().decode()


def coverage_pages(text: str, folder: Path) -> str:
    return "\n".join(page(found, folder) for found in html_pages([program(text)], Unmet()).values())


def cobertura_of(text: str, folder: Path) -> str:
    data = cobertura([program(text)], root=text, version="1", time_ms=0)
    written = page(data, folder)
    ElementTree.fromstring(written)
    return written


def recorded(text: str, folder: Path) -> str:
    mcap = pytest.importorskip("mcap.reader")
    from elitescript.recorder.writing import RecordingFile

    file = RecordingFile(folder / "x.mcap", {"program": text})
    file.attach(text, b"", 0)
    file.note("facts", {"task": json.dumps(text)})
    file.message(PRIMARY, {"text": text}, 0, 0)
    file.close()
    with (folder / "x.mcap").open("rb") as data:
        reader = mcap.make_reader(data)
        said = [in_json(message.data) for _, _, message in reader.iter_messages()]
        names = [found.name for found in reader.iter_attachments()]
        about = [found.metadata.get("program", "") for found in reader.iter_metadata()]
    return "\n".join([*said, *names, *about])


def trace(text: str, folder: Path) -> str:
    with TraceFile(Output(folder / "x.csv"), signals=[text]) as file:
        assert file is not None
    return (folder / "x.csv").read_bytes().decode()


def page_of_runs(text: str, _: Path) -> str:
    columns = {COLUMNS[0]: (0.0, 1.0)}
    data = gzip.decompress(recording([RecordedRun([{"type": "log", "text": text}], (0, 1), columns)]))
    size = int.from_bytes(data[:4], "little")
    return in_json(data[4 : 4 + size])


def lsp(text: str, folder: Path) -> str:
    pytest.importorskip("pygls")
    from elitescript.lsp.connection import Connection

    class Writer:
        def write(self, data: bytes) -> None:
            self.data = data

    connection = Connection.__new__(Connection)
    connection.writer = writer = Writer()
    connection._send_data({"jsonrpc": "2.0", "id": 1, "result": {"contents": text}})
    return in_json(writer.data.partition(b"\r\n\r\n")[2])


OUTPUTS: dict[str, Callable[[str, Path], str]] = {
    "messages between processes, studio": lambda text, _: in_json(to_text({"text": [text]})),
    "frames of the studio": lambda text, _: in_json(framed_for_studio({"text": text})[5:]),
    "dap": lambda text, _: in_json(framed({"output": text}).partition(b"\r\n\r\n")[2]),
    "lsp": lsp,
    "rows of recordings": lambda text, _: in_json(encoded({"text": text})),
    "recording": recorded,
    "table csv": sweep_table(".csv"),
    "table jsonl": sweep_table(".jsonl"),
    "table parquet": sweep_table(".parquet"),
    "trace": trace,
    "page": page,
    "runs in a page": page_of_runs,
    "lcov": lambda text, folder: page(lcov([program(text)]), folder),
    "cobertura": cobertura_of,
    "coverage json": lambda text, _: in_json(json_report([program(text)], Unmet()).encode()),
    "coverage pages": coverage_pages,
    "coverage table": lambda text, _: "\n".join(table([program(text)])).encode().decode(),
}


@pytest.mark.parametrize("text", HALVES.values(), ids=HALVES)
@pytest.mark.parametrize("output", OUTPUTS.values(), ids=OUTPUTS)
def test_an_output_has_them_as_escapes(output: Callable[[str, Path], str], text: str, tmp_path: Path) -> None:
    if output is OUTPUTS["table parquet"]:
        pytest.importorskip("pyarrow")
    assert encodable(text) in output(text, tmp_path)


@pytest.mark.parametrize("form", ["text", "json", "github", "sarif"])
def test_names_of_files_with_other_bytes(
    form: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path(os.fsdecode(b"b\xe9d.script")).write_text("x = \n")
    assert main(["check", "--format", form, "."]) == 3
    out = capfd.readouterr().out
    if form == "sarif":
        (result,) = json.loads(out)["runs"][0]["results"]
        assert result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] == "b%E9d.script"
    elif form == "json":
        assert json.loads(out)["file"] == "b\udce9d.script"
    else:
        assert r"b\udce9d.script" in out


SAYING = r"""def job():
  class Part:
    def __repr__(self):
      return "\ud83d"
    end
  end
  global part
  part = Part()
  textmsg(part, "\ud83d")
  print("\ud83d")
  popup("\ud83d", "\ud83d", False, False)
  interpreter_mode()
end
"""


def test_no_port_of_a_robot_ends_at_them() -> None:
    robot = VirtualRobot()
    clients = {service: robot.connect(service) for service in ("primary", "dashboard", "rtsi", "interpreter", "query")}
    robot.start(SAYING)
    robot.advance(0.1)
    clients["query"].send(b"req 1 part\nreq 2 1 + 1\n")
    clients["dashboard"].send(b"popup -s \\ud83d\r\nstatus\r\n")
    clients["interpreter"].send(rb'textmsg("\ud83d")' + b"\n" + rb'raise ValueError("\ud83d")' + b"\n")
    robot.advance(0.5)
    received = {service: client.receive() for service, client in clients.items()}
    assert received["query"] == b"[1] [success] : [\\ud83d]\n[2] [success] : [2]\n"
    assert b"\\ud83d" in received["primary"]
    assert b"ack: 2: raise" in received["interpreter"]
