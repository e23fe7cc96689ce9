"""One run of a sweep: from its number to its choices, from its choices to its row."""

from __future__ import annotations

import traceback
from base64 import b64decode
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from hashlib import sha256
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any, Final

from elitescript.controller.views.trace import Trace
from elitescript.devices.scenario import python_files
from elitescript.devices.surroundings import REAL, VIRTUAL
from elitescript.environment.local_channels import LocalChannels
from elitescript.environment.memory import MemoryEnvironment
from elitescript.environment.start_values import check_presets, parse_settings
from elitescript.errors import ElitescriptError, ProgramError, UsageError
from elitescript.kernel.options import ROBOT_SECTION
from elitescript.language.compiler import CompiledUnit
from elitescript.language.diagnostics import Diagnostic
from elitescript.language.parser import parse
from elitescript.lint.engine import check_parsed
from elitescript.messages.signals import SIGNALS
from elitescript.messages.timing import ticks_for
from elitescript.models.model import RobotModel, load_model, parse_model
from elitescript.properties.checks import Checks
from elitescript.properties.functions_of_files import FunctionMeasure, FunctionProperty
from elitescript.properties.parsing import parse_measure, parse_property
from elitescript.properties.verdicts import Measure, Property
from elitescript.robot import VirtualRobot
from elitescript.sweep.chaos.properties import BUILT_INS, NEVER_STUCK, BuiltInProperty, is_built_in, properties_of
from elitescript.sweep.chaos.session import ChaosSession
from elitescript.sweep.plans.plan import CRASHED, ERROR, Choices, Failure, Plan, Row
from elitescript.sweep.plans.plan_json import choices_data, choices_of, plan_of, row_data
from elitescript.sweep.plans.program_values import MARK, put_presets
from elitescript.sweep.plans.python_files import PythonFiles
from elitescript.sweep.plans.seeds import seed_of_name, seed_of_run
from elitescript.sweep.plans.trees import PREFIXES, source_of_plan
from elitescript.sweep.plans.variations import Draw, extremes, plain_value
from elitescript.sweep.plans.world_values import Path as Place
from elitescript.sweep.plans.world_values import place_of, with_value
from elitescript.world_file import WORLD_SECTIONS, WorldFile, read_tables, tables_of

if TYPE_CHECKING:
    from elitescript.controller.controller import Controller
    from elitescript.messages.events import Event
    from elitescript.run import Run

_HERE: Final = "<python>"
"""Stands for the file of functions that are no text."""

LONGER: Final = 4.0
"""How many times as long a run goes on that is said to last for ever, *assumed*."""


