"""Random sessions: a few hold all that must hold; what does not hold is found, and made short."""

import json

import pytest

from elitescript import VirtualRobot
from elitescript.runtime.environment import EmptyEnvironment
from elitescript.sweep.failures.shrinking import fewest
from tests.chaos import rtsi_streams
from tests.chaos.playing import digest_of, verdict_of
from tests.chaos.sessions import drawn
from tests.chaos.shorter import name_of, shortest
from tests.protocol import rtsi_client


def first_of(kind):
    """Return the first session of a kind that has some acts."""
    return next(its for its in map(drawn, range(3000)) if its["kind"] == kind and len(its["acts"]) in range(5, 30))


@pytest.mark.parametrize("kind", ["presses", "raises", "interpreted", "points", "journal"])
def test_everything_holds_in_sessions_of_any_kind(kind):
    failure, ticks, all_ticks, _ = verdict_of(first_of(kind))
    assert failure == ""
    assert 0 < ticks < all_ticks


def test_a_digest_is_the_same_for_the_same_session_alone():
    session, other = first_of("threads"), first_of("moves")
    assert verdict_of(session).digest == digest_of(session) != digest_of(other)


def test_a_package_that_is_missing_in_a_stream_is_found():
    robot = VirtualRobot("CS66", world=EmptyEnvironment())
    client = robot.connect("rtsi")
    sent = rtsi_client.message("V", b"\0\1") + rtsi_client.output_recipe(125.0, ["timestamp", "actual_joint_positions"])
    sent += rtsi_client.message("S")
    client.send(sent)
    robot.advance(0.2)
    received = client.receive()
    rtsi_streams.check(sent, received)
    size = 3 + 1 + 8 + 6 * 8
    with pytest.raises(rtsi_streams.Lost, match=r"1 before .* at 125 Hz"):
        rtsi_streams.check(sent, received[: -3 * size] + received[-2 * size :])


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
    name = name_of(verdict_of(session).failure)
    assert name == "exception: KeyError"
    short = shortest(session, lambda candidate: name_of(verdict_of(candidate).failure) == name)
    assert [act[1:] for act in short["acts"]] == [["slider", 0.3]]
    assert short["program"] == ""
    assert short["options"] == {}


def test_what_depends_on_the_way_time_goes_is_found(monkeypatch):
    at = VirtualRobot.set_speed

    def broken(robot, fraction):
        at(robot, fraction if robot._kernel.controller.arm_state._tick == robot.tick - 1 else 0.5)

    monkeypatch.setattr(VirtualRobot, "set_speed", broken)
    sessions = [session for session in map(drawn, range(40)) if session["kind"] == "moves"][:2]
    found = [verdict_of({**session, "way": "steps", "acts": [[400, "slider", 0.9]]}).failure for session in sessions]
    assert any(failure.startswith("in steps: ") for failure in found)


def test_the_fewest_items_that_fail_are_kept_in_their_order():
    tried = []

    def fails(items):
        tried.append(items)
        return 3 in items and 17 in items

    assert fewest(list(range(20)), fails) == [3, 17]
    assert len(tried) < 60
