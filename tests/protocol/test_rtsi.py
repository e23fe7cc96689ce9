"""One client of the RTSI port: bytes in, inputs and bytes out."""

from __future__ import annotations

import random
import struct
from typing import Any

import pytest

from elitescript.messages.inputs import AddLog, Do, VariablesArrived
from elitescript.messages.machine import SetSpeedScale, WriteSignal
from elitescript.protocol.connection import ProtocolError
from elitescript.protocol.rtsi.connection import COMMANDS, RtsiConnection
from elitescript.protocol.rtsi.inputs import INPUTS
from elitescript.protocol.rtsi.recipes import RtsiPort
from elitescript.protocol.rtsi.variables import OUTPUTS
from tests.protocol.rtsi_client import (
    STANDARD_INPUTS,
    STANDARD_OUTPUTS,
    input_recipe,
    message,
    messages,
    output_recipe,
    package,
    set_up,
    text,
    values,
)
from tests.protocol.snapshots import description, output

SLIDER = ["speed_slider_mask", "speed_slider_fraction"]
SLIDER_TYPES = ["UINT32", "DOUBLE"]
START, PAUSE = message("S"), message("P")


def connect(origin: str = "rtsi#1", port: RtsiPort | None = None) -> RtsiConnection:
    return RtsiConnection(origin, description(), port or RtsiPort())


def told(client: RtsiConnection) -> list[tuple[str, bytes]]:
    """What the client hears; every write is one message."""
    writes = client.take()
    assert all(len(messages(write)) == 1 for write in writes)
    return messages(b"".join(writes))


def ask(client: RtsiConnection, data: bytes, tick: int = 1000, **changes: Any) -> list[tuple[str, bytes]]:
    """What the client hears when it sends something that asks nothing of the robot but lines of the log."""
    assert all(isinstance(item, AddLog) for item in client.receive(data, output(tick, **changes)))
    return told(client)


def run(client: RtsiConnection, ticks: range) -> list[int]:
    """Ticks of this range at which a package comes."""
    due = []
    for tick in ticks:
        client.publish(output(tick))
        if client.take():
            due.append(tick)
    return due


# ---------------------------------------------------------------- commands


def test_version_1_is_accepted() -> None:
    assert ask(connect(), message("V", b"\0\x01")) == [("V", b"\x01")]


@pytest.mark.parametrize("body", [b"\0\0", b"\0\x02", b"\x01\0", b"", b"\x01", b"\0\x01\0"])
def test_every_other_version_is_refused_with_a_reason(body: bytes) -> None:
    refusal, (letter, reason) = ask(connect(), message("V", body))
    assert refusal == ("V", b"\0")
    assert (letter, reason[0]) == ("M", 1)
    assert b"version is 1" in reason


def test_the_version_of_the_controller_is_four_words() -> None:
    assert ask(connect(), message("v")) == [("v", struct.pack(">4I", 2, 14, 2, 7))]


def test_a_text_of_the_client_goes_to_the_log() -> None:
    client = connect("rtsi#7")
    assert client.receive(text("door open", "cell", 2), output()) == [AddLog("rtsi#7", "warning: cell: door open")]
    assert client.receive(text("hello", "", 0), output()) == [AddLog("rtsi#7", "exception: hello")]
    assert client.receive(text("", "cell", 9), output()) == [AddLog("rtsi#7", "level 9: cell: ")]
    assert told(client) == []


@pytest.mark.parametrize("body", [b"", b"\x05hi", b"\x02hi", b"\x02hi\x03ab\x01", b"\x02hi\x00", b"\x02hi\x00\x01more"])
def test_a_text_of_the_wrong_length_is_answered_with_a_reason(body: bytes) -> None:
    ((letter, reason),) = ask(connect(), message("M", body))
    assert (letter, reason[0]) == ("M", 1)


