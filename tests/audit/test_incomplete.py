"""Recordings that begin or end within the program, and the world and arm that a recording holds."""

from __future__ import annotations

import json
from functools import cache

import pytest

from elitescript.audit import audit
from elitescript.cli.main import main
from elitescript.errors import UsageError
from elitescript.recorder.recording import Recording
from elitescript.records import replace
from elitescript.testing.world import Wire, World
from tests.audit.programs import GRIPPER, LOOP, MOVES
from tests.audit.recording_runs import record_run

WIRE = """[[wire]]
when = "standard_digital_out[0]"
then = "standard_digital_in[2]"
after_s = 0.2
"""
ARM = """base = "CS66"
[arm]
d6 = 0.095
"""


@cache
def undisturbed(program: str) -> Recording:
    return record_run(program)


@cache
def cut(program: str, until_s: float) -> Recording:
    return record_run(program, until_s=until_s)


def rows_of(recording: Recording, rows: slice) -> Recording:
    return replace(
        recording,
        t=recording.t[rows],
        arrived_s=recording.arrived_s[rows],
        columns={name: values[rows] for name, values in recording.columns.items()},
    )


class TestEnds:
    def test_a_recording_that_ends_before_its_program_says_so_first(self):
        found = audit(cut(LOOP, 0.6), LOOP)
        lines = str(found).splitlines()
        assert lines[1].startswith("the recording ends at 0.596 s, in line 4, before the program does: nothing from")
        assert lines[2] == "agrees as far as it is recorded: target joints, times and signals"
        assert (found.agrees, found.is_complete) == (True, False)
        data = found.json()
        assert data["complete"] is False
        assert data["ends"] == {"run": 1, "t": 0.596, "line": 4, "controller_s": pytest.approx(0.656, abs=0.01)}
        assert data["begins"] is None
        assert data["runs"][0]["complete"] is False

    @pytest.mark.parametrize("until_s", [0.3, 0.6, 0.9, 1.2])
    def test_what_the_simulated_run_does_behind_the_end_is_not_counted(self, until_s):
        found = audit(cut(LOOP, until_s), LOOP)
        for line in found.first.comparison.lines:
            assert line.recorded_passes == line.simulated_passes, line
            assert line.simulated_s == pytest.approx(line.recorded_s, abs=0.009)
        assert found.json()["simulated_s"] == pytest.approx(found.json()["recorded_s"], abs=0.009)

    def test_a_whole_recording_is_complete(self):
        found = audit(undisturbed(LOOP), LOOP)
        assert found.is_complete
        assert (found.json()["complete"], found.json()["ends"], found.json()["begins"]) == (True, None, None)
        assert "ends at" not in str(found)

    def test_a_difference_before_the_end_is_still_one(self):
        found = audit(record_run(MOVES.replace("v=0.8", "v=0.4"), until_s=1.3), MOVES)
        assert not found.agrees
        lines = str(found).splitlines()
        assert lines[1].startswith("the recording ends at 1.296 s")
        assert lines[2].startswith("differs from")

    def test_a_recording_that_begins_within_its_program_says_so_first(self):
        whole = undisturbed(LOOP)
        found = audit(rows_of(whole, slice(120, None)), LOOP)
        assert str(found).splitlines()[1].startswith("the program ran already when the recording began, in line ")
        assert (found.is_complete, found.ends) == (False, None)
        assert found.json()["begins"]["t"] == 0.0

    @pytest.mark.parametrize("first", [30, 120, 300])
    def test_what_the_simulated_run_does_before_the_begin_is_not_counted(self, first):
        whole = undisturbed(LOOP)
        found = audit(rows_of(whole, slice(first, None)), LOOP)
        assert found.agrees
        for line in found.first.comparison.lines:
            assert line.recorded_passes == line.simulated_passes, line
            assert line.simulated_s == pytest.approx(line.recorded_s, abs=0.009)
        assert found.json()["simulated_s"] == pytest.approx(found.json()["recorded_s"], abs=0.009)

    def test_without_a_state_the_line_says_whether_the_program_goes_on(self):
        whole = undisturbed(LOOP)
        whole = replace(whole, columns={name: its for name, its in whole.columns.items() if name != "runtime_state"})
        assert audit(whole, LOOP).ends is None
        assert audit(rows_of(whole, slice(0, 150)), LOOP).ends is not None

    def test_the_run_that_is_cut_is_named(self):
        first, second = undisturbed(LOOP), cut(LOOP, 0.6)
        shift_s = first.t[-1] + 1.0 - second.t[0]
        both = replace(
            first,
            t=first.t + type(first.t)("d", [t + shift_s for t in second.t]),
            arrived_s=first.arrived_s + second.arrived_s,
            columns={name: values + second.columns[name] for name, values in first.columns.items()},
        )
        found = audit(both, LOOP)
        assert "in line 4, before the program of run 2 does" in str(found).splitlines()[1]
        assert found.json()["ends"]["run"] == 2
        assert audit(both, LOOP, run=1).is_complete

    def test_a_controller_that_begins_anew_ends_its_run(self):
        first, second = cut(LOOP, 0.6), undisturbed(LOOP)
        both = replace(
            first,
            t=first.t + second.t,
            arrived_s=first.arrived_s + second.arrived_s,
            columns={name: values + second.columns[name] for name, values in first.columns.items()},
            restarts=(len(first.t),),
        )
        found = audit(both, LOOP)
        assert found.json()["ends"]["run"] == 1


