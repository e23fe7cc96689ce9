import pytest

from elitescript.runtime.stdlib.processes import PROCESSES_MAX, ProcessTable
from elitescript.worlds.memory import MemoryWorld
from tests.runtime.machine import run


def logged(body, **options):
    lines = "".join(f"  {line}\n" for line in body.strip("\n").split("\n"))
    bench = run(f"import os, signal, subprocess\ndef job():\n{lines}job()\n", **options)
    assert bench.alarms == []
    return bench.log


def test_stale_processes_are_looked_for_and_ended_as_real_programs_do():
    body = """
def kill_existing(device):
  result = subprocess.run(["ps"], stdout=subprocess.PIPE, text=True, check=True)
  for line in result.stdout.splitlines():
    if "socat" in line and device in line:
      os.kill(int(line.split(None, 1)[0]), signal.SIGTERM)
      textmsg("killed one")
kill_existing("ttymxc0")
proc = subprocess.Popen(["socat", "tcp-l:54321,fork", "/dev/ttymxc0,raw,b115200"])
textmsg(proc.poll(), proc.pid > 0)
kill_existing("ttymxc0")
textmsg(proc.poll(), proc.wait(), proc.returncode)
kill_existing("ttymxc0")
"""
    assert logged(body) == ["NoneTrue", "killed one", "-15-15-15"]


def test_a_process_ends_when_it_is_told():
    body = """
for end in ("terminate", "kill", "send_signal"):
  p = subprocess.Popen("/usr/bin/socat a b")
  getattr(p, end)(*([2] if end == "send_signal" else []))
  textmsg(p.poll(), p.communicate())
  p.terminate()
"""
    assert logged(body) == ["-15('', '')", "-9('', '')", "-2('', '')"]


@pytest.mark.parametrize(
    "call",
    [
        'subprocess.run(["rm", "-rf", "/"])',
        'subprocess.Popen("bash -c true")',
        'subprocess.check_output("ls")',
        'subprocess.call(["ps", "; rm x"])',
        'subprocess.run("ps | grep x", shell=True)',
        'subprocess.Popen(["ps"])',
        'subprocess.Popen(["socat", "x"]).wait()',
    ],
)
def test_any_other_command_is_refused(call):
    (alarm,) = run(f"import subprocess\n{call}\n").alarms
    assert (alarm.class_name, alarm.line) == ("PermissionError", 2)
    assert alarm.details["hint"]


@pytest.mark.parametrize("args", ["[]", "''", "[1]", "[b'ps']"])
def test_a_command_is_a_text_or_texts(args):
    assert run(f"import subprocess\nsubprocess.run({args})\n").alarms[0].class_name == "TypeError"


def test_output_is_bytes_unless_text_is_asked_for():
    body = """
textmsg(type(subprocess.run(["ps"], capture_output=True).stdout).__name__)
textmsg(type(subprocess.check_output(["ps"], universal_newlines=True)).__name__)
textmsg(subprocess.run(["ps"]).stdout, subprocess.call(["pgrep", "socat"]))
subprocess.Popen(["socat", "dev"])
textmsg(subprocess.check_output(["pgrep", "-f", "socat"], text=True).strip().isdigit())
"""
    assert logged(body) == ["bytes", "str", "None0", "True"]


def test_the_table_is_bounded():
    table = ProcessTable()
    for _ in range(PROCESSES_MAX):
        table.start(["socat"])
    with pytest.raises(OSError, match="processes"):
        table.start(["socat"])


def test_a_process_that_is_not_there_cannot_be_killed():
    assert run("import os\nos.kill(1, 9)\n").alarms[0].class_name == "ProcessLookupError"
    assert logged("p = subprocess.Popen(['socat'])\nos.kill(p.pid, 0)\ntextmsg(p.poll())") == ["None"]


def test_os_knows_names_and_the_task_folder():
    body = """
textmsg(os.path.join("a", "b.txt"), os.path.splitext("x.csv"), os.path.basename("/task/y"), os.sep)
textmsg(os.getpid(), os.environ, os.getenv("HOME"), os.getenv("X", 3), os.getcwd())
textmsg(os.listdir(), os.path.exists("points.csv"), os.path.isdir("/task"), os.path.exists("/etc/passwd"))
textmsg(os.path.getsize("points.csv"), os.path.isfile(get_task_path() + "points.csv"))
os.makedirs("a/b", exist_ok=True)
os.makedirs("a/b", exist_ok=True)
os.mkdir("a/c")
open("a/b/x", "w").close()
os.remove("points.csv")
textmsg(os.listdir("a"), os.path.exists("points.csv"), os.path.abspath("a/../x"))
from os.path import dirname
textmsg(dirname("/task/a/b"))
"""
    assert logged(body, world=MemoryWorld({"points.csv": b"1,2\n"})) == [
        "a/b.txt('x', '.csv')y/",
        "1000{}None3/task",
        "['points.csv']TrueTrueFalse",
        "4True",
        "['b', 'c']False/task/x",
        "/task/a",
    ]


def test_signal_handlers_are_kept_and_never_called():
    body = """
def handler(number, frame):
  textmsg("never")
textmsg(signal.signal(signal.SIGTERM, handler))
textmsg(signal.getsignal(signal.SIGTERM) is handler, signal.SIGINT, signal.getsignal(2))
try:
  signal.signal(99, handler)
except ValueError:
  textmsg("no such signal")
"""
    assert logged(body) == ["0", "True20", "no such signal"]
