"""What the report of a failed test says of its robots, and what `--script-strict` makes of warnings."""

from __future__ import annotations

import json
import os
import re
import textwrap
from xml.etree import ElementTree

import pytest

from elitescript.pytest_plugin import plugin
from tests.plotting.front_end import pretend_built, pretend_not_built, recordings_of

FAILING = """
import pytest

CELL = '''def cell():
  set_standard_digital_out(0, True)
  movej([0.3, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
  sleep(0.5)
  textmsg("at the part")
  movel([9, 0, 0, 0, 0, 0])
end
'''

def test_it(robot):
    robot.at(0.2, "standard_digital_in[3]", True)
    robot.run(CELL).check()
"""


def run(pytester: pytest.Pytester, text: str, *words: str) -> pytest.RunResult:
    """Run one test file."""
    pytester.makepyfile(test_cell=textwrap.dedent(text))
    return pytester.runpytest_inprocess("-p", "no:cacheprovider", *words)


class TestSection:
    def test_lines_signals_messages_and_the_alarm(self, pytester):
        result = run(pytester, FAILING)
        result.assert_outcomes(failed=1)
        result.stdout.fnmatch_lines(
            [
                "*- elitescript -*",
                "<program> on CS66: alarm after 1.428 s",
                "last lines with an effect:",
                "      0.000 s     2  set_standard_digital_out(0, True)",
                "      0.000 s     3  movej(*",
                "      1.428 s     5  textmsg(*",
                "      1.428 s     6  movel(*",
                "signals that changed:",
                "      0.000 s  standard_digital_out[[]0[]] = True  (line 2)",
                "      0.200 s  standard_digital_in[[]3[]] = True  by schedule",
                "found: 1 warning",
                "  line 6, column 10: warning W231: *",
                "last messages:",
                "      1.428 s  at the part  (line 5)",
                "alarm:",
                "  1.428 s  <program>:6:3: R111 RuntimeError: movel: *",
                "      movel([[]9, 0, 0, 0, 0, 0[]])",
            ],
            consecutive=True,
        )

    def test_a_program_that_goes_on_shows_where_its_threads_are(self, pytester):
        text = """
            def test_it(robot):
                run = robot.run("while True:\\n  sleep(0.3)\\nend\\n", until_s=1)
                assert run.state == "finished"
            """
        result = run(pytester, text)
        result.stdout.fnmatch_lines(["<program> on CS66: still running at the time limit after 1.000 s", "threads:"])
        result.stdout.fnmatch_lines(["  main: line 2, `while True` in line 1 has no end"])

    def test_the_last_of_many_runs_and_lines_are_shown(self, pytester):
        text = """
            def test_it(robot):
                for number in range(9):
                    run = robot.run(f"for n in range(300):\\n  sleep(0.1)\\n  set_flag({number}, True)\\nend\\n")
                assert 0
            """
        shown = run(pytester, text).stdout.str()
        assert shown.count("finished after 30.000 s") == 5
        assert "    3  set_flag(3, True)" not in shown
        assert "    3  set_flag(8, True)" in shown

    def test_lines_are_those_that_took_time_if_pages_are_asked_for(self, pytester):
        result = run(pytester, FAILING, "--script-record=pages")
        lines = [
            "last lines:",
            "      0.000 s     3  movej(*",
            "      0.928 s     4  sleep(0.5)",
            "signals that changed:",
        ]
        result.stdout.fnmatch_lines(lines, consecutive=True)

    def test_a_run_that_is_dropped_is_known_by_its_events(self, pytester):
        text = """
            from elitescript import VirtualRobot

            def time_of(text):
                return VirtualRobot().run(text).time_s

            def test_it():
                assert time_of("sleep(2)\\n") < 1
            """
        run(pytester, text).stdout.fnmatch_lines(["<program> on CS66: finished after 2.000 s"])

    def test_a_passing_test_has_no_section_and_a_trace_of_its_own_is_kept(self, pytester):
        text = """
            def test_it(robot):
                run = robot.run("sleep(1)\\n", trace=True)
                assert len(run.trace) == 251
            """
        result = run(pytester, text, "-rA")
        result.assert_outcomes(passed=1)
        assert "- elitescript -" not in result.stdout.str()

    def test_no_section_without_a_robot(self, pytester):
        assert "- elitescript -" not in run(pytester, "def test_it(): assert 0").stdout.str()

    def test_robots_of_other_threads_are_seen(self, pytester):
        text = """
            from threading import Thread
            from elitescript import VirtualRobot

            def test_it():
                thread = Thread(target=lambda: VirtualRobot("CS63").run("sleep(1)\\n"))
                thread.start()
                thread.join()
                assert 0
            """
        run(pytester, text).stdout.fnmatch_lines(["<program> on CS63: finished after 1.000 s"])

    def test_nothing_of_a_test_is_kept(self, pytester):
        text = """
            import gc
            import weakref
            from elitescript import VirtualRobot

            kept = []

            def test_one():
                robot = VirtualRobot()
                robot.start("sleep(10)\\n")
                kept.append(weakref.ref(robot))

            def test_two():
                gc.collect()
                assert kept[0]() is None
            """
        run(pytester, text).assert_outcomes(passed=2)


