from elitescript.worlds.memory import MemoryWorld
from tests.runtime.machine import run


def logged(body, **options):
    lines = "".join(f"  {line}\n" for line in body.strip("\n").split("\n"))
    bench = run(f"import os, signal, subprocess\ndef job():\n{lines}job()\n", **options)
    assert bench.alarms == []
    return bench.log


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
