"""Looks at what `check` and a run tell of a planted mistake, and whether they blame the right line."""

from __future__ import annotations

import ast
import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from elitescript import Run, VirtualRobot
from elitescript.errors import ProgramError
from elitescript.language.hooks import HITS
from elitescript.language.options import Options
from elitescript.language.parser import parse
from elitescript.language.probes import HITS_PROBES
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.findings import Finding
from elitescript.messages.profile import DEFAULT_FIRMWARE, profile
from elitescript.records import replace
from tests.mistakes.planting import Mistake

FIRMWARE: Final = DEFAULT_FIRMWARE
FURTHER_S: Final = 20.0
"""Robot time that a program with a mistake gets beyond what the sound one needs."""
TICKS_MAX: Final = 20_000
"""Ticks that are run, however little time they take."""

AT, ARRIVES, ELSEWHERE = "at", "arrives", "elsewhere"
"""Where a report stands: at the mistake, where its value goes to, or at neither."""

_LINE = re.compile(r"\blines? (\d+)")
_WORD = re.compile(r"[A-Za-z_]\w*")


@dataclass(frozen=True, slots=True)
class Setting:
    """What a program runs with.

    Attributes:
        world: its world file.
        signals: levels at the start.
        presets: globals that have a value before it begins.
        files: contents of its task folder, by name.
    """

    world: Path | None = None
    signals: tuple[tuple[str, object], ...] = ()
    presets: tuple[tuple[str, object], ...] = ()
    files: tuple[tuple[str, bytes], ...] = ()

    def robot(self, probe: object = None) -> VirtualRobot:
        """Return a new robot in its world."""
        model = None if self.world else "CS66"
        files = dict(self.files)
        # What has no world must not look for one on this computer.
        network = None if self.world else "none"
        robot = VirtualRobot(
            model,
            world=self.world,
            task_dir=files,
            probe=probe,
            firmware=FIRMWARE,
            network=network,  # type: ignore[arg-type]
        )
        for name, value in self.signals:
            robot.signals[name] = value  # type: ignore[assignment]
        return robot


@dataclass(frozen=True, slots=True)
class Told:
    """What was told of a mistake.

    Attributes:
        by_check, by_run: the best place of what each has told; empty if nothing.
        finding: what was told first at that place, as text.
        others: further reports that stand elsewhere.
        state: how the run ended; empty if there was none.
        is_same: the run did what that of the sound program did.
    """

    by_check: str
    by_run: str
    finding: str
    others: tuple[str, ...]
    state: str
    is_same: bool

    @property
    def is_told(self) -> bool:
        """Whether it is told, at the right line."""
        return self.by_check in (AT, ARRIVES) or self.by_run in (AT, ARRIVES)

    @property
    def is_wrong(self) -> bool:
        """Whether all that is told blames another line."""
        return not self.is_told and ELSEWHERE in (self.by_check, self.by_run)


class Lines:
    """Counts which lines of a program are run; a probe."""

    def __init__(self) -> None:
        self.cells = [0] * 20_000
        self.table: tuple[tuple[int, int], ...] = ()

    def options(self, options: Options, source: SourceFile) -> Options:
        """Return the options that count statements."""
        return replace(options, probes=HITS_PROBES, first_probe=0)

    def compiled(self, unit: object) -> None:
        """Keep which counter is which line."""
        statements = unit.probes.statements  # type: ignore[attr-defined]
        self.table = tuple((row.number, row.line) for row in statements)

    def hooks(self) -> dict[str, object]:
        """Return the counters."""
        return {HITS: self.cells}

    @property
    def run(self) -> frozenset[int]:
        """Lines of statements that were run."""
        return frozenset(line for number, line in self.table if self.cells[number])


def run_bounded(setting: Setting, text: str, name: str, until_s: float, probe: object = None) -> Run:
    """Run a program within bounds that do not depend on the computer."""
    robot = setting.robot(probe)
    ticks = 0

    def watch(tick: int) -> None:
        nonlocal ticks
        ticks += 1
        if ticks > TICKS_MAX:
            robot.interrupt("time_limit")

    unit = robot.compile(SourceFile(name, text))
    return robot.run(unit, until_s=until_s, presets=dict(setting.presets), watch=watch)


def outcome(run: Run) -> str:
    """Return all that can be seen of a run: what it said, moved, set and sent, and its values at the end."""
    rows = [f"{type(event).__name__} {_plain(event)}" for event in run.events if type(event).__name__ != "Warned"]
    return "\n".join([*rows, run.state, repr(run.globals), repr(run.joints), f"{run.time_s:.3f}"])


def _plain(event: object) -> str:
    values = [
        f"{getattr(event, name)!r}"
        for name in _fields(event)
        if name not in ("line", "column", "source_line", "thread")
    ]
    return re.sub(r"at 0x[0-9a-f]+", "", " ".join(values))


