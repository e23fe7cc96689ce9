"""Faults of inputs: every kind by a table written by hand, and mixes of them by what must hold of any."""

from __future__ import annotations

import tomllib
from pathlib import Path
from random import Random
from statistics import fmean, stdev
from typing import Any

import pytest

from elitescript import VirtualRobot
from elitescript.codec.json_text import from_text, to_text
from elitescript.codec.messages import shape_of
from elitescript.controller.signals.by_name import signal_write
from elitescript.controller.signals.input_faults import EFFECTS
from elitescript.devices.channels.faults import ANALOG, DIGITAL, TABLE
from elitescript.devices.channels.machine_faults import machine_fault
from elitescript.errors import UsageError
from elitescript.kernel import RobotOptions
from elitescript.kernel.kernel import Kernel
from elitescript.messages.enums import AnalogDomain
from elitescript.messages.events import SignalChanged
from elitescript.messages.inputs import AddFault, Do, EndFaults, Input
from elitescript.messages.machine import SetAnalogDomain
from elitescript.testing.world import Device, Fault, Schedule, TcpServer, Wire, World

CASES: dict[str, dict[str, Any]] = tomllib.loads(Path(__file__).with_name("inputs.toml").read_text("utf-8"))
WAIT = "def wait():\n  sleep({:.3f})\nend\n"
DIN = "standard_digital_in[3]"
AIN = "standard_analog_in[0]"


def changes(events: Any, name: str = "") -> list[tuple[int, object, str]]:
    """Every change of a signal, or of all: tick, value, by."""
    return [
        (event.tick, event.value, event.by)
        for event in events
        if isinstance(event, SignalChanged) and name in ("", event.name)
    ]


def case_fault(case: dict[str, Any]) -> Fault:
    return Fault(on=case["on"], **{"at_s": 0.04, "for_s": 0.08, **case["fault"]})


def expected(case: dict[str, Any]) -> list[tuple[int, object, str]]:
    return [
        (tick, pytest.approx(value) if isinstance(value, float) else value, by) for tick, value, by in case["reads"]
    ]


def kernel_changes(
    faults: list[Fault], applied: list[tuple[int, str, Any]], ticks: int
) -> list[tuple[int, object, str]]:
    """The same through the kernel that a served robot is."""
    kernel = Kernel(RobotOptions(faults=tuple(map(machine_fault, faults))))
    events: list[Any] = []
    for tick in range(ticks):
        inputs = [Do("world:schedule", signal_write(name, value)) for at, name, value in applied if at == tick]
        events += kernel.tick(inputs).events
    return changes(events)


@pytest.mark.parametrize("title", CASES)
def test_the_table_in_virtual_time(title: str) -> None:
    case = CASES[title]
    robot = VirtualRobot()
    fault = case_fault(case)
    settings = {"at_s": 0.04, "for_s": 0.08, **case["fault"]}
    robot.fault(settings.pop("kind"), on=fault.on, **settings)
    for tick, value in case["applied"]:
        robot.at(tick * 0.004, case["on"], value)
    assert changes(robot.run(WAIT.format(0.24)).events) == expected(case)


@pytest.mark.parametrize("title", CASES)
def test_the_table_of_a_served_robot(title: str) -> None:
    case = CASES[title]
    applied = [(tick, case["on"], value) for tick, value in case["applied"]]
    assert kernel_changes([case_fault(case)], applied, 60) == expected(case)


def test_every_fault_of_the_table_is_in_the_table() -> None:
    for kind, row in TABLE.items():
        for channel, effect in ((DIGITAL, row.digital), (ANALOG, row.analog)):
            found = [
                case
                for case in CASES.values()
                if case["fault"]["kind"] == kind and ("analog" in case["on"]) is (channel == ANALOG)
            ]
            has_chance = (kind, channel) == ("noisy", ANALOG)
            assert bool(found) is (effect.is_possible and not has_chance), (kind, channel)
    assert {kind: set(effects) for kind, effects in EFFECTS.items()} == {
        "bool": {"stuck", "inverted", "bouncing", "open_wire", "noisy", "late"},
        "float": {"stuck", "open_wire", "drifting", "noisy", "late"},
    }


def test_noise_has_the_deviation_that_was_asked_for() -> None:
    robot = VirtualRobot()
    robot.signals[AIN] = 5.0
    robot.fault("noisy", on=AIN, sigma=0.2)
    values = [value for _, value, _ in changes(robot.run(WAIT.format(16.0)).events)][1:]
    assert len(values) > 3900
    assert fmean(values) == pytest.approx(5.0, abs=0.02)
    assert stdev(values) == pytest.approx(0.2, rel=0.05)


