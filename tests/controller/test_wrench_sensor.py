"""What the force/torque sensor reads, and what it does not ask for."""

from __future__ import annotations

from elitescript.controller.force.contact import ContactConfig
from elitescript.controller.force.wrench_sensor import WrenchSensor
from elitescript.controller.signals.image import SignalImage
from elitescript.controller.tool_setup import Setup
from elitescript.messages.state import ZERO_SIX, Payload
from elitescript.models.model import load_model

MODEL = load_model("CS66")
Q = (0.3, -1.1, -1.9, 0.4, 1.2, -2.0)
QD = (0.1, 0.2, -0.3, 0.4, -0.5, 0.6)


def sensor(payload: Payload | None = None) -> WrenchSensor:
    setup = Setup(MODEL)
    if payload is not None:
        setup.payload = payload
    return WrenchSensor(MODEL.arm, setup, SignalImage(lambda name, index, value, before: None), ContactConfig())


def test_an_arm_that_nothing_touches_reads_plain_zeros() -> None:
    assert repr(sensor().compensated(Q, QD)) == repr(ZERO_SIX)
    assert repr(sensor().raw(Q, QD, lambda: QD)) == repr(ZERO_SIX)


def test_accelerations_are_asked_for_only_with_a_payload() -> None:
    asked = []

    def qdd() -> tuple[float, ...]:
        asked.append(1)
        return ZERO_SIX

    sensor().raw(Q, QD, qdd)
    assert not asked
    read = sensor(Payload(2.0)).raw(Q, ZERO_SIX, qdd)
    assert asked
    assert sum(part * part for part in read[:3]) ** 0.5 > 19.0
