"""Conversations with the engine: texts in, messages out, and processes that hang, are killed, or eat memory."""

from __future__ import annotations

import asyncio
import os
import signal
import socket
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path

import pytest

from elitescript.conversation.messages import Detail, GoOn, Program, RunOptions, Seek, Step
from elitescript.devices.world import World
from elitescript.robot import VirtualRobot
from elitescript.services.child.jail import landlock_version
from elitescript.studio.live import engine as module
from elitescript.studio.live import processes
from elitescript.studio.live.engine import LiveEngine, Setting
from tests.conversation.frames import joints_by_tick

EXAMPLES = Path(__file__).parents[3] / "examples"
WAIT_S = 30.0

SHORT = "def job():\n  movej([0.1, -1.57, -1.57, -1.57, 1.57, 0])\n  textmsg(1)\nend\n"
ENDLESS = "def job():\n  n = 0\n  while True:\n    n = n + 1\n    sync()\n  end\nend\n"
HANGS = "def job():\n  movej([0.1, -1.57, -1.57, -1.57, 1.57, 0])\n  n = 0\n  n = sum(range(10**12))\nend\n"


CONNECTS = """def job():
  for name in ["127.0.0.1", "localhost"]:
    is_open = socket_open(name, {port}, name)
    socket_send_line("hello", socket_name=name)
    textmsg(name, " ", is_open, " ", socket_read_string(name).strip())
  end
  socket_open("cell", 3000, "cell")
  socket_send_line("?", socket_name="cell")
  textmsg(socket_read_string("cell").strip())
end
"""
"""Talks to a real server by address and by name, and to a device that tries to get out."""

HOSTILE = """
import ctypes, os, socket
from elitescript.testing.world import TcpServer

def listen():
    socket.socket().listen()

TRIED = {{
    "write": lambda: open({escaped!r}, "w"),
    "exec": lambda: os.execv("/bin/true", ["true"]),
    "fork": os.fork,
    "read": lambda: open("/etc/passwd"),
    "trace": lambda: None,
    "listen": listen,
    "unix": lambda: socket.socket(socket.AF_UNIX),
}}

class Dev(TcpServer):
    def line_received(self, connection, line):
        said = []
        for name, work in TRIED.items():
            try:
                said.append(f"{{name}} {{work()}}")
            except OSError as error:
                said.append(f"{{name}} {{type(error).__name__}}")
            if name == "trace":
                libc = ctypes.CDLL(None, use_errno=True)
                said[-1] = f"trace {{libc.ptrace(16, os.getppid(), 0, 0)}} {{ctypes.get_errno()}}"
        return ", ".join(said)
"""


def echo(server, count):
    """Send back what so many clients send."""

    def answer(connection):
        with connection:
            while data := connection.recv(1000):
                connection.sendall(data)

    for _ in range(count):
        threading.Thread(target=answer, args=server.accept()[:1], daemon=True).start()


class Page:
    """Talks to an engine."""

    def __init__(self, setting=None):
        self.runner = asyncio.Runner()
        self.messages = []
        self.rows = []
        self.version = 0
        self.asks = 0
        self.engine = self.runner.run(self._made(setting))

    async def _made(self, setting):
        self.news = asyncio.Condition()
        engine = LiveEngine(self._take, self._take_rows, setting)
        engine.name = "job.script"
        await engine.start()
        return engine

    async def _take(self, message):
        async with self.news:
            self.messages.append(message)
            self.news.notify_all()

    async def _take_rows(self, frame):
        self.rows.append(frame)

    def close(self):
        self.runner.run(self.engine.close())
        self.runner.close()

    def clear(self):
        self.messages.clear()
        self.rows.clear()

    async def _until(self, is_wanted):
        async with self.news:
            await asyncio.wait_for(self.news.wait_for(lambda: any(map(is_wanted, self.messages))), WAIT_S)
        return next(filter(is_wanted, self.messages))

    def until(self, kind, **fields):
        """Return the first message of a type with these fields, when it has come."""
        return self.runner.run(
            self._until(lambda m: m["type"] == kind and all(m.get(name) == value for name, value in fields.items()))
        )

    def do(self, work):
        return self.runner.run(work)

    def program(self, text, **options):
        """Send a text; forget what came before."""
        self.clear()
        self.version += 1
        self.do(self.engine.program(Program(self.version, text, RunOptions(**options))))

    def ran(self, text, **options):
        """Send a text; return the end of its run."""
        self.program(text, **options)
        return self.until("run_ended")

    def asked(self, kind, run, **fields):
        """Ask for a moment or a detail; return the answer."""
        self.asks += 1
        ask, works = self.asks, {Seek: self.engine.seek, Step: self.engine.step, Detail: self.engine.detail}
        self.do(works[kind](kind(run=run, ask=ask, **fields)))
        return self.runner.run(self._until(lambda message: message.get("ask") == ask))

    def kinds(self):
        return [message["type"] for message in self.messages]


