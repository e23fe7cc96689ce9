"""The modules that hold the model files of the package as Python data."""

from __future__ import annotations

import tomllib
from pathlib import Path
from pprint import pformat
from typing import Any, Final

from elitescript.models.datafile import MODEL_FOLDER

FOLDER: Final = MODEL_FOLDER / "tables"
COMMAND: Final = "python tools/write_reference.py"


def document(path: Path) -> dict[str, Any]:
    """Return the content of a model file."""
    return tomllib.loads(path.read_text(encoding="utf-8"))


def model_tables() -> dict[Path, str]:
    """Return the modules by their paths, one for each model file."""
    return {module_path(path): module_of(path) for path in sorted(MODEL_FOLDER.glob("*.toml"))}


def module_path(path: Path) -> Path:
    """Return the path of the module of a model file, which is named after it."""
    return path.parent / "tables" / f"{path.name.replace('.', '_')}.py"


def module_of(path: Path) -> str:
    """Return the module of a model file."""
    table = pformat(document(path), width=116, compact=True, sort_dicts=False).replace("\n", "\n    ")
    return "\n".join(
        (
            f'"""The content of `{path.name}`. Written by `{COMMAND}`; do not edit."""',
            "",
            "from __future__ import annotations",
            "",
            "TYPE_CHECKING = False",
            "if TYPE_CHECKING:",
            "    from typing import Any",
            "",
            "",
            "def document() -> dict[str, Any]:",
            '    """Return the tables of the file, made anew."""',
            "    # fmt: off",
            f"    return {table}",
            "",
        )
    )
