"""Recorded runs against simulated ones: what agrees, and what every planted difference is called."""

from __future__ import annotations

import json
from array import array
from functools import cache
from math import inf, nan

import pytest

from elitescript.audit import Tolerance, audit
from elitescript.audit.series import runs_of
from elitescript.errors import UsageError
from elitescript.messages.plant import PlantConfig
from elitescript.models.model import load_model
from elitescript.recorder.recording import Message, Recording
from elitescript.records import replace
from elitescript.testing.world import Wire, World
from tests.audit.programs import GRIPPER, LOOP, MOVES
from tests.audit.recording_runs import VARIABLES, record_run

ACKNOWLEDGED = ((0.4, "standard_digital_in[2]", True), (0.9, "standard_digital_in[2]", False))


@cache
def undisturbed(program: str, at=()) -> Recording:
    return record_run(program, at=at)


def without(recording: Recording, name: str) -> dict:
    return {column: values for column, values in recording.columns.items() if column.partition(".")[0] != name}


def changed(program: str, old: str, new: str) -> str:
    assert program.count(old) == 1, old
    return program.replace(old, new)


def arm_facts(**changed: object) -> dict:
    a, d, alpha = load_model("CS66").arm.modified_dh
    return {"model": "OURS", "lengths": {"a": a, "d": d, "alpha": alpha, **changed}}


class TestArms:
    @pytest.mark.parametrize("lengths", [{}, {"alpha": [0.0] * 6}])
    def test_an_arm_of_another_name_with_the_same_lengths_is_the_same(self, lengths):
        found = audit(replace(undisturbed(MOVES), facts=arm_facts(**lengths)), MOVES, robot="CS66")
        assert found.agrees
        assert found.not_compared == ()

    def test_other_lengths_are_a_difference_and_compared(self):
        d = list(load_model("CS66").arm.modified_dh[1])
        d[5] += 0.003
        found = audit(replace(undisturbed(MOVES), facts=arm_facts(d=d)), MOVES, robot="CS66")
        assert [its.name for its in found.arm] == ["d6"]
        assert found.not_compared == ()

    def test_an_arm_of_another_name_that_shows_no_lengths_is_not_compared(self):
        recording = replace(undisturbed(MOVES), facts={"model": "OURS"})
        words = "lengths of the arm: the recording shows none of its OURS, the simulated one is CS66"
        assert audit(recording, MOVES, robot="CS66").not_compared == (words,)