@pytest.fixture(scope="module")
def page():
    made = Page()
    yield made
    made.close()


def children_of(group):
    """Return the processes of a process group."""
    listed = subprocess.run(["ps", "-o", "pid=", "-g", str(group)], capture_output=True, text=True, check=False)
    return listed.stdout.split()


class TestRuns:
    def test_a_run_from_its_begin_to_its_end(self, page):
        page.engine.forget()
        ended = page.ran(SHORT)
        kinds = page.kinds()
        assert kinds[:3] == ["scene", "problems", "run_began"]
        assert kinds[-1] == "run_ended"
        assert not {"code", "at", "same"} & set(kinds)
        assert page.until("problems")["version"] == page.until("run_began")["version"] == page.version
        assert (ended["state"], ended["run"]) == ("finished", page.until("run_began")["run"])
        options = page.until("run_began")["options"]
        assert {name: options[name] for name in ("robot", "until_s", "world")} == {
            "robot": "CS66",
            "until_s": 120.0,
            "world": "",
        }
        trace = VirtualRobot(world=World(), task_dir={}).run(SHORT, trace=True).trace
        for tick, joints in joints_by_tick(page.rows).items():
            assert joints == pytest.approx(trace[tick].q, abs=2.5e-7)

    def test_numbers_of_runs_grow_and_the_scene_comes_once(self, page):
        first = page.ran(SHORT.replace("0.1", "0.11"))["run"]
        assert page.ran(SHORT.replace("0.1", "0.12"))["run"] > first
        assert "scene" not in page.kinds()
        page.ran(SHORT, robot="CS63")
        assert page.until("scene")["robot"] == "CS63"
        page.ran(SHORT)
        assert page.until("scene")["robot"] == "CS66"

    def test_a_text_that_does_not_compile_leaves_the_run_as_it_is(self, page):
        run = page.ran(SHORT)["run"]
        page.program("def job(")
        assert not page.until("problems")["compiles"]
        assert page.asked(Seek, run, t=0.1)["moment"]["t"] == pytest.approx(0.1)
        assert page.kinds() == ["problems", "state"]

    def test_the_newest_text_wins(self, page):
        page.program(ENDLESS)
        old = page.until("run_began")["run"]
        page.until("progress", run=old)
        seen = len(page.messages)
        page.do(page.engine.program(Program(90, SHORT)))
        page.until("run_ended")
        assert {message["run"] for message in page.messages[seen:] if "run" in message} == {old + 1}

    def test_an_unfinished_run_ends_when_the_newest_text_does_not_compile(self, page):
        page.program(ENDLESS)
        run = page.until("run_began")["run"]
        page.until("progress", run=run)
        page.do(page.engine.program(Program(91, "def job(")))
        page.do(page.engine.program(Program(92, "def job(:")))
        ended = page.until("run_ended")
        assert (ended["state"], ended["run"]) == ("stopped", run)
        assert page.until("problems", version=92)

    def test_many_texts_at_once_give_the_last_one(self, page):
        page.clear()
        for number in range(12):
            page.do(page.engine.program(Program(200 + number, SHORT.replace("0.1", f"0.{number + 20}"))))
        page.until("problems", version=211)
        ended = page.until("run_ended")
        assert ended["moment"]["joints"][0] == pytest.approx(0.31)
        assert page.until("run_began")["version"] == 211

    def test_a_run_at_its_limit_goes_on(self, page):
        ended = page.ran(ENDLESS, until_s=0.3)
        assert (ended["state"], ended["moment"]["t"]) == ("time_limit", 0.3)
        page.clear()
        page.do(page.engine.go_on(GoOn(ended["run"], 0.6)))
        assert page.until("run_ended")["moment"]["t"] == 0.6
        assert min(joints_by_tick(page.rows)) > 75
        assert page.asked(Seek, ended["run"], t=0.5)["moment"]["t"] == 0.5
        page.do(page.engine.go_on(GoOn(ended["run"] + 1, 0.9)))
        assert page.until("refused")

    def test_stop_ends_what_is_computed(self, page):
        page.program(ENDLESS, until_s=3000.0)
        page.until("progress")
        page.do(page.engine.stop())
        ended = page.until("run_ended")
        assert ended["state"] == "stopped"
        assert len(ended["moment"]["joints"]) == 6
        assert page.ran(SHORT)["state"] == "finished"

    def test_comments_do_not_run_it_again(self, page):
        before = page.ran(SHORT)
        old = [message for message in page.messages if message["type"] in ("lines", "events", "moves", "cycle")]
        ended = page.ran("# moves\n" + SHORT)
        began = page.until("run_began")
        assert began["same_until_s"] == before["moment"]["t"] == ended["moment"]["t"]
        assert began["options"]["robot"] == "CS66"
        assert ended["run"] == began["run"] == before["run"] + 1
        assert page.rows == []
        new = [message for message in page.messages if message["type"] in ("lines", "events", "moves", "cycle")]
        assert [message["type"] for message in new] == [message["type"] for message in old]
        assert [move["line"] for message in new if message["type"] == "moves" for move in message["list"]] == [3]
        assert page.ran(SHORT.replace("0.1", "0.13"))
        assert page.until("run_began")["same_until_s"] == 0.0

    def test_a_changed_file_runs_it_again(self, tmp_path):
        """One of the world, and one that the program reads."""
        world, count = tmp_path / "cell.toml", tmp_path / "count.txt"
        text = 'def job():\n  f = open("count.txt")\n  textmsg(get_standard_digital_in(0), f.read())\nend\n'
        made = Page(Setting(world=world))
        made.engine.folder = tmp_path
        try:
            said = []
            for level, number in (("true", 1), ("true", 1), ("false", 1), ("false", 2)):
                world.write_text(f'[signals]\n"standard_digital_in[0]" = {level}\n')
                count.write_text(str(number))
                made.ran(text)
                (record,) = [item for item in made.until("events")["list"] if item["type"] == "log"]
                said.append(record["text"])
            assert said == ["True1", "True1", "False1", "False2"]
        finally:
            made.close()

    def test_a_run_that_may_connect_is_run_again(self, page):
        text = 'def job():\n  textmsg(socket_open("127.0.0.1", 9))\n  sleep(0.1)\nend\n'
        page.ran(text, may_connect=True)
        page.ran(text, may_connect=True)
        assert page.until("run_began")["same_until_s"] == 0.0
        assert page.rows

    def test_a_new_page_gets_everything(self, page):
        page.ran(SHORT)
        page.engine.forget()
        page.ran(SHORT)
        assert page.until("run_began")["same_until_s"] == 0.0
        assert page.rows
        assert page.until("scene")


