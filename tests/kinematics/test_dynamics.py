"""Inverse dynamics: reference torques, the laws that any rigid arm obeys, and senseless bodies."""

from __future__ import annotations

import json
import random
from math import cos, inf, nan, pi, sin, sqrt
from pathlib import Path
from typing import Any

import pytest

from elitescript.errors import UsageError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.chain import solve_linear
from elitescript.kinematics.dynamics import RigidBody, joint_torques
from elitescript.kinematics.limits import SixFloats
from elitescript.kinematics.transforms import IDENTITY, Transform, apply, compose
from elitescript.models.model import load_model, model_names

DATA = json.loads((Path(__file__).parents[1] / "data" / "dynamics_vectors.json").read_text(encoding="utf-8"))["models"]
VECTORS = [(name.upper(), vector) for name, data in DATA.items() for vector in data["vectors"]]
MODELS = {name: load_model(name) for name in model_names()}
LINKS = {
    name: tuple(RigidBody(link.mass, link.com, link.inertia) for link in model.links) for name, model in MODELS.items()
}
ARMS = {name: model.arm for name, model in MODELS.items()}
MEASURED = ARMS["CS66"].calibrated(
    a=(1e-4, -2e-4, -0.4272, -0.3903, 1e-4, -1e-4),
    d=(0.1626, 2e-4, -1e-4, 0.1474, 0.0966, 0.0919),
    alpha=(3e-4, pi / 2 - 2e-4, 4e-4, -1e-4, pi / 2 + 2e-4, -pi / 2 + 1e-4),
)
CASES = {name: (ARMS[name], LINKS[name]) for name in ARMS} | {"measured": (MEASURED, LINKS["CS66"])}

UP = (0.0, 0.0, 9.82)
WEIGHTLESS = (0.0, 0.0, 0.0)
REST = (0.0,) * 6
LOAD = RigidBody(2.5, (0.02, -0.015, 0.09), (0.004, 0.005, 0.006, 0.0003, -0.0002, 0.0001))
UNITS = [tuple(float(i == joint) for i in range(6)) for joint in range(6)]

STRETCHED = (0.0, 0.0, 0.0, 0.0, pi / 2, 0.0)
STRETCHED_WRIST_STRAIGHT = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
TOOL_DOWN = (0.0, -pi / 2, -pi / 2, -pi / 2, pi / 2, 0.0)
FOREARM_LEVEL = (0.0, -pi / 2, pi / 2, 0.0, pi / 2, 0.0)
UPRIGHT = (0.0, -pi / 2, 0.0, -pi / 2, pi / 2, 0.0)
STATIC = [
    ("CS66", STRETCHED, 0.0, (-60.30, -19.79, -0.32)),
    ("CS66", STRETCHED, 6.0, (-113.89, -48.22, -5.74)),
    ("CS612", STRETCHED, 0.0, (-133.32, -43.72, -0.77)),
    ("CS612", STRETCHED, 12.0, (-286.08, -124.00, -13.76)),
    ("CS66", STRETCHED_WRIST_STRAIGHT, 0.0, (-59.99, -19.48, 0.00)),
    ("CS66", STRETCHED_WRIST_STRAIGHT, 6.0, (-108.15, -42.49, 0.00)),
    ("CS612", STRETCHED_WRIST_STRAIGHT, 0.0, (-132.57, -42.96, -0.01)),
    ("CS612", STRETCHED_WRIST_STRAIGHT, 12.0, (-272.33, -110.25, -0.01)),
    ("CS66", TOOL_DOWN, 0.0, (21.22, 21.22, 1.74)),
    ("CS66", TOOL_DOWN, 6.0, (49.91, 49.91, 7.42)),
    ("CS612", TOOL_DOWN, 0.0, (46.29, 46.30, 3.34)),
    ("CS612", TOOL_DOWN, 12.0, (127.48, 127.49, 17.25)),
    ("CS66", FOREARM_LEVEL, 0.0, (-19.79, -19.79, -0.32)),
    ("CS66", FOREARM_LEVEL, 6.0, (-48.22, -48.22, -5.74)),
    ("CS612", FOREARM_LEVEL, 0.0, (-43.72, -43.72, -0.77)),
    ("CS612", FOREARM_LEVEL, 12.0, (-124.01, -124.00, -13.76)),
    ("CS66", UPRIGHT, 0.0, (0.32, 0.32, 0.32)),
    ("CS66", UPRIGHT, 6.0, (5.74, 5.74, 5.74)),
    ("CS612", UPRIGHT, 0.0, (0.76, 0.77, 0.77)),
    ("CS612", UPRIGHT, 12.0, (13.76, 13.76, 13.76)),
]
"""Torques of joints 2, 3, 4 at rest, to a hundredth; the rated mass as a point on the flange."""
WORST_SHARE = {
    "CS63": (0.97, 0.91),
    "CS66": (0.77, 0.34),
    "CS612": (0.89, 0.88),
    "CS616": (0.88, 0.85),
    "CS620": (0.92, 0.64),
    "CS625": (0.86, 0.62),
}
"""Largest static torque of joints 2 and 3 with the rated payload, as a share of their effort limit."""


