"""The command, from its first line to its end."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
from http.client import HTTPConnection
from pathlib import Path
from time import monotonic, sleep
from urllib.parse import urlsplit

import pytest

from elitescript import page
from elitescript.cli.main import main
from elitescript.studio import serving
from elitescript.studio.memory import Memory
from tests.studio.page_client import WAIT_S, Page, process

MOVE = "def p():\n  movej([0.5, -1.57, -1.57, -1.57, 1.57, 0])\nend\n"

needs_page = pytest.mark.skipif(not page.is_built(), reason="the page is not built: make studio")


@pytest.fixture
def built(tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "built").mkdir()
    (tmp_path / "built" / "studio.html").write_text("")
    monkeypatch.setattr(page, "_BUILT", tmp_path / "built")


class TestUsage:
    def refusal(self, capsys, *words: str | Path) -> str:
        assert main(["studio", "--no-browser", *map(str, words)]) == 2
        found = capsys.readouterr()
        assert found.out == ""
        return str(found.err)

    def test_without_the_built_page_it_says_what_to_do(self, capsys, monkeypatch, tmp_path: Path) -> None:
        monkeypatch.setattr(page, "_BUILT", tmp_path)
        assert "run `make studio`" in self.refusal(capsys)

    def test_without_the_extra_it_says_how_to_install_it(self, capsys, monkeypatch, built: None) -> None:
        for name in ("elitescript.studio.serving", "elitescript.studio.server"):
            monkeypatch.delitem(sys.modules, name, raising=False)
        monkeypatch.setitem(sys.modules, "websockets", None)
        for name in [name for name in sys.modules if name.startswith("websockets.")]:
            monkeypatch.setitem(sys.modules, name, None)
        assert "pip install 'elitescript[studio]'" in self.refusal(capsys)

    def test_what_cannot_be_opened(self, capsys, tmp_path: Path, built: None) -> None:
        (tmp_path / "latin.script").write_bytes(b"\xff")
        assert "no such file or folder" in self.refusal(capsys, tmp_path / "f")
        assert "byte 0xFF is not UTF-8 text" in self.refusal(capsys, tmp_path / "latin.script")
        assert "there is no folder" in self.refusal(capsys, tmp_path / "no" / "a.script")
        assert "arm.urdf: No such file" in self.refusal(capsys, tmp_path, "--urdf", tmp_path / "arm.urdf")
        assert "no.toml" in self.refusal(capsys, tmp_path, "--world", tmp_path / "no.toml")
        assert "CS99" in self.refusal(capsys, tmp_path, "--robot", "CS99")

    def test_ports(self, capsys, tmp_path: Path, built: None) -> None:
        assert "--port 70000: a port is a number up to 65535" in self.refusal(capsys, tmp_path, "--port", "70000")
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            assert f"--port {port}: " in self.refusal(capsys, tmp_path, "--port", str(port))

    def test_control_needs_a_controller(self, capsys, tmp_path: Path, built: None) -> None:
        assert "--control goes with --connect" in self.refusal(capsys, tmp_path, "--control")


class TestBrowser:
    def test_it_opens_an_address_without_the_token(self, monkeypatch) -> None:
        opened: list[str] = []
        monkeypatch.setattr(serving.webbrowser, "open", opened.append)
        monkeypatch.setenv("DISPLAY", ":0")
        serving._open_browser("http://127.0.0.1:1/?token=once").join(WAIT_S)  # type: ignore[union-attr]
        assert opened == ["http://127.0.0.1:1/?token=once"]

    def test_without_a_screen_nothing_takes_the_terminal(self, monkeypatch) -> None:
        monkeypatch.setattr(sys, "platform", "linux")
        for name in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER"):
            monkeypatch.delenv(name, raising=False)
        assert serving._open_browser("http://127.0.0.1:1/") is None


@needs_page
class TestProcess:
    def test_the_page_is_served_until_a_signal(self, tmp_path: Path) -> None:
        with process(tmp_path / "new.script", state=tmp_path / "state") as (started, address):
            at = urlsplit(address)
            assert (at.hostname, at.path) == ("127.0.0.1", "/")
            client = HTTPConnection(at.netloc, timeout=WAIT_S)
            client.request("GET", f"/?{at.query}")
            body = client.getresponse().read()
            client.close()
            assert b'src="studio.js"' in body
            with Page(address) as connected:
                assert connected.wait("hello")["title"] == "new.script"
                assert connected.wait("file")["is_new"] is True
                connected.send("program", version=1, text=MOVE)
                ended = connected.wait("run_ended")
                assert (ended["state"], ended["moment"]["t"] > 1.0) == ("finished", True)
                state = connected.ask("seek", run=ended["run"], t=0.5)
                assert state["moment"]["line"] == 2
                labels = [hint["label"] for hint in connected.service("hints", 1, line=2, column=1)]
                assert any(label.endswith(" s") for label in labels), labels
                refused = connected.ask("control", action="power_on")
                assert refused["text"] == "a live run has no controller: start the studio with --connect"
                started.send_signal(signal.SIGINT if sys.platform != "win32" else signal.SIGTERM)
                assert started.wait(WAIT_S) == 0

    @pytest.mark.skipif(sys.platform == "win32", reason="there are no terminals that hang up")
    def test_a_terminal_that_is_closed_ends_it_like_any_other_end(self, tmp_path: Path) -> None:
        (tmp_path / "cell.script").write_text("old")
        # Under `nohup` it is ignored, and programs that are started inherit that.
        before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
        try:
            with process(tmp_path / "cell.script", state=tmp_path / "state") as (started, _):
                started.send_signal(signal.SIGHUP)
                assert started.wait(WAIT_S) == 0
        finally:
            signal.signal(signal.SIGHUP, before)

    def test_a_text_outlives_the_process(self, tmp_path: Path) -> None:
        path = tmp_path / "cell.script"
        path.write_text("old\n")
        memory = Memory(tmp_path / "state" / "elitescript" / "studio")
        with process(path, state=tmp_path / "state") as (started, address), Page(address) as connected:
            connected.wait("file")
            connected.send("program", version=1, text="never saved\n")
            end = monotonic() + WAIT_S
            while not memory.drafts(path) and monotonic() < end:
                sleep(0.02)
            started.kill()
            started.wait()
        (draft,) = memory.drafts(path)
        assert draft.text == "never saved\n"
        assert path.read_text() == "old\n"


def test_the_command_imports_only_what_it_needs() -> None:
    """`elitescript` itself must not know of the studio: it is part of the start of every command."""
    code = "import sys, elitescript.cli.studio; print(sorted({name.split('.')[0] for name in sys.modules}))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert not {"'websockets'", "'asyncio'", "'ssl'"} & set(found.strip("[]\n").split(", "))
