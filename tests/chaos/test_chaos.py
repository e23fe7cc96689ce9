"""Random sessions: a few hold all that must hold; what does not hold is found, and made short."""

import json

import pytest

from elitescript import VirtualRobot
from tests.chaos.playing import failure_of
from tests.chaos.sessions import drawn
from tests.chaos.shorter import fewest, name_of, shortest

KEPT = (1, 36, 694)
"""Seeds that broke something once: a connection that closed late, a time before a motion began, news from before a
client came."""


@pytest.mark.parametrize("seed", KEPT)
def test_sessions_that_broke_something_once_hold(seed):
    failure, ticks, all_ticks = failure_of(drawn(seed))
    assert failure == ""
    assert 0 < ticks < all_ticks


def test_a_session_is_the_same_for_each_draw_and_json_able():
    for seed in range(50):
        assert json.loads(json.dumps(drawn(seed))) == drawn(seed)


def test_what_breaks_a_robot_is_found_and_made_short(monkeypatch):
    set_speed = VirtualRobot.set_speed

    def broken(robot, fraction):
        if fraction == 0.3 and robot.tick > 500:
            raise KeyError("planted")
        set_speed(robot, fraction)

    monkeypatch.setattr(VirtualRobot, "set_speed", broken)
    session = next(
        session
        for session in map(drawn, range(1000))
        if any(act[1:] == ["slider", 0.3] and act[0] > 500 for act in session["acts"]) and len(session["acts"]) > 10
    )
    name = name_of(failure_of(session)[0])
    assert name == "exception: KeyError"
    short = shortest(session, lambda candidate: name_of(failure_of(candidate)[0]) == name)
    assert [act[1:] for act in short["acts"]] == [["slider", 0.3]]
    assert short["program"] == ""
    assert short["options"] == {}


def test_what_depends_on_the_way_time_goes_is_found(monkeypatch):
    at = VirtualRobot.set_speed

    def broken(robot, fraction):
        at(robot, fraction if robot._kernel.controller.arm_state._tick == robot.tick - 1 else 0.5)

    monkeypatch.setattr(VirtualRobot, "set_speed", broken)
    found = [failure_of({**drawn(seed), "acts": [[400, "slider", 0.9]]})[0] for seed in range(2)]
    assert any(failure.startswith("every tick: ") for failure in found)


def test_the_fewest_items_that_fail_are_kept_in_their_order():
    tried = []

    def fails(items):
        tried.append(items)
        return 3 in items and 17 in items

    assert fewest(list(range(20)), fails) == [3, 17]
    assert len(tried) < 60
