import json
import random

import pytest

from elitescript.cli.main import main
from elitescript.environment.memory import MemoryFiles
from elitescript.kernel import RobotOptions
from elitescript.messages.inputs import Do, RunUnit
from elitescript.messages.machine import WriteSignal
from elitescript.services.journal.replay import RecordedRobot
from elitescript.services.journal.writer import Journal


@pytest.fixture
def journal(tmp_path):
    path = tmp_path / "a.journal"
    writer = Journal(path, RobotOptions(power_on=True))
    robot = RecordedRobot(RobotOptions(power_on=True), MemoryFiles({}), writer)
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

    def test_says_what_has_changed_signals(self, journal, capsys):
        assert main(["replay", str(journal), "--json"]) == 0
        records = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
        assert [record for record in records if record["type"] == "signal"] == [
            {"type": "signal", "t": 1.04, "name": "flag[1]", "value": True, "by": "client", "line": 0}
        ]
        assert main(["replay", str(journal), "--log", "signals"]) == 0
        assert "[signal] flag[1] = True (client)" in capsys.readouterr().out

    def test_writes_signals_into_the_trace(self, journal, tmp_path):
        trace = tmp_path / "t.csv"
        assert main(["replay", str(journal), "--trace", str(trace), "--trace-signals", "flag[1],flag[2]"]) == 0
        lines = trace.read_text().splitlines()
        assert lines[0].endswith(",flag[1],flag[2]")
        assert [line.endswith(",1,0") for line in lines[1:]] == [False] * 260 + [True] * 40

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

    def test_says_where_a_damaged_line_is(self, journal, capsys):
        data = journal.read_bytes()
        lines = data.splitlines(keepends=True)
        damaged = lines[1][:9] + b"#" + lines[1][10:]
        journal.write_bytes(b"".join([lines[0], damaged, *lines[2:]]))
        assert main(["replay", str(journal)]) == 2
        error = capsys.readouterr().err
        assert f"elitescript replay: {journal}: line 2, byte {len(lines[0]) + 9}: no JSON" in error
        assert "Traceback" not in error

    def test_a_configuration_that_no_robot_has_is_named_with_its_line(self, journal, capsys):
        journal.write_text(journal.read_text().replace('"CS66"', '"CS99"', 1))
        assert main(["replay", str(journal)]) == 2
        assert f"{journal}: line 1: " in capsys.readouterr().err

    def test_a_cut_off_header_is_no_journal(self, journal, capsys):
        journal.write_bytes(journal.read_bytes()[:50])
        assert main(["replay", str(journal)]) == 2
        assert "line 1, byte " in capsys.readouterr().err

    def test_no_damage_ends_in_a_traceback(self, journal, capsys):
        data = journal.read_bytes()
        chance = random.Random(4)
        codes = set()
        for _ in range(60):
            changed = bytearray(data)
            for _ in range(chance.randrange(1, 4)):
                at = chance.randrange(len(changed))
                changed[at] = chance.choice(b'0159"[]{},:-e.\xffa \n')
            if chance.random() < 0.3:
                del changed[chance.randrange(len(changed)) :]
            journal.write_bytes(changed)
            codes.add(main(["replay", str(journal), "--until", "1.2"]))
        capsys.readouterr()
        assert codes == {0, 1, 2}
