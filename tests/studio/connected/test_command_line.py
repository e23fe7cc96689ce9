"""`studio --connect` and `serve --studio`, as processes."""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from elitescript import page
from elitescript.cli.main import main
from elitescript.cli.serve import ServeLog
from elitescript.errors import UsageError
from elitescript.studio.connected import target
from elitescript.studio.connected.target import find_target
from tests.studio.page_client import ROOT, WAIT_S, Page

needs_page = pytest.mark.skipif(not page.is_built(), reason="the page is not built: make studio")


class TestTarget:
    def test_the_ports_of_a_controller(self, monkeypatch, tmp_path: Path) -> None:
        monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
        found = find_target("192.168.1.20")
        assert [found.ports[name] for name in ("primary", "rtsi", "dashboard")] == [30001, 30004, 29999]
        assert (found.may_control, found.control_socket) == (False, None)
        assert find_target("localhost", instance=2).ports["rtsi"] == 30204

    @pytest.mark.parametrize(
        ("host", "number", "place"),
        [
            ("127.0.0.11", 0, "serve-0.sock"),
            ("127.0.0.12", 0, "serve-1.sock"),
            ("127.0.0.1", 0, None),
            ("127.0.0.1", 2, "serve-2.sock"),
            ("localhost", 2, "serve-2.sock"),
            ("127.0.0.3", 4, "serve-4.sock"),
        ],
    )
    def test_robots_at_an_address_each_are_told_apart(self, monkeypatch, host, number, place) -> None:
        served = {
            "serve-0.sock": ("127.0.0.11", 0),
            "serve-1.sock": ("127.0.0.12", 0),
            "serve-2.sock": ("127.0.0.1", 2),
            "serve-4.sock": ("0.0.0.0", 4),
        }

        async def exchange(path: Path, verb: str):
            at, instance = served[path.name]
            numbers = {"primary": 30001, "rtsi": 30004, "dashboard": 29999}
            rows = {name: {"host": at, "port": port + 100 * instance} for name, port in numbers.items()}
            return {"ok": True, "result": rows | {"script_sockets": {"clients": 0}}}

        def asked(path: Path, verb: str):
            if path.name not in served:
                raise UsageError("no controller is served here")
            return exchange(path, verb)

        monkeypatch.setattr(target, "exchange", asked)
        monkeypatch.setattr(target, "address_of", lambda instance: Path(f"/run/serve-{instance}.sock"))
        monkeypatch.setattr(target, "addresses", lambda: [Path("/run") / name for name in served])
        found = find_target(host, instance=number)
        assert found.control_socket == (Path("/run") / place if place else None)
        assert found.ports["rtsi"] == 30004 + 100 * number

    @pytest.mark.parametrize(
        ("host", "options", "text"),
        [
            ("", {}, "a name or an address is needed"),
            ("http://robot/", {}, "a name or an address is needed"),
            ("robot", {"instance": -1}, "an instance is a number"),
            ("robot", {"jog_register": 43}, "from 0 to 42"),
            ("127.0.0.1", {"socket": Path("/no/serve.sock")}, "no controller is served here"),
        ],
    )
    def test_what_makes_no_sense(self, monkeypatch, tmp_path: Path, host: str, options, text: str) -> None:
        monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
        with pytest.raises(UsageError, match=text):
            find_target(host, **options)

    def test_options_that_need_a_controller(self, capsys, monkeypatch, tmp_path: Path) -> None:
        monkeypatch.setattr(page, "is_built", lambda: True)
        for options in (["--control"], ["--instance", "1"], ["--socket", "x"], ["--jog-register", "3"]):
            assert main(["studio", "--no-browser", str(tmp_path), *options]) == 2
            assert f"{options[0]} goes with --connect" in capsys.readouterr().err


class TestServeStudio:
    def test_without_the_built_page_it_says_what_to_do(self, capsys, monkeypatch, tmp_path: Path) -> None:
        monkeypatch.setattr(page, "_BUILT", tmp_path)
        assert main(["serve", "--port", "all=0", "--studio"]) == 2
        assert "run `make studio`" in capsys.readouterr().err

    @needs_page
    def test_both_are_ready_and_end_together(self, tmp_path: Path) -> None:
        environment = {
            "PYTHONPATH": str(ROOT / "src"),
            "XDG_RUNTIME_DIR": str(tmp_path),
            "XDG_STATE_HOME": str(tmp_path),
        }
        served = subprocess.Popen(
            [sys.executable, "-m", "elitescript", "serve", "--port", "all=0", "--power-on", "--json", "--studio"],
            env={**os.environ, **environment},
            cwd=tmp_path,
            stdout=subprocess.PIPE,
            text=True,
        )
        try:
            assert served.stdout is not None
            records = (json.loads(line) for line in served.stdout)
            robots = next(record for record in records if record["type"] == "ready")["robots"]
            studio = next(record for record in records if record["type"] == "studio")
            assert studio["robot"] == "CS66"
            with Page(studio["address"]) as shown:
                hello = shown.wait("hello")
                assert hello["mode"] == "connected"
                assert f"127.0.0.1:{robots[0]['ports']['primary']}" in hello["title"]
                assert {"live", "control", "signals", "faults", "edit"} <= set(hello["abilities"])
                moment = shown.wait("moment", lambda message: message["controller"]["link"] == "connected")
                assert moment["controller"]["address"] == f"127.0.0.1:{robots[0]['ports']['primary']}"
                kinds = [message["type"] for message in shown.messages if isinstance(message, dict)]
                assert "scene" in kinds or shown.wait("scene")
            served.send_signal(signal.SIGTERM)
            assert served.wait(WAIT_S) == 0
            assert json.loads(served.stdout.read().splitlines()[-1]) == {"type": "stopped"}
        finally:
            served.kill()
            served.wait()
            assert served.stdout is not None
            served.stdout.close()
        with pytest.raises(OSError), Page(studio["address"]):
            pass

    @pytest.mark.parametrize(("names", "end"), [(["CS66"], ""), (["CS66-1", "CS66-2"], " CS66-2")])
    def test_of_several_robots_the_page_has_a_name(self, names: list[str], end: str) -> None:
        out = io.StringIO()
        ServeLog(out, out, names, is_json=False).studio(names[-1], "ready http://127.0.0.1:8080/?token=t")
        assert out.getvalue() == f"ready http://127.0.0.1:8080/?token=t{end}\n"

    @needs_page
    def test_a_studio_ends_with_its_input(self, tmp_path: Path) -> None:
        environment = {
            "PYTHONPATH": str(ROOT / "src"),
            "XDG_RUNTIME_DIR": str(tmp_path),
            "XDG_STATE_HOME": str(tmp_path),
        }
        words = ["studio", str(tmp_path), "--no-browser", "--connect", "127.0.0.1", "--ends-with-input"]
        ended = subprocess.run(
            [sys.executable, "-m", "elitescript", *words],
            env={**os.environ, **environment},
            input="",
            capture_output=True,
            text=True,
            timeout=WAIT_S,
            check=False,
        )
        assert (ended.returncode, ended.stderr) == (0, "")
