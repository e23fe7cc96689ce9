from __future__ import annotations

import pytest

from tests.lint.checking import body, only


def test_the_content_of_the_address_is_named():
    problem = only("def job():\n  write_port_bit(5, True)\nend\n")
    assert (problem.code, problem.severity) == ("W260", "warning")
    assert problem.text == "write_port_bit: coil 5 (standard digital inputs) cannot be written; nothing changes"


@pytest.mark.parametrize(
    "call",
    ["write_port_bit(31, 0)", "write_port_register(66, 7)", "write_port_register(address=17, value=1)"],
)
def test_inputs_states_and_reserved_addresses_mirror_the_robot(call):
    assert [finding.split()[0] for finding in body(call)] == ["W260"]


@pytest.mark.parametrize("call", ["write_port_bit(60, 1)", "write_port_register(256, 3)", "level = read_port_bit(5)"])
def test_what_can_be_set_and_what_is_read_is_fine(call):
    assert body(call) == []


def test_an_address_that_is_not_certain_is_left_to_the_run():
    assert body("n = get_flag(0)", "write_port_bit(n, True)") == []


def test_what_is_out_of_range_is_said_once():
    assert [finding.split()[0] for finding in body("write_port_bit(128, True)")] == ["E305"]
