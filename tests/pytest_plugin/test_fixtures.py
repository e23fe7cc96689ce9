"""The fixtures `robot` and `served_robot`, and the marker that configures them."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from importlib.metadata import entry_points

import pytest

WORLD = '[robot]\nfirmware = "2.10"\n\n[safety]\ntcp_speed = 0.5\n\n[signals]\n"standard_digital_in[3]" = true\n'


def run(pytester: pytest.Pytester, text: str, *words: str) -> pytest.RunResult:
    """Run the tests of one file in this process."""
    pytester.makepyfile(test_cell=textwrap.dedent(text))
    return pytester.runpytest_inprocess("-p", "no:cacheprovider", "--strict-markers", *words)


class TestRobot:
    def test_without_a_marker_it_has_the_defaults_and_is_fresh(self, pytester):
        result = run(
            pytester,
            """
            import pytest

            @pytest.mark.parametrize("count", [1, 2])
            def test_it(robot, count):
                assert (robot.model.name, robot.options.firmware, robot.tick) == ("CS66", "2.14", 0)
                assert robot.run("def a():\\n  set_flag(1, True)\\n  sleep(1)\\nend\\n").check().time_s == 1.0
            """,
        )
        result.assert_outcomes(passed=2)

    def test_the_nearest_marker_wins_for_each_keyword(self, pytester):
        result = run(
            pytester,
            """
            import pytest

            pytestmark = pytest.mark.elitescript(robot="CS63", firmware="2.10", seed=3)

            @pytest.mark.elitescript(robot="CS612")
            class TestIt:
                def test_class(self, robot):
                    assert (robot.model.name, robot.options.firmware, robot.options.seed) == ("CS612", "2.10", 3)

                @pytest.mark.elitescript(robot="CS620", seed=4)
                def test_function(self, robot):
                    assert (robot.model.name, robot.options.firmware, robot.options.seed) == ("CS620", "2.10", 4)

            def test_module(robot):
                assert (robot.model.name, robot.options.firmware, robot.options.seed) == ("CS63", "2.10", 3)
            """,
        )
        result.assert_outcomes(passed=3)

    def test_paths_are_relative_to_the_test_file(self, pytester):
        folder = pytester.mkdir("cells")
        (folder / "cell.toml").write_text(WORLD)
        (folder / "arm.toml").write_text('base = "CS66"\nname = "longer"\n[arm]\nd6 = 0.095\n')
        (folder / "test_in_folder.py").write_text(
            "import pytest\n"
            "@pytest.mark.elitescript(world='cell.toml', robot='arm.toml')\n"
            "def test_it(robot):\n"
            "    assert robot.options.firmware == '2.10'\n"
            "    assert robot.model.name == 'longer'\n"
            "    assert robot.options.safety.normal.tcp_speed_max == 0.5\n"
            "    assert robot.signals['standard_digital_in[3]'] is True\n"
        )
        pytester.runpytest_inprocess("-p", "no:cacheprovider", "--strict-markers").assert_outcomes(passed=1)

    def test_objects_tables_and_functions_that_make_a_world(self, pytester):
        result = run(
            pytester,
            """
            import pytest
            from elitescript import PlantConfig
            from elitescript.testing.world import Wire, World

            def around():
                return World(wires=[Wire(when="standard_digital_out[0]", then="standard_digital_in[1]", after_s=0.3)])

            @pytest.mark.elitescript(plant=PlantConfig(lag_s=0.02), safety={"tcp_speed": 0.4}, world=around)
            @pytest.mark.parametrize("count", [1, 2])
            def test_it(robot, count):
                assert robot.options.plant.lag_s == 0.02
                assert robot.options.safety.normal.tcp_speed_max == 0.4
                robot.run("set_standard_digital_out(0, True)\\nsleep(1)\\n").check()
                assert robot.signals["standard_digital_in[1]"] is True
            """,
        )
        result.assert_outcomes(passed=2)

    @pytest.mark.parametrize(
        ("marker", "text"),
        [
            (
                "firmwear='2.10'",
                "has no setting 'firmwear'; did you mean 'firmware'?; there are robot, world, firmware",
            ),
            ("'CS66'", "takes keywords, such as robot=..., not the positional 'CS66'"),
            ("robot='CS99'", "CS99"),
            ("world='missing.toml'", "missing.toml"),
            ("safety={'tcp_sped': 1}", "tcp_sped"),
        ],
    )
    def test_a_mistake_is_an_error_that_names_it(self, pytester, marker, text):
        text_of_test = f"import pytest\n@pytest.mark.elitescript({marker})\ndef test_it(robot): pass\n"
        result = run(pytester, text_of_test, "--tb=line")
        result.assert_outcomes(errors=1)
        result.stdout.fnmatch_lines([f"*Error: *{text}*"])

    def test_fixtures_and_marker_are_listed(self, pytester):
        pytester.makepyfile("def test_it(): pass")
        assert "served_robot" in pytester.runpytest_inprocess("--fixtures").stdout.str()
        assert "@pytest.mark.elitescript(robot=, firmware=, world=, plant=, safety=" in (
            pytester.runpytest_inprocess("--markers").stdout.str()
        )


class TestServedRobot:
    def test_ports_ctl_log_and_warnings_beside_a_robot_in_virtual_time(self, pytester):
        result = run(
            pytester,
            """
            import os
            import socket

            import pytest

            @pytest.fixture(scope="module")
            def processes():
                pids = []
                yield pids
                for pid in pids:
                    with pytest.raises(ProcessLookupError):
                        os.kill(pid, 0)

            @pytest.mark.elitescript(robot="CS612", firmware="2.10", seed=5)
            def test_it(served_robot, robot, processes):
                processes.append(served_robot.pid)
                assert robot.model.name == "CS612"
                assert served_robot.host == "127.0.0.1"
                assert {"dashboard", "primary", "rtsi", "modbus"} <= set(served_robot.ports)
                with socket.create_connection((served_robot.host, served_robot.ports["primary"])) as primary:
                    primary.sendall(b"def a():\\n  set_flag(3, True)\\n  textmsg('here')\\n  raise SystemExit\\nend\\n")
                    served_robot.wait_for("log", text="here")
                    served_robot.wait_for("warning")
                assert served_robot.log[0]["type"] == "ready"
                assert served_robot.log[0]["robots"][0]["model"] == "CS612"
                assert served_robot.ctl("state")["robot_mode"] == "RUNNING"
                assert "text" in served_robot.ctl("set", "standard_digital_in[3]=true")
                with pytest.raises(Exception, match="no verb 'flay'; did you mean 'play'"):
                    served_robot.ctl("flay")
                with pytest.raises(TimeoutError, match="no line of type 'alarm' within 0 s"):
                    served_robot.wait_for("alarm", within_s=0)
                # As when the process of the tests ends.
                served_robot._process.stdin.close()
                with pytest.raises(Exception, match="serve has ended with exit code 0"):
                    served_robot.wait_for("never")
            """,
            "--script-strict",
        )
        result.assert_outcomes(passed=1, errors=1)
        result.stdout.fnmatch_lines(
            [
                "warnings, which --script-strict refuses:",
                "SystemExit ends *",
                "*- elitescript serve -*",
                "last lines of the log:",
                "*?.??? s  task a started",
                "*?.??? s  signal flag* True  (line 2)",
                "*?.??? s  warning SystemExit ends *",
            ]
        )

    @pytest.mark.parametrize(
        ("marker", "text"),
        [
            ("plant={'lag_s': 0.02}", "served_robot cannot be given plant={'lag_s': 0.02}; write it into the file of"),
            ("world='missing.toml'", "missing.toml"),
        ],
    )
    def test_what_serve_cannot_take_is_an_error(self, pytester, marker, text):
        text_of_test = f"import pytest\n@pytest.mark.elitescript({marker})\ndef test_it(served_robot): pass\n"
        result = run(pytester, text_of_test, "--tb=line")
        result.assert_outcomes(errors=1)
        result.stdout.fnmatch_lines([f"*Error: *{text}*"])


class TestWithoutEffort:
    def test_neither_the_plugin_nor_a_session_without_robots_imports_any(self, pytester):
        """The list holds all modules that the plugin loads, those of Python too."""
        pytester.makepyfile(
            test_it="import sys\n"
            "def test_it(): assert [name for name in sys.modules if name.startswith('elitescript')] == sys.ours\n"
        )
        code = (
            "import sys, pytest\n"
            "before = set(sys.modules)\n"
            "import elitescript.pytest_plugin.plugin\n"
            "sys.ours = [name for name in sys.modules if name not in before]\n"
            "print(sorted(sys.ours))\n"
            "sys.exit(pytest.main(['-q', '-p', 'no:cacheprovider', '--strict-markers']))\n"
        )
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        assert done.stdout.partition("\n")[0] == str(
            [
                "elitescript",
                "elitescript.observer",
                "elitescript.paths",
                "elitescript.pytest_plugin",
                "elitescript.pytest_plugin.file_names",
                "elitescript.pytest_plugin.plugin",
                "elitescript.pytest_plugin.watching",
            ]
        )
        assert "1 passed" in done.stdout

    def test_it_can_be_switched_off(self, pytester, monkeypatch):
        monkeypatch.delenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD")
        monkeypatch.delenv("PYTEST_PLUGINS")
        pytester.makepyfile("def test_it(robot): pass")
        others = {found.name for found in entry_points(group="pytest11")} - {"elitescript"}
        alone = ["-p", "no:cacheprovider", *(word for name in others for word in ("-p", f"no:{name}"))]
        pytester.runpytest_inprocess(*alone).assert_outcomes(passed=1)
        result = pytester.runpytest_inprocess(*alone, "-p", "no:elitescript")
        result.assert_outcomes(errors=1)
        result.stdout.fnmatch_lines(["*fixture 'robot' not found*"])


def test_an_orphan_variable_is_not_left(pytester):
    before = os.environ.get("ELITESCRIPT_COVERAGE")
    run(pytester, "def test_it(robot): robot.run('sleep(1)')\n", "--script-cov").assert_outcomes(passed=1)
    assert os.environ.get("ELITESCRIPT_COVERAGE") == before