class TestMoments:
    def test_seek_step_and_detail(self, page):
        ended = page.ran(SHORT)
        run, end_s = ended["run"], ended["moment"]["t"]
        trace = VirtualRobot(world=World(), task_dir={}).run(SHORT, trace=True).trace
        assert page.asked(Seek, run, t=0.048)["moment"]["joints"] == list(trace[12].q)
        # A time behind the end is the end.
        assert page.asked(Seek, run, t=50.0)["moment"]["t"] == end_s
        back = page.asked(Step, run, by=-1, thread="main", t=end_s)["moment"]
        assert (back["line"], back["t"]) == (3, end_s)
        again = page.asked(Step, run, by=-1, thread="main", t=end_s, position=back["position"])["moment"]
        assert again["line"] == 2
        page.rows.clear()
        assert page.asked(Detail, run, from_s=0.04, to_s=0.08, step_s=0.004)["type"] == "detail_ended"
        assert list(joints_by_tick(page.rows)) == list(range(10, 21))

    def test_of_many_times_only_the_newest_is_answered(self, page):
        run = page.ran(SHORT)["run"]
        page.asked(Seek, run, t=0.0)
        page.clear()

        async def drag():
            for number in range(30):
                await page.engine.seek(Seek(run, 1000 + number, 0.004 * number))

        page.do(drag())
        assert page.until("state", ask=1029)["moment"]["t"] == pytest.approx(0.116)
        assert page.kinds().count("state") < 5
        # The page waits for an answer to each.
        assert sorted(message["ask"] for message in page.messages) == list(range(1000, 1030))

    def test_of_another_run_nothing_is_known(self, page):
        run = page.ran(SHORT)["run"]
        assert page.asked(Seek, run - 1, t=0.0)["type"] == "refused"
        assert page.asked(Detail, run + 1, from_s=0.0, to_s=1.0, step_s=0.04)["type"] == "refused"

    def test_a_text_that_is_sent_ends_what_is_looked_for(self, page):
        run = page.ran(SHORT)["run"]

        async def ask():
            await page.engine.seek(Seek(run, 2001, 0.0))
            await page.engine.step(Step(run, 2002, 1, "main", 0.0))
            await page.engine.detail(Detail(run, 2003, 0.0, 1.0, 0.004))

        async def ask_and_edit():
            await ask()
            await page.engine.program(Program(page.version, SHORT.replace("0.1", "0.14"), RunOptions()))

        page.clear()
        page.version += 1
        page.do(ask_and_edit())
        began = page.until("run_began", run=run + 1)
        page.until("run_ended", run=run + 1)
        answers = [message for message in page.messages if message.get("ask", 0) > 2000]
        assert sorted(message["ask"] for message in answers) == [2001, 2002, 2003]
        refused = [message for message in answers if message["type"] == "refused"]
        # One that came behind the new run is no news about the one on the screen.
        assert all(page.messages.index(message) > page.messages.index(began) for message in refused)

    def test_too_many_steps_are_refused(self, page):
        run = page.ran(SHORT)["run"]
        page.clear()

        async def press():
            for number in range(module.STEPS_MAX + 5):
                await page.engine.step(Step(run, 3000 + number, 1, "main", 0.0))

        page.do(press())
        for number in range(module.STEPS_MAX + 5):
            page.runner.run(page._until(lambda message, ask=3000 + number: message.get("ask") == ask))
        assert page.kinds().count("refused") >= 4


