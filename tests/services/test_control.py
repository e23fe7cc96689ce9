"""The local channel of `ctl`."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import stat
import tempfile
import time
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from typing import Any

import pytest

from elitescript.devices.channels.faults import Fault
from elitescript.devices.channels.machine_faults import machine_fault
from elitescript.errors import UsageError
from elitescript.messages.enums import RobotMode, TaskState
from elitescript.messages.events import Alarm, TaskStateChanged, Warned
from elitescript.messages.inputs import AddFault, ClosePopup, Do, EndFaults
from elitescript.messages.machine import (
    AskSafety,
    PauseTask,
    PowerOff,
    PowerOn,
    ReleaseBrakes,
    ResumeTask,
    SetSpeedScale,
    StopTask,
    WriteSignal,
)
from elitescript.messages.outcomes import Done, Refused
from elitescript.messages.outputs import Reply
from elitescript.services.control import channel as control
from elitescript.services.control.channel import (
    ControlChannel,
    Ending,
    OutputCollector,
    address_of,
    ask,
    runtime_folder,
)
from elitescript.services.control.verbs import VERBS, VerbAction, VerbRequest, outcome_text
from elitescript.services.robot_link import InProcessLink
from tests.protocol.snapshots import description, output
from tests.services.fake_robot import FakeRobot
from tests.services.served import Scene, run, serving


@pytest.fixture(autouse=True)
def short_folder(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Paths of sockets must be short, those of pytest are not."""
    with tempfile.TemporaryDirectory(prefix="es") as folder:
        monkeypatch.setenv("XDG_RUNTIME_DIR", folder)
        yield Path(folder)


@contextlib.asynccontextmanager
async def controlled(robot: FakeRobot | None = None) -> AsyncIterator[tuple[Scene, ControlChannel]]:
    async with serving(robot) as scene:
        channel = ControlChannel(scene.server, 0)
        await channel.open()
        try:
            yield scene, channel
        finally:
            await channel.close()


async def order(channel: ControlChannel, verb: str, *arguments: str, **values: Any) -> dict[str, Any]:
    return await asyncio.to_thread(ask, Path(channel.address), verb, list(arguments), values)


def test_what_is_set_can_be_read_back() -> None:
    async def test() -> None:
        async with controlled() as (_, channel):
            answer = await asyncio.to_thread(
                ask, Path(channel.address), "set", [], {"standard_digital_in[3]": True, "input_int_register[1]": 7}
            )
            assert answer["ok"]
            got = await order(channel, "get", "standard_digital_in[3]", "input_int_register[1]")
            assert got["result"] == {"standard_digital_in[3]": True, "input_int_register[1]": 7}
            assert (await order(channel, "get"))["result"] == got["result"]
            assert len((await order(channel, "get", "standard_digital_in"))["result"]) == 16

    run(test())


def test_the_state_is_that_of_the_robot() -> None:
    async def test() -> None:
        async with controlled() as (_, channel):
            state = (await order(channel, "state"))["result"]
            assert (state["robot_mode"], state["safety_mode"], state["waits_for"]) == ("RUNNING", "NORMAL", "")
            assert len(state["joints"]) == 6

    run(test())


def test_the_state_has_what_the_wall_clock_has_done() -> None:
    async def test() -> None:
        async with controlled() as (scene, channel):
            now = scene.server.output.tick
            # However quick this computer is, it is late once.
            scene.robot.on_tick = lambda tick: time.sleep(0.02) if tick == now + 2 else None
            await scene.until(lambda: scene.server.overruns > 1)
            state = (await order(channel, "state"))["result"]
            assert state["overruns"] > 1
            assert state["left_out"] == 0

    run(test())


@pytest.mark.parametrize(
    ("verb", "arguments", "request_made"),
    [
        ("estop", [], WriteSignal("emergency_stop", 0, True)),
        ("release", [], WriteSignal("emergency_stop", 0, False)),
        ("safeguard", ["open"], WriteSignal("safeguard_stop", 0, True)),
        ("safeguard", ["closed"], WriteSignal("safeguard_stop", 0, False)),
        ("protective", ["test"], AskSafety("stop_protectively", "test")),
        ("violation", ["test"], AskSafety("violate", "test")),
        ("fault", [], AskSafety("fail", "asked for by ctl")),
        ("unlock", [], AskSafety("unlock_protective_stop", "asked for by ctl")),
        ("restart", [], AskSafety("restart_safety", "asked for by ctl")),
        ("power", ["on"], PowerOn()),
        ("power", ["off"], PowerOff()),
        ("brakes", [], ReleaseBrakes()),
        ("pause", [], PauseTask()),
        ("resume", [], ResumeTask()),
        ("stop", [], StopTask()),
    ],
)
def test_verbs_become_requests(verb: str, arguments: list[str], request_made: Any) -> None:
    async def test() -> None:
        async with controlled() as (scene, channel):
            assert (await order(channel, verb, *arguments))["ok"]
            assert [item.request for _, item in scene.robot.heard if isinstance(item, Do)] == [request_made]

    run(test())