class Runner:
    """Runs the runs of one plan, one after the other; kept in a worker, since it parses everything once.

    Args:
        plan: of the sweep.
        functions: properties and measures that are no text, by the text that stands for them in the plan.

    Attributes:
        plan: see above.
        chaos: what goes wrong, and what built-in properties need to know.
        problems: warnings about the program.

    Raises:
        UsageError: something in the plan makes no sense.
        ProgramError: the program does not compile.
    """

    def __init__(self, plan: Plan, functions: Mapping[str, Callable[[Run], Any]] | None = None) -> None:
        self.plan = plan
        self._functions = functions or {}
        self._model = _model_of(plan)
        self._options = {**plan.options, "seed": 0}
        for name in ("model", "model_text"):
            self._options.pop(name, None)
        self._files = {name: b64decode(data) for name, data in plan.files.items()}
        self._levels, presets = parse_settings(list(plan.settings))
        check_presets(presets, plan.program)
        self._presets: dict[str, Any] = presets
        self._python = PythonFiles(plan.python)
        self._draw = Draw(plan.variations, plan.seed)
        self._world_path = Path(plan.world_name or "world.toml")
        self._tables = tables_of(self._world_path, plan.world) if plan.world else {}
        if self._tables.get("world", {}).get("network") == REAL:
            raise UsageError(
                f"{self._world_path}: [world] network: {REAL!r} is not allowed in a sweep, which is closed"
            )
        if isinstance(robot := self._tables.get(ROBOT_SECTION), dict) and "model" in robot:
            # It is among the options of the plan.
            self._tables = {**self._tables, ROBOT_SECTION: {key: robot[key] for key in robot if key != "model"}}
        self._device_files = sorted(set(python_files(self._tables)))
        self._has_world = any(section in self._tables for section in WORLD_SECTIONS) or bool(plan.chaos)
        self._signal_names: list[str] = []
        self._places: dict[str, Place] = {}
        program_names: list[str] = []
        for row in plan.variations:
            if row.name.startswith(PREFIXES):
                program_names.append(row.name)
            elif "." in row.name:
                self._places[row.name] = place_of(row.name, self._tables)
            elif row.name.partition("[")[0] in SIGNALS:
                self._signal_names.append(row.name)
            else:
                program_names.append(row.name)
        self._fixed_file = self._fixed()
        self._plain = Choices(0, seed_of_run(plan.seed, 0), {row.name: plain_value(row) for row in plan.variations})
        self._check_extremes()
        robot = self.robot(self._plain)
        self._unit, self._preset_names, self.problems = self._compiled(program_names, robot)
        self.chaos = ChaosSession(plan, self._plain, robot, self._play_plain, self._source_of)
        self._checks = self._checks_of(plan)

    def _fixed(self) -> WorldFile | None:
        """Return what the world file says of the robot, if that is the same in every run."""
        sections = {place[0] for place in self._places.values()}
        if sections - set(WORLD_SECTIONS):
            return None
        return read_tables(self._world_path, self.plan.world, self._tables, network=VIRTUAL, with_world=False)

    def _compiled(
        self, names: Sequence[str], robot: VirtualRobot
    ) -> tuple[CompiledUnit, dict[str, str], tuple[Diagnostic, ...]]:
        """Return the program, the preset of each name that is varied, and warnings."""
        source = source_of_plan(self.plan)
        parsed = parse(source, robot.text_options(source))
        found = put_presets(parsed, names) if not parsed.has_errors else {}
        known = {*self._presets, *found.values()}
        checked = check_parsed(parsed, robot.profile, presets=known, arm=robot.model)
        if checked.unit is None or checked.is_refused:
            raise ProgramError(checked.problems)
        return checked.unit, found, checked.problems

    def _checks_of(self, plan: Plan) -> Checks:
        """Return the properties and measures of the plan."""
        names = {*self._unit.global_names, *self._presets, *self._preset_names.values()}
        known = {name for name in names if not name.startswith(MARK)}
        named = {name: partial(_named, self.chaos, name) for name in BUILT_INS}

        def property_of(text: str) -> Property:
            if text in self._functions:
                return FunctionProperty(text, _HERE, text, self._functions_of)
            return (
                self.chaos.property(text)
                if is_built_in(text)
                else parse_property(text, known, load=self._load, named=named)
            )

        def measure_of(text: str) -> Measure:
            if text in self._functions:
                return FunctionMeasure(text, _HERE, text, self._functions_of)
            return parse_measure(text, known, load=self._load)

        properties = [property_of(text) for text in properties_of(plan)]
        measures = {name: measure_of(text) for name, text in plan.measures.items()}
        return Checks(properties, measures, plan.step_s)

    def _functions_of(self, _path: str) -> Mapping[str, Any]:
        return self._functions

    def _load(self, path: str) -> Mapping[str, Any]:
        """Return the names of a Python file of the plan, loaded anew."""
        return vars(self._python.modules([path])[path])

    def _check_extremes(self) -> None:
        """Try the ends of each variation before the first run, and before them the world as it stands in its file."""
        self.robot(Choices(0, 0))
        for row in self.plan.variations:
            for value in extremes(row):
                try:
                    self.robot(Choices(0, 0, {row.name: value}))
                except UsageError as error:
                    raise UsageError(f"--vary {row.name}: {value!r} is not possible: {error}") from error

    # ---------------------------------------------------------------- one run

    def choices_of(self, run: int) -> Choices:
        """Return what is drawn for a run: the same for its number in every process."""
        return Choices(run, seed_of_run(self.plan.seed, run), self._draw.values(run), self.chaos.draw(run))

    def _source_of(self, run: int, name: str) -> Random:
        return Random(seed_of_name(self.plan.seed, run, name))

    def robot(self, choices: Choices, on_event: Callable[[Event], None] | None = None) -> VirtualRobot:
        """Return the robot of a run before its program begins, with its values, and without disturbances yet.

        Raises:
            UsageError: a value makes no sense.
        """
        file = self._world_file(choices)
        environment: Any = file.world
        if environment is None:
            environment = MemoryEnvironment(self._files, LocalChannels(is_closed=True))
        options = {**self._options, **self._options_from(file)}
        options["seed"] = choices.seed
        robot = VirtualRobot(
            self._model,
            world=environment,
            task_dir=self._files if file.world is not None else None,
            on_event=on_event,
            **options,
        )
        if file.world is None:
            robot.cell = file.cell
            robot.set_start(file.signals)
        robot.set_start(self._levels)
        levels: dict[str, Any] = {name: choices.values.get(name) for name in self._signal_names}
        robot.set_start({name: level for name, level in levels.items() if level is not None})
        return robot

    def _options_from(self, file: WorldFile) -> dict[str, Any]:
        """Return the options of the world file that none of the plan's goes before."""
        if file.world is not None:
            return {}
        return {name: value for name, value in file.options.items() if name not in self._options}

    def _world_file(self, choices: Choices) -> WorldFile:
        tables = self._tables
        for name, place in self._places.items():
            if name in choices.values:
                tables = with_value(tables, place, choices.values[name])
        if not self._has_world and self._fixed_file is not None:
            return self._fixed_file
        if self._has_world:
            tables = with_value(tables, ("world", "seed"), choices.seed)
        modules = self._python.modules(self._device_files)
        if self._fixed_file is None:
            text, path = self.plan.world, self._world_path
            return read_tables(path, text, tables, network=VIRTUAL, modules=modules)
        from elitescript.devices.scenario import build_world

        # The sections about the robot are the same in every run, and read already.
        beside = {section: table for section, table in tables.items() if section in WORLD_SECTIONS}
        file = WorldFile()
        file.options, file.signals, file.cell = (
            self._fixed_file.options,
            self._fixed_file.signals,
            self._fixed_file.cell,
        )
        try:
            file.world = build_world(beside, self._world_path.parent, network=VIRTUAL, modules=modules)
        except UsageError:
            # Read again for the line of the mistake.
            return read_tables(self._world_path, self.plan.world, tables, network=VIRTUAL, modules=modules)
        file.world.settings = file
        return file

    def run(self, choices: Choices) -> Row:
        """Run the program once."""
        return self.play(choices)[0]

    def play(
        self,
        choices: Choices,
        *,
        before: Callable[[VirtualRobot], None] | None = None,
        trace: Trace | None = None,
        watch: Callable[[VirtualRobot], None] | None = None,
        on_event: Callable[[Event], None] | None = None,
    ) -> tuple[Row, Run | None]:
        """Run the program once, and look on: for a story, or for a page.

        Args:
            choices: of the run.
            before: called with the robot before its program begins.
            trace: receives rows of the arm.
            watch: called with the robot after each tick that is run.
            on_event: receives every event at the moment it happens.

        Returns:
            The row, and the record; None if the run could not begin.
        """
        run = None
        watching = self._checks.watch()
        try:
            robot = self.robot(choices, on_event)
            self.chaos.begin(robot, choices)
            if before is not None:
                before(robot)
            traces = [one for one in (watching.trace, trace) if one]
            seen = False if not traces else traces[0] if len(traces) == 1 else _Both(*traces)
            run = robot.run(**self.arguments(choices), trace=seen, watch=watch)
        except ElitescriptError as error:
            # The world cannot be made with these values, or one of its devices failed.
            return Row(choices, ERROR, None, failure=Failure(ERROR, ERROR, text=str(error))), run
        results = watching.results(run)
        failed = results.first_failed
        failure = None
        if failed is not None:
            failure = self.chaos.failure(self._checks.properties[failed].text, results.verdicts[failed], run)
        margins = tuple(verdict.margin for verdict in results.verdicts)
        digest = digest_of(run)
        return Row(choices, run.state, run.time_s, results.measures, digest, failure, margins, run.is_spoilt), run

    def ends_s(self, row: Row) -> float | None:
        """Return when a run ends that was taken to be stuck, if it has `LONGER` times as long, s; None if it does not.

        Args:
            row: of the run that was cut off.
        """
        is_cut_off = row.failure is not None and row.failure.expression == NEVER_STUCK and row.state == "time_limit"
        if not is_cut_off or row.time_s is None:
            return None
        try:
            robot = self.robot(row.choices)
            self.chaos.begin(robot, row.choices)
            run = robot.run(**self._program(row.choices), until_s=LONGER * row.time_s)
        except ElitescriptError:
            return None  # a device has failed by then: it is not the program that ends
        return None if run.state == "time_limit" else run.time_s

    def arguments(self, choices: Choices) -> dict[str, Any]:
        """Return the arguments of `VirtualRobot.run`: the program, its presets and the limit of time."""
        return {**self._program(choices), "until_s": self.chaos.until_s(choices.disturbances)}

    def _program(self, choices: Choices) -> dict[str, Any]:
        presets = {preset: choices.values[name] for name, preset in self._preset_names.items()}
        return {"program": self._unit, "presets": {**self._presets, **presets}}

    def _play_plain(
        self, choices: Choices, until_s: float | None, before: Callable[[VirtualRobot], None]
    ) -> tuple[VirtualRobot, Run]:
        """Run the program without properties, for `ChaosSession`."""
        robot = self.robot(choices)
        before(robot)
        return robot, robot.run(**self._program(choices), until_s=until_s)