def test_set_ups_tell_number_and_types() -> None:
    client = connect()
    ((letter, payload),) = ask(client, output_recipe(250.0, STANDARD_OUTPUTS))
    assert (letter, set_up(payload)) == ("O", (1, [OUTPUTS[name].type.name for name in STANDARD_OUTPUTS]))
    ((letter, payload),) = ask(client, input_recipe(STANDARD_INPUTS))
    assert (letter, set_up(payload)) == ("I", (1, [INPUTS[name].name for name in STANDARD_INPUTS]))


def test_inputs_and_outputs_are_numbered_apart() -> None:
    client = connect()
    data = output_recipe(250, ["timestamp"]) + input_recipe(SLIDER) + output_recipe(125, ["robot_mode"])
    data += input_recipe(SLIDER) + input_recipe(["input_int_register0"])
    assert [(letter, payload[0]) for letter, payload in ask(client, data)] == [
        ("O", 1),
        ("I", 1),
        ("O", 2),
        ("I", 2),
        ("I", 3),
    ]


@pytest.mark.parametrize("end", ["", ",", ",,"])
def test_commas_at_the_end_are_no_names(end: str) -> None:
    client = connect()
    assert ask(client, message("I", f"speed_slider_mask{end}".encode())) == [("I", b"\x01UINT32")]
    assert ask(client, message("O", struct.pack(">d", 125) + f"timestamp,robot_mode{end}".encode())) == [
        ("O", b"\x01DOUBLE,INT32")
    ]


def test_missing_variables_are_told_in_their_place_and_the_recipe_has_no_number() -> None:
    client = connect()
    names = ["timestamp", "speed_slider_mask", "", "output_int_register48", "output_bit_register63", "robot_mode"]
    ((_, payload),) = ask(client, output_recipe(250, names))
    assert set_up(payload) == (0, ["DOUBLE", "NOT_FOUND", "NOT_FOUND", "NOT_FOUND", "NOT_FOUND", "INT32"])
    ((_, payload),) = ask(client, input_recipe(["timestamp", "speed_slider_mask"]))
    assert set_up(payload) == (0, ["NOT_FOUND", "UINT32"])
    # The connection is as good as new.
    assert [payload[0] for _, payload in ask(client, output_recipe(250, ["timestamp"]) + input_recipe(SLIDER))] == [
        1,
        1,
    ]


@pytest.mark.parametrize(
    "body", [b"", b"\0" * 7, b"\0" * 8, struct.pack(">d", 125) + b",", struct.pack(">d", 125) + b"\xff"]
)
def test_an_output_recipe_without_frequency_or_known_names_has_no_number(body: bytes) -> None:
    answers = ask(connect(), message("O", body))
    assert answers[0][0] == "O"
    assert answers[0][1][0] == 0


def test_an_input_recipe_without_names_is_refused_with_a_reason() -> None:
    (letter, payload), (_, reason) = ask(connect(), message("I"))
    assert (letter, payload) == ("I", b"\0")
    assert b"at least one variable" in reason


def test_start_and_pause_are_answered_with_one_byte() -> None:
    client = connect()
    assert ask(client, START + PAUSE + PAUSE + START) == [
        ("S", b"\x01"),
        ("P", b"\x01"),
        ("P", b"\x01"),
        ("S", b"\x01"),
    ]


def test_an_unknown_command_is_answered_with_a_reason_and_skipped() -> None:
    (letter, reason), answer = ask(connect(), message("x", b"abc") + message("V", b"\0\x01"))
    assert (letter, reason[0]) == ("M", 1)
    assert b"no command 'x'" in reason
    assert answer == ("V", b"\x01")


def test_the_table_of_commands_is_what_is_obeyed() -> None:
    known = {command.letter for command in COMMANDS}
    for code in range(256):
        answers = ask(connect(), message(chr(code)) if code < 128 else struct.pack(">HB", 3, code))
        is_unknown = any(b"there is no command" in payload for _, payload in answers)
        assert is_unknown == (chr(code) not in known)


# ---------------------------------------------------------------- data


