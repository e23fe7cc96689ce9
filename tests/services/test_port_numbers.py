"""Which service is at which port."""

from __future__ import annotations

import pytest

from elitescript.errors import UsageError
from elitescript.protocol.ports import SERVICES, services_of
from elitescript.services.port_numbers import NAMES, port_numbers, spare_numbers
from tests.protocol.snapshots import description, output


def test_the_ports_are_those_of_the_controller() -> None:
    assert {row.name: row.number for row in SERVICES} == {
        "dashboard": 29999,
        "primary": 30001,
        "secondary": 30002,
        "realtime": 30003,
        "rtsi": 30004,
        "readonly": 30011,
        "interpreter": 30020,
        "query": 40011,
        "modbus": 502,
    }


def test_a_firmware_has_the_ports_that_its_release_brought() -> None:
    names = [row.name for row in services_of((2, 10))]
    assert names == [name for name in NAMES if name not in ("interpreter", "query")]
    assert services_of((2, 11)) == services_of((2, 14)) == SERVICES


def test_an_instance_moves_every_port() -> None:
    moved = port_numbers(3, {})
    assert all(moved[name] == number + 300 for name, number in port_numbers(0, {}).items())


def test_a_chosen_port_stays_where_it_is_and_moves_for_the_next_robot() -> None:
    assert port_numbers(3, {"rtsi": 40004})["rtsi"] == 40004
    assert port_numbers(3, {"rtsi": 40004}, robot=2)["rtsi"] == 40204
    assert port_numbers(3, {"rtsi": 0}, robot=2)["rtsi"] == 0


def test_instances_do_not_get_in_each_others_way() -> None:
    taken = [number for instance in range(10) for number in port_numbers(instance, {}).values()]
    assert len(set(taken)) == len(taken)


@pytest.mark.parametrize(
    ("instance", "chosen", "why"),
    [
        (-1, {}, "an instance is a number"),
        (201, {}, "an instance is a number"),
        (0, {"telnet": 23}, "no service is called 'telnet'"),
        (0, {"rtsi": 70000}, "port rtsi must be a number from 0 to 65535"),
        (0, {"rtsi": 30001}, "primary and rtsi cannot have the same port 30001"),
    ],
)
def test_nonsense_is_refused(instance: int, chosen: dict[str, int], why: str) -> None:
    with pytest.raises(UsageError, match=why):
        port_numbers(instance, chosen)


def test_the_ssh_port_is_there_only_when_it_is_asked_for() -> None:
    assert "ssh" not in port_numbers(0, {}) and "ssh" not in spare_numbers(0, {})
    assert port_numbers(0, {}, has_ssh=True)["ssh"] == 22
    assert port_numbers(1, {}, robot=2, has_ssh=True)["ssh"] == 322
    assert port_numbers(0, {"ssh": 2022}, has_ssh=True)["ssh"] == 2022
    assert spare_numbers(0, {}, has_ssh=True) == {"modbus": 5020, "ssh": 2222}
    assert spare_numbers(0, {"ssh": 22}, has_ssh=True) == {"modbus": 5020}
    with pytest.raises(UsageError, match="only with --ssh"):
        port_numbers(0, {"ssh": 22})
    with pytest.raises(UsageError, match="modbus and ssh cannot have the same port 22"):
        port_numbers(0, {"modbus": 22}, has_ssh=True)


@pytest.mark.parametrize("service", SERVICES, ids=NAMES)
def test_every_row_makes_connections_of_one_robot(service) -> None:
    connect = service.open(description())
    first, second = connect(f"{service.name}#1"), connect(f"{service.name}#2")
    assert (first.origin, second.origin) == (f"{service.name}#1", f"{service.name}#2")
    for tick in range(300):
        first.publish(output(tick))
    samples = [message for message in first.take() if service.is_sample(message)]
    assert bool(samples) == service.outlives_silence
