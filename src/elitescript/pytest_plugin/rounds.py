"""`--script-watch`: runs the tests again whenever a file below the root folder has changed."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path
from typing import Final

import pytest

from elitescript.environment.watched_files import Rounds, files_below

IN_ROUND: Final = "ELITESCRIPT_PYTEST_ROUND"
"""Set in the environment of the rounds, in which the option does nothing: it may stand in `addopts`."""
CODE: Final = (".py", ".script", ".txt", ".toml", ".ini", ".cfg", ".urdf")
DATA: Final = (".csv", ".json", ".xml", ".yaml", ".yml")
"""Files that tests may write themselves: they count while no test runs."""


def watch(config: pytest.Config) -> int:
    """Run the call of pytest in rounds, until Ctrl-C; return the exit code that pytest has then."""
    # Of `python -m pytest` the working directory is on the path of the tests, of `pytest` it is not.
    is_module = Path(sys.argv[0]).name == "__main__.py"
    command = [
        sys.executable,
        *(() if is_module else ("-P",)),
        "-m",
        "pytest",
        *map(str, config.invocation_params.args),
    ]
    environment = {**os.environ, IN_ROUND: "1"}

    def start() -> subprocess.Popen[bytes]:
        return subprocess.Popen(command, env=environment, cwd=config.invocation_params.dir)

    def files() -> dict[Path, bool]:
        return {path: path.suffix in DATA for path in _files(config)}

    try:
        return Rounds(start, files, "pytest", is_ended_by_change=False).run()
    except KeyboardInterrupt:
        return pytest.ExitCode.INTERRUPTED


def _files(config: pytest.Config) -> Iterator[Path]:
    left_out = config.getini("norecursedirs")
    folders = {config.rootpath}
    for argument in config.args:
        path = config.invocation_params.dir / argument.partition("::")[0]
        if not path.is_relative_to(config.rootpath):
            folders.add(path if path.is_dir() else path.parent)
    return files_below(
        sorted(folders),
        lambda name: name.endswith(CODE + DATA),
        lambda name: name == "__pycache__" or any(fnmatch(name, pattern) for pattern in left_out),
    )
