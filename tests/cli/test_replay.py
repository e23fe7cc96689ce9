import json

import pytest

from elitescript.cli.main import main
from elitescript.kernel import KernelConfig
from elitescript.messages.inputs import Do, RunUnit
from elitescript.messages.machine import WriteSignal
from elitescript.services.journal import Journal
from elitescript.services.replay import RecordedRobot
from elitescript.worlds.memory import MemoryFiles


@pytest.fixture
def journal(tmp_path):
    path = tmp_path / "a.journal"
    writer = Journal(path, KernelConfig(power_on=True))
    robot = RecordedRobot(KernelConfig(power_on=True), MemoryFiles({}), writer)
    robot.tick([RunUnit("primary#1", "program", "def p():\n  textmsg('hello')\n  sleep(0.1)\n  textmsg('again')\n")])
    for tick in range(1, 300):
        robot.tick([Do("ctl", WriteSignal("flag", 1, True))] if tick == 260 else ())
    writer.close()
    return path


class TestReplay:
    def test_prints_what_the_session_printed_and_that_it_is_the_same(self, journal, capsys):
        assert main(["replay", str(journal)]) == 0
        out = capsys.readouterr().out
        assert out.index("hello") < out.index("again") < out.index("300 ticks checked, all the same")

    def test_json(self, journal, capsys):
        assert main(["replay", str(journal), "--json", "--until", "0.05"]) == 0
        records = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
        assert [record["type"] for record in records] == ["log", "end"]
        assert records[-1]["state"] == "same"

    def test_says_where_it_differs(self, journal, capsys):
        journal.write_text(journal.read_text().replace('"flag",1,true', '"flag",2,true'))
        assert main(["replay", str(journal)]) == 1
        assert "tick 260" in capsys.readouterr().err
        assert main(["replay", str(journal), "--json"]) == 1
        assert json.loads(capsys.readouterr().out.splitlines()[-1])["first_difference"] == 260

    def test_writes_a_trace(self, journal, tmp_path):
        trace = tmp_path / "t.csv"
        assert main(["replay", str(journal), "--trace", str(trace)]) == 0
        lines = trace.read_text().splitlines()
        assert lines[0].startswith("t,line,q1")
        assert len(lines) == 301

    def test_says_that_another_python_wrote_it(self, journal, capsys):
        text = journal.read_text()
        at = text.index('"python":"') + 10
        journal.write_text(text[:at] + "2.7.1" + text[text.index('"', at) :])
        assert main(["replay", str(journal)]) == 0
        assert "Python 2.7.1" in capsys.readouterr().err

    def test_refuses_what_is_no_journal(self, tmp_path, capsys):
        path = tmp_path / "x"
        path.write_text("x")
        assert main(["replay", str(path)]) == 2
        assert "no journal" in capsys.readouterr().err
