"""Numbers that no controller should send: nothing of them reaches a page, and nothing ends because of them."""

from __future__ import annotations

import json
from math import inf, nan

import pytest

from elitescript.client.primary_messages import MessageReader, RobotState
from elitescript.protocol.primary.packets import CONFIGURATION, SUB_MESSAGES, pack_state
from elitescript.studio.connected.picture import Picture
from elitescript.studio.connected.scene import scene_of
from elitescript.studio.connected.signals import signals_of
from elitescript.studio.connected.trail import Trail
from tests.protocol.snapshots import description, snapshot
from tests.studio.connected.fake_controller import JOINTS


@pytest.mark.parametrize("value", [nan, inf, -inf])
def test_signals_without_a_number_are_left_out(value):
    assert signals_of({"tool_output_voltage": value, "standard_analog_input0": value}) == {}


@pytest.mark.parametrize("time_s", [nan, inf, 1e308, -1e308])
def test_a_picture_without_a_time_is_left_out(time_s):
    picture, trail = Picture("10.0.0.7"), Trail()
    picture.take_package({"timestamp": 5.0, "actual_joint_positions": JOINTS})
    trail.take(picture)
    picture.take_package({"timestamp": time_s, "actual_joint_positions": (0.0,) * 6})
    assert trail.take(picture) == []
    assert picture.joints == JOINTS


@pytest.mark.parametrize("row", ["DH a", "DH d", "DH alpha", "joint limits", "joint maxima"])
def test_an_arm_without_numbers_has_those_of_its_model(row):
    (state,) = MessageReader().feed(pack_state(SUB_MESSAGES, snapshot(), description()))
    assert isinstance(state, RobotState)
    configuration = state.part(CONFIGURATION)
    numbers = configuration[row]
    scene = scene_of({**configuration, row: (nan, *numbers[1:])}, (inf,) * 6, "")
    assert json.dumps(scene, allow_nan=False)
