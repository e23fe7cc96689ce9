"""A page that shows a controller: what it is told, what it may do, and what reaches the controller."""

from __future__ import annotations

import struct

import pytest

from elitescript.client.dashboard import is_reading
from elitescript.conversation.messages import ACTIONS
from elitescript.studio.connected import controller
from elitescript.studio.connected.target import Target
from tests.client.test_primary_messages import ERROR, EXCEPTION, message
from tests.protocol.snapshots import snapshot
from tests.studio.connected.fake_controller import JOINTS, FakeController, Page, faked, run, shown

EVERYTHING = [
    *(
        {"type": "control", "action": action}
        for action in (
            *("power_on", "power_off", "release_brakes", "play", "pause", "resume", "stop", "unlock", "close_popup"),
            *("freedrive_on", "freedrive_off", "emergency_stop", "emergency_stop_release", "safeguard_open"),
            "safeguard_close",
        )
    ),
    {"type": "signal", "name": "standard_digital_out[1]", "value": True},
    {"type": "speed", "fraction": 0.5},
    {"type": "fault", "words": ["protective"]},
    {"type": "load", "program": "pick.task"},
    {"type": "send_program", "text": "movej([0, 0, 0, 0, 0, 0])\n"},
]
"""All that a page can ask a controller for and that is answered."""

JOG = {"type": "jog", "frame": "joint", "axis": 0, "direction": 1, "speed": 0.5}


async def settled(page: Page) -> None:
    """Wait until everything that the page begins with is there."""
    await page.until(lambda: page.of("scene") and page.of("moment") and page.controller()["serial"] and page.frames)


class TestWhatIsShown:
    def test_the_beginning(self):
        async def test():
            async with faked() as (_, page):
                await settled(page)
                hello = page.messages[0]
                assert (hello["type"], hello["mode"], hello["abilities"]) == ("hello", "connected", ["live"])
                assert hello["title"].startswith("127.0.0.1:")
                scene = page.of("scene")[0]
                assert len(scene["dh"]) == 6
                assert len(scene["parts"]) > 20
                (began,) = page.of("run_began")
                assert began["run"] == 1

        run(test())

    def test_moments(self):
        async def test():
            async with faked() as (fake, page):
                await settled(page)
                newest = page.of("moment")[-1]
                assert newest["moment"]["joints"] == JOINTS
                assert newest["moment"]["tcp_pose"] == (0.4, 0.1, 0.5, 3.1, 0.0, 1.5)
                controller = page.controller()
                assert controller == {
                    "link": "connected",
                    "address": f"127.0.0.1:{fake.ports['primary']}",
                    "model": "CS66",
                    "firmware": "2.9.0.1",
                    "serial": "1234",
                    "robot_mode": "RUNNING",
                    "safety_mode": "NORMAL",
                    "task_state": "STOPPED",
                    "program": "pick.task",
                    "speed_fraction": 0.5,
                    "operation_mode": "remote",
                }
                fake.values["actual_joint_positions"] = (0.5,) * 6
                await page.until(lambda: page.of("moment")[-1]["moment"]["joints"] == (0.5,) * 6)

        run(test())

    def test_time_begins_with_the_first_picture_and_again_with_a_restart(self):
        async def test():
            async with faked() as (fake, page):
                await settled(page)
                first = page.of("moment")
                assert (
                    min(message["moment"]["t"] for message in first if message["controller"]["link"] == "connected")
                    < 0.1
                )
                fake.values["timestamp"] = 3.0
                await page.until(lambda: len(page.of("run_began")) == 2)
                await page.until(lambda: page.of("moment")[-1]["moment"]["t"] < 1.0)
                assert [message["run"] for message in page.of("run_began")] == [1, 2]

        run(test())

    def test_rows(self):
        async def test():
            async with faked() as (_, page):
                await settled(page)
                magic, number, _first, step, rows, columns, _ = struct.unpack_from("<IIIIIHH", page.frames[0])
                assert (magic, number, step, rows) == (0x31435345, 1, 10, 5)
                assert columns == 12, "joints and pose: what an older controller does not have is left out"

        run(test())

    def test_a_later_page_gets_what_was(self):
        async def test():
            async with faked() as (_, page):
                await page.until(lambda: len(page.frames) >= 3)
                later = Page(type(page.source)(page.source._controller))
                await later.source.start(later)
                kinds = [message["type"] for message in later.messages]
                assert kinds == ["hello", "scene", "run_began", "moment"]
                assert sum(struct.unpack_from("<I", frame, 16)[0] for frame in later.frames) >= 15
                assert later.messages[0]["title"].startswith("CS66 at 127.0.0.1:")
                await later.source.close()

        run(test())

    def test_a_controller_without_rtsi_is_shown_by_its_primary_port(self):
        async def refuse(reader, writer):
            writer.transport.abort()

        async def test():
            fake = FakeController()
            fake.serve["rtsi"] = refuse
            await fake.open()
            async with shown(Target("127.0.0.1", fake.ports)) as (_, (page,)):
                await page.until(lambda: page.of("moment") and page.controller()["link"] == "connected")
                assert page.of("moment")[-1]["moment"]["joints"] == snapshot().robot.q_actual
            await fake.close()

        run(test())

    def test_messages_of_the_controller(self):
        async def test():
            async with faked() as (fake, page):
                await settled(page)
                fake.state += (
                    EXCEPTION
                    + ERROR
                    + message(0, b"<b>hello</b>\0")
                    + message(7, bytes(8) + b"\x13PROGRAM_XXX_STARTEDpick\0")
                )
                await page.until(lambda: sum(len(message["list"]) for message in page.of("events")) >= 4)
                events = [{**event, "t": 0} for message in page.of("events") for event in message["list"]][:4]
                assert events == [
                    {
                        "type": "alarm",
                        "t": 0,
                        "code": "controller",
                        "class": "NameError",
                        "text": "NameError: name 'x' is not defined",
                        "line": 12,
                        "column": 5,
                        "thread": "main",
                    },
                    {"type": "log", "t": 0, "level": "error", "text": "C51A3: C51: Gelenk übersetzt"},
                    {"type": "log", "t": 0, "level": "info", "text": "<b>hello</b>"},
                    {"type": "task", "t": 0, "state": "started", "name": "pick"},
                ]

        run(test())


