"""What the reading commands find in a stream, however it is cut into pieces."""

from __future__ import annotations

import random
import struct

import pytest

from elitescript.commands import socket_rules as rules


def read(rule, data):
    """What a rule finds when all of that has arrived and no more will come, and what it leaves."""
    value, used = rule(bytearray(data), True)
    return value, data[used:]


def fed(rule, data, sizes):
    """What a rule finds first when a stream arrives in pieces of these sizes; None if it wants more."""
    received, rest = bytearray(), data
    for size in sizes:
        received += rest[:size]
        rest = rest[size:]
        value, used = rule(received, False)
        del received[:used]
        if value is not None:
            return value, bytes(received) + rest
    return None, bytes(received) + rest


class TestNumbers:
    def test_integers_are_signed_and_in_network_order(self):
        data = struct.pack(">4i", 1, -2, 2**31 - 1, -(2**31)) + b"rest"
        assert read(rules.integers(4), data) == ([1, -2, 2**31 - 1, -(2**31)], b"rest")

    def test_only_complete_integers_count(self):
        assert read(rules.integers(3), b"\x00\x00\x00\x01\x00\x00") == ([1], b"\x00\x00")
        assert rules.integers(3)(bytearray(b"\x00\x00\x00\x01\x00\x00"), False) == (None, 0)

    def test_bytes(self):
        assert read(rules.octets(3), b"\x00\xff\x07\x01") == ([0, 255, 7], b"\x01")
        assert read(rules.octets(3), b"\x00") == ([0], b"")
        assert read(rules.octets(3), b"") == ([], b"")


class TestFloats:
    @pytest.mark.parametrize(
        "data", [b"(3.14, 2.562, 8.24, 3.4434)", b"(3.14, ,,2.562, ,8.24, 3.4434)", b"(3.14 2.562 8.24 3.4434)"]
    )
    def test_the_lists_of_the_manual(self, data):
        assert read(rules.Floats(4), data) == ([3.14, 2.562, 8.24, 3.4434], b"")

    def test_what_stands_before_the_list_is_skipped(self):
        assert read(rules.Floats(2), b"12) noise (1,-2e3)(3)") == ([1.0, -2000.0], b"(3)")

    def test_a_shorter_list_is_all_there_is_and_comes_at_once(self):
        assert rules.Floats(3)(bytearray(b"(1.444, 2.234)"), False) == ([1.444, 2.234], 14)

    def test_of_a_longer_list_the_rest_is_dropped(self):
        assert read(rules.Floats(2), b"(1,2,3)(4)") == ([1.0, 2.0], b"(4)")

    def test_of_an_unfinished_one_the_numbers_count_that_are_surely_complete(self):
        assert read(rules.Floats(3), b"(3.12, 3.11, 8.2") == ([3.12, 3.11], b"8.2")
        assert read(rules.Floats(3), b"(3.1") == ([], b"3.1")

    @pytest.mark.parametrize(
        ("data", "values"), [(b"(1, x, 2)", [1.0]), (b"(1_000)", []), (b"()", []), (b"(\xff)", [])]
    )
    def test_it_ends_in_front_of_what_is_no_number(self, data, values):
        assert read(rules.Floats(3), data) == (values, b"")

    def test_without_a_parenthesis_nothing_is_found_or_used(self):
        assert read(rules.Floats(1), b"1.5") == ([], b"1.5")

    def test_noise_and_endless_lists_are_given_up(self):
        assert rules.Floats(1)(bytearray(b"x" * 3000), False) == (None, 3000)
        value, used = rules.Floats(1)(bytearray(b"(" + b"1," * 1500), False)
        assert (value, used) == ([1.0], 3001)


