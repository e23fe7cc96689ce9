"""The pytest plugin `elitescript`: fixtures, a marker, options, tests in the language itself.

Every pytest run of an environment loads this module, so it imports nothing of the robot before a test needs it.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Collection, Generator, Iterator
from contextlib import suppress
from fnmatch import fnmatch
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import pytest
from _pytest._code.code import ExceptionRepr, TerminalRepr

from elitescript.observer import OBSERVATION
from elitescript.paths import is_program_name, real_path
from elitescript.pytest_plugin.file_names import holds_tests, is_case
from elitescript.pytest_plugin.watching import RunWatcher, WatchedRun

if TYPE_CHECKING:
    from _pytest.terminal import TerminalReporter

    from elitescript.pytest_plugin.limits import Guard, Limits
    from elitescript.pytest_plugin.served import ServedRobot
    from elitescript.robot import VirtualRobot

try:
    _LINKS: Final[pytest.StashKey[dict[Path, Path]]] = pytest.StashKey()
    """The first link of this session to a file that is collected under no other path, by what it leads to."""
    _around = pytest.hookimpl(wrapper=True)
except (AttributeError, TypeError):
    from elitescript.errors import UsageError
    from elitescript.extras import require

    try:
        require("pytest")
    except UsageError as error:
        # Of a plugin that raises while it is loaded, pytest shows a traceback; 4 is its code for a wrong call.
        print(f"elitescript: {error}", file=sys.stderr)
        raise SystemExit(4) from None
    raise

MARKER_TEXT: Final = (
    "elitescript(robot=, firmware=, world=, plant=, safety=, ...): options of the fixtures `robot` and `served_robot`, "
    "by the keywords of VirtualRobot; robot= is the arm, and paths are relative to the test file; limit_s= and "
    "wall_limit_s= are the limits of each run"
)
_RUNS: Final = "elitescript"
_SERVED: Final = "elitescript serve"
"""Titles of sections of reports."""
_INI: Final = {
    "elitescript_limit_s": "robot time after which a run without until_s is ended and fails its test, s; 0 for none "
    "(default: 600)",
    "elitescript_findings": "let a test fail if `check` or a run of it finds an `error`, or also a `warning`; `off` "
    "does not look for any (default: tests that pass with some are named at the end)",
    "elitescript_wall_limit_s": "wall time after which a run is ended and fails its test, s; 0 for none (default: 60)",
}

_FINDINGS: Final = "elitescript_findings"
"""Property of reports of tests that have passed: how many errors and warnings there were."""
FINDINGS_SHOWN: Final = 10
"""Tests that are named at the end."""

_SHOWS_PROGRAMS: Final = "shows_programs"
"""Attribute of reports in which texts of programs stand; their parts are `_SECTIONS`, or all of a plain text."""
_SECTIONS: Final = (_RUNS, _SERVED)

_WATCHER: Final[pytest.StashKey[RunWatcher]] = pytest.StashKey()
_STANDARD_ERROR: Final[pytest.StashKey[int]] = pytest.StashKey()


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("elitescript", "programs of Elite Robots arms")
    group.addoption(
        "--script-cov",
        action="append",
        nargs="?",
        const="",
        default=[],
        metavar="PATH",
        help="measure what tests run of robot programs; PATH is a folder or a file of programs to report, also those "
        "that no test runs (may be repeated; without it those below the root folder that tests run)",
    )
    group.addoption(
        "--script-cov-report",
        action="append",
        default=[],
        metavar="TYPE",
        help="term, term-missing, lcov:FILE, xml:FILE (Cobertura), html:FOLDER or json:FILE (may be repeated; default: "
        "term)",
    )
    group.addoption(
        "--script-cov-fail-under",
        type=_percent,
        metavar="PERCENT",
        help="fail if less of lines and branches of all reported programs was run",
    )
    group.addoption(
        "--script-record",
        metavar="FOLDER",
        help="write a page that shows the run of each failing test into this folder",
    )
    group.addoption(
        "--script-strict",
        action="store_true",
        help="let a test fail if `check` or the run warns about one of its programs",
    )
    group.addoption(
        "--script-watch",
        action="store_true",
        help="run the tests again whenever a program, a Python file or a data file below the root folder has changed; "
        "Ctrl-C ends it",
    )
    for name, text in _INI.items():
        parser.addini(name, text)


def _percent(text: str) -> float:
    """Return a percentage of the command line."""
    try:
        number = float(text)
    except ValueError:
        number = -1.0
    if not 0.0 <= number <= 100.0:
        raise pytest.UsageError(f"--script-cov-fail-under: write a number from 0 to 100, not {text!r}")
    return number


@pytest.hookimpl(tryfirst=True)
def pytest_cmdline_main(config: pytest.Config) -> int | None:
    """Run the tests in rounds, if that is asked for."""
    if not config.option.script_watch:
        return None
    from elitescript.pytest_plugin.rounds import IN_ROUND, watch

    return None if IN_ROUND in os.environ else watch(config)


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", MARKER_TEXT)
    # Here nothing is captured yet.
    with suppress(OSError, ValueError):
        config.stash[_STANDARD_ERROR] = os.dup(sys.__stderr__.fileno() if sys.__stderr__ else 2)
    pages: str | None = config.option.script_record
    if pages is not None and (folder := config.invocation_params.dir / pages).exists() and not folder.is_dir():
        raise pytest.UsageError(f"--script-record={pages}: pages go into a folder, and this is none")
    if _measures(config):
        from elitescript.pytest_plugin.measuring import Measuring

        config.pluginmanager.register(Measuring(config), "elitescript-coverage")


def pytest_unconfigure(config: pytest.Config) -> None:
    descriptor = config.stash.get(_STANDARD_ERROR, None)
    if descriptor is not None:
        del config.stash[_STANDARD_ERROR]
        os.close(descriptor)


def _measures(config: pytest.Config) -> bool:
    """Return whether the coverage of programs is measured; reports and a limit ask for it too."""
    options = config.option
    asked = options.script_cov or options.script_cov_report or options.script_cov_fail_under is not None
    return bool(asked)


# ---------------------------------------------------------------- fixtures


@pytest.fixture
def robot(request: pytest.FixtureRequest) -> VirtualRobot:
    """A fresh robot in virtual time, with the options of the marker `elitescript`."""
    from elitescript.environment.network_option import MARKER
    from elitescript.pytest_plugin.marker import robot_arguments, settings_of
    from elitescript.robot import VirtualRobot

    made = VirtualRobot(**robot_arguments(settings_of(request.node), request.path.parent))
    made.set_network_by(MARKER)
    return made


@pytest.fixture
def served_robot(request: pytest.FixtureRequest) -> Iterator[ServedRobot]:
    """A controller in a process of its own on free ports of this computer, with the options of the marker."""
    from elitescript.pytest_plugin.marker import serve_arguments, settings_of
    from elitescript.pytest_plugin.served import ServedRobot

    settings = settings_of(request.node)
    served = ServedRobot(serve_arguments(settings, request.path.parent), _limits_of(request.node).wall_s)
    try:
        yield served
    finally:
        served.close()
    if request.config.option.script_strict:
        _refuse(served.warnings)


# ---------------------------------------------------------------- runs of a test


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, bool, bool]:
    """Have the runs of a test watched."""
    before = OBSERVATION.observer
    watcher = RunWatcher(keeps_rows=item.config.option.script_record is not None, guard=lambda: _guard_of(item))
    OBSERVATION.observer = item.stash[_WATCHER] = watcher
    try:
        return (yield)
    finally:
        OBSERVATION.observer = before
        watcher.close()
        del item.stash[_WATCHER]


@_around
def pytest_runtest_call(item: pytest.Item) -> Generator[None, None, None]:
    """Let a test fail whose runs were ended by a limit, or whose programs are warned about, if that is asked for."""
    yield
    if exceeded := item.stash[_WATCHER].exceeded:
        # Of another thread, or swallowed.
        from elitescript.shown import shown

        pytest.fail("\n".join(map(shown, exceeded)), pytrace=False)
    if (runs := item.stash[_WATCHER].runs) and item.config.getini("elitescript_findings"):
        from elitescript.pytest_plugin.strictness import findings_of

        if found := findings_of(runs, item.config.getini("elitescript_findings")):
            from elitescript.shown import shown

            pytest.fail("\n".join(["findings, which elitescript_findings refuses:", *map(shown, found)]), pytrace=False)
    if item.config.option.script_strict and (runs := item.stash[_WATCHER].runs):
        from elitescript.pytest_plugin.strictness import warnings_of

        _refuse(warnings_of(runs))


def _guard_of(item: pytest.Item) -> Guard:
    from elitescript.pytest_plugin.limits import Guard

    has_own = item.config.getini("faulthandler_timeout")
    return Guard(_limits_of(item), None if has_own else item.config.stash.get(_STANDARD_ERROR, None))


def _limits_of(item: pytest.Item) -> Limits:
    from elitescript.pytest_plugin.limits import limits_of
    from elitescript.pytest_plugin.marker import settings_of

    # A test script has its settings in a comment.
    return limits_of(item.config, {**getattr(item.parent, "settings", {}), **settings_of(item)})


def _refuse(warnings: list[str]) -> None:
    if warnings:
        from elitescript.shown import shown

        pytest.fail("\n".join(["warnings, which --script-strict refuses:", *map(shown, warnings)]), pytrace=False)


@_around
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Add to the report of a failed test what its robots did."""
    report = yield
    if getattr(item, _SHOWS_PROGRAMS, False):
        setattr(report, _SHOWS_PROGRAMS, True)
    if report.passed and report.when == "call" and (watcher := item.stash.get(_WATCHER, None)) is not None:
        _count_findings(item, report, watcher.runs)
    if report.failed and (watcher := item.stash.get(_WATCHER, None)) is not None and (runs := watcher.runs):
        from elitescript.pytest_plugin.failures import section, write_pages

        folder: str | None = item.config.option.script_record
        pages = [] if folder is None else write_pages(item.config.invocation_params.dir / folder, item.nodeid, runs)
        _add_section(report, _RUNS, section(runs, pages))
    if report.failed and (served := (getattr(item, "funcargs", None) or {}).get("served_robot")) is not None:
        from elitescript.pytest_plugin.failures import served_section

        _add_section(report, _SERVED, served_section(served.log))
    return report


