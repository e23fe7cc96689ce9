"""`elitescript check`: reports every problem of programs without running them, repairs some, explains codes."""

from __future__ import annotations

import sys
from typing import Any, Final

from elitescript.cli.output.check_formats import FORMATS, CheckedFile
from elitescript.cli.output.screen import progress_on
from elitescript.cli.program_texts import STANDARD_INPUT, ProgramText, program_texts, rewrite, write_out
from elitescript.cli.robot_options import options_from
from elitescript.commands.definition.plausibility import ArmFacts
from elitescript.environment.program_file import neighbours
from elitescript.errors import ProgramError, UsageError
from elitescript.kernel.options import RobotOptions, robot_options
from elitescript.language.diagnostics import diagnostic, in_order
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.lint.fixing import Repair, repaired
from elitescript.messages.profile import profile
from elitescript.paths import is_task_name, real_path
from elitescript.records import replace
from elitescript.shown import shown, shown_word

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

FOUND_ERRORS: Final = 3
"""Exit code when a program has an error."""
NOT_FOUND: Final = 2
"""Exit code when a file of the command line cannot be read."""


def check(options: argparse.Namespace) -> int:
    """Check the files of the command line; return the exit code."""
    if options.explain is not None:
        return _explain(options.explain)
    if not options.files:
        raise UsageError("name files or folders, or - for standard input")
    if options.reach:
        # Imported late: it makes a robot.
        from elitescript.cli.reach import reach

        if options.fix or options.format not in (None, "text", "json"):
            raise UsageError("--reach lists what programs reach, as text or JSON; it goes with no other report")
        options.json = options.json or options.format == "json"
        return reach(options)
    if options.serial:
        raise UsageError("--serial goes with --reach: nothing is run")
    if options.json and options.format not in (None, "json"):
        raise UsageError(f"--json and --format {options.format} contradict each other")
    is_filter = options.fix and STANDARD_INPUT in options.files
    if is_filter and len(options.files) > 1:
        raise UsageError("--fix writes the repaired text of - to standard output: check the other files by themselves")
    name = "json" if options.json else options.format or "text"
    # Standard output has only the repaired text of standard input.
    out = sys.stderr if is_filter else sys.stdout
    report = FORMATS[name](out)
    robot, arm, has_solids = _robot(options)
    code = 0
    progress = progress_on(sys.stderr) if name == "text" else None
    known = None
    if options.baseline is not None:
        # Imported late: few calls have one.
        from elitescript.cli.baseline import Baseline

        known = Baseline(options.baseline)
    for number, text in enumerate(program_texts(options.files, "check")):
        if progress is not None:
            progress.note(f"{number} files checked; {text.name}")
        checked = _check(text, robot, arm, is_fixed=options.fix, is_generated=options.generated)
        if has_solids and not any(problem.is_error for problem in checked.problems):
            checked = _with_contacts(checked, text, options)
        if known is not None:
            checked = known.without_known(checked)
        report.file(checked)
        if text.data is None and text.is_named:
            code = NOT_FOUND
            print(f"elitescript check: {shown(text.why_not)}", file=sys.stderr)
        elif code == 0 and any(problem.is_error for problem in checked.problems):
            code = FOUND_ERRORS
    report.end()
    left_out = "" if known is None else f"; {shown(known.end())}"
    print(f"{report.summary}{left_out}", file=sys.stderr)
    return code


def _robot(options: argparse.Namespace) -> tuple[RobotOptions, ArmFacts | None, bool]:
    """Return the robot that programs are for, the facts of its arm, None if no model is named, and whether there are
    solids that it can touch.

    Raises:
        UsageError: no such arm, or an invalid world file.
    """
    given = options_from(options)
    from_file: dict[str, Any] = {}
    has_solids = False
    if options.world is not None:
        from elitescript.world_file import load_world_file

        file = load_world_file(options.world)
        from_file, has_solids = file.options, file.cell is not None
    robot = robot_options(given, from_file)
    if "model" not in given and "model" not in from_file:
        return robot, None, has_solids
    # Loading a model takes longer than checking a program.
    from elitescript.kernel.arm_facts import arm_facts

    return robot, arm_facts(robot), has_solids


def _explain(code: str) -> int:
    from elitescript.lint.explanations import explanation

    print(explanation(code))
    return 0


# ---------------------------------------------------------------- one text


def _with_contacts(checked: CheckedFile, text: ProgramText, options: argparse.Namespace) -> CheckedFile:
    """Return a file with the contacts that a run of its program in the world has."""
    from elitescript.cli.contact_findings import contact_findings

    folder = None if text.path is None else real_path(text.path).parent
    contacts, why_less = contact_findings(checked.source, folder, options.world, options_from(options))
    if why_less:
        print(f"elitescript check: {shown_word(checked.name)}: {shown(why_less)}", file=sys.stderr)
    return checked._replace(problems=in_order([*checked.problems, *contacts]))


def _check(
    text: ProgramText, robot: RobotOptions, arm: ArmFacts | None, *, is_fixed: bool, is_generated: bool
) -> CheckedFile:
    if text.data is None:
        near = neighbours(text.path) if text.is_named and text.path is not None else ""
        problem = diagnostic("E003", 1, 1, text.why_not, hint=near)
        return CheckedFile(text.name, SourceFile(text.name, ""), (problem,))
    if text.path is not None and is_task_name(text.path.name):
        return _check_task(text, robot, arm, is_generated=is_generated)
    repairs: tuple[Repair, ...] = ()
    try:
        source = SourceFile.from_bytes(text.name, text.data)
        written = before = text.data.decode("utf-8")
    except ProgramError as error:
        from elitescript.text_encoding import decoded_from

        source = SourceFile.to_show(text.name, text.data)
        other = decoded_from(text.data) if is_fixed else None
        if other is None:
            if is_fixed and text.path is None:
                write_out(text.data)
            return CheckedFile(text.name, source, error.problems)
        written, encoding = other
        before = ""
        repairs = (Repair(error.problems[0].line, "E002", f"convert the file from {encoding} to UTF-8"),)
    firmware = profile(robot.firmware)
    if is_fixed:
        fixed, made = repaired(text.name, written, firmware, strict=robot.strict)
        repairs += made
        if text.path is None:
            write_out(fixed.encode("utf-8"))
        elif fixed != before:
            rewrite(text.path, fixed.encode("utf-8"))
        source = SourceFile(text.name, fixed)
    found = check_source(source, firmware, strict=robot.strict, arm=arm, ignored=robot.ignored)
    return CheckedFile(text.name, source, found, repairs)


def _check_task(text: ProgramText, robot: RobotOptions, arm: ArmFacts | None, *, is_generated: bool) -> CheckedFile:
    """Return what is found in a graphical program, node by node: in its tree and in its script."""
    # Imported late: few programs are graphical.
    from elitescript.environment.task_files import pendant_source, refused_task, source_of_task

    assert text.path is not None
    try:
        source = pendant_source(text.path) if is_generated else source_of_task(text.path)
    except ProgramError as error:
        return CheckedFile(text.name, refused_task(text.path), error.problems)
    made_for = "" if source.tree is None else source.tree.arm
    if arm is None and made_for:
        # What depends on the arm is looked at for the one that the task was made for.
        from elitescript.kernel.arm_facts import arm_facts
        from elitescript.models.model import model_names

        arm = arm_facts(replace(robot, model=made_for)) if made_for in model_names() else None
    found = check_source(source, profile(robot.firmware), strict=robot.strict, arm=arm, ignored=robot.ignored)
    return CheckedFile(text.name, source, found)
