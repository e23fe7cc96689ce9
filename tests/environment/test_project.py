"""`[tool.elitescript]` of the nearest pyproject.toml above a program."""

import pytest

from elitescript.cli.main import main
from elitescript.environment.project import project_ignore
from elitescript.errors import UsageError
from elitescript.paths import file_above


def put(folder, text):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "pyproject.toml").write_text(text, encoding="utf-8")
    return folder


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        ("", ""),
        ("[tool.black]\nline-length = 100\n", ""),
        ("[tool.elitescript]\n", ""),
        ('[tool.elitescript]\nignore = ["W230", "N280"]\n', "W230,N280"),
        ('[tool]\nelitescript = { ignore = ["W230"] }\n', "W230"),
    ],
)
def test_codes(tmp_path, text, codes):
    put(tmp_path, text)
    (tmp_path / "cell" / "deep").mkdir(parents=True)
    found = file_above(str(tmp_path / "cell" / "deep"), "pyproject.toml")
    assert found == str(tmp_path / "pyproject.toml")
    assert project_ignore(found) == codes


def test_the_nearest_counts_alone(tmp_path):
    put(tmp_path, '[tool.elitescript]\nignore = ["W230"]\n')
    assert file_above(str(put(tmp_path / "cell", "")), "pyproject.toml") == str(tmp_path / "cell" / "pyproject.toml")


@pytest.mark.parametrize(
    "text", ['[tool.elitescript]\nignore = "W230"\n', "[tool.elitescript]\nignore = [1]\n", "[tool]\nelitescript = 1\n"]
)
def test_mistakes_name_the_file(tmp_path, text):
    with pytest.raises(UsageError, match=r"pyproject\.toml"):
        project_ignore(str(put(tmp_path, text) / "pyproject.toml"))


def test_check_and_run_take_it_and_an_option_wins(tmp_path, capsys):
    put(tmp_path, '[tool.elitescript]\nignore = ["W230"]\n')
    program = tmp_path / "job.script"
    program.write_text("def f():\n  if False:\n    movej([90, 0, 0, 0, 0, 0])\n  end\nend\n")
    assert main(["check", str(program)]) in (0, 3)
    assert "W230" not in capsys.readouterr().out
    main(["check", str(program), "--ignore", "W235"])
    assert "W230" in capsys.readouterr().out
    main(["run", str(program)])
    assert "W230" not in capsys.readouterr().err


def test_a_code_that_is_none_is_refused(tmp_path, capsys):
    program = put(tmp_path, '[tool.elitescript]\nignore = ["W9"]\n') / "job.script"
    program.write_text("sync()\n")
    assert main(["run", str(program)]) == 2
    assert "pyproject.toml" in capsys.readouterr().err