def _count_findings(item: pytest.Item, report: pytest.TestReport, runs: Collection[WatchedRun]) -> None:
    """Let the report of a test that has passed say how many errors and warnings its programs and runs have."""
    if not runs or item.config.getini(_FINDINGS) == "off":
        return
    from elitescript.pytest_plugin.strictness import findings_as_json, findings_in_words

    if words := findings_in_words(runs):
        report.user_properties.append((_FINDINGS, words))
        # JUnit XML takes properties from the report of the teardown.
        item.user_properties.append((_FINDINGS, words))
        item.user_properties.append((f"{_FINDINGS}_json", findings_as_json(runs)))


def pytest_terminal_summary(terminalreporter: TerminalReporter) -> None:
    """Name tests that have passed with findings; the last line counts them, and is not green."""
    found = [report for report in terminalreporter.stats.get("passed", ()) if _FINDINGS in dict(report.user_properties)]
    if not found:
        return
    terminalreporter.stats["with findings"] = found
    terminalreporter.section("elitescript findings", yellow=True)
    for report in found[:FINDINGS_SHOWN]:
        terminalreporter.write_line(f"{report.nodeid}: {dict(report.user_properties)[_FINDINGS]}")
    if len(found) > FINDINGS_SHOWN:
        terminalreporter.write_line(f"and {len(found) - FINDINGS_SHOWN} more tests")
    advice = "elitescript_findings = warning fails such tests and names the findings; = off does not look for them"
    terminalreporter.write_line(advice)