def test_power_goes_off_and_on_also_in_local_control() -> None:
    async def test() -> None:
        async with controlled(FakeRobot(is_remote=False)) as (scene, channel):
            for verb, arguments, mode in (
                ("power", ["off"], RobotMode.POWER_OFF),
                ("power", ["on"], RobotMode.IDLE),
                ("brakes", [], RobotMode.RUNNING),
            ):
                assert (await order(channel, verb, *arguments))["ok"]
                assert scene.server.output.snapshot.robot.robot_mode is mode

    run(test())


def test_refusals_say_why() -> None:
    async def test() -> None:
        async with controlled() as (_, channel):
            for verb, arguments, why in (
                ("popup", ["confirm"], "no message window is open"),
                ("load", ["/etc/passwd"], "the path must lead into its folder"),
                ("power", ["maybe"], "power takes on or off"),
                ("speed", ["2"], "from 0 to 1"),
                ("get", ["nonsense"], "no signal is called 'nonsense'"),
                ("jump", [], "there is no verb 'jump'"),
            ):
                answer = await order(channel, verb, *arguments)
                assert not answer["ok"]
                assert why in answer["error"]

    run(test())


@pytest.mark.parametrize(
    ("verb", "arguments"),
    [("estop", []), ("safeguard", ["open"]), ("unlock", []), ("resume", []), ("speed", ["0.5"]), ("power", ["off"])],
)
def test_what_the_robot_refuses_is_no_success(verb: str, arguments: list[str]) -> None:
    async def test() -> None:
        async with controlled() as (scene, channel):
            scene.robot.refuses = "cannot do it: the robot is busy"
            answer = await order(channel, verb, *arguments)
            assert answer == {"ok": False, "error": "cannot do it: the robot is busy"}

    run(test())


def test_a_task_that_cannot_start_says_why() -> None:
    robot = FakeRobot()
    robot.play_answer = Refused("no task is loaded")

    async def test() -> None:
        async with controlled(robot) as (_, channel):
            assert await order(channel, "play") == {"ok": False, "error": "not started: no task is loaded"}

    run(test())


def test_each_signal_of_a_set_is_asked_for_and_answered_by_itself() -> None:
    async def test() -> None:
        async with controlled() as (scene, channel):
            values = {"standard_digital_in[0]": True, "standard_digital_in[1]": True}
            assert (await order(channel, "set", **values))["ok"]
            made = [item for _, item in scene.robot.heard if isinstance(item, Do)]
            assert len({item.origin for item in made}) == 2
            assert all(item.is_answered for item in made)

    run(test())


def test_the_first_refusal_of_several_answers_is_told() -> None:
    two = VerbAction((Do("ctl#1/1", SetSpeedScale(0.1)), Do("ctl#1/1", SetSpeedScale(0.2))), "set")
    assert two.answered("ctl#1/1")[1] == ("ctl#1/1.1", "ctl#1/1.2")
    assert outcome_text(two, [Done(), Done()]) == "set"
    first = Refused("first")
    for answers in ([first, Done()], [Done(), first], [first, Refused("second")]):
        with pytest.raises(UsageError, match=r"^first$"):
            outcome_text(two, answers)


def test_answers_are_taken_from_ticks_that_come_in_a_row() -> None:
    async def test() -> None:
        answers = OutputCollector(("ctl#1/1.1", "ctl#1/1.2"))
        assert answers.take(output(1))
        assert answers.take(output(2, replies=(Reply("ctl#1/1.2", Refused("x")), Reply("rtsi#1", Done()))))
        assert not answers.finished.done()
        assert not answers.take(output(3, replies=(Reply("ctl#1/1.1", Done()),)))
        assert not answers.take(output(4))
        await answers.finished
        assert answers.outcomes == [Done(), Refused("x")]

    run(test())