def test_flips_come_as_often_as_was_asked_for_and_last_one_period() -> None:
    robot = VirtualRobot()
    robot.fault("noisy", on=DIN, rate_hz=10)
    found = changes(robot.run(WAIT.format(100.0)).events)
    assert 850 < len([value for _, value, _ in found if value]) < 1150
    assert all(by == "fault" for _, _, by in found)
    lengths = [fall[0] - rise[0] for rise, fall in zip(found[::2], found[1::2], strict=False)]
    assert max(lengths) <= 4  # flips may follow each other
    assert lengths.count(1) > 0.9 * len(lengths)


@pytest.mark.parametrize("seed", range(20))
def test_a_contact_bounces_as_often_as_was_asked_for(seed: int) -> None:
    robot = VirtualRobot()
    robot.fault("bouncing", on=DIN, settle_s=0.08, bounces=4, seed=seed)
    robot.at(0.04, DIN, True)
    found = changes(robot.run(WAIT.format(0.4)).events)
    assert [value for _, value, _ in found] == [True, False] * 4 + [True]
    assert found[0] == (10, True, "schedule")
    assert found[1][0] > 10 and found[-1][0] <= 30


def test_another_seed_is_another_pattern() -> None:
    def pattern(seed: int) -> list[tuple[int, object, str]]:
        world = World([Schedule(signal=DIN, at=[(0.04, True)])], seed=seed)
        world.fault("bouncing", on=DIN, settle_s=0.08, bounces=3)
        return changes(VirtualRobot(world=world).run(WAIT.format(0.4)).events)

    assert pattern(1) == pattern(1)
    assert len({tuple(pattern(seed)) for seed in range(8)}) > 4


# ---------------------------------------------------------------- mixes


def random_settings(random: Random, seed: int) -> tuple[str, dict[str, Any]]:
    """An input, and a fault of it that lasts."""
    is_digital = random.random() < 0.6
    digital = [
        {"kind": "stuck"},
        {"kind": "stuck", "value": random.random() < 0.5},
        {"kind": "inverted"},
        {"kind": "bouncing", "settle_s": 0.06, "bounces": random.randint(1, 4), "seed": seed},
        {"kind": "open_wire"},
        {"kind": "noisy", "rate_hz": random.choice((3, 60)), "seed": seed},
        {"kind": "late", "delay_s": random.choice((0.004, 0.05))},
    ]
    analog = [
        {"kind": "stuck"},
        {"kind": "open_wire", "value": 0.5},
        {"kind": "drifting", "per_s": random.choice((-3, 2)), "bound": random.choice((None, 0.1))},
        {"kind": "noisy", "sigma": 0.1, "every_s": random.choice((0.004, 0.03)), "seed": seed},
        {"kind": "late", "delay_s": 0.1},
    ]
    return DIN if is_digital else AIN, random.choice(digital if is_digital else analog)


def mix(seed: int) -> tuple[list[Fault], list[tuple[int, str, Any]]]:
    """Some faults of two inputs that overlap, and what is applied to these."""
    random = Random(seed)
    faults = []
    for _ in range(random.randint(1, 5)):
        on, settings = random_settings(random, seed)
        times = {"at_s": random.randrange(150) * 0.004, "for_s": random.choice((None, 0.004, 0.1, 0.3))}
        faults.append(Fault(on=on, **settings, **times))
    applied: list[tuple[int, str, Any]] = []
    for tick in sorted(random.sample(range(1, 240), 25)):
        level: Any = random.random() < 0.5
        applied.append((tick, DIN, level) if random.random() < 0.6 else (tick, AIN, round(random.uniform(0, 10), 2)))
    return faults, applied


def run_mix(faults: list[Fault], applied: list[tuple[int, str, Any]], **settings: Any) -> VirtualRobot:
    robot = VirtualRobot(world=World(faults=faults))
    for tick, name, value in applied:
        robot.at(tick * 0.004, name, value)
    robot.run(WAIT.format(1.0), **settings)
    return robot


@pytest.mark.parametrize("seed", range(40))
def test_leaping_stepping_and_serving_are_the_same(seed: int) -> None:
    faults, applied = mix(seed)
    leapt = run_mix(faults, applied).current
    stepped = run_mix(faults, applied, pace=lambda tick: None).current
    assert leapt is not None and stepped is not None
    found = changes(leapt.events)
    assert changes(stepped.events) == found
    assert [change for change in kernel_changes(faults, applied, 251) if change[0] <= 250] == found


