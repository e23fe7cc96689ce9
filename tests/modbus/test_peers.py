"""Frames, slave and master against pymodbus and mbpoll, which know nothing of ours.

Real sockets on this computer: what is tried here is whether strangers understand each other.
"""

from __future__ import annotations

import asyncio
import gc
import random
import selectors
import shutil
import socket
import subprocess
from collections.abc import Callable, Iterator
from threading import Event, Thread
from typing import Any

import pytest

from elitescript import VirtualRobot
from elitescript.modbus.frames import pdu
from elitescript.modbus.frames.rtu import RtuSplitter, rtu_frame
from elitescript.modbus.frames.tcp import TcpSplitter, tcp_frame
from elitescript.modbus.slave import MemoryTables, Slave, TcpSlave

pymodbus = pytest.importorskip("pymodbus")
# pymodbus's server leaves a task behind for each connection that ends.
pytestmark = [pytest.mark.peers, pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")]

CASES = 300


@pytest.fixture(autouse=True)
def collected() -> Iterator[None]:
    """Collect the robots of a test with it: MODBUS signals outlive programs, and so do the sockets of their robot."""
    yield
    gc.collect()


# ------------------------------------------------------------------------------------------------- frames


def _pairs(chance: random.Random) -> Iterator[tuple[bytes, Any, bytes, Any]]:
    """Requests and answers, each as ours and as pymodbus's."""
    from pymodbus.pdu import bit_message as bits
    from pymodbus.pdu import register_message as registers

    for _ in range(CASES):
        address, count = chance.randrange(60000), chance.randint(1, 125)
        words = [chance.randrange(65536) for _ in range(chance.randint(1, 121))]
        levels = [chance.random() < 0.5 for _ in range(chance.randint(1, 1968))]
        read_words = [chance.randrange(65536) for _ in range(count)]
        many = {"address": address, "count": len(levels)}
        yield (
            pdu.read(1, address, len(levels)),
            bits.ReadCoilsRequest(**many),
            pdu.bits_read(1, levels),
            bits.ReadCoilsResponse(bits=levels),
        )
        yield (
            pdu.read(2, address, len(levels)),
            bits.ReadDiscreteInputsRequest(**many),
            pdu.bits_read(2, levels),
            bits.ReadDiscreteInputsResponse(bits=levels),
        )
        yield (
            pdu.read(3, address, count),
            registers.ReadHoldingRegistersRequest(address=address, count=count),
            pdu.registers_read(3, read_words),
            registers.ReadHoldingRegistersResponse(registers=read_words),
        )
        yield (
            pdu.read(4, address, count),
            registers.ReadInputRegistersRequest(address=address, count=count),
            pdu.registers_read(4, read_words),
            registers.ReadInputRegistersResponse(registers=read_words),
        )
        yield (
            pdu.write_coil(address, levels[0]),
            bits.WriteSingleCoilRequest(address=address, bits=levels[:1]),
            pdu.written(pdu.write_coil(address, levels[0])),
            bits.WriteSingleCoilResponse(address=address, bits=levels[:1]),
        )
        yield (
            pdu.write_register(address, words[0]),
            registers.WriteSingleRegisterRequest(address=address, registers=words[:1]),
            pdu.written(pdu.write_register(address, words[0])),
            registers.WriteSingleRegisterResponse(address=address, registers=words[:1]),
        )
        yield (
            pdu.write_coils(address, levels),
            bits.WriteMultipleCoilsRequest(address=address, bits=levels),
            pdu.written(pdu.write_coils(address, levels)),
            bits.WriteMultipleCoilsResponse(**many),
        )
        yield (
            pdu.write_registers(address, words),
            registers.WriteMultipleRegistersRequest(address=address, registers=words),
            pdu.written(pdu.write_registers(address, words)),
            registers.WriteMultipleRegistersResponse(address=address, count=len(words)),
        )
        yield (
            pdu.read_write_registers(address, count, 7, words),
            registers.ReadWriteMultipleRegistersRequest(
                read_address=address, read_count=count, write_address=7, write_registers=words
            ),
            pdu.registers_read(23, read_words),
            registers.ReadWriteMultipleRegistersResponse(registers=read_words),
        )


def test_frames_are_those_of_pymodbus() -> None:
    from pymodbus.framer import FramerRTU, FramerSocket
    from pymodbus.pdu import DecodePDU, ExceptionResponse

    tcp, rtu = FramerSocket(DecodePDU(True)), FramerRTU(DecodePDU(True))
    chance = random.Random(1)
    requests, answers = RtuSplitter(is_slave=True), RtuSplitter(is_slave=False)
    for ours, theirs, our_answer, their_answer in _pairs(chance):
        unit, number = chance.randint(1, 247), chance.randrange(1, 65536)
        for data, other, splitter in ((ours, theirs, requests), (our_answer, their_answer, answers)):
            other.dev_id, other.transaction_id = unit, number
            assert tcp_frame(number, unit, data) == tcp.buildFrame(other)
            assert rtu_frame(unit, data) == rtu.buildFrame(other)
            assert TcpSplitter().feed(tcp.buildFrame(other)) == [(number, unit, data)]
            assert splitter.feed(rtu.buildFrame(other)) == [(unit, data)]
    refusal = ExceptionResponse(3, 2)
    refusal.dev_id = 5
    assert rtu.buildFrame(refusal) == rtu_frame(5, pdu.exception(3, 2))


def test_values_of_pymodbus_answers_arrive() -> None:
    chance = random.Random(2)
    for request, _, our_answer, theirs in _pairs(chance):
        answer = bytes((theirs.function_code,)) + theirs.encode()
        values = pdu.values_of(request, answer)
        assert values == pdu.values_of(request, our_answer)


# ------------------------------------------------------------------------------------------------- our slave


class OurSlave:
    """Our slave on a real port."""

    def __init__(self) -> None:
        self.tables = MemoryTables(holding_registers=list(range(200)), input_registers=list(range(500, 600)), coils=100)
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = self._listener.getsockname()[1]
        self._is_over = Event()
        self._thread = Thread(target=self._serve)
        self._thread.start()

    def _serve(self) -> None:
        with selectors.DefaultSelector() as selector:
            selector.register(self._listener, selectors.EVENT_READ)
            while not self._is_over.is_set():
                for key, _ in selector.select(0.02):
                    one: Any = key.fileobj
                    if key.data is None:
                        selector.register(one.accept()[0], selectors.EVENT_READ, TcpSlave(Slave(self.tables)))
                    elif data := one.recv(65536):
                        one.sendall(key.data.take(data))
                    else:
                        selector.unregister(one)
                        one.close()
            for key in list(selector.get_map().values()):
                key.fileobj.close()  # type: ignore[union-attr]

    def close(self) -> None:
        self._is_over.set()
        self._thread.join()


@pytest.fixture
def our_slave() -> Iterator[OurSlave]:
    slave = OurSlave()
    yield slave
    slave.close()


def test_pymodbus_reads_and_writes_our_slave(our_slave: OurSlave) -> None:
    from pymodbus.client import ModbusTcpClient

    client = ModbusTcpClient("127.0.0.1", port=our_slave.port)
    assert client.connect()
    try:
        assert client.read_holding_registers(10, count=125, device_id=1).registers == list(range(10, 135))
        assert client.read_input_registers(0, count=3, device_id=255).registers == [500, 501, 502]
        assert not client.write_coil(3, True, device_id=1).isError()
        assert not client.write_coils(5, [True, False, True], device_id=1).isError()
        assert client.read_coils(0, count=9, device_id=1).bits[:9] == [0, 0, 0, 1, 0, 1, 0, 1, 0]
        assert client.read_discrete_inputs(0, count=2000, device_id=1).bits[:2000] == [False] * 2000
        assert not client.write_register(0, 77, device_id=1).isError()
        assert not client.write_registers(1, [78, 79], device_id=1).isError()
        answer = client.readwrite_registers(read_address=0, read_count=4, write_address=3, values=[80], device_id=1)
        assert answer.registers == [77, 78, 79, 80]
        assert client.read_holding_registers(199, count=2, device_id=1).exception_code == 2
        assert client.mask_write_register(address=0, device_id=1).exception_code == 1
    finally:
        client.close()


@pytest.mark.skipif(shutil.which("mbpoll") is None, reason="mbpoll is not installed")
def test_mbpoll_reads_and_writes_our_slave(our_slave: OurSlave) -> None:
    def mbpoll(*options: str) -> str:
        command = ["mbpoll", "-m", "tcp", "-p", str(our_slave.port), "-0", "-1", *options]
        done = subprocess.run(command, capture_output=True, text=True, timeout=20)
        return done.stdout + done.stderr

    assert "[12]: \t12" in mbpoll("-t", "4", "-r", "10", "-c", "3", "127.0.0.1")
    assert "[1]: \t501" in mbpoll("-t", "3", "-r", "0", "-c", "2", "127.0.0.1")
    assert "Written 2 references" in mbpoll("-t", "4", "-r", "20", "127.0.0.1", "600", "601")
    assert our_slave.tables.holding_registers[20:22] == [600, 601]
    assert "Written 3 references" in mbpoll("-t", "0", "-r", "4", "127.0.0.1", "1", "0", "1")
    assert our_slave.tables.coils[4:7] == [1, 0, 1]
    assert "Illegal data address" in mbpoll("-t", "4", "-r", "198", "-c", "5", "127.0.0.1")


# ------------------------------------------------------------------------------------------------- our master


class TheirSlave:
    """pymodbus's server on a real port.

    Args:
        trace_pdu: its error simulation: may change what it answers.
        action: called for each access.
    """

    def __init__(self, trace_pdu: Callable[[bool, Any], Any] | None = None, action: Any = None) -> None:
        self._trace = trace_pdu
        self._action = action
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self._loop = asyncio.new_event_loop()
        self._is_up = Event()
        self._thread = Thread(target=self._run)
        self._thread.start()
        assert self._is_up.wait(10)

    def _run(self) -> None:
        from pymodbus.server import ModbusTcpServer
        from pymodbus.simulator import DataType, SimData, SimDevice

        def registers(value: int) -> list[Any]:
            return [SimData(0, count=300, values=value, datatype=DataType.REGISTERS)]

        def bits() -> list[Any]:
            return [SimData(0, count=200, values=True, datatype=DataType.BITS)]

        async def serve() -> None:
            device = SimDevice(255, (bits(), bits(), registers(7), registers(9)), action=self._action)
            server = ModbusTcpServer(device, address=("127.0.0.1", self.port), trace_pdu=self._trace)
            await server.serve_forever(background=True)
            self._is_up.set()
            await self._over.wait()
            await server.shutdown()
            left = asyncio.all_tasks() - {asyncio.current_task()}
            for task in left:
                task.cancel()
            await asyncio.gather(*left, return_exceptions=True)

        self._over = asyncio.Event()
        self._loop.run_until_complete(serve())
        self._loop.close()

    def close(self) -> None:
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._over.set)
            self._thread.join()


