"""Peers that vanish: what the operating system is asked to do about them, and what is free afterwards."""

from __future__ import annotations

import socket

import pytest

from elitescript.services.clients.liveness import PROBE_S, PROBES, SILENCE_S, UNTAKEN_S, watch_peer
from tests.protocol import rtsi_client
from tests.services.served import run, serving


def test_a_watched_socket_asks_for_signs_of_life() -> None:
    with socket.socket() as one:
        watch_peer(one)
        assert one.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE)
        wanted = {
            "TCP_KEEPIDLE": SILENCE_S,
            "TCP_KEEPINTVL": PROBE_S,
            "TCP_KEEPCNT": PROBES,
            "TCP_USER_TIMEOUT": UNTAKEN_S * 1000,
        }
        for name, value in wanted.items():
            if hasattr(socket, name):
                assert one.getsockopt(socket.IPPROTO_TCP, getattr(socket, name)) == value
    assert SILENCE_S + PROBE_S * PROBES == UNTAKEN_S


def test_a_socket_of_another_kind_is_left_as_it_is() -> None:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        watch_peer(ours)


@pytest.mark.parametrize("service", ["dashboard", "primary", "rtsi", "interpreter", "query"])
def test_clients_of_every_port_are_watched(service: str) -> None:
    async def test() -> None:
        async with serving() as scene:
            await scene.connect(service)
            clients = scene.server.listeners[service].clients
            await scene.until(lambda: clients)
            raw = next(iter(clients.values()))._transport.get_extra_info("socket")
            assert raw.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE)

    run(test())


def test_inputs_of_a_client_that_has_vanished_are_free_again() -> None:
    async def test() -> None:
        async with serving() as scene:
            dead = await scene.connect("rtsi")
            dead.send(rtsi_client.message("I", b"input_int_register0"))
            assert (await dead.rtsi("I"))[1] == b"\x01INT32"
            late = await scene.connect("rtsi")
            late.send(rtsi_client.message("I", b"input_int_register0"))
            assert (await late.rtsi("I"))[1] == b"\x00IN_USE"
            client = scene.server.listeners["rtsi"].clients["rtsi#1"]
            # What the operating system does once the signs of life are missing.
            client._transport._fatal_error(TimeoutError("timed out"))
            await scene.until(lambda: scene.notes("gone"))
            assert "timed out" in scene.notes("gone")[0].text
            late.send(rtsi_client.message("I", b"input_int_register0"))
            assert (await late.rtsi("I"))[1] == b"\x01INT32"

    run(test())
