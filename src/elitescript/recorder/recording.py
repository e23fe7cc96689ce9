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
        channel: `primary`, `dashboard`, `events` (of the recorder: connected, lost, gap, repeated, restart,
            clock).
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
            recording did not have the variable. SI units, base frame, as RTSI has them. Registers and settings that
            were 0 all the time are left out.
        rate_hz: of the rows.
        gaps: last row before and first row after each stretch without rows that should have some, s of the controller.
        restarts: indices of rows at which the controller's time began anew.
        messages: of the other ports, in the order of arrival.
        facts: what is known of the controller, each missing where it was not shown: `model`, `version`, `serial`,
            `task`, `tcp_offset`; of the primary port's configuration `lengths` (a, d, alpha), `limits` (q_min, q_max,
            qd_max, qdd_max), `defaults` (joint_speed, joint_acceleration, tool_speed, tool_acceleration); of the
            recorder `host`, and `program`, `world`, `robot` as they were given (names of attachments; of a robot the
            model, if it was no file), `begin_ns` (UTC, ns since 1970), `clock_offset_s` (UTC less the time of the
            controller, at the first row).
        attachments: program, world and arm files that were given, by name.
        is_cut_off: whether the last file has lost its end: its recorder was killed, or it was truncated.
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
    is_cut_off: bool = False
