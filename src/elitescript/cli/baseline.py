"""`check --baseline FILE`: what is known in an old code base is written down once, and left out from then on.

A finding is known by file, code and the text of its line, so that it stays known when lines move. The paths of files
are relative to the folder of the baseline. What keeps a program from starting is never left out.
"""

from __future__ import annotations

import json
import os
from collections import Counter
from pathlib import Path
from typing import Any, Final

from elitescript.cli.output.check_formats import CheckedFile
from elitescript.errors import UsageError
from elitescript.language.diagnostics import Diagnostic
from elitescript.lint.suppression import can_be_hidden
from elitescript.outputs.writing import write_file
from elitescript.paths import real_path
from elitescript.untrusted.files import BASELINE, read_text
from elitescript.untrusted.json_text import JsonError, json_value

VERSION: Final = 1

_Known = Counter[tuple[str, str, str]]
"""How often there are findings with this file, code and line."""


class Baseline:
    """The findings that are known, or those of this call if the file does not exist.

    Raises:
        UsageError: it cannot be read, or is no baseline.
    """

    __slots__ = ("_folder", "_is_new", "_known", "_path", "left_out")

    def __init__(self, path: str) -> None:
        self._path = path
        self._folder = real_path(Path(path).parent)
        self._is_new = not os.path.lexists(path)
        self._known: _Known = Counter() if self._is_new else _read(path)
        self.left_out = 0
        """Findings that are known."""

    def without_known(self, checked: CheckedFile) -> CheckedFile:
        """Return a file without the findings that are known; a new baseline takes all of them."""
        file = checked.name if checked.is_stream else os.path.relpath(real_path(checked.name), self._folder)
        kept: list[Diagnostic] = []
        for problem in checked.problems:
            key = (Path(file).as_posix(), problem.code, checked.source.line(problem.line).strip())
            if not can_be_hidden(problem) or (not self._is_new and self._known[key] <= 0):
                kept.append(problem)
                continue
            self._known[key] += 1 if self._is_new else -1
            self.left_out += 1
        return checked._replace(problems=tuple(kept))

    def end(self) -> str:
        """Write a new baseline; return a sentence on what was left out.

        Raises:
            UsageError: it cannot be written.
        """
        if not self._is_new:
            return f"{self.left_out} known in {self._path} left out"
        rows = [
            {"file": file, "code": code, "line": line, "count": count}
            for (file, code, line), count in sorted(self._known.items())
        ]
        lines = ",\n".join(f"  {json.dumps(row)}" for row in rows)
        text = f'{{"elitescript_baseline": {VERSION}, "findings": [\n{lines}\n]}}\n'
        try:
            write_file(self._path, text, f"--baseline {self._path}")
        except OSError as error:
            raise UsageError(f"--baseline {self._path}: {error}") from None
        return f"{self.left_out} written to {self._path} and left out from now on"


def _read(path: str) -> _Known:
    refusal = f"--baseline {path} is no baseline of elitescript: "
    try:
        data: Any = json_value(read_text(path, BASELINE))
    except JsonError as error:
        raise UsageError(f"{refusal}{error.why}") from None
    if not isinstance(data, dict) or data.get("elitescript_baseline") != VERSION:
        raise UsageError(f'{refusal}it does not begin with "elitescript_baseline": {VERSION}')
    known: _Known = Counter()
    for number, row in enumerate(data.get("findings") or (), 1):
        try:
            file, code, line, count = row["file"], row["code"], row["line"], row["count"]
        except (TypeError, KeyError):
            raise UsageError(f"{refusal}finding {number} has no file, code, line and count") from None
        if not all(isinstance(value, str) for value in (file, code, line)) or type(count) is not int:
            raise UsageError(f"{refusal}finding {number}: file, code and line are texts, count is a whole number")
        known[(file, code, line)] += count
    return known
