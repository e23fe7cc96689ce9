import json
import sys

import pytest

from elitescript import page
from elitescript.cli import doctor
from elitescript.cli.main import main
from elitescript.services.child.jail import Layer


@pytest.fixture
def layers(monkeypatch):
    """What the child is said to have found."""
    found = [Layer("files", True, "Landlock 7"), Layer("system calls", True, "64 of them")]

    async def probe():
        return tuple(found), ""

    monkeypatch.setattr(doctor, "probe_jail", probe)
    monkeypatch.setattr(doctor, "_is_free", lambda number: number != 30004)
    return found


class TestDoctor:
    def test_says_what_is_there(self, layers, capsys):
        assert main(["doctor"]) == 0
        out = capsys.readouterr().out
        for word in (
            "Python:",
            "greenlet:",
            "active   files:",
            "Landlock 7",
            "in use   30004",
            "free     30001",
            "time:",
            "studio",
            "studio page:",
        ):
            assert word in out, word

    def test_says_what_is_missing_and_why(self, layers, capsys):
        layers[0] = Layer("files", False, "Landlock: Function not implemented")
        assert main(["doctor"]) == 1
        out = capsys.readouterr().out
        assert "MISSING  files:" in out
        assert "not implemented" in out
        assert "trust" in out

    def test_json(self, layers, capsys):
        assert main(["doctor", "--json", "--instance", "2"]) == 0
        record = json.loads(capsys.readouterr().out)
        assert record["is_jailed"] is True
        assert record["jail"]["files"] == {"active": True, "detail": "Landlock 7"}
        assert record["extras"]["studio"] in (True, False)
        assert record["studio_page"] is page.is_built()
        assert record["ports"]["rtsi"] == {"number": 30204, "free": True}

    @pytest.mark.skipif(sys.platform != "linux", reason="the jail needs Linux")
    def test_asks_a_real_child(self, capsys):
        assert main(["doctor", "--json"]) in (0, 1)
        record = json.loads(capsys.readouterr().out)
        assert record["trouble"] == ""
        assert len(record["jail"]) == 5

    def test_a_port_that_this_user_may_not_have_is_replaced_by_its_spare_one(self, layers, monkeypatch, capsys):
        monkeypatch.setattr(doctor, "_is_forbidden", lambda number: number < 1024)
        assert main(["doctor"]) == 0
        assert "free     5020   modbus" in capsys.readouterr().out
