"""Programs that crash their process, or fill its memory: the process beside it says what happened, and where."""

import json
import os
import signal
import subprocess
import sys

import pytest

from elitescript.cli.watched import can_watch
from elitescript.environment.process import place_in_trace

pytestmark = pytest.mark.skipif(not can_watch(), reason="needs Linux")

# The stack that a run gets is cut down, so that what fills it takes milliseconds.
SMALL_STACK = "import resource; resource.setrlimit(resource.RLIMIT_STACK, (1 << 20, 1 << 20)); "
MAIN = "import sys; from elitescript.cli.main import main; sys.exit(main())"


def run(text, tmp_path, *options, before=""):
    path = tmp_path / "p.script"
    path.write_text(text)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "PYTHONUNBUFFERED": ""}
    command = [sys.executable, "-c", before + MAIN, "run", str(path), *options]
    return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60, check=False)


def nested(make, use):
    return f"def p():\n  textmsg('begins')\n  x = [1]\n  for i in range(60000):\n    x = {make}\n  end\n  {use}\nend\n"


CRASHES = {
    "an iterator of iterators that is read": nested("map(int, x)", "y = list(x)"),
    "filters": nested("filter(None, x)", "y = list(x)"),
    "pairs": nested("zip(x)", "y = list(x)"),
    "numbered": nested("enumerate(x)", "y = list(x)"),
}


@pytest.mark.parametrize("text", CRASHES.values(), ids=CRASHES)
def test_a_crash_is_an_alarm_with_its_line(text, tmp_path):
    result = run(text, tmp_path, "--json", before=SMALL_STACK)
    records = [json.loads(line) for line in result.stdout.splitlines()]
    assert result.returncode == 1
    assert [record["type"] for record in records] == ["log", "alarm", "end"]
    assert records[0]["text"] == "begins"
    assert (records[1]["code"], records[1]["line"]) == ("R151", 7)
    assert "SIGSEGV" in records[1]["text"]
    assert (records[2]["state"], records[2]["killed"]) == ("alarm", True)


def test_people_see_the_line_and_what_was_printed_before(tmp_path):
    result = run(CRASHES["pairs"], tmp_path, before=SMALL_STACK)
    assert result.returncode == 1
    assert "begins" in result.stdout
    assert f"ALARM R151 in line 7 of {tmp_path / 'p.script'}: " in result.stderr
    assert "7 |   y = list(x)" in result.stderr
    assert "hint: do not nest iterators" in result.stderr


