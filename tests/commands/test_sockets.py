"""The socket commands: arguments, what goes out, and the form of what comes back."""

from __future__ import annotations

from math import isnan

import pytest

from elitescript.errors import ArgumentRangeError, ArgumentTypeError


@pytest.fixture
def sockets(robot):
    return robot.sockets


def test_the_name_is_the_usual_one_unless_another_is_given(script, sockets):
    script("socket_open('10.0.0.1', 80)")
    script("socket_open('10.0.0.1', 80, '')")
    script("socket_open('10.0.0.1', 80, 'a')")
    script("socket_close()")
    script("socket_is_connected(socket_name='a')")
    assert sockets.asked == [
        ("open", "10.0.0.1", 80, "socket_0"),
        ("open", "10.0.0.1", 80, "socket_0"),
        ("open", "10.0.0.1", 80, "a"),
        ("close", "socket_0"),
        ("is_connected", "a"),
    ]


@pytest.mark.parametrize(
    ("call", "data"),
    [
        ("socket_send_int(10)", b"\x00\x00\x00\x0a"),
        ("socket_send_int(-2)", b"\xff\xff\xff\xfe"),
        ("socket_send_int(True)", b"\x00\x00\x00\x01"),
        ("socket_send_byte(10)", b"\n"),
        ("socket_send_byte(300)", b"\x2c"),
        ("socket_send_byte(-1)", b"\xff"),
        ("socket_send_byte('a')", b"a"),
        ("socket_send_byte('')", b""),
        ("socket_send_line('Hello')", b"Hello\n"),
        ("socket_send_line('Hello', 1)", b"Hello\r"),
        ("socket_send_line('Hello', 2)", b"Hello\r\n"),
        ("socket_send_string('a\\n')", b"a\n"),
        ("socket_send_string('é')", b"\xc3\xa9"),
        ("socket_send_string('\\ud800')", b"?"),
        ("socket_send_string(1.5)", b"1.5"),
        ("socket_send_string(2.0)", b"2"),
        ("socket_send_string(True)", b"True"),
        ("socket_send_string([1, 2.5, 'x'])", b"[1, 2.5, 'x']"),
        ("socket_send_string('x' * 5000)", b"x" * 5000),
    ],
)
def test_what_is_sent(script, sockets, call, data):
    assert script(call) is True
    assert sockets.asked == [("send", "socket_0", data)]


def test_sending_bytes_gives_their_number(script, sockets):
    assert script("socket_send_byte_list([1, 0x3, 0x2E, 3])") == 4
    assert sockets.asked == [("send", "socket_0", b"\x01\x03.\x03")]
    sockets.stands = False
    assert script("socket_send_byte_list([1])") == 0


def test_sending_without_a_connection_fails(script, sockets):
    sockets.stands = False
    calls = ("socket_send_int(1)", "socket_send_byte(1)", "socket_send_line('')", "socket_send_string('')")
    assert [script(call) for call in calls] == [False] * 4


def test_variables_of_the_server(script, sockets):
    sockets.received += b"JOINT_0 1000\n"
    assert script("socket_get_var('JOINT_0')") == 1000
    script("socket_set_var('JOINT_0', -5, 'a')")
    assert sockets.asked == [
        ("send", "socket_0", b"GET JOINT_0\n"),
        ("read", "socket_0", 2.0),
        ("send", "a", b"SET JOINT_0 -5\n"),
    ]


def test_a_variable_is_not_waited_for_when_it_could_not_be_asked_for(script, sockets):
    sockets.stands = False
    assert script("socket_get_var('JOINT_0')") == 0
    assert [call[0] for call in sockets.asked] == ["send"]


def test_lists_say_how_much_of_them_arrived(script, sockets):
    sockets.received += b"\x00\x00\x00\x64\x00\x00\x00\xc8"
    assert script("socket_read_binary_integer(3)") == [2, 100, 200, -1]
    assert script("socket_read_binary_integer(3)") == [0, -1, -1, -1]
    sockets.received += b"\x64\xc8"
    assert script("socket_read_byte_list(3)") == [2, 100, 200, -1]
    sockets.received += b"(3.12, 3.11)"
    count, first, second, missing = script("socket_read_ascii_float(3)")
    assert (count, first, second, isnan(missing)) == (2, 3.12, 3.11, True)


def test_time_limits_are_passed_on(script, sockets):
    script("socket_read_binary_integer(26, 'c', 0)")
    script("socket_read_string(timeout=-1)")
    script("socket_read_byte_list(1)")
    assert sockets.asked == [("read", "c", 0.0), ("read", "socket_0", -1.0), ("read", "socket_0", 2.0)]


def test_texts_between_marks(script, sockets):
    sockets.received += b"..<111>"
    assert script("socket_read_string(prefix='<', suffix='>')") == "111"


@pytest.mark.parametrize(
    ("call", "kind", "text"),
    [
        ("socket_read_string(prefix='x' * 2048)", ArgumentRangeError, "prefix must have at most 2047 bytes, got 2048"),
        ("socket_read_string(suffix='é' * 1024)", ArgumentRangeError, "suffix must have at most 2047 bytes, got 2048"),
        ("socket_send_string(print)", ArgumentTypeError, "str must be a text, a number or a list"),
        ("socket_send_string(b'ab')", ArgumentTypeError, "str must be a text, a number or a list, not bytes b'ab'"),
        ("socket_send_string(bytearray(b'ab'))", ArgumentTypeError, "str must be a text, a number or a list"),
        ("socket_send_string(None)", ArgumentTypeError, "str must be a text, a number or a list, not None"),
        ("socket_send_string({'a': 1})", ArgumentTypeError, "str must be a text, a number or a list"),
        ("socket_send_string((1, 2))", ArgumentTypeError, "str must be a text, a number or a list"),
        ("socket_send_byte('ab')", ArgumentRangeError, "value must be a number or one character, got 'ab'"),
        ("socket_open('h', 70000)", ArgumentRangeError, "port must be in"),
        ("socket_read_binary_integer(31)", ArgumentRangeError, "number must be in"),
        ("socket_read_string(timeout=float('nan'))", ArgumentRangeError, "timeout must be a finite number"),
    ],
)
def test_what_makes_no_sense_is_refused(script, sockets, call, kind, text):
    with pytest.raises(kind, match=text):
        script(call)
    assert sockets.asked == []
