"""Tests in the language: which files are collected, how a test runs, and what a failing one shows."""

from __future__ import annotations

import pytest

GRIPPER = """# A gripper.
# elitescript: robot=CS612 until=5
set_standard_digital_out(0, True)

def half(n):
  return n / 2
end

def test_half():
  assert half(4) == 2
  assert get_standard_digital_out(0)
end

def test_fails():
  for n in range(3):
    assert half(n) < 1, "n is too large"
  end
end

def test_fails_deep():
  def deep():
    movel([9, 0, 0, 0, 0, 0])
  end
  deep()
end

def test_endless():
  while True:
    sleep(1)
  end
end

def test_halted():
  halt()
end

def tester():
  halt()
end
"""


def script(pytester: pytest.Pytester, text: str, *words: str, name: str = "test_it.script") -> pytest.RunResult:
    """Run the tests of one script in this process."""
    (pytester.path / name).write_text(text)
    return pytester.runpytest_inprocess("-p", "no:cacheprovider", *words)


class TestCollection:
    def test_by_name_or_if_named(self, pytester):
        for name in ("test_a.script", "b_test.script", "c.script"):
            (pytester.path / name).write_text("def test_it():\n  sleep(1)\nend\n")
        result = pytester.runpytest_inprocess("--collect-only", "-q", "-p", "no:cacheprovider")
        assert sorted(line for line in result.outlines if "::" in line) == [
            "b_test.script::test_it",
            "test_a.script::test_it",
        ]
        pytester.runpytest_inprocess("c.script", "-p", "no:cacheprovider").assert_outcomes(passed=1)

    def test_a_name_in_capitals_is_a_program_too(self, pytester):
        for name in ("TEST_A.SCRIPT", "b_test.Script", "CELL.SCRIPT"):
            (pytester.path / name).write_text("def test_it():\n  sleep(1)\nend\n")
        pytester.runpytest_inprocess("-p", "no:cacheprovider").assert_outcomes(passed=2)
        pytester.runpytest_inprocess("CELL.SCRIPT", "-p", "no:cacheprovider").assert_outcomes(passed=1)

    def test_links_to_a_file_and_links_that_go_round_add_no_tests(self, pytester):
        folder = pytester.mkdir("programs")
        (folder / "test_it.script").write_text("def test_it():\n  sleep(1)\nend\n")
        (folder / "test_alias.script").symlink_to("test_it.script")
        (folder / "round").symlink_to("..", target_is_directory=True)
        (folder / "test_loop.script").symlink_to("test_loop.script")
        (pytester.path / "more").symlink_to("programs", target_is_directory=True)
        pytester.runpytest_inprocess("-p", "no:cacheprovider").assert_outcomes(passed=1)
        both = ("programs/test_it.script::test_it", "programs/test_alias.script::test_it")
        pytester.runpytest_inprocess("-p", "no:cacheprovider", both[1]).assert_outcomes(passed=1)
        pytester.runpytest_inprocess("-p", "no:cacheprovider", both[0], both[0]).assert_outcomes(passed=1)
        pytester.runpytest_inprocess("-p", "no:cacheprovider", *both).assert_outcomes(passed=2)

    def test_a_link_to_a_file_that_is_not_found_by_itself_is_collected_once(self, pytester):
        for folder in ("cells", "build", ".hidden"):
            pytester.mkdir(folder)
        for name in ("build/test_a.script", ".hidden/test_b.script", "plain.script"):
            (pytester.path / name).write_text("def test_it():\n  sleep(1)\nend\n")
            for link in ("test", "test_again"):
                (pytester.path / "cells" / f"{link}_{name[-8]}.script").symlink_to(pytester.path / name)
        pytester.runpytest_inprocess("-p", "no:cacheprovider").assert_outcomes(passed=3)

    def test_one_can_be_chosen(self, pytester):
        (pytester.path / "test_it.script").write_text(GRIPPER)
        pytester.runpytest_inprocess("test_it.script::test_half", "-p", "no:cacheprovider").assert_outcomes(passed=1)

    def test_functions_of_one_program_are_tests_too(self, pytester):
        text = "def cell():\n  x = 4\n  def test_it():\n    assert x == 4\n  end\nend\n"
        script(pytester, text).assert_outcomes(passed=1)

    @pytest.mark.parametrize(
        ("text", "shown"),
        [
            ("def test_it():\n  x = (\nend\n", "*test_it.script:*line 2*error E*"),
            ("def test_it(a):\n  x = a\nend\n", "*test_it has parameters without a default*"),
            (
                "# elitescript: robt=CS66\ndef test_it():\n  x = 1\nend\n",
                "*line 1: *no setting 'robt'; did you mean 'rob*",
            ),
            ("# elitescript: seed=no\ndef test_it():\n  x = 1\nend\n", "*line 1: seed must be a whole number*'no'*"),
            ("# elitescript: until\ndef test_it():\n  x = 1\nend\n", "*line 1: write NAME=VALUE*"),
            ("# elitescript: network=a/b\ndef test_it():\n  x = 1\nend\n", "*line 1: network must be*'a/b'*"),
            ("# elitescript: limit_s=x\ndef test_it():\n  x = 1\nend\n", "*line 1: limit_s must be*'x'*"),
            ("# elitescript: plant=a\ndef test_it():\n  x = 1\nend\n", "*plant cannot be given here*"),
        ],
    )
    def test_a_mistake_in_the_file_is_an_error_of_its_collection(self, pytester, text, shown):
        # Else pytest prepares the traceback of its own interruption, which takes longer than all the rest.
        result = script(pytester, text, "--continue-on-collection-errors")
        result.assert_outcomes(errors=1)
        result.stdout.fnmatch_lines([shown])


