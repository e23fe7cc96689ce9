"""Coverage of robot programs in a session of pytest: collected from all processes, merged, reported."""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from collections.abc import Collection, Generator, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest

import elitescript
from elitescript.coverage.analysis import AnalysedProgram, added, analyse, program_coverage
from elitescript.coverage.cobertura import cobertura
from elitescript.coverage.html_pages import INDEX, html_pages
from elitescript.coverage.json_report import json_report
from elitescript.coverage.lcov import lcov
from elitescript.coverage.model import ProgramCoverage, total
from elitescript.coverage.recording import Record, digest_of, read_record
from elitescript.coverage.terminal import table, unmet_lines
from elitescript.coverage.unmet import Unmet
from elitescript.environment.coverage_file import content_of, records_in
from elitescript.environment.repository import from_root, repository_root
from elitescript.errors import ProgramError, UsageError
from elitescript.language.text.source import SourceFile
from elitescript.observer import COVERAGE_VARIABLE
from elitescript.outputs.call_paths import MADE, Read, Written, check_paths, why_not_written
from elitescript.outputs.writing import why_no_page, write_file
from elitescript.paths import PROGRAM_SUFFIX, is_program_name, is_task_name, real_path
from elitescript.pytest_plugin.file_names import holds_tests
from elitescript.pytest_plugin.unmet_facts import unmet_of
from elitescript.records import replace
from elitescript.runtime.probe import set_default
from elitescript.services.coverage import count_programs
from elitescript.shown import shown, shown_word
from elitescript.untrusted.files import PROGRAM, opened, read_bytes

if TYPE_CHECKING:
    from _pytest.terminal import TerminalReporter

TERM: Final = "term"
TERM_MISSING: Final = "term-missing"
FILES: Final = ("lcov", "xml", "html", "json")
"""Kinds of reports that need a destination."""

_BEGINS: Final = {"lcov": (b"TN:", b"SF:"), "xml": (b"<",), "json": (b"{",)}
"""How reports begin."""
_HEAD_BYTES: Final = 100

_NOT_SEARCHED: Final = ("build", "dist", "node_modules", "venv", "__pycache__")
"""Folders without programs of the user; so are those that begin with a full stop, or hold an environment of Python."""


