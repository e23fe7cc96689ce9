"""`elitescript audit`: holds a recording of a controller against the simulated robot."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any, Final

from elitescript.audit import Tolerance
from elitescript.audit.auditing import ALL, Audit
from elitescript.audit.auditing import audit as audited
from elitescript.audit.fit.arm_file import arm_text
from elitescript.cli.output.screen import palette_of, rendered
from elitescript.cli.robot_options import options_from
from elitescript.environment.program_file import refused_source, source_of
from elitescript.errors import ProgramError, UsageError, did_you_mean
from elitescript.language.text.source import SourceFile
from elitescript.models.datafile import parsed, read_text
from elitescript.models.model import is_model_file
from elitescript.page import NOT_BUILT, is_built
from elitescript.shown import shown
from elitescript.untrusted.files import ARM, text_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

AGREES: Final = 0
DIFFERS: Final = 1
USAGE: Final = 2

_TOLERANCES: Final = {"joints": "joints", "time": "time_s", "share": "share"}
"""Names on the command line of the fields of `Tolerance`."""


def audit(options: argparse.Namespace) -> int:
    """Audit the recording of the command line; return the exit code."""
    path = Path(options.file)
    if options.fit is not None and not is_model_file(options.fit):
        raise UsageError(f"--fit {options.fit}: the name of an arm file ends in .toml")
    if options.page is not None and not is_built():
        raise UsageError(f"--page: {NOT_BUILT}")
    tolerance = parse_tolerance(options.tolerance)
    given = options_from(options)
    try:
        found = audited(
            path,
            given_program(options.program, is_generated=options.generated),
            robot=given.pop("model", None),
            world=options.world,
            run=_run(options.run),
            tolerance=tolerance,
            fit=options.fit is not None,
            **given,
        )
    except ProgramError as error:
        print_problems("audit", options.program, error)
        return USAGE
    if options.fit is not None:
        options.outputs["fit"].finish(_arm_text(found, getattr(options, "model", None)))
    if options.page is not None:
        from elitescript.audit.page import audit_page

        options.outputs["page"].finish(audit_page(found, path.name).text)
    if options.json:
        print(json.dumps(found.json(), ensure_ascii=False, allow_nan=False))
    else:
        print(found)
    return AGREES if found.agrees and (found.is_complete or options.partial) else DIFFERS


def parse_tolerance(texts: list[str]) -> Tolerance:
    """Return the tolerance of the command line.

    Args:
        texts: a number, rad, or `joints=RAD`, `time=SECONDS`, `share=FRACTION`, several with commas between them.

    Raises:
        UsageError: another name, or no number of at least 0.
    """
    values: dict[str, float] = {}
    for part in (part for text in texts for part in text.split(",")):
        name, equals, text = part.strip().rpartition("=")
        name = name.strip() if equals else "joints"
        if name not in _TOLERANCES:
            known = ", ".join(_TOLERANCES)
            raise UsageError(f"--tolerance: {name!r} is not known; there are {known}{did_you_mean(name, _TOLERANCES)}")
        try:
            value = float(text)
        except ValueError:
            value = -1.0
        if not 0.0 <= value < float("inf"):
            raise UsageError(f"--tolerance {part.strip()}: write a number of at least 0")
        values[_TOLERANCES[name]] = value
    return Tolerance(**values)


def _run(text: str) -> int | str:
    if text == ALL:
        return ALL
    if not text.isdecimal():
        raise UsageError(f"--run: write the number of a run, or {ALL}, not {text!r}")
    return int(text)


def given_program(path: str | None, *, is_generated: bool = False) -> SourceFile | None:
    """Return the program of `--program`; None if there is none.

    Raises:
        UsageError: no such file.
    """
    if path is None:
        if is_generated:
            raise UsageError("--generated goes with --program FILE.task")
        return None
    return source_of(path, is_generated=is_generated)


def print_problems(command: str, path: str | None, error: ProgramError) -> None:
    """Print what is wrong in a program: the file of a path, or one that came from elsewhere."""
    if path is None:
        print(f"elitescript {command}: the program that was found: {shown(str(error))}", file=sys.stderr)
        return
    source = refused_source(Path(path))
    for problem in error.problems:
        print(rendered(problem, source, palette_of(sys.stderr)), file=sys.stderr)


def _arm_text(found: Audit, robot: str | None) -> str:
    """Return an arm file with what the fit has found; it goes on from the arm file that was given, or recorded."""
    assert found.fit is not None
    base: dict[str, Any] = {"base": found.model.name}
    if robot is not None and is_model_file(robot):
        base = parsed(robot, read_text(Path(robot)))
    elif (name := found.arm_file) and robot is None:
        base = parsed(name, text_of(found.recording.attachments[name], name, ARM.noun))
    return arm_text(
        base,
        found.fit.parameters,
        [joint.qd_max for joint in found.model.joints],
        about="fitted to a recording of its controller",
    )
