"""A link whose other end is a list, for work that needs no process of its own."""

from __future__ import annotations

import json

from elitescript.studio.live.jobs import Job, job_data
from elitescript.studio.live.link import Link


class ListLink(Link):
    """Keeps what is sent, and gives requests.

    Args:
        requests: for `receive`, in order; then there are none any more.
    """

    def __init__(self, *requests):
        super().__init__(-1, -1)
        self.requests = list(requests)
        self.messages = []
        self.rows = []

    def send(self, message):
        self.messages.append(json.loads(json.dumps(message, allow_nan=False)))

    def send_rows(self, frame):
        self.rows.append(frame)

    def receive(self):
        if not self.requests:
            raise EOFError
        return self.requests.pop(0)

    def of(self, kind):
        """Return the messages of a type."""
        return [message for message in self.messages if message["type"] == kind]

    def one(self, kind):
        """Return the only message of a type."""
        (message,) = self.of(kind)
        return message


def request(text, *, until_s=120.0, known=None, wall_s=60.0, **job):
    """Return a request to run a text."""
    return {
        "do": "run",
        "job": job_data(Job("job.script", text, **job)),
        "run": 3,
        "version": 7,
        "options": {"until_s": until_s},
        "until_s": until_s,
        "wall_s": wall_s,
        "known": known,
    }


def no_jail():
    """Stay as free as a test."""