class TestCommand:
    @pytest.fixture
    def folder(self, tmp_path, monkeypatch):
        pytest.importorskip("mcap")
        monkeypatch.chdir(tmp_path)
        return tmp_path

    def test_exit_code_and_json(self, folder, capsys):
        from elitescript.recorder.writing import write_recording

        recording = replace(cut(LOOP, 0.6), attachments={"loop.script": LOOP.encode()})
        write_recording(folder / "part.mcap", recording)
        assert main(["audit", "part.mcap"]) == 1
        assert capsys.readouterr().out.splitlines()[1].startswith("the recording ends at 0.596 s, in line 4")
        assert main(["audit", "part.mcap", "--partial"]) == 0
        capsys.readouterr()
        assert main(["audit", "part.mcap", "--json"]) == 1
        data = json.loads(capsys.readouterr().out)
        assert (data["agrees"], data["complete"], data["ends"]["line"]) == (True, False, 4)
        # A difference stays one.
        (folder / "other.script").write_text(
            LOOP.replace(
                "v=1.5)\n    set_standard_digital_out(4, True)", "v=0.5)\n    set_standard_digital_out(4, True)"
            )
        )
        assert main(["audit", "part.mcap", "--partial", "--program", "other.script"]) == 1

    def test_a_file_that_was_cut_off(self, folder, capsys):
        from elitescript.recorder.mcap_file import _DATA_END, _records, read_recording
        from elitescript.recorder.writing import write_recording

        recording = replace(undisturbed(LOOP), attachments={"loop.script": LOOP.encode()})
        write_recording(folder / "whole.mcap", recording)
        assert not read_recording("whole.mcap").is_cut_off
        assert main(["audit", "whole.mcap"]) == 0
        data = (folder / "whole.mcap").read_bytes()
        with (folder / "whole.mcap").open("rb") as file:
            end = next(at for at, code, _ in _records(file, folder / "whole.mcap") if code == _DATA_END)
        # All rows are there, and not the mark behind them.
        (folder / "killed.mcap").write_bytes(data[:end])
        assert read_recording("killed.mcap").is_cut_off
        capsys.readouterr()
        # The run is whole, but another one may have been behind it.
        assert main(["audit", "killed.mcap"]) == 1
        text = capsys.readouterr().out.splitlines()
        assert text[1].startswith("the file of the recording is cut off")
        assert text[2] == "agrees as far as it is recorded: target joints, times and signals"
        assert main(["audit", "killed.mcap", "--partial"]) == 0
        capsys.readouterr()
        assert main(["audit", "killed.mcap", "--json"]) == 1
        found = json.loads(capsys.readouterr().out)
        assert (found["agrees"], found["complete"], found["ends"]["run"]) == (True, False, 1)
        assert found["ends"]["t"] == found["recorded_s"]
        (folder / "short.mcap").write_bytes(data[:300])
        assert main(["audit", "short.mcap"]) == 2
        assert "the recording has no rows: its file is cut off before the first" in capsys.readouterr().err


