"""A conveyor that is tracked with an encoder that the program never sets up.

Unless the installation of the robot sets it up, its count stays where it is, so the tool follows nothing.
`encoder_enable_set_tick_count` takes counts that the program gets elsewhere, `encoder_enable_pulse_decode` reads an
encoder at the control box.

    def job():
      encoder_enable_set_tick_count(0, 0)
      track_conveyor_linear([1, 0, 0, 0, 0, 0], 10000)          # fine: encoder 0
      stop_conveyor_tracking()
      track_conveyor_linear([1, 0, 0, 0, 0, 0], 10000, 1)       # N221: encoder 1 is not set up
      stop_conveyor_tracking()
    end
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.language.options import PROGRAM
from elitescript.lint.called import CalledCommands
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_SET_UP: Final = ("encoder_enable_set_tick_count", "encoder_enable_pulse_decode")
_INDEX: Final = "encoder_index"


@rule(code="N221", since="0.3", needs_all_lines=True)
def encoder_not_set_up(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such call in a whole program."""
    called = program.derived(CalledCommands)
    # A script without a `def` may be a part. What the firmware lacks, or is passed on, may set up any encoder.
    set_up = called.of(*_SET_UP)
    uses = [use for use in program.outside if use.name in _SET_UP]
    if program.parsed.kind != PROGRAM or len(uses) > len(set_up):
        return
    ready = {called.number(found, _INDEX) for found in set_up}
    if None in ready:
        return
    for found in called.of("track_conveyor_linear", "track_conveyor_circular"):
        number = called.number(found, _INDEX, 0)
        if number is not None and number not in ready:
            text = said("{command}: nothing in the program sets up encoder {number}", command=found.name, number=number)
            hint = "encoder_enable_set_tick_count or encoder_enable_pulse_decode sets it up"
            yield Finding(found.call, text, hint)