def test_the_first_package_comes_with_the_start_and_then_one_a_tick() -> None:
    client = connect()
    ask(client, output_recipe(250, ["timestamp", "robot_mode"]))
    assert run(client, range(995, 1000)) == []
    start, (letter, payload) = ask(client, START, tick=1000)
    assert (start, letter, payload[0]) == (("S", b"\x01"), "U", 1)
    assert values(payload, ["DOUBLE", "INT32"]) == [4.0, 7]
    assert run(client, range(1000, 1010)) == list(range(1001, 1010))


def test_values_are_those_of_the_tick() -> None:
    client = connect()
    ask(client, output_recipe(250, ["timestamp", "actual_joint_positions", "output_int_register7"]) + START)
    for tick in (1001, 1002, 1003):
        q = (tick / 10,) * 6
        client.publish(output(tick, q_actual=q, signals={"output_int_register": {7: tick}}))
        ((_, payload),) = told(client)
        assert values(payload, ["DOUBLE", "VECTOR6D", "INT32"]) == [tick / 250, q, tick]


def test_recipes_have_their_own_frequencies() -> None:
    client = connect()
    ask(
        client,
        output_recipe(250, ["timestamp"]) + output_recipe(125, ["robot_mode"]) + output_recipe(50, ["io_current"]),
    )
    answers = ask(client, START, tick=1000)
    assert [payload[0] for letter, payload in answers if letter == "U"] == [1, 2, 3]
    heard: dict[int, list[int]] = {1: [], 2: [], 3: []}
    for tick in range(1001, 1011):
        client.publish(output(tick))
        for _, payload in told(client):
            heard[payload[0]].append(tick)
    assert heard == {1: list(range(1001, 1011)), 2: [1002, 1004, 1006, 1008, 1010], 3: [1005, 1010]}


@pytest.mark.parametrize(("wanted", "got"), [(500, 250), (0, 1), (-3, 1), (float("inf"), 250), (0.99, 1), (250.5, 250)])
def test_a_frequency_out_of_range_is_clamped_and_said(wanted: float, got: int) -> None:
    client = connect()
    (letter, payload), (kind, reason) = ask(client, output_recipe(wanted, ["timestamp"]))
    assert (letter, payload, kind, reason[0]) == ("O", b"\x01DOUBLE", "M", 2)
    assert f"at {got} Hz" in reason.decode()
    ask(client, START, tick=1000)
    assert len(run(client, range(1001, 1501))) == 2 * got


def test_a_frequency_that_is_no_number_is_refused() -> None:
    (_, payload), (_, reason) = ask(connect(), output_recipe(float("nan"), ["timestamp"]))
    assert set_up(payload) == (0, ["DOUBLE"])
    assert b"nan" in reason


def test_after_a_pause_nothing_comes_until_the_next_start() -> None:
    client = connect()
    ask(client, output_recipe(125, ["timestamp"]) + START, tick=1000)
    assert ask(client, PAUSE, tick=1003) == [("P", b"\x01")]
    assert run(client, range(1004, 1050)) == []
    assert [letter for letter, _ in ask(client, START, tick=1051)] == ["S", "U"]
    assert run(client, range(1052, 1058)) == [1053, 1055, 1057]


def test_a_second_start_changes_nothing() -> None:
    client = connect()
    ask(client, output_recipe(50, ["timestamp"]) + START, tick=1000)
    assert ask(client, START, tick=1002) == [("S", b"\x01")]
    assert run(client, range(1003, 1011)) == [1005, 1010]


def test_a_recipe_that_is_added_while_data_flows_begins_with_the_next_tick() -> None:
    client = connect()
    ask(client, START + output_recipe(10, ["timestamp"]), tick=1000)
    assert run(client, range(1001, 1030)) == [1001, 1026]


def test_clients_with_the_same_recipe_get_the_same_values_under_their_own_numbers() -> None:
    port = RtsiPort()
    first, second = connect("rtsi#1", port), connect("rtsi#2", port)
    ask(first, output_recipe(250, ["timestamp", "robot_mode"]) + START)
    ask(second, output_recipe(1, ["io_current"]) + output_recipe(250, ["timestamp", "robot_mode"]) + START)
    tick = output(1001)
    first.publish(tick)
    second.publish(tick)
    ((_, one),), ((_, two),) = told(first), told(second)
    assert (one[0], two[0]) == (1, 2)
    assert one[1:] == two[1:]