class TestPages:
    def test_a_failing_test_leaves_a_page(self, pytester, monkeypatch):
        pretend_not_built(pytester.path, monkeypatch)
        result = run(pytester, FAILING + "\ndef test_well(robot): robot.run(CELL)\n", "--script-record=pages")
        (page,) = (pytester.path / "pages").iterdir()
        assert page.name == "test_cell.py-test_it.html"
        result.stdout.fnmatch_lines([f"page: {page}"])
        text = page.read_text(encoding="utf-8")
        assert 'textmsg(\\"at the part\\")' in text
        assert "R111" in text

    def test_the_page_holds_the_recording_where_it_is_built(self, pytester, monkeypatch, tmp_path):
        pretend_built(tmp_path, monkeypatch)
        run(pytester, FAILING, "--script-record=pages")
        (page,) = (pytester.path / "pages").iterdir()
        (recorded,) = recordings_of(page)
        said = {message["type"]: message for message in recorded["said"]}
        assert 'textmsg("at the part")' in said["file"]["text"]
        assert said["run_ended"]["state"] == "alarm"
        assert said["run_ended"]["alarm"]["line"] == 6

    def test_each_run_has_one(self, pytester):
        text = "def test_it(robot):\n    robot.run('sleep(1)\\n')\n    robot.run('sleep(2)\\n')\n    assert 0\n"
        run(pytester, text, "--script-record=pages")
        assert sorted(path.name for path in (pytester.path / "pages").iterdir()) == [
            "test_cell.py-test_it.1.html",
            "test_cell.py-test_it.2.html",
        ]

    def test_passing_tests_leave_nothing(self, pytester):
        run(pytester, "def test_it(robot): robot.run('sleep(1)\\n')\n", "--script-record=pages").assert_outcomes(
            passed=1
        )
        assert not (pytester.path / "pages").exists()

    def test_a_test_in_the_language_has_one(self, pytester):
        (pytester.path / "test_it.script").write_text("def test_it():\n  sleep(1)\n  assert 1 == 2\nend\n")
        pytester.runpytest_inprocess("-p", "no:cacheprovider", "--script-record=pages").assert_outcomes(failed=1)
        assert [path.name for path in (pytester.path / "pages").iterdir()] == ["test_it.script-test_it.html"]


