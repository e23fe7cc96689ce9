"""The ports of a controller against a table written by hand."""

from __future__ import annotations

import pytest

from elitescript.protocol.ports import SERVICES
from elitescript.protocol.primary import connection as primary
from elitescript.services.port_numbers import INSTANCE_MAX, PORT_MAX, PORTS_PER_INSTANCE, port_numbers, spare_numbers
from tests.tables import rows

# Name, number, first firmware, number without the right to ports below 1024, whether a client that has ended its own
# half of the connection still gets its stream. What 30002, 30003 and 30011 do is assumed; that they exist is not. That
# 40011 came with 2.11 is assumed as well.
PORTS = """
dashboard     29999   .      .      closes
primary       30001   .      .      goes on
secondary     30002   .      .      goes on
realtime      30003   .      .      goes on
readonly      30011   .      .      goes on
rtsi          30004   .      .      closes
interpreter   30020   2.11   .      closes
query         40011   2.11   .      closes
modbus          502   .      5020   closes
"""

# Name, number, states in a second, whether robot messages are sent, whether programs are taken, evidence.
PRIMARY_PORTS = """
primary     30001    10   messages   programs   documented
secondary   30002    10   .          programs   assumed
realtime    30003   125   .          programs   assumed
readonly    30011    10   messages   .          assumed
"""


def test_ports() -> None:
    shown = [
        (
            row.name,
            str(row.number),
            "" if row.since == (0, 0) else "{}.{}".format(*row.since),
            str(row.spare_number or ""),
            "goes on" if row.outlives_silence else "closes",
        )
        for row in SERVICES
    ]
    assert shown == rows(PORTS)


def test_evidence() -> None:
    shown = {row.name: row.evidence for row in SERVICES}
    assert shown == {
        "dashboard": "vendor's client; documented",
        "primary": "documented",
        "secondary": "assumed",
        "realtime": "assumed",
        "readonly": "assumed",
        "rtsi": "vendor's client; documented",
        "interpreter": "documented",
        "query": "observed",
        "modbus": "documented",
    }


def test_ports_that_send_the_state() -> None:
    shown = [
        (
            port.name,
            str(port.number),
            str(port.rate),
            "messages" if port.sends_messages else "",
            "programs" if port.takes_programs else "",
            port.evidence,
        )
        for port in primary.PORTS
    ]
    assert shown == rows(PRIMARY_PORTS)


@pytest.mark.parametrize("instance", [0, 1, 3])
def test_ports_of_an_instance(instance: int) -> None:
    table = rows(PORTS)
    assert port_numbers(instance, {}) == {name: int(number) + 100 * instance for name, number, *_ in table}
    assert spare_numbers(instance, {}) == {"modbus": 5020 + 100 * instance}
    assert (PORTS_PER_INSTANCE, PORT_MAX, INSTANCE_MAX) == (100, 65535, 200)
