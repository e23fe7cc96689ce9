"""The Modbus server on real sockets: clients that behave badly harm nobody; a port for everybody."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import pytest

from elitescript.errors import UsageError
from elitescript.kernel import Kernel, RobotOptions
from elitescript.services.clients import binding
from elitescript.services.clients.binding import bind
from elitescript.services.port_numbers import NAMES, PORT_MAX, port_numbers, spare_numbers
from tests.protocol import modbus_client as client
from tests.services.served import Scene, run, serving


def site() -> Any:
    return serving(Kernel(RobotOptions()))  # type: ignore[arg-type]


async def answer(peer: Any) -> bytes:
    head = await peer.reader.readexactly(6)
    (found,) = client.frames(head + await peer.reader.readexactly(int.from_bytes(head[4:])))
    return found[2]


async def ask(peer: Any, pdu: bytes) -> bytes:
    peer.send(client.frame(1, pdu))
    return await answer(peer)


def test_a_client_that_ends_its_half_is_answered() -> None:
    async def test() -> None:
        async with site() as scene:
            peer = await scene.connect("modbus")
            peer.send(client.frame(1, client.write(6, 256, 7)) + client.frame(2, client.read(3, 256, 1)))
            peer.half_close()
            assert await answer(peer) == client.write(6, 256, 7)
            assert client.words(await answer(peer)) == [7]
            assert await peer.reader.read() == b""

    run(test())


def test_garbage_floods_and_resets_harm_nobody_else() -> None:
    async def test() -> None:
        async with site() as scene:
            good = await scene.connect("modbus")
            noise = await scene.connect("modbus")
            noise.send(b"\xff" * 500)
            # What the server leaves unread when it closes makes its end a reset.
            with suppress(ConnectionResetError):
                assert await noise.reader.read() == b""
            flood = await scene.connect("modbus")
            flood.send(client.frame(1, client.read(3, 0, 125)) * 3000)
            gone = await scene.connect("modbus")
            gone.send(client.frame(1, client.write(6, 300, 5)))
            gone.reset()
            trickle = await scene.connect("modbus")
            for byte in client.frame(1, client.write(6, 301, 6)):
                trickle.send(bytes([byte]))
                await scene.ticks()
            assert await answer(trickle) == client.write(6, 301, 6)
            for value in range(20):
                assert await ask(good, client.write(6, 256, value)) == client.write(6, 256, value)
            assert client.words(await ask(good, client.read(3, 301, 1))) == [6]
            assert [note.details["origin"] for note in scene.notes("offence")] == ["modbus#2"]
            assert not scene.notes("bug")

    run(test())


def refusing(monkeypatch: pytest.MonkeyPatch, *numbers: int) -> list[int]:
    """Have the system refuse ports; returns what was tried."""
    tried: list[int] = []

    def bind_or_refuse(host: str, number: int) -> Any:
        tried.append(number)
        if number in numbers:
            raise PermissionError(13, "Permission denied")
        return bind(host, 0)

    monkeypatch.setattr(binding, "bind", bind_or_refuse)
    return tried


def test_who_may_not_have_port_502_gets_the_spare_one(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = refusing(monkeypatch, 502)

    async def test() -> None:
        scene = Scene()
        await scene.server.boot()
        scene.server.bind("127.0.0.1", port_numbers(0, {}), spare_numbers(0, {}))
        await scene.server.close()
        (note,) = scene.notes("spare_port")
        assert note.text == "port 502 (modbus) may not be had by this user: modbus is served at 5020"

    run(test())
    assert tried[-2:] == [502, 5020]


def test_a_port_that_was_chosen_is_that_one_or_none(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = refusing(monkeypatch, 502)

    async def test() -> None:
        scene = Scene()
        await scene.server.boot()
        chosen = {"modbus": 502}
        with pytest.raises(UsageError, match=r"port 502 \(modbus\) may not be had by this user"):
            scene.server.bind("127.0.0.1", port_numbers(0, chosen), spare_numbers(0, chosen))
        assert scene.server.ports == {}
        await scene.server.close()

    run(test())
    assert tried[-1] == 502


def test_spare_ports_move_with_the_instance_and_are_nobodys() -> None:
    assert spare_numbers(3, {}, robot=2) == {"modbus": 5520}
    assert spare_numbers(3, {"modbus": 1502}) == {}
    taken = {number for instance in range(201) for number in port_numbers(instance, {}).values()}
    spare = {spare_numbers(instance, {})["modbus"] for instance in range(201)}
    assert not taken & spare
    assert max(spare) <= PORT_MAX
    assert set(spare_numbers(0, {})) <= set(NAMES)
