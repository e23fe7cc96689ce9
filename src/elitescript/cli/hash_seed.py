"""Decides whether a run needs a process with a fixed seed of Python's string hashing.

Imported before anything that only a run needs: what it loads is lost if the process starts again.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

from elitescript.environment.program_file import source_of
from elitescript.environment.start_values import parse_settings
from elitescript.errors import ProgramError, UsageError
from elitescript.language.hash_order import may_hold_set, shows_hash_order
from elitescript.language.nodes import Census
from elitescript.language.options import Options
from elitescript.language.parser import Parsed, parse

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse


BYTES_MAX: Final = 1 << 20
"""A longer program takes longer to read than Python to start."""


def program_of_any_seed(options: argparse.Namespace) -> Parsed | None:
    """Return the program of a call of `run` if neither it nor what is beside it can show the order of a set.

    None also if it is long, or cannot be read, or only once, or plays a case.
    """
    if options.file is None or options.case is not None:
        return None
    path = Path(options.file)
    try:
        if options.world is not None or not path.is_file() or path.stat().st_size > BYTES_MAX:
            return None
        if may_hold_set(parse_settings(options.set)[1].values()):
            return None
        parsed = parse(
            source_of(path, options.task_dir, is_generated=options.generated),
            Options(strict=getattr(options, "strict", False)),
        )
    except (OSError, ProgramError, UsageError):
        # The run reports it.
        return None
    return None if not parsed.is_complete or shows_hash_order(Census(parsed.tree)) else parsed