def kill(page, worker):
    """Kill the process of a worker, once its number has come: 0 would stand for this group of processes."""

    async def begun():
        while not worker.pid:
            await asyncio.sleep(0.001)

    page.do(begun())
    os.kill(worker.pid, signal.SIGKILL)


class TestFailures:
    def test_what_does_not_return_is_ended_with_its_line(self, page):
        ended = page.ran(HANGS)
        assert ended["state"] == "killed"
        assert ended["killed"].startswith("line 4 does not return")
        assert ended["moment"]["line"] == 4
        assert ended["moment"]["t"] > 0.0
        seen = page.asked(Seek, ended["run"], t=ended["moment"]["t"])["moment"]
        assert (seen["t"], seen["joints"]) == (ended["moment"]["t"], ended["moment"]["joints"])
        assert page.ran(SHORT)["state"] == "finished"

    def test_memory_has_a_limit(self, page):
        ended = page.ran('def job():\n  a = "x"\n  a = a * (2 * 10**9)\nend\n')
        assert ended["state"] == "alarm"
        assert (ended["alarm"]["code"], ended["alarm"]["line"]) == ("R150", 3)
        assert page.ran(SHORT)["state"] == "finished"

    def test_a_killed_worker_is_said_and_replaced(self, page):
        page.program(ENDLESS, until_s=3000.0)
        page.until("progress")
        kill(page, page.engine._worker)
        ended = page.until("run_ended")
        assert ended["state"] == "killed"
        assert "SIGKILL" in ended["killed"]
        assert page.ran(SHORT)["state"] == "finished"

    def test_a_killed_looker_is_replaced(self, page):
        run = page.ran(SHORT)["run"]
        page.asked(Seek, run, t=0.1)
        kill(page, page.engine._looker)
        answers = [page.asked(Seek, run, t=0.1)["type"] for _ in range(2)]
        assert answers[1] == "state"

    def test_a_killed_keeper_is_said_and_replaced(self, page):
        page.program(ENDLESS, until_s=3000.0)
        page.until("progress")
        os.kill(page.do(page.engine._workers()).pid, signal.SIGKILL)
        assert page.until("run_ended")["state"] == "killed"
        assert page.ran(SHORT)["state"] == "finished"
        assert "started again" in page.until("notice")["text"]

    def test_a_text_that_comes_as_the_keeper_ends_is_run(self, page):
        page.ran(SHORT)
        keeper = page.do(page.engine._workers())
        os.kill(keeper.pid, signal.SIGKILL)
        assert page.ran(SHORT.replace("0.1", "0.17"))["state"] == "finished"
        assert [message["severity"] for message in page.messages if message["type"] == "notice"] == ["warning"]

    def test_a_page_that_does_not_read_holds_the_run_back(self, page):
        text = 'def job():\n  while True:\n    textmsg("x" * 2000)\n    sync()\n  end\nend\n'
        taken, reads = page.engine._send_rows, asyncio.Event()

        async def wait(frame):
            await reads.wait()
            await taken(frame)

        async def run():
            page.engine._send_rows = wait
            await page.engine.program(Program(300, text, RunOptions(until_s=3000.0)))
            worked_s = [0.0, -1.0]
            while worked_s[-1] == 0.0 or worked_s[-1] - worked_s[-2] > 0.01:
                await asyncio.sleep(0.25)
                worker = page.engine._worker
                worked_s.append((worker.processor_time_s() or 0.0) if worker is not None else 0.0)
            return [message["type"] for message in page.messages]

        page.clear()
        try:
            # It computes no more, is not taken for one that does not return, and goes on.
            kinds = page.do(asyncio.wait_for(run(), WAIT_S))
            assert {"progress", "run_ended"}.isdisjoint(kinds)
            reads.set()
            page.until("progress")
        finally:
            page.engine._send_rows = taken
            page.do(page.engine.stop())
        assert page.until("run_ended")["state"] == "stopped"

    @pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no process group")
    def test_no_process_outlives_the_one_that_started_them(self):
        """Not even a run that never looks at its link."""
        script = (
            "import asyncio, sys\n"
            "from elitescript.conversation.messages import Program, Seek\n"
            "from elitescript.studio.live.engine import LiveEngine\n"
            "async def main():\n"
            "    began = asyncio.Event()\n"
            "    async def send(message):\n"
            "        if message['type'] == 'run_began': began.set()\n"
            "    async def send_rows(frame): pass\n"
            "    engine = LiveEngine(send, send_rows)\n"
            f"    await engine.program(Program(1, {HANGS!r}))\n"
            "    await began.wait()\n"
            "    print(engine._worker.pid, (await engine._workers()).pid, flush=True)\n"
            "    await asyncio.sleep(60)\n"
            "asyncio.run(main())\n"
        )
        started = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
        worker, keeper = map(int, started.stdout.readline().split())
        started.kill()
        started.wait()
        started.stdout.close()

        async def gone():
            while any(map(is_running, (worker, keeper))):
                await asyncio.sleep(0.01)

        asyncio.run(asyncio.wait_for(gone(), WAIT_S))


