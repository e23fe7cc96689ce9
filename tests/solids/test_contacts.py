"""Contacts over a run: exact in time, with names, lines and depths."""

from __future__ import annotations

from math import cos, pi, sin

import pytest

from elitescript.kinematics.transforms import compose
from elitescript.models.model import load_model
from elitescript.robot import VirtualRobot
from elitescript.solids.arm import arm_parts
from elitescript.solids.cell import LINKS
from elitescript.solids.distance import closest
from elitescript.solids.frames import frames_of
from elitescript.solids.pairs import NOT_WATCHED, Group
from elitescript.solids.spans import measured
from tests.solids.every_tick import compare, contacts_of_every_tick

TABLE = '[[box]]\nname = "table"\nsize = [2.0, 2.0, 0.1]\npose = [0.0, 0.0, -0.05]\n'
GRIPPER = '[tool]\nname = "gripper"\n[[tool.box]]\nsize = [0.06, 0.06, 0.1]\npose = [0, 0, 0.05]\n'


def run_in(tmp_path, world, program, **options):
    path = tmp_path / "world.toml"
    path.write_text(world)
    return VirtualRobot("CS66", world=path, **options).run(program).check()


@pytest.mark.parametrize("seed", [0, 2, 3])
def test_it_finds_what_looking_at_every_tick_finds(seed, tmp_path):
    compare(seed, tmp_path)


DOWN = """def down():
  set_tcp([0, 0, 0.1, 0, 0, 0])
  movej([0, -1.5708, -1.5708, -1.5708, 1.5708, 0])
  p = get_target_tcp_pose()
  p[2] = {height}
  movel(p, a=1, v=0.1)
  p[2] = 0.1
  movel(p, a=1, v=0.1)
end
"""


def test_a_contact_has_names_line_depth_and_time(tmp_path):
    run = run_in(tmp_path, TABLE + GRIPPER, DOWN.format(height=-0.012))
    (contact,) = run.contacts
    assert (contact.first, contact.second, contact.line) == ("gripper", "table", 6)
    assert contact.is_contact
    assert contact.distance_m == pytest.approx(-0.012, abs=1e-6)
    (first, second) = contact.points
    assert first[2] == pytest.approx(-0.012, abs=1e-6)
    assert second[2] == pytest.approx(0.0, abs=1e-6)
    # 12 mm at 0.1 m/s and 1 m/s^2 from the end of the move: v^2/2a = 5 mm, so 7 mm at full speed.
    assert contact.t - contact.start_s == pytest.approx(0.17, abs=0.008)
    (warned,) = [event for event in run.events if getattr(event, "code", "") == "W273"]
    assert warned.line == 6
    assert warned.tick * 0.004 == pytest.approx(contact.start_s)
    when = f"at {contact.t:.3f} s, from {contact.start_s:.3f} s on"
    assert str(warned) == f"line 6: warning W273: gripper touches table: 12.0 mm deep {when}"


def test_the_closest_distance_is_found_where_nothing_touches(tmp_path):
    run = run_in(tmp_path, TABLE + GRIPPER, DOWN.format(height=0.008))
    assert run.contacts == []
    (clearance,) = run.clearances
    assert (clearance.first, clearance.second, clearance.line) == ("gripper", "table", 6)
    assert clearance.distance_m == pytest.approx(0.008, abs=1e-4)
    assert not clearance.is_contact
    assert not [event for event in run.events if getattr(event, "code", "") == "W273"]


def test_what_is_ignored_may_touch(tmp_path):
    program = DOWN.format(height=-0.012)
    may = TABLE + 'ignore = ["gripper"]\n' + GRIPPER
    run = run_in(tmp_path, may, program)
    assert run.contacts == []
    assert run.clearances[0].first != "gripper"
    run = run_in(tmp_path, TABLE + GRIPPER.replace("[[tool", 'ignore = ["table"]\n[[tool', 1), program)
    assert run.contacts == []


def test_the_arm_touches_itself(tmp_path):
    """Folded at the elbow, the forearm's end meets the shoulder."""
    world = GRIPPER
    program = "movej([0, -1.5708, -3.0, 0, 1.5708, 0], a=2, v=1)\n"
    run = run_in(tmp_path, world, program)
    names = {(its.first, its.second) for its in run.contacts}
    assert ("forearm", "shoulder") in names or ("wrist 1", "shoulder") in names
    assert all(its.line == 1 for its in run.contacts)