class Measuring:
    """Measures the coverage of programs; a plugin object of one session, or of one worker of it.

    Raises:
        pytest.UsageError: an option that makes no sense.
    """

    def __init__(self, config: pytest.Config) -> None:
        options = config.option
        self._root = config.rootpath.resolve()
        self._start = config.invocation_params.dir
        self._paths = [self._start / path for path in options.script_cov if path]
        for path in self._paths:
            if not path.exists():
                raise pytest.UsageError(f"--script-cov={path}: there is no such file or folder")
            if path.is_file() and not (is_program_name(path.name) or is_task_name(path.name)):
                raise pytest.UsageError(
                    f"--script-cov={path}: this is no program; --script-cov without PATH stands behind the test files"
                )
        self._reports = [_report(text, self._start) for text in options.script_cov_report or [TERM]]
        _check_reports(self._reports, self._paths)
        self._fail_under: float | None = options.script_cov_fail_under
        self._programs: list[ProgramCoverage] = []
        self._unmet = Unmet()
        self._notes: list[str] = []
        self._is_measured = False
        self._is_worker = hasattr(config, "workerinput")
        self._variable = os.environ.get(COVERAGE_VARIABLE)
        self._folder = Path(self._variable if self._is_worker and self._variable else tempfile.mkdtemp())
        os.environ[COVERAGE_VARIABLE] = str(self._folder)
        self._maker = count_programs(str(self._folder))

    def pytest_unconfigure(self) -> None:
        """Count no more, and remove the records."""
        set_default(self._maker)
        if self._is_worker:
            return
        if self._variable is None:
            del os.environ[COVERAGE_VARIABLE]
        else:
            os.environ[COVERAGE_VARIABLE] = self._variable
        shutil.rmtree(self._folder, ignore_errors=True)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtestloop(self, session: pytest.Session) -> Generator[None, object, object]:
        """Write the reports when tests have run, here and in all workers; also if `-x` or Ctrl-C ended them."""
        try:
            return (yield)
        finally:
            if not self._is_worker and not session.config.option.collectonly:
                self._measure()
                for kind, target in self._reports:
                    if target is not None:
                        self._write(kind, target)
                if self._is_too_little:
                    session.testsfailed += 1

    def pytest_terminal_summary(self, terminalreporter: TerminalReporter) -> None:
        """Print the table, and what no test has met."""
        if not self._is_measured:
            return
        kinds = [kind for kind, _ in self._reports]
        write = terminalreporter.write_line
        if TERM in kinds or TERM_MISSING in kinds:
            terminalreporter.section("coverage of robot programs")
            for line in table(self._programs, shows_missing=TERM_MISSING in kinds):
                write(line)
            if not self._programs:
                write("no program with a file was run")
            if lines := unmet_lines(self._unmet):
                write("")
                write("What no test has met")
                for line in lines:
                    write(line)
        for note in self._notes:
            write(f"warning: {shown(note)}", yellow=True)
        for kind, target in self._reports:
            if target is not None:
                write(f"coverage of robot programs written to {kind} {shown_word(str(target))}")
        if self._is_too_little:
            reached = total(self._programs).percent
            write(
                f"FAIL: {reached:.2f}% of lines and branches of robot programs were run; "
                f"--script-cov-fail-under asks for {self._fail_under:g}%",
                red=True,
                bold=True,
            )

    @property
    def _is_too_little(self) -> bool:
        if not self._is_measured or self._fail_under is None:
            return False
        return not self._programs or total(self._programs).percent < self._fail_under

    # ---------------------------------------------------------------- measuring

    def _measure(self) -> None:
        records = list(self._records())
        counts: dict[str, list[tuple[int, ...]]] = {}
        names: dict[str, set[str]] = {}
        for record in records:
            for recorded in record.programs:
                counts.setdefault(recorded.digest, []).append(recorded.counts)
                names.setdefault(recorded.digest, set()).add(recorded.name)
        analysed: list[tuple[str, AnalysedProgram]] = []
        seen: set[str] = set()
        for path in self._files({name for known in names.values() for name in known}):
            try:
                source = _source_at(path)
                digest = digest_of(source.text)
                if not self._paths and digest not in counts:
                    continue
                program = analyse(source)
            except (ProgramError, UsageError):
                self._notes.append(f"{path} does not compile; it is in no report")
                continue
            seen.add(digest)
            shown = self._shown(path)
            analysed.append((shown, program))
            self._programs.append(program_coverage(shown, program, added(counts.get(digest, ()))))
        self._note_changed(names, seen)
        self._unmet = unmet_of(analysed, self._programs, frozenset().union(*(record.facts for record in records)))
        self._is_measured = True

    def _note_changed(self, names: dict[str, set[str]], seen: set[str]) -> None:
        """Note programs that have been written anew since they ran, whose lines are not known any more."""
        shown = {program.path for program in self._programs}
        for digest in names.keys() - seen:
            changed = {self._shown(Path(name).resolve()) for name in names[digest]} & shown
            self._notes += [f"{path} was changed while tests ran" for path in sorted(changed)]

    def _records(self) -> Iterator[Record]:
        for path in records_in(self._folder):
            try:
                record = read_record(content_of(path))
            except (OSError, ValueError) as error:
                self._notes.append(f"the record of a process cannot be read: {error}")
                continue
            if not record.is_complete:
                self._notes.append("a process has run more programs than its record holds; the coverage is incomplete")
            yield record

    def _files(self, names: Iterable[str]) -> list[Path]:
        """Return the files that reports may show, sorted by the path that they show.

        Args:
            names: of the programs that ran.
        """
        found: dict[Path, None] = {}
        for path in self._paths or [self._root]:
            if path.is_file():
                found[path.resolve()] = None
            else:
                found.update(dict.fromkeys(_programs_below(path)))
        if not self._paths:
            for name in names:
                path = Path(name).resolve()
                if path.is_file() and self._root in path.parents and not holds_tests(path.name):
                    found[path] = None
        return sorted(found, key=self._shown)

    def _shown(self, path: Path) -> str:
        """Return a path as reports show it."""
        try:
            return Path(os.path.relpath(path, self._root)).as_posix()
        except ValueError:  # on another drive
            return path.as_posix()

    # ---------------------------------------------------------------- reports

    def _from(self, root: Path) -> list[ProgramCoverage]:
        """Return the coverage under paths from the root of the repository, as services find files."""
        return [
            replace(program, path=from_root(self._root / program.path, root).as_posix()) for program in self._programs
        ]

    def _write(self, kind: str, target: Path) -> None:
        if kind == "html":
            target.mkdir(parents=True, exist_ok=True)
            for name, text in html_pages(self._programs, self._unmet).items():
                write_file(target / name, text)
            return
        if kind == "lcov":
            text = lcov(row.in_file() for row in self._from(repository_root()))
        elif kind == "xml":
            root = repository_root()
            version, time_ms = elitescript.__version__, int(time.time() * 1000)
            text = cobertura(
                [row.in_file() for row in self._from(root)], root=str(root), version=version, time_ms=time_ms
            )
        else:
            text = json_report(self._programs, self._unmet)
        target.parent.mkdir(parents=True, exist_ok=True)
        write_file(target, text)