class TestStrict:
    CHECKED = "def test_it(robot): robot.run('x = 1\\nmovej([90, 0, 0, 0, 0, 0])\\n', until_s=1)\n"

    def test_what_check_finds_makes_a_test_fail(self, pytester):
        run(pytester, self.CHECKED).assert_outcomes(passed=1)
        result = run(pytester, self.CHECKED, "--script-strict")
        result.assert_outcomes(failed=1)
        result.stdout.fnmatch_lines(
            ["warnings, which --script-strict refuses:", "<program>: line 2, column 8: warning W230: *"]
        )

    def test_what_the_run_warns_about_does_so_once(self, pytester):
        (pytester.path / "cell.script").write_text("def cell():\n  set_flag(3, True)\n  raise SystemExit\nend\n")
        text = "def test_it(robot):\n    for _ in range(2): robot.run('cell.script')\n"
        run(pytester, text).assert_outcomes(passed=1)
        result = run(pytester, text, "--script-strict")
        result.assert_outcomes(failed=1)
        report, _, _ = result.stdout.str().partition("short test summary info")  # that repeats it in full only on a CI
        assert report.count("SystemExit ends the program") == 5  # and what is found in two runs, and their messages

    def test_programs_without_warnings_pass(self, pytester):
        text = "def test_it(robot): robot.run('g = count + 1\\nset_flag(g, True)\\n', presets={'count': 1})\n"
        run(pytester, text, "--script-strict").assert_outcomes(passed=1)

    def test_tests_in_the_language(self, pytester):
        (pytester.path / "test_it.script").write_text("def test_it():\n  set_flag(1, True)\nend\n")
        pytester.runpytest_inprocess("-p", "no:cacheprovider", "--script-strict").assert_outcomes(passed=1)

    def test_a_failure_of_the_test_itself_is_shown_alone(self, pytester):
        result = run(pytester, self.CHECKED.replace("robot): ", "robot):\n    ") + "    assert 0\n", "--script-strict")
        result.assert_outcomes(failed=1)
        assert "which --script-strict refuses" not in result.stdout.str()


HOSTILE = r"""def test_b():
  textmsg("a\n::error::x\n##[group]y \x1b[2J \ud83d")
  print("\u202e     4.244 s  finished")
  popup("t\n::a", "##vso[x]", False, False)
  assert 1 == 2, "n\n::b ##[c \x1b \ud83d"
end
def test_alarm():
  raise ValueError("n\n::b ##[c \x1b \ud83d")
end
"""
STRANGE = os.fsdecode(b"test_b\xe9d\x1b\n##[x].script")
ACTS = re.compile(r"(?m)^\s*::|##\w*\[|[\x00-\x08\x0b-\x1f\x7f-\x9f\u202e\ud800-\udfff]")


class TestTextsOfStrangers:
    def test_nothing_acts_on_the_terminal_and_junit_has_the_texts(self, pytester):
        (pytester.path / STRANGE).write_text(HOSTILE)
        (pytester.path / "job.script").write_text(HOSTILE.replace("def test_b", "def job").split("def test_alarm")[0])
        pytester.makepyfile(
            test_c="def test_c(robot):\n    robot.run('job.script').check()\n"
            "def test_d(robot):\n    assert robot.run('job.script').state == 'finished'\n"
        )
        done = pytester.runpytest_inprocess("-p", "no:cacheprovider", "--junit-xml=x.xml")
        done.assert_outcomes(failed=4)
        out = "\n".join(line for line in done.outlines if not line.startswith(">"))
        assert not (found := ACTS.search(out)), ascii(out[max(0, found.start() - 200) : found.end() + 20])
        assert "\n| :\\x3aerror::x\n| #\\x23[group]y \\x1b[2J \\ud83d  (line 2)" in out
        assert r"FAILED test_b\udce9d\x1b\n#\x23[x].script::test_b" in out
        assert "\nE   :\\x3ab #\\x23[c \\x1b \\ud83d\nE   assert 1 == 2" in out
        junit = (pytester.path / "x.xml").read_text()
        ElementTree.fromstring(junit)
        assert "##[group]y #x1B[2J #xD83D" in junit

    def test_what_is_sent_has_an_encoding(self):
        data = {"longrepr": ["a\ud83d", ("b\udce9", 1)], "\ud83d": None, "sections": [("x", "plain é")]}
        sent = plugin._encodable(data)
        assert sent == {"longrepr": ["a\\ud83d", ("b\\udce9", 1)], "\\ud83d": None, "sections": [("x", "plain é")]}

    @pytest.mark.slow
    def test_workers_of_xdist_live_on(self, pytester, monkeypatch):
        monkeypatch.setenv("PYTEST_PLUGINS", "elitescript.pytest_plugin.plugin,xdist.plugin")
        (pytester.path / STRANGE).write_text(HOSTILE)
        done = pytester.runpytest_inprocess("-p", "no:cacheprovider", "-n1", "--junit-xml=x.xml")
        done.assert_outcomes(failed=2)
        out = done.stdout.str()
        assert not ACTS.search(out)
        assert "##[group]y #x1B[2J \\ud83d" in (pytester.path / "x.xml").read_text()