class TestRun:
    def test_the_comment_says_what_it_reaches(self, pytester):
        connect = 'def test_it():\n  assert socket_open("192.168.1.5", 502)\nend\n'
        result = script(pytester, "# elitescript: network=10.0.0.0/8,plc:502 controller_version=2.15.0.0\n" + connect)
        result.assert_outcomes(failed=1)
        result.stdout.fnmatch_lines(
            ["*has refused 1 connection*; `# elitescript: network=10.0.0.0/8,plc:502,192.168.1.5:502` allows it"]
        )

    def test_the_comment_has_the_limits_of_the_marker(self, pytester):
        text = "# elitescript: limit_s=2 wall_limit_s=60\ndef test_it():\n  sleep(3)\nend\n"
        script(pytester, text).assert_outcomes(failed=1)

    def test_body_header_and_ways_to_fail(self, pytester):
        result = script(pytester, GRIPPER)
        result.assert_outcomes(passed=1, failed=4)
        result.stdout.fnmatch_lines(
            [
                "*test_it.script:16: in test_fails",
                ">   assert half(n) < 1, *",
                "E   n is too large",
                "E   assert 1.0 < 1",
                "*test_it.script on CS612: alarm after 0.000 s",
                "*test_it.script:24: in test_fails_deep",
                "    deep()",
                "*test_it.script:22: in deep",
                ">   movel(*",
                "E   R111 RuntimeError: movel: *",
                "E   still running after 5 s of robot time*",
                "E   main: line 29, `while True` in line 28 has no end",
                "E   the program has ended before test_halted returned: stopped",
            ]
        )

    def test_each_test_has_a_fresh_robot(self, pytester):
        text = (
            "def test_one():\n  assert not get_flag(1)\n  set_flag(1, True)\nend\n"
            "def test_two():\n  assert not get_flag(1)\n  set_flag(1, True)\nend\n"
        )
        script(pytester, text).assert_outcomes(passed=2)

    @pytest.mark.parametrize(
        ("condition", "text"),
        [
            ("1 + 1 == 3", "assert 2 == 3"),
            ("'a' in ['b']", "assert 'a' in ['b']"),
            ("not [1]", "assert not [1]"),
            ("[]", "assert []"),
            ("1 < 2 < 2", "assert False"),
            ("1 == 2, 'why ' + str(3)", "why 3"),
            ("{1: 2} == {1: 3}", "assert {1: 2} == {1: 3}"),
        ],
    )
    def test_an_assertion_shows_its_values(self, pytester, condition, text):
        result = script(pytester, f"def test_it():\n  assert {condition}\nend\n")
        result.stdout.fnmatch_lines([f"E   {text.replace('[', '[[]')}"])

    def test_sides_are_evaluated_once_and_in_order(self, pytester):
        text = """
def test_it():
  seen = []
  def note(value):
    seen.append(value)
    return value
  end
  assert note(1) < note(2)
  assert not note(0)
  assert note(3)
  assert seen == [1, 2, 0, 3]
end
"""
        script(pytester, text).assert_outcomes(passed=1)

    def test_a_mock_takes_the_place_of_a_command(self, pytester):
        text = """
targets = []
def mock_movej(q, a=1, v=1, t=0, r=0):
  targets.append(q)
end
def home():
  movej([9, 9, 9, 9, 9, 9], a=2)
end
def test_it():
  home()
  assert targets == [[9, 9, 9, 9, 9, 9]]
end
"""
        script(pytester, text).assert_outcomes(passed=1)
        result = script(pytester, text.replace("mock_movej", "mock_movv"))
        result.stdout.fnmatch_lines(["*line 3: mock_movv is the mock of no command; did you mean 'mov*'?*"])

    def test_a_body_that_returns_is_no_test(self, pytester):
        result = script(pytester, "def cell():\n  def test_it():\n    x = 1\n  end\n  return\nend\n")
        result.stdout.fnmatch_lines(["E   the file has returned before test_it was called"])

    def test_the_world_of_the_header(self, pytester):
        (pytester.path / "cell.toml").write_text('[signals]\n"standard_digital_in[3]" = true\n')
        header = '# elitescript: world="cell.toml" strict=true speed=0.5'
        text = f"{header}\ndef test_it():\n  assert get_standard_digital_in(3)\nend\n"
        script(pytester, text).assert_outcomes(passed=1)