class TestKept:
    def test_the_world_of_the_recording_is_used(self):
        wired = World(wires=[Wire(when="standard_digital_out[0]", then="standard_digital_in[2]", after_s=0.2)])
        kept = {"facts": {"world": "cell.toml"}, "attachments": {"cell.toml": WIRE.encode()}}
        good = record_run(GRIPPER, world=wired)
        found = audit(replace(good, facts={**good.facts, **kept["facts"]}, attachments=kept["attachments"]), GRIPPER)
        assert found.agrees
        assert found.taken == ("cell.toml",)
        assert str(found).splitlines()[1] == "with cell.toml of the recording"
        # Its wire sets the input, not the recording: an input that sticks is seen.
        stuck = record_run(GRIPPER, until_s=1.5)
        found = audit(replace(stuck, facts={**stuck.facts, **kept["facts"]}, attachments=kept["attachments"]), GRIPPER)
        assert "standard_digital_in[2] becomes on in the simulated run only" in str(found)

    def test_a_world_that_cannot_be_used_is_said_first(self):
        good = undisturbed(LOOP)
        for text, words in (
            ('[[device]]\nname = "lamp"\npython = "lamp.py:Lamp"\n', "cell.toml"),
            ("[[wire]\n", "the world file is not TOML"),
            (None, "cell.toml, which the recorder was given, is not in the recording"),
        ):
            attachments = {} if text is None else {"cell.toml": text.encode()}
            found = audit(replace(good, facts={**good.facts, "world": "cell.toml"}, attachments=attachments), LOOP)
            assert words in str(found).splitlines()[1]
            assert len(found.not_taken) == 1
            assert found.json()["not_taken"] == list(found.not_taken)
            assert found.agrees

    def test_the_arm_of_the_recording_is_used_with_a_world_too(self, tmp_path):
        arm = tmp_path / "my_arm.toml"
        arm.write_text(ARM)
        cell = tmp_path / "cell.toml"
        recorded = record_run(MOVES, model=str(arm))
        recorded = replace(
            recorded, facts={**recorded.facts, "robot": "my_arm.toml"}, attachments={"my_arm.toml": ARM.encode()}
        )
        for text in ("", '[robot]\nmodel = "CS66"\n'):
            cell.write_text(text)
            found = audit(recorded, MOVES, world=cell)
            assert found.agrees
            assert found.taken == ("my_arm.toml",)
        # With both of the recording, where the world names the arm.
        both = {"cell.toml": b'[robot]\nmodel = "my_arm.toml"\n', "my_arm.toml": ARM.encode()}
        found = audit(replace(recorded, facts={**recorded.facts, "world": "cell.toml"}, attachments=both), MOVES)
        assert found.agrees
        assert found.taken == ("my_arm.toml", "cell.toml")
        # An arm file of the given world goes before, which is said first.
        (tmp_path / "other_arm.toml").write_text('base = "CS66"\n')
        cell.write_text('[robot]\nmodel = "other_arm.toml"\n')
        found = audit(recorded, MOVES, world=cell)
        assert (
            "the arm file my_arm.toml of the recording: the world file names other_arm.toml"
            in str(found).splitlines()[1]
        )

    def test_an_arm_that_is_not_known_is_said_first(self):
        found = audit(replace(record_run(MOVES), facts={"model": "CS1000"}), MOVES)
        assert str(found).splitlines()[1].startswith("the arm of the recording is not simulated: ")

    def test_a_model_that_the_recorder_was_given_by_name(self):
        recorded = record_run(MOVES, model="CS63")
        found = audit(replace(recorded, facts={"robot": "CS63"}), MOVES)
        assert found.model.name == "CS63"

    def test_a_damaged_arm_file_is_refused(self):
        recorded = replace(record_run(MOVES), attachments={"my_arm.toml": b'base = "CS66"\nnothing = 1\n'})
        with pytest.raises(UsageError, match=r"my_arm\.toml"):
            audit(recorded, MOVES)
