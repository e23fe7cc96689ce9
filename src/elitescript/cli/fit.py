"""`elitescript fit`: lengths of an arm from points that are known as joints and as pose."""

from __future__ import annotations

import json
import sys
from math import isfinite
from pathlib import Path
from typing import Any, Final

from elitescript.audit.fit.arm_file import arm_text
from elitescript.audit.fit.lengths import LengthFit, fit_lengths
from elitescript.audit.fit.pairs import ARITHMETIC, POINTS_MAX, Point, Points, points_of_file, points_of_program
from elitescript.audit.fit.words import table
from elitescript.cli.settings import parse_six
from elitescript.errors import UsageError
from elitescript.messages.motion import Six
from elitescript.models.datafile import parsed, read_text
from elitescript.models.model import RobotModel, is_model_file, load_model
from elitescript.outputs.writing import Output
from elitescript.shown import shown, shown_word
from elitescript.untrusted import files as untrusted_files

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

AGREES: Final = 0
DIFFERS: Final = 1


def fit(options: argparse.Namespace) -> int:
    """Fit the lengths of an arm to the points of the command line; return the exit code."""
    if not options.files and not options.pairs:
        raise UsageError("name programs with points, or --pairs FILE with joints and poses")
    if options.out is not None and not is_model_file(options.out):
        raise UsageError(f"--out {options.out}: the name of an arm file ends in .toml")
    model = load_model(options.robot)
    tcp = None if options.tcp is None else parse_six("--tcp", options.tcp, "m and rad")
    if tcp is not None and not all(map(isfinite, tcp)):
        raise UsageError(f"--tcp {options.tcp}: six finite numbers are needed")
    points = _all_points(options.files, options.pairs, tcp)
    fitted = fit_lengths(points, model.arm, zeros=options.zeros)
    if options.out is not None:
        _write_arm(options.outputs["out"], options.robot, model, fitted)
    if options.json:
        print(json.dumps({"robot": model.name, **fitted.json()}, allow_nan=False))
    else:
        _print(model, fitted)
        if options.out is not None:
            print(f"{shown_word(options.out)}: an arm file for --robot", file=sys.stderr)
    return DIFFERS if fitted.differs else AGREES


def _all_points(programs: list[str], files: list[str], tcp: Six | None) -> Points:
    parts = [(name, points_of_program(_text(name), name, tcp)) for name in programs]
    parts += [(name, points_of_file(_text(name), name, tcp)) for name in files]
    many = len(parts) > 1
    count = sum(len(part.points) for _, part in parts)
    if count > POINTS_MAX:
        raise UsageError(f"{count} points with joints and pose are given; at most {POINTS_MAX} are fitted")

    def named(point: Point, name: str) -> Point:
        return point._replace(name=f"{name}: {point.name}") if many and not point.name.startswith(name) else point

    return Points(
        points=tuple(named(point, name) for name, part in parts for point in part.points),
        tcp_words="; ".join(
            dict.fromkeys(f"{name}: {part.tcp_words}" if many else part.tcp_words for name, part in parts)
        ),
        # The digits of the coarsest file: all weigh alike.
        q_step=max((part.q_step for _, part in parts if part.points), default=ARITHMETIC),
        position_step=max((part.position_step for _, part in parts if part.points), default=ARITHMETIC),
        angle_step=max((part.angle_step for _, part in parts if part.points), default=ARITHMETIC),
    )


def _text(name: str) -> str:
    path = Path(name)
    return untrusted_files.read_text(path, untrusted_files.POINTS, is_stream_allowed=True)


def _write_arm(output: Output, robot: str, model: RobotModel, fitted: LengthFit) -> None:
    base: dict[str, Any] = {"base": model.name}
    if is_model_file(robot):
        base = parsed(robot, read_text(Path(robot)))
    about = f"lengths fitted to {fitted.used} points with joints and poses"
    text = arm_text(base, fitted.parameters, [joint.qd_max for joint in model.joints], about=about)
    output.finish(text)


def _print(model: RobotModel, fitted: LengthFit) -> None:
    count = f"{fitted.used} point{'' if fitted.used == 1 else 's'}"
    print(f"{model.name} against {count} with joints and pose:")
    print(*map(shown, table(fitted.parameters)), sep="\n")
    before, after = 1e3 * fitted.rms_before, 1e3 * fitted.rms_after
    print(f"positions: {before:.6g} mm rms from the model, {after:.6g} mm with what was found")
    for words in fitted.words:
        print(f"- {shown(words)}")
    for words in fitted.left_out:
        print(f"- left out: {shown(words)}")
    print("they differ" if fitted.differs else "they agree")
