"""Messages between two processes, cut anywhere."""

import os
import socket

import pytest

from elitescript.codec.values import CodecError
from elitescript.services.child.frames import DOWN_MAX, BlockingLine, FrameReader, frame


class TestFrameReader:
    def test_cuts_messages_out_of_any_pieces(self):
        data = frame("T", "[]") + frame("O", '["ä"]') + frame("A", "")
        for size in (1, 2, 3, 7, 100):
            reader, found = FrameReader(), []
            for at in range(0, len(data), size):
                found += reader.feed(data[at : at + size])
            assert found == [("T", b"[]"), ("O", '["ä"]'.encode()), ("A", b"")]

    def test_bytes_that_are_fed_while_messages_are_taken_follow_them(self):
        """What a message sets off may read on: each message comes once, in order."""
        first, second = b"".join(frame("T", str(number)) for number in range(3)), frame("T", "3") + frame("T", "4")
        reader, found = FrameReader(), []
        for letter, text in reader.feed(first + second[:4]):
            found.append((letter, text))
            if text == b"0":
                found += reader.feed(second[4:])
        assert [int(text) for _, text in found] == [0, 1, 2, 3, 4]

    @pytest.mark.parametrize("length", [0, DOWN_MAX + 1, 2**32 - 1])
    def test_refuses_a_length_that_is_none(self, length):
        with pytest.raises(CodecError, match="bytes"):
            list(FrameReader().feed(length.to_bytes(4, "big") + b"xxxx"))

    def test_too_long_a_message_is_not_sent(self):
        with pytest.raises(CodecError, match="at most"):
            frame("O", " " * DOWN_MAX)


class TestBlockingLine:
    @pytest.fixture
    def ends(self):
        near, far = socket.socketpair()
        with near, far:
            yield BlockingLine(near.fileno()), far

    def test_an_answer_may_overtake_what_waits(self, ends):
        line, far = ends
        far.sendall(frame("T", "1") + frame("T", "2") + frame("A", "3"))
        assert line.receive_answer("A") == b"3"
        assert [line.receive(), line.receive()] == [("T", b"1"), ("T", b"2")]

    def test_the_end_of_the_other_side_is_told(self, ends):
        line, far = ends
        far.shutdown(socket.SHUT_WR)
        with pytest.raises(EOFError):
            line.receive()

    def test_sends_what_the_other_side_reads(self, ends):
        line, far = ends
        line.send("O", "[1]")
        assert list(FrameReader().feed(os.read(far.fileno(), 100))) == [("O", b"[1]")]
