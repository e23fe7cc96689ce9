"""A slave answers from its tables."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elitescript.errors import UsageError
from elitescript.modbus.frames import pdu
from elitescript.modbus.frames.rtu import rtu_frame
from elitescript.modbus.frames.tcp import tcp_frame
from elitescript.modbus.slave import MemoryTables, RtuSlave, Slave, TcpSlave


def small() -> tuple[Slave, MemoryTables]:
    tables = MemoryTables(
        coils=[1, 0, 1, 1], discrete_inputs=[0, 1], holding_registers=[10, 11, 12, 13], input_registers=[20, 21]
    )
    return Slave(tables), tables


@pytest.mark.parametrize(
    ("request_bytes", "values"),
    [
        (pdu.read(1, 0, 4), (1, 0, 1, 1)),
        (pdu.read(2, 0, 2), (0, 1)),
        (pdu.read(3, 1, 3), (11, 12, 13)),
        (pdu.read(4, 1, 1), (21,)),
    ],
)
def test_each_table_is_read_by_its_function(request_bytes: bytes, values: tuple[int, ...]) -> None:
    slave, _ = small()
    assert pdu.values_of(request_bytes, slave.answer(request_bytes)) == values


def test_writes_reach_the_tables_and_are_repeated() -> None:
    slave, tables = small()
    for request in (
        pdu.write_coil(1, True),
        pdu.write_coils(2, [0, 0]),
        pdu.write_register(0, 99),
        pdu.write_registers(2, [7, 8]),
    ):
        assert slave.answer(request) == request[:5]
    assert tables.coils == [1, 1, 0, 0]
    assert tables.holding_registers == [99, 11, 7, 8]


def test_reading_and_writing_in_one_writes_first() -> None:
    slave, tables = small()
    request = pdu.read_write_registers(0, 4, 1, [5, 6])
    assert pdu.values_of(request, slave.answer(request)) == (10, 5, 6, 13)
    assert tables.holding_registers == [10, 5, 6, 13]


@pytest.mark.parametrize(
    ("request_bytes", "code"),
    [
        (pdu.read(3, 2, 3), 2),
        (pdu.read(1, 4, 1), 2),
        (pdu.read(2, 65535, 1), 2),
        (pdu.write_register(4, 1), 2),
        (pdu.write_coils(3, [1, 1]), 2),
        (pdu.read_write_registers(3, 2, 0, [1]), 2),
        (pdu.read_write_registers(0, 1, 3, [1, 2]), 2),
        (b"\x07", 1),
        (b"\x03\0\0\0\0", 3),
    ],
)
def test_what_is_wrong_is_answered_with_its_code_and_changes_nothing(request_bytes: bytes, code: int) -> None:
    slave, tables = small()
    assert slave.answer(request_bytes) == pdu.exception(request_bytes[0], code)
    assert (tables.coils, tables.holding_registers) == ([1, 0, 1, 1], [10, 11, 12, 13])


def test_a_slave_may_know_fewer_functions() -> None:
    slave = Slave(MemoryTables(), frozenset({3}))
    assert slave.answer(pdu.write_register(0, 1)) == pdu.exception(6, 1)
    assert slave.answer(pdu.read(3, 0, 1)) == pdu.registers_read(3, [0])


class Stubborn(MemoryTables):
    """Refuses with any code."""

    code = 6

    def read_registers(self, table: int, address: int, count: int) -> list[int]:
        raise pdu.ExceptionResponse(self.code)


@pytest.mark.parametrize("code", [1, 2, 3, 4, 5, 6, 7, 8, 10, 11])
def test_tables_refuse_with_any_code(code: int) -> None:
    tables = Stubborn()
    tables.code = code
    assert Slave(tables).answer(pdu.read(4, 0, 1)) == pdu.exception(4, code)


@given(st.binary(max_size=260))
def test_every_request_has_an_answer_that_fits(data: bytes) -> None:
    answer = Slave(MemoryTables(holding_registers=100, coils=100)).answer(data)
    assert 2 <= len(answer) <= pdu.PDU_MAX
    assert answer[0] & 0x7F == (data[0] & 0x7F if data else 0)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"coils": [0, 2]}, r"coils\[1\] must be 0 to 1, got 2"),
        ({"holding_registers": [65536]}, r"holding_registers\[0\] must be 0 to 65535, got 65536"),
        ({"input_registers": 65537}, "input_registers has 65537 addresses"),
    ],
)
def test_tables_refuse_what_does_not_fit(content: dict[str, object], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        MemoryTables(**content)  # type: ignore[arg-type]


# ------------------------------------------------------------------------------------------------- on a line


def test_answers_of_one_segment_leave_in_one_piece_and_order() -> None:
    slave, _ = small()
    connection = TcpSlave(slave)
    frames = [tcp_frame(number, 7, pdu.read(3, number, 1)) for number in range(4)]
    answer = b"".join(tcp_frame(number, 7, pdu.registers_read(3, [10 + number])) for number in range(4))
    assert connection.take(b"".join(frames)) == answer


def test_a_gateway_says_that_a_slave_is_not_there() -> None:
    connection = TcpSlave({1: small()[0]})
    assert connection.take(tcp_frame(1, 2, pdu.read(3, 0, 1))) == tcp_frame(1, 2, pdu.exception(3, 11))
    assert not connection.is_lost


def test_too_many_registers_are_an_exception_and_the_connection_stays() -> None:
    connection = TcpSlave(small()[0])
    long = bytes([16, 0, 0, 0, 124, 248]) + bytes(248)
    assert connection.take(tcp_frame(1, 7, long)) == tcp_frame(1, 7, pdu.exception(16, 3))
    assert not connection.is_lost


def test_nonsense_loses_a_connection() -> None:
    connection = TcpSlave(small()[0])
    assert connection.take(b"GET / HTTP/1.1\r\n\r\n") == b""
    assert connection.is_lost


def test_slaves_of_a_line_answer_for_themselves() -> None:
    one, two = small()[0], small()[0]
    line = RtuSlave({1: one, 2: two})
    assert line.take(rtu_frame(2, pdu.read(3, 0, 1))) == rtu_frame(2, pdu.registers_read(3, [10]))
    assert line.take(rtu_frame(3, pdu.read(3, 0, 1))) == b""
    assert line.take(rtu_frame(1, b"\x41")) == b""
    assert line.silence() == rtu_frame(1, pdu.exception(0x41, 1))


def test_a_broadcast_reaches_all_and_is_answered_by_none() -> None:
    (one, tables_one), (two, tables_two) = small(), small()
    line = RtuSlave({1: one, 2: two})
    assert line.take(rtu_frame(0, pdu.write_register(0, 5))) == b""
    assert tables_one.holding_registers[0] == tables_two.holding_registers[0] == 5
