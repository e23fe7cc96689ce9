"""Curves: what is derived from a trace, and how it is packed."""

import pytest

from elitescript import PlantConfig
from elitescript.models.model import load_model
from elitescript.plotting.curves import (
    PATH_POINTS_MAX,
    POINTS_MAX,
    accelerations,
    error_curves,
    joint_curves,
    speed_curve,
    tcp_path,
    tcp_speeds,
)
from elitescript.plotting.packing import undo_deltas
from tests.plotting.recordings import recorded, restless, row

MODEL = load_model("CS66")


def test_accelerations_are_differences_of_speeds():
    assert accelerations([0.0, 0.5, 1.0], [0.0, 1.0, 0.0]) == [0.0, 2.0, -2.0]


def test_the_tcp_speed_is_distance_by_time():
    assert tcp_speeds([row(0.0, x=0.4), row(0.1, q1=0.2, x=0.45)]) == pytest.approx([0.0, 0.5])


def test_another_tcp_is_no_motion():
    rows = [row(0.0, x=0.4), row(0.004, x=0.6), row(0.008, x=0.6)]
    assert tcp_speeds(rows) == [0.0, 0.0, 0.0]
    path = tcp_path(rows, tcp_speeds(rows))
    assert path["jumps"] == [1]
    assert [n * path["step"] for n in undo_deltas(path["xyz"][0])] == pytest.approx([0.4, 0.6, 0.6])


def test_packed_curves_keep_extremes_and_limits():
    rows = recorded().rows
    for index, joint in enumerate(joint_curves(rows, MODEL)):
        curve, speeds = joint["qd"], [r.qd[index] for r in rows]
        unpacked = [n * curve["step"] for n in undo_deltas(curve["v"])]
        assert (curve["min"], curve["max"]) == (min(speeds), max(speeds))
        assert max(unpacked) == pytest.approx(max(speeds), abs=curve["step"])
        assert min(unpacked) == pytest.approx(min(speeds), abs=curve["step"])
        limit = MODEL.joints[index].qd_max
        assert (curve["low"], curve["high"]) == (-limit, limit)
        assert curve["used"] == pytest.approx(max(map(abs, speeds)) / limit)
        assert undo_deltas(curve["t"])[-1] == round(1000 * rows[-1].t)


def test_a_move_at_the_limit_uses_all_of_it():
    rows = recorded("movej([2.0, -1.4, -1.7, -1.6, 1.57, 0], a=40, v=9)\n").rows
    assert joint_curves(rows, MODEL)[0]["qd"]["used"] == pytest.approx(1.0, abs=1e-6)


def test_restless_rows_stay_within_the_budget():
    rows = restless(6_000)
    for joint in joint_curves(rows, MODEL):
        for name in ("q", "qd", "qdd"):
            assert len(joint[name]["t"]) == len(joint[name]["v"]) <= POINTS_MAX
    speeds = tcp_speeds(rows)
    path = tcp_path(rows, speeds)
    assert len(path["t"]) == len(path["v"]) == len(path["xyz"][2]) <= PATH_POINTS_MAX
    assert speed_curve(rows, speeds, 2.5)["max"] == max(speeds)


def test_the_tracking_error_is_target_less_actual():
    rows = recorded(plant=PlantConfig(lag_s=0.02)).rows
    curves = error_curves(rows, MODEL)
    fastest = max(each.qd[0] for each in rows)
    assert curves[0]["max"] == pytest.approx(0.02 * fastest, rel=0.05)
    assert (curves[0]["low"], curves[0]["high"]) == (-MODEL.safety.tracking_error_max, MODEL.safety.tracking_error_max)
    assert curves[5]["max"] < curves[0]["max"]


def test_without_measured_positions_there_is_no_tracking_error():
    assert error_curves(recorded().rows, MODEL) == []