class TestAgreement:
    @pytest.mark.parametrize(
        ("program", "settings"),
        [
            (MOVES, {}),
            (MOVES, {"plant": PlantConfig(lag_s=0.02, noise_rad=1e-4), "noise_rad": 1e-3}),
            (MOVES, {"wait_s": 0.212, "phase_s": 0.0013}),
            (MOVES, {"lost": 0.05, "jitter_s": 0.02}),
            (MOVES, {"hz": 125.0}),
            (MOVES, {"speed": 0.4}),
            (MOVES, {"acts": {0.3: lambda robot: robot.set_speed(0.5), 0.6: lambda robot: robot.set_speed(1.0)}}),
            (MOVES, {"acts": {0.5: lambda robot: robot.pause(), 0.8: lambda robot: robot.resume()}}),
            (MOVES, {"at": [(0.3, "safeguard_stop", True), (0.7, "safeguard_stop", False)]}),
            (MOVES, {"at": [(0.3, "reduced_mode", True), (0.7, "reduced_mode", False)]}),
            (MOVES, {"until_s": 0.5}),
            (MOVES, {"variables": [name for name in VARIABLES if name != "script_control_line"]}),
            (MOVES, {"variables": [name for name in VARIABLES if name != "target_joint_speeds"]}),
            (LOOP, {"lost": 0.03, "seed": 2}),
            (LOOP, {"at": [(0.3, "standard_digital_in[1]", True)]}),
            (GRIPPER, {"at": ACKNOWLEDGED}),
            (GRIPPER, {"at": ACKNOWLEDGED, "lost": 0.04, "seed": 5, "speed": 0.6}),
        ],
    )
    def test_what_comes_from_outside_and_what_is_not_exact_is_no_difference(self, program, settings):
        found = audit(record_run(program, **settings), program)
        assert found.agrees, str(found)
        assert found.divergence is None

    def test_the_same_run_is_the_same_to_the_last_digits(self):
        comparison = audit(undisturbed(MOVES), MOVES).first.comparison
        assert comparison.joints.largest < 1e-12
        assert comparison.path.largest < 1e-12
        assert comparison.measured.largest < 1e-12
        assert all(line.recorded_s == pytest.approx(line.simulated_s) for line in comparison.lines)

    def test_inputs_come_where_they_belong_in_the_program_not_at_their_time(self):
        slower = changed(
            GRIPPER,
            "movej([0.1, -1.5, -1.5, -1.5, 1.5, 0.2], a=10, v=1.5)",
            "movej([0.1, -1.5, -1.5, -1.5, 1.5, 0.2], a=2, v=0.5)",
        )
        found = audit(
            record_run(slower, at=((0.9, "standard_digital_in[2]", True), (1.3, "standard_digital_in[2]", False))),
            GRIPPER,
        )
        assert [(finding.line, finding.cause) for finding in found.first.comparison.findings] == [(2, "acceleration")]

    def test_a_stop_from_outside_is_named_and_no_difference(self):
        found = audit(record_run(MOVES, acts={0.4: lambda robot: robot.stop()}), MOVES)
        assert found.agrees
        assert "was ended at 0.404 s in line 4" in str(found)

    def test_an_exception_that_the_controller_told_of_is_a_difference(self):
        recording = record_run(changed(LOOP, "(5, i)", "(5, 1 / 0)"))
        end_s = recording.t[-5]
        data = {"type": "script exception", "timestamp": round(1e6 * end_s), "line": 16, "column": 1, "text": "1 / 0"}
        told = replace(recording, messages=(Message(end_s, end_s, "primary", data),))
        assert "ends behind line 14 (line 16: 1 / 0), the simulated one goes on with line 17" in str(audit(told, LOOP))

    def test_a_recording_that_begins_in_the_middle_is_compared_from_there(self):
        whole = undisturbed(LOOP)
        later = 120
        part = replace(
            whole,
            t=whole.t[later:],
            arrived_s=whole.arrived_s[later:],
            columns={name: values[later:] for name, values in whole.columns.items()},
        )
        assert "ran already when the recording began" in str(audit(part, LOOP))

    def test_a_part_of_one_move_cannot_be_compared_and_is_no_difference(self):
        whole = undisturbed(MOVES)
        for part in (slice(60, 61), slice(60, 75)):
            cut = replace(
                whole,
                t=whole.t[part],
                arrived_s=whole.arrived_s[part],
                columns={name: values[part] for name, values in whole.columns.items()},
            )
            with pytest.raises(UsageError, match="so nothing is compared"):
                audit(cut, MOVES)

    @pytest.mark.parametrize("value", [nan, inf, 1e300, -7.0, 99.0])
    @pytest.mark.parametrize("name", ["safety_status", "script_control_line", "target_speed_fraction", "payload_mass"])
    def test_a_value_that_no_controller_should_have_is_survived(self, name, value):
        whole = undisturbed(MOVES)
        column = array("d", whole.columns[name])
        column[90] = value
        found = audit(replace(whole, columns={**whole.columns, name: column}), MOVES, fit=True)
        assert json.loads(json.dumps(found.json(), allow_nan=False))["agrees"] or name == "script_control_line"
        assert str(found)

    def test_texts_of_the_controller_do_nothing_to_a_terminal(self):
        recording = record_run(changed(LOOP, "(5, i)", "(5, 1 / 0)"))
        end_s = recording.t[runs_of(recording)[0].stop - 1]
        data = {"type": "script exception", "timestamp": round(1e6 * end_s), "line": 16, "text": "\x1b[2Jx\r\nagrees"}
        told = replace(
            recording, messages=(Message(end_s, end_s, "primary", data),), facts={"model": "\x1b]0;x\x07\nagrees"}
        )
        text = str(audit(told, LOOP, robot="CS66"))
        assert "\\x1b[2Jx\\r\n| agrees" in text
        assert "\nagrees" not in text
        assert text.replace("\n", "").isprintable()

    def test_a_recording_without_safety_modes(self):
        whole = undisturbed(MOVES)
        assert audit(replace(whole, columns=without(whole, "safety_status")), MOVES).agrees

    def test_the_tolerance_decides(self):
        recording = record_run(changed(MOVES, "sleep(0.1)", "sleep(0.12)"))
        assert not audit(recording, MOVES).agrees
        assert audit(recording, MOVES, tolerance=Tolerance(time_s=0.03)).agrees


