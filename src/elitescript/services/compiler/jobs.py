"""Texts to compile, as messages: from the process of a robot through its parent, unread, to the compiler."""

from __future__ import annotations

import struct
from typing import Final

from elitescript.codec.json_text import from_text, to_text
from elitescript.codec.values import CodecError
from elitescript.kernel.compiling import Job

PORTION_BYTES: Final = 256 * 1024
"""Bytes of a text that leave the process of a robot in a tick."""
_HEAD: Final = struct.Struct(">q?")


def portion(number: int, data: bytes, is_last: bool) -> bytes:
    """Return the content of a message with a part of a job."""
    return _HEAD.pack(number, is_last) + data


def read_portion(content: bytes) -> tuple[int, bool, bytes]:
    """Return what `portion` was given.

    Raises:
        CodecError: there is no such thing in it.
    """
    if len(content) < _HEAD.size:
        raise CodecError("a part of a text without its number")
    return *_HEAD.unpack_from(content), content[_HEAD.size :]


def job_bytes(job: Job) -> bytes:
    """Return a job: a line of JSON, then the text."""
    return f"{to_text([*job._replace(text='')])}\n".encode() + job.text.encode("utf-8", "surrogatepass")


def read_job(data: bytes) -> Job:
    """Return the job that `job_bytes` was given."""
    head, _, text = data.partition(b"\n")
    job = Job(*from_text(head))
    return job._replace(text=text.decode("utf-8", "surrogatepass"), presets=tuple(job.presets))