class TestWithoutControl:
    def test_nothing_that_commands_leaves_this_computer(self):
        async def test():
            async with faked() as (fake, page):
                await settled(page)
                for message in EVERYTHING:
                    answer = await page.ask(**message)
                    assert (answer["type"], message["type"]) == ("refused", message["type"])
                    assert "--control" in answer["text"]
                await page.say(**JOG)
                await page.say(type="jog_end")
                assert "--control" in page.of("refused")[-1]["text"]
                await page.until(lambda: fake.sent["dashboard"].count(b"task\n") > 1)
                assert set(fake.letters) == {"V", "v", "O", "S"}
                assert fake.sent["primary"] == b""
                assert all(is_reading(line) for line in fake.sent["dashboard"].decode().splitlines())

        run(test())

    def test_every_action_was_asked_for(self):
        assert {message["action"] for message in EVERYTHING if "action" in message} == set(ACTIONS)


class TestWithControl:
    @pytest.mark.parametrize(
        ("message", "line", "state"),
        [
            ({"type": "control", "action": "power_on"}, "robotControl -on", {"robot_mode": 3}),
            ({"type": "control", "action": "power_off"}, "robotControl -off", {}),
            ({"type": "control", "action": "release_brakes"}, "brakeRelease", {"robot_mode": 5}),
            ({"type": "control", "action": "play"}, "play", {}),
            ({"type": "control", "action": "resume"}, "play", {"runtime_state": 2}),
            ({"type": "control", "action": "pause"}, "pause", {"runtime_state": 1}),
            ({"type": "control", "action": "stop"}, "stop", {"runtime_state": 1}),
            ({"type": "control", "action": "stop"}, "stop", {"runtime_state": 3}),
            ({"type": "control", "action": "unlock"}, "unlockProtectiveStop", {"safety_status": 3}),
            ({"type": "control", "action": "close_popup"}, "popup -c", {}),
        ],
    )
    def test_buttons_are_commands_of_the_dashboard(self, message, line, state):
        async def test():
            async with faked(may_control=True) as (fake, page):
                fake.values |= state
                await settled(page)
                before = fake.sent["dashboard"]
                answer = await page.ask(**message)
                assert answer["type"] == "done", answer
                ordered = fake.sent["dashboard"].removeprefix(before).decode().splitlines()
                assert [text for text in ordered if not is_reading(text)] == [line]

        run(test())

    @pytest.mark.parametrize(
        ("message", "state", "text"),
        [
            ({"type": "control", "action": "play"}, {"robot_mode": 3}, "robotMode is POWER_OFF; power on first"),
            ({"type": "control", "action": "play"}, {"safety_status": 5}, "SAFEGUARD_STOP; close the safeguard first"),
            ({"type": "control", "action": "pause"}, {}, "no task is running"),
            ({"type": "control", "action": "safeguard_open"}, {}, "only a robot that is served on this computer"),
            ({"type": "fault", "words": ["protective"]}, {}, "only a robot that is served on this computer"),
            ({"type": "fault", "words": ["estop"]}, {}, "a fault is one of"),
            ({"type": "load", "program": "gone.task"}, {}, "the controller refuses: Unknown command"),
            ({"type": "send_program", "text": "x = 1"}, {"robot_mode": 5}, "release the brakes first"),
            ({"type": "signal", "name": "standard_digital_in[1]", "value": True}, {}, "is an input"),
            ({"type": "control", "action": "freedrive_on"}, {}, "has no freedrive_mode; 2.14 brought it"),
            ({"type": "seek", "run": 1, "t": 0.5}, {}, "it does not go back to a moment"),
        ],
    )
    def test_refusals_say_why(self, message, state, text):
        async def test():
            async with faked(may_control=True) as (fake, page):
                fake.values |= state
                await settled(page)
                answer = await page.ask(**message)
                assert answer["type"] == "refused"
                assert text in answer["text"]

        run(test())

    @pytest.mark.parametrize(
        ("state", "text"),
        [
            ({"runtime_state": 1}, "a program runs or is paused; stop it first"),
            ({"runtime_state": 2}, "a program runs or is paused; stop it first"),
            ({"robot_mode": 5}, "the arm cannot move: robot mode IDLE"),
            ({"safety_status": 3}, "safety PROTECTIVE_STOP"),
        ],
    )
    def test_the_arm_is_not_jogged_in_other_states(self, state, text):
        async def test():
            async with faked(may_control=True) as (fake, page):
                fake.values |= state
                await settled(page)
                await page.say(**JOG)
                assert text in page.of("refused")[-1]["text"]
                assert fake.sent["primary"] == b""

        run(test())

    def test_an_output_is_set_by_a_secondary_program(self):
        async def test():
            async with faked(may_control=True) as (fake, page):
                await settled(page)
                answer = await page.ask(type="signal", name="configurable_digital_out[2]", value=True)
                assert answer["type"] == "done"
                await page.until(lambda: fake.sent["primary"].endswith(b"end\n\n"))
                assert fake.sent["primary"] == b"sec studio_set():\n    set_configurable_digital_out(2, True)\nend\n\n"

        run(test())

    def test_an_emergency_stop_of_another_controller_stops_and_powers_off(self):
        async def test():
            async with faked(may_control=True) as (fake, page):
                fake.values["runtime_state"] = 1
                await settled(page)
                assert (await page.ask(type="control", action="emergency_stop"))["type"] == "done"
                ordered = [line for line in fake.sent["dashboard"].decode().splitlines() if not is_reading(line)]
                assert ordered == ["stop", "robotControl -off"]

        run(test())

    def test_it_does_not_wait_for_a_command_that_hangs(self):
        async def test():
            async with faked(may_control=True) as (fake, page):
                fake.values["runtime_state"] = 1
                await settled(page)
                await page.say(type="send_program", ask=1, text="while True:\n    sleep(1)\n")
                await page.say(type="control", ask=2, action="pause")
                assert (await page.ask(type="control", action="emergency_stop"))["type"] == "done"

        run(test())

    @pytest.mark.parametrize("answers_to_others", [True, False])
    def test_a_stop_does_not_wait_behind_a_command_that_hangs(self, monkeypatch, answers_to_others):
        monkeypatch.setattr(controller, "STOP_S", 0.05)

        async def test():
            async with faked(may_control=True) as (fake, page):
                await settled(page)
                sound = fake.serve["dashboard"]
                fake.replies["popup -c"] = None
                await page.say(type="control", ask=1, action="close_popup")
                await page.until(lambda: b"popup -c" in fake.sent["dashboard"])
                if not answers_to_others:
                    fake.serve["dashboard"] = lambda reader, writer: reader.read()
                assert (await page.ask(type="control", action="stop"))["type"] == "done"
                if answers_to_others:
                    assert fake.sent["dashboard"].endswith(b"stop\n")
                else:
                    await page.until(lambda: fake.sent["primary"] == b"stop task\n")
                fake.serve["dashboard"] = sound

        run(test())

    def test_an_emergency_stop_without_a_dashboard_goes_to_the_primary_port(self):
        async def test():
            async with faked(may_control=True) as (fake, page):
                await settled(page)
                fake.serve["dashboard"] = lambda reader, writer: _gone(writer)
                fake.hang_up()
                await page.until(lambda: fake.sent["primary"] == b"" and page.of("notice"))
                await page.until(lambda: page.controller()["link"] == "connected")
                answer = await page.ask(type="control", action="emergency_stop")
                assert "primary port" in answer["text"], answer
                await page.until(lambda: fake.sent["primary"] == b"stop task\npower off\n")

        run(test())


