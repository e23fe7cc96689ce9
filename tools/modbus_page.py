"""The reference page of the controller's own Modbus server, from its table of registers and coils."""

from __future__ import annotations

from elitescript.messages.signals import SIGNALS
from elitescript.modbus.port_map import COIL_COUNT, COILS, REGISTER_COUNT, REGISTERS
from elitescript.protocol.modbus_port import NUMBER, REQUESTS_PER_TICK, SPARE_NUMBER
from elitescript.services.state_keeper import INTERVAL_S
from tools.markdown import NOTICE, cell

_PROMISES = """
## What a client may expect

- Any unit is answered. Requests that are sent without waiting are answered in their order, up to {paced} in a tick of
  4 ms for each client, fewer for each where there are more than ten clients.
- A read is answered at once, with the state of the last tick.
- A write is answered when the robot has taken it, in its next tick. Whoever asks after that answer, on whatever
  connection, sees what was written. A client has one write under way at a time.
- A write of several registers or coils happens in one tick, whole or not at all. Function 23 reads right after it
  wrote; no other request comes in between.
- A coil is set by itself: clients that write different coils of one word never undo each other's. A register of
  outputs sets all of them.
- A level that is written together with its domain belongs to the new domain.
- Outputs follow the rules of all other ways to set them: one that is tied to the task
  (`set_runstate_..._to_value`) waits for it, a tool pin that is no output is refused (in register 3: only if its
  bit changes). Remote and local control make no difference (*assumed*).
- Exceptions (*assumed*): 1 for other functions, 2 for addresses that are not there or not to be written, 3 for
  values that the robot refuses (its log says why), 4 when the robot was started anew in between.
- What is no Modbus TCP closes the connection, after the answers that are due.

## What is kept

The robot remembers {kept}
when it is switched off (flags: *documented* between programs; the others: *assumed*, from the manual's words that
registers are in system memory). `--state FILE` of `serve` and `run`, and `VirtualRobot(state_file=...)`, do so;
without it every start is the same.

`serve` writes the file at once after a change, but not more often than every {interval} s, and at the end; `run` at
the end of the program. The file is JSON with the names that `--set` takes. It is replaced as a whole: a kill or a power
loss leaves the old one or the new one. It is locked while it is in use (`FILE.lock`), and left alone when it is not
understood or when somebody else has changed it. `--set` and the cell file count more than what is kept. Of several
robots in one `serve`, each has its own: `cell.json`, `cell.1.json`, and so on.
"""


def modbus_page() -> str:
    """What clients and programs find at each address."""
    lines = [
        "# The Modbus server",
        "",
        NOTICE,
        f"The controller is a Modbus TCP slave at port {NUMBER}. Where the system keeps ports below 1024 for",
        f"others, `elitescript serve` says so and takes {SPARE_NUMBER}; `--port modbus=NUMBER` is that port or none.",
        "Both move with `--instance`; the `ready` line says which it is. [Connecting a PLC](../how-to/modbus.md) shows",
        "how to begin.",
        "",
        "Programs see the same table by `read_port_bit`, `read_port_register`, `write_port_bit` and",
        "`write_port_register`.",
        "",
        "## Registers",
        "",
        f"{REGISTER_COUNT} registers of 16 bits, read by functions 3, 4 and 23, written by 6, 16 and 23. *RW* can be",
        "written.",
        "",
        "| address | content | unit | access | evidence |",
        "|---|---|---|---|---|",
    ]
    for row in REGISTERS:
        access = "R" if row.write is None else "RW"
        lines.append(
            f"| {_span(row.first, row.size)} | {cell(row.content)} | {cell(row.unit)} | {access} | {row.evidence} |"
        )
    lines += [
        "",
        "Register 256 + i is the signal `general_register[i]`. Addresses without a row read as 0 and are not written",
        "(*assumed*). A value that needs more than 16 bits shows as the nearest that fits.",
        "",
        "## Coils",
        "",
        f"{COIL_COUNT} coils, read by functions 1 and 2, written by 5 and 15.",
        "",
        "| address | content | access | signals | evidence |",
        "|---|---|---|---|---|",
    ]
    for coil in COILS:
        last = coil.point + coil.size - 1
        lines.append(
            f"| {_span(coil.first, coil.size)} | {cell(coil.content)} | {'RW' if coil.is_writable else 'R'} | "
            f"`{coil.family}[{coil.point}]` to `[{last}]` | {coil.evidence} |"
        )
    kept = ", ".join(f"`{row.name}`" for row in SIGNALS.values() if row.is_kept)
    return "\n".join(lines) + "\n" + _PROMISES.format(paced=REQUESTS_PER_TICK, kept=kept, interval=f"{INTERVAL_S:g}")


def _span(first: int, size: int) -> str:
    return str(first) if size == 1 else f"{first} to {first + size - 1}"
