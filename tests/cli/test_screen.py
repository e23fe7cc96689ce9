"""Colours and the status line: on terminals alone, and gone when something is printed."""

import io
import os
import re
import sys
from select import select

import pytest

from elitescript.cli.main import main
from elitescript.cli.output import screen
from elitescript.cli.output.screen import (
    CALLS,
    ERASE,
    Palette,
    Progress,
    ScreenStream,
    StatusLine,
    is_colored,
    on_screen,
    palette_of,
    progress_on,
    rendered,
    understands_escapes,
)
from elitescript.language.diagnostics import Severity, diagnostic
from elitescript.language.text.source import SourceFile
from elitescript.shown import OWN_COLORS

XTERM = {"TERM": "xterm"}
SPEED = "\N{MULTIPLICATION SIGN} real time"


class Terminal(io.StringIO):
    """A stream that says it is a terminal, of 80 columns."""

    def isatty(self):
        return True


@pytest.fixture
def clock(monkeypatch):
    """Wall time of the status line, to be set by the test."""
    now = [100.0]
    monkeypatch.setattr(screen.time, "monotonic", lambda: now[0])
    return now


# ---------------------------------------------------------------- what a terminal can do


@pytest.mark.parametrize(
    ("environment", "system", "expected"),
    [
        ({"TERM": "xterm-256color"}, "posix", True),
        ({"TERM": "dumb"}, "posix", False),
        ({}, "posix", False),
        ({}, "nt", False),
        ({"WT_SESSION": "1"}, "nt", True),
        ({"ConEmuANSI": "ON"}, "nt", True),
        ({"ConEmuANSI": "OFF"}, "nt", False),
        ({"TERM": "dumb", "WT_SESSION": "1"}, "nt", False),
    ],
)
def test_escape_codes_go_where_they_are_understood(environment, system, expected):
    assert understands_escapes(environment, system) is expected


@pytest.mark.parametrize(
    ("color", "stream", "environment", "expected"),
    [
        ("auto", Terminal(), XTERM, True),
        ("auto", io.StringIO(), XTERM, False),
        ("auto", Terminal(), {"TERM": "dumb"}, False),
        ("auto", Terminal(), {**XTERM, "NO_COLOR": "1"}, False),
        ("auto", Terminal(), {**XTERM, "NO_COLOR": ""}, True),
        ("never", Terminal(), XTERM, False),
        ("always", io.StringIO(), {"NO_COLOR": "1", "TERM": "dumb"}, True),
    ],
)
def test_when_there_are_colours(color, stream, environment, expected):
    assert is_colored(color, stream, environment, "posix") is expected


# ---------------------------------------------------------------- colours


def test_a_finding_has_its_severity_caret_and_hint_in_colours():
    source = SourceFile("a.script", "slep(1)\n")
    problem = diagnostic("E301", 1, 1, "no `slep` ^^^", end_column=5, severity=Severity.ERROR, hint="is `sleep` meant?")
    rows = rendered(problem, source, Palette(True)).split("\n")
    assert rows == [
        "\x1b[1ma.script:1:1: \x1b[0m\x1b[1;31merror E301\x1b[0m: no `slep` ^^^",
        "    slep(1)",
        "\x1b[1;31m    ^^^^\x1b[0m",
        "\x1b[36mhint: is `sleep` meant?\x1b[0m",
    ]
    plain = rendered(problem, source, Palette(False))
    assert plain == re.sub(r"\x1b\[[\d;]*m", "", "\n".join(rows))


def test_a_stream_that_is_not_wrapped_has_no_colours():
    assert not palette_of(sys.stderr).is_colored
    assert progress_on(sys.stderr) is None


# ---------------------------------------------------------------- the status line


def test_what_is_printed_takes_the_place_of_the_status_line():
    err = Terminal()
    status = StatusLine(err, Palette(False))
    stream = ScreenStream(err, Palette(False), status)
    status.show("line 3")
    status.show("line 4")
    print("hello", file=stream)
    print("again", file=stream)
    status.show("line 5")
    status.erase()
    status.erase()
    assert err.getvalue() == f"{ERASE}line 3{ERASE}line 4{ERASE}hello\nagain\n{ERASE}line 5{ERASE}"


