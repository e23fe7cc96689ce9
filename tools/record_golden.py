"""Record the event traces of the examples: `python tools/record_golden.py`.

A trace is the meaning of a program: what it asked of the machine and what happened, with tick and script line. The
tests compare the traces in `tests/golden` as text, and only this tool writes them. Look at the difference before
you commit it.

An example that needs something from outside says so in its head, as the command that runs it: `# Run` and the command
line, whose `--set` and `--world` options count here too.

One line for each event: tick, script line (`-` where there is none), thread, event. Floats are rounded to nine
significant digits and nine decimals, which is far below what the arm can do and far above the last digits in
which the mathematical libraries of two computers may differ.
"""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Iterable
from enum import Enum
from itertools import pairwise
from pathlib import Path

from elitescript import Run, VirtualRobot
from elitescript.environment.start_values import parse_settings

ROOT = Path(__file__).resolve().parent.parent
EXAMPLES = ROOT / "examples"
GOLDEN = ROOT / "tests" / "golden"
PLACE = ("tick", "line", "thread")


def programs() -> list[Path]:
    """Every example program."""
    return sorted(EXAMPLES.glob("*.script"))


def golden_file(program: Path) -> Path:
    """Where the trace of a program is kept."""
    return GOLDEN / f"{program.stem}.events"


def settings(program: Path, wanted: str = "--set") -> list[str]:
    """The values of one option of the line `# Run` in the head of an example."""
    head = program.read_text(encoding="utf-8").splitlines()[:20]
    words = [word for line in head if line.startswith("# Run ") for word in line.split()]
    return [value for option, value in pairwise(words) if option == wanted]


def run_example(program: Path) -> Run:
    """Run an example as `elitescript run` does with the options that it asks for."""
    signals, presets = parse_settings(settings(program))
    robot = VirtualRobot("CS66", world=next((ROOT / name for name in settings(program, "--world")), None))
    for name, value in signals.items():
        robot.signals[name] = value
    return robot.run(program, presets=presets)


def render(run: Run) -> str:
    """The trace of a run as text."""
    rows = [event_line(event) for event in run.events]
    rows.append(f"{run.state} after {_value(run.time_s)} s")
    rows += [f"global {name} = {_value(value)}" for name, value in run.globals.items()]
    return "".join(f"{row}\n" for row in rows)


def event_line(event: object) -> str:
    """One event as a line of text."""
    tick = getattr(event, "tick", 0)
    line = event.line if "line" in names_of(event) else "-"
    thread = getattr(event, "thread", "-") or "-"
    return f"{tick:>7} {line:>4} {thread} {_name(event)} {_fields(event, PLACE)}".rstrip()


def names_of(event: object) -> set[str]:
    """Return the fields of an event: all events have a line, 0 where it is no field."""
    return {field.name for field in dataclasses.fields(event)}  # type: ignore[arg-type]


def _name(thing: object) -> str:
    return type(thing).__name__


def _fields(thing: object, without: Iterable[str] = ()) -> str:
    shown = []
    for field in dataclasses.fields(thing):  # type: ignore[arg-type]
        value = getattr(thing, field.name)
        if field.name in without or not field.repr or value == field.default:
            continue
        shown.append(f"{field.name}={_value(value)}")
    return " ".join(shown)


def _value(value: object) -> str:
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, float):
        return f"{round(value, 9) + 0.0:.9g}"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key}: {_value(item)}' for key, item in value.items())}}}"
    if dataclasses.is_dataclass(value):
        return f"{_name(value)}({_fields(value)})"
    return repr(value)


def main() -> int:
    """Write every trace that changed; remove those without a program."""
    GOLDEN.mkdir(exist_ok=True)
    wanted = {golden_file(program): program for program in programs()}
    for path in sorted(GOLDEN.glob("*.events")):
        if path not in wanted:
            path.unlink()
            print(f"removed {path.relative_to(ROOT)}")
    for path, program in wanted.items():
        text = render(run_example(program))
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8", newline="\n")
            print(f"wrote {path.relative_to(ROOT)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
