"""What the VS Code extension declares fits what elitescript does; its own tests are `make vscode-test`."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from elitescript import __version__
from elitescript.cli.arguments import COMMANDS
from elitescript.cli.main import main
from elitescript.kernel.options import OPTIONS
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.profile import DEFAULT_FIRMWARE, profile
from elitescript.paths import PROGRAM_SUFFIX

FOLDER = Path(__file__).parents[2] / "editors" / "vscode"
PACKAGE = json.loads((FOLDER / "package.json").read_text("utf-8"))
CONTRIBUTES = PACKAGE["contributes"]


def test_its_version_is_that_of_elitescript():
    assert PACKAGE["version"] == __version__
    lock = json.loads((FOLDER / "package-lock.json").read_text("utf-8"))
    assert lock["version"] == lock["packages"][""]["version"] == __version__


def test_the_lock_names_no_registry_and_holds_a_hash_for_each_package():
    lock = json.loads((FOLDER / "package-lock.json").read_text("utf-8"))
    packages = {name: package for name, package in lock["packages"].items() if name}
    assert packages
    for name, package in packages.items():
        assert "resolved" not in package, name
        assert package["integrity"].startswith("sha512-"), name


def test_launch_has_the_options_of_a_run_and_nothing_that_is_none():
    launch = CONTRIBUTES["debuggers"][0]["configurationAttributes"]["launch"]["properties"]
    run = {name for name, option in OPTIONS.items() if "run" in option.commands}
    own = {"program", "robot", "world", "set", "until", "taskDir", "stopOnEntry", "stopOnEnd"}
    assert set(launch) <= own | run
    assert set(launch) >= own | {"firmware", "joints", "seed", "strict", "speed"}


def test_tasks_are_commands_of_the_command_line():
    commands = CONTRIBUTES["taskDefinitions"][0]["properties"]["command"]["enum"]
    assert set(commands) <= set(COMMANDS)


def test_the_problem_pattern_reads_every_finding(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("cell.script").write_text('def a():\n  movej(vv=1)\n  print "x"\n  lost\nend\n', "utf-8")
    main(["check", "cell.script"])
    pattern = CONTRIBUTES["problemPatterns"][0]
    lines = capsys.readouterr().out.splitlines()
    found = [match for line in lines if (match := re.match(pattern["regexp"], line))]
    keys = ("file", "line", "column", "severity", "code")
    problems = check_source(
        SourceFile("cell.script", Path("cell.script").read_text("utf-8")), profile(DEFAULT_FIRMWARE)
    )
    assert [tuple(match[pattern[key]] for key in keys) for match in found] == [
        ("cell.script", str(problem.line), str(problem.column), str(problem.severity), problem.code)
        for problem in problems
    ]
    assert {match[pattern["severity"]] for match in found} == {"error", "warning"}


def test_snippets_are_laid_out_and_read_without_errors():
    from elitescript.assist.formatting import formatted

    for name, snippet in json.loads((FOLDER / "snippets" / "elitescript.json").read_text("utf-8")).items():
        text = "\n".join(snippet["body"])
        text = re.sub(r"\$\{\d+:([^}]*)\}", r"\1", text)
        text = re.sub(r"\$\d+", "pass", text) + "\n"
        assert formatted(text).text == text, name
        assert formatted(text).problems == (), name


def test_programs_are_recognised_by_their_suffix():
    assert CONTRIBUTES["languages"][0]["extensions"] == [PROGRAM_SUFFIX]
    assert f"**/*{PROGRAM_SUFFIX}" in str(PACKAGE["activationEvents"])


def test_nothing_of_other_people_is_committed():
    git = shutil.which("git")
    if git is None or not (FOLDER.parents[1] / ".git").exists():
        pytest.skip("this is no clone")
    files = subprocess.run([git, "ls-files", "."], cwd=FOLDER, capture_output=True, text=True, check=True).stdout
    assert not [
        file for file in files.splitlines() if file.startswith(("node_modules/", "dist/", "build/", "syntaxes/"))
    ]