@pytest.fixture(params=CASES)
def case(request: pytest.FixtureRequest) -> tuple[Arm, tuple[RigidBody, ...], random.Random]:
    arm, links = CASES[request.param]
    return arm, links, random.Random(request.param)


def numbers(rng: random.Random, span: float) -> tuple[float, ...]:
    return tuple(rng.uniform(-span, span) for _ in range(6))


def payload_of(vector: dict[str, Any]) -> RigidBody | None:
    given = vector["payload"]
    return None if given is None else RigidBody(given["mass"], tuple(given["cog"]), tuple(given["inertia"]))


def modified_link(q: float, a: float, d: float, alpha: float) -> Transform:
    c, s, ca, sa = cos(q), sin(q), cos(alpha), sin(alpha)
    return c, -s, 0.0, s * ca, c * ca, -sa, s * sa, c * sa, ca, a, -sa * d, ca * d


def frames(arm: Arm, q: tuple[float, ...]) -> list[Transform]:
    T, found = IDENTITY, []
    for angle, a, d, alpha in zip(q, *arm.modified_dh, strict=True):
        T = compose(T, modified_link(angle, a, d, alpha))
        found.append(T)
    return found


def potential_energy(arm: Arm, links: tuple[RigidBody, ...], q: tuple[float, ...], gravity: tuple[float, ...]) -> float:
    places = frames(arm, q)
    energy = 0.0
    for T, body in [*zip(places, links, strict=True), (places[-1], LOAD)]:
        energy += body.mass * sum(g * x for g, x in zip(gravity, apply(T, body.com), strict=True))
    return energy


def mass_matrix(arm: Arm, links: tuple[RigidBody, ...], q: Any, load: RigidBody | None = None) -> list[SixFloats]:
    """The mass matrix of the joints, by columns: torques that accelerate one joint alone, without gravity."""
    return [joint_torques(arm, links, q, REST, unit, REST[:3], load) for unit in UNITS]


def kinetic_energy(arm: Arm, links: tuple[RigidBody, ...], q: tuple[float, ...], qd: tuple[float, ...]) -> float:
    rows = mass_matrix(arm, links, q, LOAD)
    return 0.5 * sum(qd[i] * rows[i][j] * qd[j] for i in range(6) for j in range(6))


def point_energy(arm: Arm, body: RigidBody, joint: int, q: tuple[float, ...], qd: tuple[float, ...]) -> float:
    """Kinetic energy of a body without inertia of its own, from the way of its centre of mass."""
    step = 1e-5
    after, before = (
        apply(frames(arm, tuple(x + sign * step * v for x, v in zip(q, qd, strict=True)))[joint], body.com)
        for sign in (1, -1)
    )
    return 0.5 * body.mass * sum(((b - a) / (2 * step)) ** 2 for a, b in zip(before, after, strict=True))


@pytest.mark.parametrize(("name", "vector"), VECTORS, ids=[vector["id"] for _, vector in VECTORS])
def test_torques_meet_the_vector(name: str, vector: dict[str, Any]) -> None:
    arm, links, payload = ARMS[name], LINKS[name], payload_of(vector)
    gravity = vector["gravity"]
    moving = joint_torques(arm, links, vector["q"], vector["qd"], vector["qdd"], gravity, payload)
    assert moving == pytest.approx(vector["tau"], abs=1e-9)
    assert joint_torques(arm, links, vector["q"], REST, REST, gravity, payload) == pytest.approx(
        vector["tau_gravity"], abs=1e-9
    )


@pytest.mark.parametrize("name", ARMS)
def test_mass_matrix_meets_the_reference(name: str) -> None:
    wanted = DATA[name.lower()]["mass_matrix"]
    rows = mass_matrix(ARMS[name], LINKS[name], wanted["q"], payload_of(wanted))
    for row, wanted_row in zip(rows, wanted["M"], strict=True):
        assert row == pytest.approx(wanted_row, abs=1e-9)


