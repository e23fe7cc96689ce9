"""How far joints turn and the tool goes on planned moves, against samples of every tick."""

from __future__ import annotations

from itertools import pairwise
from math import dist

import pytest

from elitescript.kinematics.transforms import transform_from_pose
from elitescript.models.model import load_model
from elitescript.robot import VirtualRobot

HOME = "movej([0, -1.5708, -1.5708, -1.5708, 1.5708, 0], a=3, v=2)\n"

MOVES = {
    "joints": "movej([0.4, -1.2, -1.9, -1.5, 1.4, 0.5], a=2, v=1)",
    "line": "p = get_target_tcp_pose()\np[0] += 0.15\np[2] -= 0.2\nmovel(p, a=1, v=0.4)",
    "turning line": "p = get_target_tcp_pose()\np[1] += 0.1\np[5] += 0.9\nmovel(p, a=1, v=0.2)",
    "arc": (
        "p = get_target_tcp_pose()\nvia = p.copy()\nvia[0] += 0.05\nvia[1] += 0.05\np[0] += 0.1\n"
        "movec(via, p, a=1, v=0.2)"
    ),
    "blended lines": (
        "p = get_target_tcp_pose()\np[0] += 0.1\nmovel(p, a=1, v=0.2, r=0.03)\np[1] += 0.1\n"
        "movel(p, a=1, v=0.2, r=0.03)\np[2] -= 0.1\nmovel(p, a=1, v=0.2)"
    ),
    "blended joints": (
        "movej([0.4, -1.2, -1.9, -1.5, 1.4, 0.5], a=2, v=1, r=0.05)\nmovej([0.0, -1.4, -1.7, -1.5, 1.4, 0.0], a=2, v=1)"
    ),
    "slowed line": "p = get_target_tcp_pose()\np[2] -= 0.2\nmovel(p, a=1, v=0.4)",
}


@pytest.mark.parametrize("kind", MOVES)
def test_it_is_at_least_what_every_tick_adds_up_to_and_hardly_more(kind):
    robot = VirtualRobot("CS66")
    spans = []

    def watch(its):
        controller = its.controller
        due = controller.next_tick()
        if due is None or due - controller.tick < 20:
            return
        begin, end = controller.tick, due
        turned, tool = controller.turned(begin, end), controller.tool_way(begin, end)
        rows = [q for q, _ in controller.targets_at(range(begin, end + 1))]
        spans.append((turned, tool, rows, controller.turned(begin, (begin + end) // 2)))

    if kind == "slowed line":
        robot.set_speed(0.4)
    robot.run(HOME + MOVES[kind] + "\n", watch=watch)
    arm = load_model("CS66").arm
    assert spans
    for turned, tool, rows, half in spans:
        sums = [sum(abs(b[i] - a[i]) for a, b in pairwise(rows)) for i in range(6)]
        for bound, total, first in zip(turned, sums, half, strict=True):
            assert total - 1e-9 <= bound <= 1.3 * total + 0.06
            assert 0.0 <= first <= bound + 1e-12
        if tool is not None:
            way, turn, tcp = tool
            places = [arm.forward_tcp(q, transform_from_pose((*tcp, 0, 0, 0)))[9:] for q in rows]
            gone = sum(dist(a, b) for a, b in pairwise(places))
            assert gone - 1e-9 <= way <= 1.5 * gone + 0.001
            assert turn >= 0.0
    assert any(tool is not None for _, tool, _, _ in spans) == (kind not in ("joints", "blended joints"))
