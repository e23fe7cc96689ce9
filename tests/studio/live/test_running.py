"""What is reported of a run while it is computed: all of it, once, and exactly."""

from __future__ import annotations

from contextlib import suppress
from itertools import pairwise
from pathlib import Path

import pytest

from elitescript.codec.json_text import to_text
from elitescript.conversation import describe, limits
from elitescript.conversation.limits import EventBudget
from elitescript.conversation.messages import SignalInput
from elitescript.devices.world import World
from elitescript.messages.timing import TICKS_PER_S
from elitescript.plotting.events import timed_moves
from elitescript.plotting.line_times import line_times
from elitescript.plotting.sampling import Sampling
from elitescript.robot import VirtualRobot
from elitescript.studio.live import running
from elitescript.studio.live.running import run_program
from tests.conversation.frames import joints_by_tick, read
from tests.studio.live.links import ListLink, no_jail, request

EXAMPLES = Path(__file__).parents[3] / "examples"

TEXT = """def job():
  global total
  total = 0
  def blink():
    while True:
      set_standard_digital_out(1, True)
      sleep(0.3)
      set_standard_digital_out(1, False)
      sleep(0.3)
    end
  end
  start_thread(blink, ())
  for n in range(3):
    movej([0.2 * n, -1.57, -1.57, -1.57, 1.57, 0])
    total = total + n
    textmsg("n ", n)
  end
  sleep(0.5)
end
"""


def reported(text, *requests, **options):
    link = ListLink(*requests)
    run_program(link, request(text, **options), no_jail)
    return link


def by_itself(text, **options):
    robot = VirtualRobot(world=World(), task_dir={})
    return robot.run(text, trace=True, **options)


@pytest.fixture
def flushes(monkeypatch):
    """Report at every tick, so that whatever goes wrong in between is seen."""
    monkeypatch.setattr(running, "FLUSH_S", 0.0)
    monkeypatch.setattr(running, "FIRST_FLUSH_S", 0.0)


@pytest.mark.usefixtures("flushes")
class TestReport:
    def test_order(self):
        link = reported(TEXT)
        kinds = [message["type"] for message in link.messages]
        assert kinds[:4] == ["scene", "problems", "code", "run_began"]
        assert kinds[-2:] == ["cycle", "run_ended"]
        assert len(link.of("progress")) > 5
        assert all(before["t"] <= after["t"] for before, after in pairwise(link.of("progress")))
        assert all(message.get("run", 3) == 3 for message in link.messages)
        assert link.one("problems")["version"] == link.one("run_began")["version"] == 7

    def test_rows_are_those_of_the_trace(self):
        rows = {round(row.t * TICKS_PER_S): row.q for row in by_itself(TEXT).trace}
        found = joints_by_tick(reported(TEXT).rows)
        assert 0.1 * len(rows) < len(found) < 0.12 * len(rows)
        assert max(found) == max(rows)
        for tick, joints in found.items():
            assert joints == pytest.approx(rows[tick], abs=2.5e-7)
        assert max(later - before for before, later in pairwise(found)) <= 10

    def test_events_and_moves_are_those_of_the_run(self):
        run = by_itself(TEXT)
        link = reported(TEXT)
        events = [event for message in link.of("events") for event in message["list"]]
        assert events == describe.events(3, run.events, EventBudget())["list"]
        moves = [move for message in link.of("moves") for move in message["list"]]
        assert moves == describe.moves(3, timed_moves(run.events, run.time_s))["list"]
        assert len(moves) == 3

    def test_lines_of_all_threads(self):
        link = reported(TEXT)
        found = {}
        for message in link.of("lines"):
            times, lines = found.setdefault(message["thread"], ([], []))
            times += message["t"]
            lines += message["line"]
        assert set(found) == {"main", "blink"}
        times, lines = found["main"]
        assert times == sorted(times)
        assert [line for line in lines if line in (14, 18)] == [14, 18]
        # Steps of one tick are not seen in between: a `movej` follows the one before in the same line.
        assert found["blink"][1][:4] == [7, 9, 7, 9]
        assert found["blink"][0][:3] == [0.0, 0.3, 0.6]

    def test_cycle_times_are_those_of_the_rows(self):
        rows = Sampling(step_s=0.04)
        robot = VirtualRobot(world=World(), task_dir={})
        robot.run(TEXT, trace=rows)
        assert reported(TEXT).one("cycle") == describe.cycle(3, line_times(rows.rows))
        table = reported(TEXT).one("cycle")["table"]
        assert sum(row["moving_s"] + row["standing_s"] for row in table) == pytest.approx(robot.time_s)

    def test_the_end_is_exact(self):
        run = by_itself(TEXT)
        ended = reported(TEXT).one("run_ended")
        assert ended["state"] == "finished"
        assert ended["moment"]["t"] == run.time_s
        assert tuple(ended["moment"]["joints"]) == run.joints == run.trace[-1].q
        assert tuple(ended["moment"]["tcp_pose"]) == run.tcp_pose
        assert ended["moment"]["globals"] == [{"name": "total", "value": "3", "type": "int", "changed": False}]
        assert ended["moment"]["signals"] == dict(run.signals)