def test_the_status_line_does_not_overwrite_half_a_line():
    err = Terminal()
    status = StatusLine(err, Palette(False))
    stream = ScreenStream(err, Palette(False), status)
    stream.write("half ")
    status.show("line 3")
    stream.write("a line\n")
    assert err.getvalue() == "half a line\n"


def test_the_status_line_fits_its_terminal_and_hides_control_characters():
    err = Terminal()
    StatusLine(err, Palette(False)).show("a\x1b[2Jb\n" + "x" * 200)
    (shown,) = err.getvalue().split(ERASE)[1:]
    assert shown.startswith("a?[2Jb?xxx")
    assert len(shown) == 79


def test_progress_shows_time_line_and_speed_ten_times_a_second_at_most(clock):
    err = Terminal()
    progress = Progress(StatusLine(err, Palette(False)))
    for tick in range(10_000):
        clock[0] = 100.0 + 0.0002 * tick
        progress.update(0.004 * tick, 7)
    shown = err.getvalue().split(ERASE)[1:]
    # Two seconds: nothing in the first, ten lines in the second.
    assert 9 <= len(shown) <= 10
    assert re.fullmatch(r" +20\.\d{3} s  line 7  20 . real time  \(Ctrl-C ends it\)", shown[0])


def test_the_clock_is_not_read_at_every_tick(monkeypatch):
    reads = []
    monkeypatch.setattr(screen.time, "monotonic", lambda: reads.append(1) or 5.0)
    progress = Progress(StatusLine(Terminal(), Palette(False)))
    for tick in range(100 * CALLS):
        progress.update(0.004 * tick, 1)
    assert len(reads) == 1 + 100


def test_a_run_slower_than_real_time_shows_its_speed(clock):
    err = Terminal()
    progress = Progress(StatusLine(err, Palette(False)), start_s=10.0)
    clock[0] += 2.0
    for _ in range(CALLS):
        progress.update(10.5, 0)
    assert "    10.500 s  no program line  0.25 " + SPEED in err.getvalue()


def test_streams_are_given_back_and_the_line_is_gone(monkeypatch):
    out, err = Terminal(), Terminal()
    monkeypatch.setattr(sys, "stdout", out)
    monkeypatch.setattr(sys, "stderr", err)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    with pytest.raises(KeyError), on_screen("auto"):
        assert palette_of(sys.stdout).is_colored
        sys.stderr.status.show("busy")
        raise KeyError
    assert (sys.stdout, sys.stderr) == (out, err)
    assert err.getvalue().endswith(f"busy\x1b[0m{ERASE}")


@pytest.mark.parametrize(
    ("name", "value", "has_status", "has_color"),
    [("TERM", "xterm", True, True), ("TERM", "dumb", False, False), ("NO_COLOR", "1", True, False)],
)
def test_what_the_environment_allows(monkeypatch, name, value, has_status, has_color):
    monkeypatch.setattr(sys, "stdout", Terminal())
    monkeypatch.setattr(sys, "stderr", Terminal())
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv(name, value)
    with on_screen("auto"):
        assert (progress_on(sys.stderr) is not None) is has_status
        assert palette_of(sys.stderr).is_colored is has_color


# ---------------------------------------------------------------- commands on a pseudo-terminal

PROGRAM = """def job():
  for n in range(60):
    if n % 20 == 0:
      textmsg(n)
    end
    sleep(0.01)
  end
  slep(1)
end
"""


@pytest.fixture
def on_terminal(tmp_path, monkeypatch):
    """A function that runs a command of ours on a pseudo-terminal; it returns the exit code and what was shown."""
    far, near = os.openpty()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setattr(screen, "FIRST_AFTER_S", 0.0)
    monkeypatch.setattr(screen, "INTERVAL_S", 0.0)
    for name in ("job.script", "other.script"):
        (tmp_path / name).write_text(PROGRAM)

    def run(*arguments, piped=()):
        with open(near, "w", encoding="utf-8", closefd=False) as terminal:
            for name in {"stdout", "stderr"}.difference(piped):
                monkeypatch.setattr(sys, name, terminal)
            code = main(list(arguments))
        data = b""
        while select([far], [], [], 0)[0]:
            data += os.read(far, 65536)
        return code, data.decode().replace("\r\n", "\n")

    yield run
    os.close(far)
    os.close(near)


