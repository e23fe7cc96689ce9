"""The state file of a served robot: written soon after changes, not too often, and at the end."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import pytest

from elitescript.environment.state_file import StateFile
from elitescript.errors import UsageError
from elitescript.kernel import Kernel, RobotOptions
from elitescript.services import state_keeper
from elitescript.services.state_keeper import StateKeeper
from tests.protocol import modbus_client
from tests.protocol.snapshots import signal_image
from tests.services.served import run, serving


class FakeFile:
    """Remembers what is saved; fails when it is told to."""

    def __init__(self) -> None:
        self.saved: list[dict[str, Any]] = []
        self.is_held = False
        self.trouble = ""

    def hold(self) -> None:
        self.is_held = True

    def release(self) -> None:
        self.is_held = False

    def save(self, levels: Any) -> None:
        assert self.is_held
        if self.trouble:
            raise UsageError(self.trouble)
        self.saved.append(dict(levels))

    @property
    def registers(self) -> list[int]:
        return [levels["general_register"][0] for levels in self.saved]


def register(value: int) -> Any:
    return signal_image({"general_register": {0: value}})


def keeper(file: FakeFile, told: list[str] | None = None) -> StateKeeper:
    return StateKeeper(file, [].append if told is None else told.append)  # type: ignore[arg-type]


async def until(condition: Any) -> None:
    while not condition():
        await asyncio.sleep(0)


def test_a_change_is_written_at_once_and_what_follows_together(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(state_keeper, "INTERVAL_S", 3600.0)

    async def test() -> None:
        file = FakeFile()
        keeping = keeper(file)
        assert file.is_held
        keeping.take(register(1))
        await until(lambda: file.saved)
        for value in range(2, 50):
            keeping.take(register(value))
            await asyncio.sleep(0)
        assert file.registers == [1]
        await keeping.close()
        assert file.registers == [1, 49]
        assert not file.is_held

    run(test())


def test_changes_are_written_one_interval_after_another(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(state_keeper, "INTERVAL_S", 0.0)

    async def test() -> None:
        file = FakeFile()
        keeping = keeper(file)
        for value in (1, 2, 3):
            keeping.take(register(value))
            await until(lambda value=value: file.registers[-1:] == [value])
        await keeping.close()
        assert file.registers == [1, 2, 3]

    run(test())


def test_what_is_not_kept_is_no_reason_to_write() -> None:
    async def test() -> None:
        file = FakeFile()
        keeping = keeper(file)
        keeping.take(register(1))
        await until(lambda: file.saved)
        keeping.take(signal_image({"general_register": {0: 1}, "standard_digital_out": {3: True}}))
        keeping.take(register(1))
        await keeping.close()
        assert file.registers == [1]

    run(test())


def test_a_write_that_fails_is_told_and_tried_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(state_keeper, "RETRY_S", 0.0)

    async def test() -> None:
        file, told = FakeFile(), []
        file.trouble = "the disk is full"
        keeping = keeper(file, told)
        keeping.take(register(1))
        await until(lambda: len(told) > 2)
        file.trouble = ""
        await until(lambda: file.saved)
        await keeping.close()
        assert set(told) == {"the disk is full"}
        assert file.registers == [1]

    run(test())


def test_at_the_end_a_write_that_fails_is_told_and_the_file_is_free() -> None:
    async def test() -> None:
        file, told = FakeFile(), []
        file.trouble = "the disk is full"
        keeping = keeper(file, told)
        keeping.take(register(1))
        await keeping.close()
        assert told[-1] == "the disk is full"
        assert not file.is_held

    run(test())


def test_what_a_client_writes_is_there_for_the_next_robot(tmp_path: Path) -> None:
    path = tmp_path / "state.json"

    async def test() -> None:
        for count in range(3):
            file = StateFile(path)
            keeping = StateKeeper(file)
            config = RobotOptions(signals=tuple(keeping.load().items()))
            async with serving(Kernel(config), keeper=keeping) as scene:  # type: ignore[arg-type]
                peer = await scene.connect("modbus")
                peer.send(modbus_client.frame(1, modbus_client.read(3, 256, 1)))
                _, _, pdu = modbus_client.frames(await peer.reader.readexactly(11))[0]
                assert modbus_client.words(pdu) == [count]
                peer.send(modbus_client.frame(2, modbus_client.write(6, 256, count + 1)))
                await peer.reader.readexactly(12)
            assert StateFile(path).load() == {"general_register[0]": count + 1}

    run(test())
