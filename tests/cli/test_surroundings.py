"""A run says the same, to the byte, wherever it is started."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Any, Final

import pytest

from elitescript.records import NamedTuple

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not hasattr(os, "fork"), reason="needs processes of a Unix"),
]

EXAMPLES: Final = Path(__file__).parents[2] / "examples"
PROGRAMS: Final = sorted(EXAMPLES.glob("*.script"))
LIMIT_S: Final = 120.0


class Surroundings(NamedTuple):
    """What is unlike where a run is usually started.

    Attributes:
        environment: variables; None takes one away.
        before: called in the new process.
        python: options of Python.
        cwd: name of the folder in which it is started; the folder of the copy if empty.
    """

    environment: Mapping[str, str | None] = {}
    before: Callable[[], Any] | None = None
    python: tuple[str, ...] = ()
    cwd: str = ""


def _limits() -> None:
    import resource

    resource.setrlimit(resource.RLIMIT_NOFILE, (64, 64))
    resource.setrlimit(resource.RLIMIT_STACK, (1 << 20, 1 << 20))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _memory() -> None:
    import resource

    resource.setrlimit(resource.RLIMIT_AS, (300 << 20, 300 << 20))


def _another_user() -> None:
    if os.geteuid() == 0:
        os.setgroups([])
        os.setgid(65534)
        os.setuid(65534)


@cache
def _can_be_run_by_another_user() -> bool:
    """Return whether that user may read this Python and the package."""
    command = [sys.executable, "-c", "import elitescript.cli.main"]
    try:
        found = subprocess.run(command, preexec_fn=_another_user, capture_output=True, check=False, timeout=LIMIT_S)
    except PermissionError:
        return False
    return found.returncode == 0


SURROUNDINGS: Final = {
    "locale C": Surroundings({"LC_ALL": "C", "LANG": None, "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}),
    "locale of German": Surroundings({"LC_ALL": "de_DE.ISO-8859-1", "LANG": "de_DE"}),
    "a time zone": Surroundings({"TZ": "Asia/Kathmandu"}),
    "another folder": Surroundings(cwd="/"),
    "umask": Surroundings(before=partial(os.umask, 0o777)),
    "hash seed 1": Surroundings({"PYTHONHASHSEED": "1"}),
    "hash seed random": Surroundings({"PYTHONHASHSEED": "random"}),
    "no home": Surroundings({"HOME": None, "XDG_CACHE_HOME": None, "USER": None, "LOGNAME": None}),
    "a home that is not there": Surroundings({"HOME": "/nonexistent", "TMPDIR": "/nonexistent"}),
    "no variables": Surroundings(dict.fromkeys(os.environ)),
    "nice": Surroundings(before=partial(os.nice, 19)),
    "limits": Surroundings(before=_limits),
    "python -O": Surroundings(python=("-O",)),
    "python -OO": Surroundings(python=("-OO",)),
    "PYTHONOPTIMIZE=2": Surroundings({"PYTHONOPTIMIZE": "2"}),
    "warnings are errors": Surroundings({"PYTHONWARNINGS": "error", "PYTHONDEVMODE": None}),
    "a memory limit of the shell": Surroundings(before=_memory),
    "another user": Surroundings({"PYTHONDONTWRITEBYTECODE": "1"}, before=_another_user),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A copy of the programs that nothing can write to, and that everybody can read."""
    path = tmp_path_factory.mktemp("programs")
    for file in EXAMPLES.iterdir():
        if file.is_file():
            (path / file.name).write_bytes(file.read_bytes())
            (path / file.name).chmod(0o444)
    for above in (path, *path.parents[:3]):
        if above.stat().st_uid == os.getuid() and above != Path(above.anchor):
            above.chmod(above.stat().st_mode | 0o055)
    path.chmod(0o555)
    yield path
    path.chmod(0o755)


def outcome(program: str, folder: Path, there: Surroundings) -> tuple[int, bytes, bytes]:
    environment = os.environ | {key: value for key, value in there.environment.items() if value is not None}
    for name in [key for key, value in there.environment.items() if value is None]:
        environment.pop(name, None)
    found = subprocess.run(
        [sys.executable, *there.python, "-m", "elitescript", "run", "--json", "--until", "20", str(folder / program)],
        cwd=there.cwd or folder,
        env=environment,
        preexec_fn=there.before,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        timeout=LIMIT_S,
        check=False,
    )
    return found.returncode, found.stdout, found.stderr


@pytest.mark.parametrize("program", [path.name for path in PROGRAMS])
def test_a_run_is_the_same_everywhere(program: str, folder: Path) -> None:
    usual = outcome(program, folder, Surroundings())
    assert usual[1]
    for name, there in SURROUNDINGS.items():
        if there.before is _another_user and not _can_be_run_by_another_user():
            continue
        assert outcome(program, folder, there) == usual, name


@pytest.mark.parametrize("target", ["closed", "a pipe that nobody reads", "a full device"])
def test_a_place_that_takes_no_output_ends_a_run_without_a_traceback(target: str, folder: Path) -> None:
    command = [sys.executable, "-m", "elitescript", "run", "--until", "20", str(folder / PROGRAMS[0].name)]
    output: Any = subprocess.PIPE
    before: Callable[[], Any] | None = None
    if target == "closed":
        output, before = None, partial(os.close, 1)
    elif target == "a full device":
        if not Path("/dev/full").exists():
            pytest.skip("no device that is always full")
        output = os.open("/dev/full", os.O_WRONLY)
    process = subprocess.Popen(
        command, cwd=folder, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.PIPE, preexec_fn=before
    )
    if process.stdout is not None:
        process.stdout.close()
    assert process.stderr is not None
    with process.stderr:
        said = process.stderr.read()
    process.wait(LIMIT_S)
    if isinstance(output, int) and output >= 0:
        os.close(output)
    assert b"Traceback" not in said
    assert b"Exception ignored" not in said
