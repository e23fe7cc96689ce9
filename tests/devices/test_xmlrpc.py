"""XML-RPC servers of a test."""

from __future__ import annotations

import pytest

from elitescript.messages.inputs import ChannelData
from elitescript.testing.world import DeviceError, RpcFault, World, XmlRpcServer
from tests.devices.programs import run

MAKE = 's = rpc_factory("xmlrpc", "http://h:8000/RPC2")\n'


CALL = b"<methodCall><methodName>nothing</methodName></methodCall>"


class Planner(XmlRpcServer):
    port = 8000

    def echo(self, value):
        return value

    def fail(self):
        raise RpcFault(7, "no part < left")

    def slowly(self):
        return self.delayed(0.5, "done")

    def nothing(self):
        return None


@pytest.mark.parametrize("value", ["1", "-2.5", "True", "'text'", "[1, [2.5, 'x'], True]", "{'a': 1, 'b': [1]}"])
def test_values_go_there_and_back(value):
    found = run(MAKE + f"global same\nsame = s.echo({value}) == {value}", Planner())
    assert found.globals["same"] is True


def test_many_calls_go_over_one_connection():
    planner = Planner()
    found = run(MAKE + "for n in range(5):\n  textmsg(s.echo(n))\nend\nglobal n_open\n", planner)
    assert found.log == ["0", "1", "2", "3", "4"]


@pytest.mark.parametrize(
    "call, words",
    [
        ("s.fail()", "fault 7: no part < left"),
        ("s.missing(1)", "method 'missing' is not supported"),
        ("s.echo()", "echo: missing a required argument: 'value'"),
        ("s.procedure('echo')", "method 'procedure' is not supported"),
        ("s.cell()", "method 'cell' is not supported"),
    ],
)
def test_faults_reach_the_program(call, words):
    found = run(MAKE + f"try:\n  {call}\nexcept Exception as error:\n  textmsg(error)\nend", Planner())
    assert words in found.log[0]


def test_a_call_takes_the_time_that_the_device_takes():
    assert run(MAKE + "textmsg(s.slowly())", Planner()).time_s == pytest.approx(0.5, abs=0.02)
    assert run(MAKE + "textmsg(s.echo(1))", Planner(duration_s=0.3)).time_s == pytest.approx(0.3, abs=0.02)


def test_functions_may_have_names_with_dots():
    class Plain(XmlRpcServer):
        port = 8000

    network = World(devices=[Plain(functions={"camera.trigger": lambda: 5})]).network
    body = b"<methodCall><methodName>camera.trigger</methodName></methodCall>"
    assert b"<int>5</int>" in post(network, body)


def post(network, body, head=b"POST / HTTP/1.1\r\nContent-Length: %d\r\n\r\n"):
    channel = network.open("h", 8000, 2.0)
    network.arrivals(1)
    network.send(channel, (head % len(body) if b"%d" in head else head) + body)
    events = [event for tick in range(2, 6) for event in network.arrivals(tick)]
    return b"".join(event.data for event in events if isinstance(event, ChannelData))


@pytest.mark.parametrize(
    "head, body, status",
    [
        (b"GET / HTTP/1.1\r\n\r\n", b"", b"405"),
        (b"POST / HTTP/1.1\r\nContent-Length: 99999999\r\n\r\n", b"", b"413"),
        (b"POST / HTTP/1.1\r\nContent-Length: " + b"9" * 5000 + b"\r\n\r\n", b"", b"413"),
        (b"POST / HTTP/1.1\r\nContent-Length: %d\r\n\r\n", b"<no xml", b"400"),
        (b"POST / HTTP/1.1\r\nContent-Length: %d\r\n\r\n", b"<!DOCTYPE m []>" + CALL, b"400"),
        (b"POST / HTTP/1.1\r\nContent-Length: %d\r\n\r\n", b"<a/>", b"400"),
        (b"x" * 40_000, b"", b"431"),
    ],
)
def test_what_is_no_call_is_refused_with_a_status(head, body, status):
    assert post(World(devices=[Planner()]).network, body, head).startswith(b"HTTP/1.1 " + status)


def test_a_call_that_comes_in_pieces_is_one():
    network = World(devices=[Planner()]).network
    body = b"<methodCall><methodName>nothing</methodName></methodCall>"
    request = b"POST / HTTP/1.1\r\nContent-Length: %d\r\n\r\n" % len(body) + body
    channel = network.open("h", 8000, 2.0)
    network.arrivals(1)
    data = b""
    for tick, byte in enumerate(request, 2):
        network.send(channel, bytes((byte,)))
        data += b"".join(event.data for event in network.arrivals(tick) if isinstance(event, ChannelData))
    data += b"".join(event.data for event in network.arrivals(1000) if isinstance(event, ChannelData))
    assert data.count(b"HTTP/1.1 200 OK") == 1


def test_a_failing_procedure_is_named_with_its_line():
    class Broken(Planner):
        def echo(self, value):
            return value / 0

    with pytest.raises(DeviceError, match=r"test_xmlrpc\.py:\d+: device Broken: ZeroDivisionError"):
        run(MAKE + "s.echo(1)", Broken())


def test_what_xmlrpc_cannot_carry_is_a_mistake_of_the_device():
    class Broken(Planner):
        def echo(self, value):
            return 2**40

    with pytest.raises(DeviceError, match="echo returned 1099511627776, which XML-RPC cannot carry"):
        run(MAKE + "s.echo(1)", Broken())