PLANTED = [
    # program, change, line, cause, words, time from to
    (MOVES, "v=1.0, r=0.03", "v=0.7, r=0.03", 5, "speed", "0.7 instead of 1 rad/s", 0.3, 0.9),
    (MOVES, "a=8, v=0.8)", "a=2, v=0.8)", 6, "acceleration", "instead of 8 rad/s^2", 0.5, 1.1),
    (MOVES, "a=3, v=0.3)", "a=3, v=0.1)", 9, "speed", "simulated", 0.8, 1.5),
    (MOVES, "r=0.03", "r=0.01", 5, "blend", "blend into the next move", 0.3, 0.8),
    (MOVES, ", r=0.03", "", 5, "blend", "blend into the next move", 0.3, 0.8),
    (MOVES, "[0.4, -1.4,", "[0.4, -1.395,", 6, "target", "joint 2 is up to 0.005", 0.5, 1.0),
    (MOVES, "[0.1, -1.6,", "[0.1, -1.602,", 2, "target", "joint 2 is up to 0.002", 0.0, 0.3),
    (MOVES, "sleep(0.1)", "sleep(0.3)", 4, "waiting", "waits longer", 0.3, 0.5),
    (MOVES, "sleep(0.1)", "sleep(0.01)", 4, "waiting", "waits less", 0.2, 0.4),
    (MOVES, "out(3, False)", "out(5, True)", 6, "signal", "standard_digital_out[5] becomes on", 0.5, 1.2),
    (MOVES, "(1, 2.5)", "(1, 2.6)", 6, "signal", "output_float_register[1] is 2.6, simulated 2.5", 0.5, 1.2),
    (
        LOOP,
        "out(4, True)",
        "out(4, False)",
        4,
        "signal",
        "standard_digital_out[4] becomes on in the simulated run only",
        0.0,
        0.3,
    ),
    (LOOP, "i < 3", "i < 4", 4, "program", "lines 4, 6, 7 once more, the simulated run does not", 0.5, 2.0),
    (LOOP, "i < 3", "i < 2", 7, "program", "lines 4, 6, 7 once more, the recording does not", 0.3, 1.5),
    (LOOP, "if get", "if not get", 12, "program", "line 12, the simulated run with line 14", 0.5, 2.0),
    (LOOP, "(5, i)", "(5, 7)", 14, "signal", "output_int_register[5] becomes 7, simulated 3", 0.8, 2.5),
    (LOOP, "  sleep(0.05)\nend", "end", 14, "program", "ends behind line 14", 0.8, 2.5),
    (LOOP, "(5, i)", "(5, 1 / 0)", 14, "program", "ends behind line 14", 0.8, 2.5),
    (LOOP, "  i = 0\n", "  i = 0\n  sleep(0.2)\n", 3, "program", "the recording goes on with line", 0.0, 0.1),
    (GRIPPER, "out(0, False)", "out(0, True)", 7, "signal", "standard_digital_out[0] becomes off", 0.3, 0.9),
]
"""Changes of the recorded program, and what an audit with the unchanged one has to say first."""