@pytest.mark.parametrize("seed", range(40))
def test_what_is_applied_is_read_again_when_faults_are_over(seed: int) -> None:
    faults, applied = mix(seed)
    world = World(faults=faults)
    robot = VirtualRobot(world=world)
    for tick, name, value in applied:
        robot.at(tick * 0.004, name, value)
    robot.run(WAIT.format(1.0))
    world.end_faults()
    robot.run("def once():\n  sync()\nend\n")
    for name in (DIN, AIN):
        last = [value for _, which, value in applied if which == name]
        assert robot.signals[name] == (last[-1] if last else 0)


def test_faults_of_one_input_act_one_after_the_other() -> None:
    faults = [Fault("inverted", on=DIN, at_s=0.04), Fault("late", on=DIN, at_s=0.08, delay_s=0.04)]
    robot = run_mix(faults, [(25, DIN, True)])
    assert changes(robot.current.events if robot.current else ()) == [(10, True, "fault"), (35, False, "fault")]


# ---------------------------------------------------------------- what else sees it


def test_the_program_and_its_globals_read_the_fault_and_python_sets_what_is_applied() -> None:
    robot = VirtualRobot()
    robot.fault("stuck", on=DIN, value=True, for_s=0.1)
    run = robot.run(
        "def look():\n  global a\n  global b\n  a = get_standard_digital_in(3)\n  sleep(0.2)\n"
        "  b = get_standard_digital_in(3)\nend\n"
    )
    assert (run.globals["a"], run.globals["b"]) == (True, False)
    robot.fault("stuck", on=DIN, value=False)
    robot.signals[DIN] = True
    robot.run(WAIT.format(0.1))
    assert robot.signals[DIN] is False


def test_an_output_that_is_wired_to_an_input_passes_through_its_fault() -> None:
    wire = Wire(name="switch", when="standard_digital_out[0]", then="standard_digital_in[1]", after_s=0.02)
    world = World(wires=[wire], faults=[Fault("late", on="switch", delay_s=0.1)])
    run = VirtualRobot(world=world).run("def p():\n  set_standard_digital_out(0, True)\n  sleep(0.4)\nend\n")
    assert changes(run.events, "standard_digital_in[1]") == [(30, True, "fault")]


def test_a_wire_at_rest_is_stuck_as_it_rests() -> None:
    wire = Wire(when="standard_digital_out[0]", then="standard_digital_in[1]", inverted=True)
    world = World(wires=[wire], faults=[Fault("stuck", on="standard_digital_in[1]", for_s=0.2)])
    program = "def p():\n  set_standard_digital_out(0, True)\n  sleep(0.4)\nend\n"
    run = VirtualRobot(world=world).run(program)
    assert changes(run.events, "standard_digital_in[1]") == [(0, True, "wire"), (50, False, "fault")]


def test_an_open_wire_reads_no_current() -> None:
    robot = VirtualRobot()
    robot.controller.request(SetAnalogDomain("standard_analog_in", 0, AnalogDomain.CURRENT))
    robot.signals[AIN] = 0.012
    robot.fault("open_wire", on=AIN)
    robot.run(WAIT.format(0.1))
    assert robot.signals[AIN] == 0.0 < 0.004


def test_noise_stays_within_the_range_of_the_domain() -> None:
    robot = VirtualRobot()
    robot.controller.request(SetAnalogDomain("standard_analog_in", 0, AnalogDomain.CURRENT))
    robot.signals[AIN] = 0.019
    robot.fault("noisy", on=AIN, sigma=0.01)
    values = [value for _, value, _ in changes(robot.run(WAIT.format(1.0)).events)]
    assert min(values) == 0.0 and max(values) == 0.020


def test_a_robot_without_faults_of_inputs_has_nothing_of_them() -> None:
    robot = VirtualRobot(world=World([TcpServer(port=5000)], faults=[Fault("drop", on=5000)]))
    robot.run(WAIT.format(0.1))
    assert robot.controller.signals.faults is None


def test_a_client_of_a_served_robot_lets_one_come_and_go() -> None:
    kernel = Kernel(RobotOptions())
    events: list[Any] = []
    fault = machine_fault(Fault("stuck", on=DIN, value=True))
    for tick in range(12):
        inputs = {3: [AddFault("ctl", fault)], 8: [EndFaults("ctl")]}.get(tick, ())
        events += kernel.tick(inputs).events
    assert changes(events) == [(3, True, "fault"), (8, False, "fault")]


# ---------------------------------------------------------------- names


class Door(Device):
    name = "door"
    contact = "standard_digital_in[5]"
    lamp = "standard_digital_out[2]"


