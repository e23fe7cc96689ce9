"""Parameters from recordings: arms with hidden parameters, and recordings made by hand."""

from array import array
from math import nan, sqrt

import pytest

from elitescript.audit.fit.arm_file import arm_text
from elitescript.audit.fit.least_squares import solve
from elitescript.audit.fit.program_moves import moves_of
from elitescript.audit.fit.recordings import clustered_sigma, fit_recording, summary
from elitescript.models.model import load_model, parse_model
from elitescript.recorder.recording import Recording
from elitescript.records import replace
from tests.audit.fit import hidden_arms
from tests.audit.recording_runs import VARIABLES, record_run

CS66 = load_model("CS66")
EXACT = ("d1", "a2", "a3", "d4", "d5", "d6", "payload_kg", "speed_slider", "qd_max.1", "qd_max.4")
DEFAULTS = tuple(f"default_{name}" for name in ("joint_speed", "joint_acceleration", "tool_speed", "tool_acceleration"))


@pytest.fixture(scope="module")
def hidden(tmp_path_factory):
    arm = hidden_arms.hidden_arm(7)
    return arm, hidden_arms.recorded_in_memory(arm, tmp_path_factory.mktemp("hidden"))


@pytest.fixture(scope="module")
def found(hidden):
    fit = fit_recording(hidden[1], CS66, hidden_arms.AUDITED_PROGRAM)
    return fit, {parameter.name: parameter for parameter in fit.parameters}


@pytest.mark.parametrize("name", [*EXACT, *DEFAULTS])
def test_what_was_hidden_is_found_and_differs_from_the_model(name, hidden, found):
    true = hidden[0].true[name]
    parameter = found[1][name]
    low, high = parameter.interval
    assert low <= true <= high
    assert high - low < 1e-5
    assert parameter.differs is (parameter.model is not None)


def test_drives_and_torques_are_found_within_their_noise(hidden, found):
    true = hidden[0].true
    for name, accuracy in (("plant.lag_s", 2e-4), ("plant.noise_rad", 2e-5)):
        assert found[1][name].found == pytest.approx(true[name], abs=accuracy)
        low, high = found[1][name].interval
        assert 0.0 < high - low < 2.0 * accuracy
    assert found[1]["payload_of_torques_kg"].found == pytest.approx(true["payload_kg"], abs=2e-3)


def test_what_no_move_shows_is_a_lower_bound(found):
    for joint in (2, 3, 5, 6):
        parameter = found[1][f"qd_max.{joint}"]
        assert parameter.state == "at least"
        assert parameter.interval is None
        assert parameter.found < parameter.model
    assert found[1]["jerk"].state == "not determined"
    assert summary(found[0])[1] == "at least: qd_max.2, qd_max.3, qd_max.5, qd_max.6"


def test_packages_were_lost(hidden):
    assert len(hidden[1].gaps) > 20


def test_the_arm_file_of_a_fit_has_what_was_found(hidden, found):
    true = hidden[0].true
    text = arm_text({"base": "CS66"}, found[0].parameters, [joint.qd_max for joint in CS66.joints], about="a test")
    model = parse_model("my_arm.toml", text)
    assert model.arm.d6 == pytest.approx(true["d6"], abs=1e-9)
    assert model.joints[0].qd_max == pytest.approx(true["qd_max.1"], abs=1e-5)
    assert model.joints[1].qd_max == CS66.joints[1].qd_max
    assert model.plant.lag_s == pytest.approx(true["plant.lag_s"], abs=2e-4)
    assert model.default_joint_speed == pytest.approx(true["default_joint_speed"], abs=1e-5)


def test_without_the_program_nothing_is_said_of_defaults(hidden):
    fit = fit_recording(hidden[1], CS66)
    found = {parameter.name: parameter for parameter in fit.parameters}
    assert found["default_joint_speed"].state == "not determined"
    assert found["qd_max.1"].state == "at least"
    assert any("no program was given" in words for words in fit.words)
    assert found["d6"].found == pytest.approx(hidden[0].true["d6"], abs=1e-9)


# ---------------------------------------------------------------- by hand


