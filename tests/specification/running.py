"""Runs the cases of specification pages; see `tests.specification.pages`."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from typing import Any, Final

from elitescript.controller.force.contact import ContactConfig
from elitescript.environment.memory import MemoryEnvironment
from elitescript.errors import ProgramError
from elitescript.language.compiler import compile_unit
from elitescript.language.options import SECONDARY, Options
from elitescript.language.text.source import SourceFile
from elitescript.language.text.units import DiscardedText, Unit, UnitSplitter
from elitescript.lint.engine import check_source
from elitescript.messages.profile import DEFAULT_FIRMWARE, profile
from elitescript.messages.timing import PERIOD_S
from elitescript.robot import VirtualRobot
from elitescript.run import Run
from tests.specification.events import note_event
from tests.specification.pages import Case, CaseOutcome, Expectation, ProgramBlock, differences
from tests.specification.servers import PageServer, network, written

FILE_LIMIT_S: Final = 100_000.0
"""Virtual time after which a program of a page is cut; a simulated day passes in milliseconds."""
STREAM_S: Final = 3.0
"""Virtual time of a conversation on the script port."""


def run_case(case: Case, expectation: Expectation) -> list[str]:
    """Run a case under the conditions of one expectation; return the differences."""
    if case.is_served:
        from tests.specification.sessions import run_session

        return differences(run_session(case, expectation), expectation)
    robot = _Observed(case, expectation)
    if case.is_stream:
        robot.converse(case.texts)
    else:
        robot.run(case.texts[0])
    return differences(robot.outcome, expectation)


class _Observed:
    """A robot and the outcome of its case."""

    def __init__(self, case: Case, expectation: Expectation) -> None:
        words = expectation.words
        self._is_strict = "strict" in words
        self._firmware = words.get("firmware", DEFAULT_FIRMWARE)
        self._until_s = float(words.get("until", STREAM_S if case.is_stream else FILE_LIMIT_S))
        self.outcome = CaseOutcome()
        self._servers = [PageServer(line, text) for _, line, text in case.servers]
        self._robot = VirtualRobot(
            "CS66",
            world=MemoryEnvironment(channels=network(self._servers, (end for end, _, _ in case.servers))),
            firmware=self._firmware,
            strict=self._is_strict,
            contact=ContactConfig.from_table(tomllib.loads(case.world).get("contact", {})),
            on_event=lambda event: note_event(self.outcome, event),
        )
        for time_s, name, value in case.inputs:
            self._robot.at(time_s, name, value)

    def run(self, text: ProgramBlock) -> None:
        """Run a text as the command line runs a file."""
        source = SourceFile("<page>", text.sent)
        problems = self._check(source)
        if self._is_strict:
            self._refuse([problem for problem in problems if problem.is_error])
            if self.outcome.lists["error"]:
                return
        try:
            run = self._robot.run(text.sent, until_s=self._until_s)
        except ProgramError as error:
            self._refuse(error.problems)
            return
        self._finish(run)

    def converse(self, texts: Iterable[ProgramBlock]) -> None:
        """Send texts to the script port, and run their units as the port does."""
        splitter = UnitSplitter()
        self._check(SourceFile("<page>", "".join(text.sent for text in texts)))
        for text in texts:
            self._advance_to(float(text.words.get("at", 0.0)))
            found = splitter.receive(text.sent.encode())
            if "close" in text.words:
                found += splitter.close()
            for part in found:
                self._take(part)
        self._advance_to(self._until_s)
        run = self._robot.current
        if run is None:
            self._look()
        else:
            self._finish(run)

    def _take(self, part: Unit | DiscardedText) -> None:
        if isinstance(part, DiscardedText):
            self._refuse(part.problems)
            return
        try:
            if part.kind == SECONDARY:
                self._robot.submit_secondary(part.text)
                return
            options = Options(strict=self._is_strict, kind=part.kind)
            unit = compile_unit(SourceFile("<port>", part.text), options)
        except ProgramError as error:
            self._refuse(error.problems)
            return
        run = self._robot.current
        if run is not None and run.state == "":
            self._robot.stop()
            self._robot.advance(PERIOD_S)
        self._robot.start(unit)

    def _advance_to(self, time_s: float) -> None:
        if time_s > self._robot.time_s:
            self._robot.advance(time_s - self._robot.time_s)

    def _check(self, source: SourceFile) -> tuple[Any, ...]:
        problems = check_source(source, profile(self._firmware), strict=self._is_strict)
        for problem in problems:
            word = "finding" if problem.is_error else "warn"
            self.outcome.findings.append(f"{word}: {problem.code} line {problem.line}")
        return problems

    def _refuse(self, problems: Iterable[Any]) -> None:
        errors = self.outcome.lists["error"]
        errors += [f"{problem.code} line {problem.line}" for problem in problems if problem.is_error]

    def _finish(self, run: Run) -> None:
        self.outcome.state = run.state or "running"
        self.outcome.lists["global"] = [f"{name} = {value!r}" for name, value in run.globals.items()]
        self._look()

    def _look(self) -> None:
        if self._servers:
            # The last data that the program sent is still under way.
            self._robot.advance(2 * PERIOD_S)
        self.outcome.lists["sent"] = [written(server.received) for server in self._servers]
        signals = self._robot.controller.non_default_signals()
        self.outcome.signals = [f"{name} = {value!r}" for name, value in signals.items()]
