import sys

import pytest

from elitescript.devices.memory import MemoryEnvironment
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
    assert logged(body, world=MemoryEnvironment({"points.csv": b"1,2\n"})) == [
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


def test_paths_are_those_of_the_robot():
    body = """
path = os.path
textmsg(path.realpath("a/../b"), path.realpath("/task/x/."), path.realpath("../c", strict=False))
textmsg(path.relpath("/task/a/b"), path.relpath("/task/a", "/task/b"), path.relpath("x", start="y/z"))
textmsg(path.expanduser("~/x"), path.expanduser("~root/x"), path.expanduser("x"))
textmsg(path.splitdrive("C:/x"), path.splitdrive("/x"), path.normcase("/A/b"))
textmsg(path.pardir, path.curdir, path.extsep, os.pardir, os.curdir)
"""
    assert logged(body) == [
        "/task/b/task/x/c",
        "a/b../a../../x",
        "~/x~root/xx",
        "('', 'C:/x')('', '/x')/A/b",
        ".......",
    ]


@pytest.mark.parametrize(
    ("path", "error"),
    [("points.csv", "NotImplementedError"), ("none", "FileNotFoundError"), ("/etc", "PermissionError")],
)
def test_nobody_knows_when_a_file_was_changed(path, error):
    body = f"import os\ntry:\n  os.path.getmtime({path!r})\nexcept {error} as e:\n  textmsg(e)\n"
    bench = run(body, world=MemoryEnvironment({"points.csv": b""}))
    assert bench.alarms == [] and path in bench.log[0]


def test_signals_have_their_numbers():
    import signal

    letters = ("HUP", "INT", "ABRT", "KILL", "USR1", "USR2", "PIPE", "ALRM", "TERM", "CHLD", "CONT", "STOP")
    names = [f"SIG{each}" for each in letters]
    numbers = (1, 2, 6, 9, 10, 12, 13, 14, 15, 17, 18, 19)
    assert logged(f"textmsg([getattr(signal, name) for name in {names}])") == [str(list(numbers))]
    if sys.platform == "linux":
        assert tuple(getattr(signal, name) for name in names) == numbers


@pytest.mark.parametrize("name", ["SIGKILL", "SIGSTOP"])
def test_some_signals_cannot_be_handled(name):
    assert run(f"import signal\nsignal.signal(signal.{name}, 1)\n").alarms[0].class_name == "OSError"
