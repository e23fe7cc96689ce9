"""`elitescript run` as its contract says: events, exit codes, traces."""

import csv
import json
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from elitescript.cli.main import main
from elitescript.cli.output import trace_file
from elitescript.cli.watched import can_watch
from elitescript.controller.views.trace import TRACE_COLUMNS

SOURCE = Path(__file__).resolve().parent.parent.parent / "src"


@pytest.fixture
def program(tmp_path):
    def write(text, name="job.script"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return str(path)

    return write


@pytest.fixture
def run_json(program, capsys):
    def run(text, *options):
        code = main(["run", program(text), "--json", *options])
        return code, [json.loads(line) for line in capsys.readouterr().out.splitlines()]

    return run


def test_a_program_that_ends(run_json):
    code, records = run_json(
        'def a():\n  global n, p\n  n = 1\n  p = (1, float("nan"))\n  sleep(0.5)\n'
        '  textmsg("n=", n)\n  print(n, 2)\n  popup("look", blocking=True)\nend\n'
    )
    assert code == 0
    assert records[0] == {
        "type": "log", "t": 0.5, "level": "info", "text": "n=1", "thread": "main", "line": 6,
    }  # fmt: skip
    assert records[1] == {"type": "print", "t": 0.5, "text": "1 2", "thread": "main", "line": 7}
    assert (records[2]["type"], records[2]["text"], records[2]["confirmed"]) == ("popup", "look", True)
    end = records[-1]
    assert list(end)[:7] == ["type", "state", "t", "globals", "joints", "tcp_pose", "signals"]
    assert list(end)[7:] in (["findings", "why"], ["reproducible", "findings", "why"])
    assert (end["state"], end["t"], end["globals"]) == ("finished", 0.5, {"n": 1, "p": [1, "NaN"]})
    assert len(end["joints"]) == len(end["tcp_pose"]) == 6


def test_an_alarm(run_json):
    code, records = run_json("def a():\n  sleep(0.1)\n  movej([0, 0, 0, 0, 0, 9])\nend\n")
    assert code == 1
    alarm, end = records[-2:]
    assert (alarm["type"], alarm["t"], alarm["line"], alarm["column"], alarm["thread"]) == ("alarm", 0.1, 3, 3, "main")
    assert (alarm["code"], alarm["class"]) == ("R110", "RuntimeError")
    assert end["state"] == "alarm"


def test_a_text_that_does_not_compile(run_json):
    code, records = run_json("def a():\n  while True:\n  end\n  x = = 1\nend\n")
    assert code == 3
    assert [(record["code"], record["line"]) for record in records] == [("E104", 2), ("E001", 4)]
    assert all(record["severity"] == "error" and record["hint"] is not None for record in records)


def test_findings_against_the_catalogue_are_errors_that_refuse_only_when_strict(run_json, capsys):
    text = "def a():\n  if False:\n    set_digital_out(1, True)\n  end\nend\n"
    code, records = run_json(text)
    assert (code, records[0]["code"], records[0]["severity"]) == (0, "E301", "error")
    assert records[-1]["state"] == "finished"
    code, records = run_json(text, "--strict")
    assert (code, records[0]["severity"]) == (3, "error")


def test_a_text_in_which_nothing_runs_is_said_before_the_run_and_refused_when_strict(run_json):
    text = "import math\ndef a():\n  sync()\nend\ndef b():\n  a()\nend\n"
    code, records = run_json(text)
    assert (code, [record["type"] for record in records]) == (0, ["problem", "end"])
    assert (records[0]["code"], records[0]["severity"], records[0]["line"]) == ("W214", "warning", 5)
    code, records = run_json(text, "--strict")
    assert (code, [record["severity"] for record in records]) == (3, ["error"])


@pytest.mark.parametrize("text", ["", "# only a comment\n"])
def test_a_text_that_holds_nothing_is_told_and_refused_where_that_is_asked_for(run_json, text):
    code, records = run_json(text)
    assert (code, [record["type"] for record in records]) == (0, ["problem", "end"])
    assert (records[0]["code"], records[0]["line"]) == ("W214", 1)
    assert run_json(text, "--strict")[0] == 3


def test_a_run_in_spite_of_errors_says_why(program, capsys):
    text = "def a():\n  if False:\n    set_digital_out(1, True)\n    texmsg(1)\n  end\nend\n"
    assert main(["run", program(text)]) == 0
    told = capsys.readouterr().err
    assert told.count(": error E301: ") == 2
    assert told.endswith(
        "2 errors: their lines raise an exception. A program can catch exceptions, so it runs. --strict refuses it\n"
    )


def test_check_and_run_say_the_same(program, capsys):
    text = "def a():\n  sleeep = 1\n  if sleeep > 2:\n    movej([0, 0], a=-1)\n    texmsg(unknwn)\n  end\nend\n"
    path = program(text)
    main(["check", "--json", path])
    checked = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    main(["run", "--json", path])
    run = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert len(checked) > 3
    assert [{**record, "file": path} for record in run if record["type"] == "problem"] == checked


def test_halt_is_no_failure(run_json):
    code, records = run_json("def a():\n  halt()\nend\n")
    assert (code, records[-1]["state"]) == (0, "stopped")


@pytest.mark.skipif(os.name != "posix", reason="descriptors as POSIX has them")
def test_streams_that_the_caller_has_closed_are_no_defect(program):
    command = [sys.executable, "-m", "elitescript", "run", str(program("sleep(1)\n"))]
    done = subprocess.run(["sh", "-c", 'exec "$@" <&- >&-', "sh", *command], stderr=subprocess.PIPE, check=False)
    assert (done.returncode, done.stderr) == (0, b"")


def test_a_time_limit(run_json):
    code, records = run_json("def a():\n  while True:\n    sync()\n  end\nend\n", "--until", "1.5")
    assert (code, records[-1]["state"], records[-1]["t"]) == (4, "time_limit", 1.5)
    assert records[-1]["threads"][0]["line"] == 3


def test_a_limit_of_wall_time(run_json):
    code, records = run_json("def a():\n  while True:\n    pass\n  end\nend\n", "--max-wall", "0.1")
    assert (code, records[-1]["state"]) == (4, "time_limit")


def test_a_program_that_is_stuck(run_json):
    code, records = run_json("def a():\n  pause()\nend\n")
    assert (code, records[-1]["state"]) == (5, "stuck")
    assert records[-2]["code"] == "R130"
    assert "line 2" in records[-2]["text"]


def test_settings_reach_the_program(run_json):
    code, records = run_json(
        "def a():\n  textmsg(get_standard_digital_in(3), count)\n  set_standard_digital_out(0, True)\nend\n",
        *("--set", "standard_digital_in[3]=true", "--set", "count=7"),
    )
    assert code == 0
    assert records[0]["text"] == "True7"
    assert records[-1]["signals"] == {"standard_digital_in[3]": True, "standard_digital_out[0]": True}


def test_what_is_kept_is_there_for_the_next_run(program, tmp_path, capsys):
    path = program("def p():\n  write_port_register(256, read_port_register(256) + 1)\n  textmsg(get_flag(3))\nend\n")
    state = str(tmp_path / "state.json")
    for options in ((), (), ("--set", "flag[3]=true"), ()):
        assert main(["run", str(path), "--state", state, *options]) == 0
    words = [line.split()[-1] for line in capsys.readouterr().out.splitlines() if line.endswith(("True", "False"))]
    assert words == ["False", "False", "True", "True"]
    assert json.loads(Path(state).read_text())["signals"] == {"flag[3]": True, "general_register[0]": 4}


def test_a_state_file_of_somebody_else_is_left_alone(program, tmp_path, capsys):
    path = tmp_path / "notes.json"
    path.write_text('{"mine": 1}')
    assert main(["run", str(program("textmsg(1)\n")), "--state", str(path)]) == 2
    assert "It was left as it is" in capsys.readouterr().err
    assert path.read_text() == '{"mine": 1}'


def test_start_joints_speed_robot_and_epoch(run_json):
    text = "def a():\n  textmsg(get_target_joint_positions())\n  textmsg(controller_timestamp())\nend\n"
    _, records = run_json(text, "--joints", "0.1,-1.5,-1.5,-1.5,1.5,0", "--epoch", "2025-01-01", "--robot", "cs620")
    assert records[0]["text"] == "[0.1, -1.5, -1.5, -1.5, 1.5, 0.0]"
    assert records[1]["text"] == "1735689600.0"
    move = "def a():\n  movej([0.5, -1.5, -1.5, -1.5, 1.5, 0])\nend\n"
    fast, slow = run_json(move)[1][-1]["t"], run_json(move, "--speed", "0.5")[1][-1]["t"]
    assert slow == pytest.approx(2 * fast, abs=0.008)


@pytest.mark.parametrize("options", [[], ["--step", "0.02"]])
def test_a_trace_as_csv_and_as_json_lines_is_the_same(program, tmp_path, capsys, options):
    path = program("def a():\n  movel([0.45, -0.15, 0.45, 3.14159, 0, -1.5708])\n  sleep(0.05)\nend\n")
    for ending in ("csv", "jsonl"):
        assert main(["run", path, "--trace", str(tmp_path / f"out.{ending}"), *options]) == 0
    with (tmp_path / "out.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    records = [json.loads(line) for line in (tmp_path / "out.jsonl").read_text().splitlines()]
    assert tuple(rows[0]) == TRACE_COLUMNS == tuple(records[0])
    assert len(rows) == len(records) > 10
    for row, record in zip(rows, records, strict=True):
        assert {key: str(value) for key, value in record.items()} == row
    assert float(records[-1]["x"]) == pytest.approx(0.45, abs=1e-9)


def test_a_trace_as_parquet_has_the_rows_and_signals_of_one_as_json_lines(program, tmp_path, monkeypatch, capsys):
    parquet = pytest.importorskip("pyarrow.parquet")
    monkeypatch.setattr(trace_file, "GROUP_ROWS", 50)
    path = program(
        "def a():\n  set_standard_digital_out(0, True)\n  movel([0.45, -0.15, 0.45, 3.14159, 0, -1.5708])\nend\n"
    )
    names = "standard_digital_out[0],standard_analog_out[0],output_int_register[3]"
    for ending in ("parquet", "jsonl"):
        assert main(["run", path, "--trace", str(tmp_path / f"out.{ending}"), "--trace-signals", names]) == 0
    table = parquet.read_table(tmp_path / "out.parquet")
    assert table.to_pylist() == [json.loads(line) for line in (tmp_path / "out.jsonl").read_text().splitlines()]
    assert [str(kind) for kind in table.schema.types[-4:]] == ["string", "bool", "double", "int64"]
    assert parquet.ParquetFile(tmp_path / "out.parquet").num_row_groups > 1


def test_a_trace_as_parquet_of_a_program_that_does_not_move(program, tmp_path, capsys):
    parquet = pytest.importorskip("pyarrow.parquet")
    assert main(["run", program("def a():\n  x = 1\nend\n"), "--trace", str(tmp_path / "out.parquet")]) == 0
    assert parquet.read_table(tmp_path / "out.parquet").column_names == list(TRACE_COLUMNS)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--robot", "CS1"], "CS1"),
        (["--speed", "2"], "speed"),
        (["--joints", "1,2"], "six"),
        (["--set", "x"], "NAME=VALUE"),
        (["--set", "standard_digital_in[99]=1"], "indices 0 to 15"),
        (["--trace", "out.txt"], ".csv, .jsonl or .parquet"),
        (["--step", "1"], "--trace"),
        (["--trace", "out.csv", "--step", "0.003"], "choose 0.004 s"),
        (["--trace", "out.csv", "--step", "0.01"], "choose 0.008 or 0.012 s"),
        (["--until", "nan"], "--until"),
        (["--set", "standard_analog_in[0]=50"], "[0, 10]"),
        (["--set", "input_int_register[0]=99999999999"], "input_int_register[0]"),
        (["--set", "input_int_register[0]=1e999"], "input_int_register[0]"),
        (["--set", "tool_digital_out[3]=true"], "tool pin 3"),
        (["--set", "if=3"], "global"),
        (["--set", "__builtins__=3"], "global"),
        (["--epoch", "nan"], "nan"),
        (["--max-wall", "-1"], "--max-wall"),
        (["--task-dir", "/nowhere/at/all"], "/nowhere/at/all"),
    ],
)
def test_a_call_that_makes_no_sense_is_refused(program, capsys, options, words):
    assert main(["run", program("def a():\n  pass\nend\n"), *options]) == 2
    assert words in capsys.readouterr().err