def test_ordinary_depths_do_not_crash(tmp_path):
    text = nested("map(int, x)", "textmsg(list(x))").replace("60000", "150000")
    result = run(text, tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert "[1]" in result.stdout


OUT_OF_MEMORY = {
    "one list": ("x = [0] * 10**12", 2),
    "one text": ("x = 'x' * 10**12", 2),
    "bytes": ("x = bytes(10**12)", 2),
    "a doubled text": ("x = 'x'\n  while True:\n    x = x + x\n  end", 4),
    "a doubled list": ("x = [0]\n  while True:\n    x = x + x\n  end", 4),
    "a number": ("x = 1 << 10**11", 2),
}


@pytest.mark.parametrize(("body", "line"), OUT_OF_MEMORY.values(), ids=OUT_OF_MEMORY)
def test_too_little_memory_is_an_alarm_with_line_and_limit(body, line, tmp_path):
    result = run(f"def p():\n  {body}\nend\n", tmp_path, "--json", "--memory-limit", "512MiB")
    records = [json.loads(row) for row in result.stdout.splitlines()]
    alarm = next(record for record in records if record["type"] == "alarm")
    assert (alarm["code"], alarm["class"], alarm["line"]) == ("R150", "MemoryError", line)
    assert alarm["text"] == "there is not enough memory for what this line asks for: a run may have 512 MiB"
    assert (records[-1]["type"], records[-1]["state"], result.returncode) == ("end", "alarm", 1)


def program(*lines):
    return "def p():\n" + "".join(f"  {line}\n" for line in lines) + "end\n"


HARMLESS = {
    "recursion": (program("def f(n):", "  return f(n + 1)", "end", "f(0)"), "RecursionError"),
    "a list in lists that is shown": (nested("[x]", "y = str(x)"), "RecursionError"),
    "lists that are compared": (
        program("x = []", "y = []", "for i in range(60000):", "  x = [x]", "  y = [y]", "end", "z = x == y"),
        "RecursionError",
    ),
    "lists that are let go": (nested("[x]", "x = None"), ""),
    "tables that are let go": (nested("{1: x}", "x = None"), ""),
    "an expression": (program("x = eval('(' * 5000 + '1' + ')' * 5000)"), "Error"),
    "a large number that is shown": (program("x = str(10 ** 100000)"), "ValueError"),
    "a class that shows itself": (
        program("class A:", "  def __repr__(self):", "    return repr(self)", "  end", "end", "x = repr(A())"),
        "RecursionError",
    ),
    "generators": (
        program(
            "def g(x):", "  yield from x", "end", "x = [1]", "for i in range(20000):", "  x = g(x)", "end", "list(x)"
        ),
        "RecursionError",
    ),
    "sums of errors": (
        program("x = None", "for i in range(60000):", "  x = ValueError(x)", "end", "y = str(x)"),
        "Error",
    ),
    "threads in threads": (
        program("def f():", "  start_thread(f, ())", "  sleep(1)", "end", "start_thread(f, ())", "sleep(2)"),
        "Error",
    ),
}


@pytest.mark.parametrize(("text", "error"), HARMLESS.values(), ids=HARMLESS)
def test_what_python_bounds_itself_is_an_ordinary_end(text, error, tmp_path):
    result = run(text, tmp_path, "--json")
    records = [json.loads(row) for row in result.stdout.splitlines()]
    classes = [record["class"] for record in records if record["type"] == "alarm"]
    assert records[-1]["type"] == "end", result.stderr
    assert "killed" not in records[-1]
    assert bool(classes) == bool(error) and error in "".join(classes)


def started(text, tmp_path):
    path = tmp_path / "p.script"
    path.write_text(text)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "PYTHONUNBUFFERED": ""}
    command = [sys.executable, "-c", MAIN, "run", str(path), "--json", "--realtime"]
    return subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


ENDLESS = "def p():\n  textmsg('begins')\n  while True:\n    sleep(0.1)\n  end\nend\n"


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_signals_are_passed_on(tmp_path, number, code):
    process = started(ENDLESS, tmp_path)
    assert "begins" in process.stdout.readline()
    process.send_signal(number)
    out, _ = process.communicate(timeout=30)
    assert process.returncode == code
    if number == signal.SIGINT:
        assert json.loads(out.splitlines()[-1])["state"] == "stopped"


def test_a_run_ends_with_the_process_that_watches_over_it(tmp_path):
    process = started(ENDLESS, tmp_path)
    assert "begins" in process.stdout.readline()
    process.kill()
    # Both hold the pipe: it ends when both are gone.
    process.communicate(timeout=30)
    assert process.returncode == -signal.SIGKILL


@pytest.mark.parametrize(
    ("trace", "place"),
    [
        (
            b'  File "/x/a.py", line 1 in f\n  File "p.script", line 12 in p\n  File "q.script", line 3',
            ("p.script", 12),
        ),
        (b'  File "<frozen importlib>", line 1 in f\n  File "<script>", line 2 in p\n', ("<script>", 2)),
        (b'  File "/x/a.py", line 1 in f\n', None),
        (b'  File "/x/elitescript/cli/main.py", line 1 in f\n  File "/x/bin/elitescript", line 8 in <module>\n', None),
        (b"", None),
    ],
)
def test_the_place_is_the_innermost_line_of_a_program(trace, place):
    assert place_in_trace(trace) == place