def _report(text: str, folder: Path) -> tuple[str, Path | None]:
    """Return kind and destination of a report."""
    kind, colon, target = text.partition(":")
    if kind in (TERM, TERM_MISSING) and not colon:
        return kind, None
    if kind not in FILES:
        known = ", ".join((TERM, TERM_MISSING, *(f"{name}:PATH" for name in FILES)))
        raise pytest.UsageError(f"--script-cov-report={text}: there are {known}")
    if not target:
        raise pytest.UsageError(f"--script-cov-report={text}: write {kind}:PATH")
    return kind, folder / target


def _check_reports(reports: Iterable[tuple[str, Path | None]], programs: Iterable[Path]) -> None:
    """Refuse reports that cannot be written, or would destroy another file.

    Raises:
        pytest.UsageError: the text names the report.
    """
    read = [Read(path, f"--script-cov={path}", "a program") for path in programs if path.is_file()]
    written: list[Written] = []
    for kind, target in reports:
        if target is None:
            continue
        called = f"--script-cov-report={kind}:{target}"
        file = target / INDEX if kind == "html" else target
        if kind == "html" and target.exists() and not target.is_dir():
            raise pytest.UsageError(f"{called}: pages go into a folder, and this is none")
        # Folders are made.
        if file.parent.exists() and (why := why_not_written(file)):
            raise pytest.UsageError(f"{called}: {why}")
        if why := why_no_page(file) if kind == "html" else _why_no_report(kind, file):
            raise pytest.UsageError(f"{called}: {why}; give it another name")
        written.append(Written(file, called, MADE))
    try:
        check_paths(read, written)
    except UsageError as error:
        raise pytest.UsageError(str(error)) from None


def _why_no_report(kind: str, file: Path) -> str:
    """Return why a file is no report that may be replaced; empty if it is one, is empty, or is not there."""
    if not file.is_file() or not file.stat().st_size:
        return ""
    with opened(file) as there:
        is_report = there.read(_HEAD_BYTES).lstrip().startswith(_BEGINS[kind])
    return "" if is_report else f"it is no report of kind {kind}, and would be lost"


def _is_of_task(name: str, files: Collection[str]) -> bool:
    """Return whether a program is the script that a pendant has written beside a graphical program."""
    task = name[: -len(PROGRAM_SUFFIX)]
    return is_task_name(task) and task in files


def _source_at(path: Path) -> SourceFile:
    if not is_task_name(path.name):
        return SourceFile.from_bytes(str(path), read_bytes(path, PROGRAM))
    # Imported late: few programs are graphical.
    from elitescript.environment.task_files import source_of_task

    return source_of_task(path)


def _programs_below(folder: Path) -> Iterator[Path]:
    for place, folders, files in os.walk(folder.resolve()):
        folders[:] = sorted(
            name
            for name in folders
            if not name.startswith(".") and name not in _NOT_SEARCHED and not Path(place, name, "pyvenv.cfg").exists()
        )
        for name in files:
            is_program = is_program_name(name) and not holds_tests(name) and not _is_of_task(name, files)
            if is_program or is_task_name(name):
                # A link is the program that it leads to.
                yield real_path(Path(place, name))