@pytest.mark.parametrize(("name", "q", "mass", "torques"), STATIC)
def test_static_torques(name: str, q: SixFloats, mass: float, torques: tuple[float, ...]) -> None:
    found = joint_torques(ARMS[name], LINKS[name], q, REST, REST, UP, RigidBody(mass))
    assert found[1:4] == pytest.approx(torques, abs=0.0051)
    if mass == 0.0:
        assert (found[0], found[4], found[5]) == pytest.approx((0.0, 0.0, 0.0), abs=0.011)


@pytest.mark.parametrize("name", WORST_SHARE)
def test_every_arm_can_just_hold_its_rated_payload(name: str) -> None:
    model, rng = MODELS[name], random.Random(3)
    load = RigidBody(model.payload_max_kg)
    largest = [0.0, 0.0]
    for _ in range(600):
        torques = joint_torques(model.arm, LINKS[name], numbers(rng, pi), REST, REST, UP, load)
        for i in (0, 1):
            largest[i] = max(largest[i], abs(torques[1 + i]) / model.joints[1 + i].effort_max)
    for share, worst in zip(largest, WORST_SHARE[name], strict=True):
        assert 0.85 * worst < share < worst + 0.01


def test_a_calibration_that_changes_nothing_changes_no_torque() -> None:
    rng = random.Random(5)
    nominal = ARMS["CS612"]
    same = nominal.calibrated()
    for _ in range(10):
        state = numbers(rng, pi), numbers(rng, 2.0), numbers(rng, 5.0)
        wanted = joint_torques(nominal, LINKS["CS612"], *state, UP, LOAD)
        assert joint_torques(same, LINKS["CS612"], *state, UP, LOAD) == pytest.approx(wanted, abs=1e-9)


