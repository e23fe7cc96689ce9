"""The stream that never holds its writer up."""

from __future__ import annotations

import json
import threading

from elitescript.cli.output.terminal import WAITING_MAX, QueuedStream
from elitescript.cli.serve import missing_record


class SlowTerminal:
    """Takes nothing until it is told to."""

    def __init__(self) -> None:
        self.text = ""
        self.is_asked = threading.Event()
        self.may_go_on = threading.Event()

    def write(self, text: str) -> int:
        self.is_asked.set()
        self.may_go_on.wait(20)
        self.text += text
        return len(text)

    def flush(self) -> None:
        """Nothing is held back."""


def test_texts_keep_their_order_and_what_is_left_out_is_counted_in_its_place() -> None:
    terminal = SlowTerminal()
    stream = QueuedStream(terminal)
    stream.write("first\n")
    stream.flush()
    assert terminal.is_asked.wait(20)
    for number in range(WAITING_MAX + 5):
        stream.write(f"{number}\n")
    terminal.may_go_on.set()
    stream.close()
    assert terminal.text.splitlines() == [
        "first",
        *(str(number) for number in range(WAITING_MAX)),
        "(5 texts are missing here: they came faster than they could be printed)",
    ]


def test_it_goes_on_behind_the_gap() -> None:
    terminal = SlowTerminal()
    stream = QueuedStream(terminal, missing_record)
    stream.write("{}\n")
    stream.flush()
    assert terminal.is_asked.wait(20)
    for _ in range(WAITING_MAX + 5):
        stream.write("{}\n")
    stream._texts.popleft()
    stream.write('{"n": 1}\n')
    terminal.may_go_on.set()
    stream.close()
    *_, gap, last = map(json.loads, terminal.text.splitlines())
    assert (gap["what"], gap["count"], last) == ("missing", 5, {"n": 1})