@pytest.hookimpl(trylast=True)
def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Let nothing act in what the terminal shows of programs. JUnit XML has been made by now, of texts as they are."""
    if not getattr(report, _SHOWS_PROGRAMS, False):
        return
    from elitescript.shown import printed

    def changed(sections: list[Any]) -> list[Any]:
        return [
            (name, printed(text), *rest) if name in _SECTIONS else (name, text, *rest) for name, text, *rest in sections
        ]

    report.sections = changed(report.sections)
    if isinstance(report.longrepr, str):
        report.longrepr = printed(report.longrepr)
    elif isinstance(report.longrepr, ExceptionRepr):
        report.longrepr.sections = changed(report.longrepr.sections)


@_around
def pytest_report_to_serializable() -> Generator[None, Any, Any]:
    """Let reports have texts that can be sent: at half a surrogate pair a worker of xdist ends, and loses its tests."""
    return _encodable((yield))


def _encodable(data: Any) -> Any:
    if isinstance(data, str):
        from elitescript.shown import encodable

        return data if data.isascii() else encodable(data)
    if isinstance(data, dict):
        return {_encodable(name): _encodable(value) for name, value in data.items()}
    if isinstance(data, list | tuple):
        return type(data)(map(_encodable, data))
    return data


def _add_section(report: pytest.TestReport, name: str, content: str) -> None:
    """Add a section to what a report says of the failure, which is also what JUnit XML carries."""
    setattr(report, _SHOWS_PROGRAMS, True)
    if isinstance(report.longrepr, TerminalRepr) and hasattr(report.longrepr, "addsection"):
        report.longrepr.addsection(name, content)
    elif isinstance(report.longrepr, str):
        report.longrepr += f"\n{f' {name} ':-^80}\n{content}"
    else:
        report.sections.append((name, content))


# ---------------------------------------------------------------- tests in the language


def _is_found(name: str) -> bool:
    """Return whether a file is collected without being named."""
    return is_case(name) or holds_tests(name)


def _is_second(path: Path, session: pytest.Session) -> bool:
    """Return whether a path is a link to a file that is collected under another path, or has been."""
    leads_to = real_path(path)
    for argument in session.config.args:
        # As pytest makes paths: without dots, but with links.
        given = session.config.invocation_params.dir / argument.partition("::")[0]
        given = Path(os.path.normpath(given))
        root = real_path(given)
        if leads_to.is_relative_to(root):
            inner = leads_to.relative_to(root)
            if given / inner == path:
                return False
            ignored = session.config.getini("norecursedirs")
            if _is_found(inner.name) and not any(fnmatch(part, row) for part in inner.parts[:-1] for row in ignored):
                return True
    return session.stash.setdefault(_LINKS, {}).setdefault(leads_to, path) != path


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """Leave out links to a folder that they are in: pytest would follow them round and round."""
    if not collection_path.is_symlink() or not collection_path.is_dir():
        return None
    leads_to, home = real_path(collection_path), real_path(collection_path.parent)
    return True if leads_to == home or leads_to in home.parents else None


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collect the tests of a script, of one that is named like a test or that the command line names, and cases."""
    is_named = parent.session.isinitpath(file_path)
    if not _is_found(file_path.name) and not (is_named and is_program_name(file_path.name)):
        return None
    if not is_named and _is_second(file_path, parent.session):
        return None
    if is_case(file_path.name):
        from elitescript.pytest_plugin.case_files import CaseFile

        return CaseFile.from_parent(parent, path=file_path, **_node_id(file_path, parent))
    from elitescript.pytest_plugin.script_files import ScriptFile

    return ScriptFile.from_parent(parent, path=file_path, **_node_id(file_path, parent))


def _node_id(path: Path, parent: pytest.Collector) -> dict[str, Any]:
    """Return the id of a file that reports can hold, if its name is none; otherwise nothing: pytest makes one."""
    name = str(path)
    if name.isascii() and name.isprintable():
        return {}
    from elitescript.shown import shown_word

    with suppress(ValueError):
        name = path.relative_to(parent.config.rootpath).as_posix()
    return {} if name.isprintable() else {"nodeid": shown_word(name)}
