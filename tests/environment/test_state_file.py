"""The state file: what is kept comes back, and nothing is ever broken or overwritten by mistake."""

from __future__ import annotations

import io
import json
import random
from pathlib import Path
from typing import IO, Any

import pytest

from elitescript.environment.state_file import FORMAT, SIZE_MAX, Disk, StateFile, kept_levels, state_text
from elitescript.errors import UsageError
from elitescript.messages.signals import KEPT, SIGNALS
from elitescript.robot import VirtualRobot
from tests.protocol.snapshots import signal_image

PATH = Path("/disk/state.json")
OLD = signal_image({"flag": {3: True}, "general_register": {0: 700, 127: 65535}})
NEW = signal_image({"general_coil": {67: True}, "output_float_register": {5: -0.1}, "output_int_register": {0: -7}})


class MemoryDisk(Disk):
    """A disk that counts what is written; how a real one is written, `tests/outputs` says."""

    def __init__(self, files: dict[Path, bytes]) -> None:
        self.files = dict(files)
        self.steps: list[str] = []
        self.locked: set[Path] = set()

    def read(self, path: Path, size_max: int) -> bytes:
        if path not in self.files:
            raise FileNotFoundError(2, "No such file or directory")
        return self.files[path][:size_max]

    def put(self, path: Path, data: bytes) -> None:
        self.steps.append("put")
        self.files[path] = data

    def lock(self, path: Path) -> IO[bytes]:
        if path in self.locked:
            raise BlockingIOError
        self.locked.add(path)
        held = io.BytesIO()
        held.close = lambda: self.locked.discard(path)  # type: ignore[method-assign]
        return held


def loaded(files: dict[Path, bytes]) -> dict[str, Any]:
    return StateFile(PATH, MemoryDisk(files)).load()


def content(levels: Any) -> dict[str, Any]:
    signals: dict[str, Any] = json.loads(state_text(levels))["signals"]
    return signals


def test_what_was_saved_is_loaded() -> None:
    disk = MemoryDisk({})
    file = StateFile(PATH, disk)
    assert file.load() == {}
    file.save(OLD)
    assert list(disk.files) == [PATH]
    assert loaded(disk.files) == {"flag[3]": True, "general_register[0]": 700, "general_register[127]": 65535}
    file.save(NEW)
    assert loaded(disk.files) == {
        "output_int_register[0]": -7,
        "output_float_register[5]": -0.1,
        "general_coil[67]": True,
    }
    file.save(signal_image())
    assert loaded(disk.files) == {}


def test_every_kept_point_survives_in_its_kind() -> None:
    chance = random.Random(1)
    values = {
        name: {
            index: {"bool": True, "int": chance.randrange(1, 30000), "float": chance.uniform(-1e9, 1e9)}[row.kind]
            for index in range(row.size)
        }
        for name in KEPT
        for row in [SIGNALS[name]]
    }
    disk = MemoryDisk({})
    StateFile(PATH, disk).save(signal_image(values))
    found = loaded(disk.files)
    assert found == {f"{name}[{index}]": value for name, of_name in values.items() for index, value in of_name.items()}
    assert len(disk.files[PATH]) < SIZE_MAX / 10


def test_what_is_kept_is_what_the_manual_says() -> None:
    assert KEPT == (
        "input_bool_register",
        "input_int_register",
        "input_float_register",
        "output_bool_register",
        "output_int_register",
        "output_float_register",
        "flag",
        "general_register",
        "general_coil",
    )
    assert tuple(kept_levels(signal_image())) == KEPT
    assert content(signal_image({"standard_digital_out": {0: True}, "tool_voltage": {0: 24}})) == {}


