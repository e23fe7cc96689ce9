"""`--script-watch` of pytest: what is watched, and a session."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from types import SimpleNamespace

import pytest

from elitescript.pytest_plugin import rounds


def test_files_below_the_root_folder_and_beside_the_arguments(tmp_path):
    root, other = tmp_path / "root", tmp_path / "other"
    for path in (root / "test_a.py", root / "cell.script", root / "out/b.py", root / "cell.toml", other / "test_c.py"):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("")
    (root / "report.html").write_text("")
    config = SimpleNamespace(
        rootpath=root,
        args=[str(root), f"{other / 'test_c.py'}::test_x"],
        invocation_params=SimpleNamespace(dir=root),
        getini={"norecursedirs": ["ou*"]}.get,
    )
    names = sorted(path.name for path in rounds._files(config))
    assert names == ["cell.script", "cell.toml", "test_a.py", "test_c.py"]


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_a_session(tmp_path):
    (tmp_path / "test_a.py").write_text("def test_a():\n    assert False\n")
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    command = [sys.executable, "-m", "pytest", "-q", "--script-watch", "-p", "no:cacheprovider"]
    with subprocess.Popen(
        command, cwd=tmp_path, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stderr is not None
        assert process.stdout is not None
        errors = process.stderr
        assert "exit code 1" in next(line for line in errors if "Ctrl-C ends it" in line)
        (tmp_path / "test_a.py").write_text("def test_a():\n    assert True\n")
        assert "test_a.py changed" in next(errors)
        assert "exit code 0" in next(line for line in errors if "Ctrl-C ends it" in line)
        process.send_signal(signal.SIGINT)
        out = process.stdout.read()
        assert process.wait(20) == 2
    assert "1 failed" in out
    assert "1 passed" in out
