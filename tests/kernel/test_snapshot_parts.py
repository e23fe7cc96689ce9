"""A snapshot of some parts: those are as in a whole one, the others as they were."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest

from elitescript.controller.force.contact import ContactConfig, Plane
from elitescript.kernel import Kernel, RobotOptions
from elitescript.messages.plant import PlantConfig
from elitescript.messages.snapshot_parts import ALL_PARTS, ELBOW, JOINTS, LOADS, TEMPERATURES, TIME
from tests.kernel.machine import READY, program
from tests.messages.snapshot_fields import DISCRETE, FIELDS, values_of, with_parts_of
from tests.protocol.snapshots import snapshot as made_snapshot

PROGRAM = (
    "set_tcp([0, 0.02, 0.1, 0.3, 0, 0])",
    "set_payload(1.5, [0.01, 0, 0.05])",
    "movej([0.2, -1.4, -1.7, -1.6, 1.57, 0.4], a=1.4, v=1.05)",
    "movel(pose_trans(get_actual_tcp_pose(), [0, 0, 0.02, 0, 0, 0]), a=1.2, v=0.25)",
    "sleep(0.2)",
    "set_standard_digital_out(1, True)",
    "zero_ftsensor()",
    "sleep(0.1)",
    "speedl([0.05, 0.02, 0.01, 0.1, 0, 0], 0.5, 0.3)",
    "stopl(1)",
)
LAGGING = PlantConfig(lag_s=0.03)
NOISY = PlantConfig(lag_s=0.03, noise_rad=1e-4, seed=5)
FLOOR = ContactConfig((Plane((0.0, 0.0, 0.3), (0.0, 0.0, 1.0), 5000.0),))


@pytest.mark.parametrize(
    "options",
    [READY, replace(READY, plant=LAGGING, contact=FLOOR), replace(READY, plant=NOISY, contact=FLOOR)],
    ids=["exact", "lagging", "noisy"],
)
def test_parts_are_those_of_the_whole(options: RobotOptions) -> None:
    random = Random(11)
    whole, some = Kernel(options), Kernel(options)
    expected: dict[str, object] = {}
    for tick in range(1500):
        inputs = [program(*PROGRAM)] if tick == 3 else ()
        full = values_of(whole.tick_and_snapshot(inputs).snapshot)
        some.tick(inputs)
        parts = ALL_PARTS if not tick else random.choice((0, TIME, JOINTS, random.randint(0, ALL_PARTS)))
        found = values_of(some.snapshot(parts))
        if tick % 7 == 0:
            # What the arm at rest has already is not computed again.
            assert repr(values_of(some.snapshot(parts))) == repr(found)
        names = DISCRETE.union(*(in_part for part, in_part in FIELDS.items() if part & (parts | TIME)))
        if options.plant is NOISY:
            # The elbow of an arm at rest has the noise of the tick in which it was computed.
            names -= FIELDS[ELBOW]
        for name in names:
            assert repr(found[name]) == repr(full[name]), (tick, parts, name)
        # The joints come with what follows from them.
        for name in found.keys() - names - FIELDS[JOINTS] - FIELDS[ELBOW] - {"robot_current"}:
            assert repr(found[name]) == repr(expected[name]), (tick, parts, name)
        expected |= found


def test_the_first_one_is_whole() -> None:
    one, other = Kernel(READY), Kernel(READY)
    assert one.tick_and_snapshot().snapshot == (other.tick(), other.snapshot(0))[1]


def test_loads_that_are_not_read_are_not_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    kernel = Kernel(READY)
    kernel.tick_and_snapshot([program(*PROGRAM)])
    calls = dict.fromkeys(("measured", "temperatures"), 0)

    def counted(name: str, call):
        def run(*arguments):
            calls[name] += 1
            return call(*arguments)

        return run

    for name in calls:
        owner = type(kernel.controller.loads)
        monkeypatch.setattr(owner, name, counted(name, getattr(owner, name)))
    for _ in range(50):
        kernel.tick()
        kernel.snapshot(ALL_PARTS & ~LOADS & ~TEMPERATURES)
    assert calls == {"measured": 0, "temperatures": 0}
    kernel.snapshot()
    assert calls == {"measured": 1, "temperatures": 1}


def test_the_fields_by_hand_replace_what_they_name() -> None:
    one, other = made_snapshot(5), Kernel(READY).tick_and_snapshot().snapshot
    assert with_parts_of(one, other, ALL_PARTS).joint_torques == other.joint_torques
    assert with_parts_of(one, other, ALL_PARTS).signals == one.signals
