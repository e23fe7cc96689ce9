"""Files of a recording that others move, remove or truncate while they are written."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

from elitescript.paths import CHANGED, MOVED, REMOVED, what_became_of
from elitescript.recorder.channels import EVENTS
from elitescript.recorder.mcap_file import read_recording
from elitescript.recorder.sinks import StorageError
from elitescript.recorder.storing import McapSink
from tests.recorder.controller import FakeController, ticks
from tests.recorder.test_session import record

pytest.importorskip("mcap")


class Disturbed(McapSink):
    """Has something done to its files at some rows, and looks after each of them."""

    def __init__(self, path: Path, acts: dict) -> None:
        self.said: list[str] = []
        super().__init__(path, {}, say=self.said.append)
        self._acts = acts

    def row(self, t, flat, arrived_ns) -> None:
        super().row(t, flat, arrived_ns)
        if act := self._acts.get(self.rows):
            # What was written until here is on the disk.
            self.tick(arrived_ns)
            act()
        if self.rows % 10 == 5:
            self.tick(arrived_ns)


def recorded(path: Path, acts: dict) -> Disturbed:
    sink = Disturbed(path, acts)
    record(FakeController(ticks(1.0, 100)), sink, 100)
    sink.close()
    return sink


def test_a_file_that_is_moved_goes_on_where_it_is(tmp_path):
    path, other = tmp_path / "run.mcap", tmp_path / "other.mcap"
    sink = recorded(path, {20: lambda: path.rename(other)})
    assert sink.losses == []
    assert sink.said == [f"{path} was moved while it was written; it goes on where it is"]
    assert list(read_recording(other).t) == ticks(1.0, 100)
    assert sink.size == other.stat().st_size


def test_a_file_that_is_removed_is_said_and_a_further_one_goes_on(tmp_path):
    path = tmp_path / "run.mcap"
    sink = recorded(path, {20: path.unlink})
    assert sink.losses == [f"{path} was removed: its 25 rows are lost"]
    assert (sink.rows, sink.rows_lost) == (100, 25)
    assert sink.said == [f"{sink.losses[0]}; {tmp_path / 'run.0001.mcap'} goes on"]
    assert list(read_recording(tmp_path / "run.0001.mcap").t) == ticks(1.1, 75)


@pytest.mark.parametrize("size", [0, 10, 3000])
def test_a_file_that_is_truncated_is_said_and_a_further_one_goes_on(size, tmp_path):
    path = tmp_path / "run.mcap"
    sink = recorded(path, {40: lambda: os.truncate(path, size)})
    assert len(sink.losses) == 1
    words = "was truncated, or another process has written to it: its 45 rows are lost, but for what can be read of it"
    assert sink.losses[0] == f"{path} {words}"
    assert list(read_recording(tmp_path / "run.0001.mcap").t) == ticks(1.18, 55)


def test_a_file_that_is_replaced_by_another_one_is_lost(tmp_path):
    path = tmp_path / "run.mcap"

    def replace() -> None:
        (tmp_path / "new").write_bytes(b"mine")
        (tmp_path / "new").replace(path)

    sink = recorded(path, {20: replace})
    assert len(sink.losses) == 1
    assert path.read_bytes() == b"mine"


def test_a_loss_just_before_the_end_is_said(tmp_path):
    path = tmp_path / "run.mcap"
    sink = recorded(path, {100: path.unlink})
    assert sink.losses == [f"{path} was removed: its 100 rows are lost"]


def test_it_ends_when_files_are_removed_again_and_again(tmp_path):
    acts = {20 * number: lambda number=number: next(tmp_path.glob("*.mcap")).unlink() for number in (1, 2, 3, 4)}
    with pytest.raises(StorageError, match="so it was 3 times, and nothing more is recorded"):
        recorded(tmp_path / "run.mcap", acts)


def test_a_folder_that_is_removed_ends_the_recording(tmp_path):
    folder = tmp_path / "runs"
    folder.mkdir()
    with pytest.raises(StorageError, match=r"a further file cannot be begun: .* there is no folder"):
        recorded(folder / "run.mcap", {20: lambda: shutil.rmtree(folder)})


def test_what_became_of_a_file(tmp_path):
    path = tmp_path / "a"
    with path.open("ab", buffering=0) as file:
        file.write(b"1234")
        assert what_became_of(path, file.fileno(), 4) == ""
        path.rename(tmp_path / "b")
        assert what_became_of(path, file.fileno(), 4) == MOVED
        path.write_bytes(b"5678")
        assert what_became_of(path, file.fileno(), 4) == MOVED
        (tmp_path / "b").replace(path)
        assert what_became_of(path, file.fileno(), 4) == ""
        os.truncate(path, 0)
        file.write(b"12")
        assert what_became_of(path, file.fileno(), 6) == CHANGED
        path.unlink()
        assert what_became_of(path, file.fileno(), 6) == REMOVED
    with Path(os.devnull).open("wb") as file:
        assert what_became_of(os.devnull, file.fileno(), 4) == ""


def test_a_message_alone_is_kept_too(tmp_path):
    sink = McapSink(tmp_path / "run.mcap", {})
    sink.message(EVENTS, {"type": "lost", "port": "rtsi"}, 1)
    (tmp_path / "run.mcap").unlink()
    sink.tick(2)
    assert sink.losses == [f"{tmp_path / 'run.mcap'} was removed: its 0 rows are lost"]
    sink.close()