def test_a_world_without_solids_has_no_contacts(tmp_path):
    run = run_in(tmp_path, "[robot]\nseed = 1\n", "sleep(0.1)\n")
    assert run.contacts == []
    assert run.clearances == []
    assert run.watch is None


def test_what_touches_from_the_begin_is_in_contact_at_once(tmp_path):
    world = GRIPPER + '[[sphere]]\nname = "ball"\nradius = 0.1\npose = [0.4, -0.15, 0.4]\n'
    run = run_in(tmp_path, world, "sleep(1)\n")
    assert {its.second for its in run.contacts} == {"ball"}
    assert {(its.start_s, its.end_s) for its in run.contacts} == {(0.0, 1.0)}


def test_a_contact_that_gets_deeper_in_later_moves_is_reported_at_its_end_again(tmp_path):
    program = DOWN.format(height=-0.004).replace(
        "  p[2] = 0.1\n", "  p[2] = -0.02\n  movel(p, a=1, v=0.1)\n  p[2] = 0.1\n"
    )
    run = run_in(tmp_path, TABLE + GRIPPER, program)
    (contact,) = run.contacts
    texts = [event.text for event in run.events if getattr(event, "code", "") == "W273"]
    assert [text.partition(" mm")[0] for text in texts] == [
        "gripper touches table: 4.0",
        "gripper touches table: 20.0",
    ]
    assert contact.distance_m == pytest.approx(-0.02, abs=1e-6)


def test_the_same_run_gives_the_same_contacts(tmp_path):
    runs = [run_in(tmp_path, TABLE + GRIPPER, DOWN.format(height=-0.012)) for _ in range(2)]
    assert runs[0].contacts == runs[1].contacts
    assert runs[0].clearances == runs[1].clearances


@pytest.mark.parametrize("name", ["CS63", "CS66", "CS612", "CS616", "CS620", "CS625"])
def test_links_that_are_left_out_never_touch(name):
    """Base and upper arm depend on one joint; the wrists on two."""
    model = load_model(name)
    frames = frames_of(model.arm)
    groups = {
        link: Group(LINKS[link], [part for part in arm_parts(model) if part.link == link and part.role != "ring"])
        for link in range(7)
    }
    least = {}
    for second, first in NOT_WATCHED:
        for i in range(24):
            for j in range(1 if second == 0 else 24):
                q = [0.0] * 6
                q[second + 1 if second == 0 else second] = i * pi / 12
                q[first - 1] += j * pi / 12
                its = frames(q)
                for a, T_a in groups[first].solids:
                    for b, T_b in groups[second].solids:
                        d = closest(a, compose(its[first], T_a), b, compose(its[second], T_b)).distance
                        least[second, first] = min(d, least.get((second, first), 1.0))
    assert least[0, 2] > 0.002
    assert least[4, 6] > 0.002
    assert least[3, 5] > (-0.012 if name in ("CS620", "CS625") else 0.002)


SWEEP = """def sweep():
  movej([-0.6, -1.5708, -1.5708, -1.5708, 1.5708, 0], a=4, v=2)
  movej([0.6, -1.5708, -1.5708, -1.5708, 1.5708, 0], a=4, v=2)
  p = get_target_tcp_pose()
  p[1] -= 0.5
  movel(p, a=2, v=0.5)
end
"""


@pytest.mark.parametrize("gap", [0.0, 0.05])
def test_what_happens_in_the_middle_of_a_move_is_found(gap, tmp_path):
    """The gripper passes a post, or through it; at both ends of the moves it is far away."""
    home = VirtualRobot("CS66").state
    x, y, z = home.tcp_pose_target[:3]
    # Turned about the base, away from where the run begins.
    x, y = x * cos(0.3) - y * sin(0.3), x * sin(0.3) + y * cos(0.3)
    world = f'[[cylinder]]\nname = "post"\nradius = 0.01\nlength = 0.1\npose = [{x}, {y}, {z - 0.15 - gap}]\n' + GRIPPER
    run = VirtualRobot("CS66", world=_written(tmp_path, world)).run(SWEEP, trace=True)
    expected, closest_by_thing = contacts_of_every_tick(run, home.q_target, tmp_path / "world.toml")
    found = [(its.first, its.second, its.start_s, its.end_s) for its in run.contacts]
    assert sorted(found) == sorted(its[:4] for its in expected)
    assert len(found) == (2 if gap == 0.0 else 0)
    least = closest_by_thing["post"]
    assert least <= run.clearances[0].distance_m <= least + max(1e-5, 0.011 * least, -0.11 * least)


