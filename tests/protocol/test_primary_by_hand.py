"""Layouts of the primary port against tables written by hand: every field with its place, type and unit.

The places of the fields are documented (those of the joints are also found in public clients); type numbers 2, 8, 10
and 11 are assumed by elimination.
"""

from __future__ import annotations

import pytest

from elitescript.messages.enums import SafetyMode
from elitescript.messages.events import SafetyModeChanged
from elitescript.messages.machine import (
    AskSafety,
    PauseTask,
    PowerOff,
    PowerOn,
    ReleaseBrakes,
    SetSpeedScale,
    StopTask,
)
from elitescript.protocol.primary.commands import request_of
from elitescript.protocol.primary.messages import KINDS, message_of
from elitescript.protocol.primary.packets import ROBOT_STATE, STATE_SIZE, SUB_MESSAGES
from tests.protocol.snapshots import description, snapshot
from tests.tables import rows

SIZES = {
    "BOOL": 1,
    "INT8": 1,
    "UINT8": 1,
    "INT32": 4,
    "UINT32": 4,
    "UINT64": 8,
    "FLOAT": 4,
    "DOUBLE": 8,
    "VECTOR3D": 24,
    "VECTOR6D": 48,
    "6 x (DOUBLE, DOUBLE)": 96,
}
"""Bytes of each type."""

# Order on the wire: number, bytes with the head of 5, how often the fields follow each other, evidence for the number.
ORDER = """
robot mode            0    53   1   documented
joints                1   347   6   observed
cartesian             4   101   1   documented
configuration         6   445   1   documented
master board          3    88   1   documented
additional info       8    10   1   assumed
tool                  2    37   1   assumed
safety               10    43   1   assumed
tool communication   11    28   1   assumed
"""

LAYOUTS = {
    "robot mode": """
         5   UINT64   us   timestamp
        13   BOOL     .    reserved 1
        14   BOOL     .    reserved 2
        15   BOOL     .    robot power on
        16   BOOL     .    emergency stopped
        17   BOOL     .    protective stopped
        18   BOOL     .    task running
        19   BOOL     .    task paused
        20   UINT8    .    robot mode
        21   UINT8    .    control mode
        22   DOUBLE   1    target speed fraction
        30   DOUBLE   1    speed scaling
        38   DOUBLE   1    target speed fraction limit
        46   UINT8    .    robot speed mode
        47   UINT8    .    reserved 3
        48   BOOL     .    in package mode
        49   UINT32   .    reserved 4
    """,
    "joints": """
         5   DOUBLE   rad     actual position
        13   DOUBLE   rad     target position
        21   DOUBLE   rad/s   actual velocity
        29   INT32    .       target encoder pulses
        33   INT32    .       actual encoder pulses
        37   INT32    .       zero position pulses
        41   FLOAT    A       current
        45   FLOAT    V       voltage
        49   FLOAT    degC    temperature
        53   FLOAT    N m     torque
        57   UINT8    .       joint mode
        58   UINT32   .       reserved
    """,
    "cartesian": """
         5   VECTOR6D   m, rad   TCP pose
        53   VECTOR6D   m, rad   TCP offset
    """,
    "configuration": """
          5   6 x (DOUBLE, DOUBLE)   rad              joint limits
        101   6 x (DOUBLE, DOUBLE)   rad/s, rad/s^2   joint maxima
        197   DOUBLE                 rad/s            default joint velocity
        205   DOUBLE                 rad/s^2          default joint acceleration
        213   DOUBLE                 m/s              default tool velocity
        221   DOUBLE                 m/s^2            default tool acceleration
        229   DOUBLE                 m                equivalent radius
        237   VECTOR6D               m                DH a
        285   VECTOR6D               m                DH d
        333   VECTOR6D               rad              DH alpha
        381   VECTOR6D               .                reserved
        429   UINT32                 .                master board version
        433   UINT32                 .                control box type
        437   UINT32                 .                robot type
        441   UINT32                 .                robot structure
    """,
    "master board": """
         5   UINT32   bit      digital inputs
         9   UINT32   bit      digital outputs
        13   UINT8    .        analog input 0 domain
        14   UINT8    .        analog input 1 domain
        15   UINT8    .        tool analog input domain
        16   DOUBLE   A or V   analog input 0
        24   DOUBLE   A or V   analog input 1
        32   DOUBLE   A or V   tool analog input
        40   UINT8    .        analog output 0 domain
        41   UINT8    .        analog output 1 domain
        42   UINT8    .        tool analog output domain
        43   DOUBLE   A or V   analog output 0
        51   DOUBLE   A or V   analog output 1
        59   DOUBLE   A or V   tool analog output
        67   FLOAT    degC     board temperature
        71   FLOAT    V        robot voltage
        75   FLOAT    A        robot current
        79   FLOAT    A        I/O current
        83   UINT8    .        safety mode
        84   UINT8    .        in reduced mode
        85   UINT8    .        operational mode selector
        86   UINT8    .        three-position enabling device
        87   UINT8    .        internal
    """,
    "additional info": """
         5   BOOL    .   freedrive button pressed
         6   BOOL    .   reserved 1
         7   BOOL    .   freedrive by I/O enabled
         8   BOOL    .   dynamic collision detection enabled
         9   UINT8   .   reserved 2
    """,
    "tool": """
         5   UINT8    .        analog output domain
         6   UINT8    .        analog input domain
         7   DOUBLE   A or V   analog output
        15   DOUBLE   A or V   analog input
        23   FLOAT    V        tool voltage
        27   UINT8    V        output voltage
        28   FLOAT    A        tool current
        32   FLOAT    degC     tool temperature
        36   UINT8    .        tool mode
    """,
    "safety": """
         5   UINT32     .   configuration checksum
         9   INT8       .   operational mode
        10   UINT8      .   reserved
        11   VECTOR3D   m   elbow position
        35   DOUBLE     m   elbow radius
    """,
    "tool communication": """
         5   BOOL     .     enabled
         6   UINT32   1/s   baud rate
        10   UINT32   .     parity
        14   UINT32   .     stop bits
        18   BOOL     .     Modbus status
        19   UINT8    .     usage
        20   FLOAT    .     reserved 1
        24   FLOAT    .     reserved 2
    """,
}

