"""A page that drives a robot of our own, through its ordinary ports and `ctl`: real sockets, the whole way."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator
from math import dist

import pytest

from elitescript.kernel import Kernel, RobotOptions
from elitescript.services.control.channel import ControlChannel
from elitescript.studio.connected import jogging, source
from elitescript.studio.connected.controller import ConnectedController
from elitescript.studio.connected.target import Target
from tests.services.served import Scene, serving
from tests.studio.connected.fake_controller import Page, run, shown

JOG = {"type": "jog", "frame": "joint", "axis": 0, "direction": 1, "speed": 1.0}
COUNTING = "global n\nn = 0\nwhile True:\n    n = n + 1\n    sleep(0.01)\n"


@contextlib.asynccontextmanager
async def driven(
    monkeypatch, tmp_path, pages: int = 1, **options
) -> AsyncIterator[tuple[Scene, ConnectedController, list[Page]]]:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    robot = Kernel(RobotOptions(power_on=True, **options))
    async with serving(robot) as scene:
        control = ControlChannel(scene.server, 41)
        await control.open()
        target = Target(
            "127.0.0.1", scene.server.ports, may_control=True, control_socket=tmp_path / "elitescript" / "serve-41.sock"
        )
        async with shown(target, pages) as (controller, made):
            await made[0].until(lambda: made[0].of("scene") and controller.picture.may_move)
            yield scene, controller, made
        await control.close()


async def hold(page: Page, seconds: float, **jog) -> None:
    """Hold a button: the page repeats its message."""
    end = asyncio.get_running_loop().time() + seconds
    while asyncio.get_running_loop().time() < end:
        await page.say(**{**JOG, **jog})
        await asyncio.sleep(0.05)


async def hold_until(page: Page, condition, **jog) -> None:
    """Hold a button until a condition holds, however long this computer takes."""
    while not condition():
        await hold(page, 0.05, **jog)


async def stands(page: Page, controller: ConnectedController) -> float:
    """Wait until the arm stands and nothing runs; return the first joint."""
    await page.until(lambda: not controller.jogger.is_active)
    await page.until(lambda: not any(controller.picture.values["actual_joint_speeds"]))
    return controller.picture.joints[0]


@pytest.fixture
def patient(monkeypatch):
    """Let a jog outlast a busy computer, where its own limits are not the subject."""
    for limit in ("HOLD_S", "BLIND_S", "QUIET_S"):
        monkeypatch.setattr(jogging, limit, 2.0)


class TestJogging:
    @pytest.mark.usefixtures("patient")
    def test_it_moves_while_held_and_stops_when_released(self, monkeypatch, tmp_path):
        async def test():
            async with driven(monkeypatch, tmp_path) as (_, controller, (page,)):
                first = controller.picture.joints[0]
                await hold_until(page, lambda: controller.picture.joints[0] - first > 0.05)
                await page.say(type="jog_end")
                assert await stands(page, controller) - first > 0.05
                assert page.of("refused") == page.of("notice") == []
                assert {message["moment"]["line"] for message in page.of("moment")} == {0}

        run(test())

    def test_it_stops_when_the_page_says_nothing_more(self, monkeypatch, tmp_path):
        async def test():
            async with driven(monkeypatch, tmp_path) as (_, controller, (page,)):
                await hold(page, 0.4)
                await stands(page, controller)

        run(test())

    def test_it_stops_when_the_page_is_gone(self, monkeypatch, tmp_path):
        async def test():
            async with driven(monkeypatch, tmp_path, pages=2) as (_, controller, (watching, page)):
                await hold(page, 0.4)
                await page.source.close()
                last = controller.picture.joints[0]
                assert await stands(watching, controller) - last < 0.5 * 0.3

        run(test())

    @pytest.mark.usefixtures("patient")
    def test_one_page_holds_it(self, monkeypatch, tmp_path):
        async def test():
            async with driven(monkeypatch, tmp_path, pages=2) as (_, controller, (page, other)):
                await hold(page, 0.3)
                await other.say(type="jog", frame="joint", axis=1, direction=1, speed=1.0)
                await other.say(type="jog", frame="joint", axis=1, direction=1, speed=1.0)
                assert [message["text"] for message in other.of("refused")] == ["another page moves the arm"]
                await other.say(type="jog_end")
                assert controller.jogger.owner is page.source
                await page.say(type="jog_end")
                await stands(page, controller)
                await hold(other, 0.2)
                assert controller.jogger.owner is other.source
                await other.say(type="jog_end")
                await stands(other, controller)

        run(test())

    @pytest.mark.usefixtures("patient")
    def test_a_button_that_is_held_does_not_begin_later(self, monkeypatch, tmp_path):
        async def test():
            async with driven(monkeypatch, tmp_path) as (_, controller, (page,)):
                assert (await page.ask(type="send_program", text=COUNTING))["type"] == "done"
                await hold(page, 0.1)
                assert (await page.ask(type="control", action="stop"))["type"] == "done"
                await page.until(lambda: controller.picture.task_state.name == "STOPPED")
                await hold(page, 0.2)
                assert not controller.jogger.is_active
                await page.say(type="jog_end")
                await hold(page, 0.1)
                assert controller.jogger.is_active
                await page.say(type="jog_end")
                await stands(page, controller)

        run(test())

    def test_a_page_that_was_away_has_to_release_the_button(self, monkeypatch, tmp_path):
        async def test():
            monkeypatch.setattr(source, "GAP_S", 0.06)
            async with driven(monkeypatch, tmp_path) as (_, controller, (page,)):
                await page.say(**JOG)
                await asyncio.sleep(0.07)
                await page.say(**JOG)
                await page.say(**JOG)
                texts = [message["text"] for message in page.of("refused")]
                assert texts == ["nothing was heard of the page for 0.06 s; release the button first"]
                await stands(page, controller)
                await page.say(type="jog_end")
                await page.say(**JOG)
                assert controller.jogger.is_active
                await page.say(type="jog_end")

        run(test())

    def test_without_pictures_the_arm_stands(self, monkeypatch, tmp_path):
        async def test():
            async with driven(monkeypatch, tmp_path) as (_, controller, (page,)):
                jogger = controller.jogger
                holding = asyncio.create_task(hold(page, 20.0))
                await page.until(lambda: controller.picture.values["actual_joint_speeds"][0] > 0.1)
                jogger._picture_age_s = lambda: jogging.BLIND_S
                await page.until(lambda: not any(controller.picture.values["actual_joint_speeds"]))
                assert jogger.is_active
                jogger._picture_age_s = lambda: jogging.GAP_S + 0.1
                await page.until(lambda: not jogger.is_active)
                assert page.of("notice")[-1]["text"].endswith("nothing was heard of the controller for 0.5 s")
                holding.cancel()

        run(test())

    def test_a_safeguard_ends_it_for_good(self, monkeypatch, tmp_path):
        async def test():
            async with driven(monkeypatch, tmp_path) as (_, controller, (page,)):
                await hold(page, 0.3)
                assert (await page.ask(type="control", action="safeguard_open"))["type"] == "done"
                await page.until(lambda: page.controller()["task_state"] == "STOPPED")
                last = await stands(page, controller)
                assert (await page.ask(type="control", action="safeguard_close"))["type"] == "done"
                await page.until(lambda: controller.picture.may_move)
                await hold(page, 0.2)
                assert controller.picture.joints[0] == last

        run(test())

    def test_another_program_takes_its_place(self, monkeypatch, tmp_path):
        async def test():
            async with driven(monkeypatch, tmp_path) as (scene, controller, (page,)):
                holding = asyncio.create_task(hold(page, 20.0))
                await page.until(lambda: (controller.picture.values["output_int_register40"]) < 0)
                _, writer = await asyncio.open_connection("127.0.0.1", scene.server.ports["primary"])
                writer.write(b"def other():\n  sleep(100)\nend\n")
                await page.until(lambda: not controller.jogger.is_active)
                assert "does not answer" in page.of("notice")[-1]["text"]
                holding.cancel()
                writer.close()

        run(test())


class TestPrograms:
    def test_a_text_is_sent_and_runs(self, monkeypatch, tmp_path):
        async def test():
            async with driven(monkeypatch, tmp_path) as (_, controller, (page,)):
                assert (await page.ask(type="send_program", text=COUNTING))["type"] == "done"
                await page.until(lambda: controller.picture.globals.get("n", "-") not in ("-", "0"), 10.0)
                lines = {message["moment"]["line"] for message in page.of("moment")}
                assert lines <= {0, 1, 2, 3, 4, 5}, "lines are those of the text of the page"
                answer = await page.ask(type="control", action="stop")
                assert answer["type"] == "done"

        run(test())

    def test_what_is_wrong_with_a_text_is_said_with_its_line(self, monkeypatch, tmp_path):
        async def test():
            async with driven(monkeypatch, tmp_path) as (_, _, (page,)):
                answer = await page.ask(type="send_program", text="x = 1\ny = \n")
                assert answer["type"] == "refused"
                assert answer["text"].startswith("line 2: SyntaxError")

        run(test())


class TestOwnRobot:
    def test_inputs_faults_and_stops(self, monkeypatch, tmp_path):
        async def test():
            async with driven(monkeypatch, tmp_path) as (_, _, (page,)):
                assert page.messages[0]["abilities"] == ["live", "control", "signals", "faults"]
                assert (await page.ask(type="signal", name="standard_digital_in[3]", value=True))["type"] == "done"
                await page.until(lambda: page.of("moment")[-1]["moment"]["signals"].get("standard_digital_in[3]"))
                for action, mode in (
                    ("emergency_stop", "ROBOT_EMERGENCY_STOP"),
                    ("emergency_stop_release", "NORMAL"),
                    ("safeguard_open", "SAFEGUARD_STOP"),
                    ("safeguard_close", "NORMAL"),
                ):
                    assert (await page.ask(type="control", action=action))["type"] == "done"
                    await page.until(lambda mode=mode: page.controller()["safety_mode"] == mode)
                assert (await page.ask(type="fault", words=["protective", "touched"]))["type"] == "done"
                await page.until(lambda: page.controller()["safety_mode"] == "PROTECTIVE_STOP")
                answer = await page.ask(type="control", action="play")
                assert "unlock it" in answer["text"]

        run(test())

    def test_hand_guiding(self, monkeypatch, tmp_path):
        async def test():
            async with driven(monkeypatch, tmp_path) as (_, controller, (page,)):
                assert (await page.ask(type="control", action="freedrive_on"))["type"] == "done"
                await page.until(lambda: page.controller()["task_state"] == "PLAYING")
                await page.ask(type="signal", name="external_wrench[1]", value=40.0)
                await page.say(**JOG)
                assert page.of("refused")[-1]["text"] == "hand guiding is on; end it first"
                await page.say(type="jog_end")
                first = controller.picture.joints
                await page.until(lambda: dist(first, controller.picture.joints) > 0.01)
                assert (await page.ask(type="control", action="freedrive_off"))["type"] == "done"
                await stands(page, controller)

        run(test())

    def test_hand_guiding_ends_without_the_page(self, monkeypatch, tmp_path):
        async def test():
            async with driven(monkeypatch, tmp_path) as (_, controller, (page,)):
                assert (await page.ask(type="control", action="freedrive_on"))["type"] == "done"
                held_until = controller.jogger._held_until
                await page.say(type="guiding")
                assert controller.jogger._held_until > held_until
                assert controller.jogger.is_active
                assert page.of("notice") == []
                monkeypatch.setattr(jogging, "GUIDE_HOLD_S", 0.2)
                await page.say(type="guiding")
                await page.until(lambda: not controller.jogger.is_active)
                assert page.of("notice")[-1]["text"].endswith("nothing was heard of the page for 0.2 s.")
                await page.say(type="guiding")
                assert not controller.jogger.is_active

        run(test())

    def test_a_page_that_leaves_at_once_is_not_guided(self, monkeypatch, tmp_path):
        async def test():
            async with driven(monkeypatch, tmp_path, pages=2) as (_, controller, (watching, page)):
                await page.say(type="control", action="freedrive_on", ask=1)
                await page.source.close()
                for _ in range(3):
                    await asyncio.sleep(0)
                await watching.until(lambda: not controller.jogger.is_active, 2.0)
                assert controller.picture.task_state.name == "STOPPED"

        run(test())

    def test_a_window_of_a_program_is_closed(self, monkeypatch, tmp_path):
        async def test():
            async with driven(monkeypatch, tmp_path) as (_, _, (page,)):
                text = 'popup("go on?", "Question", blocking=True)\n'
                assert (await page.ask(type="send_program", text=text))["type"] == "done"
                await page.until(lambda: "popup" in page.controller())
                popup = page.controller()["popup"]
                assert (popup["title"], popup["text"], popup["level"]) == ("Question", "go on?", "info")
                assert (await page.ask(type="control", action="close_popup"))["type"] == "done"
                await page.until(lambda: "popup" not in page.controller())
                await page.until(lambda: page.controller()["task_state"] == "STOPPED")

        run(test())