def is_running(process):
    """Return whether a process computes or waits; one that has ended and nobody has asked about does not."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state not in "ZX"


class TestSettings:
    def test_the_command_line_counts_and_the_page_more(self, tmp_path):
        (tmp_path / "cell.toml").write_text('[robot]\nmodel = "CS620"\n')
        setting = Setting(
            robot={"firmware": "2.10"},
            world=tmp_path / "cell.toml",
            levels={"standard_digital_in[3]": True},
            presets={"count": 4},
        )
        made = Page(setting)
        try:
            text = "def job():\n  global count\n  textmsg(count, get_standard_digital_in(3))\nend\n"
            made.ran(text)
            options = made.until("run_began")["options"]
            assert (options["robot"], options["firmware"]) == ("CS620", "2.10")
            (record,) = [item for item in made.until("events")["list"] if item["type"] == "log"]
            assert record["text"] == "4True"
            made.ran(text, robot="CS63", world=options["world"])
            assert made.until("run_began")["options"]["robot"] == "CS63"
            made.ran(text, world="")
            assert made.until("run_began")["options"]["robot"] == "CS66"
            made.program(text, world="../other.toml")
            assert made.until("notice")["text"] == "world: no folder is open, so ../other.toml cannot be read"
            made.engine.folder = tmp_path
            made.program(text, world="../other.toml")
            assert made.until("notice")["text"] == "world: ../other.toml is outside of the opened folder"
            assert made.until("run_ended")
        finally:
            made.close()

    def test_moments_are_found_with_files_of_other_folders(self, tmp_path):
        """A world file may name them, and they may import what is not there any more when a moment is looked for."""
        cell, shared = tmp_path / "cell", tmp_path / "shared"
        cell.mkdir()
        shared.mkdir()
        (cell / "cell.toml").write_text(
            '[robot]\nmodel = "../shared/arm.toml"\n[[tcp]]\nport = 3000\nclass = "../shared/dev.py:Dev"\n'
        )
        (shared / "arm.toml").write_text((EXAMPLES / "my_arm.toml").read_text())
        (shared / "dev.py").write_text("import websockets\nfrom elitescript.testing.world import TcpServer as Dev\n")
        made = Page(Setting(world=cell / "cell.toml"))
        try:
            ended = made.ran(SHORT)
            assert made.asked(Seek, ended["run"], t=0.1)["type"] == "state"
        finally:
            made.close()

    def test_a_world_of_the_page_lets_connect_what_the_user_lets(self, page, tmp_path):
        (tmp_path / "cell.toml").write_text("[[tcp]]\nport = 3000\n")
        page.engine.folder = tmp_path
        try:
            text = 'def job():\n  textmsg(socket_open("127.0.0.1", 9))\nend\n'
            assert page.ran(text, world="cell.toml", may_connect=True)["state"] == "finished"
            page.program(text, world="cell.toml")
            assert page.until("run_ended")["refused_connections"]
            (tmp_path / "cell.toml").write_text('[world]\nnetwork = "real"\n')
            page.program(text, world="cell.toml")
            assert page.until("notice")["text"].endswith("[world] network: 'real' is not allowed here")
        finally:
            page.engine.folder = None

    @pytest.mark.skipif(sys.platform != "linux", reason="the jail needs Linux")
    def test_a_run_that_may_connect_is_locked_in_but_for_the_network(self, tmp_path):
        try:
            landlock_version()
        except OSError as error:
            pytest.skip(str(error))
        escaped = tmp_path / "escaped"
        (tmp_path / "dev.py").write_text(HOSTILE.format(escaped=str(escaped)))
        (tmp_path / "cell.toml").write_text('[[tcp]]\naddress = "cell"\nport = 3000\nclass = "dev.py:Dev"\n')
        made = Page(Setting(world=tmp_path / "cell.toml"))
        with socket.create_server(("127.0.0.1", 0)) as server:
            port = server.getsockname()[1]
            threading.Thread(target=echo, args=(server, 2), daemon=True).start()
            try:
                ended = made.ran(CONNECTS.format(port=port), may_connect=True)
                texts = [
                    event["text"]
                    for message in made.messages
                    if message["type"] == "events"
                    for event in message["list"]
                    if event["type"] == "log"
                ]
            finally:
                made.close()
        assert ended["state"] == "finished"
        assert texts == [
            "127.0.0.1 True hello",
            "localhost True hello",
            "write PermissionError, exec PermissionError, fork PermissionError, read PermissionError, trace -1 1, "
            "listen PermissionError, unix PermissionError",
        ]
        assert not escaped.exists()

    @pytest.mark.parametrize("name", ["C" * 300, "CS66\0", "\0.toml", "C" * 300 + ".toml"])
    def test_a_name_that_no_robot_has_is_said_and_the_text_is_checked(self, page, name):
        page.program(SHORT, robot=name)
        assert "robot" in page.until("notice")["text"]
        assert page.until("problems")["compiles"]

    def test_a_run_that_may_connect_is_not_repeated(self, page):
        ended = page.ran('def job():\n  textmsg(socket_open("127.0.0.1", 9))\nend\n', may_connect=True)
        assert "refused_connections" in ended or ended["state"] == "finished"
        answer = page.asked(Seek, ended["run"], t=0.0)
        assert (answer["type"], "real connections" in answer["text"]) == ("refused", True)


class TestStarts:
    """Processes that are begun for a text while the next one comes, or not at all."""

    @pytest.mark.skipif(sys.platform != "linux", reason="there is no list of open descriptors")
    def test_texts_that_come_while_a_worker_begins_leave_nothing_open(self, page):
        async def typed(count):
            for number in range(count):
                await page.engine.program(Program(400 + number, SHORT))
                for _ in range(number % 4):
                    await asyncio.sleep(0)

        page.ran(SHORT)
        before = len(list(Path("/proc/self/fd").iterdir()))
        page.do(typed(40))
        page.program(SHORT.replace("0.1", "0.15"))
        assert page.until("run_ended")["moment"]["joints"][0] == pytest.approx(0.15)
        assert len(list(Path("/proc/self/fd").iterdir())) <= before + 4

    def test_a_computer_that_starts_no_process_is_said_and_tried_again(self, monkeypatch):
        async def fails():
            raise OSError(11, "Resource temporarily unavailable")

        with monkeypatch.context() as patch:
            patch.setattr(module, "start_workers", fails)
            patch.setattr(LiveEngine, "start", lambda engine: asyncio.sleep(0))
            made = Page()
            made.program(SHORT)
            text = "no process can be started: Resource temporarily unavailable"
            assert made.until("notice")["text"] == text
        try:
            assert made.ran(SHORT)["state"] == "finished"
        finally:
            made.close()


class TestSpares:
    """Where processes cannot be copied one is started ahead."""

    def test_runs_moments_and_ends(self, monkeypatch):
        monkeypatch.setattr(processes, "CAN_COPY", False)
        made = Page()
        try:
            ended = made.ran(SHORT)
            assert ended["state"] == "finished"
            assert made.asked(Seek, ended["run"], t=0.1)["moment"]["t"] == pytest.approx(0.1)
            assert made.ran(HANGS)["killed"].startswith("line ")
        finally:
            made.close()

    def test_texts_that_come_while_one_starts_are_run(self, monkeypatch):
        monkeypatch.setattr(processes, "CAN_COPY", False)
        made = Page()
        try:
            for number in range(3):
                made.do(made.engine.program(Program(number, SHORT)))
            assert made.ran(SHORT)["state"] == "finished"
        finally:
            made.close()

    def test_each_request_has_its_own_worker(self):
        async def begun():
            spares = await processes.Spares.start()
            try:
                first, second = await asyncio.gather(spares.begin(), spares.begin())
                return first is not second
            finally:
                await spares.close()

        assert asyncio.run(begun())

    def test_one_that_never_starts_keeps_nothing_from_ending(self, monkeypatch):
        may_end = asyncio.Event()

        async def never():
            while not may_end.is_set():
                with suppress(asyncio.CancelledError):
                    await may_end.wait()
            raise OSError

        async def closed():
            spares = await processes.Spares.start()
            await asyncio.sleep(0)
            await spares.close()
            may_end.set()

        monkeypatch.setattr(processes, "END_S", 0.01)
        monkeypatch.setattr(processes, "_started", never)
        asyncio.run(asyncio.wait_for(closed(), WAIT_S))
