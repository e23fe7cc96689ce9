"""`check --baseline`: what is known is left out, what is new is found."""

import json

import pytest

from elitescript.cli.main import main

OLD = "def f():\n  movej([90, 0, 0, 0, 0, 0])\n  texmsg(1)\nend\n"


@pytest.fixture
def check(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def call(text, *options):
        (tmp_path / "job.script").write_text(text, encoding="utf-8")
        code = main(["check", "job.script", "--json", "--baseline", "known.json", *options])
        out, err = capsys.readouterr()
        return code, [json.loads(line)["code"] for line in out.splitlines()], err

    return call


def test_the_first_call_writes_and_later_ones_leave_out_what_is_known(check, tmp_path):
    code, found, err = check(OLD)
    assert (code, found) == (0, [])
    assert "written to known.json" in err
    written = (tmp_path / "known.json").read_bytes()
    code, found, err = check(f"# moved\n\n{OLD}")
    assert (code, found) == (0, [])
    assert "known in known.json left out" in err
    assert (tmp_path / "known.json").read_bytes() == written


def test_what_is_new_or_once_more_is_found(check):
    check(OLD)
    assert check(OLD.replace("end\n", "  texmsg(1)\n  texmsg(2)\nend\n"))[:2] == (3, ["E301", "E301"])


def test_errors_of_the_text_are_never_left_out(check):
    assert check("def f():\n  x = = 1\nend\n")[:2] == (3, ["E001"])
    assert check("def f():\n  x = = 1\nend\n")[:2] == (3, ["E001"])


@pytest.mark.parametrize("text", ["", "{}", "[1]", '{"elitescript_baseline": 1, "findings": [1]}', "{"])
def test_another_file_is_refused(check, tmp_path, text):
    (tmp_path / "known.json").write_text(text)
    code, found, err = check(OLD)
    assert (code, found) == (2, [])
    assert "is no baseline" in err
    assert (tmp_path / "known.json").read_text() == text


def test_ignored_codes_are_left_out_but_not_what_keeps_a_program_from_starting(tmp_path, capsys):
    path = tmp_path / "job.script"
    path.write_text(OLD)
    assert main(["check", str(path), "--ignore", "E301,W230,E305"]) == 0
    assert "0 errors, 0 warnings" in capsys.readouterr().err
    assert main(["check", str(path), "--ignore", "E001"]) == 2
