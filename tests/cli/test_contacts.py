"""Contacts on the command line: `run --world` and `check --world`."""

from __future__ import annotations

import json

import pytest

from elitescript.cli import contact_findings
from elitescript.cli.main import main

WORLD = """[[box]]
name = "table"
size = [2.0, 2.0, 0.1]
pose = [0.0, 0.0, -0.05]
[tool]
name = "gripper"
[[tool.box]]
size = [0.06, 0.06, 0.1]
pose = [0, 0, 0.05]
"""

DOWN = """def down():
  set_tcp([0, 0, 0.1, 0, 0, 0])
  movej([0, -1.5708, -1.5708, -1.5708, 1.5708, 0])
  p = get_target_tcp_pose()
  p[2] = -0.012
  movel(p, a=1, v=0.1)
end
"""

TEXT = "gripper touches table: 12.0 mm deep at 4.196 s, from 4.028 s on"


IN_A_PROCESS = contact_findings._answered


@pytest.fixture
def in_a_process(files, monkeypatch):
    """Runs are in processes of their own, as they are outside of tests."""
    monkeypatch.setattr(contact_findings, "_answered", IN_A_PROCESS)


@pytest.fixture
def files(tmp_path, monkeypatch):
    """Writes program and world; runs of `check` are in this process."""
    monkeypatch.setattr(contact_findings, "_answered", contact_findings.answer_to)

    def write(program=DOWN, world=WORLD):
        (tmp_path / "cell.toml").write_text(world)
        (tmp_path / "down.script").write_text(program)
        return str(tmp_path / "down.script"), str(tmp_path / "cell.toml")

    return write


def test_run_warns_with_line_time_and_millimetres(files, capsys):
    program, world = files()
    assert main(["run", program, "--world", world]) == 0
    assert f"     4.028 s  warning W273: line 6: {TEXT}" in capsys.readouterr().err
    assert main(["run", "--json", program, "--world", world]) == 0
    records = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    (warning,) = [record for record in records if record["type"] == "warning"]
    assert (warning["t"], warning["line"], warning["code"], warning["text"]) == (4.028, 6, "W273", TEXT)


def test_check_has_the_same_as_a_finding_on_the_line(files, capsys):
    program, world = files()
    assert main(["check", "--json", program, "--world", world]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    record = json.loads(line)
    assert (record["code"], record["severity"], record["line"], record["column"]) == ("W273", "warning", 6, 3)
    assert record["text"] == TEXT


@pytest.mark.usefixtures("in_a_process")
def test_the_run_of_check_has_a_process_of_its_own(files, capsys):
    program, world = files(DOWN.replace("set_tcp", "print(3)\n  set_tcp"))
    assert main(["check", program, "--world", world]) == 0
    assert "warning W273: gripper touches table: 12.0 mm deep" in capsys.readouterr().out


@pytest.mark.usefixtures("in_a_process")
def test_a_step_that_does_not_end_is_killed(files, capsys, monkeypatch):
    monkeypatch.setattr(contact_findings, "WALL_S", 0.1)
    monkeypatch.setattr(contact_findings, "GRACE_S", 0.4)
    program, world = files(program="n = 9 ** 9 ** 9\n")
    assert main(["check", program, "--world", world]) == 0
    expected = f"{program}: not run for contacts: a step of the program did not end within 0.5 s"
    assert expected in capsys.readouterr().err


def test_check_without_solids_runs_nothing(files, capsys, monkeypatch):
    program, world = files(world='[robot]\nmodel = "CS66"\n')
    monkeypatch.setattr(contact_findings, "contact_findings", lambda *_: pytest.fail("ran"))
    assert main(["check", program, "--world", world]) == 0
    assert "0 warnings" in capsys.readouterr().err


def test_a_program_with_errors_is_not_run(files, capsys, monkeypatch):
    program, world = files(program="def a():\n  foo(\nend\n")
    monkeypatch.setattr(contact_findings, "contact_findings", lambda *_: pytest.fail("ran"))
    assert main(["check", program, "--world", world]) == 3


def test_a_comment_hides_the_finding(files, capsys):
    program, world = files(program=DOWN.replace("v=0.1)", "v=0.1)  # check: ignore[W273]"))
    assert main(["check", program, "--world", world]) == 0
    assert "0 warnings" in capsys.readouterr().err


def test_an_endless_program_is_cut_off_and_says_so(files, capsys, monkeypatch):
    monkeypatch.setattr(contact_findings, "UNTIL_S", 2.0)
    program, world = files(program="while True:\n  sync()\nend\n")
    assert main(["check", program, "--world", world]) == 0
    assert (
        f"{program}: contacts are known up to 2.000 s of robot time: the run was cut off there"
        in capsys.readouterr().err
    )


def test_wall_time_is_bounded(files, capsys, monkeypatch):
    monkeypatch.setattr(contact_findings, "WALL_S", 0.0)
    program, world = files()
    assert main(["check", program, "--world", world]) == 0
    assert "the run was cut off there" in capsys.readouterr().err


def test_a_program_that_needs_the_network_ends_where_it_connects(files, capsys):
    program, world = files(program='def a():\n  rpc_factory("xmlrpc", "http://192.168.1.9:8000").go()\nend\n')
    assert main(["check", program, "--world", world]) == 0
    assert "the run ended there by alarm R133 in line 2" in capsys.readouterr().err
    program, world = files(world='[world]\nnetwork = "real"\n' + WORLD)
    assert main(["check", program, "--world", world]) == 0
    assert "not run for contacts: its world leads to the network" in capsys.readouterr().err


def test_nothing_is_written_beside_the_program(files, tmp_path, capsys):
    text = 'def a():\n  f = open("out.txt", "w")\n  f.write(open("in.txt").read())\n  f.close()\nend\n'
    program, world = files(program=text)
    (tmp_path / "in.txt").write_text("x")
    assert main(["check", program, "--world", world]) == 0
    assert "known up to" not in capsys.readouterr().err
    assert not (tmp_path / "out.txt").exists()