def test_a_device_is_named_in_place_of_its_port_or_of_the_input_that_it_sets() -> None:
    devices = [TcpServer(name="camera", port=5000), Door(), Schedule(name="button", signal=DIN, at=[(0.0, True)])]
    world = World(
        devices,
        faults=[
            Fault("delay", on="camera", delay_s=0.1),
            Fault("stuck", on="door"),
            Fault("bouncing", on="button"),
        ],
        seed=9,
    )
    assert [(fault.on, fault.seed) for fault in world.faults] == [
        (5000, None),
        ("standard_digital_in[5]", None),
        (DIN, 9),
    ]


@pytest.mark.parametrize(
    ("kind", "on", "words"),
    [
        ("stuck", "dor", "on: there is no device, serial port or input 'dor'; did you mean 'door'"),
        ("stuck", "standard_digital_inn", "did you mean 'standard_digital_in'"),
        ("stuck", "camera", "on: camera sets no input; name the place itself"),
        ("drop", "door", "on: door has no port or line"),
        ("stuck", "two", "on: two sets standard_digital_in.0., standard_digital_in.1.; name one of them"),
        ("drifting", "door", "kind: drifting on 'standard_digital_in.5.': a digital input has two levels only"),
    ],
)
def test_a_name_that_means_no_place_is_refused(kind: str, on: str, words: str) -> None:
    class Two(Device):
        first = "standard_digital_in[0]"
        second = "standard_digital_in[1]"

    world = World([TcpServer(name="camera", port=5000), Door(), Two(name="two")])
    with pytest.raises(UsageError, match=words):
        world.fault(kind, on=on, **({"per_s": 1} if kind == "drifting" else {}))


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"kind": "stuk", "on": DIN}, "kind: there is no fault 'stuk'; there are .*; did you mean 'stuck'"),
        ({"kind": "drop", "on": DIN}, "it is a fault of connections and serial lines. Take stuck"),
        ({"kind": "delay", "on": DIN}, "Take late"),
        ({"kind": "stuck", "on": 5000}, "kind: stuck on 5000: it is a fault of inputs"),
        ({"kind": "stuck", "on": "emergency_stop"}, "on: emergency_stop is no digital or analog input"),
        ({"kind": "stuck", "on": "input_bool_register[0]"}, "is no digital or analog input"),
        ({"kind": "stuck", "on": "standard_digital_in[16]"}, "on: standard_digital_in has indices 0 to 15"),
        ({"kind": "stuck", "on": DIN, "value": 3}, "value: standard_digital_in.3. reads true or false, not 3"),
        ({"kind": "stuck", "on": AIN, "value": 11}, "value: must be a number in"),
        ({"kind": "stuck", "on": AIN, "value": True}, "value: must be a number in"),
        ({"kind": "inverted", "on": AIN}, "an analog level has no opposite"),
        ({"kind": "inverted", "on": DIN, "value": True}, "value: inverted has no such setting; stuck, open_wire has"),
        ({"kind": "bouncing", "on": DIN, "settle_s": 0.012}, "settle_s: 2 bounces need two control periods each"),
        ({"kind": "bouncing", "on": DIN, "bounces": 0}, "bounces: must be a whole number"),
        ({"kind": "drifting", "on": AIN}, "per_s: is missing"),
        ({"kind": "drifting", "on": AIN, "per_s": float("nan")}, "per_s: must be a number"),
        ({"kind": "noisy", "on": AIN}, "sigma: is missing"),
        ({"kind": "noisy", "on": DIN}, "rate_hz: is missing"),
        ({"kind": "noisy", "on": DIN, "sigma": 0.1}, "sigma: a digital input has rate_hz"),
        ({"kind": "noisy", "on": AIN, "rate_hz": 1}, "rate_hz: an analog input has sigma"),
        ({"kind": "noisy", "on": DIN, "rate_hz": 251}, "rate_hz: must be a number in .0, 250."),
        ({"kind": "late", "on": DIN}, "delay_s: must be one control period at least"),
        ({"kind": "stuck", "on": DIN, "nth": 2}, "nth: stuck is about an input, not about messages"),
        ({"kind": "stuck", "on": DIN, "direction": "to_robot"}, "direction: stuck is about an input"),
    ],
)
def test_what_makes_no_sense_is_refused(settings: dict[str, Any], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        Fault(**settings)


@pytest.mark.parametrize("title", CASES)
def test_a_fault_reaches_the_robot_of_another_process_as_it_is(title: str) -> None:
    shape, fault = shape_of(Input), AddFault("ctl", machine_fault(case_fault(CASES[title])))
    assert repr(shape.decode(from_text(to_text(shape.encode(fault))))) == repr(fault)