def test_power_of_the_joints_is_the_change_of_energy(case: Any) -> None:
    arm, links, rng = case
    step = 1e-5
    gravity = (2.0, -3.0, 9.0)

    def state(t: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
        motion = list(zip(q, qd, qdd, strict=True))
        return tuple(x + t * v + 0.5 * t * t * a for x, v, a in motion), tuple(v + t * a for _, v, a in motion)

    for _ in range(8):
        q, qd, qdd = numbers(rng, pi), numbers(rng, 2.0), numbers(rng, 5.0)
        torques = joint_torques(arm, links, q, qd, qdd, gravity, LOAD)
        power = sum(torque * speed for torque, speed in zip(torques, qd, strict=True))
        after, before = (
            kinetic_energy(arm, links, *state(t)) + potential_energy(arm, links, state(t)[0], gravity)
            for t in (step, -step)
        )
        assert power == pytest.approx((after - before) / (2 * step), abs=2e-5 * (1.0 + abs(power)))


def test_kinetic_energy_of_point_masses_is_that_of_their_speeds(case: Any) -> None:
    arm, links, rng = case
    points = tuple(RigidBody(body.mass, body.com) for body in links)
    for _ in range(4):
        q, qd = numbers(rng, pi), numbers(rng, 2.0)
        rows = mass_matrix(arm, points, q)
        energy = 0.5 * sum(qd[i] * rows[i][j] * qd[j] for i in range(6) for j in range(6))
        wanted = sum(point_energy(arm, body, joint, q, qd) for joint, body in enumerate(points))
        assert energy == pytest.approx(wanted, rel=1e-7)


def test_weight_is_the_slope_of_the_potential_energy(case: Any) -> None:
    arm, links, rng = case
    step = 1e-5
    for _ in range(5):
        q, gravity = numbers(rng, pi), tuple(rng.uniform(-10.0, 10.0) for _ in range(3))
        slopes = []
        for unit in UNITS:
            after, before = (
                potential_energy(arm, links, tuple(x + sign * step * u for x, u in zip(q, unit, strict=True)), gravity)
                for sign in (1, -1)
            )
            slopes.append((after - before) / (2 * step))
        assert joint_torques(arm, links, q, REST, REST, gravity, LOAD) == pytest.approx(slopes, abs=1e-6)


def test_mass_matrix_is_symmetric_and_positive_definite(case: Any) -> None:
    arm, links, rng = case
    for _ in range(10):
        rows = mass_matrix(arm, links, numbers(rng, pi), LOAD)
        for i in range(6):
            for j in range(i):
                assert rows[i][j] == pytest.approx(rows[j][i], abs=1e-11)
        lower = [[0.0] * 6 for _ in range(6)]
        for i in range(6):
            for j in range(i):
                known = sum(lower[i][k] * lower[j][k] for k in range(j))
                lower[i][j] = (rows[i][j] - known) / lower[j][j]
            square = rows[i][i] - sum(x * x for x in lower[i][:i])
            assert square > 1e-5
            lower[i][i] = sqrt(square)


def test_torques_are_linear_in_the_acceleration_with_the_mass_matrix_as_slope(case: Any) -> None:
    arm, links, rng = case
    for _ in range(5):
        q, qd, qdd = numbers(rng, pi), numbers(rng, 2.0), numbers(rng, 8.0)
        rows = mass_matrix(arm, links, q, LOAD)
        bias = joint_torques(arm, links, q, qd, REST, UP, LOAD)
        wanted = [c + sum(m * a for m, a in zip(row, qdd, strict=True)) for c, row in zip(bias, rows, strict=True)]
        assert joint_torques(arm, links, q, qd, qdd, UP, LOAD) == pytest.approx(wanted, abs=1e-9)


def test_the_acceleration_of_a_free_arm_is_found_back() -> None:
    arm, links, rng = ARMS["CS66"], LINKS["CS66"], random.Random(8)
    q, qd, qdd = numbers(rng, pi), numbers(rng, 2.0), numbers(rng, 8.0)
    torques = joint_torques(arm, links, q, qd, qdd, UP, LOAD)
    bias = joint_torques(arm, links, q, qd, REST, UP, LOAD)
    driving = [torque - known for torque, known in zip(torques, bias, strict=True)]
    assert solve_linear(mass_matrix(arm, links, q, LOAD), driving) == pytest.approx(qdd, abs=1e-8)


def test_velocity_torques_grow_with_the_square_of_the_speed(case: Any) -> None:
    arm, links, rng = case
    q, qd = numbers(rng, pi), numbers(rng, 2.0)
    once = joint_torques(arm, links, q, qd, REST, WEIGHTLESS, LOAD)
    thrice = joint_torques(arm, links, q, [-3.0 * speed for speed in qd], REST, WEIGHTLESS, LOAD)
    assert max(map(abs, once)) > 0.01
    assert thrice == pytest.approx([9.0 * torque for torque in once], abs=1e-9)


def test_a_payload_adds_to_the_last_link_as_a_part_of_it_would() -> None:
    rng = random.Random(12)
    arm, links = ARMS["CS66"], LINKS["CS66"]
    half = RigidBody(1.5, (0.03, 0.01, 0.05), (0.001, 0.002, 0.003, 1e-4, 2e-4, 3e-4))
    twice = RigidBody(3.0, half.com, tuple(2.0 * element for element in half.inertia))  # type: ignore[arg-type]
    state = numbers(rng, pi), numbers(rng, 2.0), numbers(rng, 8.0)
    bare, one, two = (joint_torques(arm, links, *state, UP, load) for load in (None, half, twice))
    assert [b - a for a, b in zip(one, two, strict=True)] == pytest.approx(
        [b - a for a, b in zip(bare, one, strict=True)], abs=1e-10
    )
    assert joint_torques(arm, links, *state, UP, RigidBody(0.0)) == bare


def test_two_point_masses_are_a_dumbbell() -> None:
    rng = random.Random(13)
    arm, links = ARMS["CS63"], LINKS["CS63"]
    weightless = (*(RigidBody(0.0),) * 5,)
    ends = RigidBody(0.5, (0.1, 0.2, 0.35)), RigidBody(0.5, (0.1, 0.2, 0.05))
    dumbbell = RigidBody(1.0, (0.1, 0.2, 0.2), (0.0225, 0.0225, 0.0, 0.0, 0.0, 0.0))
    state = numbers(rng, pi), numbers(rng, 2.0), numbers(rng, 8.0)
    halves = [joint_torques(arm, (*weightless, end), *state, UP) for end in ends]
    assert joint_torques(arm, (*weightless, dumbbell), *state, UP) == pytest.approx(
        [a + b for a, b in zip(*halves, strict=True)], abs=1e-12
    )
    assert joint_torques(arm, links, *state, UP) != halves[0]


@pytest.mark.parametrize(
    ("mass", "com", "inertia", "message"),
    [
        (-0.1, (0, 0, 0), (0,) * 6, r"mass of a body is -0\.1 kg; it cannot be negative"),
        (nan, (0, 0, 0), (0,) * 6, "mass of a body holds nan; it has to be finite"),
        (1.0, (0, inf, 0), (0,) * 6, "com of a body holds inf"),
        (1.0, (0, 0), (0,) * 6, "com of a body needs 3 numbers; it has 2"),
        (1.0, (0, 0, 0), (0,) * 5, "inertia of a body needs 6 numbers; it has 5"),
        (1.0, (0, 0, 0), (0, 0, 0, 0, 0, -inf), "inertia of a body holds -inf"),
    ],
)
def test_senseless_bodies_are_refused(mass: float, com: Any, inertia: Any, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        RigidBody(mass, com, inertia)
