"""The stream that never holds its writer up."""

from __future__ import annotations

import json
import threading

from elitescript.cli.output.terminal import BACKLOG, CHARACTERS_MAX, WAITING_MAX, QueuedStream
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


def test_a_stop_goes_before_what_waits_and_no_state_overtakes_another() -> None:
    terminal = SlowTerminal()
    stream = QueuedStream(terminal)
    stream.write_state("started\n", overtakes=False)
    stream.flush()
    assert terminal.is_asked.wait(20)
    for number in range(BACKLOG + 1):
        stream.write(f"{number}\n")
    stream.write_state("stopped\n", overtakes=True)
    stream.write_state("finished\n", overtakes=False)
    stream.write_state("stopped again\n", overtakes=True)
    terminal.may_go_on.set()
    stream.close()
    messages = [str(number) for number in range(BACKLOG + 1)]
    assert terminal.text.splitlines() == ["started", "stopped", *messages, "finished", "stopped again"]


def test_a_stop_keeps_its_place_while_the_reader_keeps_up() -> None:
    terminal = SlowTerminal()
    stream = QueuedStream(terminal)
    stream.write("before\n")
    stream.write_state("stopped\n", overtakes=True)
    terminal.may_go_on.set()
    stream.close()
    assert terminal.text == "before\nstopped\n"


def test_long_texts_count_by_their_length() -> None:
    terminal = SlowTerminal()
    stream = QueuedStream(terminal)
    stream.write("first\n")
    stream.flush()
    assert terminal.is_asked.wait(20)
    stream.write("x" * (CHARACTERS_MAX - 10))
    stream.write("too much\n" * 2)
    assert stream._missing == 1
    terminal.may_go_on.set()
    stream.close()