async def _gone(writer):
    writer.transport.abort()


class TestLostConnections:
    def test_lost_and_back(self):
        async def test():
            async with faked() as (fake, page):
                await settled(page)
                await fake.close()
                await page.until(lambda: page.controller()["link"] == "lost")
                assert any("closed the connection" in message["text"] for message in page.of("notice"))
                joints = page.of("moment")[-1]["moment"]["joints"]
                assert joints == JOINTS, "the last picture stays"
                await fake.open()
                await page.until(lambda: page.controller()["link"] == "connected")

        run(test())

    def test_the_same_reason_is_said_once(self):
        async def test():
            async with faked() as (fake, page):
                await settled(page)
                await fake.close()
                await page.until(lambda: page.controller()["link"] == "lost")
                count = len(page.of("moment"))
                await page.until(lambda: len(page.of("moment")) > count + 10)
                texts = [message["text"] for message in page.of("notice")]
                assert len(texts) == len(set(texts))

        run(test())

    @pytest.mark.parametrize("port", ["rtsi", "primary", "dashboard"])
    @pytest.mark.parametrize(
        "data",
        [
            b"",
            b"\0",
            b"\0\0\0",
            b"\xff" * 2000,
            b"HTTP/1.1 400 Bad Request\r\n\r\n",
            bytes(range(256)) * 20,
            b"\x00\x04V\x01\x00\x04V\x01",
            b"\x00\x04V\x00",
            b"\x00\x00\x00\x0a\x10abcde",
            b"Hello ELITE ROBOTS.\r\n" * 3,
        ],
    )
    def test_bytes_that_make_no_sense(self, port, data):
        """Such a port is tried again; the others go on, and the next controller there is shown."""

        async def nonsense(reader, writer):
            writer.write(data)
            await writer.drain()
            fake.count = getattr(fake, "count", 0) + 1

        fake = FakeController()

        async def test():
            sound = fake.serve[port]
            fake.serve[port] = nonsense
            await fake.open()
            async with shown(Target("127.0.0.1", fake.ports)) as (_, (page,)):
                await page.until(lambda: getattr(fake, "count", 0) >= 3)
                assert page.of("notice")
                fake.serve[port] = sound
                await settled(page)
            await fake.close()

        run(test())

    @pytest.mark.parametrize("port", ["rtsi", "primary", "dashboard"])
    def test_disconnected_after_every_few_bytes(self, port):
        """The controller cuts its answers off at each length; nothing is shown wrong, and it recovers."""

        async def test():
            fake = FakeController()
            sound = fake.serve[port]
            lengths = iter([*range(0, 60, 3), *range(60, 1200, 150)])

            async def cut(reader, writer):
                left = next(lengths, None)
                if left is None:
                    await sound(reader, writer)
                    return
                write = writer.write

                def some(data):
                    nonlocal left
                    write(data[:left])
                    left -= min(left, len(data))
                    if not left:
                        writer.close()

                writer.write = some
                await sound(reader, writer)

            fake.serve[port] = cut
            await fake.open()
            async with shown(Target("127.0.0.1", fake.ports), backoff_s=(0.001,)) as (_, (page,)):
                await page.until(lambda: next(lengths, None) is None, 10.0)
                await settled(page)
                joints = {tuple(message["moment"]["joints"]) for message in page.of("moment")}
                assert joints <= {JOINTS, (0.0,) * 6} | ({snapshot().robot.q_actual} if port == "rtsi" else set())
            await fake.close()

        run(test())
