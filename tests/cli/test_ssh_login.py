"""`serve --ssh` and `--ssh-password`."""

from __future__ import annotations

import argparse
import json
import os
import re
import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from elitescript import extras
from elitescript.cli import ssh_login
from elitescript.cli.main import main
from elitescript.cli.ssh_login import Login
from elitescript.errors import UsageError
from tests.cli.test_serve import SOURCE, line_with, ports_in, start, stop


def login(password: str | None = None, *, ssh: bool = True) -> Login | None:
    return ssh_login.ssh_login(argparse.Namespace(ssh=ssh, ssh_password=password))


@pytest.fixture(autouse=True)
def extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ssh_login, "require", lambda extra: None)


def test_it_is_off_by_default() -> None:
    assert login(ssh=False) is None


def test_a_password_without_the_port_is_a_mistake() -> None:
    with pytest.raises(UsageError, match="nothing without --ssh"):
        login("x", ssh=False)


def test_a_random_password_is_long_and_never_the_same() -> None:
    first, second = login(), login()
    assert first is not None and second is not None
    assert first.user == "root" and first.is_random
    assert len(first.password) >= 16 and first.password != second.password


def test_a_password_is_given_as_text_or_in_a_file(tmp_path: Path) -> None:
    (tmp_path / "pw").write_text("from file\n")
    assert login("text") == Login("root", "text", is_random=False)
    assert login(f"@{tmp_path / 'pw'}") == Login("root", "from file", is_random=False)


@pytest.mark.parametrize("text", ["", "x" * 257, "a\nb", "abcdefg\0"])
def test_what_is_no_password_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "pw").write_text(text)
    for given in (text, f"@{tmp_path / 'pw'}"):
        with pytest.raises(UsageError, match="1 to 256 printable characters"):
            login(given)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"cannot read .*none: No such file"):
        login(f"@{tmp_path / 'none'}")


def test_without_the_extra_the_line_that_installs_it_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.undo()
    monkeypatch.setattr(extras, "installed_version", lambda package: None)
    monkeypatch.setitem(sys.modules, "asyncssh", None)
    assert main(["serve", "--ssh", "--port", "all=0"]) == 2
    assert "pip install 'elitescript[ssh]'" in capsys.readouterr().err


def test_other_computers_are_served_only_on_insistence(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", "--ssh", "--host", "0.0.0.0", "--port", "all=0"]) == 2
    err = capsys.readouterr().err
    assert "--ssh --host 0.0.0.0" in err and "--trust-network" in err


def test_its_port_needs_the_option(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", "--port", "ssh=2222"]) == 2
    assert "only with --ssh" in capsys.readouterr().err


@pytest.mark.skipif(os.name != "posix", reason="signals")
class TestServed:
    @pytest.fixture
    def place(self) -> Iterator[Path]:
        with tempfile.TemporaryDirectory(prefix="es") as folder:
            yield Path(folder)

    @pytest.fixture(autouse=True)
    def needs_the_extra(self) -> None:
        pytest.importorskip("asyncssh")

    def test_the_ready_lines_name_the_port_and_the_random_password(self, place: Path) -> None:
        process = start(place, "--in-process", "--ssh")
        ports = ports_in(line_with(process, "ready"))
        said = re.fullmatch(
            r"ssh: user root, password ([\w-]{16,}), host key (SHA256:\S+)\n", line_with(process, "ssh: ")
        )
        assert said is not None and ports["ssh"] > 0
        with socket.create_connection(("127.0.0.1", ports["ssh"]), timeout=5) as client:
            assert client.recv(8) == b"SSH-2.0-"
        code, out = stop(process)
        assert code == 0 and said[1] not in out

    def test_a_given_password_is_not_printed(self, place: Path) -> None:
        process = start(place, "--in-process", "--ssh", "--ssh-password", "hidden word", "--json")
        ready = json.loads(line_with(process, '"ready"'))
        _, out = stop(process)
        (robot,) = ready["robots"]
        assert robot["ssh"]["user"] == "root" and robot["ssh"]["host_key"].startswith("SHA256:")
        assert robot["ports"]["ssh"] > 0
        assert "hidden" not in json.dumps(ready) + out


def test_serving_without_it_does_not_load_the_library() -> None:
    code = (
        "import sys, elitescript.cli.serve, elitescript.cli.doctor; sys.exit('asyncssh' in sys.modules "
        "or 'elitescript.services.ssh.desk' in sys.modules)"
    )
    environment = {**os.environ, "PYTHONPATH": str(SOURCE)}
    assert subprocess.run([sys.executable, "-c", code], env=environment, check=False).returncode == 0
