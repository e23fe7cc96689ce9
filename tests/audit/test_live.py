"""What is said of a controller while its program runs, against a program that differs in a known way."""

from __future__ import annotations

from pathlib import Path

import pytest

from elitescript.audit.live import Said, Shadow
from elitescript.audit.live_run import Expected
from elitescript.audit.motion import Tolerance
from elitescript.audit.simulation import cell_of
from elitescript.language.text.source import SourceFile
from elitescript.messages.state import Payload
from elitescript.recorder.recording import Message
from tests.audit.live_rows import differences, disturbed, live_rows, shadowed
from tests.audit.programs import GRIPPER, LOOP, MOVES
from tests.audit.recording_runs import record_run

EXAMPLES = Path(__file__).parents[2] / "examples"

PAYLOAD = """def main():
  set_payload(1.5, [0, 0, 0.05])
  movej([0.3, -1.5, -1.5, -1.5, 1.5, 0.2], a=4, v=1.0)
  sleep(0.8)
end
main()
"""

PLANTED = {
    "speed": (MOVES, "a=8, v=1.0", "a=8, v=0.9", 5, "speed"),
    "target": (MOVES, "[0.4, -1.4, -1.3", "[0.4, -1.4, -1.2", 6, "target"),
    "a stuck input": (MOVES, "sleep(0.1)", "sleep(0.9)", 4, "waiting"),
    "a missing output": (MOVES, "out(3, False)", "out(5, True)", 6, "signal"),
    "a number": (MOVES, "register(1, 2.5)", "register(1, 7.5)", 6, "signal"),
    "another pass": (LOOP, "i < 3", "i < 4", 4, "program"),
    "payload": (PAYLOAD, "payload(1.5", "payload(2.5", 3, "payload"),
}


@pytest.mark.parametrize("name", PLANTED)
def test_a_difference_is_said_within_a_second(name):
    program, given, planted, line, cause = PLANTED[name]
    said = differences(shadowed(live_rows(record_run(program.replace(given, planted), after_s=0.6)), program))
    assert (said[0].line, said[0].cause) == (line, cause)
    assert said[0].delay_s <= 1.0
    # The rest is the same again, or the same difference: nothing is said for each row.
    assert len(said) <= 2


def test_what_differs_later_is_said_for_itself():
    other = MOVES.replace("a=8, v=1.0", "a=8, v=0.9").replace("sleep(0.05)", "sleep(0.7)")
    said = differences(shadowed(live_rows(record_run(other, after_s=0.6)), MOVES))
    assert [(its.line, its.cause) for its in said] == [(5, "speed"), (10, "waiting")]
    assert max(its.delay_s for its in said) <= 1.0


def test_another_program_is_named_as_such():
    said = differences(shadowed(live_rows(record_run("x = 0\n" * 40 + GRIPPER, until_s=2.0)), MOVES))
    assert said[0].cause == "program"
    assert said[0].what.startswith("another program runs")
    assert said[0].delay_s <= 1.0


def test_slider_and_safety_are_said_and_given_to_the_simulated_robot():
    acts = {0.3: lambda robot: robot.set_speed(0.5), 0.9: lambda robot: robot.protective_stop("planted")}
    said = differences(shadowed(live_rows(record_run(MOVES, acts=acts, until_s=2.2)), MOVES))
    assert [its.cause for its in said] == ["slider", "safety"]
    assert max(its.delay_s for its in said) <= 1.0


def test_an_expected_slider_is_no_difference():
    rows = list(live_rows(record_run(MOVES, after_s=0.6, speed=0.5)))
    assert not differences(shadowed(rows, MOVES, speed=0.5))
    assert [its.cause for its in differences(shadowed(rows, MOVES))] == ["slider"]


def test_a_program_that_waits_in_one_place_is_said():
    rows = live_rows(record_run(GRIPPER, until_s=3.0))
    said = differences(shadowed(rows, GRIPPER, wait_s=1.5))
    assert [(its.cause, its.line) for its in said] == [("waiting", 5)]
    assert "waits in line" in said[0].what


