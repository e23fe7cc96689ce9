"""Default limits of runs: a forgotten `until_s`, a program that hangs in a call, and what JUnit XML carries."""

from __future__ import annotations

import signal
import subprocess
import sys
import textwrap
from xml.etree import ElementTree

import pytest

from elitescript.errors import UsageError
from elitescript.pytest_plugin import limits

ENDLESS = "def p():\n  while True:\n    sleep(1)\n    textmsg('here')\n  end\nend\n"
BUSY = "def p():\n  while True:\n    x = 1\n  end\nend\n"


def run(pytester: pytest.Pytester, text: str, *words: str) -> pytest.RunResult:
    """Run the tests of one file in this process."""
    pytester.makepyfile(test_cell=f"import pytest\nENDLESS = {ENDLESS!r}\nBUSY = {BUSY!r}\n{textwrap.dedent(text)}")
    return pytester.runpytest_inprocess("-p", "no:cacheprovider", "--strict-markers", *words)


def test_a_run_without_a_limit_ends_after_600_s_and_fails_its_test(pytester):
    result = run(
        pytester,
        """
        def test_it(robot):
            robot.run(ENDLESS)
            raise AssertionError("not reached")

        def test_a_robot_of_its_own():
            from elitescript import VirtualRobot
            VirtualRobot().run(ENDLESS)

        def test_swallowed(robot):
            try:
                robot.run(ENDLESS)
            except BaseException:
                pass
        """,
        "--junit-xml=out.xml",
    )
    result.assert_outcomes(failed=3)
    words = "<program> was still running after 600 s of robot time, the limit of a run in pytest; another one"
    result.stdout.fnmatch_lines([f"*{words}*elitescript_limit_s in the ini file; or run(..., until_s=SECONDS)"])
    result.stdout.fnmatch_lines(["*- elitescript -*", "*still running at the time limit after 600.000 s"])
    # JUnit XML says as much.
    for failure in ElementTree.parse(pytester.path / "out.xml").iter("failure"):
        text = failure.text or ""
        assert words in text
        assert text.count("last lines with an effect:") == 1
        assert "600.000 s  here  (line 4)" in text


def test_a_limit_of_the_test_is_a_result_and_none_of_ours(pytester):
    result = run(
        pytester,
        """
        def test_it(robot):
            assert robot.run(ENDLESS, until_s=5).state == "time_limit"

        def test_longer(robot):
            assert robot.run(ENDLESS, until_s=700).time_s == 700.0

        @pytest.mark.elitescript(limit_s=0)
        def test_none(robot):
            run = robot.run("def p():\\n  sleep(4000)\\nend\\n")
            assert run.state == "finished"

        def test_an_end_of_its_own(robot):
            def watch(robot):
                if robot.tick > 250:
                    robot.interrupt("time_limit")
            assert robot.run(ENDLESS, watch=watch).state == "time_limit"
        """,
    )
    result.assert_outcomes(passed=4)


def test_marker_before_ini_before_default(pytester):
    pytester.makeini("[pytest]\nelitescript_limit_s = 7\n")
    result = run(
        pytester,
        """
        def test_ini(robot):
            robot.run(ENDLESS)

        @pytest.mark.elitescript(limit_s=3.5)
        def test_marker(robot):
            robot.run(ENDLESS)
        """,
    )
    result.assert_outcomes(failed=2)
    result.stdout.fnmatch_lines(["*after 7 s of robot time*", "*after 3.5 s of robot time*"])


class Ini:
    """A configuration with options of an ini file."""

    def __init__(self, **options: str) -> None:
        self._options = options

    def getini(self, name: str) -> str:
        return self._options.get(name, "")


@pytest.mark.parametrize("name", limits.SETTINGS)
@pytest.mark.parametrize("value", ["soon", "-1.5", "nan", "-inf", "true", "1_0 s"])
def test_a_limit_of_the_ini_file_that_is_no_number_is_refused(name, value):
    with pytest.raises(UsageError, match=f"^elitescript_{name}: write seconds, or 0 for no limit, not '?{value}'?$"):
        limits.limits_of(Ini(**{f"elitescript_{name}": value}), {})


@pytest.mark.parametrize("name", limits.SETTINGS)
@pytest.mark.parametrize("value", [True, False, "5", b"5", "", -1, float("nan"), -(10**400), 10**400, [5], 1j])
def test_a_limit_of_a_marker_that_is_no_number_is_refused(name, value):
    words = rf"^@pytest\.mark\.elitescript\({name}=\): write seconds, or 0 for no limit, not "
    with pytest.raises(UsageError, match=words):
        limits.limits_of(Ini(), {name: value})


