"""A child that starts in a few milliseconds, says what it is given, and misbehaves after its first answer.

Arguments: how it misbehaves; files with its description and an output; the number of its socket.
"""

import json
import os
import struct
import sys

HOW, DESCRIPTION, OUTPUT = sys.argv[1:4]
DESCRIPTOR = int(sys.argv[4])
MARK = "987654321"
"""Stands for the tick in the output."""


def receive(size):
    data = b""
    while len(data) < size:
        piece = os.read(DESCRIPTOR, size - len(data))
        if not piece:
            os._exit(0)
        data += piece
    return data


def say(letter, text):
    body = (letter + text).encode()
    os.write(DESCRIPTOR, struct.pack(">I", len(body)) + body)


def content(name):
    with open(name, encoding="utf-8") as file:  # noqa: PTH123
        return file.read()


def misbehave():
    if HOW == "exit":
        os._exit(3)
    elif HOW == "abort":
        os.abort()
    elif HOW == "flood":
        while True:
            os.write(2, b"x" * 65536)
    elif HOW == "questions":
        question = b'Q["kind","a"]'
        os.write(DESCRIPTOR, 2 * (struct.pack(">I", len(question)) + question))
    elif HOW == "garbage":
        os.write(DESCRIPTOR, b"\xff" * 1000)


def main():
    tick = 0
    while True:
        body = receive(struct.unpack(">I", receive(4))[0])
        letter = chr(body[0])
        if letter == "L":
            if HOW == "boot":
                sys.stderr.write("it does not come up\n")
                sys.stderr.flush()
                os._exit(3)
            say("L", "[]")
        elif letter == "B":
            tick = json.loads(body[1:])["first_tick"]
            say("D", content(DESCRIPTION))
        elif letter == "T":
            say("O", "\0" * 25 + content(OUTPUT).replace(MARK, str(tick)))
            tick += 1
            misbehave()


main()