class TestTexts:
    def test_one_that_does_not_compile_is_not_run(self):
        link = reported("def job():\n  movej(\nend\n")
        assert [message["type"] for message in link.messages] == ["scene", "problems"]
        problems = link.one("problems")
        assert not problems["compiles"]
        assert problems["list"][0]["line"] == 2

    @pytest.mark.parametrize(("lines", "messages"), [(5, [["E304", "W201"]]), (3, [["W201"], ["E304", "W201"]])])
    def test_what_needs_no_values_of_a_long_one_comes_first(self, monkeypatch, lines, messages):
        monkeypatch.setattr(running, "LONG_LINES", lines)
        link = reported('def job():\n  sleep("x" + "y")\n  x = nonsense\nend\n')
        assert [[found["code"] for found in message["list"]] for message in link.of("problems")] == messages
        assert [message["compiles"] for message in link.of("problems")] == [True] * len(messages)
        kinds = [message["type"] for message in link.messages]
        assert kinds.index("run_began") > len(messages)

    def test_nothing_comes_first_of_a_long_one_where_nothing_is_found(self, monkeypatch):
        monkeypatch.setattr(running, "LONG_LINES", 3)
        link = reported('def job():\n  sleep("x" + "y")\n  x = 1\nend\n')
        assert [[found["code"] for found in message["list"]] for message in link.of("problems")] == [["E304"]]

    def test_one_with_errors_that_it_may_catch_is_run(self):
        link = reported("def job():\n  set_standard_digital_out(99, True)\nend\n")
        assert link.one("problems")["compiles"]
        assert link.one("problems")["list"][0]["severity"] == "error"
        ended = link.one("run_ended")
        assert ended["state"] == "alarm"
        assert (ended["alarm"]["line"], ended["alarm"]["limit"]) == (2, "n: 99, allowed in [0, 15]")

    @pytest.mark.parametrize("name", ["palletising", "two_threads_queue"])
    def test_every_begin_of_an_example_is_answered(self, name):
        text = (EXAMPLES / f"{name}.script").read_text(encoding="utf-8")
        for end in range(0, len(text), 97):
            link = ListLink()
            with suppress(EOFError):
                run_program(link, request(text[:end], until_s=0.1), no_jail)
            problems = link.one("problems")
            assert len(link.of("run_began")) == (problems["compiles"] and "start" not in problems)
            if not problems["compiles"]:
                assert problems["list"]

    def test_a_robot_that_does_not_exist_is_said_beside_the_findings(self):
        link = reported("def job():\n  movej(\nend\n", robot={"model": "CS67"})
        assert [message["type"] for message in link.messages] == ["problems", "notice"]
        assert "CS67" in link.one("notice")["text"]
        assert not link.one("problems")["compiles"]

    def test_lone_surrogates_are_a_finding(self):
        assert reported('def job():\n  textmsg("\ud800")\nend\n').of("problems")


