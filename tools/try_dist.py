"""Try the files of a release as a user would: `make dist` calls `python -m tools.try_dist DIST FOLDER`.

The wheel is installed in a fresh environment in FOLDER. There, away from the working copy, an example of the sdist
runs, and a controller is served until a client has talked to it.
"""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import tarfile
import venv
import zipfile
from pathlib import Path
from typing import Final

PAGE_FOLDER: Final = "elitescript/page/built/"
PAGE_FILES: Final = {"studio.html", "studio.js", "studio.css", "recorded.html", "sweep.html", "THIRD_PARTY.txt"}
WHEEL_MAX: Final = 5_000_000
"""Size limit of the wheel, bytes."""
SERVE: Final = ("serve", "--port", "all=0")
REPLY_MAX_S: Final = 30.0


def main(dist: Path, folder: Path) -> int:
    """Try wheel and sdist; print each step. Return 0, or 1 if the wheel is too large.

    Raises:
        subprocess.CalledProcessError: a step has failed.
        AssertionError, OSError, StopIteration: the served controller does not answer as it should.
    """
    (wheel,), (sdist,) = dist.glob("*.whl"), dist.glob("*.tar.gz")
    for file in (wheel, sdist):
        print(f"{file}: {file.stat().st_size // 1000} kB")
    if wheel.stat().st_size > WHEEL_MAX:
        print(f"the wheel has more than {WHEEL_MAX // 1_000_000} MB", file=sys.stderr)
        return 1
    with zipfile.ZipFile(wheel) as archive:
        missing = PAGE_FILES - {name.removeprefix(PAGE_FOLDER) for name in archive.namelist()}
    if missing:
        print(
            f"the wheel lacks the page of the studio: {', '.join(sorted(missing))}; run `make studio`", file=sys.stderr
        )
        return 1
    with tarfile.open(sdist) as archive:
        archive.extractall(folder, filter="data")
    sources = folder / sdist.name.removesuffix(".tar.gz")
    home = folder / "fresh"
    venv.create(home, clear=True, with_pip=True)
    scripts = home / ("Scripts" if os.name == "nt" else "bin")
    environment = {name: text for name, text in os.environ.items() if name != "PYTHONPATH"}
    install = [scripts / "python", "-m", "pip", "install", "-qq", "--disable-pip-version-check", wheel.resolve()]
    subprocess.run(install, check=True, env=environment)
    command = (scripts / "elitescript").resolve()
    for words in (["--version"], ["run", sources.resolve() / "examples" / "pick_and_place.script"], ["doctor"]):
        subprocess.run([command, *words], check=True, cwd=home, env=environment)
    _try_serving([command, *SERVE], home, environment)
    return 0


def _try_serving(command: list[str | Path], folder: Path, environment: dict[str, str]) -> None:
    """Serve a controller, ask its dashboard for the robot mode, and end it."""
    served = subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True)
    assert served.stdout is not None
    try:
        ready = served.stdout.readline().rstrip()
        print(ready)
        port = re.search(r"dashboard (\d+)", ready)
        assert port is not None, "no `ready` line"
        with socket.create_connection(("127.0.0.1", int(port[1])), timeout=REPLY_MAX_S) as client:
            client.sendall(b"robotMode\n")
            answer = next(line for line in client.makefile("rb") if b"POWER_OFF" in line)
        print(answer.decode().rstrip())
        served.send_signal(signal.SIGINT)
        assert served.wait(REPLY_MAX_S) == 0, f"exit code {served.returncode}"
    finally:
        served.kill()
        served.wait()


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
