"""`elitescript completion`: every call is in the scripts, and bash completes with its own."""

from __future__ import annotations

import shutil
import subprocess

import pytest

from elitescript.cli import main
from elitescript.cli.arguments import COMMANDS
from elitescript.cli.completion import SHELLS, calls
from elitescript.commands.catalogue import CATALOGUE
from elitescript.models.model import model_names

BASH = shutil.which("bash")
ASK = """
source "$1"
shift
COMP_WORDS=("$@")
COMP_CWORD=$(($# - 1))
_elitescript
printf '%s\\n' "${COMPREPLY[@]}"
"""


@pytest.fixture(scope="module")
def script(tmp_path_factory):
    path = tmp_path_factory.mktemp("completion") / "elitescript.bash"
    path.write_text(SHELLS["bash"](tuple(calls())), encoding="utf-8")
    return path


@pytest.fixture
def offered(script, tmp_path):
    if BASH is None:
        pytest.skip("there is no bash")

    def ask(*words):
        command = [BASH, "--norc", "-c", ASK, "bash", str(script), "elitescript", *words]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
        assert done.stderr == ""
        return sorted(done.stdout.split())

    return ask


def parser_of(name):
    return main._parser(name)[1].choices[name]


@pytest.mark.parametrize("shell", SHELLS)
def test_every_option_of_every_command_is_in_every_script(shell, capsys):
    assert main.main(["completion", shell]) == 0
    text = capsys.readouterr().out
    for name in COMMANDS:
        assert name in text
        for action in parser_of(name)._actions:
            for flag in action.option_strings if action.help != "==SUPPRESS==" else ():
                assert (f"-l {flag[2:]}" if shell == "fish" and flag.startswith("--") else flag.lstrip("-")) in text


def test_an_unknown_shell_is_refused(capsys):
    assert main.main(["completion", "tcsh"]) == 2
    assert "'tcsh' is none of the shells: bash, zsh, fish" in capsys.readouterr().err


class TestBash:
    def test_commands(self, offered):
        assert offered("") == sorted([*COMMANDS, "--help", "--version"])
        assert offered("ch") == ["check"]
        assert offered("--v") == ["--version"]

    @pytest.mark.parametrize("name", COMMANDS)
    def test_options_are_those_of_the_parser(self, offered, name):
        shown = [action for action in parser_of(name)._actions if action.help != "==SUPPRESS=="]
        assert offered(name, "-") == sorted(flag for action in shown for flag in action.option_strings)

    def test_values(self, offered):
        assert offered("run", "--firmware", "") == ["2.10", "2.14"]
        assert offered("run", "--firmware", "=", "2.1") == ["2.10", "2.14"]
        assert offered("run", "--firmware", "=") == ["2.10", "2.14"]
        assert offered("check", "--format", "s") == ["sarif"]
        assert offered("check", "--explain", "E30") == ["E301", "E302", "E303", "E304", "E305"]
        assert offered("serve", "--robot", "") == sorted(model_names())
        assert offered("run", "--until", "") == []

    def test_words_in_their_place(self, offered):
        assert offered("completion", "") == ["bash", "fish", "zsh"]
        assert offered("completion", "bash", "") == []
        assert offered("commands", "movej") == sorted(name for name in CATALOGUE.names() if name.startswith("movej"))
        assert "popup" in offered("ctl", "")
        assert offered("ctl", "--instance", "3", "pop") == ["popup"]

    def test_files_and_folders(self, offered, tmp_path):
        (tmp_path / "cell.script").touch()
        (tmp_path / "cells").mkdir()
        assert offered("run", "ce") == ["cell.script", "cells"]
        assert offered("run", "--strict", "--until", "3", "ce") == ["cell.script", "cells"]
        assert offered("run", "--task-dir", "ce") == ["cells"]
        assert offered("check", "a.script", "b.script", "ce") == ["cell.script", "cells"]
        assert offered("run", "cell.script", "ce") == []