# ---------------------------------------------------------------- inputs


def slider(mask: int, fraction: float, ident: int = 1) -> bytes:
    return package(ident, SLIDER_TYPES, [mask, fraction])


def test_a_package_asks_for_its_requests_and_tells_what_has_arrived() -> None:
    client = connect("rtsi#4")
    ask(client, input_recipe(SLIDER))
    tick = output()
    assert client.receive(slider(1, 0.5) + slider(0, 0.5), tick) == [
        Do("rtsi#4", SetSpeedScale(0.5)),
        VariablesArrived("rtsi#4", tuple(SLIDER)),
        VariablesArrived("rtsi#4", tuple(SLIDER)),
    ]
    assert told(client) == []


def test_inputs_count_while_paused_and_while_data_flows() -> None:
    client = connect()
    ask(client, output_recipe(250, ["timestamp"]) + START + PAUSE + input_recipe(SLIDER))
    expected = [Do("rtsi#1", SetSpeedScale(0.5)), VariablesArrived("rtsi#1", tuple(SLIDER))]
    assert client.receive(slider(1, 0.5), output()) == expected
    ask(client, START)
    assert client.receive(slider(1, 0.5), output()) == expected


def test_the_first_package_after_an_input_is_of_a_tick_that_knows_it() -> None:
    # A client of the vendor's writes the slider while paused, starts, and takes the first package for the answer.
    client = connect()
    ask(client, output_recipe(250, ["target_speed_fraction"]) + input_recipe(SLIDER))
    assert len(client.receive(slider(1, 0.5) + START, output(1000))) == 2
    assert told(client) == [("S", b"\x01")]
    client.publish(output(1001, speed_scale=0.5))
    ((_, payload),) = told(client)
    assert values(payload, ["DOUBLE"]) == [0.5]
    # Sent a tick before the start, it is known already.
    client.receive(PAUSE + slider(1, 0.25), output(1001))
    told(client)
    start, (letter, _) = ask(client, START, tick=1002)
    assert (start, letter) == (("S", b"\x01"), "U")


def test_an_input_sent_while_a_tick_is_under_way_is_in_the_first_package_after_the_start() -> None:
    client = connect()
    ask(client, output_recipe(250, ["target_speed_fraction"]) + input_recipe(SLIDER))
    client.receive(slider(1, 0.5), output(1000))
    client.posted(1002)
    assert ask(client, START, tick=1001) == [("S", b"\x01")]
    client.publish(output(1002, speed_scale=0.5))
    ((_, payload),) = told(client)
    assert values(payload, ["DOUBLE"]) == [0.5]


def test_an_input_sent_before_the_start_holds_packages_back_for_half_a_second_at_most() -> None:
    client = connect()
    ask(client, output_recipe(250, ["timestamp"]) + input_recipe(SLIDER))
    client.receive(slider(1, 0.5) + START, output(1000))
    client.posted(5000)
    told(client)
    assert run(client, range(1001, 1130)) == list(range(1125, 1130))


def test_mask_and_levels_may_come_in_recipes_of_their_own() -> None:
    client = connect()
    ask(client, input_recipe(SLIDER[:1]) + input_recipe(SLIDER[1:]))
    arrived = [
        VariablesArrived("rtsi#1", ("speed_slider_mask",)),
        VariablesArrived("rtsi#1", ("speed_slider_fraction",)),
    ]
    assert client.receive(package(1, ["UINT32"], [1]), output()) == arrived[:1]
    assert client.receive(package(2, ["DOUBLE"], [0.25]), output()) == [Do("rtsi#1", SetSpeedScale(0.25)), arrived[1]]


