"""Sessions on disk: what is written, what a broken file gives, and whether they come out the same again."""

import json
import time
from pathlib import Path

import pytest

from elitescript.cli.main import main
from elitescript.environment.memory import MemoryFiles
from elitescript.errors import UsageError
from elitescript.kernel import RobotOptions
from elitescript.messages.events import Warned
from elitescript.messages.inputs import Do, LoadTask, PlayTask, RunUnit
from elitescript.messages.machine import WritePortCoils, WritePortRegisters, WriteSignal
from elitescript.messages.plant import PlantConfig
from elitescript.said import said
from elitescript.services.journal.replay import RecordedRobot, Replay
from elitescript.services.journal.writer import DIGEST_TICKS, Journal, JournalReader

CONFIG = RobotOptions(
    power_on=True, plant=PlantConfig(noise_rad=1e-5), signals=(("flag[3]", True), ("general_register[9]", 9))
)
PROGRAM = (
    'textmsg(random())\nmovej([0.1, -1.4, -1.6, -1.5, 1.5, 0.2])\nwith open("log.txt", "w") as f:\n  f.write("x")\n'
)
TICKS = 2 * DIGEST_TICKS + 40


@pytest.fixture
def recorded(tmp_path):
    """A session: a task of the task folder, a program from a client, signals."""
    path = tmp_path / "a.journal"
    journal = Journal(path, CONFIG)
    files = MemoryFiles({"job.task": b"", "job.script": PROGRAM.encode(), "points.txt": b"1 2 3"})
    robot = RecordedRobot(CONFIG, files, journal)
    inputs = {
        2: [LoadTask("dashboard#1", "job.task"), PlayTask("dashboard#1")],
        300: [Do("rtsi#1", WriteSignal("input_float_register", 0, 0.1))],
        310: [Do("modbus#1/1", WritePortRegisters(256, (1, 2), 256, 2), is_answered=True)],
        320: [Do("modbus#1/2", WritePortCoils(33, (True,)), is_answered=True)],
        400: [RunUnit("primary#1", "secondary", 'sec s():\n  textmsg(open("points.txt").read())\nend\n')],
    }
    outputs = [robot.tick(inputs.get(tick, ())).with_snapshot(robot.snapshot()) for tick in range(TICKS)]
    journal.close()
    return path, outputs


def last_tick_in(data):
    """Of the lines that are whole."""
    records = [json.loads(line) for line in data.split(b"\n")[:-1]]
    return max([-1, *(record[key] for record in records for key in ("tick", "digest") if key in record)])


def lines_of(path):
    return path.read_text().splitlines(keepends=True)


def replayed(path, until=None):
    reader = JournalReader(path)
    session = Replay(reader, until)
    return session, list(session.outputs()), reader


class TestReplay:
    def test_gives_the_same_without_the_files(self, recorded):
        path, outputs = recorded
        session, played, reader = replayed(path)
        assert played == outputs
        assert session.difference is None
        assert session.checked_ticks == TICKS
        assert reader.note == ""

    def test_ends_where_it_is_told(self, recorded):
        path, outputs = recorded
        session, played, _ = replayed(path, until=310)
        assert played == outputs[:311]
        assert session.checked_ticks == DIGEST_TICKS
        assert session.difference is None

    def test_names_the_first_tick_that_differs(self, recorded):
        path, _ = recorded
        changed = path.read_text().replace('"input_float_register",0,0.1', '"input_float_register",0,0.2')
        assert changed != path.read_text()
        path.write_text(changed)
        session, _, _ = replayed(path)
        assert session.difference is not None
        assert session.difference.tick == 300
        assert session.checked_ticks == DIGEST_TICKS

    def test_another_configuration_differs_at_once(self, recorded):
        path, _ = recorded
        path.write_text(path.read_text().replace('"flag[3]"', '"flag[4]"', 1))
        assert replayed(path)[0].difference.tick == 0

    def test_a_missing_answer_about_files_is_told(self, recorded):
        path, _ = recorded
        records = [json.loads(line) for line in lines_of(path)]
        for record in records:
            record.pop("asked", None)
        path.write_text("".join(json.dumps(record) + "\n" for record in records))
        with pytest.raises(UsageError, match="no answer"):
            replayed(path)