def _fields(event: object) -> tuple[str, ...]:
    return tuple(type(event).__dataclass_fields__)  # type: ignore[attr-defined]


def judge(mistake: Mistake, setting: Setting, sound: Run) -> Told:
    """Check and run a program with a mistake, and see what is told of it.

    Args:
        mistake: the mistake.
        setting: what the program runs with.
        sound: the run of the sound program.
    """
    source = SourceFile(mistake.program, mistake.text)
    presets = tuple(name for name, _ in setting.presets)
    where = Places(mistake)
    known = Counter((row.code, _numberless(row.text)) for row in sound.findings)
    problems = [
        Finding(row.code, str(row.severity), row.line, row.column, row.text, row.hint, source="check")
        for row in check_source(source, profile(FIRMWARE), presets=presets)
    ]
    of_text = [row for row in problems if not known[row.code, _numberless(row.text)]]
    run = None
    of_run: list[Finding] = []
    try:
        run = run_bounded(setting, mistake.text, mistake.program, sound.time_s + FURTHER_S)
    except ProgramError:
        pass
    else:
        of_run = [row for row in run.findings.of_run if not known[row.code, _numberless(row.text)]]
        if run.state == "time_limit" != sound.state:
            of_run += _hang(run)
    by_check = sorted(((where.of(row), str(row)) for row in of_text), key=lambda row: _ORDER[row[0]])
    by_run = sorted(((where.of(row), str(row)) for row in of_run), key=lambda row: _ORDER[row[0]])
    best = sorted([*by_check[:1], *by_run[:1]], key=lambda row: _ORDER[row[0]])
    return Told(
        by_check[0][0] if by_check else "",
        by_run[0][0] if by_run else "",
        best[0][1] if best else "",
        tuple(text for place, text in [*by_check, *by_run] if place == ELSEWHERE),
        "" if run is None else run.state,
        run is not None and outcome(run) == outcome(sound),
    )


_ORDER: Final = {AT: 0, ARRIVES: 1, ELSEWHERE: 2}


def _numberless(text: str) -> str:
    return re.sub(r"[-+]?\d[\d.]*(?:e[-+]?\d+)?", "#", text)


def _hang(run: Run) -> list[Finding]:
    """Return why a run does not go on, for each thread that says more than that time goes by."""
    return [
        Finding("", "hang", thread.line, 0, f"{thread.name} is in line {thread.line}, {thread.doing}: {thread.because}")
        for thread in run.threads
        if thread.because or not thread.doing.startswith("waiting for time")
    ]


class Places:
    """Says where a report stands in relation to a mistake.

    At the mistake: in a line of its statement; in a line that has one of its names; in a line elsewhere, if the text of
    the report names its line or one of its names. Where it arrives: in a line of a name to which its value goes through
    assignments, arguments and results.
    """

    def __init__(self, mistake: Mistake) -> None:
        self.mistake = mistake
        self._rows = mistake.text.splitlines()
        self._names = mistake.names
        self._reached = self._names | _reached(mistake.text, self._names)

    def of(self, row: Finding) -> str:
        """Return where a finding stands."""
        said = f"{row.text} {row.hint}"
        lines = {row.line, *(int(number) for number in _LINE.findall(said))}
        if lines & self.mistake.lines or self._names & _words(said):
            return AT
        shown = {word for line in lines if 0 < line <= len(self._rows) for word in _words(self._rows[line - 1])}
        if self._names & shown:
            return AT
        return ARRIVES if self._reached & shown else ELSEWHERE


def _words(text: str) -> set[str]:
    """Return the names in a text; of a comment none."""
    return set(_WORD.findall(text.partition("#")[0])) | set(re.findall(r"\w+\[\d+\]", text))


def _reached(text: str, names: frozenset[str]) -> frozenset[str]:
    """Return the names to which values of others go."""
    tree = parse(SourceFile("", text)).tree
    flows: list[tuple[set[str], set[str]]] = []
    functions = {node.name: node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign | ast.AugAssign | ast.For):
            given = node.iter if isinstance(node, ast.For) else node.value
            target = node.targets[0] if isinstance(node, ast.Assign) else node.target
            flows.append((_loaded(given), _loaded(target)))
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in functions:
            for arg, value in zip(functions[node.func.id].args.args, node.args, strict=False):
                flows.append((_loaded(value), {arg.arg}))
    for function in functions.values():
        for node in ast.walk(function):
            if isinstance(node, ast.Return) and node.value is not None:
                flows.append((_loaded(node.value), {function.name}))
    reached = set(names)
    grows = True
    while grows:
        more = {name for sources, targets in flows if sources & reached for name in targets} - reached
        reached |= more
        grows = bool(more)
    return frozenset(reached - names)


def _loaded(node: ast.AST) -> set[str]:
    return {other.id for other in ast.walk(node) if isinstance(other, ast.Name)}