def test_the_15_inputs_of_common_clients_in_one_package() -> None:
    client = connect()
    ask(client, input_recipe(STANDARD_INPUTS))
    wrench = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    sent = [1, 0.5, 0x8001, 0x0001, 0, 0, 0, 0, 0, 0, 0.0, 0.0, wrench, 0, 1 << 31]
    data = package(1, [INPUTS[name].name for name in STANDARD_INPUTS], sent)
    assert len(data) == 98
    *requests, last = client.receive(data, output())
    assert last == VariablesArrived("rtsi#1", tuple(STANDARD_INPUTS))
    done = [item.request for item in requests if isinstance(item, Do)]
    assert done[:3] == [
        SetSpeedScale(0.5),
        WriteSignal("standard_digital_out", 0, True),
        WriteSignal("standard_digital_out", 15, False),
    ]
    assert WriteSignal("input_bool_register", 63, True) in done
    assert [WriteSignal("external_force_torque", index, value) for index, value in enumerate(wrench)] == done[3:9]
    assert len(done) == 3 + 6 + 64
    # Repeated once the machine has the registers: outputs and speed again, registers not.
    there = output(signals={"input_bool_register": {63: True}, "external_force_torque": dict(enumerate(wrench))})
    assert [item.request for item in client.receive(data, there) if isinstance(item, Do)] == done[:3]


@pytest.mark.parametrize("ident", [0, 2, 255])
def test_a_package_of_no_recipe_is_answered_with_a_reason_and_ignored(ident: int) -> None:
    client = connect()
    ask(client, input_recipe(SLIDER))
    ((letter, reason),) = ask(client, slider(1, 0.5, ident))
    assert (letter, reason[0]) == ("M", 1)
    assert f"no input recipe {ident}" in reason.decode()
    assert len(client.receive(slider(1, 0.5), output())) == 2


@pytest.mark.parametrize("body", [b"\x01", b"\x01" + bytes(11), b"\x01" + bytes(13)])
def test_a_package_of_the_wrong_size_is_answered_with_a_reason_and_ignored(body: bytes) -> None:
    client = connect()
    ask(client, input_recipe(SLIDER))
    ((letter, reason),) = ask(client, message("U", body))
    assert letter == "M"
    assert f"has 16 bytes, not {3 + len(body)}" in reason.decode()
    assert len(client.receive(slider(1, 0.5), output())) == 2


def test_a_package_without_a_number_is_ignored() -> None:
    ((letter, _),) = ask(connect(), message("U"))
    assert letter == "M"


def test_a_value_that_cannot_be_is_said_once_a_second() -> None:
    client = connect()
    ask(client, input_recipe(SLIDER))
    told_at = []
    for tick in range(1000, 1600):
        assert client.receive(slider(1, 7.0), output(tick)) == [VariablesArrived("rtsi#1", tuple(SLIDER))]
        if told(client):
            told_at.append(tick)
    assert told_at == [1000, 1250, 1500]


# ---------------------------------------------------------------- claims


def test_an_input_of_another_client_is_in_use_until_that_client_goes() -> None:
    port = RtsiPort()
    first, second = connect("rtsi#1", port), connect("rtsi#2", port)
    ask(first, input_recipe(SLIDER))
    ((_, payload),) = ask(second, input_recipe(["input_int_register3", "speed_slider_fraction", "nothing"]))
    assert set_up(payload) == (0, ["INT32", "IN_USE", "NOT_FOUND"])
    assert first.closed() == []
    ((_, payload),) = ask(second, input_recipe(SLIDER))
    assert set_up(payload) == (1, SLIDER_TYPES)


def test_a_refused_recipe_claims_nothing() -> None:
    port = RtsiPort()
    first, second, third = (connect(f"rtsi#{number}", port) for number in (1, 2, 3))
    ask(first, input_recipe(["speed_slider_mask"]))
    ask(second, input_recipe(["input_int_register3", "speed_slider_mask"]))
    ask(second, input_recipe(["input_int_register3", "nothing"]))
    ((_, payload),) = ask(third, input_recipe(["input_int_register3"]))
    assert set_up(payload) == (1, ["INT32"])