def by_hand(v, a, duration_s, line=2, v_of_other=0.0, scaling=1.0):
    """Return a recording of one trapezoid of joint 1, and of joint 2 with a share of it."""
    rows = []
    ramp_s = v / a
    for k in range(round(duration_s / 0.004) + 1):
        t = 0.004 * k
        speed = min(a * t, v, max(0.0, a * (duration_s - t)))
        s = (
            0.5 * a * t * t
            if t < ramp_s
            else v * (t - 0.5 * ramp_s)
            if t < duration_s - ramp_s
            else v * (duration_s - ramp_s) - 0.5 * a * (duration_s - t) ** 2
        )
        rows.append((t, s, speed))
    columns = {
        "script_control_line": array("d", [line] * len(rows)),
        "speed_scaling": array("d", [scaling] * len(rows)),
    }
    for joint in range(6):
        share = 1.0 if joint == 0 else v_of_other if joint == 1 else 0.0
        columns[f"target_joint_positions.{joint}"] = array("d", [share * s for _, s, _ in rows])
        columns[f"target_joint_speeds.{joint}"] = array("d", [share * speed for *_, speed in rows])
    times = array("d", [t for t, *_ in rows])
    return Recording(t=times, arrived_s=times, columns=columns, rate_hz=250.0)


def of(recording, text):
    return {parameter.name: parameter for parameter in fit_recording(recording, CS66, text).parameters}


def test_a_cruise_and_a_slope_by_hand():
    found = of(by_hand(0.8, 1.6, 2.0), "def f():\n  movej(q)\nend")
    assert found["default_joint_speed"].found == pytest.approx(0.8, rel=1e-9)
    assert found["default_joint_acceleration"].found == pytest.approx(1.6, rel=1e-9)


def test_the_slider_is_taken_out():
    found = of(by_hand(0.4, 0.4, 4.0, scaling=0.5), "def f():\n  movej(q)\nend")
    assert found["default_joint_speed"].found == pytest.approx(0.8)
    assert found["default_joint_acceleration"].found == pytest.approx(1.6)


def test_a_move_that_never_cruises_has_no_speed():
    found = of(by_hand(0.8, 1.6, 0.9), "def f():\n  movej(q)\nend")
    assert found["default_joint_speed"].why == "no movej without v is long enough to cruise, at one speed scaling"
    assert found["default_joint_acceleration"].found == pytest.approx(1.6, rel=1e-6)


@pytest.mark.parametrize(
    ("call", "name"),
    [("movej(q, v=0.8)", "speed"), ("movej(q, 1.4, 0.8)", "speed"), ("movej(q, t=2)", "speed"), ("movel(q)", "speed")],
)
def test_moves_that_give_it_or_are_of_another_kind_do_not_count(call, name):
    found = of(by_hand(0.8, 1.6, 2.0), f"def f():\n  {call}\nend")
    assert found[f"default_joint_{name}"].why == "no movej without v was recorded"


LIMITED = "every movej without v that cruises has a joint at its limit (base 0.8 rad/s)"


def test_moves_at_the_limit_that_the_controller_shows_leave_the_default_open():
    recording = by_hand(0.8, 1.6, 2.0)
    text = "def f():\n  movej(q)\nend"
    limited = of(replace(recording, facts={"limits": {"qd_max": [0.8] * 6}}), text)["default_joint_speed"]
    assert (limited.state, limited.found, limited.why) == ("at least", pytest.approx(0.8), LIMITED)
    assert not limited.differs
    free = of(replace(recording, facts={"limits": {"qd_max": [1.2] * 6}}), text)["default_joint_speed"]
    assert free.state == "determined"


def test_moves_as_fast_as_one_that_was_limited_leave_the_default_open():
    first, second = by_hand(0.8, 1.6, 2.0), by_hand(0.8, 1.6, 2.0, line=3)
    later = array("d", [t + 5.0 for t in second.t])
    columns = {name: column + second.columns[name] for name, column in first.columns.items()}
    recording = replace(first, t=first.t + later, arrived_s=first.t + later, columns=columns)
    found = of(recording, "def f():\n  movej(q, a=10, v=2)\n  movej(q)\nend")
    assert (found["default_joint_speed"].state, found["default_joint_speed"].why) == ("at least", LIMITED)
    assert found["qd_max.1"].found == pytest.approx(0.8)