class TestKilled:
    def test_whatever_is_left_of_the_file_can_be_played(self, recorded):
        path, outputs = recorded
        whole = path.read_bytes()
        first = whole.index(b"\n") + 1
        for size in {first, first + 1, len(whole) // 2, len(whole) - 2, len(whole) - 20, len(whole)}:
            path.write_bytes(whole[:size])
            session, played, reader = replayed(path)
            assert session.difference is None
            assert played == outputs[: len(played)]
            assert len(played) >= max(0, last_tick_in(whole[:size]) + 1)
            assert bool(reader.note) == (size < len(whole))
            if reader.note:
                assert f"cut off behind tick {last_tick_in(whole[:size])}:" in reader.note

    def test_a_file_without_its_end_says_where_it_was_cut(self, recorded, capsys):
        path, outputs = recorded
        path.write_text("".join(lines_of(path)[:-1]))
        _, played, reader = replayed(path)
        assert played == outputs
        assert reader.note == f"the journal was cut off behind tick {TICKS - 1}: it has no end mark"
        assert main(["replay", str(path)]) == 0
        assert f"cut off behind tick {TICKS - 1}" in capsys.readouterr().err

    def test_lines_are_written_while_the_session_goes_on(self, tmp_path):
        path = tmp_path / "a.journal"
        journal = Journal(path, CONFIG)
        robot = RecordedRobot(CONFIG, MemoryFiles({}), journal)
        robot.tick([Do("a", WriteSignal("flag", 0, True))])
        while len(lines_of(path)) < 2:
            time.sleep(0.001)
        assert [json.loads(line).get("tick") for line in lines_of(path)] == [None, 0]
        journal.close()


class TestJournal:
    def test_quiet_ticks_have_no_line(self, recorded):
        path, _ = recorded
        kinds = [next(iter(json.loads(line))) for line in lines_of(path)]
        assert kinds.count("digest") == 3
        assert kinds[0] == "journal"
        assert kinds[-1] == "end"
        assert len(lines_of(path)) < 20

    @pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full")
    def test_a_full_disk_ends_the_journal_and_not_the_session(self):
        journal = Journal(Path("/dev/full"), CONFIG)
        robot = RecordedRobot(CONFIG, MemoryFiles({}), journal)
        for tick in range(3):
            assert robot.tick([Do("a", WriteSignal("flag", 0, True))]).tick == tick
        journal._file._thread.join(10.0)
        assert "space" in journal.failure
        assert [event.text for event in journal.take_warning(3)] == [
            "the journal ends here, it cannot be written: No space left on device"
        ]
        assert journal.take_warning(4) == ()
        journal.close()

    def test_texts_that_were_told_keep_their_parts(self, tmp_path):
        path = tmp_path / "told.journal"
        journal = Journal(path, CONFIG)
        journal.told(0, [Warned(0, said("{n} times", n=3)), Warned(0, "so")])
        journal.told(1, [Warned(1, "so")])
        journal.close()
        first, second = (json.loads(line) for line in lines_of(path) if '"told"' in line)
        assert first["events"][0][2] == "3 times"
        assert first["said"][0][2] == ["said", "3 times", "{n} times", {"n": 3}]
        assert "said" not in second

    def test_a_place_that_cannot_be_written_is_told(self, tmp_path):
        with pytest.raises(UsageError, match="--journal"):
            Journal(tmp_path / "none" / "a.journal", CONFIG)


class TestJournalReader:
    @pytest.mark.parametrize(
        "text",
        [
            *("", "x\n", "[]\n", "{}\n", '{"journal":2}\n', '{"journal":2,"config":[1]}\n', '{"journal":3}\n'),
            *(f'{{"journal":3,"options":{options}}}\n' for options in ("[1]", '{"spee":1.0}', '{"speed":"fast"}')),
            '{"journal":3,"options":{"speed":2.0}}\n',
        ],
    )
    def test_refuses_what_is_no_journal(self, tmp_path, text):
        path = tmp_path / "a.journal"
        path.write_text(text)
        with pytest.raises(UsageError):
            JournalReader(path)

    def test_refuses_another_format(self, tmp_path):
        path = tmp_path / "a.journal"
        path.write_text('{"journal":1,"version":"0.1.2","config":[]}\n')
        with pytest.raises(
            UsageError, match=r"line 1: a journal of format 1, written by elitescript 0\.1\.2; 2 to 4 are known"
        ):
            JournalReader(path)

    def test_names_a_line_in_the_middle_that_is_none(self, recorded):
        path, _ = recorded
        lines = lines_of(path)
        path.write_text("".join([lines[0], '{"tick":0,"in":[["Nonsense"]]}\n', *lines[1:]]))
        with pytest.raises(UsageError, match=r"line 2.*Nonsense"):
            replayed(path)


def test_a_journal_that_is_there_is_not_overwritten(tmp_path):
    path = tmp_path / "session.journal"
    path.write_text("precious")
    with pytest.raises(UsageError, match="the file exists"):
        Journal(path, RobotOptions())
    assert path.read_text() == "precious"