def test_robots_do_not_share_claims() -> None:
    for _ in range(2):
        ((_, payload),) = ask(connect("rtsi#1", RtsiPort()), input_recipe(SLIDER))
        assert payload[0] == 1


def test_a_client_that_has_gone_hears_nothing_more() -> None:
    client = connect()
    ask(client, output_recipe(250, ["timestamp"]) + START)
    client.closed()
    assert run(client, range(1001, 1010)) == []


# ---------------------------------------------------------------- limits


def test_a_client_has_254_recipes_in_each_direction() -> None:
    client = connect()
    for make in (lambda: output_recipe(250, ["timestamp"]), lambda: input_recipe(["input_int_register0"])):
        assert [ask(client, make())[0][1][0] for _ in range(254)] == list(range(1, 255))
        (_, payload), (_, reason) = ask(client, make())
        assert payload[0] == 0
        assert b"254 recipes" in reason


def test_a_client_has_2048_variables_in_each_direction() -> None:
    client = connect()
    assert ask(client, output_recipe(250, ["robot_mode"] * 2000))[0][1][0] == 1
    (_, payload), (_, reason) = ask(client, output_recipe(250, ["robot_mode"] * 49))
    assert set_up(payload) == (0, ["INT32"] * 49)
    assert b"2048 variables" in reason
    assert ask(client, output_recipe(250, ["robot_mode"] * 48))[0][1][0] == 2


def test_a_package_that_would_be_too_long_is_refused() -> None:
    (_, payload), (_, reason) = ask(connect(), output_recipe(250, ["actual_TCP_pose"] * 1400))
    assert set_up(payload) == (0, ["VECTOR6D"] * 1400)
    assert b"65535" in reason
    ((_, payload),) = ask(connect(), output_recipe(250, ["actual_TCP_pose"] * 1365))
    assert payload[0] == 1


@pytest.mark.parametrize(("letter", "head"), [("O", struct.pack(">d", 1.0)), ("I", b"")])
def test_a_recipe_of_more_variables_than_a_client_may_have_is_refused_and_said(letter: str, head: bytes) -> None:
    client, why = connect(), "a recipe has 2048 variables at most, not 2049"
    said = client.receive(message(letter, head + b"a," * 2048 + b"a"), output())
    assert said == [AddLog("rtsi#1", f"rtsi#1: {why}", is_warning=True)]
    (first, payload), (second, reason) = told(client)
    assert (first, payload, second, reason[1:].decode()) == (letter, b"\0", "M", why)
    # The next ones within a second are refused alone; the connection goes on.
    assert client.receive(message(letter, head + b"a," * 30_000), output()) == []
    assert told(client) == [(letter, b"\0")]
    assert ask(client, output_recipe(250, ["robot_mode"] * 2048))[0][1][0] == 1


def test_a_client_is_told_why_its_connection_ends() -> None:
    client = connect()
    with pytest.raises(ProtocolError, match="at least 3 bytes, not 2"):
        client.receive(b"\0\2V", output())
    ((letter, text),) = told(client)
    assert (letter, text[1:]) == ("M", b"the connection is closed: a message has at least 3 bytes, not 2")


def test_the_longest_message_is_taken() -> None:
    client = connect()
    assert [letter for letter, _ in ask(client, message("V", bytes(65532)))] == ["V", "M"]


def test_a_long_text_for_the_client_is_cut_at_a_character() -> None:
    client = connect()
    client.send_text(3, "ü" * 40000)
    ((_, payload),) = told(client)
    assert payload == b"\x03" + "ü".encode() * 32765


# ---------------------------------------------------------------- the stream


@pytest.mark.parametrize("head", [b"\0\0V", b"\0\x01V", b"\0\x02S"])
def test_a_size_below_3_ends_the_connection(head: bytes) -> None:
    client = connect()
    with pytest.raises(ProtocolError, match="at least 3 bytes"):
        client.receive(head, output())
    assert client.is_over


def test_what_came_before_a_mistake_counts() -> None:
    client = connect()
    ask(client, input_recipe(SLIDER))
    assert len(client.receive(slider(1, 0.5) + b"\0\0\0" + slider(1, 0.6), output())) == 2
    assert client.is_over
    with pytest.raises(ProtocolError, match="at least 3 bytes"):
        client.receive(b"", output())