class TestBegin:
    @pytest.mark.parametrize("text", ["", "\n", "  \n\t\n", "# only a comment", "\n  # one\n# two\n"])
    def test_a_text_that_holds_nothing_is_a_beginning(self, text):
        link = reported(text, robot={"joints": (0.1, -1.2, 1.3, -1.4, 1.5, 0.6)})
        assert [message["type"] for message in link.messages] == ["scene", "problems"]
        problems = link.one("problems")
        assert (problems["list"], problems["compiles"]) == ([], True)
        assert problems["start"]["joints"] == [0.1, -1.2, 1.3, -1.4, 1.5, 0.6]

    @pytest.mark.parametrize("text", ["pass", "'text'", "x = 1", "def job():\n  sync()\nend", "end"])
    def test_any_other_is_not(self, text):
        assert "start" not in reported(text).one("problems")


class TestLimits:
    ENDLESS = "def job():\n  n = 0\n  while True:\n    n = n + 1\n    sync()\n  end\nend\n"

    def test_at_its_limit_a_run_waits_and_goes_on(self):
        link = ListLink({"do": "go_on", "until_s": 0.5})
        with pytest.raises(EOFError):
            run_program(link, request(self.ENDLESS, until_s=0.2), no_jail)
        assert [(ended["state"], ended["moment"]["t"]) for ended in link.of("run_ended")] == [
            ("time_limit", 0.2),
            ("time_limit", 0.5),
        ]
        ticks = [tick for frame in link.rows for tick in read(frame)[1]]
        assert (ticks[0], ticks[-1]) == (0, 125)
        assert len(ticks) == len(set(ticks))
        assert 50 in ticks

    def test_a_sleep_over_the_limit_ends_at_it(self):
        link = ListLink()
        with pytest.raises(EOFError):
            run_program(link, request("def job():\n  sleep(1000)\nend\n", until_s=20.0), no_jail)
        assert link.one("run_ended")["moment"]["t"] == 20.0
        assert link.one("run_ended")["moment"]["threads"][0]["line"] == 2

    def test_wall_time_is_a_limit_too_and_said(self):
        link = ListLink()
        with pytest.raises(EOFError):
            run_program(link, request(self.ENDLESS, wall_s=0.0), no_jail)
        assert link.one("run_ended")["state"] == "time_limit"
        assert "computing" in link.one("notice")["text"]

    def test_the_joints_at_a_limit_are_those_of_a_longer_run(self):
        text = "def job():\n  movej([1, -1.57, -1.57, -1.57, 1.57, 0], a=0.5, v=0.5)\nend\n"
        link = ListLink()
        with pytest.raises(EOFError):
            run_program(link, request(text, until_s=1.0), no_jail)
        rows = {round(row.t * TICKS_PER_S): row for row in by_itself(text).trace}
        assert tuple(link.one("run_ended")["moment"]["joints"]) == rows[250].q
        assert joints_by_tick(link.rows)[250] == pytest.approx(rows[250].q, abs=2.5e-7)

    def test_events_beyond_the_limit_are_left_out_but_alarms(self, monkeypatch):
        monkeypatch.setattr(running, "EventBudget", lambda: EventBudget(5))
        monkeypatch.setattr(limits, "LAST_EVENTS", 3)
        link = reported("def job():\n  for n in range(20):\n    textmsg(n)\n  end\n  a = 1 / 0\nend\n")
        events = [event for message in link.of("events") for event in message["list"]]
        assert [event["type"] for event in events] == ["log"] * 8 + ["alarm"]
        assert [event["text"] for event in events[:-1]] == ["0", "1", "2", "3", "4", "17", "18", "19"]
        left_out = link.of("left_out")[-1]
        assert left_out["events"] == 12
        assert left_out["bytes"] > 12 * 64

    @pytest.mark.parametrize(
        "call",
        [
            'print("y" * 100000)',
            'textmsg("y" * 100000)',
            'popup("y" * 100000, "t" * 99)',
            'textmsg("y" * 9999)',
        ],
    )
    def test_long_texts_are_cut_and_all_of_them_are_bounded(self, call, monkeypatch):
        monkeypatch.setattr(limits, "BYTES_MAX", 100_000)
        monkeypatch.setattr(limits, "LAST_BYTES", 10_000)
        link = reported(f"def job():\n  for n in range(60):\n    {call}\n  end\nend\n")
        sizes = [sum(len(event.get("text", "")) for event in message["list"]) for message in link.of("events")]
        assert sum(sizes) <= limits.BYTES_MAX + limits.LAST_BYTES
        assert max(len(to_text(message)) for message in link.messages) < 2 * limits.BYTES_MAX
        assert len(to_text(link.one("run_ended"))) < 10_000
        left_out = link.of("left_out")[-1]
        if "100000" in call:
            assert left_out["bytes"] + sum(sizes) == pytest.approx(60 * 100_000, rel=0.01)

    def test_variables_of_a_moment_are_bounded(self):
        names = [f"v{number}" for number in range(1500)]
        text = f"def job():\n  global {', '.join(names)}\n  {' = '.join(names)} = 'z' * 3000\n  sleep(1)\nend\n"
        moment = reported(text).one("run_ended")["moment"]
        assert len(to_text(moment)) < 2 * limits.VARIABLES_BYTES_MAX
        assert moment["left_out"] + len(moment["globals"]) == 1500