@pytest.fixture
def their_slave(request: pytest.FixtureRequest) -> Iterator[TheirSlave]:
    slave = TheirSlave(**getattr(request, "param", {}))
    yield slave
    slave.close()


def _until(condition: str) -> tuple[str, ...]:
    """Lines that wait for a condition, as long as a busy computer may need."""
    return "for n in range(200):", f"  if {condition}:", "    break", "  end", "  sleep(0.05)", "end"


def _run(port: int, *lines: str) -> Any:
    text = "def main():\n" + "".join(f"  {line}\n" for line in lines).replace("PORT", str(port)) + "end\n"
    robot = VirtualRobot()
    run = robot.run(text, until_s=20.0)
    # Connections of a program that has ended are closed in the ticks after its end.
    robot.advance(0.1)
    return run


def test_a_program_reads_and_writes_pymodbus(their_slave: TheirSlave) -> None:
    run = _run(
        their_slave.port,
        'modbus_add_signal("127.0.0.1", 255, 0, 0, "di", False, 1, PORT)',
        'modbus_add_signal("127.0.0.1", 255, 0, 1, "do", False, 4, PORT)',
        'modbus_add_signal("127.0.0.1", 255, 0, 2, "ri", False, 1, PORT)',
        'modbus_add_signal("127.0.0.1", 255, 10, 3, "ro", False, 3, PORT)',
        'modbus_add_rw_signal("127.0.0.1", 255, 20, 2, 21, 2, "rw", False, PORT)',
        'modbus_add_signal("127.0.0.1", 255, 5000, 3, "bad", False, 3, PORT)',
        *_until('modbus_get_error("bad") == [2, 0] and modbus_get_error("rw") == [0, 0]'),
        'print(modbus_get_signal_status("di"), modbus_get_signal_status("do"), modbus_get_signal_status("ri"))',
        'print(modbus_get_signal_status("ro"), modbus_get_error("ro"), modbus_get_error("bad"))',
        'modbus_set_output_register("ro", [70000, -1])',
        'modbus_set_output_signal("do", [False, True])',
        'modbus_set_output_register("rw", 99)',
        'modbus_send_custom_command("127.0.0.1", 255, 6, [0, 30, 1, 2], True, PORT)',
        'modbus_add_signal("127.0.0.1", 255, 10, 3, "check", False, 3, PORT)',
        'modbus_add_signal("127.0.0.1", 255, 30, 3, "custom", False, 1, PORT)',
        'modbus_add_signal("127.0.0.1", 255, 0, 1, "coils", False, 4, PORT)',
        *_until('modbus_get_signal_status("check") == [4464, 65535, 7]'),
        *_until('modbus_get_signal_status("custom") == 258 and modbus_get_signal_status("rw") == [7, 99]'),
        *_until('modbus_get_signal_status("coils") == [False, True, True, True]'),
        'print(modbus_get_signal_status("check"), modbus_get_signal_status("custom"), modbus_get_signal_status("rw"))',
        'print(modbus_get_signal_status("coils"), modbus_get_error("coils"))',
    )
    assert run.printed == [
        "True [True, True, True, True] 9",
        "[7, 7, 7] [0, 0] [2, 0]",
        "[4464, 65535, 7] 258 [7, 99]",
        "[False, True, True, True] [0, 0]",
    ]
    assert run.state == "finished"
    assert run.is_paced


