"""The dashboard's commands, and words and reasons of interpreter mode, against tables written by hand.

Replies are tested where the commands are; here it is about which commands there are, in which spelling, and how well
each is known. Clients repeat the replies marked `client` word by word.
"""

from __future__ import annotations

import pytest

from elitescript.protocol import interpreter
from elitescript.protocol.connection import RESTARTED
from elitescript.protocol.dashboard.verbs import VERBS, help_text, usage_text
from tests.tables import rows

COMMANDS = """
echo                       client                             Hello ELITE ROBOTS.
help [NAME...]             documented                         text
usage NAME...              client                             text
version                    client; wording assumed            A.B.C.D
robot -t                   client; wording assumed            MODEL
robot -s                   client; wording assumed            NUMBER
robot -id                  client; wording assumed            ID
robotControl -on           client                             Powering on
robotControl -off          client                             Powering off
brakeRelease               client                             Brake Releasing... / Brake is released...
robotMode                  client                             robotMode: NAME
safety -s                  client                             Safety status: NAME
safety -m                  client                             Safety mode: NAME
safety -r                  client                             Restarting safety board
closeSafetyDialog          client                             closing safety dialog
unlockProtectiveStop       client                             Protective stop unlocking...
log -a TEXT                client                             Log has been added.
popup -s TEXT              client                             Showing popup with text:TEXT
popup -c                   client                             Closing popup
status                     client                             several lines NAME: VALUE
speed                      observed                           Target Speed Fraction: N
speed -v N                 client; wording assumed            Speed is set to: N
task                       client                             Relative path:PATH
task -p PATH               client                             Loaded task: PATH
task -s                    client                             Task is running / paused / stopped
task -r                    client                             Task is running / not running
task -ss                   client                             Task is saved / not saved
play                       client                             Starting task
pause                      client                             Pausing task
stop                       client                             Stopping task
configuration              client                             configuration: Relative path:PATH
configuration -p PATH      client                             Loading Configuration :PATH
configuration -s           client                             Configuration is modified / not modified
clear -a                   observed                           clear alarm
remoteControl -on          documented; wording assumed        Remote control is on
remoteControl -off         documented; wording assumed        Remote control is off
remoteControl -s           documented; wording assumed        Remote control is on / off
remoteControl -status      documented; wording assumed        Remote control is on / off
variable -get NAME         documented; wording assumed        NAME: VALUE / Can not find variable NAME: ...
variable -set NAME VALUE   documented; wording assumed        Variable is set: NAME
quit                       client; wording assumed            Bye.
reboot                     client; wording assumed            Rebooting
shutdown                   client; wording assumed            Shutting down
"""

# A word that does not wait its turn, its reply, and what is assumed besides.
WORDS = """
skipbuffer             .                                 .
abort                  .                                 .
statelastexecuted      state: ID: statelastexecuted      .
statelastinterpreted   state: ID: statelastinterpreted   .
statelastcleared       state: ID: statelastcleared       the word in the reply and what counts as cleared assumed
stateunexecuted        state: COUNT: stateunexecuted     without the skipped ones assumed, the texts disagree
state                  state: 0: running: state          .
"""

REASONS = """
Compile error
Task is in an invalid state
Too many interpreted messages
Cleaned up before interpretation
Cleaned up after end
Cleaned up
"""


def test_commands() -> None:
    shown = [(row.usage, row.evidence, row.reply) for entries in VERBS.values() for row in entries]
    assert shown == rows(COMMANDS)


@pytest.mark.parametrize("verb", list(dict.fromkeys(usage.split(" ")[0] for usage, *_ in rows(COMMANDS))))
def test_help_and_usage_name_every_form_of_a_verb(verb: str) -> None:
    forms = [usage for usage, *_ in rows(COMMANDS) if usage.split(" ")[0] == verb]
    assert usage_text([verb]) == f"usage: {' | '.join(forms)}"
    assert [line.partition(": ")[0] for line in help_text([verb]).split("\r\n")] == forms


def test_words_of_interpreter_mode() -> None:
    shown = [(word.name, word.reply, word.evidence) for word in interpreter.WORDS.values()]
    assert shown == [
        (name, reply, f"documented; {rest}" if rest else "documented") for name, reply, rest in rows(WORDS)
    ]


def test_reasons_of_interpreter_mode() -> None:
    assert [(reason.text, reason.evidence) for reason in interpreter.REASONS] == [
        (text, "documented") for (text,) in rows(REASONS)
    ]


def test_limits_of_interpreter_mode() -> None:
    assert interpreter.QUEUE_LIMIT == 8500
    assert interpreter.LINE_LIMIT == 65536  # assumed
    assert interpreter.LINES_PER_TICK == 20  # assumed
    assert RESTARTED == "R132"