def test_an_expected_payload_is_compared_with_that_of_the_arm():
    rows = list(live_rows(record_run(MOVES, after_s=0.6)))
    said = differences(shadowed(rows, MOVES, payload=Payload(2.0, (0.0, 0.0, 0.1))))
    assert [its.cause for its in said] == ["payload"]
    assert said[0].what == "the payload is 0 kg at (0, 0, 0) m, simulated 2 kg at (0, 0, 0.1) m"


def test_lengths_of_another_arm_are_said():
    configuration = {
        "type": "configuration",
        "DH a": [0.0, 0.0, -0.5, -0.3, 0.0, 0.0],
        "DH d": [0.16, 0.0, 0.0, 0.13, 0.1, 0.09],
        "DH alpha": [0.0] * 6,
        "joint limits": [0.0] * 12,
        "joint maxima": [0.0] * 12,
        "default joint velocity": 0.0,
        "default joint acceleration": 0.0,
        "default tool velocity": 0.0,
        "default tool acceleration": 0.0,
    }
    message = Message(0.0, 0.0, "primary", configuration)
    answer = Message(0.0, 0.0, "dashboard", {"type": "answer", "question": "robot -t", "answer": "CS66"})
    said = differences(shadowed([answer, message, *live_rows(record_run(MOVES, after_s=0.6))], MOVES, model=None))
    assert {its.cause for its in said} == {"configuration"}


def test_runs_follow_each_other_and_agree_again():
    good, bad = record_run(MOVES, after_s=0.6), record_run(MOVES.replace("a=8, v=1.0", "a=8, v=0.9"), after_s=0.6)
    rows = [*live_rows(good), *live_rows(bad, shift_s=10.0), *live_rows(good, shift_s=20.0)]
    said = shadowed(rows, MOVES)
    assert [its.run for its in said if its.kind == "end"] == [1, 2, 3]
    assert [its.run for its in differences(said)] == [2]


def test_what_is_found_of_a_program_that_ran_already_may_come_from_its_variables():
    rows = list(live_rows(record_run(LOOP, after_s=0.6)))
    said = shadowed(rows[250:], LOOP)
    assert said[0].kind == "joined"
    assert not differences(said)


def test_rows_that_are_missing_for_long_are_no_difference():
    rows = [row for row in live_rows(record_run(LOOP, after_s=0.6)) if not 0.5 < row.t < 1.6]
    said = shadowed(rows, LOOP)
    assert not differences(said)
    assert any("no rows for 1.1 s" in its.what for its in said)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("name", ["circles", "error_handling", "runstate_outputs"])
def test_lost_doubled_and_late_rows_are_no_difference(name, seed):
    path = EXAMPLES / f"{name}.script"
    rows = disturbed(live_rows(record_run(path, after_s=0.6, until_s=4.0)), seed, lost=0.05)
    assert not differences(shadowed(rows, path))


@pytest.mark.parametrize("ours", ["    sleep(0.1)\n    sync()\n", "    sleep(9)\n", "    sleep(0.1)\n    sleep(99)\n"])
def test_few_rows_are_kept_of_a_long_run(ours):
    """Whether both agree, stand in one line for long, or the simulated program never goes on."""
    head, tail = "def main():\n  while True:\n", "  end\nend\nmain()\n"
    theirs = ours.replace("sleep(99)", "sync()")
    said: list[Said] = []
    source = SourceFile("<cell>", head + ours + tail)
    shadow = Shadow(Expected(cell_of(source, "CS66"), Tolerance()), said.append)
    most = 0
    for row in live_rows(record_run(head + theirs + tail, until_s=24.0)):
        shadow.take(row)
        most = max(most, shadow.rows_kept)
    assert most < 12 * 500
    if theirs == ours:
        assert most < 3 * 500
        assert not differences(said)
    else:
        assert differences(said)


def test_an_input_that_the_simulated_world_gives_and_the_arm_does_not_get(tmp_path):
    world = tmp_path / "cell.toml"
    world.write_text(
        '[[wire]]\nwhen = "standard_digital_out[0]"\nthen = "standard_digital_in[2]"\nafter_s = 0.3\n', encoding="utf-8"
    )
    said = differences(shadowed(live_rows(record_run(GRIPPER, until_s=3.0)), GRIPPER, model=None, world=world))
    assert said[0].cause in ("signal", "waiting")
    assert said[0].line in (4, 5)
    assert said[0].delay_s <= 1.0
    assert len(said) <= 2
