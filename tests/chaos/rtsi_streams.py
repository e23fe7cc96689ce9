"""What a client of the RTSI port got, read as the product reads a controller: every package whole, none lost."""

from __future__ import annotations

import struct
from math import isnan

from elitescript.client.rtsi_messages import FrameReader, LossCounter, OutputLayout, set_up_of
from elitescript.errors import PeerError
from elitescript.protocol.rtsi.recipes import FREQUENCY_MAX_HZ, FREQUENCY_MIN_HZ

OUTPUT_RECIPE, PAUSE, PACKAGE = map(ord, "OPU")
TIME = "timestamp"


class Lost(Exception):
    """Packages are missing."""


def check(sent: bytes, received: bytes) -> None:
    """Read everything that a client got.

    Args:
        sent: what it has said; what the answers mean is known only if that can be read.
        received: what came.

    Raises:
        PeerError: what came cannot be read.
        Lost: a package is missing.
    """
    answers = FrameReader().feed(received)
    try:
        requests = FrameReader().feed(sent)
    except PeerError:
        return
    asked = [frame.payload for frame in requests if frame.command == OUTPUT_RECIPE and len(frame.payload) > 8]
    answered = [frame.payload for frame in answers if frame.command == OUTPUT_RECIPE]
    if len(asked) < len(answered):
        return
    layouts: dict[int, tuple[OutputLayout, LossCounter]] = {}
    for request, answer in zip(asked, answered, strict=False):
        try:
            names = request[8:].decode("ascii").split(",")
        except UnicodeDecodeError:
            return
        wanted_hz = struct.unpack_from(">d", request)[0]
        if isnan(wanted_hz):
            continue  # Refused as a whole.
        found = set_up_of(answer, names, "output")
        if found.is_complete:
            rate_hz = min(max(wanted_hz, FREQUENCY_MIN_HZ), FREQUENCY_MAX_HZ)
            layouts[found.ident] = OutputLayout(found.ident, names, found.words, rate_hz), LossCounter(rate_hz)
    is_paused = any(frame.command == PAUSE for frame in requests)
    for frame in answers:
        if frame.command == PACKAGE:
            layout, counter = layouts[frame.payload[0]]
            numbers = layout.flat(frame.payload)
            if TIME in layout.names and not is_paused:
                time_s = layout.getter(TIME)(numbers)
                if counter.take(time_s):
                    raise Lost(f"{counter.lost} before {time_s} s at {layout.frequency_hz:g} Hz")
