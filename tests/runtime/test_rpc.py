"""Remote procedure calls in virtual time, and to the standard library's server."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any
from xmlrpc import client
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

import pytest

from elitescript import VirtualRobot
from elitescript.devices.channels.network import DeviceLink, Peer, VirtualNetwork
from elitescript.environment.memory import MemoryEnvironment
from elitescript.errors import InvalidValueError, UsageError
from elitescript.runtime.connections.rpc import IDLE_MAX, server_of


class Answering(Peer):
    """A server in memory: each request is answered by a function of method and arguments."""

    def __init__(self, link: DeviceLink, answer: Callable[[str, tuple[Any, ...]], bytes | None]) -> None:
        super().__init__(link)
        self.answer = answer
        self.heard = b""

    def received(self, data: bytes) -> None:
        self.heard += data
        head, _, body = self.heard.partition(b"\r\n\r\n")
        size = int(head.lower().partition(b"content-length:")[2].split()[0]) if body else 1
        if body and len(body) >= size:
            self.heard = body[size:]
            args, method = client.loads(body[:size], use_builtin_types=True)
            answer = self.answer(method, args)
            if answer is None:
                self.link.close()
            else:
                self.link.send(answer)


def http(body: bytes | str, status: str = "200 OK", fields: str = "") -> bytes:
    body = body.encode() if isinstance(body, str) else body
    return f"HTTP/1.1 {status}\r\n{fields}Content-Length: {len(body)}\r\n\r\n".encode() + body


def result(value: Any) -> bytes:
    return http(client.dumps((value,), methodresponse=True, allow_none=True))


class Scene:
    """A robot with servers in memory on port 5050."""

    def __init__(self, answer: Callable[[str, tuple[Any, ...]], bytes | None], **options: Any) -> None:
        self.world = MemoryEnvironment(channels=VirtualNetwork())
        self.peers: list[Answering] = []
        self.world.channels.servers[5050] = self.accept
        self.answer = answer
        self.robot = VirtualRobot(world=self.world, **options)

    def accept(self, link: DeviceLink) -> Answering:
        self.peers.append(Answering(link, self.answer))
        return self.peers[-1]

    def run(self, *lines: str, until_s: float = 100.0) -> Any:
        text = "".join(f"  {line}\n" for line in ('c = rpc_factory("xmlrpc", "10.0.0.1:5050")', *lines))
        self.ended = self.robot.run(f"def job():\n{text}end\n", until_s=until_s)
        return list(self.ended.log)


VALUES = [0, -(2**31), 2.5, True, "prüf <&>", "", b"\x00\xff", [], [1, [2.5, "x"]], {"a": {"b": [1]}}, None]


@pytest.mark.parametrize("value", VALUES, ids=repr)
def test_values_go_there_and_back(value):
    scene = Scene(lambda method, args: result([method, *args]))
    assert scene.run(f"textmsg(c.echo({value!r}) == ['echo', {value!r}])") == ["True"]


def test_texts_of_objects_go_without_their_addresses():
    heard = []
    scene = Scene(lambda method, args: heard.append(args) or result(0))
    foreign, own = "<Pump object at 0x10>", "<__main__.job.<locals>.Pump object>"
    scene.run("class Pump:", "  pass", "end", f"c.note(repr(Pump()), [{{'p': str(Pump())}}], {foreign!r})")
    assert heard == [(own, [{"p": own}], foreign)]
    assert "0x7" not in str(scene.ended.events)


def test_a_handle_connects_when_a_procedure_is_called():
    scene = Scene(lambda method, args: result(1))
    scene.run("sleep(1)", "before = controller_timestamp()")
    assert scene.peers == []
    assert scene.ended.state == "finished"


def test_a_connection_is_kept_for_the_next_call():
    scene = Scene(lambda method, args: result(args[0]))
    assert scene.run("textmsg([c.f(n) for n in range(5)])") == ["[0, 1, 2, 3, 4]"]
    assert len(scene.peers) == 1
    assert not scene.peers[0].link.is_open


def test_a_kept_connection_that_has_gone_is_opened_anew():
    scene = Scene(lambda method, args: http(client.dumps((1,), methodresponse=True)))

    def answer(method: str, args: tuple[Any, ...]) -> bytes | None:
        if method == "once" and len(scene.peers) == 1:
            return None
        return result(len(scene.peers))

    scene.answer = answer
    assert scene.run("textmsg(c.first())", "textmsg(c.once())") == ["1", "2"]


def test_bytes_that_nobody_asked_for_are_not_taken_for_the_next_answer():
    scene = Scene(lambda method, args: result(method))

    def greet(link: DeviceLink) -> Answering:
        peer = scene.accept(link)
        link.later(0.1, lambda: link.send(result("unasked")))
        return peer

    scene.world.channels.servers[5050] = greet
    assert scene.run("textmsg(c.one())", "sleep(0.2)", "textmsg(c.two())") == ["one", "two"]
    assert len(scene.peers) == 2


def test_connections_to_many_servers_are_not_kept_for_ever():
    scene = Scene(lambda method, args: result(method))
    for port in range(6000, 6100):
        scene.world.channels.servers[port] = scene.accept
    lines = [
        "for n in range(100):",
        '  c = rpc_factory("xmlrpc", "h:" + to_str(6000 + n))',
        "  c.f()",
        "end",
        "sleep(1)",
    ]
    scene.robot.start("def job():\n" + "".join(f"  {line}\n" for line in lines) + "end\n")
    while len(scene.peers) < 100:
        scene.robot.advance(0.1)
    scene.robot.advance(0.1)
    assert scene.world.channels.open_channels == IDLE_MAX


def test_an_answer_that_declares_entities_is_refused():
    text = "".join(f'<!ENTITY e{n + 1} "{f"&e{n};" * 10}">' for n in range(5))
    body = client.dumps(("BOMB",), methodresponse=True).replace("BOMB", "&e5;")
    bomb = f'<!DOCTYPE m [<!ENTITY e0 "x">{text}]>' + body.partition("?>")[2]
    scene = Scene(lambda method, args: http(bomb))
    lines = ("try:", "  c.f()", "except Exception as error:", "  textmsg(str(error))", "end")
    assert scene.run(*lines)[0].endswith("the answer is no XML-RPC: it declares a type of document")


def test_procedures_may_have_dots():
    scene = Scene(lambda method, args: result(method))
    assert scene.run("textmsg(c.system.list.all())") == ["system.list.all"]


def test_two_threads_call_at_the_same_time():
    scene = Scene(lambda method, args: result(args[0]))
    lines = ("out = []", "a = start_thread(lambda: out.append(c.f(1)), ())", "out.append(c.f(2))", "join_thread(a)")
    assert scene.run(*lines, "textmsg(sorted(out))") == ["[1, 2]"]
    assert len(scene.peers) == 2


def fault(code: int, text: str) -> bytes:
    return http(client.dumps(client.Fault(code, text)))


PROBLEMS = {
    "a fault": (fault(4, "no part"), "the server answered with fault 4: no part"),
    "a status": (http("", "500 Internal Server Error"), "the server answered 500 Internal Server Error"),
    "no XML": (http("hello"), "the answer is no XML: syntax error: line 1, column 0"),
    "no XML-RPC": (http("<a/>"), "the answer is no XML-RPC: ResponseError()"),
    "no HTTP": (b"SSH-2.0\r\n", "what arrived is no HTTP; it begins with b'SSH-2'"),
    "cut short": (b"HTTP/1.0 200 OK\r\nContent-Length: 9\r\n\r\nabc", "no answer within 3 s"),
    "closed": (None, "the server closed the connection unasked"),
    "a bad number": (
        http("<methodResponse><params><param><value><int>x</int></value></param></params></methodResponse>"),
        "the answer is no XML-RPC: invalid literal for int() with base 10: 'x'",
    ),
}


@pytest.mark.parametrize("name", PROBLEMS)
def test_a_call_that_fails_is_an_alarm_with_the_peers_text(name):
    answer, words = PROBLEMS[name]
    scene = Scene(lambda method, args: answer, rpc_timeout_s=3.0)
    scene.run("c.get(1)")
    alarm = scene.ended.alarms[0]
    assert (alarm.code, alarm.line) == ("R133", 3)
    assert alarm.text == f"get() on http://10.0.0.1:5050/RPC2: {words}"
    assert not scene.peers[0].link.is_open


def test_programs_catch_a_fault_and_read_it():
    scene = Scene(lambda method, args: fault(7, "empty"))
    lines = ("try:", "  c.get()", "except Exception as e:", "  textmsg(e.faultCode, e.faultString)", "end")
    assert scene.run(*lines) == ["7empty"]


def test_nobody_listens():
    scene = Scene(lambda method, args: None)
    scene.world.channels.servers.clear()
    scene.run("c.get()")
    assert scene.ended.alarms[0].text == "get() on http://10.0.0.1:5050/RPC2: connection refused"


def test_waits_for_an_answer_as_long_as_it_may():
    scene = Scene(lambda method, args: b"", rpc_timeout_s=3.0)
    scene.run("c.get()")
    assert scene.ended.time_s == pytest.approx(3.0, abs=0.02)


def test_a_call_that_waits_for_ever_can_be_stopped():
    scene = Scene(lambda method, args: b"", rpc_timeout_s=0.0)
    scene.run("c.get()", until_s=1000.0)
    assert scene.ended.state == "stuck"
    assert not scene.peers[0].link.is_open
    lines = ("a = start_thread(lambda: c.get(), ())", "sleep(1)", "stop_thread(a)", "textmsg('on')")
    assert Scene(lambda method, args: b"", rpc_timeout_s=0.0).run(*lines) == ["on"]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ("c.f(2**31)", "f(): int exceeds XML-RPC limits: whole numbers have 32 bits"),
        ("c.f(sleep)", "f(): cannot marshal"),
        ("c.f([len])", "f(): cannot marshal"),
        ("c.f({1: 2})", "f(): dictionary key must be string"),
        ("c.f(1j)", "f(): cannot marshal <class 'complex'> objects"),
        ("c.f(x=1)", "c.f() has no parameter `x`"),
        ("c()", "which cannot be called"),
    ],
)
def test_what_cannot_be_sent_is_refused_before_anything_is(call, words):
    scene = Scene(lambda method, args: result(1))
    scene.run(call)
    assert words in scene.ended.alarms[0].text
    assert scene.peers == []


def test_a_list_that_holds_itself_is_refused():
    scene = Scene(lambda method, args: result(1))
    scene.run("a = []", "a.append(a)", "c.f(a)")
    assert scene.ended.alarms[0].code == "R101"


def test_secondary_programs_may_not_wait_for_procedures():
    scene = Scene(lambda method, args: result(1))
    run = scene.robot.run('sec s():\n  rpc_factory("xmlrpc", "10.0.0.1:5050").f()\nend\n')
    assert "may not wait for remote procedures" in run.warnings[0]


def test_dates_come_as_text():
    body = (
        "<methodResponse><params><param><value><dateTime.iso8601>20240102T03:04:05</dateTime.iso8601></value>"
        "</param></params></methodResponse>"
    )
    assert Scene(lambda method, args: http(body)).run("textmsg(c.when())") == ["2024-01-02T03:04:05"]


def test_reruns_are_the_same():
    def traced() -> Any:
        scene = Scene(lambda method, args: result(args))
        return scene.run("textmsg([c.f(n) for n in range(20)], ' ', controller_timestamp())"), scene.ended.time_s

    assert traced() == traced()


@pytest.mark.parametrize(
    ("url", "address", "port", "path"),
    [
        ("127.0.0.1:9120", "127.0.0.1", 9120, "/RPC2"),
        ("http://127.0.0.1:5050/RPC2", "127.0.0.1", 5050, "/RPC2"),
        ("http://6.0.0.10:60005/", "6.0.0.10", 60005, "/"),
        ("HTTP://camera/vision?x=1", "camera", 80, "/vision?x=1"),
        ("http://[::1]:80/a", "::1", 80, "/a"),
        (" camera:81/a/b ", "camera", 81, "/a/b"),
    ],
)
def test_urls(url, address, port, path):
    assert server_of(url)[1:] == (address, port, path)


@pytest.mark.parametrize(
    ("url", "words"),
    [
        ("https://a:1", "https:// is not supported"),
        ("", "the address is missing"),
        (":80", "the address is missing"),
        ("a:0", r"the port must be in \[1, 65535\]"),
        ("a:70000", "[Pp]ort"),
        ("a:b", "Port"),
        ("me:secret@a:1", "user name"),
        ("a:1/x y", "no blanks"),
        ("a:1/\r\nX: y", "no blanks|[Nn]on-printable"),
        ("http://[::1", "IPv6"),
    ],
)
def test_urls_that_make_no_sense_are_refused(url, words):
    with pytest.raises(InvalidValueError, match=words):
        server_of(url)


def test_a_handle_shows_nothing_of_its_inside():
    scene = Scene(lambda method, args: result(method))
    lines = ("textmsg(dir(c), dir(c.f))", "textmsg(c._call(), c._name())", "textmsg(c)", "textmsg(c.a.b)")
    assert scene.run(*lines) == [
        "[][]",
        "_call_name",
        "<rpc handle of http://10.0.0.1:5050/RPC2>",
        "<procedure a.b of http://10.0.0.1:5050/RPC2>",
    ]


@contextmanager
def real_server(version: str) -> Iterator[int]:
    class Handler(SimpleXMLRPCRequestHandler):
        protocol_version = version

    with SimpleXMLRPCServer(
        ("127.0.0.1", 0), Handler, logRequests=False, allow_none=True, use_builtin_types=True
    ) as server:
        server.register_function(lambda *args: list(args), "echo")
        server.register_function(lambda size: "x" * size, "text")
        server.register_introspection_functions()
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        yield server.server_address[1]
        server.shutdown()
        thread.join()


@pytest.mark.parametrize("version", ["HTTP/1.0", "HTTP/1.1"])
def test_the_server_of_the_standard_library(version):
    with real_server(version) as port:
        run = VirtualRobot().run(
            f'def job():\n  c = rpc_factory("xmlrpc", "http://127.0.0.1:{port}/RPC2")\n'
            "  textmsg(c.echo(1, 2.5, True, 'prüf', None, [1], {'a': 1}, b'xy'))\n"
            "  textmsg(len(c.text(200000)), c.system.listMethods()[0])\n  c.nothing()\nend\n",
            until_s=30.0,
        )
    assert list(run.log) == ["[1, 2.5, True, 'prüf', None, [1], {'a': 1}, b'xy']", "200000echo"]
    assert 'method "nothing" is not supported' in run.alarms[0].text


@pytest.mark.parametrize("timeout_s", [float("nan"), float("inf")])
def test_a_time_out_is_finite(timeout_s):
    with pytest.raises(UsageError, match="rpc_timeout_s must be finite"):
        VirtualRobot(rpc_timeout_s=timeout_s)