def visible(text):
    """What is left on the lines of a terminal, without colours."""
    lines = [line.rsplit("\x1b[2K", 1)[-1].strip("\r") for line in text.split("\n")]
    return [re.sub(r"\x1b\[[\d;]*m", "", line) for line in lines]


def test_run_shows_where_it_is_and_leaves_only_what_was_printed(on_terminal):
    code, text = on_terminal("run", "job.script")
    assert code == 1
    assert SPEED in text
    shown = visible(text)
    assert not any("real time" in line for line in shown)
    assert [line for line in shown if re.fullmatch(r" +\d\.\d{3} s  \d+", line)] == [
        "     0.000 s  0",
        "     0.240 s  20",
        "     0.480 s  40",
    ]
    assert "\x1b[1;31mALARM R100\x1b[0m" in text
    assert shown[-1] == ""


def test_plot_has_a_status_line(on_terminal):
    code, text = on_terminal("plot", "job.script")
    assert code == 1
    assert SPEED in text
    assert not any("real time" in line for line in visible(text))


def test_check_of_many_files_says_which_one(on_terminal):
    code, text = on_terminal("check", "job.script", "other.script")
    assert code == 3
    assert "1 files checked; other.script" in text
    assert "2 files checked: 2 errors" in "\n".join(visible(text))


def test_json_gets_neither_colours_nor_a_status_line(on_terminal):
    _, text = on_terminal("run", "job.script", "--json")
    assert "\x1b" not in text


def test_a_pipe_gets_what_it_always_got(on_terminal, capsys):
    _, text = on_terminal("run", "job.script", piped=["stdout"])
    assert SPEED in text
    out = capsys.readouterr().out
    assert "\x1b" not in out
    assert "0.240 s  20" in out


def test_no_colours_if_they_are_not_wanted(on_terminal):
    _, text = on_terminal("run", "job.script", "--color", "never")
    assert "ALARM R100 in line 8" in "\n".join(visible(text))
    assert not re.search(r"\x1b\[[\d;]*m", text)


def test_colours_for_a_pipe_if_they_are_wanted(tmp_path, capsys):
    path = tmp_path / "job.script"
    path.write_text("sleep(0.1)\n")
    assert main(["run", str(path), "--color", "always"]) == 0
    assert "\x1b[32mfinished\x1b[0m" in capsys.readouterr().out


HOSTILE = "textmsg('a\\x1b]0;title\\x07\\x1b[2Jb\\rALARM')\nprint('x\\n::error::y')\n"


def test_texts_of_programs_do_not_drive_a_terminal(on_terminal, tmp_path):
    (tmp_path / "hostile.script").write_text(HOSTILE)
    code, text = on_terminal("run", "hostile.script")
    assert code == 0
    assert r"a\x1b]0;title\x07\x1b[2Jb\rALARM" in text
    assert "\x1b]0" not in text
    assert "\x1b[2J" not in text


def test_errors_do_not_drive_a_terminal(on_terminal, tmp_path):
    (tmp_path / "w.toml").write_text('["\\u001b[2J"]\n')
    code, text = on_terminal("run", "job.script", "--world", "w.toml")
    assert code == 2
    assert r"[\x1b[2J] is not known" in text


@pytest.mark.parametrize("is_github", [False, True])
def test_texts_of_programs_are_no_commands_of_runners(tmp_path, capsys, monkeypatch, is_github):
    monkeypatch.setenv("GITHUB_ACTIONS", "true" if is_github else "")
    (tmp_path / "hostile.script").write_text(HOSTILE)
    assert main(["run", str(tmp_path / "hostile.script")]) == 0
    out = capsys.readouterr().out
    assert r"a\x1b]0;title\x07\x1b[2Jb\rALARM" in out
    assert "x\n| :\\x3aerror::y" in out
    (tmp_path / "wrong.script").write_text("slep(1)\n")
    assert main(["check", "--format", "github", str(tmp_path / "wrong.script")]) == 3
    assert capsys.readouterr().out.startswith("::error ")


def test_the_colours_of_terminals_are_those_that_pass():
    assert {*screen._CODES.values(), "0"} == set(OWN_COLORS)
