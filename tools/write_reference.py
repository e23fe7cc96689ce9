"""Write the reference pages in docs/reference from the tables and functions that they describe.

Run it after a change to a command, an option, an error code, a signal, a safety state or a port:
`python tools/write_reference.py`.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Final

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "src"))

from elitescript import errors
from elitescript.controller.safety import states as safety
from elitescript.lint import explanations
from elitescript.messages.signals import SIGNALS, Signal
from tools.api_page import api_page
from tools.command_line_page import command_line_page
from tools.commands_pages import COMMAND_PAGES
from tools.devices_page import devices_page
from tools.events_page import events_page
from tools.expressions_page import expressions_page
from tools.faults_page import faults_page
from tools.line_port_pages import dashboard_page, interpreter_page
from tools.markdown import NOTICE, cell
from tools.modbus_page import modbus_page
from tools.model_tables import model_tables
from tools.modules_page import modules_page
from tools.options_page import keywords_module, options_page
from tools.ports_page import ports_page
from tools.primary_page import primary_page
from tools.rtsi_page import rtsi_page
from tools.textmate_grammar import PATH as GRAMMAR
from tools.textmate_grammar import grammar_text

FOLDER: Final = Path(__file__).resolve().parent.parent / "docs" / "reference"


def errors_page() -> str:
    """Codes and exception classes."""
    lines = [
        "# Errors",
        "",
        NOTICE,
        "## Codes",
        "",
        "E0xx and E1xx keep a program from starting, W2xx are warnings, N2xx notes on what a sound program may have.",
        "E3xx contradict the command catalogue: `check`",
        "fails, `run` shows the same errors and starts the program all the same, because it may catch the exceptions;",
        "`run --strict` refuses it. R are alarms of a running program. What each code means: [rules.md](rules.md) and",
        "`elitescript check --explain CODE`.",
        "",
        "What only this implementation accepts is a warning, and an error with `--strict`.",
        "",
        "| code | severity | with `--strict` | title |",
        "|---|---|---|---|",
    ]
    for row in errors.CODES.values():
        link = f"[{row.code}](rules.md#{row.code.lower()})"
        lines.append(f"| {link} | {row.default_severity} | {row.strict_severity} | {cell(row.title)} |")
    lines += [
        "",
        "## Exceptions that commands raise",
        "",
        "Scripts catch them as the built-in exceptions that they are as well.",
        "",
        "| class | is also | usual code | when |",
        "|---|---|---|---|",
    ]
    for kind in vars(errors).values():
        if not (isinstance(kind, type) and issubclass(kind, errors.ScriptError) and kind is not errors.ScriptError):
            continue
        builtin = ", ".join(f"`{base.__name__}`" for base in kind.__bases__ if base.__module__ == "builtins")
        when = (kind.__doc__ or "").split("\n")[0]
        lines.append(f"| `{kind.__name__}` | {builtin} | {kind.default_code} | {cell(when)} |")
    return "\n".join(lines) + "\n"


def rules_page() -> str:
    """Every code: what it means, why, an example."""
    lines = [
        "# Codes",
        "",
        NOTICE,
        "What `elitescript check --explain CODE` prints. A finding of `check` can be hidden by a comment on its line,",
        "`# check: ignore[W204]`, unless it keeps the program from starting.",
    ]
    for row in errors.CODES.values():
        lines += ["", f"## {row.code}", "", f"**{row.title}**", "", explanations.markdown(row.code)]
    return "\n".join(lines) + "\n"


def signals_page() -> str:
    """I/O points, registers and flags."""
    lines = [
        "# Signals",
        "",
        NOTICE,
        "The names that `--set`, `robot.signals` and the `end` event use. A family of one is written without an index,",
        "`tool_analog_in`; the others with one, `standard_digital_in[3]`.",
        "",
        "What is *kept* goes into the file of `--state`, so that it outlasts the controller; see",
        "[the Modbus server](modbus.md#what-is-kept).",
        "",
        "| name | type | indices | direction | range | kept | meaning |",
        "|---|---|---|---|---|---|---|",
    ]
    for signal in SIGNALS.values():
        indices = "" if signal.size == 1 else f"0 to {signal.size - 1}"
        direction = "input" if signal.is_input else "output"
        lines.append(
            f"| `{signal.name}` | {signal.kind} | {indices} | {direction} | {_range(signal)} | "
            f"{'kept' if signal.is_kept else ''} | {signal.summary} |"
        )
    return "\n".join(lines) + "\n"


def safety_page() -> str:
    """States of the safety system, what they do, what leads where, and what is refused."""
    lines = [
        "# Safety",
        "",
        NOTICE,
        "Names and numbers of the states are documented by the vendor; what they do is assumed where the vendor does",
        "not say it. A stop ends the program with an alarm that names line, reason, value, limit and unit and three",
        "things to try; `safeguard_stop` pauses it, and it goes on when the safeguard is closed. After a stop that",
        "took the power, once it is released, the next `run` or `start` powers on and releases the brakes by itself.",
        "",
        "Inputs are signals: `emergency_stop`, `system_emergency_stop`, `safeguard_stop`, `reduced_mode` (`--set`,",
        "`robot.signals`, `robot.at`). From Python: `robot.protective_stop(reason)`, `robot.unlock_protective_stop()`,",
        f"{safety.UNLOCK_AFTER_S:g} s after the stop at the earliest, and `robot.restart_safety()`.",
        "",
        "A restart of the safety system (`restart_safety`; `safety -r` on the dashboard, `restart safetyboard` on port",
        "30001, `elitescript ctl restart`) ends violations and faults. It takes the power of the arm in every state,",
        "also in NORMAL, and ends a task with an alarm (*assumed*); a stop button that is pressed still counts.",
        "",
        "## States",
        "",
        "The strongest last.",
        "",
        "| state | number | the arm | the task | power | alarm |",
        "|---|---:|---|---|---|---|",
    ]
    for mode in safety.MODES:
        effect = safety.EFFECTS[mode]
        power = "stays on" if effect.is_power_kept else "goes off"
        lines.append(f"| {mode.name} | {int(mode)} | {effect.arm} | {effect.task} | {power} | {effect.code} |")
    lines += [
        "",
        "## Transitions",
        "",
        "*inputs*: the strongest state that the inputs ask for at that moment: a stop that is pressed, an open",
        "safeguard, recovery of an arm outside its limits, reduced mode, normal. *refused*: see below. An empty cell:",
        "nothing changes.",
        "",
        "| action | " + " | ".join(mode.name for mode in safety.MODES) + " |",
        "|---|" + "---|" * len(safety.MODES),
    ]
    for action in safety.ACTIONS:
        cells = []
        for mode in safety.MODES:
            if (mode, action) in safety.REFUSALS:
                cells.append("*refused*")
            else:
                after = safety.TRANSITIONS[mode, action]
                cells.append("*inputs*" if after is None else "" if after is mode else after.name)
        lines.append(f"| `{action}` | " + " | ".join(cells) + " |")
    lines += ["", "## Refusals", "", "| in state | to a motion, a task or power | to an unlock |", "|---|---|---|"]
    for mode in safety.MODES:
        unlock = safety.REFUSALS.get((mode, "unlock_protective_stop"), "")
        lines.append(f"| {mode.name} | {cell(safety.WHAT_TO_DO.get(mode, ''))} | {cell(unlock)} |")
    return "\n".join([*lines, "", _CELL_FILE])


_CELL_FILE: Final = """\
## Limits: the cell file