def test_a_robot_that_never_answers_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(control, "REPLY_TICKS", 3)
    monkeypatch.setattr(FakeRobot, "tick", _deaf(FakeRobot.tick))

    async def test() -> None:
        async with controlled() as (_, channel):
            answer = await order(channel, "speed", "0.5")
            text = "speed 0.5: asked for, and not answered yet; the robot may do it later"
            assert answer == {"ok": False, "error": text}

    run(test())


@pytest.mark.parametrize("by_the_clock", [False, True])
def test_an_answer_that_is_late_is_told_in_one_way_and_names_the_line(
    monkeypatch: pytest.MonkeyPatch, by_the_clock: bool
) -> None:
    """Whether the robot's time goes on or not."""
    monkeypatch.setattr(control, "ANSWER_TIMEOUT_S" if by_the_clock else "REPLY_TICKS", 0.001 if by_the_clock else 3)
    monkeypatch.setattr(FakeRobot, "tick", _deaf(FakeRobot.tick))
    monkeypatch.setattr(InProcessLink, "busy_line", 12)

    async def test() -> None:
        async with controlled() as (_, channel):
            answer = await order(channel, "stop")
            text = "no task or program is running: asked for, and not answered yet: the program keeps it in line 12"
            assert answer == {"ok": False, "error": f"{text}; the robot may do it later"}

    run(test())


def _deaf(tick: Any) -> Any:
    return lambda robot, _inputs, number: tick(robot, (), number)


def test_a_popup_is_confirmed() -> None:
    async def test() -> None:
        async with controlled(FakeRobot(popup="ready?")) as (scene, channel):
            assert (await order(channel, "popup", "confirm"))["ok"]
            assert any(isinstance(item, ClosePopup) for _, item in scene.robot.heard)

    run(test())


def test_ports_tell_who_is_connected() -> None:
    async def test() -> None:
        async with controlled() as (scene, channel):
            await (await scene.connect("dashboard")).line()
            ports = (await order(channel, "ports"))["result"]
            assert ports["dashboard"]["port"] == scene.server.ports["dashboard"]
            assert ports["dashboard"]["host"] == "127.0.0.1"
            assert [client["origin"] for client in ports["dashboard"]["clients"]] == ["dashboard#1"]

    run(test())


def test_nonsense_is_answered_and_harms_nobody() -> None:
    async def test() -> None:
        async with controlled() as (_, channel):
            reader, writer = await asyncio.open_unix_connection(channel.address)
            writer.write(b'[1]\n{"verb": 7}\nnot json\n{"verb": "get", "arguments": 3}\n')
            for _ in range(4):
                assert json.loads(await reader.readline())["ok"] is False
            writer.write(bytes(200_000))
            assert json.loads(await reader.read())["error"] == "a request has 65536 bytes at most"
            writer.close()
            assert (await order(channel, "state"))["ok"]

    run(test())


@pytest.mark.skipif(os.name != "posix", reason="modes of files")
def test_only_its_user_may_speak_to_a_robot(short_folder: Path) -> None:
    async def test() -> None:
        async with controlled() as (_, channel):
            assert stat.S_IMODE(Path(channel.address).stat().st_mode) == 0o600
            assert stat.S_IMODE(Path(channel.address).parent.stat().st_mode) == 0o700
        assert not address_of(0).exists()

    run(test())
    (short_folder / "elitescript").chmod(0o777)
    with pytest.raises(UsageError, match="only you can use"):
        runtime_folder()