def test_pymodbus_gets_one_request_at_a_time_when_it_does_not_cope(their_slave: TheirSlave) -> None:
    run = _run(
        their_slave.port,
        "for n in range(8):",
        '  modbus_add_signal("127.0.0.1", 255, n, 3, str(n), False, 1, PORT)',
        "  modbus_set_signal_update_frequency(str(n), 250)",
        "end",
        "sleep(1.5)",
        "print([modbus_get_error(str(n)) for n in range(8)] == [[0, 0]] * 8)",
        "print([modbus_get_time_since_signal_invalid(str(n)) for n in range(8)] == [0.0] * 8)",
    )
    assert run.printed == ["True", "True"]
    assert run.warnings == []


def _refusing(is_answer: bool, message: Any) -> Any:
    from pymodbus.pdu import ExceptionResponse

    if is_answer and message.function_code == 3:
        refusal = ExceptionResponse(3, 6)
        refusal.dev_id, refusal.transaction_id = message.dev_id, message.transaction_id
        return refusal
    return message


def _other_transaction(is_answer: bool, message: Any) -> Any:
    if is_answer:
        message.transaction_id += 1000
    return message


def _other_slave(is_answer: bool, message: Any) -> Any:
    if is_answer:
        message.dev_id = 9
    return message


def _too_many(is_answer: bool, message: Any) -> Any:
    if is_answer:
        message.registers = [1, 2, 3, 4]
    return message