Without limits, normal mode watches nothing but the joint ranges of the model and the force at the TCP, and reduced mode
slows the TCP down to 0.75 m/s. Limits come from `run --world FILE.toml`, `VirtualRobot(world=...)` or
`VirtualRobot(safety=SafetyLimits(...))`.
A limit that is exceeded while the arm moves is a protective stop. Every key may be left out.

The force counts where anything can touch the TCP: with contact planes, or while `external_wrench` is not zero. Its
limits of 250 N and 150 N in reduced mode are assumed. It is the force that `get_tcp_force` reads, whatever
`zero_ftsensor` took as zero. After a force stop is unlocked the arm may move while the force does not grow by more than
2 %, so that a program can back out. `force_mode` with a target above the limit is accepted with a warning.

In reduced mode planned moves, `speedj`, `speedl`, force mode and hand guiding are slowed down. `servoj` and conveyor
tracking are not: their speed is what they mean, so the arm stops protectively where they are too fast, from 0.5 s after
the change on.

```toml
[safety]
tcp_speed = 1.0                 # m/s
operational_mode = "automatic"  # or "manual"; shown by the primary port, which reports none without it
tcp_force = 250                 # N
joint_speed_deg = 120           # deg/s, one number or six; joint_speed in rad/s
joint_range_deg = [[-180, 180], [-200, 20], [-160, 160], [-270, 90], [-180, 180], [-360, 360]]
                                # joint_range in rad

[safety.reduced]                # in reduced mode; what is left out is as in normal mode
tcp_speed = 0.25
tcp_force = 150

[[safety.planes]]               # the TCP stays on the side to which the normal points
name = "table"
point = [0, 0, 0.01]            # m, base frame
normal = [0, 0, 1]
offset = 0.02                   # m, along the normal
use = "always"                  # or "normal", "reduced"; "trigger_reduced" asks for reduced mode behind it
inputs = [0, 1]                 # counts only while both of these configurable inputs are high (assumed)

[safety.tool_direction]         # the tool's z axis stays in this cone
axis = [0, 0, -1]
angle_deg = 45

[signals]                       # levels at the start, as for --set
"standard_digital_in[3]" = true
```
"""


def _range(signal: Signal) -> str:
    if signal.low is None or signal.high is None:
        return signal.unit
    return f"{signal.low:.10g} to {signal.high:.10g} {signal.unit}".rstrip()


PAGES: Final[dict[str, Callable[[], str]]] = {
    "api.md": api_page,
    "command-line.md": command_line_page,
    **COMMAND_PAGES,
    "dashboard.md": dashboard_page,
    "devices.md": devices_page,
    "errors.md": errors_page,
    "events.md": events_page,
    "expressions.md": expressions_page,
    "faults.md": faults_page,
    "interpreter.md": interpreter_page,
    "modbus.md": modbus_page,
    "modules.md": modules_page,
    "options.md": options_page,
    "ports.md": ports_page,
    "primary.md": primary_page,
    "rtsi.md": rtsi_page,
    "rules.md": rules_page,
    "safety.md": safety_page,
    "signals.md": signals_page,
}

MODULE: Final = FOLDER.parent.parent / "src" / "elitescript" / "kernel" / "option_keywords.py"


def main() -> int:
    """Write all pages, the module with the types of keywords, those with the models, and the grammar for editors."""
    for name, page in PAGES.items():
        path = FOLDER / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(page(), encoding="utf-8", newline="\n")
        print(path)
    MODULE.write_text(keywords_module(), encoding="utf-8", newline="\n")
    print(MODULE)
    for path, text in model_tables().items():
        path.write_text(text, encoding="utf-8", newline="\n")
        print(path)
    GRAMMAR.write_text(grammar_text(), encoding="utf-8", newline="\n")
    print(GRAMMAR)
    return 0


if __name__ == "__main__":
    sys.exit(main())
