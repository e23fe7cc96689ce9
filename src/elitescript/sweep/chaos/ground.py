"""What there is to disturb: places of faults, inputs that the program reads, moments at which something happens there.

It comes from the program, from what is beside the robot, and from a plain run: one without disturbances, in which
everything that passes over channels is heard.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Final

from elitescript.devices.channels.faults import ANALOG, DIGITAL, FORMS, INPUTS, LINE, TABLE, TCP, Fault, place_of
from elitescript.errors import UsageError
from elitescript.language.parser import parse
from elitescript.lint.program import AnalysedProgram
from elitescript.messages.events import SignalChanged
from elitescript.messages.faults import Passing
from elitescript.messages.signals import SIGNALS, parse_signal_name, point_names, signal_name
from elitescript.messages.timing import seconds
from elitescript.records import NamedTuple, record
from elitescript.sweep.chaos.kinds import KINDS, PLACED, is_fault

if TYPE_CHECKING:
    from elitescript.language.text.source import SourceFile
    from elitescript.messages.motion import Six
    from elitescript.messages.profile import Profile
    from elitescript.robot import VirtualRobot
    from elitescript.run import Run

MOMENTS_MAX: Final = 1000
"""Moments of one place that are kept."""

_READERS: Final = {
    "get_standard_digital_in": "standard_digital_in",
    "get_configurable_digital_in": "configurable_digital_in",
    "get_tool_digital": "tool_digital_in",
    "get_standard_analog_in": "standard_analog_in",
    "get_tool_analog_in": "tool_analog_in",
}
"""Commands that read inputs."""

_FEELERS: Final = ("force_mode", "get_tcp_force", "freedrive_mode", "zero_ftsensor", "get_tool_force")
"""Commands of programs for which it matters what pushes the tool."""

_SAMPLES: Final[dict[str, dict[str, Any]]] = {
    "delay": {"delay_s": 1.0},
    "late": {"delay_s": 1.0},
    "drifting": {"per_s": 0.1},
}
_REPLIES: Final[dict[str, dict[str, Any]]] = {
    "text": {"reply": "?\r\n"},
    "exception": {"code": 4},
    "fault": {"code": 1, "reply": "failed"},
    "http": {"code": 503},
}
"""Settings without which a fault, or a form of wrong replies, is none."""


class Place(NamedTuple):
    """Something that can be disturbed.

    Attributes:
        on: as in `Fault.on`.
        kind: `tcp`, `line`, `digital` or `analog`.
        device: title of what is there, for people; empty if nothing is.
        moments: times at which something passed or changed there in the plain run, s.
    """

    on: int | str
    kind: str
    device: str = ""
    moments: tuple[float, ...] = ()


class Chance(NamedTuple):
    """A kind of disturbance at a place where it makes sense.

    Attributes:
        kind: of the disturbance.
        place: where; None for what is nowhere in particular.
        settings: that it needs there, besides those that are drawn.
    """

    kind: str
    place: Place | None = None
    settings: Mapping[str, Any] = {}


@record
class End:
    """How a run ended, for a comparison with another one.

    Attributes:
        state: of the run.
        joints: rad.
        outputs: digital and analog ones that are not at their default, by name.
        time_s: virtual time, s.
    """

    state: str
    joints: Six | tuple[()]
    outputs: Mapping[str, Any]
    time_s: float


@record
class Ground:
    """What there is to disturb in one program and its world.

    Attributes:
        chances: what can go wrong, where it makes sense.
        plain: end of the plain run.
        rises: for each digital input, times at which it became high in the plain run, s.
    """

    chances: tuple[Chance, ...]
    plain: End
    rises: Mapping[str, tuple[float, ...]]


class Ears:
    """Hears what passes over the channels of a robot in one run.

    Args:
        robot: before its program begins.

    Attributes:
        heard: messages in their order.
    """

    __slots__ = ("heard",)

    def __init__(self, robot: VirtualRobot) -> None:
        self.heard: list[Passing] = []
        if robot.surroundings is not None:
            robot.surroundings.hear(self.heard.append)


_OUTPUTS: Final = tuple(
    name for name in SIGNALS if name.endswith("_out") and ("_digital_" in name or "_analog_" in name)
)


def end_of(run: Run) -> End:
    """Return how a run ended."""
    outputs = {name: value for name, value in run.signals.items() if name.partition("[")[0] in _OUTPUTS}
    return End(run.state, run.joints, outputs, run.time_s)


def survey(robot: VirtualRobot, run: Run, heard: Iterable[Passing]) -> Ground:
    """Return what there is to disturb.

    Args:
        robot: after a plain run.
        run: that run.
        heard: what passed over its channels.
    """
    places = [*_channels(robot, heard), *_inputs(robot, run)]
    chances = [Chance(kind, place, settings) for place in places for kind, settings in _faults_of(robot, place)]
    chances += [Chance(kind, place) for place in places if place.kind == DIGITAL for kind in PLACED]
    program = read_of(run.unit.source, robot.profile)
    for row in KINDS.values():
        if is_fault(row.name) or row.name in PLACED:
            continue
        if row.name == "reduced_mode" and robot.options.safety is None:
            continue
        if row.name == "push" and not program.feels:
            continue
        chances.append(Chance(row.name))
    rises: dict[str, list[float]] = {}
    for event in run.events:
        if isinstance(event, SignalChanged) and event.value is True:
            rises.setdefault(event.name, []).append(seconds(event.tick))
    return Ground(tuple(chances), end_of(run), {name: tuple(times) for name, times in rises.items()})


def _channels(robot: VirtualRobot, heard: Iterable[Passing]) -> list[Place]:
    if robot.surroundings is None:
        return []
    messages = list(heard)
    found: dict[str, Place] = {}
    for on, kind, device in robot.surroundings.fault_places():
        if kind not in (TCP, LINE) or on in found:
            continue
        _, address, port = where = place_of(on)
        times = [
            seconds(message.tick)
            for message in messages
            if message.place == where
            or (kind == TCP and message.place[0] == TCP and message.place[2] == port and not address)
        ]
        found[on] = Place(port if kind == TCP and not address else on, kind, device, _few(times))
    return list(found.values())


def _inputs(robot: VirtualRobot, run: Run) -> list[Place]:
    """Return the inputs that the program reads; those that something drives, if it is not known which it reads."""
    driven: dict[str, str] = {}
    for on, kind, device in () if robot.surroundings is None else robot.surroundings.fault_places():
        if kind in (DIGITAL, ANALOG):
            row, index = parse_signal_name(on)
            driven.setdefault(signal_name(row, index), device)
    changes: dict[str, list[float]] = {}
    for event in run.events:
        if isinstance(event, SignalChanged) and event.name.partition("[")[0] in INPUTS:
            changes.setdefault(event.name, []).append(seconds(event.tick))
    program = read_of(run.unit.source, robot.profile)
    names = set(program.inputs)
    names |= {name for name in (*driven, *changes) if name.partition("[")[0] in program.families}
    ordered = [name for family in INPUTS for name in point_names(family) if name in names]
    return [
        Place(name, INPUTS[name.partition("[")[0]], driven.get(name, ""), _few(changes.get(name, [])))
        for name in ordered
    ]


def _few(times: list[float]) -> tuple[float, ...]:
    """Return times, evenly left out if there are very many."""
    step = -(-len(times) // MOMENTS_MAX) or 1
    return tuple(times[::step])


def _faults_of(robot: VirtualRobot, place: Place) -> Iterable[tuple[str, Mapping[str, Any]]]:
    """Yield the kinds of faults that make sense at a place, with the settings that they need there."""
    for kind in KINDS:
        if kind not in TABLE:
            continue
        forms = FORMS if kind == "wrong_reply" else ("",)
        for form in forms:
            settings = {"form": form, **_REPLIES.get(form, {})} if form else dict(_SAMPLES.get(kind, {}))
            if kind == "noisy":
                settings["rate_hz" if place.kind == DIGITAL else "sigma"] = 1.0
            try:
                fault = Fault(kind, place.on, **settings)
                if robot.surroundings is not None:
                    robot.surroundings.check_fault(fault)
            except UsageError:
                continue  # it makes no sense there
            yield kind, settings


class ProgramReads(NamedTuple):
    """What a program reads of the world.

    Attributes:
        inputs: names of inputs whose index is certain.
        families: of inputs that it reads with an index that is not.
        feels: whether it matters to it what pushes the tool.
    """

    inputs: frozenset[str]
    families: frozenset[str]
    feels: bool


def read_of(source: SourceFile, profile: Profile) -> ProgramReads:
    """Return what a program reads of the world, as far as its text says it."""
    analysed = AnalysedProgram(parse(source), profile)
    inputs: set[str] = set()
    families: set[str] = set()
    feels = False
    for called, arguments in zip(analysed.command_calls, analysed.arguments, strict=True):
        feels |= called.command.name in _FEELERS
        family = _READERS.get(called.command.name)
        if family is None:
            continue
        nodes: list[ast.expr] = [node for _, node in arguments.given]
        index = analysed.constants.value(nodes[0], called.scope) if nodes else 0
        names = point_names(family)
        if isinstance(index, int) and 0 <= index < len(names):
            inputs.add(names[index])
        else:
            families.add(family)
    return ProgramReads(frozenset(inputs), frozenset(families), feels)
