"""Settings of a project: `[tool.elitescript]` in the `pyproject.toml` that is nearest above a program."""

from __future__ import annotations

from typing import Any, Final

from elitescript.errors import UsageError
from elitescript.untrusted.files import PROJECT, read_bytes, text_of
from elitescript.untrusted.toml_text import toml_tables

TABLE: Final = "elitescript"


def project_ignore(path: str) -> str:
    """Return the codes of findings that a project file leaves out, separated by commas.

    Raises:
        UsageError: the file cannot be read, or `ignore` is no list of texts.
    """
    data = read_bytes(path, PROJECT)
    if TABLE.encode() not in data:
        return ""
    settings = _settings(data, path)
    codes = settings.get("ignore", [])
    if not isinstance(codes, list) or not all(isinstance(code, str) for code in codes):
        raise UsageError(f'{path}: [tool.{TABLE}] ignore must be a list of codes such as ["W230"], got {codes!r}')
    return ",".join(codes)


def _settings(data: bytes, path: str) -> dict[str, Any]:
    tool = toml_tables(text_of(data, path, "project file"), path, "project file").get("tool", {})
    settings = tool.get(TABLE, {}) if isinstance(tool, dict) else {}
    if not isinstance(settings, dict):
        raise UsageError(f"{path}: [tool.{TABLE}] must be a table")
    return settings
