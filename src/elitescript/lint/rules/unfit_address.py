"""An address that no device has: a port or too large a number in an IP address, or a MODBUS address from a manual.

Device manuals number holding registers from 40001 on and input registers from 30001; commands take the address that is
sent, which begins with 0 for each kind.

    def job():
      socket_open("192.168.1.20:5000", 5000)                   # W252: the port is the second argument
      socket_open("192.168.1.300", 5000)                       # W252: 300 is above 255
      modbus_add_signal("192.168.1.50", 255, 40001, 3, "cmd")  # W252: register 40001 has the address 0
      modbus_add_signal("192.168.1.50", 255, 0, 3, "run")      # fine
    end
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from typing import Final

from elitescript.language.diagnostics import Edit, Fix
from elitescript.lint.called import Called, CalledCommands
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_HOSTS: Final = ("address", "IP", "connection_id")
_HOLDERS: Final = (
    *("socket_open", "modbus_add_signal", "modbus_add_rw_signal", "modbus_send_custom_command"),
    "modbus_reset_connection",
)
_BLOCKS: Final = {0: (10001, "digital inputs"), 2: (30001, "input registers"), 3: (40001, "holding registers")}
"""First number of each type of signal in manuals of devices."""
_REGISTERS: Final = ("read_address", "write_address")
_BLOCK_LENGTH: Final = 9_999


@rule(code="W252", since="0.3", needs_values=True)
def unfit_address(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such address."""
    for found in program.derived(CalledCommands).all_of(*_HOLDERS):
        for param in _HOSTS:
            node = found.given.get(param)
            if node is not None:
                for text in program.derived(CalledCommands).texts(found, param, ""):
                    why, hint, fixed = _host(text, found.name)
                    if why:
                        fix = None
                        if fixed and isinstance(node, ast.Constant):
                            fix = Fix(
                                said("write {fixed!r}", fixed=fixed),
                                (Edit(*program.span(node), f'"{fixed}"'),),
                                safe=False,
                            )
                        text = said("{command}: {why}", command=found.name, why=why)
                        yield Finding(node, text, hint, fix)
                        break
        yield from _registers(program, found)


def _host(text: str, command: str) -> tuple[str, str, str]:
    """Return what is wrong with an address, what to do, and what it should be; empty if nothing is."""
    if "://" in text:
        host = text.partition("://")[2].partition("/")[0].partition(":")[0]
        return said("{text!r} is a URL, not an address", text=text), said("write {host!r}", host=host), host
    host, colon, port = text.partition(":")
    if colon and port.strip().isdigit() and ":" not in port:
        return (
            said("{text!r} has a port in it", text=text),
            said("write {host!r}, and port {port} as an argument of its own", host=host, port=port),
            host,
        )
    if text != text.strip():
        return said("{text!r} has blanks around it", text=text), said("write {text!r}", text=text.strip()), text.strip()
    parts = re.split(r"[.,]", text)
    if len(parts) < 3 or not all(part.isdigit() for part in parts):
        return "", "", ""
    if "," in text:
        fixed = text.replace(",", ".")
        return (
            said("{text!r} has a comma in it", text=text),
            said("write {fixed!r}", fixed=fixed),
            fixed if len(parts) == 4 else "",
        )
    large = next((part for part in parts if int(part) > 255), "")
    if large:
        return (
            said("{text!r} is no address: {large} is above 255", text=text, large=large),
            "each of the four numbers is 0 to 255",
            "",
        )
    if len(parts) != 4:
        return (
            said("{text!r} is no address: it has {count} numbers instead of four", text=text, count=len(parts)),
            "",
            "",
        )
    return "", "", ""


def _registers(program: AnalysedProgram, found: Called) -> Iterator[Finding]:
    called = program.derived(CalledCommands)
    kind = called.number(found, "signal_type") if "signal_type" in found.given else 3
    if kind not in _BLOCKS:
        return
    first, words = _BLOCKS[kind]
    for param in ("signal_address", *_REGISTERS):
        node = found.given.get(param)
        number = None if node is None else called.number(found, param)
        if node is not None and number is not None and first <= number < first + _BLOCK_LENGTH:
            text = said(
                "{command}: {param} {number} looks like a number of a manual, where {words} begin with {first}",
                command=found.name,
                param=param,
                number=number,
                words=words,
                first=first,
            )
            yield Finding(
                node, text, said("the address of {number} is {address}", number=number, address=number - first)
            )
