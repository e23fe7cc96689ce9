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
from elitescript.records import record
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

    @property
    def agrees(self) -> bool:
        """Whether every run agrees, and the arm has the lengths of the model."""
        return not any(run.comparison.findings for run in self.runs) and not any(its.is_geometry for its in self.arm)

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


def arm_file_of(recording: Recording) -> str:
    """Return the name of the arm file that a recording holds; empty if it holds none."""
    for name, data in recording.attachments.items():
        try:
            if name.endswith(".toml") and "base" in toml_tables(text_of(data, name, ARM.noun), name, ARM.noun):
                return name
        except UsageError:
            continue
    return ""