class TestPlanted:
    @pytest.mark.parametrize(("program", "old", "new", "line", "cause", "words", "from_s", "to_s"), PLANTED)
    def test_the_first_difference(self, program, old, new, line, cause, words, from_s, to_s):
        at = ACKNOWLEDGED if program is GRIPPER else ()
        text = changed(program, old, new)
        found = audit(record_run(text, at=at), program)
        finding = found.divergence
        assert (finding.line, finding.cause) == (line, cause), str(found)
        assert words in finding.what
        assert from_s <= finding.t <= to_s
        assert words in str(found)
        assert found.json()["divergence"]["line"] == line

    def test_a_line_more_in_the_recorded_program(self):
        found = audit(record_run(changed(LOOP, "  i = 0\n", "  i = 0\n  sleep(0.2)\n")), LOOP)
        assert "lines of the recording are 1 higher than those of the program" in str(found)

    def test_what_happens_again_and_again_is_said_once(self):
        found = audit(record_run(changed(LOOP, "    sleep(0.05)", "    sleep(0.15)")), LOOP)
        assert len(found.first.comparison.findings) == 3
        assert "the same in this line 2 times more" in str(found)

    def test_a_slider_is_an_input_and_its_share_of_the_time_is_said(self):
        found = audit(record_run(MOVES, speed=0.5), MOVES)
        assert found.agrees
        times = {line.line: line for line in found.first.comparison.lines}
        assert times[5].cause == "slider"
        assert times[5].slowed_s == pytest.approx(0.5 * times[5].recorded_s, rel=0.05)
        assert times[4].cause == ""
        assert "speed slider           50%" in str(found)

    def test_without_the_slider_the_speed_scaling_is_taken(self):
        recording = record_run(MOVES, speed=0.5)
        del recording.columns["target_speed_fraction"]
        found = audit(recording, MOVES)
        assert found.agrees
        assert {line.line: line for line in found.first.comparison.lines}[5].cause == "speed scaling"

    def test_a_speed_scaling_that_is_not_the_slider(self):
        recording = record_run(MOVES, speed=0.5)
        for row in range(len(recording.t)):
            recording.columns["target_speed_fraction"][row] = 1.0
        finding = audit(recording, MOVES).divergence
        assert (finding.line, finding.cause) == (2, "speed scaling")
        assert "speed scaling 50% at a slider of 100%" in finding.what

    def test_without_both_it_may_be_the_one_or_the_other(self):
        recording = record_run(MOVES, speed=0.5)
        del recording.columns["target_speed_fraction"], recording.columns["speed_scaling"]
        found = audit(recording, MOVES)
        assert (found.divergence.line, found.divergence.cause) == (2, "acceleration")
        assert "or the speed scaling, which is not recorded" in found.divergence.what
        assert "the speed slider: the recording has neither" in str(found)

    def test_a_stuck_input_of_the_world(self, tmp_path):
        world = tmp_path / "cell.toml"
        world.write_text('[[wire]]\nwhen = "standard_digital_out[0]"\nthen = "standard_digital_in[2]"\nafter_s = 0.2\n')
        wired = World(wires=[Wire(when="standard_digital_out[0]", then="standard_digital_in[2]", after_s=0.2)])
        good = record_run(GRIPPER, world=wired)
        assert audit(good, GRIPPER, world=world).agrees
        stuck = record_run(GRIPPER, until_s=1.5)
        found = audit(stuck, GRIPPER, world=world)
        assert "standard_digital_in[2] becomes on in the simulated run only" in str(found)
        # Without the world nothing contradicts the recorded input.
        assert audit(stuck, GRIPPER).agrees

        # The edge that the program waits for comes first, whatever the simulated run does behind it.
        assert (found.divergence.line, found.divergence.cause) == (5, "signal")
        assert 0.45 < found.divergence.t < 0.52

    def test_a_recording_that_ends_in_a_longer_wait(self):
        recording = record_run(changed(MOVES, "sleep(0.1)", "sleep(9)"), until_s=1.0)
        finding = audit(recording, MOVES).divergence
        assert (finding.line, finding.cause) == (4, "waiting")
        assert "waits still after" in finding.what
        # A wait that nobody knows the end of is no difference as long as both wait.
        assert audit(recording, changed(MOVES, "sleep(0.1)", "sleep(8)")).agrees

    def test_an_arm_that_does_not_move_where_it_should(self):
        move = "  movej([0.1, -1.6, -1.7, -1.3, 1.5, {}])\n"
        text = f"def p():\n{move.format('0.1')}  x = 1\n{move.format('Q')}end\n"
        still, moved = text.replace("Q", "0.1"), text.replace("Q", "0.3")
        finding = audit(record_run(still), moved).divergence
        assert finding.line == 4

    def test_one_more_pass_with_other_places_is_the_last_one(self):
        text = """def p():
  movej([0.1, -1.6, -1.7, -1.3, 1.5, 0.1], a=8, v=2)
  i = 0
  while i < 3:
    movej([0.1 + 0.1 * i, -1.6, -1.6, -1.3, 1.5, 0.1], a=8, v=2)
    sleep(0.02)
    i = i + 1
  end
  movej([0.0, -1.6, -1.7, -1.3, 1.5, 0.1], a=8, v=2)
end
"""
        for count, side in ((4, "the recording goes"), (2, "the simulated run goes")):
            found = audit(record_run(changed(text, "i < 3", f"i < {count}")), text)
            assert side in found.divergence.what
            assert "once more" in found.divergence.what
            later = [finding.what for finding in found.first.comparison.findings[1:]]
            assert all("begins elsewhere" in what for what in later), later

    def test_a_tcp_that_the_program_sets_is_no_error_of_the_path(self):
        text = changed(MOVES, "def main():\n", "def main():\n  set_tcp([0, 0, 0.1, 0, 0, 0])\n")
        found = audit(record_run(text), text)
        assert found.agrees
        assert found.json()["errors"]["path"]["largest"] < 1e-3

    def test_other_lengths_come_first(self):
        lengths = {"a": (0, 0, -0.427, -0.3905, 0, 0), "d": (0.1625, 0, 0, 0.1475, 0.0965, 0.095), "alpha": ()}
        found = audit(replace(undisturbed(MOVES), facts={"model": "CS66", "lengths": lengths}), MOVES)
        assert found.divergence is None
        assert not found.agrees
        assert found.json()["arm"] == [{"name": "d6", "unit": "m", "recorded": 0.095, "model": 0.092}]
        assert "d6: 95 mm, model 92 mm" in str(found).split("\n")[2]