def test_nothing_is_written_when_nothing_has_changed() -> None:
    disk = MemoryDisk({})
    file = StateFile(PATH, disk)
    file.load()
    file.save(signal_image())
    assert disk.steps == []
    file.save(OLD)
    steps = len(disk.steps)
    file.save(dict(OLD))
    assert len(disk.steps) == steps


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b"", "it is not JSON"),
        (state_text(OLD).encode()[:-20], "it is not JSON"),
        (b"\xff\xfe", "it is not JSON"),
        (b"[" * 100_000, "it is not JSON"),
        (b"[1, 2]", 'it does not say "format"'),
        (b'{"signals": {}}', 'it does not say "format"'),
        (b"hello = 1\n", "it is not JSON"),
        (b" " * (SIZE_MAX + 1), "it has more than 1000000 bytes"),
        (json.dumps({"format": FORMAT, "version": 2, "signals": {}}).encode(), "it has version 2, and this program"),
        (json.dumps({"format": FORMAT, "version": 1}).encode(), "its `signals` are not a table"),
        (
            json.dumps({"format": FORMAT, "version": 1, "signals": {}, "poses": []}).encode(),
            "it has the unknown key 'poses'",
        ),
        (
            json.dumps({"format": FORMAT, "version": 1, "signals": {"lamp[0]": True}}).encode(),
            "no signal is called 'lamp'",
        ),
        (
            json.dumps({"format": FORMAT, "version": 1, "signals": {"flag[32]": True}}).encode(),
            "flag has indices 0 to 31, not 32",
        ),
        (
            json.dumps({"format": FORMAT, "version": 1, "signals": {"flag[3]": 2}}).encode(),
            "flag[3] takes True or False, not 2",
        ),
        (
            json.dumps({"format": FORMAT, "version": 1, "signals": {"general_register[0]": 65536}}).encode(),
            "general_register[0] must be in [0, 65535], got 65536",
        ),
        (
            json.dumps({"format": FORMAT, "version": 1, "signals": {"standard_digital_out[0]": True}}).encode(),
            "standard_digital_out[0] is not kept",
        ),
    ],
)
def test_a_file_that_is_not_understood_is_refused_and_left_alone(data: bytes, why: str) -> None:
    disk = MemoryDisk({PATH: data})
    file = StateFile(PATH, disk)
    with pytest.raises(UsageError) as caught:
        file.load()
    assert str(caught.value).startswith(f"state file {PATH}: {why}")
    assert "It was left as it is" in str(caught.value)
    with pytest.raises(UsageError):
        StateFile(PATH, disk).save(NEW)
    assert disk.files == {PATH: data}
    assert disk.steps == []


def test_a_file_that_somebody_else_has_changed_is_left_alone() -> None:
    disk = MemoryDisk({PATH: state_text(OLD).encode()})
    file = StateFile(PATH, disk)
    file.load()
    disk.files[PATH] = state_text(NEW).encode()
    with pytest.raises(UsageError, match="somebody else has changed it; it was left as it is"):
        file.save(signal_image())
    assert disk.files[PATH] == state_text(NEW).encode()


def test_a_file_in_use_is_refused() -> None:
    disk = MemoryDisk({})
    first, second = StateFile(PATH, disk), StateFile(PATH, disk)
    first.hold()
    for use in (second.hold, second.load, lambda: second.save(NEW)):
        with pytest.raises(UsageError, match="another `elitescript` uses it"):
            use()
    first.save(OLD)
    first.release()
    assert second.load() == content(OLD)


def test_a_real_file_is_replaced_as_a_whole(tmp_path: Path) -> None:
    path = tmp_path / "state.json"
    link = tmp_path / "link.json"
    link.symlink_to(path)
    first = StateFile(link)
    first.hold()
    first.save(OLD)
    assert sorted(item.name for item in tmp_path.iterdir()) == ["link.json", "state.json", "state.json.lock"]
    assert link.is_symlink()
    with pytest.raises(UsageError, match="another `elitescript` uses it"):
        StateFile(path).hold()
    first.release()
    assert StateFile(path).load() == content(OLD)


def test_real_trouble_is_told(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="there is no folder"):
        StateFile(tmp_path / "none" / "state.json")
    with pytest.raises(UsageError, match="is a folder, not a file"):
        StateFile(tmp_path).load()


def test_a_virtual_robot_begins_with_what_the_last_one_left(tmp_path: Path) -> None:
    path = tmp_path / "state.json"
    program = (
        "def p():\n  write_port_register(256, read_port_register(256) + 1)\n  set_flag(0, True)\n"
        "  set_standard_digital_out(0, True)\nend\n"
    )
    for count in (1, 2, 3):
        robot = VirtualRobot("CS66", state_file=path)
        assert robot.signals["general_register[0]"] == count - 1
        assert not robot.signals["standard_digital_out[0]"]
        robot.run(program).check()
        assert robot.signals["general_register[0]"] == count
    assert StateFile(path).load() == {"flag[0]": True, "general_register[0]": 3}


def test_a_robot_that_is_stepped_remembers_too(tmp_path: Path) -> None:
    path = tmp_path / "state.json"
    robot = VirtualRobot("CS66", state_file=path)
    robot.start("def p():\n  set_flag(7, True)\n  sleep(10)\nend\n")
    robot.advance(0.1)
    assert StateFile(path).load() == {"flag[7]": True}


def test_two_robots_do_not_overwrite_each_other(tmp_path: Path) -> None:
    path = tmp_path / "state.json"
    first, second = VirtualRobot("CS66", state_file=path), VirtualRobot("CS66", state_file=path)
    first.run("def p():\n  set_flag(1, True)\nend\n").check()
    with pytest.raises(UsageError, match="somebody else has changed it"):
        second.run("def p():\n  set_flag(2, True)\nend\n")
    assert StateFile(path).load() == {"flag[1]": True}


def test_a_link_to_itself_is_said(tmp_path: Path) -> None:
    (tmp_path / "state.json").symlink_to("state.json")
    with pytest.raises(UsageError, match="cannot be read: Too many levels of symbolic links"):
        StateFile(tmp_path / "state.json").load()
