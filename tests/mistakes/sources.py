"""The sound programs into which mistakes are planted: examples, pages, and some written for it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final

from elitescript import Run
from elitescript.environment.start_values import parse_settings
from elitescript.errors import ElitescriptError
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.profile import profile
from tests.mistakes.judging import FIRMWARE, Lines, Setting, run_bounded
from tests.mistakes.planting import Program
from tests.specification.pages import parse_page
from tools.record_golden import programs, settings

ROOT: Final = Path(__file__).resolve().parents[2]
OWN: Final = Path(__file__).resolve().parent / "programs"
UNTIL_S: Final = 150.0


@dataclass(frozen=True, slots=True)
class Sound:
    """A sound program.

    Attributes:
        program: its text, with the lines that its run has passed.
        setting: what it runs with.
        run: its run, which has finished without an error or a warning.
    """

    program: Program
    setting: Setting
    run: Run


def sound(name: str, text: str, setting: Setting) -> Sound | None:
    """Return a program if it is sound: it finishes, and neither `check` nor the run has an error or a warning.

    In a world with faults the run may warn of them: that is what such a program is about.
    """
    if not text.isascii() or any(row.severity != "note" for row in _problems(name, text, setting)):
        return None
    lines = Lines()
    try:
        run = run_bounded(setting, text, name, UNTIL_S, lines)
    except ElitescriptError:
        return None
    has_faults = setting.world is not None and "[[fault]]" in setting.world.read_text(encoding="utf-8")
    if run.state != "finished" or run.alarms or not (run.findings.is_clean or has_faults):
        return None
    return Sound(Program(name, text, _with_declarations(text, lines.run)), setting, run)


def _problems(name: str, text: str, setting: Setting) -> tuple[object, ...]:
    return check_source(SourceFile(name, text), profile(FIRMWARE), presets=tuple(name for name, _ in setting.presets))


def _with_declarations(text: str, lines: frozenset[int]) -> frozenset[int]:
    """Return the lines that were run, with the lines of `global` and `nonlocal` in front of them."""
    found = set(lines)
    rows = text.splitlines()
    for number in range(len(rows), 0, -1):
        if rows[number - 1].split()[:1] in (["global"], ["nonlocal"]) and number + 1 in found:
            found.add(number)
    return frozenset(found)


def examples() -> Iterator[tuple[str, str, Setting]]:
    """Yield the examples, as their heads say that they are run."""
    files = tuple((path.name, path.read_bytes()) for path in sorted((ROOT / "examples").glob("*.txt")))
    for path in programs():
        signals, presets = parse_settings(settings(path))
        world = next((ROOT / name for name in settings(path, "--world")), None)
        setting = Setting(world, tuple(signals.items()), tuple(presets.items()), files)
        yield path.name, path.read_text(encoding="utf-8"), setting


def own() -> Iterator[tuple[str, str, Setting]]:
    """Yield the programs that were written for it."""
    for path in sorted(OWN.glob("*.script")):
        world = path.with_suffix(".toml")
        yield path.name, path.read_text(encoding="utf-8"), Setting(world if world.exists() else None)


def pages() -> Iterator[tuple[str, str, Setting]]:
    """Yield the programs of the specification that need nothing around them."""
    for path in sorted((ROOT / "tests" / "spec").glob("*.md")):
        if path.name == "README.md":
            continue
        for number, case in enumerate(parse_page(path.read_text(encoding="utf-8")), 1):
            is_plain = len(case.texts) == 1 and not case.texts[0].words and not case.servers and not case.inputs
            if is_plain and not case.world:
                yield f"{path.name}:{number}", case.texts[0].text, Setting()


@cache
def written_for_it() -> tuple[Sound, ...]:
    """Return the programs that were written for it and the examples: all must be sound."""
    return tuple(made for row in (*own(), *examples()) if (made := sound(*row)) is not None)


@cache
def everything() -> tuple[Sound, ...]:
    """Return these, and the programs of the specification that are sound."""
    return written_for_it() + tuple(made for row in pages() if (made := sound(*row)) is not None)