@pytest.mark.skipif(not Path("/dev/stdin").exists(), reason="no such file on this system")
def test_a_program_can_come_through_a_pipe():
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    for options in ((), ("--max-wall", "20")):
        command = [sys.executable, "-m", "elitescript", "run", "/dev/stdin", *options]
        result = subprocess.run(command, env=environment, input=b"textmsg('x')\n", capture_output=True, check=True)
        assert b"0.000 s  x" in result.stdout


def test_a_missing_file_is_named(capsys):
    assert main(["run", "missing.script"]) == 2
    assert "missing.script" in capsys.readouterr().err


def test_a_file_that_is_not_utf_8_is_refused_with_its_place(tmp_path, capsys):
    path = tmp_path / "latin.script"
    path.write_bytes(b"def a():\n  textmsg('\xe4')\nend\n")
    assert main(["run", str(path)]) == 3
    assert "E002" in capsys.readouterr().err


def test_people_see_what_happened_and_where_it_went_wrong(program, capsys):
    assert main(["run", program("def a():\n  textmsg('go')\n  sleep(1)\n  x = [1][3]\nend\n")]) == 1
    captured = capsys.readouterr()
    assert "0.000 s  go" in captured.out
    assert "1.000 s  ended by an alarm" in captured.out
    assert "in line 4: IndexError: index 3 is out of range: `[1]` has 1 element" in captured.err
    assert "4 |   x = [1][3]" in captured.err


