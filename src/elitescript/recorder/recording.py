"""What was recorded of a controller: columns of the rows of RTSI, and messages of the other ports.

A recording of an hour has 900,000 rows, so numbers stand in arrays, one for each element of a variable.
"""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from typing import Any

from elitescript.records import field, record


@record
class Message:
    """Something that another port than RTSI, or the recorder, said once.

    Attributes:
        t: time of the controller, s, of the row before it; of the first row if it came before.
        arrived_s: when it came, s since the begin of the recording, by the clock of the recorder.
        channel: `primary`, `dashboard`, `events` (of the recorder: lost, back, gaps).
        data: the record as JSON has it, with its `type`.
    """

    t: float
    arrived_s: float
    channel: str
    data: Mapping[str, Any]


@record
class Recording:
    """A recording, all of its files together.

    Attributes:
        t: time of the controller of each row, s; rises, but for `restarts`.
        arrived_s: when each row came, s since the begin of the recording, by the clock of the recorder.
        columns: values of each variable by its name in RTSI; of a vector `NAME.0` and so on. NaN where a part of the
            recording did not have the variable. SI units, base frame, as RTSI has them.
        rate_hz: of the rows.
        gaps: begin and end, s of the controller, of each stretch without rows that should have some.
        restarts: indices of rows at which the controller's time began anew.
        messages: of the other ports, in the order of arrival.
        facts: what is known of the controller: `model`, `version`, `serial`, `tcp_offset`, `lengths`
            (a, d, alpha of the primary port's configuration), `limits`, `host`, each missing where it was not shown.
        attachments: program, world and arm files that were given, by name.
    """

    t: array[float]
    arrived_s: array[float]
    columns: Mapping[str, array[float]]
    rate_hz: float
    gaps: tuple[tuple[float, float], ...] = ()
    restarts: tuple[int, ...] = ()
    messages: tuple[Message, ...] = ()
    facts: Mapping[str, Any] = field(default_factory=dict)
    attachments: Mapping[str, bytes] = field(default_factory=dict)