ASSUMED_FIELDS = {("robot mode", "control mode")}
"""Fields whose values are not known from the vendor; all others are documented."""

MESSAGE_HEAD = """
     0   UINT32   length
     4   UINT8    type
     5   UINT64   timestamp
    13   UINT8    source
    14   UINT8    kind
"""

# Kind, evidence, texts at the end, and the fields behind the head. Clients know 6 and 10 alone; the layouts of the
# others are assumed from a protocol of the same family.
MESSAGES: dict[str, tuple[int, str, tuple[str, ...], str]] = {
    "text": (0, "assumed", ("text",), ""),
    "popup": (
        2,
        "assumed",
        ("title", "text"),
        """
        15   UINT32   request
        19   UINT8    requested type
        20   BOOL     is warning
        21   BOOL     is error
        22   BOOL     is blocking
        """,
    ),
    "version": (
        3,
        "assumed",
        ("build date",),
        """
        15   UINT8   name length
        16   text    name
        26   UINT8   major
        27   UINT8   minor
        28   INT32   bug fix
        32   INT32   build
        """,
    ),
    "robot error": (
        6,
        "documented",
        ("text",),
        """
        15   INT32    code
        19   INT32    sub-code
        23   INT32    level
        27   UINT32   data type
        """,
    ),
    "key": (
        7,
        "assumed",
        ("title", "text"),
        """
        15   INT32   code
        19   INT32   argument
        """,
    ),
    "script exception": (
        10,
        "documented",
        ("text",),
        """
        15   INT32   line
        19   INT32   column
        """,
    ),
}

COMMANDS = {
    "power on": PowerOn(),
    "power off": PowerOff(),
    "set robotmode run": ReleaseBrakes(),
    "pause task": PauseTask(),
    "stop task": StopTask(),
    "set unlock protective stop": AskSafety("unlock_protective_stop"),
    "restart safetyboard": AskSafety("restart_safety"),
    "set speed 0.50": SetSpeedScale(0.5),
    "set speed": None,
    "power on 1": None,
    "power": None,
}
"""Plain command lines, as the vendor's client and the ROS 2 driver send them, and lines that only look like them."""