@pytest.mark.parametrize(
    ("their_slave", "codes"),
    [
        ({"trace_pdu": _refusing}, "[6, 0]"),
        ({"trace_pdu": _other_transaction}, "[0, 110]"),
        ({"trace_pdu": _other_slave}, "[9, 0]"),
        ({"trace_pdu": _too_many}, "[9, 0]"),
    ],
    indirect=["their_slave"],
)
def test_errors_that_pymodbus_simulates_show_in_their_codes(their_slave: TheirSlave, codes: str) -> None:
    run = _run(
        their_slave.port,
        'modbus_add_signal("127.0.0.1", 255, 0, 3, "x", False, 2, PORT)',
        *_until(f'modbus_get_error("x") == {codes}'),
        'print(modbus_get_error("x"), modbus_get_signal_status("x"))',
    )
    assert run.printed == [f"{codes} [0, 0]"]


def test_a_server_that_goes_is_missed() -> None:
    slave = TheirSlave()
    port = slave.port
    robot = VirtualRobot()
    robot.start(
        f'def main():\n  modbus_add_signal("127.0.0.1", 255, 0, 3, "x", False, 1, {port})\n'
        '  while True:\n    sleep(0.1)\n    print(modbus_get_error("x"))\n  end\nend\n'
    )
    run = robot.current
    assert run is not None
    for seen in ("[0, 0]", "[-2, 111]"):
        for _ in range(100):
            robot.advance(0.1)
            if run.printed and run.printed[-1] == seen:
                break
        assert run.printed[-1] == seen
        slave.close()
    robot.stop()
    robot.advance(0.1)


def test_nobody_there_is_refused() -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
        run = _run(
            port,
            'modbus_add_signal("127.0.0.1", 255, 0, 3, "x", False, 1, PORT)',
            *_until('modbus_get_error("x")[1] > 0'),
            'print(modbus_get_error("x"))',
        )
    assert run.printed == ["[-2, 111]"]