def test_a_limited_move_with_two_joints_at_once_leaves_it_open():
    one = of(by_hand(2.0, 8.0, 2.0), "def f():\n  movej(q, a=10, v=6)\nend")
    assert one["qd_max.1"].found == pytest.approx(2.0)
    assert one["qd_max.2"].state == "not determined"
    two = of(by_hand(2.0, 8.0, 2.0, v_of_other=0.9), "def f():\n  movej(q, a=10, v=6)\nend")
    assert (two["qd_max.1"].state, two["qd_max.2"].state) == ("at least", "at least")
    assert two["qd_max.2"].found == pytest.approx(1.8)


def test_a_recording_without_poses_and_actual_positions():
    found = of(by_hand(0.8, 1.6, 2.0), None)
    assert found["d6"].why == "the recording has no poses"
    assert found["plant.lag_s"].why == "the recording has no actual positions"
    assert found["payload_kg"].why == "the recording has no payload_mass"


def test_rows_without_a_variable_do_no_harm():
    recording = by_hand(0.8, 1.6, 2.0)
    for joint in range(6):
        recording.columns[f"target_TCP_pose.{joint}"] = array("d", [nan] * len(recording.t))
    assert of(recording, None)["d6"].state == "not determined"


def test_rows_that_a_late_controller_repeats_count_once():
    recording = by_hand(0.8, 1.6, 2.0)
    doubled = replace(
        recording,
        t=array("d", [t for t in recording.t for _ in range(12)]),
        arrived_s=array("d", [t for t in recording.t for _ in range(12)]),
        columns={
            name: array("d", [x for x in column for _ in range(12)]) for name, column in recording.columns.items()
        },
    )
    text = "def f():\n  movej(q)\nend"
    assert of(doubled, text) == of(recording, text)
    assert any("repeat the time" in words for words in fit_recording(doubled, CS66, text).words)


def test_only_ramps_of_joint_moves_have_a_shape():
    assert of(by_hand(0.8, 1.6, 2.0), "def f():\n  movej(q)\nend")["jerk"].why == "ramps are straight (trapezoid)"
    assert of(by_hand(0.8, 1.6, 2.0), "def f():\n  movel(q)\nend")["jerk"].why == "no ramp of a movej has ten rows"


def test_moves_by_line_and_what_they_give():
    moves = moves_of(
        "def f():\n  movej(q, 1.0, t=2)\n  movel(p); movel(q)\n  movel(\n    p,\n    v=x)\nend", "f.script"
    )
    assert sorted(moves) == [2, 4, 5, 6]
    assert dict(moves[2].given) == {"q": None, "a": 1.0, "t": 2.0}
    assert dict(moves[5].given) == {"p": None, "v": None}
    assert not moves[2].has_default("v")
    assert moves[4].has_default("a")
    assert not moves[4].has_default("v")


def test_equations_that_are_written_twice_say_no_more_than_once():
    rows, values = [[1.0], [1.0], [1.0], [1.0]], [1.0, 2.0, 4.0, 5.0]
    once = solve(rows, values)
    twice = solve([row for row in rows for _ in range(2)], [value for value in values for _ in range(2)])
    alone = clustered_sigma(once, rows, 1)
    assert clustered_sigma(twice, [row for row in rows for _ in range(2)], 2) == pytest.approx(alone)
    # The residuals are -2, -1, 1, 2, each with the weight 1/4.
    assert alone == pytest.approx(sqrt(10.0) / 4.0)


def test_the_last_row_of_a_rest_has_the_torque_of_the_move_that_follows():
    text = """def p():
  set_payload(1.5, [0, 0.01, 0.05])
  movej([0.1, -1.6, -1.7, -1.3, 1.5, 0.1], a=8, v=2)
  sleep(0.15)
  movej([0.1, -1.3, -1.7, -1.0, 1.2, 0.4], a=8, v=2)
  sleep(0.15)
  movej([0.1, -1.5, -1.2, -1.6, 0.8, 0.4], a=8, v=2)
  sleep(0.15)
end
"""
    recording = record_run(text, variables=(*VARIABLES, "actual_joint_torques"))
    payload = next(
        its for its in fit_recording(recording, CS66, text).parameters if its.name == "payload_of_torques_kg"
    )
    assert payload.found == pytest.approx(1.5, abs=1e-9)
