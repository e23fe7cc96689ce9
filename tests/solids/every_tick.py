"""Contacts and closest distances by looking at every pair in every control period: what `ContactWatch` must find."""

from __future__ import annotations

from math import inf
from pathlib import Path
from random import Random

from elitescript.messages.machine import PauseTask, ResumeTask, SetSpeedScale, StopTask
from elitescript.models.model import load_model
from elitescript.robot import VirtualRobot
from elitescript.solids.frames import frames_of
from elitescript.solids.pairs import watched_pairs
from elitescript.solids.spans import PlacedGroup, measured
from elitescript.world_file import load_world_file
from tests.invariants.random_programs import random_program


def random_world(draw: Random) -> str:
    """The text of a world file with things where the arm of `random_program` moves."""
    text = ""
    for number in range(draw.randrange(1, 4)):
        kind = draw.choice(("box", "box", "cylinder", "sphere"))
        where = [draw.uniform(0.15, 0.75), draw.uniform(-0.45, 0.3), draw.uniform(0.0, 0.75)]
        turn = [draw.choice((0.0, draw.uniform(-180, 180))) for _ in range(3)]
        sizes = {
            "box": f"size = {[round(draw.uniform(0.05, 0.4), 3) for _ in range(3)]}",
            "cylinder": f"radius = {draw.uniform(0.02, 0.15):.3f}\nlength = {draw.uniform(0.05, 0.4):.3f}",
            "sphere": f"radius = {draw.uniform(0.03, 0.2):.3f}",
        }
        text += (
            f'[[{kind}]]\nname = "thing {number}"\npose_deg = {[round(c, 4) for c in (*where, *turn)]}\n{sizes[kind]}\n'
        )
    if draw.random() < 0.6:
        text += '[[box]]\nname = "table"\nsize = [1.5, 1.5, 0.1]\npose = [0.0, 0.0, -0.05]\n'
    if draw.random() < 0.6:
        text += "[tool]\n[[tool.box]]\nsize = [0.12, 0.05, 0.1]\npose = [0, 0, 0.05]\n"
        text += "[[tool.payload.cylinder]]\nradius = 0.03\nlength = 0.08\npose = [0.02, 0, 0.14]\n"
    return text


def watched_run(seed: int, folder: Path):
    """A random program in a random world, to which something happens from outside; with rows of every period."""
    draw = Random(f"contacts {seed}")
    world = folder / "world.toml"
    world.write_text(random_world(draw))
    robot = VirtualRobot("CS66", seed=seed, world=world)
    robot.set_speed(draw.choice((1.0, 1.0, 0.4)))
    if draw.random() < 0.3:
        robot.controller.put(draw.randrange(0, 800), SetSpeedScale(draw.choice((0.0, 0.3, 1.0))))
    if draw.random() < 0.3:
        tick = draw.randrange(0, 500)
        robot.controller.put(tick, PauseTask())
        robot.controller.put(tick + draw.randrange(0, 200), ResumeTask())
    if draw.random() < 0.2:
        robot.controller.put(draw.randrange(0, 700), StopTask())
    home = robot.state.q_target
    run = robot.run(random_program(draw), until_s=8.0, trace=True)
    return run, home, world


class OneMoment:
    """Stands for a span: groups where they are at one moment."""

    def __init__(self, frames) -> None:
        self._frames = frames

    def placed(self, group, _tick):
        return PlacedGroup(group, self._frames[group.link])


def contacts_of_every_tick(run, home, world, arm=None):
    """Return contacts as (first, second, start, end, deepest), and the closest distance to each thing."""
    arm = arm or load_model("CS66")
    frames = frames_of(arm.arm)
    samples = [(run.trace[0].t, home), *((row.t, row.q) for row in run.trace)]
    contacts, closest = [], {}
    for pair in watched_pairs(load_world_file(world).cell, arm):
        start, deepest, best, last_q, distance = None, inf, inf, None, inf
        for t, q in samples:
            if q != last_q:
                last_q = q
                gap, found = measured(pair, OneMoment(frames(q)), 0, (max(best, 0.0) if pair.is_thing else 0.0) + 1e-3)
                distance = gap.distance if found is None else found.distance
            best = min(best, distance)
            if distance <= 0.0:
                start, deepest = (t, distance) if start is None else (start, min(deepest, distance))
            elif start is not None:
                contacts.append((pair.first.name, pair.second.name, start, t, deepest))
                start = None
        if start is not None:
            contacts.append((pair.first.name, pair.second.name, start, samples[-1][0], deepest))
        if pair.is_thing:
            closest[pair.second.name] = min(best, closest.get(pair.second.name, inf))
    return contacts, closest


def compare(seed: int, folder: Path) -> int:
    """Compare a run with the result of every tick; return the number of its contacts."""
    run, home, world = watched_run(seed, folder)
    check(run, home, world, load_model("CS66"))
    return len(run.contacts)


def check(run, home, world, arm) -> None:
    """Compare a run of an arm, with rows of every period, with the result of every tick."""
    expected, closest = contacts_of_every_tick(run, home, world, arm)
    found = [(its.first, its.second, its.start_s, its.end_s) for its in run.contacts]
    assert sorted(found) == sorted(its[:4] for its in expected), world.read_text()
    depths = {its[:3]: its[4] for its in expected}
    for its in run.contacts:
        deepest = depths[its.first, its.second, its.start_s]
        assert deepest - 1e-9 <= its.distance_m <= deepest + max(2e-5, -0.11 * deepest)
    assert {its.second for its in run.clearances} == set(closest)
    for its in run.clearances:
        least = closest[its.second]
        assert least - 1e-9 <= its.distance_m <= least + max(2e-5, 0.011 * least, -0.11 * least)
