"""The reference page of RTSI, from its tables."""

from __future__ import annotations

from elitescript.messages.outputs import REPEAT_AFTER_S
from elitescript.protocol.rtsi import connection as rtsi
from elitescript.protocol.rtsi import recipes as rtsi_recipes
from elitescript.protocol.rtsi.inputs import INPUT_ROWS, InputVariable
from elitescript.protocol.rtsi.variables import OUTPUT_ROWS, OutputVariable
from tools.markdown import NOTICE, cell


def rtsi_page() -> str:
    """Commands, types and variables of the RTSI port."""
    low, high = rtsi_recipes.FREQUENCY_MIN_HZ, rtsi_recipes.FREQUENCY_MAX_HZ
    types = {row.type.name: row.type.size for row in (*OUTPUT_ROWS, *INPUT_ROWS)}
    lines = [
        "# RTSI",
        "",
        NOTICE,
        "Port 30004: typed variables both ways. Integers and floats are big-endian.",
        "",
        "*vendor's client*, *third-party client*: it sends or reads exactly this; *documented*: in a page of the",
        "vendor; *assumed*: decided here.",
        "",
        "## Messages",
        "",
        "A message is a u16, its size with this head, a u8, the letter of its command, and up to",
        f"{rtsi.MESSAGE_MAX - 3} bytes. Names and types are separated by commas.",
        "",
        "| command | name | client sends | controller sends |",
        "|---|---|---|---|",
    ]
    lines += [
        f"| `{row.letter}` ({ord(row.letter)}) | {row.name} | {row.question} | {row.answer} |" for row in rtsi.COMMANDS
    ]
    lines += [
        "",
        f"- Recipes have numbers 1 to {rtsi.RECIPES_MAX}, apart for outputs and inputs. A set-up that fails has number",
        f"  0 (*assumed*). `{rtsi.NOT_FOUND}` stands in place of the type of a variable that there is not,",
        f"  `{rtsi.IN_USE}` of an input that another client has claimed. Inputs are free again when the connection of",
        "  their client ends.",
        f"- A client has {rtsi.VARIABLES_MAX} variables at most in all its recipes of one direction (*assumed*).",
        f"- Frequencies are {low:g} to {high:g} Hz; others are clamped, and a text message says so (*assumed*).",
        "- The first package of each recipe follows the start at once; n ticks later a recipe of f Hz has sent",
        "  floor(n f / 250) more. Values are those of the tick.",
        "- Each tick gives a package once, with its own time stamp, also when `serve` is late: what is made up for",
        "  comes together. A tick is missing only where the robot was restarted (R132), or for a client that reads too",
        f"  slowly. After {REPEAT_AFTER_S:g} s without a new tick each recipe repeats its last package at its rate,",
        "  until there is one (*assumed*): a package with the time stamp of the one before is no news.",
        "- Inputs count while data flows and while it is paused, in local control too (*assumed*).",
        "- What cannot be obeyed is ignored and answered with a text message, at most once a second for each kind: a",
        "  package of a wrong size or of no recipe, a value out of range, an unknown command. A size below 3 ends the",
        "  connection (*assumed*).",
        "",
        "## Types",
        "",
        "| type | bytes |",
        "|---|---:|",
        *(f"| {name} | {size} |" for name, size in sorted(types.items())),
    ]
    for title, rows in (("Output variables", OUTPUT_ROWS), ("Input variables", INPUT_ROWS)):
        head = "| name | type | unit | meaning | evidence |"
        lines += ["", f"## {title}", "", head, "|---|---|---|---|---|", *(_variable(row) for row in rows)]
    return "\n".join(lines) + "\n"


def _variable(row: OutputVariable | InputVariable) -> str:
    name = f"`{row.name.replace('#', 'N')}`"
    if "#" in row.name:
        name += f", N = {row.indices[0]} to {row.indices[-1]}"
    return f"| {name} | {row.type.name} | {row.unit} | {cell(row.summary)} | {row.evidence} |"