class _Both(Trace):
    """Shows a run to two traces."""

    __slots__ = ("_first", "_second")

    def __init__(self, first: Trace, second: Trace) -> None:
        self._first = first
        self._second = second

    def record(self, controller: Controller, until_tick: int) -> None:
        """Let both record."""
        self._first.record(controller, until_tick)
        self._second.record(controller, until_tick)

    def finish(self, controller: Controller) -> None:
        """Let both finish."""
        self._first.finish(controller)
        self._second.finish(controller)


def _named(chaos: ChaosSession, name: str, *values: Any) -> BuiltInProperty:
    return chaos.property(f"{name}({', '.join(map(repr, values))})" if values else name)


def _model_of(plan: Plan) -> RobotModel:
    name = plan.options.get("model", "CS66")
    text = plan.options.get("model_text", "")
    return parse_model(name, text) if text else load_model(name)


# ---------------------------------------------------------------- digests

_DIGITS: Final = 9
"""Decimals of lengths and angles that count, m and rad: the last bit of a sine is far below."""


def digest_of(run: Run) -> str:
    """Return 16 hexadecimal digits of the end of a run: state, ticks, positions, signals, texts, alarms."""
    signals = sorted((name, _rounded(value)) for name, value in run.signals.items())
    alarms = [(alarm.code, alarm.line, alarm.text) for alarm in run.alarms]
    ends = [_rounded(value) for value in (*run.joints, *run.tcp_pose)]
    content = (run.state, ticks_for(run.time_s), ends, signals, run.log, run.printed, alarms)
    return sha256(repr(content).encode("utf-8", "backslashreplace")).hexdigest()[:16]