class TestOutside:
    def test_inputs_change_at_their_times(self):
        text = (
            "def job():\n  while not get_standard_digital_in(2):\n    sync()\n  end\n"
            "  textmsg(get_standard_digital_in(1))\nend\n"
        )
        inputs = (SignalInput("standard_digital_in[1]", True, 0.0), SignalInput("standard_digital_in[2]", True, 0.4))
        link = reported(text, inputs=inputs)
        assert link.one("run_ended")["moment"]["t"] == 0.4
        events = [event for message in link.of("events") for event in message["list"]]
        assert [event["text"] for event in events if event["type"] == "log"] == ["True"]
        assert [event["by"] for event in events if event["type"] == "signal"] == ["schedule"]

    def test_connections_are_refused_and_said(self):
        link = reported('def job():\n  socket_open("192.168.1.5", 5000)\nend\n')
        (refused,) = link.one("run_ended")["refused_connections"]
        assert "192.168.1.5:5000" in refused

    def test_files_are_written_to_a_copy(self, tmp_path):
        (tmp_path / "points.txt").write_text("7")
        text = (
            'def job():\n  f = open("points.txt")\n  textmsg(f.read())\n'
            '  g = open("new.txt", "w")\n  g.write("x")\n  g.close()\nend\n'
        )
        link = reported(text, folder=str(tmp_path))
        assert link.one("run_ended")["state"] == "finished"
        events = [event for message in link.of("events") for event in message["list"]]
        assert events[0]["text"] == "7"
        assert [path.name for path in tmp_path.iterdir()] == ["points.txt"]

    def test_devices_of_a_world_file_answer(self):
        text = (EXAMPLES / "part_counter.script").read_text(encoding="utf-8")
        link = ListLink()
        try:
            run_program(link, request(text, until_s=5.0, world=str(EXAMPLES / "part_counter.toml")), no_jail)
        except EOFError:
            assert link.one("run_ended")["state"] == "time_limit"
        assert "refused_connections" not in link.one("run_ended")

    def test_contacts_with_things_of_the_world_and_the_closest_to_them(self, tmp_path):
        (tmp_path / "cell.toml").write_text(
            '[[box]]\nname = "wall"\nsize = [0.2, 0.2, 2.0]\npose = [-0.6, 0.35, 0.0, 0, 0, 0]\n'
            '[[box]]\nname = "far"\nsize = [0.1, 0.1, 0.1]\npose = [3.0, 0.0, 0.0, 0, 0, 0]\n'
        )
        text = (
            "def job():\n  movej([0, -1.2, -1.57, -1.57, 1.57, 0])\n  movej([-1.2, -1.2, -1.57, -1.57, 1.57, 0])\nend\n"
        )
        link = reported(text, world=str(tmp_path / "cell.toml"))
        found = {contact["second"]: contact for contact in link.one("contacts")["list"]}
        assert set(found) == {"wall", "far"}
        assert found["wall"]["is_contact"] == (found["wall"]["distance_m"] < 0.0)
        assert not found["far"]["is_contact"]
        assert found["far"]["distance_m"] > 1.0
        assert [part["name"] for part in link.one("scene")["parts"] if part["role"] == "thing"] == ["wall", "far"]

    def test_a_world_file_that_is_not_trusted_names_no_python(self, tmp_path):
        (tmp_path / "cell.toml").write_text('[[device]]\nclass = "cell.py:Cell"\n')
        link = reported(TEXT, world=str(tmp_path / "cell.toml"))
        assert "a Python file is not allowed here" in link.one("notice")["text"]
        assert not link.of("run_began")


