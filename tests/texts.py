"""What the texts of findings and alarms must be: `said`, or a constant of the product."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from elitescript.said import Said, template_of

SOURCE = Path(__file__).resolve().parents[1] / "src" / "elitescript"


PACKAGES = (
    *("commands", "controller", "errors.py", "findings", "language", "lint", "messages", "modbus", "motion"),
    "runtime",
)
"""Where the texts of findings and alarms are written."""


@cache
def tree_of(path: Path) -> ast.Module:
    """Return the syntax tree of a file of the product."""
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def written() -> str:
    """Return the source of these packages, with each text in one piece."""
    paths = [path for path in SOURCE.rglob("*.py") if path.relative_to(SOURCE).parts[0] in PACKAGES]
    return re.sub(r'"\s+"', "", "\n".join(path.read_text(encoding="utf-8") for path in paths))


def is_constant(text: str) -> bool:
    """Return whether a text is written in the product as it is."""
    return text in written() or text.replace("\\", "\\\\").replace('"', '\\"') in written()


def parts(text: str) -> Iterator[str]:
    """Yield a text and the texts within it."""
    yield text
    if isinstance(text, Said):
        for value in text.values.values():
            if isinstance(value, Said):
                yield from parts(value)


def lost(text: str) -> list[str]:
    """Return the texts, of a text and those within it, that are neither made by `said` nor constants of the product."""
    found = []
    for part in parts(text):
        if isinstance(part, Said):
            assert part.template.format(**part.values) == part
        elif part and not is_constant(part):
            found.append(part)
        assert template_of(part)[:1] or not part
    return found
