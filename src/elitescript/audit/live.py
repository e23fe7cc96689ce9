"""Follows a controller live, with its program on a simulated robot beside it, and says where they part."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import PurePosixPath
from typing import Any, Final

from elitescript.audit.configuration import arm_differences
from elitescript.audit.differences import Finding
from elitescript.audit.findings import Cut
from elitescript.audit.inputs import SAFETY
from elitescript.audit.live_inputs import Values
from elitescript.audit.live_run import Expected, LiveRun
from elitescript.audit.series import LINE, SCALING, SLIDER, STATE
from elitescript.client.rtsi_signals import POINTS
from elitescript.errors import UsageError
from elitescript.messages.enums import SafetyMode, TaskState
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model
from elitescript.protocol.primary.messages import SCRIPT_EXCEPTION
from elitescript.recorder.channels import CHANGES, ROWS, TIME, Group
from elitescript.recorder.facts import facts_of
from elitescript.recorder.live import LiveRow
from elitescript.recorder.recording import Message
from elitescript.records import NamedTuple, replace

LOOK_S: Final = 0.1
"""Time of the controller between two comparisons."""
GAP_S: Final = 1.0
"""Without rows for longer the run is joined anew: what came meanwhile is not known (*assumed*)."""
_FACTS_S: Final = 1.0
"""So long the other ports may take to say what arm it is, when the program runs already."""
_SPEED_SAME: Final = 0.005

_ROW: Final = (
    TIME,
    LINE,
    STATE,
    SAFETY[0],
    "target_joint_positions",
    "target_joint_speeds",
    "actual_digital_input_bits",
    "actual_digital_output_bits",
    "standard_analog_input0",
    "standard_analog_input1",
    "tool_analog_input",
    SCALING,
    SLIDER,
)
WANTED: Final = (
    Group(
        CHANGES,
        (TIME, "payload_mass", "payload_cog", "analog_io_types", *(name for name in POINTS if name not in _ROW)),
        only_changes=True,
    ),
    Group(ROWS, _ROW, is_needed=True),
)
"""What a session asks for: no more than is compared."""

DIFFERENCE: Final = "difference"
PERHAPS: Final = "perhaps"
"""A difference that may come from what was not seen: of a program that ran already, or went on without rows."""
NOTE: Final = "note"


class Said(NamedTuple):
    """One thing that is said.

    Attributes:
        kind: `run`, `joined`, `end`, `note`, `difference`, `perhaps`.
        run: number of the run, from 1 on; 0 before the first.
        t: s since the begin of the run; of what belongs to none, time of the controller.
        controller_s: time of the controller.
        line: of the program; 0 if none.
        what: in words.
        cause: of a difference; see `Finding`, and `payload`, `safety`.
        delay_s: of the controller's time, since it happened.
    """

    kind: str
    run: int
    t: float
    controller_s: float
    line: int
    what: str
    cause: str = ""
    delay_s: float = 0.0

    def json(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        found = {
            "type": self.kind,
            "run": self.run,
            "t": round(self.t, 3),
            "controller_s": round(self.controller_s, 3),
            "line": self.line,
            "what": self.what,
        }
        if self.kind in (DIFFERENCE, PERHAPS):
            found |= {"cause": self.cause, "delay_s": round(self.delay_s, 3)}
        return found

    def __str__(self) -> str:
        run = f"run {self.run}  " if self.run else ""
        line = f"line {self.line}: " if self.line else ""
        cause = f"  [{self.cause}]" if self.cause else ""
        perhaps = "perhaps: " if self.kind == PERHAPS else ""
        return f"{run}{self.t:9.3f} s  {perhaps}{line}{self.what}{cause}"


class Shadow:
    """Takes what a controller shows, as it comes, and says where its programs part from the simulated ones.

    Args:
        expected: what the controller should be like.
        say: takes everything that is said.

    Attributes:
        runs: that were followed.
        differences: that were said.
        ends: where the last run was left that was not over; None if it was.
    """

    def __init__(self, expected: Expected, say: Callable[[Said], None]) -> None:
        self._expected = expected
        self._say_it = say
        self.runs = 0
        self.differences = 0
        self.ends: Cut | None = None
        self._facts: dict[str, Any] = {}
        self._run: LiveRun | None = None
        self._t: float | None = None
        """Time of the last row."""
        self._first_t = 0.0
        self._was_running: bool | None = None
        """None before the first row."""
        self._look_t = 0.0
        self._mode = SafetyMode.NORMAL
        self._speed_said: float | None = None
        self._arm_said = False
        self._rejoins = False
        self._late_s = 0.0

    @property
    def rows_kept(self) -> int:
        """Rows of both runs that are kept."""
        return 0 if self._run is None else self._run.rows_kept

    def take(self, item: LiveRow | Message) -> None:
        """Take what came next."""
        if isinstance(item, Message):
            self._hear(item)
            return
        t, values = item.t, item.values
        before, self._t = self._t, item.t
        if before is None:
            self._first_t = t
        elif t <= before and before - t < GAP_S:
            # A row for the second time, or behind a later one.
            self._t = before
            return
        elif t < before:
            self._begin_anew()
        elif t - before > GAP_S and self._run is not None and not self._run.has_ended:
            self._say(NOTE, self._run.t, self._run.line, f"no rows for {t - before:.1f} s: what came then is not known")
            self._run.doubt()
        late_s = 0.0 if before is None else t - before - PERIOD_S
        self._late_s = late_s if late_s > 0.5 * PERIOD_S else 0.0
        self._take_row(t, values)

    def finish(self) -> None:
        """Compare what is left: no more comes."""
        if self._run is not None:
            self._close(self._run)

    # ---------------------------------------------------------------- rows

    def _take_row(self, t: float, values: Values) -> None:
        is_running = values.get(STATE) in (TaskState.PLAYING, TaskState.PAUSED)
        run = self._run
        if run is not None and is_running and run.has_ended:
            self._close(run)
            run = None
        if run is None:
            if is_running and not self._begin(t, values):
                return
        else:
            run.take(t, values)
        self._was_running = is_running
        self._watch(t, values)
        if self._run is not None and t >= self._look_t:
            self._look_t = t + LOOK_S
            self._look(self._run)

    def _begin(self, t: float, values: Values) -> bool:
        """Begin a run; return whether everything that is needed is known."""
        is_joined = self._was_running is not False or self._rejoins
        cell = self._expected.cell
        is_open = cell.model is None and cell.world is None and "model" not in self._facts
        if is_open and is_joined and t - self._first_t < _FACTS_S:
            return False
        if not self._rejoins:
            self.runs += 1
        expected = self._with_arm()
        self._run = LiveRun(expected, t, values, self._facts, is_joined=is_joined, late_s=self._late_s)
        self._look_t = t + LOOK_S
        self._speed_said = None
        if is_joined:
            self._say("joined", 0.0, self._run.line, "the program runs already; compared from the first mark in common")
        else:
            self._say("run", 0.0, 0, f"the program begins{self._named_task()}")
        self._rejoins = False
        self._say_notes(self._run)
        return True

    def _with_arm(self) -> Expected:
        """Return what is expected, with the arm that the controller named if none was given."""
        cell = self._expected.cell
        if cell.model is None and cell.world is None and (name := str(self._facts.get("model", "")).strip()):
            try:
                self._expected = replace(self._expected, cell=replace(cell, model=load_model(name)))
            except UsageError as error:
                self._say(NOTE, 0.0, 0, f"the arm that the controller names is not known: {error}")
        return self._expected

    def _named_task(self) -> str:
        """Return the name of the loaded task, if it is not that of the program."""
        task = PurePosixPath(str(self._facts.get("task", ""))).stem
        own = PurePosixPath(self._expected.cell.source.name.replace("\\", "/")).stem
        return f"; the dashboard names {task}, given was {own}" if task and task != own else ""

    def _look(self, run: LiveRun) -> None:
        run.follow()
        for finding, is_sure in run.compare():
            self._differ(run, finding, is_sure=is_sure)
        self._say_notes(run)
        if run.is_done:
            self._end(run)
        elif run.is_lost:
            self._say(NOTE, run.t, run.line, "nothing in common any more: the program is begun anew beside it")
            self._run, self._rejoins = None, True

    def _close(self, run: LiveRun) -> None:
        for finding, is_sure in run.finish():
            self._differ(run, finding, is_sure=is_sure)
        self._say_notes(run)
        self._end(run)

    def _end(self, run: LiveRun) -> None:
        said, again = run.counts
        if not said:
            what = "no difference" if run.is_together else "nothing could be compared"
        else:
            what = f"{said} difference{'s' if said > 1 else ''}"
            what += f", seen again {again} times" if again else ""
        over = "the program is over" if run.has_ended else "followed until here"
        self.ends = None if run.has_ended else Cut(self.runs, run.t, run.line, run.begin_s + run.t)
        self._say("end", run.t, 0, f"{over}: {what}")
        self._run = None

    def _begin_anew(self) -> None:
        run = self._run
        if run is not None:
            self._say(NOTE, run.t, run.line, "the controller's time began anew")
            self._close(run)
        self._was_running = None
        self._rejoins = False

    # ---------------------------------------------------------------- everything else

    def _hear(self, message: Message) -> None:
        for name, value in facts_of([message]).items():
            self._facts[name] = value
        data = message.data
        if self._run is not None and data.get("type") == SCRIPT_EXCEPTION.name:
            self._run.exception = f"line {data.get('line', 0)}: {data.get('text', '')}"
        if "lengths" in self._facts and not self._arm_said and ("model" in self._facts or self._expected.cell.model):
            self._arm_said = True
            for its in arm_differences(self._facts, self._with_arm().cell.robot().model):
                if its.is_geometry:
                    what = f"{its.name} of the arm is {its.recorded:g} {its.unit}, simulated {its.model:g} {its.unit}"
                    self.differences += 1
                    t = 0.0 if self._t is None else self._t
                    self._say_it(Said(DIFFERENCE, self.runs, t, t, 0, what, "configuration"))

    def _watch(self, t: float, values: Values) -> None:
        """Say what changes the motion from outside: slider and safety."""
        run = self._run
        number = next((values[name] for name in SAFETY if name in values), SafetyMode.NORMAL)
        mode = SafetyMode(int(number)) if number in set(SafetyMode) else SafetyMode.UNDEFINED
        is_new, self._mode = mode is not self._mode, mode
        if run is None or (run.has_ended and not is_new):
            return
        line = int(values.get(LINE, 0))  # type: ignore[arg-type]
        if is_new and mode is SafetyMode.NORMAL:
            self._say(NOTE, run.t, line, "safety mode normal")
        elif is_new:
            name = mode.name.lower().replace("_", " ")
            self._see(run, line, f"safety mode {name}", "safety")
        if SLIDER in values:
            speed, due = float(values[SLIDER]), self._expected.speed  # type: ignore[arg-type]
            if abs(speed - due) <= _SPEED_SAME:
                self._speed_said = None
            elif self._speed_said is None or abs(speed - self._speed_said) > _SPEED_SAME:
                self._speed_said = speed
                self._see(run, line, f"the speed slider is at {speed:.0%}, not {due:.0%}", "slider")

    def _see(self, run: LiveRun, line: int, what: str, cause: str) -> None:
        """Say what the controller itself shows in its newest row."""
        run.counts[0] += 1
        self._differ(run, Finding(run.t, line, what, cause))

    def _differ(self, run: LiveRun, finding: Finding, *, is_sure: bool = True) -> None:
        self.differences += is_sure
        self._say_it(
            Said(
                DIFFERENCE if is_sure else PERHAPS,
                self.runs,
                finding.t,
                run.begin_s + finding.t,
                finding.line,
                finding.what,
                finding.cause,
                max(run.t - finding.t, 0.0),
            )
        )

    def _say_notes(self, run: LiveRun) -> None:
        for note in run.notes:
            self._say(NOTE, run.t, 0, note)
        run.notes.clear()

    def _say(self, kind: str, t: float, line: int, what: str) -> None:
        begin_s = self._run.begin_s if self._run is not None else 0.0
        self._say_it(Said(kind, self.runs, t, begin_s + t, line, what))
