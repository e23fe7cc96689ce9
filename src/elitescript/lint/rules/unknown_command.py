"""A call of a function that exists nowhere: not in the program, not in the catalogue, not in Python.

It is an alarm (`NameError`) when it is reached. Names of other robots' languages get the command that does
the same here. A secondary program may call functions of the running program, so only names that are plainly
a slip are reported there.

    def job():
      set_digital_out(1, True)   # E301: here it is set_standard_digital_out
    end
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.commands.reserved import GENERATED_PREFIXES, RESERVED
from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.kinds import SCRIPT
from elitescript.lint.program import Program, Use
from elitescript.lint.registry import Finding, rule
from elitescript.lint.suggestions import MOST_SUGGESTIONS, available_commands, nearest, visible_names


@rule(code="E301", since="0.1")
def unknown_command(program: Program) -> Iterator[Finding]:
    """Report calls of unknown functions."""
    hints: dict[tuple[str, int], tuple[str, str]] = {}
    for use in program.unknown:
        name = use.name
        if not use.is_call or program.expects_missing_names(use.node):
            continue
        if program.parsed.kind == SCRIPT and name.startswith(GENERATED_PREFIXES):
            continue
        key = (name, id(use.scope))
        if key not in hints:
            hints[key] = _meant(use, program, is_searched=len(hints) < MOST_SUGGESTIONS)
        meant, hint = hints[key]
        if program.shares_globals and not hint:
            continue
        fix = None
        if meant:
            line, column, end_line, end_column = program.span(use.node)
            fix = Fix(f"write {meant}", (Edit(line, column, end_line, end_column, meant),), safe=False)
        yield Finding(use.node, f"there is no command or function called `{name}`", hint, fix)


FOREIGN: Final = {
    "get_actual_tcp_force": "get_tcp_force",
    "get_analog_in": "get_standard_analog_in",
    "get_analog_out": "get_standard_analog_out",
    "get_controller_temp": "get_controller_temperature",
    "get_conveyor_tick_count": "encoder_get_tick_count",
    "get_digital_in": "get_standard_digital_in",
    "get_digital_out": "get_standard_digital_out",
    "get_joint_positions": "get_actual_joint_positions",
    "get_joint_speeds": "get_actual_joint_speeds",
    "get_joint_temp": "get_joint_temperatures",
    "get_target_payload": "get_target_payload_mass",
    "get_tcp_speed": "get_actual_tcp_speed",
    "get_tool_digital_in": "get_tool_digital",
    "get_tool_digital_out": "get_tool_digital",
    "rtde_set_watchdog": "rtsi_set_watchdog",
    "set_analog_inputrange": "set_standard_analog_input_domain",
    "set_analog_out": "set_standard_analog_out",
    "set_analog_outputdomain": "set_standard_analog_output_domain",
    "set_conveyor_tick_count": "encoder_set_tick_count",
    "set_digital_out": "set_standard_digital_out",
    "set_payload_cog": "set_payload",
    "set_payload_mass": "set_payload",
    "set_target_payload": "set_payload",
    "set_tool_communication": "tool_serial_config",
    "set_tool_digital_out": "set_tool_digital",
    "socket_read_line": "socket_read_string",
    "str_sub_string": "str_sub",
    "to_string": "to_str",
}
"""Names that other languages have, and the commands that do the same."""


def _meant(use: Use, program: Program, *, is_searched: bool) -> tuple[str, str]:
    """The name that is meant, if one can take its place, and the hint."""
    name = use.name
    if name in FOREIGN:
        return "", f"here the command is called {FOREIGN[name]}"
    if name in RESERVED:
        return "", "the name is reserved, but no released command has it; `elitescript commands` lists them all"
    if not is_searched:
        return "", ""
    candidates = available_commands(program) if program.shares_globals else visible_names(use, program)
    meant = nearest(name, candidates)
    return meant, f"is `{meant}` meant?" if meant else ""