class TestRuns:
    def test_each_run_of_a_recording(self):
        first, second = undisturbed(LOOP), record_run(changed(LOOP, "sleep(0.05)\nend", "sleep(0.2)\nend"))
        shift_s = first.t[-1] + 1.0 - second.t[0]
        both = replace(
            first,
            t=first.t + type(first.t)("d", [t + shift_s for t in second.t]),
            arrived_s=first.arrived_s + second.arrived_s,
            columns={name: values + second.columns[name] for name, values in first.columns.items()},
        )
        found = audit(both, LOOP)
        assert [run.comparison.divergence is None for run in found.runs] == [True, False]
        assert found.first.number == 2
        assert audit(both, LOOP, run=1).agrees
        with pytest.raises(UsageError, match="the runs 1 to 2, got 3"):
            audit(both, LOOP, run=3)

    def test_the_program_of_the_recording(self):
        recording = replace(undisturbed(LOOP), attachments={"loop.script": LOOP.encode()})
        assert audit(recording).agrees

    def test_no_program(self):
        with pytest.raises(UsageError, match="holds no program"):
            audit(undisturbed(LOOP))

    def test_no_run(self):
        whole = undisturbed(LOOP)
        idle = replace(
            whole, t=whole.t[:10], arrived_s=whole.arrived_s[:10], columns={n: c[:10] for n, c in whole.columns.items()}
        )
        with pytest.raises(UsageError, match="no program ran"):
            audit(idle, LOOP)

    def test_no_targets(self):
        whole = undisturbed(LOOP)
        columns = {name: values for name, values in whole.columns.items() if not name.startswith("target_joint_pos")}
        with pytest.raises(UsageError, match="no target joint positions"):
            audit(replace(whole, columns=columns), LOOP)

    def test_devices_that_a_recording_does_not_show_are_named(self):
        program = (
            'def main():\n  socket_open("10.0.0.9", 5000)\n  movej([0.1, -1.5, -1.5, -1.5, 1.5, 0.2])\nend\nmain()\n'
        )
        found = audit(record_run(program, world=World()), program)
        assert "devices (socket): what they answered is not in a recording; --world gives them" in str(found)