class TestFindings:
    TEXT = "def test_it(robot): robot.run('movej([0, 0, 0, 0, 0, {a}])\\n', until_s=1)\n"

    @pytest.mark.parametrize(
        ("level", "a", "failed"),
        [("", 90, 0), ("off", 90, 0), ("error", 7, 1), ("error", 6.2, 0), ("warning", 7, 1), ("warning", 6.2, 0)],
    )
    def test_levels(self, pytester, level, a, failed):
        (pytester.path / "pytest.ini").write_text(f"[pytest]\nelitescript_findings = {level}\n")
        run(pytester, self.TEXT.replace("{a}", str(a))).assert_outcomes(failed=failed, passed=1 - failed)

    def test_tests_that_pass_with_findings_are_named_and_the_last_line_is_not_green(self, pytester):
        text = """
            def test_sound(robot): robot.run('sync()')
            def test_text(robot): robot.run("a = get_standard_digital_in(0) == 'on'\\nsync()")
        """
        result = run(pytester, text, "--junitxml=report.xml")
        result.stdout.fnmatch_lines(["*elitescript findings*", "*::test_text: 1 warning"])
        assert "1 passed" not in result.stdout.str()
        assert "2 passed, 1 with findings" in result.stdout.str()
        xml = (pytester.path / "report.xml").read_text()
        assert xml.count('<property name="elitescript_findings" value="1 warning" />') == 1
        properties = {node.get("name"): node.get("value", "") for node in ElementTree.fromstring(xml).iter("property")}
        (row,) = json.loads(properties["elitescript_findings_json"] or "")
        assert (row["code"], row["template"], row["values"]["what"]) == (
            "W240",
            "{operand}: never equal to {what}",
            "`'on'`",
        )
        (pytester.path / "pytest.ini").write_text("[pytest]\nelitescript_findings = off\n")
        assert "with findings" not in run(pytester, text).stdout.str()

    def test_the_report_lists_them_and_a_level_that_is_none_is_refused(self, pytester):
        (pytester.path / "pytest.ini").write_text("[pytest]\nelitescript_findings = warning\n")
        servo = "def f():\\n  q = get_actual_joint_positions()\\n  q[0] = q[0] + 0.8\\n  servoj(q, t=0.008)\\nend\\n"
        result = run(pytester, f"def test_it(robot): robot.run('{servo}')\n")
        result.stdout.fnmatch_lines(
            [
                "findings, which elitescript_findings refuses:",
                "<program>: line 4: warning W280: the program ends *",
                "found: 1 warning",
            ]
        )
        (pytester.path / "pytest.ini").write_text("[pytest]\nelitescript_findings = much\n")
        result = run(pytester, "def test_it(robot): robot.run('sync()')\n")
        assert "elitescript_findings must be off, error, warning, got 'much'" in result.stdout.str()
