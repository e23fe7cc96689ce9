"""Coverage of programs in a session: where it is collected, what reports say, what they refuse."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

CELL = """def cell():
  global count
  # nothing runs here
  count = 0
  def risky(n):
    if n > 1:
      movel([n, 0, 0, 0, 0, 0])
    end
  end
  while count < 3:
    try:
      risky(count)
    except RuntimeError:
      textmsg("refused")
    except ValueError:
      textmsg("never")
    end
    count = count + 1
  end
  textmsg("over")
end
"""
LCOV = """TN:
SF:programs/cell.script
FN:5,risky
FNDA:3,risky
FNF:1
FNH:1
BRDA:6,0,0,1
BRDA:6,0,1,2
BRDA:10,0,0,3
BRDA:10,0,1,1
BRF:4
BRH:4
DA:4,1
DA:5,1
DA:6,3
DA:7,1
DA:10,1
DA:11,3
DA:12,3
DA:14,1
DA:16,0
DA:18,3
DA:20,1
LF:11
LH:10
end_of_record
"""
"""Of one run of `CELL`, counted by hand."""


def times(text: str, count: int) -> str:
    """Return a tracefile with all counts of lines, branches and calls that many times as large."""
    rows = []
    for row in text.splitlines(keepends=True):
        kind, _, values = row.partition(":")
        parts = values.rstrip("\n").split(",")
        if kind in ("DA", "BRDA"):
            parts[-1] = str(int(parts[-1]) * count)
        elif kind == "FNDA":
            parts[0] = str(int(parts[0]) * count)
        rows.append(f"{kind}:{','.join(parts)}\n" if values else row)
    return "".join(rows)


@pytest.fixture
def cell(pytester):
    """Make a project of a program, and one that no test runs."""
    folder = pytester.mkdir("programs")
    (folder / "cell.script").write_text(CELL)
    (folder / "unused.script").write_text("def unused():\n  sleep(1)\nend\n")
    return folder


def run(pytester: pytest.Pytester, text: str, *words: str) -> pytest.RunResult:
    """Run one test file."""
    pytester.makepyfile(test_cell=text)
    return pytester.runpytest_inprocess("-p", "no:cacheprovider", *words)


HERE = "def test_here(robot):\n    robot.run('programs/cell.script').check()\n"
COMMAND = (
    "import subprocess, sys\n"
    "def test_child():\n"
    "    command = [sys.executable, '-m', 'elitescript', 'run', 'programs/cell.script']\n"
    "    subprocess.run(command, check=True, capture_output=True)\n"
)
SERVED = (
    "import socket\n"
    "def test_served(served_robot):\n"
    "    with open('programs/cell.script', 'rb') as program, socket.create_connection(\n"
    "        (served_robot.host, served_robot.ports['primary'])\n"
    "    ) as primary:\n"
    "        primary.sendall(program.read())\n"
    "        served_robot.wait_for('log', text='over')\n"
)


class TestCollecting:
    @pytest.mark.parametrize("test", [HERE, COMMAND, SERVED], ids=["here", "command", "served"])
    def test_lines_branches_and_functions_have_true_counts(self, pytester, cell, test):
        result = run(pytester, test, "--script-cov", "--script-cov-report=lcov:out/lcov.info")
        result.assert_outcomes(passed=1)
        assert (pytester.path / "out/lcov.info").read_text() == LCOV

    def test_a_terminated_process_keeps_its_counts(self, pytester, cell):
        (cell / "cell.script").write_text(
            CELL.replace('textmsg("over")', 'textmsg("over")\n  while True:\n    sleep(1)\n  end')
        )
        test = (
            "import subprocess, sys\n"
            "def test_child():\n"
            "    command = [sys.executable, '-m', 'elitescript', 'run', '--json', 'programs/cell.script']\n"
            "    child = subprocess.Popen(command, stdout=subprocess.PIPE)\n"
            "    assert any(b'over' in line for line in child.stdout)\n"
            "    child.terminate()\n"
            "    assert child.wait() != 0\n"
            "    child.stdout.close()\n"
        )
        result = run(pytester, test, "--script-cov", "--script-cov-report=lcov:lcov.info")
        result.assert_outcomes(passed=1)
        assert "DA:18,3\nDA:20,1\n" in (pytester.path / "lcov.info").read_text()

    @pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
    def test_processes_that_fork_have_records_of_their_own(self, pytester, cell):
        test = (
            "import os\n"
            "def test_it(robot):\n"
            "    unit = robot.compile('programs/cell.script')\n"
            "    for work in (unit, 'programs/unused.script'):\n"
            "        if not (child := os.fork()):\n"
            "            robot.run(work)\n"
            "            os._exit(0)\n"
            "        os.waitpid(child, 0)\n"
            "    robot.run('sleep(0.1)\\n')\n"
            "    robot.run(unit).check()\n"
        )
        run(pytester, test, "--script-cov", "--script-cov-report=lcov:lcov.info").assert_outcomes(passed=1)
        unused = "TN:\nSF:programs/unused.script\nFNF:0\nFNH:0\nBRF:0\nBRH:0\nDA:2,1\nLF:1\nLH:1\nend_of_record\n"
        assert (pytester.path / "lcov.info").read_text() == times(LCOV, 2) + unused

    def test_tests_and_workers_are_merged(self, pytester, cell, monkeypatch):
        monkeypatch.setenv("PYTEST_PLUGINS", "elitescript.pytest_plugin.plugin,xdist.plugin")
        test = (
            "import pytest\n"
            "@pytest.mark.parametrize('count', range(2))\n"
            "def test_it(robot, count):\n"
            "    robot.run('programs/cell.script').check()\n"
            "    robot.run('programs/cell.script').check()\n"
        )
        pytester.makepyfile(test_cell=test)
        words = ("-n2", "-p", "no:cacheprovider", "--script-cov", "--script-cov-report=lcov:lcov.info")
        pytester.runpytest_inprocess(*words).assert_outcomes(passed=2)
        assert (pytester.path / "lcov.info").read_text() == times(LCOV, 4)

    def test_secondary_programs_and_texts_of_a_file_count(self, pytester, cell):
        (cell / "side.script").write_text("sec side():\n  set_flag(1, True)\nend\n")
        test = (
            "def test_it(robot):\n"
            "    with open('programs/side.script') as side: robot.submit_secondary(side.read())\n"
            "    with open('programs/cell.script') as cell: robot.run(cell.read().rstrip()).check()\n"
        )
        run(pytester, test, "--script-cov", "--script-cov-report=lcov:lcov.info").assert_outcomes(passed=1)
        text = (pytester.path / "lcov.info").read_text()
        assert text.startswith(LCOV)
        assert "SF:programs/side.script\n" in text
        assert "DA:2,1\n" in text

    def test_functions_of_a_script_with_tests_count_and_its_tests_do_not(self, pytester, cell):
        half = "def half(n):\n  if n > 9:\n    return 9\n  end\n  return n / 2\nend\n"
        (cell / "half.script").write_text(f"{half}def test_half():\n  assert half(4) == 2\nend\n")
        (cell / "test_half.script").write_text("def test_it():\n  sleep(1)\nend\n")
        words = ("programs/half.script", "programs/test_half.script", "--script-cov", "--script-cov-report=json:c.json")
        result = pytester.runpytest_inprocess("-p", "no:cacheprovider", *words)
        result.assert_outcomes(passed=2)
        (program,) = json.loads((pytester.path / "c.json").read_text())["programs"]
        assert program["file"] == "programs/half.script"
        assert program["lines"] == {"1": 1, "2": 1, "3": 0, "5": 1, "7": 1, "8": 1}

    def test_a_file_of_a_single_test_is_no_program(self, pytester, cell):
        (cell / "one.script").write_text("def test_one():\n  x = 1\n  assert x == 1\nend\n")
        result = pytester.runpytest_inprocess("-p", "no:cacheprovider", "programs/one.script", "--script-cov")
        result.assert_outcomes(passed=1)
        result.stdout.fnmatch_lines(["no program with a file was run"])

    def test_texts_without_a_file_are_in_no_report(self, pytester, cell):
        result = run(pytester, "def test_it(robot): robot.run('sleep(1)\\n')\n", "--script-cov")
        result.stdout.fnmatch_lines(["no program with a file was run"])

    def test_nothing_is_counted_without_the_option(self, pytester, cell):
        test = (
            "import os\n"
            "from elitescript import VirtualRobot\n"
            "def test_it(robot):\n"
            "    assert robot.compile('programs/cell.script').statements == ()\n"
            "    assert 'ELITESCRIPT_COVERAGE' not in os.environ\n"
        )
        run(pytester, test).assert_outcomes(passed=1)


class TestPaths:
    def test_programs_that_no_test_ran_are_reported_of_a_folder(self, pytester, cell):
        result = run(pytester, HERE, "--script-cov=programs", "--script-cov-report=term-missing")
        result.stdout.fnmatch_lines(
            [
                "Program * Missing",
                "programs/cell.script *93%   16",
                "programs/unused.script *0%   2",
                "TOTAL *",
            ]
        )

    def test_a_root_folder_that_is_a_link(self, pytester, cell):
        link = pytester.path.with_name(f"{pytester.path.name}-link")
        link.symlink_to(pytester.path, target_is_directory=True)
        result = run(pytester, HERE, f"--rootdir={link}", "--script-cov", "--script-cov-report=lcov:lcov.info")
        result.assert_outcomes(passed=1)
        assert (pytester.path / "lcov.info").read_text() == LCOV

    def test_a_link_is_the_program_that_it_leads_to(self, pytester, cell):
        (cell / "alias.script").symlink_to("cell.script")
        (cell / "far").mkdir()
        (cell / "far" / "round").symlink_to("..", target_is_directory=True)
        (cell / "UNUSED2.SCRIPT").write_text("def unused2():\n  sleep(1)\nend\n")
        run(pytester, HERE, "--script-cov=programs", "--script-cov-report=json:a.json").assert_outcomes(passed=1)
        found = json.loads((pytester.path / "a.json").read_text())
        shown = [program["file"] for program in found["programs"]]
        assert shown == ["programs/UNUSED2.SCRIPT", "programs/cell.script", "programs/unused.script"]

    def test_several_files(self, pytester, cell):
        words = ("--script-cov=programs/unused.script", "--script-cov=programs/cell.script")
        result = run(pytester, HERE, *words, "--script-cov-report=lcov:lcov.info")
        result.assert_outcomes(passed=1)
        text = (pytester.path / "lcov.info").read_text()
        unused = "TN:\nSF:programs/unused.script\nFNF:0\nFNH:0\nBRF:0\nBRH:0\nDA:2,0\nLF:1\nLH:0\nend_of_record\n"
        assert text == LCOV + unused
        assert "TOTAL" not in result.stdout.str()

    def test_a_broken_program_and_a_changed_one_are_named(self, pytester, cell):
        (cell / "broken.script").write_text("def broken(:\n")
        test = HERE + "    with open('programs/cell.script', 'a') as program: program.write('# more')\n"
        result = run(pytester, test, "--script-cov=programs")
        result.stdout.fnmatch_lines_random(
            [
                "warning: *broken.script does not compile; it is in no report",
                "warning: programs/cell.script was changed while tests ran",
            ]
        )

    @pytest.mark.parametrize(
        ("word", "text"),
        [
            ("--script-cov=missing", "*--script-cov=*missing: there is no such file or folder*"),
            (
                "--script-cov=test_cell.py",
                "*test_cell.py: this is no program; --script-cov without PATH*",
            ),
            ("--script-cov-report=pdf:a", "*--script-cov-report=pdf:a: there are term, term-missing, lcov:PATH,*"),
            ("--script-cov-report=lcov", "*--script-cov-report=lcov: write lcov:PATH*"),
            ("--script-cov-report=json:programs/cell.script", "*cell.script: it is no report of kind json*"),
            ("--script-cov-report=xml:programs", "*programs: it is a folder, not a file*"),
            ("--script-cov-report=html:test_cell.py", "*pages go into a folder, and this is none*"),
            ("--script-record=test_cell.py", "*--script-record=test_cell.py: pages go into a folder*"),
        ],
    )
    def test_a_wrong_option_is_refused(self, pytester, cell, word, text):
        result = run(pytester, HERE, word)
        assert result.ret == pytest.ExitCode.USAGE_ERROR
        result.stderr.fnmatch_lines([text])


class TestReports:
    def test_all_kinds_are_written(self, pytester, cell):
        kinds = ("xml:out/a.xml", "html:out/html", "json:out/a.json", "lcov:out/a.info")
        run(pytester, HERE, *(f"--script-cov-report={kind}" for kind in kinds)).assert_outcomes(passed=1)
        out = pytester.path / "out"
        assert 'filename="programs/cell.script"' in (out / "a.xml").read_text()
        assert "programs/cell.script" in (out / "html/index.html").read_text()
        assert (out / "a.info").read_text() == LCOV
        found = json.loads((out / "a.json").read_text())
        assert found["totals"] == {
            "lines": 11,
            "lines_hit": 10,
            "branches": 4,
            "branches_hit": 4,
            "functions": 1,
            "functions_hit": 1,
            "percent": 93.33,
        }

    @pytest.mark.parametrize("by", ["variable", "git"])
    def test_services_find_files_from_the_root_of_the_repository(self, pytester, cell, monkeypatch, by):
        top = pytester.path.parent
        inner = f"{pytester.path.name}/programs/cell.script"
        if by == "variable":
            monkeypatch.setenv("GITHUB_WORKSPACE", str(top))
        else:
            (top / ".git").mkdir()
        try:
            kinds = ("xml:a.xml", "lcov:a.info", "json:a.json")
            run(pytester, HERE, *(f"--script-cov-report={kind}" for kind in kinds)).assert_outcomes(passed=1)
        finally:
            if by == "git":
                (top / ".git").rmdir()
        xml = (pytester.path / "a.xml").read_text()
        assert f'filename="{inner}"' in xml
        assert f"<source>{top.resolve()}</source>" in xml
        assert f"SF:{inner}\n" in (pytester.path / "a.info").read_text()

    def test_a_session_that_a_failure_ends_has_its_reports(self, pytester, cell):
        test = HERE + "    assert 0\ndef test_never(): pass\n"
        result = run(pytester, test, "-x", "--script-cov", "--script-cov-report=lcov:lcov.info")
        result.assert_outcomes(failed=1)
        assert (pytester.path / "lcov.info").read_text() == LCOV
        result.stdout.fnmatch_lines(["coverage of robot programs written to lcov *"])

    def test_a_limit(self, pytester, cell):
        assert run(pytester, HERE, "--script-cov-fail-under=93.3").ret == 0
        result = run(pytester, HERE, "--script-cov-fail-under=93.4")
        assert result.ret == pytest.ExitCode.TESTS_FAILED
        result.stdout.fnmatch_lines(["FAIL: 93.33% of lines and branches*--script-cov-fail-under asks for 93.4%"])

    @pytest.mark.parametrize("value", ["nan", "100.1", "most"])
    def test_a_limit_that_is_no_percentage_is_refused(self, pytester, cell, value):
        result = run(pytester, HERE, f"--script-cov-fail-under={value}")
        assert result.ret == pytest.ExitCode.USAGE_ERROR
        result.stderr.fnmatch_lines([f"*--script-cov-fail-under: write a number from 0 to 100, not '{value}'*"])

    def test_what_no_test_has_met(self, pytester, cell):
        (cell / "cell.toml").write_text(
            '[[tcp]]\nname = "camera"\nport = 5000\n\n[[fault]]\nkind = "refuse"\non = "camera"\nat_s = 0.1\n'
        )
        test = (
            "import pytest\n"
            "@pytest.mark.elitescript(world='programs/cell.toml')\n"
            "def test_it(robot):\n"
            "    robot.at(0.0, 'safeguard_stop', True)\n"
            "    robot.at(1.0, 'safeguard_stop', False)\n"
            "    robot.run('programs/cell.script').check()\n"
        )
        result = run(pytester, test, "--script-cov", "--script-cov-report=json:a.json", "--script-cov-report=term")
        result.assert_outcomes(passed=1)
        found = json.loads((pytester.path / "a.json").read_text())
        unmet = found["unmet"]
        assert found["met"]["alarms"] == ["R111"]
        assert unmet["handlers"] == [{"file": "programs/cell.script", "line": 15, "text": "except ValueError"}]
        assert [(row["line"], row["command"], row["error"]) for row in unmet["refusals"]] == [
            (7, "movel", "ScriptStateError")
        ]
        assert "SAFEGUARD_STOP" not in unmet["safety_states"]
        assert "PROTECTIVE_STOP" in unmet["safety_states"]
        assert unmet["task_states"] == []
        (fault,) = unmet["faults"]
        assert fault["on"] == "camera (5000)"
        assert "silence" in fault["kinds"]
        assert "refuse" not in fault["kinds"]
        assert "stuck" not in fault["kinds"]
        result.stdout.fnmatch_lines(
            ["What no test has met", "except paths:", "  programs/cell.script:15: except ValueError"]
        )


class TestChild:
    def test_a_folder_that_is_missing_is_a_mistake(self, tmp_path):
        (tmp_path / "a.script").write_text("sleep(1)\n")
        environment = {**os.environ, "ELITESCRIPT_COVERAGE": str(tmp_path / "missing")}
        command = [sys.executable, "-m", "elitescript", "run", str(tmp_path / "a.script")]
        done = subprocess.run(command, env=environment, capture_output=True, text=True)
        assert done.returncode == 2
        assert "ELITESCRIPT_COVERAGE=" in done.stderr
        assert "No such file or directory" in done.stderr


def test_a_tree_is_measured_by_its_nodes(pytester):
    """And the script that a pendant has written beside it is no other program."""
    main_task = (
        '<MainTask isTaskAlwaysLoops="false" hasInitVariables="false"><IfNode><Expression>'
        '<ExpressionCharCell char="0"/></Expression><children><HaltNode/></children></IfNode><HaltNode/></MainTask>'
    )
    (pytester.path / "cell.task").write_text(f'<EliTask name="cell">{main_task}</EliTask>')
    (pytester.path / "cell.task.script").write_text("sleep(1)\n")
    test = "def test_it(robot):\n    assert robot.run('cell.task').state == 'stopped'\n"
    result = run(pytester, test, "--script-cov=.", "--script-cov-report=term-missing")
    result.assert_outcomes(passed=1)
    result.stdout.fnmatch_lines(["cell.task *   2 If > 3 Halt*"])
    result.stdout.no_fnmatch_line("cell.task.script *")
