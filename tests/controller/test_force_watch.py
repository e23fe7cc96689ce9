"""When a force at the TCP is too high, and when it is tolerated."""

import pytest

from elitescript.controller.force.contact import ContactConfig
from elitescript.controller.force.wrench_sensor import WrenchSensor
from elitescript.controller.safety.force_watch import ForceWatch
from elitescript.controller.safety.limits import SafetyLimits
from elitescript.controller.safety.monitor import SafetyMonitor
from elitescript.controller.signals.image import SignalImage
from elitescript.controller.tool_setup import Setup
from elitescript.messages.enums import SafetyMode
from elitescript.messages.state import ZERO_SIX
from elitescript.messages.yielding import ForceMode
from elitescript.models.model import load_model

MODEL = load_model("CS66")
NORMAL = SafetyMode.NORMAL


@pytest.fixture
def signals():
    return SignalImage(lambda name, index, value, before: None)


@pytest.fixture
def watch(signals):
    sensor = WrenchSensor(MODEL.arm, Setup(MODEL), signals, ContactConfig())
    watch = ForceWatch(SafetyMonitor(MODEL.arm, SafetyLimits()), sensor)
    watch.is_to_tolerate = False
    return watch


def look(watch, signals, force, mode=NORMAL):
    signals.write("external_wrench", 1, -force)
    breach, warning = watch.look(MODEL.home, ZERO_SIX, mode)
    return None if breach is None else breach.value, warning


def test_a_force_is_compared_with_the_limit_of_the_mode(watch, signals):
    assert not watch.is_watching
    assert look(watch, signals, 250.0) == (None, "")
    assert watch.is_watching
    assert look(watch, signals, 250.1) == (pytest.approx(250.1), "")
    assert look(watch, signals, 151.0, SafetyMode.REDUCED) == (pytest.approx(151.0), "")


def test_a_force_that_is_there_when_the_arm_may_move_again_is_tolerated_until_it_grows_or_has_been_away(watch, signals):
    watch.is_to_tolerate = True
    breach, warning = look(watch, signals, 300.0)
    assert breach is None
    watch.is_to_tolerate = False
    assert "300.0 N; 250 N are allowed in normal mode; the arm may move back out" in warning
    assert look(watch, signals, 305.0) == (None, "")
    assert look(watch, signals, 307.0) == (pytest.approx(307.0), "")
    assert look(watch, signals, 240.0) == (None, "")
    assert look(watch, signals, 260.0) == (pytest.approx(260.0), "")


@pytest.mark.parametrize(
    ("target", "mode", "is_said"),
    [
        ((200.0, 0.0, -200.0), NORMAL, True),
        ((0.0, 0.0, -250.0), NORMAL, False),
        ((0.0, 999.0, 0.0), NORMAL, False),
        ((0.0, 0.0, -200.0), SafetyMode.REDUCED, True),
    ],
)
def test_a_target_above_the_limit_along_axes_that_yield_is_said(watch, target, mode, is_said):
    axes = (True, False, True, False, False, False)
    request = ForceMode(ZERO_SIX, axes, (*target, 0.0, 0.0, 0.0), 0, (0.1,) * 6)
    assert bool(watch.caution(request, mode)) is is_said
