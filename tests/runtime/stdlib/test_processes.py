import pytest

from elitescript.runtime.stdlib.subprocess_module import PROCESSES_MAX, ProcessTable
from tests.runtime.machine import Bench, run


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
    assert logged(body) == ["-15(None, None)", "-9(None, None)", "-2(None, None)"]


@pytest.mark.parametrize(
    "call",
    [
        'subprocess.run(["rm", "-rf", "/"])',
        'subprocess.Popen("bash -c true")',
        'subprocess.check_output("ls")',
        'subprocess.call(["ps", "; rm x"])',
        'subprocess.run("ps | grep x", shell=True)',
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


@pytest.mark.parametrize(
    ("call", "seconds"),
    [("wait(timeout=0.5)", 0.5), ("communicate(timeout=0.5)", 0.5), ("wait(0)", 0), ("wait(-1)", 0)],
)
def test_a_wait_with_a_time_out_is_over_after_it(call, seconds):
    body = f"""
import time
p = subprocess.Popen(["socat", "a", "b"])
began = time.time()
try:
  p.{call}
except subprocess.TimeoutExpired as e:
  textmsg(round(time.time() - began, 6), " ", e.cmd, " ", str(e).startswith("Command ['socat', 'a', 'b'] timed out"))
textmsg(p.poll())
"""
    assert logged(body)[0].startswith(f"{float(seconds)} ['socat', 'a', 'b'] True")


def test_a_wait_is_over_when_another_thread_ends_the_process():
    body = """
import time
p = subprocess.Popen(["socat", "a", "b"])
def end():
  time.sleep(0.2)
  p.terminate()
start_thread(end, ())
textmsg(p.wait(timeout=5), " ", time.monotonic())
"""
    assert logged(body) == ["-15 0.2"]


def test_a_wait_that_is_stopped_leaves_nothing_behind():
    body = """
p = subprocess.Popen(["socat", "a", "b"])
def wait():
  p.wait(timeout=5)
h = start_thread(wait, ())
sleep(0.1)
stop_thread(h)
sleep(0.1)
p.kill()
textmsg(p.wait(timeout=5))
"""
    assert logged(body) == ["-9"]


def test_a_time_out_is_a_number():
    (alarm,) = run("import subprocess\nsubprocess.Popen(['socat']).wait(timeout='1')\n").alarms
    assert alarm.class_name == "TypeError"


def test_a_secondary_program_does_not_wait():
    bench = Bench().start("sleep(1)\n")
    bench.run(until=1)
    bench.secondary("sec s():\n  import subprocess\n  subprocess.Popen(['socat']).wait(timeout=1)\nend\n").run()
    assert ["Popen.wait waits" in text for text in bench.warnings] == [True]


def test_a_listing_can_be_started_too():
    body = """
p = subprocess.Popen(["ps", "aux"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
textmsg(p.communicate(timeout=1), p.returncode, p.wait(), p.poll())
subprocess.Popen(["socat", "dev"])
p = subprocess.Popen("pgrep socat", stdout=subprocess.PIPE, text=True)
for line in p.stdout:
  textmsg(line.strip().isdigit(), p.pid > 1000)
with subprocess.Popen(["ps"], stdout=subprocess.PIPE, universal_newlines=True) as p:
  textmsg("socat dev" in p.stdout.read(), p.stderr)
textmsg(p.stdout.closed, subprocess.Popen(["ps"]).communicate())
"""
    assert logged(body) == [
        "(b'  PID USER     TIME  COMMAND\\n', b'')000",
        "TrueTrue",
        "TrueNone",
        "True(None, None)",
    ]


def test_some_signals_end_nothing():
    body = """
p = subprocess.Popen(["socat"])
for number in (0, 17, 18, 19):
  os.kill(p.pid, number)
  p.send_signal(number)
textmsg(p.poll())
"""
    assert logged(body) == ["None"]