class TestSameCode:
    def known(self, text, **options):
        code = reported(text, **options).one("code")
        return {"digest": code["digest"], "lines": code["lines"]}

    def test_comments_and_blank_lines_move_lines_only(self):
        link = reported(
            "# what it is\n\n" + TEXT.replace("  sleep(0.5)", "\n  # wait\n  sleep(0.5)"), known=self.known(TEXT)
        )
        assert [message["type"] for message in link.messages] == ["scene", "problems", "code", "same"]
        moved = dict(link.one("same")["moved"])
        assert (moved[14], moved[18], moved[0]) == (16, 22, 0)

    @pytest.mark.parametrize(
        ("old", "new"),
        [("0.2 * n", "0.3 * n"), ("0.2 * n", "0.2  *  n"), ('"n "', '"m "'), ("total = 0", "total = 0.0")],
    )
    def test_anything_else_is_run(self, old, new):
        assert reported(TEXT.replace(old, new), known=self.known(TEXT)).of("run_began")

    def test_other_options_are_run(self):
        assert reported(TEXT, known=self.known(TEXT), robot={"seed": 3}).of("run_began")
        assert reported(TEXT, known=self.known(TEXT), until_s=60.0).of("run_began")

    def test_a_run_that_names_lines_in_words_is_not_repeated(self):
        ended = reported("def job():\n  textmsg(1)\nend\n").one("run_ended")
        assert ended["is_repeatable"]
        stuck = reported("def job():\n  l = new_lock()\nend\n").one("run_ended")
        assert stuck["is_repeatable"] == (stuck["state"] != "stuck")
        held = ListLink()
        with pytest.raises(EOFError):
            run_program(held, request(TestLimits.ENDLESS, until_s=0.1), no_jail)
        assert not held.one("run_ended")["is_repeatable"]


def test_a_copy_of_the_folder_that_is_not_whole_is_said_once(tmp_path):
    for number in range(201):
        (tmp_path / f"{number:03}.txt").write_bytes(b"x")
    link = ListLink()
    asked = request("def p():\n  sleep(0.1)\nend\n")
    asked["job"]["folder"] = str(tmp_path)
    run_program(link, asked, no_jail)
    (notice,) = [message for message in link.messages if message["type"] == "notice"]
    assert notice["severity"] == "warning"
    assert f"a copy of the folder {tmp_path.name} that ends before 200.txt" in notice["text"]
    again = ListLink()
    run_program(again, asked | {"known": {"digest": "", "lines": []}}, no_jail)
    assert not [message for message in again.messages if message["type"] == "notice"]