class TestPlacesThatCannotBeUsed:
    """Each is told in one sentence, with the path and the variable that leads there."""

    @pytest.fixture
    def place(self, monkeypatch: pytest.MonkeyPatch, short_folder: Path) -> Path:
        monkeypatch.delenv("XDG_RUNTIME_DIR")
        monkeypatch.setattr(tempfile, "tempdir", str(short_folder))
        return short_folder

    @staticmethod
    def refusal() -> str:
        with pytest.raises(UsageError) as refused:
            runtime_folder()
        return str(refused.value)

    def test_a_file_is_there(self, place: Path) -> None:
        path = place / runtime_folder().name
        path.rmdir()
        path.touch()
        assert self.refusal() == (
            f"{path}: it is a file, not a folder; addresses of served robots are there, and the variable TMPDIR says "
            "where that is"
        )

    @pytest.mark.skipif(os.name != "posix", reason="modes of files")
    def test_a_link_is_there_or_others_may_write(self, place: Path) -> None:
        path = runtime_folder()
        path.chmod(0o777)
        assert f"{path}: it must be a folder that only you can use (mode 700); remove it; addresses" in self.refusal()
        path.rmdir()
        path.symlink_to(place)
        assert "and the variable TMPDIR says where that is" in self.refusal()

    def test_there_is_no_place(self, place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(tempfile, "tempdir", str(place / "none"))
        assert f"{place / 'none'}" in self.refusal()

    @pytest.mark.parametrize("value", ["", "relative", "/none/at/all"])
    def test_a_variable_that_names_no_folder_says_nothing(
        self, value: str, place: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setenv("XDG_RUNTIME_DIR", value)
        assert runtime_folder().parent == place

    @pytest.mark.skipif(not hasattr(asyncio, "open_unix_connection"), reason="needs sockets in folders")
    def test_its_path_is_too_long_for_a_socket(self, place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        long = place / ("x" * 110)
        long.mkdir()
        monkeypatch.setattr(tempfile, "tempdir", str(long))

        async def test() -> None:
            with pytest.raises(UsageError) as refused:
                async with controlled():
                    pass
            assert str(refused.value) == (
                f"{runtime_folder() / 'serve-0.sock'}: AF_UNIX path too long; addresses of served robots are there, "
                "and the variable TMPDIR says where that is"
            )

        run(test())


def test_two_serves_of_one_instance_get_two_addresses() -> None:
    async def test() -> None:
        async with controlled() as (_, first), controlled() as (_, second):
            assert first.address != second.address
            assert (await order(first, "state"))["ok"]
            assert (await order(second, "state"))["ok"]

    run(test())


def test_without_a_unix_socket_a_secret_keeps_others_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(control, "_HAS_UNIX", False)

    async def test() -> None:
        async with controlled() as (_, channel):
            address = json.loads(Path(channel.address).read_text())
            assert (await order(channel, "state"))["ok"]
            reader, writer = await asyncio.open_connection("127.0.0.1", address["port"])
            writer.write(b'{"verb": "state", "token": "guess"}\n')
            assert json.loads(await reader.readline()) == {"ok": False, "error": "the token is wrong"}
            writer.close()

    run(test())


def test_nobody_there_is_said_clearly() -> None:
    with pytest.raises(UsageError, match="no controller is served here"):
        ask(address_of(7), "state", [], {})


def disturbed(*arguments: str) -> VerbAction:
    verb = VERBS["disturb"]
    assert verb.order is not None
    last = output(0)
    return verb.order(VerbRequest("ctl#1/1", arguments, {}, last.snapshot, description()))


def test_a_disturbance_is_an_input_of_the_robot() -> None:
    (asked,) = disturbed("delay", "on=5000", "delay_s=0.5", "direction=to_robot").inputs
    assert isinstance(asked, AddFault)
    assert asked.fault == machine_fault(Fault("delay", 5000, delay_s=0.5, direction="to_robot"))
    assert disturbed("end").inputs == (EndFaults("ctl#1/1"),)


@pytest.mark.parametrize(
    "arguments, words",
    [
        (("drop",), "on: is missing"),
        (("drop", "5000"), "disturb takes KIND on=PLACE NAME=VALUE..., not '5000'"),
        (("refuse", "on=tool"), "a serial line cannot refuse"),
        (("drop", "on=5000", "colour=red"), "colour: is not known"),
        (("end", "on=5000"), "there is no fault 'end'"),
    ],
)
def test_a_disturbance_that_makes_no_sense_is_refused(arguments: tuple[str, ...], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        disturbed(*arguments)


PLAYING = TaskStateChanged(10, TaskState.PLAYING, "pick")
PAUSED = TaskStateChanged(20, TaskState.PAUSED, "pick")
ALARM = Alarm(500, "R100", "IndexError", "list index out of range", 3, 5, "main")
WARNED = Warned(300, "the targets come too late", "main", 4, "W290")


def ended(how: str) -> TaskStateChanged:
    return TaskStateChanged(500, TaskState.STOPPED, "pick", how)


@pytest.mark.parametrize(
    ("events", "answer"),
    [
        ([PLAYING], None),
        ([ended("stopped")], None),
        ([ended("stopped"), PLAYING, ended("finished")], "task pick ended at 2.000 s: finished"),
        ([PLAYING, PAUSED, PLAYING, ended("stopped")], "task pick ended at 2.000 s: stopped"),
        ([PLAYING, WARNED, WARNED, ended("finished")], "task pick ended at 2.000 s: finished, 1 warning"),
        ([WARNED, PLAYING, ended("finished")], "task pick ended at 2.000 s: finished"),
        ([PLAYING, ALARM, ended("alarm")], "R100 in line 3: IndexError: list index out of range"),
    ],
)
@pytest.mark.parametrize("in_one_output", [True, False])
def test_play_waits_for_the_end_of_its_own_task(events: list[Any], answer: str | None, in_one_output: bool) -> None:
    async def test() -> None:
        ending = Ending()
        for group in [events] if in_one_output else [[event] for event in events]:
            is_wanted = ending.take(output(events=tuple(group)))
            assert is_wanted is not ending.finished.done()
        if answer is None:
            assert not ending.finished.done()
            ending.finished.cancel()
        else:
            result = await ending.finished
            assert result["ok"] is ("R100" not in answer)
            assert answer in result["text" if result["ok"] else "error"]

    run(test())


def test_a_refused_play_does_not_wait() -> None:
    async def test() -> None:
        robot = FakeRobot()
        robot.play_answer = Refused("no task is loaded")
        async with controlled(robot) as (_, channel):
            answer = await asyncio.to_thread(ask, Path(channel.address), "play", [], {}, waits=True)
            assert answer == {"ok": False, "error": "not started: no task is loaded"}

    run(test())


def test_stop_says_when_nothing_runs() -> None:
    async def test() -> None:
        async with controlled() as (_, channel):
            assert await order(channel, "stop") == {"ok": True, "text": "no task or program is running"}

    run(test())


@pytest.mark.parametrize(
    ("line", "why"),
    [
        (b'{"verb":' + b"[" * 30_000 + b"]" * 30_000 + b"}", "nested more than 100 deep in line 1"),
        (b'{"verb":' + b"9" * 5000 + b"}", "a number of 5000 digits in line 1"),
        (b'{"verb":"state","verb":"stop"}', "'verb' is given twice"),
        (b'{"verb":"set","values":{"standard_analog_in[0]":NaN}}', "NaN is no number of JSON"),
        (b'{"verb":"set","values":{"standard_analog_in[0]":1e999}}', "1e999 is larger than every number of a computer"),
        (b'{"verb":"\xff"}', "not UTF-8: invalid start byte at byte 9"),
        (b'{"verb":"\0"}', "Invalid control character at: line 1 column 10"),
        (b'{"verb":"get","arguments":[["tool_digital_in[0]"]]}', "arguments are texts and numbers"),
        (
            b'{"verb":"get","arguments":["tool_digital_in[' + b"9" * 5000 + b']"]}',
            f"tool_digital_in has indices 0 to 3, not {'9' * 40}",
        ),
        (b'{"verb":"disturb"}', "disturb takes KIND on=PLACE NAME=VALUE..., or end"),
    ],
)
def test_what_is_no_request_is_refused_in_one_sentence(line: bytes, why: str) -> None:
    async def scene() -> None:
        async with controlled() as (_, channel):
            assert await asked(channel, line) == {"ok": False, "error": why}
            assert (await asked(channel, b'{"verb":"state"}'))["ok"]

    run(scene())


def test_a_defect_ends_no_connection_and_is_in_the_log(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError

    async def scene() -> None:
        async with controlled() as (scene, channel):
            monkeypatch.setitem(VERBS, "state", VERBS["state"]._replace(read=fail))
            answer = await asked(channel, b'{"verb":"state"}')
            assert answer == {"ok": False, "error": "internal error; the log of serve has it"}
            assert "ZeroDivisionError" in scene.notes("bug")[0].text

    run(scene())


def test_connections_are_bounded() -> None:
    async def scene() -> None:
        async with controlled() as (_, channel):
            held = [await asyncio.open_unix_connection(channel.address) for _ in range(control.CLIENTS_MAX)]
            assert await asked(channel, b"{}") == {"ok": False, "error": "64 connections to ctl are open"}
            held[0][1].close()
            await held[0][0].read()
            assert (await asked(channel, b'{"verb":"state"}'))["ok"]
            for _, writer in held:
                writer.close()

    run(scene())


async def asked(channel: ControlChannel, line: bytes) -> dict[str, Any]:
    """The answer to one line."""
    reader, writer = await asyncio.open_unix_connection(channel.address)
    with contextlib.suppress(ConnectionError):
        writer.write(line + b"\n")
    answer: dict[str, Any] = json.loads(await reader.readline())
    writer.close()
    return answer
