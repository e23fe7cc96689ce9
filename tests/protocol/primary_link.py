"""A client of a script port without a socket: what it sends, and what it gets at which tick."""

from __future__ import annotations

from elitescript.protocol.primary.connection import (
    PRIMARY,
    PrimaryConnection,
    PrimaryFeed,
    PrimaryPort,
)
from tests.protocol import primary_client as client
from tests.protocol.snapshots import description, output

ME = "primary#1"
PROGRAM = "def pick():\n\tmovej([0, -1.57, -1.57, 0, 1.57, 0])\nend"


def connect(port: PrimaryPort = PRIMARY, **options) -> PrimaryConnection:
    return PrimaryConnection(ME, description(), PrimaryFeed(description(), port, **options))


def run(connection: PrimaryConnection, ticks, **first) -> dict[int, list[bytes]]:
    """Publish ticks, the first of them with these changes; return what is sent at which."""
    sent = {}
    for tick in ticks:
        connection.publish(output(tick, **first))
        first = {}
        if messages := connection.take():
            sent[tick] = messages
    return sent


def told(connection: PrimaryConnection, tick: int = 0) -> dict:
    """The one robot message that waits for a client which has its state."""
    sent = run(connection, range(tick, tick + 1))
    (message,) = [message for messages in sent.values() for message in messages if message[4] == 20]
    return client.robot_message(message)