def test_order_numbers_and_sizes() -> None:
    shown = [(part.name, str(part.number), str(part.size), str(part.repeats), part.evidence) for part in SUB_MESSAGES]
    assert shown == rows(ORDER)
    assert (ROBOT_STATE, STATE_SIZE) == (16, 1157)
    assert 5 + sum(int(size) for _, _, size, _, _ in rows(ORDER)) == 1157


@pytest.mark.parametrize("part", SUB_MESSAGES, ids=lambda part: part.name)
def test_layout(part) -> None:
    fields = [row.field for row in part.rows]
    shown = [
        (str(at), field.type.name, field.unit, field.name) for at, field in zip(part.offsets(), fields, strict=True)
    ]
    assert shown == rows(LAYOUTS[part.name])
    assert {field.type.name: field.type.size for field in fields}.items() <= SIZES.items()
    for field in fields:
        assert field.evidence == ("assumed" if (part.name, field.name) in ASSUMED_FIELDS else "documented")


@pytest.mark.parametrize("part", SUB_MESSAGES, ids=lambda part: part.name)
def test_fields_follow_each_other_without_a_gap(part) -> None:
    table = rows(LAYOUTS[part.name])
    [(size, repeats)] = [(int(row[2]), int(row[3])) for row in rows(ORDER) if row[0] == part.name]
    ends = [int(at) + SIZES[wire] for at, wire, _, _ in table]
    assert [int(at) for at, *_ in table[1:]] == ends[:-1]
    assert 5 + repeats * (ends[-1] - 5) == size


def test_kinds_of_messages() -> None:
    shown = {kind.name: (kind.number, kind.evidence, kind.texts) for kind in KINDS}
    assert shown == {name: (number, mark, texts) for name, (number, mark, texts, _) in MESSAGES.items()}


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_layout_of_messages(kind) -> None:
    wanted = [*rows(MESSAGE_HEAD), *rows(MESSAGES[kind.name][3])]
    fields, offsets = kind.fields.fields, kind.fields.offsets()
    shown = [(str(at), field.type.name, field.name) for at, field in zip(offsets, fields, strict=True)]
    assert shown == wanted
    assert [field.evidence for field in fields] == ["documented"] * 5 + [MESSAGES[kind.name][1]] * (len(fields) - 5)


@pytest.mark.parametrize("line", COMMANDS)
def test_plain_commands(line: str) -> None:
    wanted = COMMANDS[line]
    if line == "set speed":
        with pytest.raises(ValueError, match=r"takes a fraction from 0 to 1, such as 0\.50, not nothing"):
            request_of(line)
        return
    assert request_of(line) == wanted


SAFETY_LEVELS = {
    "PROTECTIVE_STOP": 2,
    "SAFEGUARD_STOP": 1,
    "SYSTEM_EMERGENCY_STOP": 2,
    "ROBOT_EMERGENCY_STOP": 2,
    "VIOLATION": 3,
    "FAULT": 3,
    "AUTOMATIC_MODE_SAFEGUARD_STOP": 1,
    "SYSTEM_THREE_POSITION_ENABLING_STOP": 1,
    "TP_THREE_POSITION_ENABLING_STOP": 1,
}
"""Level of the robot error that tells of a mode: 1 warning, 2 error, 3 fatal (assumed); other modes send none."""


@pytest.mark.parametrize("mode", SafetyMode)
def test_level_of_the_error_that_tells_of_a_safety_mode(mode: SafetyMode) -> None:
    note = message_of(SafetyModeChanged(tick=0, mode=mode))
    level = None if note is None else int.from_bytes(note.data[23:27], "big")
    assert level == SAFETY_LEVELS.get(mode.name)
    assert note is None or (note.data[13], note.data[14]) == (99, 6)


def test_what_is_not_simulated_is_sent_as_a_constant() -> None:
    shown = snapshot(), description()
    constants = {
        f"{part.name}, {row.field.name}": row.read(*shown)
        for part in SUB_MESSAGES
        for row in part.rows
        if "always" in row.field.summary or "reserved" in row.field.name
    }
    assert constants.pop("robot mode, target speed fraction limit") == 1.0
    assert constants.pop("configuration, reserved") == (0.0,) * 6
    assert set(constants.values()) == {0}