def _rounded(value: Any) -> Any:
    # No -0.0: it is the same place.
    return round(value, _DIGITS) + 0.0 if type(value) is float else value


# ---------------------------------------------------------------- in a child process


def job(description: Any) -> _Job:
    """Return what a child process does: rows as JSON has them, for numbers of runs or for choices.

    Args:
        description: a plan as JSON has it.
    """
    return _Job(Runner(plan_of(description)))


class _Job:
    """Runs what it is given; a mistake in the product itself costs one run too.

    Args:
        runner: of the plan.
    """

    __slots__ = ("_runner",)

    def __init__(self, runner: Runner) -> None:
        self._runner = runner

    def __call__(self, order: Any) -> list[Any]:
        """Return the row of a number, or of choices, as JSON has it."""
        choices = self._runner.choices_of(order) if isinstance(order, int) else choices_of(order)
        try:
            row = self._runner.run(choices)
        except MemoryError:
            raise
        except Exception as error:
            traceback.print_exc()
            text = f"elitescript has failed: {type(error).__name__}: {error}"
            row = Row(choices, CRASHED, None, failure=Failure(CRASHED, CRASHED, text=text))
        return row_data(row)

    def about(self, number: int) -> dict[str, Any]:
        """Return the choices of a run, as JSON has them."""
        return choices_data(self._runner.choices_of(number))
