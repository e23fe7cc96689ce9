"""Audits a recording: runs its program with the recorded inputs, and says where both part."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Final

from elitescript.audit.configuration import arm_differences, shows_lengths
from elitescript.audit.differences import Comparer
from elitescript.audit.findings import AuditedRun, AuditFindings, arm_file_of
from elitescript.audit.inputs import inputs_of
from elitescript.audit.motion import Tolerance
from elitescript.audit.series import edges_of, marks_of, recorded, recorded_signals, runs_of
from elitescript.audit.settings import MASS, TCP, setter_lines, setting_pairs
from elitescript.audit.simulation import Cell, Simulated, cell_of, simulate
from elitescript.audit.verdict import findings_of
from elitescript.audit.words import audit_as_json, audit_in_words
from elitescript.commands.catalogue import CATALOGUE
from elitescript.errors import UsageError
from elitescript.kernel.options import ROBOT_SECTION
from elitescript.language.text.source import SourceFile
from elitescript.models.model import is_model_file, load_model
from elitescript.protocol.primary.messages import SCRIPT_EXCEPTION
from elitescript.recorder.recording import Recording
from elitescript.records import record, replace
from elitescript.shown import shown_word
from elitescript.untrusted.files import WORLD, text_of
from elitescript.world_file import closed_world, tables_of, world_text

if TYPE_CHECKING:
    from elitescript.findings.found import Findings
    from elitescript.models.model import RobotModel

ALL: Final = "all"
PROGRAMS: Final = (".script", ".txt")
"""Suffixes of programs among the attachments of a recording."""

_CHANNELS: Final = frozenset({"socket", "serial", "modbus", "modbus_rtu", "rpc"})
"""Families of commands that speak to devices; what these say is not in a recording."""
_FORCES: Final = "force"
_EXCEPTION_S: Final = 0.1
"""Time between the end of a program and the message about its cause, at most (*assumed*)."""
_CALL: Final = re.compile(r"\b([A-Za-z_]\w*)\s*\(")


@record
class Audit(AuditFindings):
    """What an audit has found, in words (`str`) and as JSON has it (`json`)."""

    @property
    def findings(self) -> Findings:
        """What differs (`source` is `audit`), and what was found in the simulated program and its run, in one list."""
        return findings_of(self)

    def json(self) -> dict[str, Any]:
        """Return the audit as JSON has it; see docs/how-to/audit.md."""
        return audit_as_json(self)

    def __str__(self) -> str:
        return audit_in_words(self)


def audit(
    recording: Recording | str | Path,
    program: str | Path | SourceFile | None = None,
    *,
    robot: str | None = None,
    world: str | Path | None = None,
    run: int | str = ALL,
    tolerance: Tolerance | None = None,
    presets: Mapping[str, object] | None = None,
    fit: bool = False,
    **options: Any,
) -> Audit:
    """Run the program of a recording with the recorded inputs, and compare.

    Args:
        recording: of `elitescript record`, or the path of its file.
        program: text, path or source of the program that ran; that of the recording if None.
        robot: name of the arm or path of its file; if None the arm file that the recording holds, else the arm of the
            world file, else the recorded model.
        world: path of the world file; that of the recording if None. What devices have answered is not recorded.
        run: number of the run to audit, from 1 on; `all` for each.
        tolerance: what does not count as a difference.
        presets: program globals that have a value before the program begins.
        fit: whether to estimate parameters of the arm too.
        **options: further options of the robot, as of `VirtualRobot`.

    Raises:
        UsageError: no such file, no program, a recording without a run, or without target joints.
        ProgramError: the program does not compile.
    """
    from elitescript.recorder.mcap_file import read_recording

    found = recording if isinstance(recording, Recording) else read_recording(recording)
    if not found.t:
        raise UsageError(f"the recording has no rows{': its file is cut off before the first' * found.is_cut_off}")
    source = _program(found, program)
    kept = _Kept()
    kept_world = kept.world(found) if world is None else None
    named = str(world) if world is not None else None if kept_world is None else kept.taken[-1]
    arm = robot or kept.arm(found, named, kept_world)
    cell = cell_of(source, arm, named, options, presets, kept_world)
    return _audit(found, cell, run, tolerance or Tolerance(), kept, is_fitted=fit)


class _Kept:
    """What the simulated robot is made of that the recording holds.

    Attributes:
        taken: names of its files.
        not_taken: what is not, in words.
    """

    __slots__ = ("not_taken", "taken")

    def __init__(self) -> None:
        self.taken: list[str] = []
        self.not_taken: list[str] = []

    def world(self, recording: Recording) -> str | None:
        """Return the text of the world file that the recording holds; None if it holds none that can be used."""
        name = str(recording.facts.get("world", ""))
        if not name:
            return None
        if name not in recording.attachments:
            self.not_taken.append(f"the world file {name}, which the recorder was given, is not in the recording")
            return None
        try:
            text = text_of(recording.attachments[name], name, WORLD.noun)
            closed_world(name, text=text)
        except UsageError as error:
            self.not_taken.append(f"the world file of the recording is not used: {error}; --world FILE gives it")
            return None
        self.taken.append(name)
        return text

    def arm(self, recording: Recording, world: str | None, kept_world: str | None) -> RobotModel | None:
        """Return the recorded arm: the file that the recording holds, else the model that is named in it.

        Args:
            recording: that is audited.
            world: name or path of the world file; None without one.
            kept_world: text of one that the recording holds.

        Returns:
            None for the arm of the world file.
        """
        of_world = _arm_of_world(world, kept_world)
        file = arm_file_of(recording)
        if file and not is_model_file(of_world):
            with TemporaryDirectory() as folder:
                # An arm is read from a file.
                path = Path(folder) / Path(file).name
                path.write_bytes(recording.attachments[file])
                model = load_model(str(path))
            self.taken.insert(0, file)
            return model
        if file:
            self.not_taken.append(f"the arm file {file} of the recording: the world file names {of_world}")
        if of_world:
            return None
        for fact in ("model", "robot"):
            name = str(recording.facts.get(fact, "")).strip()
            try:
                if name and not is_model_file(name):
                    return load_model(name)
            except UsageError as error:
                self.not_taken.append(f"the arm of the recording is not simulated: {error}; --robot names another")
        return None


def _arm_of_world(world: str | None, text: str | None) -> str:
    """Return the arm that a world file names; empty if it names none."""
    if world is None:
        return ""
    tables = tables_of(Path(world), text if text is not None else world_text(Path(world)))
    section = tables.get(ROBOT_SECTION)
    name = str(section.get("model", "")) if isinstance(section, dict) else ""
    # An arm file of the recorder's disk is the one that the recording holds.
    return "" if text is not None and is_model_file(name) else name


def _audit(
    recording: Recording, cell: Cell, run: int | str, tolerance: Tolerance, kept: _Kept, *, is_fitted: bool
) -> Audit:
    model = cell.robot().model
    ranges = runs_of(recording)
    if not ranges:
        raise UsageError("no program ran while the recording was made, so there is nothing to compare")
    if run != ALL and (not isinstance(run, int) or not 1 <= run <= len(ranges)):
        raise UsageError(f"run: the recording has the runs 1 to {len(ranges)}, got {run!r}")
    chosen = [(number, rows) for number, rows in enumerate(ranges, 1) if run in (ALL, number)]
    runs = tuple(filter(None, (_audited(recording, cell, number, rows, tolerance) for number, rows in chosen)))
    if not runs:
        raise UsageError(
            "the recording has a part of one move or wait of a program that ran already when it began, and no change "
            "of a line or an output, so nothing is compared"
        )
    lost = sum(round((end - begin) * recording.rate_hz) - 1 for begin, end in recording.gaps)
    fit = None
    if is_fitted:
        from elitescript.audit.fit.recordings import fit_recording

        fit = fit_recording(recording, model, cell.source.text)
    return Audit(
        recording,
        cell,
        model,
        runs,
        len(ranges),
        tuple(arm_differences(recording.facts, model)),
        (*_without_marks(chosen, runs), *_not_compared(recording, cell, model)),
        lost,
        fit,
        tuple(kept.taken),
        tuple(kept.not_taken),
    )


def _without_marks(chosen: Iterable[tuple[int, range]], runs: Iterable[AuditedRun]) -> Iterable[str]:
    compared = {run.number for run in runs}
    for number, _ in chosen:
        if number not in compared:
            yield f"run {number}, which ran already when it was first seen: it has no change of a line or an output"


def _audited(recording: Recording, cell: Cell, number: int, rows: range, tolerance: Tolerance) -> AuditedRun | None:
    """Return one run with what was found; None if it has nothing by which it could be aligned."""
    series = recorded(recording, rows)
    signals = recorded_signals(recording)
    driven = cell.driven() & set(signals)
    inputs = inputs_of(recording, rows, series, driven)
    edges = edges_of(signals, driven)
    by_lines = series.has_lines
    marks = marks_of(series, edges, by_lines=by_lines)
    if series.is_headless:
        # Where the recording begins nothing has happened.
        marks = [mark for mark in marks if mark.row]
        if not marks:
            return None
    made = simulate(cell, inputs, series, marks, signals, by_lines=by_lines)
    settings, setters = [*setting_pairs(recording, rows, made.settings)], setter_lines(cell.source.text)
    comparer = Comparer(
        series,
        made.series,
        marks,
        marks_of(made.series, edges, by_lines=by_lines),
        arrivals=inputs.arrivals,
        tolerance=tolerance,
        ending=_ending(made),
        recorded_ending=_exception(recording, recording.t[rows.stop - 1]),
        settings=settings,
        setters=setters,
    )
    comparison = comparer.compare(signals)
    compared = {pair.kind.command for pair in settings}
    missing = [
        f"{kind.name} ({kind.command}): the recording does not show it all the time"
        for kind in (MASS, TCP)
        if setters[kind.command] and kind.command not in compared
    ]
    notes = [*comparison.notes, *missing, *inputs.unknown, *made.refused]
    if not by_lines:
        notes.insert(0, "the recording shows no change of lines: pieces are cut at standstills and edges of outputs")
    return AuditedRun(
        number,
        recording.t[rows.start],
        recording.t[rows.stop - 1],
        replace(comparison, notes=tuple(notes)),
        inputs,
        series,
        tuple(marks),
        by_lines,
        made,
    )


def _ending(made: Simulated) -> str:
    """Return how the simulated run ended, if its program did not come to its end."""
    run = made.run
    if run.alarms:
        alarm = run.alarms[-1]
        verb = "waits for ever" if run.state == "stuck" else "ends with an alarm"
        return f"{verb} in line {alarm.line}: {alarm.text}"
    if run.state != "time_limit":
        return ""
    lines = [line for line in made.series.lines[-2:] if line]
    return f"is still in line {lines[-1]} at {made.series.t[-1]:.3f} s" if lines else "goes on"


def _exception(recording: Recording, end_s: float) -> str:
    """Return the exception that a controller has told of when a program ended, with its line; empty if it has not."""
    for message in recording.messages:
        data = message.data
        if message.channel == "primary" and data.get("type") == SCRIPT_EXCEPTION.name:
            t = data["timestamp"] * 1e-6 if "timestamp" in data else message.t
            if abs(t - end_s) < _EXCEPTION_S:
                return f"line {data.get('line', 0)}: {data.get('text', '')}"
    return ""


def _program(recording: Recording, program: str | Path | SourceFile | None) -> str | Path | SourceFile:
    """Return the program: the given one, else the one in the recording."""
    if program is not None:
        return program
    names = [name for name in recording.attachments if Path(name).suffix.lower() in PROGRAMS]
    if not names:
        raise UsageError("the recording holds no program; name the one that ran (--program FILE)")
    if len(names) > 1:
        raise UsageError(
            f"the recording holds {shown_word(', '.join(names))}; name the program that ran (--program FILE)"
        )
    # Bytes of a file are text of UTF-8, as those that are read from the disk.
    return SourceFile(f"<{names[0]}>", recording.attachments[names[0]].decode("utf-8", "replace"))


def _not_compared(recording: Recording, cell: Cell, model: RobotModel) -> Iterable[str]:
    families = {
        command.family for name in _CALL.findall(cell.source.text) if (command := CATALOGUE.get(name)) is not None
    }
    if found := sorted(families & _CHANNELS):
        if cell.world is None:
            yield f"devices ({', '.join(found)}): what they answered is not in a recording; --world gives them"
        else:
            yield f"devices ({', '.join(found)}): those of the world file answered, not the recorded ones"
    named = str(recording.facts.get("model", "")).strip()
    if named and named != model.name and not model.name.startswith(named) and not shows_lengths(recording.facts):
        # A fitted arm has another name, and the lengths of the recorded one.
        yield f"lengths of the arm: the recording shows none of its {named}, the simulated one is {model.name}"
    known = (arm_file_of(recording), cell.world if cell.world_text is not None else "", recording.facts.get("world"))
    for name in recording.attachments:
        if name.endswith(".toml") and name not in known and cell.world is None:
            yield f"{name}, which the recording holds: as a world it is given with --world"
    if _FORCES in families:
        yield "forces at the TCP: the simulated arm has only those of the world file"
    for rows in (gap for gap in recording.gaps if gap[1] - gap[0] > 1.0):
        yield f"{rows[0]:.3f} to {rows[1]:.3f} s of the controller: no rows"
