"""What no test has met, from the programs of a report and the facts that tests have recorded."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.controller.safety.states import MODES
from elitescript.coverage.analysis import AnalysedProgram
from elitescript.coverage.model import ProgramCoverage
from elitescript.coverage.probe import ALARM, FAULT, PLACE, REFUSAL, SAFETY, TASK
from elitescript.coverage.unmet import Refusal, Unmet, UnmetFault, UnmetHandler
from elitescript.devices.channels.faults import TABLE
from elitescript.language.options import SECONDARY
from elitescript.messages.enums import SafetyMode, TaskState

TASK_STATES: Final = (TaskState.PLAYING, TaskState.PAUSED, TaskState.STOPPED)

IN_SECONDARY: Final = "called in a secondary program"
"""Begin of the catalogue's text about a refusal that only secondary programs meet."""


def unmet_of(
    analysed: Iterable[tuple[str, AnalysedProgram]],
    programs: Iterable[ProgramCoverage],
    facts: Collection[tuple[str, ...]],
) -> Unmet:
    """Return what no test has met.

    Args:
        analysed: path and text of each program.
        programs: what was run of them.
        facts: that processes have recorded.
    """
    details: dict[str, set[tuple[str, ...]]] = {}
    for kind, *words in facts:
        details.setdefault(kind, set()).add(tuple(words))
    refusals = details.get(REFUSAL, set())
    safety = {name for (name,) in details.get(SAFETY, ())} | {SafetyMode.NORMAL.name}
    tasks = {name for (name,) in details.get(TASK, ())}
    codes = {code for (code,) in details.get(ALARM, ())} | {code for _, _, code in refusals}
    return Unmet(
        tuple(_refusals(analysed, {(command, error) for command, error, _ in refusals})),
        tuple(
            UnmetHandler(program.path, row.line, row.text)
            for program in programs
            for row in program.handlers
            if not row.hits
        ),
        tuple(mode.name for mode in MODES if mode.name not in safety),
        tuple(state.name for state in TASK_STATES if state.name not in tasks),
        tuple(_faults(sorted(details.get(PLACE, ())), details.get(FAULT, set()))),
        tuple(sorted(codes)),
    )


def _refusals(analysed: Iterable[tuple[str, AnalysedProgram]], met: set[tuple[str, str]]) -> Iterable[Refusal]:
    for path, program in analysed:
        for name, line in sorted(program.calls.items(), key=lambda call: (call[1], call[0])):
            command = CATALOGUE.get(name)
            if command is None:
                continue
            for error, text in command.details.raises.items():
                is_elsewhere = text.startswith(IN_SECONDARY) and program.kind != SECONDARY
                if (name, error) not in met and not is_elsewhere:
                    yield Refusal(path, line, name, error, text.rstrip("."))


def _faults(places: Sequence[tuple[str, ...]], met: set[tuple[str, ...]]) -> Iterable[UnmetFault]:
    for place, kind, device in places:
        names = tuple(name for name, row in TABLE.items() if row.effect(kind).is_possible and (place, name) not in met)
        if names:
            yield UnmetFault(f"{device} ({place})" if device else place, names)