def a_session() -> bytes:
    """Every command once or more."""
    return b"".join(
        [
            message("V", b"\0\x01"),
            message("v"),
            text("hello"),
            input_recipe(STANDARD_INPUTS),
            output_recipe(250, STANDARD_OUTPUTS),
            output_recipe(33.3, ["timestamp", "nothing"]),
            START,
            package(
                1, [INPUTS[name].name for name in STANDARD_INPUTS], [1, 0.5, 3, 1, *[0] * 6, 0.0, 0.0, (0.0,) * 6, 0, 0]
            ),
            message("x"),
            message("U", b"\x09"),
            PAUSE,
        ]
    )


def heard(chunks: list[bytes]) -> tuple[list[Any], bytes]:
    client = connect()
    inputs: list[Any] = []
    tick = output()
    for chunk in chunks:
        inputs += client.receive(chunk, tick)
    return inputs, b"".join(client.take())


def test_a_session_is_the_same_in_any_pieces() -> None:
    stream = a_session()
    whole = heard([stream])
    assert len(whole[0]) > 60
    assert [letter for letter, _ in messages(whole[1])] == list("VvIOOSUMMP")
    assert heard([stream[at : at + 1] for at in range(len(stream))]) == whole
    dice = random.Random(11)
    for _ in range(20):
        cuts = sorted(dice.randrange(len(stream)) for _ in range(dice.randrange(1, 30)))
        assert heard([stream[a:b] for a, b in zip([0, *cuts], [*cuts, len(stream)], strict=True)]) == whole


def test_half_a_message_at_the_end_waits() -> None:
    client = connect()
    assert [letter for letter, _ in ask(client, a_session_of_questions() + b"\0\x05V\0")] == ["V", "v"]
    assert ask(client, b"\x01") == [("V", b"\x01")]


def a_session_of_questions() -> bytes:
    return message("V", b"\0\x01") + message("v")


def test_random_bytes_are_answered_or_end_the_connection() -> None:
    dice = random.Random(30004)
    tick = output()
    for _ in range(300):
        client = connect()
        try:
            for _ in range(dice.randrange(1, 20)):
                client.receive(dice.randbytes(dice.randrange(0, 200)), tick)
                messages(b"".join(client.take()))
        except ProtocolError:
            assert client.is_over


def test_damaged_sessions_are_answered_or_end_the_connection() -> None:
    dice = random.Random(40003)
    stream = a_session()
    tick = output()
    for _ in range(400):
        damaged = bytearray(stream)
        for _ in range(dice.randrange(1, 8)):
            at = dice.randrange(len(damaged))
            change = dice.random()
            if change < 0.5:
                damaged[at] = dice.randrange(256)
            elif change < 0.75:
                del damaged[at : at + dice.randrange(1, 9)]
            else:
                damaged[at:at] = dice.randbytes(dice.randrange(1, 9))
        client = connect()
        try:
            client.receive(bytes(damaged), tick)
        except ProtocolError:
            assert client.is_over
        messages(b"".join(client.take()))


def test_well_framed_nonsense_leaves_the_connection_usable() -> None:
    dice = random.Random(50005)
    tick = output()
    for _ in range(100):
        client = connect()
        for _ in range(20):
            client.receive(message(dice.choice("VvMUOISPxyz"), dice.randbytes(dice.randrange(40))), tick)
        client.receive(PAUSE, tick)
        client.take()
        assert ask(client, message("V", b"\0\x01")) == [("V", b"\x01")]


@pytest.mark.parametrize("data", [b"\x05\0V\x01\0", b"\x03\0v", b"\x03\0S", b"\x03\0P"])
def test_a_little_endian_client_is_named_instead_of_waited_for(data: bytes) -> None:
    with pytest.raises(ProtocolError, match="RTSI is big-endian, and this client little-endian"):
        connect().receive(data, output(1))