class TestText:
    def test_without_marks_it_is_all_there_is(self):
        assert read(rules.Texts(b"", b""), b"abc") == ("abc", b"")

    def test_behind_a_prefix(self):
        assert read(rules.Texts(b"<", b""), b"12<34") == ("34", b"")

    def test_in_front_of_a_suffix(self):
        assert read(rules.Texts(b"", b"\r\n"), b"one\r\ntwo") == ("one", b"two")

    def test_the_loop_of_the_manual(self):
        rule, rest, found = rules.Texts(b"<", b">"), b"<111><222><333><444>", []
        while rest:
            text, rest = read(rule, rest)
            found.append(text)
        assert found == ["111", "222", "333", "444"]
        assert read(rule, rest) == ("", b"")

    @pytest.mark.parametrize("data", [b"", b"abc", b"ab<", b"ab<cd"])
    def test_a_text_without_its_end_stays(self, data):
        assert read(rules.Texts(b"<", b">"), data) == ("", data)
        assert rules.Texts(b"<", b">")(bytearray(data), False) == (None, 0)

    def test_an_empty_line_is_used_up(self):
        assert read(rules.Texts(b"", b"\n"), b"\nnext") == ("", b"next")

    def test_marks_may_be_long_and_alike(self):
        assert read(rules.Texts(b"--", b"--"), b"x----y--z") == ("", b"y--z")

    @pytest.mark.parametrize(("suffix", "size"), [(b"", 2047), (b"\n", 2047)])
    def test_at_most_so_much_comes_at_once(self, suffix, size):
        data = b"x" * 3000 + suffix
        text, rest = read(rules.Texts(b"", suffix), data)
        assert (len(text), rest) == (size, data[size:])
        assert fed(rules.Texts(b"", suffix), data, [10] * 300)[0] is not None

    def test_the_longest_line_is_one(self):
        assert read(rules.Texts(b"", b"\n"), b"x" * 2047 + b"\nz") == ("x" * 2047, b"z")

    def test_what_comes_before_a_prefix_does_not_fill_the_buffer(self):
        value, used = rules.Texts(b"<<", b"")(bytearray(b"-" * 20000 + b"<"), False)
        assert (value, used) == (None, 20000)

    def test_other_alphabets_and_what_is_none(self):
        assert read(rules.Texts(b"", b"\n"), "位置é\n".encode()) == ("位置é", b"")
        assert read(rules.Texts(b"", b"\n"), b"a\xffb\n") == ("a\ufffdb", b"")

    def test_a_character_in_two_pieces_is_not_torn(self):
        data = "é".encode()
        assert rules.Texts(b"", b"")(bytearray(b"a" + data[:1]), False) == ("a", 1)
        assert rules.Texts(b"", b"")(bytearray(data[:1]), False) == (None, 0)
        assert read(rules.Texts(b"", b""), data[:1]) == ("\ufffd", b"")
        assert rules.Texts(b"", b"")(bytearray(b"a" + data[:1]), True) == ("a", 1)


class TestVariables:
    @pytest.mark.parametrize(
        ("line", "value"),
        [
            (b"J 1000\n", 1000),
            (b"J -7\r\n", -7),
            (b"J +7\n", 7),
            (b"J 0000000000000012\n", 12),
            (b"J 2147483648\n", 2147483647),
            (b"J -99999999999999999999999\n", -2147483648),
            (b"K 1\n", 0),
            (b"J\n", 0),
            (b"J 1 2\n", 0),
            (b"J 1.5\n", 0),
            (b"J 1_0\n", 0),
            (b"J --1\n", 0),
            (b"J \xc2\xb2\n", 0),
            (b"\n", 0),
            (b"J 1", 0),
        ],
    )
    def test_only_the_right_answer_counts(self, line, value):
        assert read(rules.Variable("J"), line)[0] == value


@pytest.mark.invariants
def test_how_a_stream_is_cut_does_not_matter():
    """What a rule finds first in pieces is what it finds in the whole, where it waits for an end at all."""
    random_ = random.Random(3)
    found = 0
    for _ in range(3000):
        data = bytes(random_.choice(b"<>(),1 \n\x00") for _ in range(random_.randrange(40)))
        rule = random_.choice(
            [
                rules.integers(2),
                rules.octets(3),
                rules.Floats(2),
                rules.Texts(b"<", b">"),
                rules.Texts(b"", b"\n"),
                rules.Variable("1"),
            ]
        )
        sizes = [random_.randrange(1, 6) for _ in range(40)]
        whole = fed(rule, data, [len(data)])
        assert fed(rule, data, sizes)[0] == whole[0]
        if whole[0] is not None:
            assert fed(rule, data, sizes) == whole
            found += 1
    assert found > 1000
