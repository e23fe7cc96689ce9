"""The verdict of `run`: what its last line, `end`, exit codes and formats say of findings."""

import json

import pytest

from elitescript.cli.main import main
from elitescript.robot import VirtualRobot

SERVO = "def f():\n  q = get_actual_joint_positions()\n  q[0] = q[0] + 0.8\n  servoj(q, t=0.008)\nend\n"
SOUND = "def f():\n  sleep(0.1)\nend\n"
ALARM = "def f():\n  x = 1 / len([])\nend\n"
HANG = "def f():\n  while not get_standard_digital_in(3):\n    sleep(0.1)\n  end\nend\n"
TEXT = "def f():\n  import numpy\nend\n"


@pytest.fixture
def call(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def run(text, *options, command="run"):
        path = tmp_path / "job.script"
        path.write_text(text, encoding="utf-8")
        code = main([command, str(path), *options])
        out, err = capsys.readouterr()
        return code, out, err

    return run


def end_of(out):
    return json.loads(out.splitlines()[-1])


@pytest.mark.parametrize(
    ("text", "options", "code", "last"),
    [
        (SOUND, (), 0, "finished (robot time;"),
        (SERVO, (), 0, "finished, 1 warning (robot time;"),
        (SERVO, ("--strict",), 1, "finished, 1 warning, which --strict does not allow (robot time;"),
        (SERVO, ("--strict", "--ignore", "W280"), 0, "finished (robot time;"),
        (SOUND, ("--strict",), 0, "finished (robot time;"),
        (ALARM, (), 1, "ended by an alarm (robot time;"),
        (HANG, ("--until", "1"), 4, "still running at the time limit (robot time;"),
        (SERVO.replace("0.008)", "0.008)  # check: ignore[W280]"), (), 0, "finished (robot time;"),
        (SERVO.replace("0.008)", "0.008)  # check: ignore[W230]"), (), 0, "finished, 1 warning (robot time;"),
    ],
)
def test_last_line_and_exit_code(call, text, options, code, last):
    found, out, _ = call(text, *options)
    assert (found, out.splitlines()[-1][14:].startswith(last)) == (code, True), out


def test_a_warning_of_a_line_with_a_comment_is_neither_printed_nor_in_json(call):
    text = SERVO.replace("0.008)", "0.008)  # check: ignore")
    code, out, _ = call(text, "--json")
    assert (code, [json.loads(line)["type"] for line in out.splitlines()]) == (0, ["end"])


@pytest.mark.parametrize(
    ("text", "options", "findings", "why"),
    [
        (SOUND, (), {"error": 0, "warning": 0, "note": 0}, None),
        (SERVO, (), {"error": 0, "warning": 1, "note": 0}, None),
        (ALARM, (), {"error": 1, "warning": 0, "note": 0}, "ZeroDivisionError: division by zero"),
        (HANG, ("--until", "1"), {"error": 0, "warning": 0, "note": 0}, "main is in line 3, "),
    ],
)
def test_end_counts_and_says_why(call, text, options, findings, why):
    end = end_of(call(text, "--json", *options)[1])
    assert end["findings"] == findings
    assert end["why"] is None if why is None else end["why"].startswith(why)


def test_a_warning_says_code_line_hint_and_source(call):
    records = [json.loads(line) for line in call(SERVO, "--json")[1].splitlines()]
    (warning,) = [record for record in records if record["type"] == "warning"]
    assert (warning["code"], warning["line"], warning["source"]) == ("W280", 4, "end")
    assert "movej" in warning["hint"]


def test_sarif_has_findings_of_text_and_run_and_nothing_else_is_on_standard_output(call):
    code, out, err = call('def f():\n  textmsg("hello")\n  x = 1 / len([])\n  movj(1)\nend\n', "--format", "sarif")
    log = json.loads(out)
    assert code == 1
    assert [row["ruleId"] for row in log["runs"][0]["results"]] == ["R100", "E301"]
    assert "hello" in err


def test_github_has_workflow_commands(call):
    _, out, _ = call(SERVO, "--format", "github")
    (line,) = out.splitlines()
    assert line.startswith("::warning file=job.script,line=4,")
    assert "W280" in line
    assert "at 0.008 s" in line


def test_a_text_that_does_not_compile_is_in_the_report(call):
    code, out, _ = call("def f():\n  x = = 1\nend\n", "--format", "sarif")
    assert code == 3
    assert [row["ruleId"] for row in json.loads(out)["runs"][0]["results"]] == ["E001"]


def test_json_and_another_format_contradict_each_other(call):
    assert call(SOUND, "--json", "--format", "sarif")[0] == 2


CAUGHT = "def f():\n  try:\n    movj(1)\n  except Exception:\n    sleep(0.1)\n  end\nend\n"
COMPARED = "def f():\n  x = get_standard_digital_in(0) == 'on'\n  sleep(0.1)\nend\n"


@pytest.mark.parametrize(("text", "code"), [(COMPARED, 3), (CAUGHT, 3), (SERVO, 1), (SOUND, 0)])
def test_strict_refuses_what_the_text_shows_and_fails_what_the_run_shows(call, text, code):
    assert call(text, "--strict")[0] == code
    assert call(text)[0] == 0


@pytest.mark.parametrize(
    ("text", "color"), [(SOUND, "32"), (COMPARED, "33"), (SERVO, "33"), (CAUGHT, "33"), (ALARM, "1;31")]
)
def test_only_an_end_without_errors_and_warnings_is_green(call, text, color):
    out = call(text, "--color", "always")[1]
    assert out.splitlines()[-1].split("s  ", 1)[1].startswith(f"\x1b[{color}m"), out


def test_a_run_that_the_time_limit_has_ended_is_an_error_of_both_formats(call):
    github = call(HANG, "--format", "github", "--until", "1")
    assert github[0] == 4
    assert github[1].startswith("::error file=job.script,line=3,title=not finished::still running at the time limit")
    (run,) = json.loads(call(HANG, "--format", "sarif", "--until", "1")[1])["runs"]
    (invocation,) = run["invocations"]
    (said,) = invocation["toolExecutionNotifications"]
    assert (invocation["executionSuccessful"], said["level"], run["results"]) == (False, "error", [])
    assert said["locations"][0]["physicalLocation"]["region"] == {"startLine": 3}


@pytest.mark.parametrize(
    ("text", "words"),
    [(SOUND, "finished ("), (SERVO, "finished, 1 warning ("), (CAUGHT, "finished, 1 error ("), (ALARM, "alarm (")],
)
def test_the_line_of_plot_counts_findings(call, text, words):
    assert f"of CS66, {words}" in call(text, "-o", "page.html", command="plot")[1]


def test_a_run_says_its_verdict_where_it_is_printed():
    run = VirtualRobot().run(COMPARED)
    assert (repr(run), run.verdict) == ("<Run finished, 1 warning, 0.100 s>", "finished, 1 warning")
    assert not run.is_clean
    assert VirtualRobot().run(SOUND).is_clean
