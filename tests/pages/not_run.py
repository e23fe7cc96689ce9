"""What pages show and the tests do not run, with the reason. A row that fits nothing fails the tests."""

from __future__ import annotations

from typing import Final

NOT_RUN: Final[dict[str, str]] = {
    r"make \w+": "the targets of the Makefile build an environment, or run these tests",
    r"elitescript record 192.*": "needs a controller on the network; tests/recorder has some",
    r"elitescript audit cell.mcap .*": "needs a recording of a controller; tests/audit has some",
    r"elitescript devices .*": "opens the ports that the page names, which another process may have",
    r"elitescript studio .*--connect 192.*": "needs a controller on the network; tests/studio/connected has some",
    r"elitescript studio \w+\.script( --world cell\.toml)?": "tests/studio_page runs it, with the built page",
    r"elitescript studio examples/palletising\.task .*": "tests/studio_page has trees, with the built page",
    r"elitescript sweep .* --page \w+\.html": "needs the built page; tests/sweep/test_replays.py writes one",
    r"elitescript serve --studio": "needs the built page; tests/studio/connected runs it where that is there",
    r"elitescript serve --ssh.*": "needs the extra `ssh`; tests/services runs it",
    r"elitescript run .* --serial .*": "needs a serial port of this computer",
    r"elitescript run examples/camera_picking.script --set .*": "needs `devices` in another terminal",
    r"elitescript serve --host .*": "opens ports at an address that this computer does not have",
    r"code --install-extension .*": "needs VS Code",
    r"mbpoll .*": "a program of somebody else",
    r"elitescript sweep .* --dask tcp://10.*": "needs a cluster; tests/sweep/test_cluster.py has one",
    r"elitescript sweep examples/(palletising|mended)\.task .*": "takes seconds; tests/sweep runs sweeps",
    r"elitescript sweep examples/pick_and_place\.script .*": "takes seconds; tests/sweep runs sweeps",
    r"elitescript sweep examples/transfer\.script .* --minimise .*": "takes seconds; tests/sweep runs it",
    r"pip install .*": "installs from a package index",
    r"python3 -m venv .*|\. .*/bin/activate": "the page runs in the environment of the tests",
    r"sudo .*": "changes the system",
    r"git clone .*": "needs the network",
    r"cp /usr/share/Elite/.*|cp -r EliPlugin-learning/.*": "files of the vendor's SDK",
    r"g\+\+ .*|\./move|python watch\.py": "needs the vendor's SDK",
}
"""Pattern of a whole command, and why it is not run. `elitescript` commands are parsed all the same."""

CHECKED_ELSEWHERE: Final[dict[str, str]] = {
    "docs/reference/api.md": "signatures; tests/test_device_docstrings.py runs the examples of the docstrings",
    "docs/reference/rules.md": "programs with mistakes; tests/lint/test_explanations.py checks each one",
}
"""Generated pages whose blocks other tests run."""
