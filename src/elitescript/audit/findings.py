"""What an audit has found: the data, without the words for it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from elitescript.audit.configuration import ArmDifference
from elitescript.audit.differences import Comparison, Finding
from elitescript.audit.inputs import Inputs
from elitescript.audit.series import Mark, Series
from elitescript.audit.simulation import Cell, Simulated
from elitescript.errors import UsageError
from elitescript.recorder.recording import Recording
from elitescript.records import NamedTuple, record
from elitescript.untrusted.files import ARM, text_of
from elitescript.untrusted.toml_text import toml_tables

if TYPE_CHECKING:
    from elitescript.audit.fit.recordings import RecordingFit
    from elitescript.models.model import RobotModel


@record
class AuditedRun:
    """One run of a program in a recording.

    Attributes:
        number: from 1 on.
        begin_s, end_s: in the time of the controller.
        comparison: what was found.
        inputs: what came from outside.
        recorded: its numbers.
        marks: by which it was aligned.
        by_lines: whether lines are among the marks.
        simulated: the simulated run.
    """

    number: int
    begin_s: float
    end_s: float
    comparison: Comparison
    inputs: Inputs
    recorded: Series
    marks: tuple[Mark, ...]
    by_lines: bool
    simulated: Simulated


class Cut(NamedTuple):
    """Where a recording begins or ends within a run.

    Attributes:
        run: its number.
        t: s since the begin of the run, as far as it is recorded.
        line: of the program; 0 if it is not known.
        controller_s: time of the controller.
    """

    run: int
    t: float
    line: int
    controller_s: float


@record
class AuditFindings:
    """What an audit has found.

    Attributes:
        recording: that was audited.
        cell: program, arm and world of the simulated robot.
        model: its arm.
        runs: that were compared, in order.
        runs_in_all: in the recording.
        arm: numbers of the arm that differ from the model.
        not_compared: what could not be compared, in words, for all runs.
        lost: rows that are missing in the recording.
        fit: what the recording says of the arm; None unless it was asked for.
        taken: names of arm file and world file of the recording that the simulated robot is made of.
        not_taken: what the recording says of arm and world and the simulated robot is not made of, with the reason.
    """

    recording: Recording
    cell: Cell
    model: RobotModel
    runs: tuple[AuditedRun, ...]
    runs_in_all: int
    arm: tuple[ArmDifference, ...]
    not_compared: tuple[str, ...]
    lost: int
    fit: RecordingFit | None = None
    taken: tuple[str, ...] = ()
    not_taken: tuple[str, ...] = ()

    @property
    def agrees(self) -> bool:
        """Whether every run agrees as far as it is recorded, and the arm has the lengths of the model."""
        return not any(run.comparison.findings for run in self.runs) and not any(its.is_geometry for its in self.arm)

    @property
    def begins(self) -> Cut | None:
        """Where the recording begins within a run; None if it shows the begin of each."""
        return next((_cut(run, 0) for run in self.runs if run.recorded.is_headless), None)

    @property
    def ends(self) -> Cut | None:
        """Where the recording ends within a run, or its file was cut off; None if it shows the end of each."""
        last = self.runs[-1:] if self.recording.is_cut_off else ()
        return next((_cut(run, -1) for run in (*filter(_is_open, self.runs), *last)), None)

    @property
    def is_complete(self) -> bool:
        """Whether each run was compared from its begin to its end, and no further one can be missing."""
        return self.begins is None and self.ends is None

    @property
    def first(self) -> AuditedRun:
        """The first run that differs; the first of all if none does."""
        return next((run for run in self.runs if run.comparison.findings), self.runs[0])

    @property
    def arm_file(self) -> str:
        """Name of the arm file that the recording holds; empty if it holds none."""
        return arm_file_of(self.recording)

    @property
    def divergence(self) -> Finding | None:
        """The first difference of target joints, durations or signals; None if there is none."""
        return self.first.comparison.divergence


def _is_open(run: AuditedRun) -> bool:
    return run.recorded.is_open


def _cut(run: AuditedRun, row: int) -> Cut:
    series = run.recorded
    return Cut(run.number, series.t[row], series.lines[row], run.begin_s + series.t[row])


def arm_file_of(recording: Recording) -> str:
    """Return the name of the arm file that a recording holds; empty if it holds none."""
    for name, data in recording.attachments.items():
        try:
            if name.endswith(".toml") and "base" in toml_tables(text_of(data, name, ARM.noun), name, ARM.noun):
                return name
        except UsageError:
            continue
    return ""
