"""Ports in this process, the robot in a jailed child: what a program does there, clients here do not notice."""

import asyncio
import os
from itertools import pairwise

import pytest

from elitescript.kernel import RobotOptions
from elitescript.messages.events import Alarm, TextMessage
from elitescript.messages.outputs import REPEAT_AFTER_S
from elitescript.messages.timing import PERIOD_S, seconds
from elitescript.services.child.link import ChildLink
from elitescript.services.port_numbers import NAMES
from elitescript.services.robots import served_robot
from tests.protocol import rtsi_client
from tests.services.served import Scene

LIMIT_S = 40.0
GAP_S = 1.0
"""Longest silence of a stream: then the vendor's client in C++ ends its connection."""

pytestmark = pytest.mark.skipif(os.name != "posix", reason="children inherit a socket, as POSIX has it")


class Stream:
    """An RTSI client that notes its packages, and how long it waited for each."""

    def __init__(self, peer, scene):
        self.peer = peer
        self._scene = scene
        self.stamps: list[float] = []
        self.repeated: list[tuple[float, float]] = []
        """Stamps of the packages that came again, and the time of the server then."""
        self.worst_s = 0.0

    async def begin(self):
        self.peer.send(rtsi_client.message("V", b"\0\1"))
        await self.peer.rtsi("V")
        self.peer.send(rtsi_client.output_recipe(250.0, ["timestamp"]) + rtsi_client.message("S"))
        await self.peer.rtsi("U")

    async def read(self):
        loop = asyncio.get_running_loop()
        last_s = loop.time()
        while True:
            _, payload = await self.peer.rtsi("U")
            self.worst_s = max(self.worst_s, loop.time() - last_s)
            last_s = loop.time()
            (stamp,) = rtsi_client.values(payload, ["DOUBLE"])
            if self.stamps[-1:] == [stamp]:
                self.repeated.append((stamp, seconds(self._scene.server.output.tick)))
            self.stamps.append(stamp)

    @property
    def news(self):
        """Stamps of the packages that are new, each once."""
        return list(dict.fromkeys(self.stamps))


class Pulse:
    """Notes the longest time for which this computer did not let the event loop go on."""

    def __init__(self):
        self.worst_s = 0.0

    async def beat(self):
        loop = asyncio.get_running_loop()
        while True:
            begin_s = loop.time()
            await asyncio.sleep(0.01)
            self.worst_s = max(self.worst_s, loop.time() - begin_s - 0.01)


def play(program, is_over, after=lambda scene, streams: None):
    """Send a program to a served robot; two clients stream until something is so."""

    async def run():
        scene = Scene()
        link = ChildLink(RobotOptions(power_on=True))
        scene.server = served_robot("CS66", link, lambda _, what: scene.said.append(what))
        await scene.server.boot()
        scene.server.bind("127.0.0.1", dict.fromkeys(NAMES, 0))
        await scene.server.open()
        pulse = Pulse()
        readers = [asyncio.get_running_loop().create_task(pulse.beat())]
        try:
            streams = [Stream(await scene.connect("rtsi"), scene) for _ in range(2)]
            for stream in streams:
                await stream.begin()
                readers.append(asyncio.get_running_loop().create_task(stream.read()))
            primary = await scene.connect("primary")
            primary.send(program.encode())
            await scene.until(lambda: is_over(scene, streams))
            for stream in streams:
                assert stream.worst_s < GAP_S + pulse.worst_s
                # No tick is missing but those of one restart, however long that and this client's reading take.
                gaps = [later - earlier for earlier, later in pairwise(stream.news)]
                assert gaps
                assert sum(gap > 1.5 * PERIOD_S for gap in gaps) <= 1
                assert stream.stamps == sorted(stream.stamps)
                assert all(now_s - stamp > REPEAT_AFTER_S for stamp, now_s in stream.repeated)
            after(scene, streams)
        finally:
            for reader in readers:
                reader.cancel()
            for peer in scene.peers:
                await peer.close()
            await scene.server.close()

    asyncio.run(asyncio.wait_for(run(), LIMIT_S))


def texts(scene):
    return [event.text for event in scene.said if isinstance(event, TextMessage)]


def goes_on(scene, streams):
    """Whether every client has got a package of the robot that took the place of another."""
    alarms = [event for event in scene.said if isinstance(event, Alarm)]
    return bool(alarms) and all(stream.stamps and stream.stamps[-1] > seconds(alarms[0].tick) for stream in streams)


def test_an_endless_loop_does_not_disturb_the_streams():
    program = "def p():\n  def forever():\n    while True:\n      pass\n  start_thread(forever, ())\n"
    program += "  sleep(0.5)\n  textmsg('half a second')\n  while True:\n    pass\nend\n"

    def after(scene, streams):
        for stream in streams:
            assert len(stream.news) > 100
            assert max(later - earlier for earlier, later in pairwise(stream.news)) < 0.005

    play(program, lambda scene, streams: "half a second" in texts(scene), after)


def test_a_call_that_never_returns_is_ended_and_the_streams_go_on():
    def after(scene, streams):
        (alarm,) = [event for event in scene.said if isinstance(event, Alarm)]
        assert alarm.code == "R132"
        assert alarm.line == 3
        for stream in streams:
            # Most of the time there is nothing new: the last tick before it again and again.
            assert len(stream.repeated) > 50
            assert len(stream.stamps) == len(stream.news) + len(stream.repeated)

    program = "def p():\n  textmsg('now')\n  sum(range(10**12))\nend\n"

    play(program, goes_on, after)


def test_long_calls_again_and_again_end_the_program_with_the_line_of_the_call():
    def after(scene, streams):
        (alarm,) = [event for event in scene.said if isinstance(event, Alarm)]
        assert alarm.code == "R135"
        assert alarm.line == 4
        assert alarm.source_line.strip() == "x = sum(range(1500000))"
        assert alarm.details["limit"] == 0.25
        assert alarm.details["value"] >= 0.01

    program = "def p():\n  while True:\n    a = 1\n    x = sum(range(1500000))\n    b = 2\n    c = 3\n  end\nend\n"

    play(program, goes_on, after)


def test_a_crash_is_told_with_its_line_and_the_streams_go_on():
    def after(scene, streams):
        (alarm,) = [event for event in scene.said if isinstance(event, Alarm)]
        assert alarm.code == "R132"
        assert alarm.line == 6

    program = "def p():\n  x = [1]\n  for i in range(150000):\n    x = map(int, x)\n  end\n  y = list(x)\nend\n"

    play(program, goes_on, after)
