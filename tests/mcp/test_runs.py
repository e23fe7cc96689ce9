import json

import pytest

from elitescript.errors import UsageError
from elitescript.mcp import runs

PROGRAM = """\
def job():
  global parts
  textmsg("start")
  movej([0, -1.2, -1.5, -1.5, 1.5, 0], a=1.4, v=1.05)
  set_standard_digital_out(3, get_standard_digital_in(2))
  parts = parts + 1
end
"""


def request(text, **settings):
    return {"name": "<text>", "text": text, **settings}


def test_check_says_where_and_what():
    found = runs.check(request("def job():\n  movj([0,0,0,0,0,0])\nend\n"))
    assert (found["errors"], found["starts"]) == (1, True)
    problem = found["problems"][0]
    assert (problem["line"], problem["column"], problem["code"]) == (2, 3, "E301")
    assert "movej" in problem["text"] + problem["hint"]


def test_run_returns_end_messages_moves_signals_and_globals():
    found = runs.run(request(PROGRAM, set={"standard_digital_in[2]": True, "parts": 4}))
    assert found["state"] == "finished"
    assert [(message["type"], message["text"], message["line"]) for message in found["messages"]] == [
        ("log", "start", 3)
    ]
    assert [(move["kind"], move["line"], move["begin_s"]) for move in found["moves"]] == [("movej", 4, 0.0)]
    assert found["signals"] == {"standard_digital_in[2]": True, "standard_digital_out[3]": True}
    assert found["globals"] == {"parts": 5}
    assert found["joints"] == [0, -1.2, -1.5, -1.5, 1.5, 0]
    assert json.loads(json.dumps(found, allow_nan=False)) == found


def test_an_alarm_names_its_line():
    found = runs.run(request("def job():\n  textmsg(1 / 0)\nend\n"))
    assert (found["state"], found["alarm"]["line"], found["alarm"]["class"]) == ("alarm", 2, "ZeroDivisionError")


def test_a_stuck_program_names_what_its_threads_wait_for():
    found = runs.run(
        request("def job():\n  import threading\n  gate = threading.Lock()\n  gate.acquire()\n  gate.acquire()\nend\n")
    )
    assert found["state"] == "stuck"
    assert found["threads"][0]["line"] == 5
    assert "lock" in found["threads"][0]["doing"]


def test_what_does_not_compile_is_not_run():
    found = runs.run(request("def job():\n  x = (1\nend\n"))
    assert found["state"] == "does_not_compile"
    assert found["check"]["problems"][0]["line"] == 2


def test_a_run_that_takes_too_much_wall_time_says_how_far_it_came():
    found = runs.run(request("x = 0\nwhile True:\n  x = x + 1\nend\n", until_s=1e6, wall_s=0.05))
    assert (found["state"], found["cut_by_wall_time"]) == ("time_limit", True)
    assert found["time_s"] > 0.0


def test_trace_returns_rows_of_the_window():
    found = runs.trace(request(PROGRAM, set={"parts": 0}, from_s=0.1, to_s=0.3, step_s=0.1))
    assert [row["t"] for row in found["rows"]] == pytest.approx([0.1, 0.2, 0.3])
    assert all(row["line"] == 4 and len(row["joints"]) == 6 for row in found["rows"])


@pytest.mark.parametrize(
    ("window", "text"),
    [
        ((0.3, 0.1, 0.1), "no stretch"),
        ((0, 1, 0), "step_s must be > 0 s"),
        ((0, 100, 0.004), "too many"),
        ((-1, 1, 0.1), "from_s must be >= 0 s, got -1"),
    ],
)
def test_a_window_that_makes_no_sense_is_refused(window, text):
    begin, end, step = window
    with pytest.raises(UsageError, match=text):
        runs.trace(request(PROGRAM, from_s=begin, to_s=end, step_s=step))


def test_nothing_outside_the_robot_is_real():
    found = runs.run(request('ok = socket_open("127.0.0.1", 22, "s")\nglobal answer\nanswer = ok\n', until_s=20))
    assert found["globals"] == {"answer": False}


def test_long_values_are_cut():
    found = runs.run(request('def job():\n  global big\n  big = "x" * 100000\n  textmsg(big)\nend\n'))
    assert len(found["globals"]["big"]) < 3000
    assert len(json.dumps(found)) < 20000


def test_many_messages_are_counted():
    found = runs.run(request("def job():\n  for i in range(150):\n    textmsg(i)\n  end\nend\n"))
    assert len(found["messages"]) == 100
    assert found["messages_left_out"] == 50
    assert found["messages"][-1]["text"] == "149"


class TestWorldFiles:
    def run(self, tmp_path, text):
        (tmp_path / "cell.toml").write_text(text)
        return runs.run(request("def job():\n  sleep(0.1)\nend\n", world=str(tmp_path / "cell.toml")))

    def test_options_and_signals_of_the_file_count(self, tmp_path):
        (tmp_path / "cell.toml").write_text('[robot]\nspeed = 0.5\n[signals]\n"standard_digital_in[1]" = true\n')
        program = "def job():\n  global on\n  on = get_standard_digital_in(1)\nend\n"
        found = runs.run(request(program, world=str(tmp_path / "cell.toml")))
        assert found["globals"] == {"on": True}

    def test_the_network_of_this_computer_is_refused(self, tmp_path):
        with pytest.raises(UsageError, match=r"cell.toml:2: \[world\] network"):
            self.run(tmp_path, '[world]\nnetwork = "real"\n')

    def test_a_python_file_is_refused_and_not_run(self, tmp_path):
        (tmp_path / "cell.py").write_text(f"open({str(tmp_path / 'was_here')!r}, 'w')\n")
        with pytest.raises(UsageError, match=r"cell.toml:2: .*class"):
            self.run(tmp_path, '[[device]]\nclass = "cell.py:Camera"\n')
        assert not (tmp_path / "was_here").exists()


def test_large_globals_say_what_is_left_out():
    text = "def job():\n  global v, d\n  v = [0.1] * 600000\n  d = {}\n"
    text += "  for i in range(1000):\n    d[str(i)] = [i]\n  end\nend\n"
    found = runs.run(request(text))["globals"]
    assert found["v"]["repr"].endswith("0.1, … 599,900 more]")
    assert found["d"]["repr"].endswith("'99': [99], … 900 more}")


def test_findings_of_text_and_run_come_first_with_the_reason_of_the_end():
    answer = runs.run(request("def job():\n  x = 1 / 0\n  texmsg(1)\nend\n"))
    assert next(iter(answer)) == "findings"
    assert [(row["code"], row["line"], row["source"]) for row in answer["findings"]] == [
        ("R100", 2, "run"),
        ("E301", 3, "check"),
    ]
    assert (answer["findings_left_out"], answer["why"]) == (0, "ZeroDivisionError: division by zero: the divisor is 0")
