"""What a robot's reply to a port says."""

from __future__ import annotations

import pytest

from elitescript.protocol.outcomes import Outcome, done, read_outcome, refused


@pytest.mark.parametrize(
    ("text", "outcome"),
    [
        (done(), Outcome(True, "")),
        (done("[1, 2]"), Outcome(True, "[1, 2]")),
        (done("done: 1"), Outcome(True, "done: 1")),
        (refused("there is no such file: a: b"), Outcome(False, "there is no such file: a: b")),
        ("nonsense", Outcome(False, "nonsense")),
        ("refused", Outcome(False, "refused")),
    ],
)
def test_a_reply_is_read_as_it_was_written(text: str, outcome: Outcome) -> None:
    assert read_outcome(text) == outcome
