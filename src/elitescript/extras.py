"""Extras: the packages that some commands need, and from which version on.

The bounds are the lowest versions with which the tests of what needs them pass; `make lowest` installs these and runs
the tests. `pyproject.toml` says the same to pip, and a test compares both.
"""

from __future__ import annotations

import re
import sys
from importlib import import_module
from typing import Any, Final

from elitescript.errors import UsageError
from elitescript.records import NamedTuple


class Extra(NamedTuple):
    """What an extra installs.

    Attributes:
        package: its name for pip.
        least: lowest version that works.
        modules: that are imported of it; the first part of the first one is the name of the package in Python.
        purpose: what needs it, for messages.
        instead: what works without it, for messages.
        also: further packages that older versions of it leave too old, with their lowest version.
    """

    package: str
    least: str
    modules: tuple[str, ...]
    purpose: str
    instead: str = ""
    also: tuple[tuple[str, str], ...] = ()


EXTRAS: Final = {
    "serial": Extra(
        "pyserial", "3.5", ("serial",), "a serial port of this computer", "socket://HOST:PORT works without it"
    ),
    "ssh": Extra("asyncssh", "2.20", ("asyncssh",), "--ssh"),
    "lsp": Extra("pygls", "2.1", ("pygls.lsp.server", "lsprotocol.types"), "elitescript lsp"),
    "mcp": Extra("mcp", "2.0", ("mcp.server.mcpserver",), "elitescript mcp"),
    "studio": Extra("websockets", "17.0", ("websockets.asyncio.server",), "elitescript studio"),
    "cluster": Extra("distributed", "2026.1", ("distributed",), "--dask"),
    "parquet": Extra(
        "pyarrow", "20.0", ("pyarrow", "pyarrow.parquet"), "a Parquet table", "CSV and JSON lines work without it"
    ),
    "optimise": Extra("optuna", "5.0", ("optuna",), "--minimise or --maximise"),
    "mcap": Extra("mcap", "1.5", ("mcap.writer", "mcap.stream_reader"), "a recording"),
    "pytest": Extra("pytest", "7.0", ("pytest",), "the pytest plugin of elitescript", also=(("pluggy", "1.2"),)),
}
"""By the name of the extra."""

_REASON_MAX: Final = 200
"""Characters of what a package raises that are shown."""


def require(extra: str, purpose: str = "") -> Any:
    """Import the package of an extra, and return its module.

    Args:
        extra: of `EXTRAS`.
        purpose: what needs it, if that is not what the table says; for messages.

    Raises:
        UsageError: it is not installed, too old, or raises an error when it is imported; says which, which version is
            needed and which one is there, and how to install it.
    """
    package, least, modules, usual_purpose, instead, also = EXTRAS[extra]
    purpose = purpose or usual_purpose
    otherwise = f"; {instead}" if instead else ""
    is_hidden = sys.modules.get(modules[0].partition(".")[0], sys) is None  # as tests make a package missing
    version: str | None = None
    for name, lowest in (*also, (package, least)):
        version = None if is_hidden else installed_version(name)
        if version is not None and is_older(version, lowest):
            raise UsageError(
                f"{name} {version} is installed; {purpose} needs {lowest} or newer: "
                f"pip install '{name}>={lowest}'{otherwise}"
            )
    try:
        loaded = [import_module(module) for module in modules]
        return loaded[0]
    except Exception as error:  # Whatever the code of a package raises.
        if version is None and not _is_there(modules[0], error):
            raise UsageError(
                f"{purpose} needs {package} {least} or newer, which is not installed: "
                f"pip install 'elitescript[{extra}]'{otherwise}"
            ) from None
        found = package if version is None else f"{package} {version}"
        lines = str(error).strip().splitlines() or [""]
        raise UsageError(
            f"{found} is installed, but importing it fails ({type(error).__name__}: {lines[0]:.{_REASON_MAX}}); "
            f"{purpose} needs it: pip install --force-reinstall '{package}>={least}'{otherwise}"
        ) from error


def state_of(extra: str) -> str:
    """Return a word on an extra, without importing its package: `installed`, `not installed`, or its version and the
    one that is needed."""
    from importlib.util import find_spec

    package, least, modules, *_ = EXTRAS[extra]
    if find_spec(modules[0].partition(".")[0]) is None:
        return NOT_INSTALLED
    version = installed_version(package)
    if version is not None and is_older(version, least):
        return f"too old ({package} {version}, needs {least})"
    return INSTALLED


INSTALLED: Final = "installed"
NOT_INSTALLED: Final = "not installed"


def installed_version(package: str) -> str | None:
    """Return the version of a package; None if it is not installed, or was not installed by pip or its like."""
    # Imported late: it takes longer than most commands.
    from importlib.metadata import PackageNotFoundError, version

    try:
        # A damaged installation has no version.
        return version(package) or None
    except PackageNotFoundError:
        return None


def is_older(version: str, least: str) -> bool:
    """Return whether a version is older than another one, by their numbers; `2.0rc1` is older than `2.0`.

    Args:
        version: as packages have it (PEP 440).
        least: numbers with full stops.
    """
    found = re.match(r"v?(?:\d+!)?(\d+(?:\.\d+)*)(.*)", version.strip(), re.IGNORECASE | re.DOTALL)
    if found is None:
        return False
    numbers, needed = (_numbers(text) for text in (found[1], least))
    if numbers != needed:
        return numbers < needed
    return re.match(r"[-_.]?(a|b|c|rc|alpha|beta|pre|preview|dev)", found[2], re.IGNORECASE) is not None


def _numbers(text: str) -> tuple[int, ...]:
    """Return the numbers of a version without zeros at its end: 2.0 is 2."""
    numbers = [int(part) for part in text.split(".")]
    while numbers and not numbers[-1]:
        numbers.pop()
    return tuple(numbers)


def _is_there(module: str, error: Exception) -> bool:
    """Return whether a package whose import has failed is there all the same, so that it is broken."""
    name = module.partition(".")[0]
    is_own = isinstance(error, ModuleNotFoundError) and (error.name or "").partition(".")[0] == name
    return not is_own or sys.modules.get(name) is not None