def _written(folder, text):
    path = folder / "world.toml"
    path.write_text(text)
    return path


AGAIN = """def again():
  set_tcp([0, 0, 0.1, 0, 0, 0])
  movej([0, -1.5708, -1.5708, -1.5708, 1.5708, 0], a=4, v=2)
  start = get_target_tcp_pose()
  for n in range(4):
    p = start.copy()
    p[1] += 0.1
    movel(p, a=4, v=0.8, r=0.03)
    p[2] = -0.012
    movel(p, a=2, v=0.5)
    movel(start, a=4, v=0.8)
  end
end
"""


def test_a_move_that_comes_again_is_not_watched_again_but_for_what_touched(tmp_path, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr("elitescript.solids.contacts._WORTHWHILE_TICKS", 1_000_000)
        expected = run_in(tmp_path, TABLE + GRIPPER, AGAIN).contacts
    seen = []

    def counted(pair, span, tick, ample):
        seen.append((tick, pair.first.name, pair.second.name))
        return measured(pair, span, tick, ample)

    monkeypatch.setattr("elitescript.solids.contacts.measured", counted)
    found = run_in(tmp_path, TABLE + GRIPPER, AGAIN).contacts
    assert [(its.first, its.second) for its in found] == [("gripper", "table")] * 4
    assert [its[:5] for its in found] == [its[:5] for its in expected]
    # The first move of the first cycle begins elsewhere; the second cycle is watched, the others are known.
    assert {its[1:] for its in seen if its[0] > round(found[2].end_s / 0.004)} == {("gripper", "table")}


SERVO = """def servo():
  import math
  q = get_target_joint_positions()
  for i in range(250):
    servoj([q[0], q[1] + 0.25 * math.sin(0.03 * i), q[2], q[3], q[4], q[5]], t=0.004, lookahead_time=0.1, gain=300)
  end
  stopj(4)
end
"""


def test_contacts_in_motions_that_are_known_for_one_period_only(tmp_path):
    home = VirtualRobot("CS66").state
    x, y, z = home.tcp_pose_target[:3]
    world = f'[[box]]\nname = "plate"\nsize = [0.4, 0.4, 0.02]\npose = [{x}, {y}, {z - 0.16}]\n' + GRIPPER
    path = _written(tmp_path, world)
    run = VirtualRobot("CS66", world=path).run(SERVO, trace=True).check()
    expected, near = contacts_of_every_tick(run, home.q_target, path)
    found = [(its.first, its.second, its.start_s, its.end_s) for its in run.contacts]
    assert sorted(found) == sorted(its[:4] for its in expected)
    assert ("gripper", "plate") in {its[:2] for its in found}
    assert run.clearances[0].distance_m == pytest.approx(near["plate"], abs=1e-9)


def test_sums_that_begin_anew_change_nothing(tmp_path, monkeypatch):
    runs = [run_in(tmp_path, TABLE + GRIPPER, AGAIN)]
    monkeypatch.setattr("elitescript.solids.contacts._FARTHEST_RAD", 0.0)
    runs.append(run_in(tmp_path, TABLE + GRIPPER, AGAIN))
    assert runs[0].contacts == runs[1].contacts


def test_a_run_that_is_cut_off_is_watched_to_its_last_row(tmp_path):
    home = VirtualRobot("CS66").state
    x, y, z = home.tcp_pose_target[:3]
    path = _written(
        tmp_path, f'[[box]]\nname = "plate"\nsize = [0.4, 0.4, 0.02]\npose = [{x}, {y}, {z - 0.12}]\n' + GRIPPER
    )
    program = "p = get_target_tcp_pose()\np[2] = p[2] - 0.25\nmovel(p, a=1, v=0.5)\n"
    run = VirtualRobot("CS66", world=path).run(program, until_s=0.3, trace=True)
    expected, _ = contacts_of_every_tick(run, home.q_target, path)
    assert run.state == "time_limit"
    (deepest,) = [its[4] for its in expected if its[0] == "gripper"]
    (contact,) = [its for its in run.contacts if its.first == "gripper"]
    assert contact.distance_m == pytest.approx(deepest, abs=1e-9)
    assert contact.t == run.trace[-1].t