def test_a_call_that_never_comes_back_is_ended_from_outside(program):
    path = program("def a():\n  textmsg('before')\n  x = sum(range(10**12))\nend\n")
    command = [sys.executable, "-m", "elitescript", "run", path, "--json", "--max-wall", "0.05"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    result = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=30, check=False)
    records = [json.loads(line) for line in result.stdout.splitlines()]
    assert result.returncode == 4
    assert (records[0]["text"], records[-1]["type"], records[-1]["state"]) == ("before", "end", "time_limit")
    assert "does not come back" in result.stderr


def test_the_process_gives_the_same_bytes_for_every_hash_seed(program):
    path = program("def a():\n  textmsg({'a', 'b', 'c', 'd', 'e'})\n  textmsg(random())\n  print(object())\nend\n")
    outputs = set()
    for seed in ("1", "2", "random"):
        environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(sys.path)}
        command = [sys.executable, "-m", "elitescript", "run", path, "--json"]
        outputs.add(subprocess.run(command, env=environment, capture_output=True, check=True).stdout)
    assert len(outputs) == 1


@pytest.mark.skipif(not can_watch() or sys.version_info >= (3, 14), reason="every run starts Python twice here")
@pytest.mark.parametrize(
    ("text", "seed", "words", "starts"),
    [
        ("def a():\n  textmsg('a')\nend\n", "random", (), 1),
        ("def a():\n  textmsg({'a'})\nend\n", "random", (), 2),
        ("def a():\n  textmsg({'a'})\nend\n", "0", (), 1),
        ("def a():\n  textmsg('a')\nend\n", "1", ("--world", "cell.toml"), 2),
        ("def a():\n  textmsg('a'\nend\n", "1", (), 1),
        ("def a():\n  global x\nend\n", "1", ("--set", "x={'a': 1}"), 1),
        ("def a():\n  global x\nend\n", "1", ("--set", "x=[{'a'}]"), 2),
    ],
    ids=["no set", "a set", "a set and a fixed seed", "a world", "a mistake", "a dict outside", "a set outside"],
)
def test_python_starts_again_only_if_the_order_of_a_set_can_show(text, seed, words, starts, program, tmp_path):
    (tmp_path / "cell.toml").write_text("[robot]\nseed = 1\n")
    (tmp_path / "sitecustomize.py").write_text("with open('starts', 'a') as file:\n  file.write('x')\n")
    path = os.pathsep.join((str(tmp_path), *sys.path))
    environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": path}
    command = [sys.executable, "-m", "elitescript", "run", program(text), "--json", *words]
    done = subprocess.run(command, env=environment, capture_output=True, check=False, cwd=tmp_path)
    assert b"reproducible" not in done.stdout
    assert len((tmp_path / "starts").read_text()) == starts