def test_a_limit_that_is_refused_fails_its_test(pytester):
    pytester.makeini("[pytest]\nelitescript_wall_limit_s = nan\n")
    text = """
        @pytest.mark.elitescript(limit_s=True)
        def test_marker(robot):
            robot.run("def p():\\n  x = 1\\nend\\n")

        def test_ini(robot):
            robot.run("def p():\\n  x = 1\\nend\\n")
        """
    result = run(pytester, text)
    result.assert_outcomes(failed=2)
    result.stdout.fnmatch_lines(
        [
            "*@pytest.mark.elitescript(limit_s=): write seconds, or 0 for no limit, not True",
            "*elitescript_wall_limit_s: write seconds, or 0 for no limit, not nan",
        ]
    )


@pytest.mark.parametrize("value", [0, 0.0, float("inf"), 1e300, 1e9])
def test_no_limit_is_none(value):
    given = dict.fromkeys(limits.SETTINGS, value)
    assert limits.limits_of(Ini(), given) == (None, None)
    texts = {f"elitescript_{name}": str(value) for name in limits.SETTINGS}
    assert limits.limits_of(Ini(**texts), {}) == (None, None)


def test_a_test_script_without_until_has_the_limit_of_all_runs(pytester):
    pytester.makeini("[pytest]\nelitescript_limit_s = 7\n")
    endless = "def test_it():\n  while True:\n    sleep(1)\n  end\nend\n"
    for name, header in (("ini", ""), ("until", "until=5"), ("limit", "limit_s=3.5")):
        (pytester.path / f"test_{name}.script").write_text(f"# elitescript: {header}\n{endless}" if header else endless)
    (pytester.path / "test_none.script").write_text("# elitescript: limit_s=0\ndef test_it():\n  sleep(4000)\nend\n")
    result = pytester.runpytest_inprocess("-p", "no:cacheprovider")
    result.assert_outcomes(failed=3, passed=1)
    text = result.stdout.str()
    for seconds in ("7", "5", "3.5"):
        assert f"still running after {seconds} s of robot time; another limit: `# elitescript: until=SECONDS`" in text


def test_wall_time_counts_also_with_a_limit_of_robot_time(pytester):
    result = run(
        pytester,
        """
        @pytest.mark.elitescript(wall_limit_s=0.05)
        def test_it(robot):
            robot.run(BUSY, until_s=1e9)
        """,
    )
    result.assert_outcomes(failed=1)
    words = "<program> was still running after 0.05 s of wall time (* s of robot time), the limit of a run in pytest"
    result.stdout.fnmatch_lines([f"*{words}; another one*elitescript_wall_limit_s in the ini file"])


@pytest.mark.skipif(sys.platform == "win32", reason="there is no timer")
def test_a_call_that_hangs_is_ended_and_the_next_test_runs(pytester, monkeypatch):
    # The timer of the outer session is put aside: that of pytest-timeout has it.
    signal.setitimer(signal.ITIMER_REAL, 0.0)
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    monkeypatch.setattr(limits, "AGAIN_S", 0.05)
    text = "def p():\n  import re\n  re.match('(a+)+$', 'a' * 60 + 'b')\nend\n"
    result = run(
        pytester,
        f"""
        @pytest.mark.elitescript(wall_limit_s=0.05)
        def test_hangs(robot):
            robot.run({text!r})

        def test_next(robot):
            assert robot.run("def p():\\n  sleep(1)\\nend\\n").state == "finished"
        """,
    )
    result.assert_outcomes(failed=1, passed=1)
    result.stdout.fnmatch_lines(["*was still running after 0.05 s of wall time*"])


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="there is no timer")
def test_a_call_that_looks_for_no_signal_ends_the_process_and_says_where(tmp_path):
    (tmp_path / "test_cell.py").write_text(
        "from elitescript.pytest_plugin import limits\n"
        "limits.EXIT_S = limits._REARM_S = 0.5\n"
        "import pytest\n"
        "@pytest.mark.elitescript(wall_limit_s=0.5)\n"
        "def test_it(robot):\n"
        "    robot.run('def p():\\n  x = max(range(10 ** 13))\\nend\\n')\n"
    )
    words = [
        "-m",
        "pytest",
        "-p",
        "elitescript.pytest_plugin.plugin",
        "-p",
        "no:cacheprovider",
        "--disable-plugin-autoload",
    ]
    done = subprocess.run(
        [sys.executable, *words, "test_cell.py"], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 1
    assert "Timeout (0:00:01" in done.stderr
    assert 'File "<program>", line 2 in p' in done.stderr


def test_the_report_of_a_script_test_has_the_section_in_junit_xml_too(pytester):
    (pytester.path / "test_a.script").write_text("def test_a():\n  textmsg('here')\n  assert 1 == 2\nend\n")
    pytester.runpytest_inprocess("-p", "no:cacheprovider", "--junit-xml=out.xml").assert_outcomes(failed=1)
    (failure,) = ElementTree.parse(pytester.path / "out.xml").iter("failure")
    assert "here  (line 2)" in str(failure.text)
