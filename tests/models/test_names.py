"""Names of robots that are no names: one refusal, whichever door they come through, before anything is looked for."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from elitescript import VirtualRobot
from elitescript.cli.main import main
from elitescript.errors import UsageError
from elitescript.lsp.settings import read_settings
from elitescript.mcp.worker import answer_to, requests
from elitescript.models.model import load_model
from elitescript.world_file import load_world_file

LONG = "C" * 300
NAMES = [
    ("", "there is no robot model '' (models: CS63, CS66, CS612, CS616, CS620, CS625)"),
    (LONG, "has at most 255 bytes"),
    (f"{LONG}.toml", "has at most 255 bytes"),
    ("é" * 200, "has at most 255 bytes"),
    ("a/" * 4000 + "x.toml", "the path of its file 4096 characters"),
    ("CS66\0", "one line of text: 'CS66\\x00' has '\\x00'"),
    ("CS66\0.toml", "one line of text"),
    ("CS\n66", "one line of text"),
    ("\udcff.toml", "one line of text"),
    ("a/b", "there is no robot model 'a/b'"),
    ("../models/cs66", "there is no robot model"),
    ("common", "there is no robot model 'common'"),
    ("/tmp", "there is no robot model '/tmp'"),
    ("\uff43s66", "there is no robot model"),
]
FOR_SHELLS = [name for name, _ in NAMES if "\0" not in name and "\udcff" not in name and name != "/tmp"]


@pytest.mark.parametrize(("name", "why"), NAMES)
def test_each_is_refused_with_its_reason(name, why):
    with pytest.raises(UsageError) as refused:
        load_model(name)
    assert why in str(refused.value)
    assert len(str(refused.value)) < 400
    assert "src/elitescript" not in str(refused.value)


@pytest.mark.parametrize(("name", "why"), NAMES)
def test_robots_refuse_it_too(name, why):
    with pytest.raises(UsageError) as refused:
        VirtualRobot(name)
    assert why in str(refused.value)


@pytest.mark.parametrize("name", FOR_SHELLS)
@pytest.mark.parametrize("words", [["run"], ["check"], ["plot"], ["sweep", "--runs", "1"]], ids=lambda words: words[0])
def test_commands_refuse_it_in_a_line(name, words, tmp_path, capsys):
    program = tmp_path / "a.script"
    program.write_text("def a():\n  sync()\nend\n")
    assert main([*words, str(program), "--robot", name]) == 2
    said = capsys.readouterr().err
    assert f"elitescript {words[0]}: " in said
    assert "Traceback" not in said and "Errno" not in said and "src/elitescript" not in said
    assert [path.name for path in tmp_path.iterdir()] == ["a.script"]


def test_a_folder_with_the_name_of_a_file_is_said(tmp_path):
    (tmp_path / "arm.toml").mkdir()
    with pytest.raises(UsageError, match="it is a folder, not a file"):
        load_model(tmp_path / "arm.toml")


@pytest.mark.parametrize("name", [LONG, "", f"{LONG}.toml"])
def test_world_files_refuse_it(name, tmp_path: Path):
    (tmp_path / "cell.toml").write_text(f"[robot]\nmodel = {json.dumps(name)}\n")
    with pytest.raises(UsageError, match=r"\[robot\] model: (the name of a robot|there is no robot model)"):
        load_world_file(tmp_path / "cell.toml")


@pytest.mark.parametrize(("name", "why"), NAMES[1:4])
def test_editors_and_agents_refuse_it(name, why, tmp_path):
    (said,) = read_settings({"robot": name}, None)[1]
    assert why in said
    request = {"do": "check", "name": "a.script", "text": "def a():\n  sync()\nend\n", "robot": name}
    assert why in answer_to(json.dumps(request), requests())["error"]


@pytest.mark.parametrize("name", ["CS66", "cs63", "Cs620"])
def test_capitals_do_not_matter(name):
    assert load_model(name).name == name.upper()