def test_a_seed_that_python_was_told_to_ignore_is_none(program):
    text = program("textmsg({'a', 'b', 'c', 'd', 'e'})\n")
    environment = {**os.environ, "PYTHONHASHSEED": "0"}
    call = f"import sys; sys.path[:0] = {sys.path!r}; from elitescript.cli.main import main; sys.exit(main())"
    outputs = set()
    for options in ((), ("-E",), ("-E",)):
        command = [sys.executable, *options, "-c", call, "run", text, "--json"]
        outputs.add(subprocess.run(command, env=environment, capture_output=True, check=True).stdout)
    assert len(outputs) == 1


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
def test_what_is_installed_beside_the_package_is_found(program, tmp_path):
    """As by `pip install --target`, in whose folder Python is started then."""
    import greenlet

    folder = tmp_path / "target"
    folder.mkdir()
    (folder / "elitescript").symlink_to(SOURCE / "elitescript")
    (folder / "greenlet").symlink_to(Path(greenlet.__file__).parent)
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    command = [sys._base_executable, "-S", "-m", "elitescript", "run", program("textmsg('hello')\n")]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, "hello" in done.stdout) == (0, True), done.stderr


def test_a_path_that_cannot_be_looked_at_is_named(tmp_path):
    path = str(tmp_path / ("a" * 5000))
    command = [sys.executable, "-m", "elitescript", "run", path]
    environment = {**os.environ, "PYTHONPATH": str(SOURCE)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    # Of the path the middle is left out.
    assert (done.returncode, done.stderr.startswith(f"elitescript run: cannot read {path[:2000]}")) == (2, True)
    assert done.stderr.endswith("aaa: File name too long\n")
    assert len(done.stderr) < 4100


CELL = """[safety]
[[safety.planes]]
name = "table"
point = [0, 0, 0.3]
normal = [0, 0, 1]
"""
DOWN = "def a():\n  p = get_target_tcp_pose()\n  p[2] -= 0.3\n  movel(p, a=1, v=0.4)\nend\n"


@pytest.fixture
def cell(tmp_path):
    path = tmp_path / "cell.toml"
    path.write_text(CELL)
    return path


def test_a_protective_stop_as_json_has_reason_value_limit_and_what_to_try(run_json, cell):
    code, records = run_json(DOWN, "--world", str(cell))
    safety, alarm, end = records
    assert code == 1
    assert (safety["type"], safety["mode"]) == ("safety", "PROTECTIVE_STOP")
    assert (alarm["code"], alarm["class"], alarm["line"], alarm["column"]) == ("R140", "ProtectiveStop", 4, 3)
    assert (alarm["reason"], alarm["plane"], alarm["limit"], alarm["unit"]) == ("plane", "table", ">= 0", "m")
    assert -0.01 < alarm["value"] < 0.0
    assert len(alarm["hints"]) == 3
    assert end["state"] == "alarm"


def test_a_protective_stop_for_people_has_the_line_the_reason_and_three_things_to_try(program, capsys, cell):
    assert main(["run", program(DOWN), "--world", str(cell)]) == 1
    captured = capsys.readouterr()
    assert "ALARM R140 in line 4: ProtectiveStop: the TCP is " in captured.err
    assert "behind safety plane 'table'" in captured.err
    assert "    4 |   movel(p, a=1, v=0.4)" in captured.err
    assert captured.err.count(" try: ") == 3
    assert "ended by an alarm" in captured.out


@pytest.mark.parametrize(("setting", "code", "word"), [("emergency_stop", 1, "R141"), ("safeguard_stop", 5, "R130")])
def test_a_stop_that_is_pressed_from_the_start(run_json, setting, code, word):
    exit_code, records = run_json(DOWN, "--set", f"{setting}=true")
    assert exit_code == code
    assert [record["code"] for record in records if record["type"] == "alarm"] == [word]


def test_an_emergency_stop_says_what_leads_back(program, capsys):
    assert main(["run", program(DOWN), "--set", "emergency_stop=true"]) == 1
    err = capsys.readouterr().err
    assert "ALARM R141: EmergencyStop: cannot start: the emergency stop is pressed; release it" in err
    assert "power on and release the brakes; then start the program again" in err


def test_an_open_safeguard_says_that_the_program_is_held(program, capsys):
    assert main(["run", program(DOWN), "--set", "safeguard_stop=true"]) == 5
    err = capsys.readouterr().err
    assert "the safeguard is open; close it" in err
    assert "waits for ;" not in err


def test_a_mistake_in_the_cell_file_is_one_of_usage(program, capsys, tmp_path):
    path = tmp_path / "cell.toml"
    path.write_text("[safety]\ntcp_speed = 'fast'\n")
    assert main(["run", program(DOWN), "--world", str(path)]) == 2
    assert f"{path}:2: [safety] tcp_speed must be a number > 0 in m/s, got 'fast'" in capsys.readouterr().err


def test_a_connection_to_the_outside_paces_the_run_and_the_end_says_so(run_json):
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        text = f'def a():\n  socket_open("127.0.0.1", {port})\n  socket_send_string("hello")\nend\n'
        code, records = run_json(text)
        server.settimeout(10)
        peer, _ = server.accept()
        with peer:
            assert peer.recv(100) == b"hello"
            assert peer.recv(100) == b""
    assert (code, records[-1]["state"], records[-1]["paced"]) == (0, "finished", True)


def test_a_run_without_one_is_not_paced(run_json):
    _, records = run_json("def a():\n  sleep(60)\nend\n")
    assert "paced" not in records[-1]


def test_devices_of_a_world_file_are_beside_the_program(run_json, tmp_path):
    path = tmp_path / "world.toml"
    path.write_text("[[tcp]]\nname = 'camera'\nport = 5000\nreplies = [{ to = 'where?', send = '7' }]\n")
    text = 'def main():\n  socket_open("h", 5000)\n  socket_send_line("where?")\n'
    text += '  textmsg(socket_read_string("socket_0", "", "\\n"))\n  socket_send_line("what?")\n  sleep(1)\nend\n'
    for option in ("--world", "--cell"):
        code, records = run_json(text, option, str(path))
        assert code == 0
        assert [record["text"] for record in records if record["type"] == "log"] == ["7"]
        assert [(record["level"], record["device"]) for record in records if record["type"] == "device"] == [
            ("warning", "camera")
        ]


def test_a_device_that_fails_ends_the_records_too(run_json, tmp_path):
    (tmp_path / "cell.py").write_text(
        "from elitescript.testing.world import Device\n\n\nclass Bad(Device):\n    def started(self):\n"
        "        self.after(0.5, self.fail)\n\n    def fail(self):\n        raise ValueError('lens')\n"
    )
    path = tmp_path / "world.toml"
    path.write_text("[[device]]\nclass = 'cell.py:Bad'\n")
    code, records = run_json("def main():\n  sleep(1)\nend\n", "--world", str(path))
    assert code == 1
    assert (records[-1]["type"], records[-1]["state"], records[-1]["t"]) == ("end", "stopped", 0.5)
    assert records[-2]["type"] == "device"
    assert records[-2]["text"] == f"{tmp_path / 'cell.py'}:9: device Bad: ValueError: lens"


def test_a_device_that_fails_is_an_error_with_its_place(program, capsys, tmp_path):
    (tmp_path / "cell.py").write_text(
        "from elitescript.testing.world import Device\n\n\nclass Bad(Device):\n    def started(self):\n        1 / 0\n"
    )
    path = tmp_path / "world.toml"
    path.write_text("[[device]]\nclass = 'cell.py:Bad'\n")
    # The program has not begun.
    assert main(["run", program("def main():\n  sleep(1)\nend\n"), "--world", str(path)]) == 2
    assert f"{tmp_path / 'cell.py'}:6: device Bad: ZeroDivisionError" in capsys.readouterr().err


ENDLESS = """
from elitescript.testing.world import TcpServer


class Endless(TcpServer):
    port = 5000

    def opened(self, connection):
        print("here", flush=True)
        while True:
            pass
"""


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_a_device_that_does_not_come_back_is_told_of_after_ctrl_c_and_a_second_one_ends_it(tmp_path):
    (tmp_path / "cell.py").write_text(ENDLESS)
    (tmp_path / "cell.toml").write_text('[[tcp]]\nclass = "cell.py:Endless"\n')
    program = tmp_path / "cell.script"
    program.write_text('def cell():\n  socket_open("127.0.0.1", 5000)\nend\n')
    process = subprocess.Popen(
        [sys.executable, "-m", "elitescript", "run", str(program), "--world", str(tmp_path / "cell.toml")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": str(SOURCE)},
    )
    assert process.stdout is not None and process.stderr is not None
    try:
        assert process.stdout.readline() == "here\n"
        process.send_signal(signal.SIGINT)
        assert "still busy" in process.stderr.readline()
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=20)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == -signal.SIGINT


def test_a_remote_procedure_call_waits_as_long_as_it_may(run_json, tmp_path):
    path = tmp_path / "world.toml"
    path.write_text('[[tcp]]\nname = "silent"\nport = 5050\n', encoding="utf-8")
    text = 'def a():\n  rpc_factory("xmlrpc", "h:5050").f()\nend\n'
    code, records = run_json(text, "--world", str(path), "--rpc-timeout", "0.25")
    assert code == 1
    assert "no answer within 0.25 s" in next(record["text"] for record in records if record["type"] == "alarm")
    with pytest.raises(SystemExit):
        main(["run", "x.script", "--rpc-timeout", "soon"])


def test_changes_of_signals_are_records(run_json):
    _, records = run_json(
        "def a():\n  set_standard_digital_out(0, True)\nend\n", "--set", "standard_digital_in[3]=true"
    )
    assert [record for record in records if record["type"] == "signal"] == [
        {"type": "signal", "t": 0.0, "name": "standard_digital_out[0]", "value": True, "by": "program", "line": 2},
    ]


def test_what_passes_on_connections_are_records(run_json, tmp_path):
    world = tmp_path / "cell.toml"
    world.write_text('[[tcp]]\nport = 5000\nreplies = [{ match = "go", send = "12.5" }]\n', encoding="utf-8")
    _, records = run_json(
        'def a():\n  socket_open("h", 5000, "cam")\n  socket_send_string("go\\n", "cam")\n'
        '  socket_read_string("cam", suffix="\\n")\nend\n',
        "--world",
        str(world),
    )
    found = [record for record in records if record["type"] == "channel"]
    assert [(record["what"], record["data"], record["line"]) for record in found] == [
        ("open", "h:5000", 2),
        ("sent", "go\n", 3),
        ("received", "12.5\n", 4),
        ("closed", "", 0),
    ]
    assert {(record["channel"], record["kind"]) for record in found} == {("cam", "socket")}


def test_text_has_signals_when_asked(program, capsys):
    path = program("def a():\n  set_standard_digital_out(0, True)\nend\n")
    assert main(["run", path]) == 0
    assert "standard_digital_out" not in capsys.readouterr().out
    assert main(["run", path, "--log", "signals"]) == 0
    assert "[signal] standard_digital_out[0] = True (line 2)" in capsys.readouterr().out
    assert main(["run", path, "--log", "sounds"]) == 2


def test_signals_as_columns_of_a_trace(program, tmp_path, capsys):
    path = program(
        "def a():\n  sleep(0.008)\n  set_standard_digital_out(1, True)\n  set_standard_analog_out(0, 0.1)\nend\n"
    )
    trace, names = tmp_path / "t.csv", "standard_digital_out[1],standard_analog_out[0]"
    assert main(["run", path, "--trace", str(trace), "--trace-signals", names]) == 0
    rows = list(csv.DictReader(trace.read_text(encoding="utf-8").splitlines()))
    assert list(rows[0]) == [*TRACE_COLUMNS, *names.split(",")]
    assert [(row["standard_digital_out[1]"], row["standard_analog_out[0]"]) for row in rows] == [
        ("0", "0.0"),
        ("0", "0.0"),
        ("1", "1.0"),
    ]
    lines = tmp_path / "t.jsonl"
    assert main(["run", path, "--trace", str(lines), "--trace-signals", names]) == 0
    assert [json.loads(line)["standard_digital_out[1]"] for line in lines.read_text().splitlines()] == [
        False,
        False,
        True,
    ]
    assert main(["run", path, "--trace-signals", names]) == 2
    assert main(["run", path, "--trace", str(trace), "--trace-signals", "standard_digital_uot[1]"]) == 2
    assert "standard_digital_uot" in capsys.readouterr().err
