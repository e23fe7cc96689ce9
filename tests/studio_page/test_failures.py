"""What goes wrong around a page of `elitescript studio`; one studio and one page take all of it.

Each test begins and ends with a program that runs, so that the page has to come out of every failure.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from elitescript import VirtualRobot
from elitescript.controller.views.trace import TraceRow
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.profile import profile
from tests.studio.page_client import process
from tests.studio_page.conftest import Loan

GOOD = """\
global part
part = 1
movej([0.1, -1.2, 1.2, -1.5, -1.57, 0.2])
textmsg("part ", part)
sleep(0.5)
"""

HOSTILE = """\
global text
text = "<img src=x onerror=window.taken=1>"
textmsg(text)
textmsg("</script><script>window.taken=1</script>")
textmsg("\N{RIGHT-TO-LEFT OVERRIDE}abc\N{RIGHT-TO-LEFT ISOLATE}")
textmsg("a" + chr(0xd800) + "b" + chr(0))
textmsg("y" * 1000000)
popup(text, "<b>title</b>", False, False, False)
"""

LONG = "n = 0\nwhile True:\n  n = n + 1\n  sync()\nend\n"


class Shared(NamedTuple):
    """A page, its studio and its file."""

    page: Page
    server: subprocess.Popen[str]
    address: str
    file: Path
    wrong: list[str]

    def region(self, name: str) -> Locator:
        return self.page.get_by_role("region", name=name, exact=True)

    def press(self, name: str) -> None:
        self.page.get_by_role("button", name=name, exact=True).click()

    @property
    def slider(self) -> Locator:
        return self.page.get_by_role("slider", name="Time", exact=True)

    def write(self, text: str) -> None:
        """Put a text into the editor."""
        self.page.get_by_role("textbox", name="Program text").focus()
        self.page.keyboard.press("Control+a")
        self.page.keyboard.insert_text(text)

    def expect_state(self, state: str) -> None:
        expect(self.page.locator(".state")).to_contain_text(re.compile(state))

    def expect_takes_programs(self) -> None:
        self.write(GOOD)
        self.expect_state("finished")
        expect(self.region("Messages")).to_contain_text("part 1")

    def processes(self) -> tuple[int, list[int]]:
        """Return the process that starts runs of the page, and those that run something."""
        (keeper,) = _children(self.server.pid)
        return keeper, _children(keeper)


def _children(process: int) -> list[int]:
    found = subprocess.run(["ps", "-o", "pid=", "--ppid", str(process)], capture_output=True, text=True, check=False)
    return [int(line) for line in found.stdout.split()]


@pytest.fixture(scope="module")
def _opened(loan: Loan, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Shared]:
    folder = tmp_path_factory.mktemp("studio")
    file = folder / "a <b> job.script"
    file.write_text(GOOD)
    with process(file, state=folder / "state") as (server, address):
        with loan.of_browser() as browser:
            page = new_page(browser)
        wrong: list[str] = []
        page.on("pageerror", lambda error: wrong.append(str(error)))
        yield Shared(page, server, address, file, wrong)
        with loan.of_browser():
            page.context.close()


def new_page(browser: Browser) -> Page:
    page = browser.new_context(viewport={"width": 1100, "height": 600}, reduced_motion="reduce").new_page()
    page.set_default_timeout(15_000)
    return page


@pytest.fixture
def shared(_opened: Shared, browser: Browser) -> Iterator[Shared]:
    if _opened.page.url == "about:blank":
        _opened.page.goto(_opened.address)
        _opened.expect_state("finished")
    yield _opened
    _opened.expect_takes_programs()
    assert _opened.wrong == []


def test_programs_that_do_not_end(shared: Shared) -> None:
    shared.write("while True:\n  pass\nend\n")
    shared.expect_state(r"^\d+\.\d of")
    shared.press("Stop")
    shared.expect_state("stopped")
    shared.write("movej([0.2, -1.2, 1.2, -1.5, -1.57, 0.2])\nn = sum(range(10**12))\n")
    shared.expect_state("line 2 does not return")
    shared.slider.press("End")
    assert float(shared.slider.get_attribute("aria-valuenow") or 0) > 0.5
    shared.press("Stop")
    expect(shared.slider).to_have_attribute("aria-valuenow", "0")


def test_processes_that_are_killed(shared: Shared) -> None:
    notices = shared.page.locator(".notice")
    shared.write(LONG)
    shared.expect_state(r"^\d+\.\d of")
    # One may look for moments beside the run.
    keeper, workers = shared.processes()
    for worker in workers:
        os.kill(worker, signal.SIGKILL)
    shared.expect_state("SIGKILL")
    shared.expect_takes_programs()

    shared.slider.press("Home")
    shared.slider.press("ArrowRight")
    expect(shared.slider).to_have_attribute("aria-valuetext", "0.004 s, line 3")
    for looker in shared.processes()[1]:
        os.kill(looker, signal.SIGKILL)
    # One moment may be lost with it, the next one is found.
    for _ in range(2):
        shared.slider.press("ArrowRight")
    expect(shared.region("Robot")).to_have_attribute("data-time", "0.012")

    os.kill(keeper, signal.SIGKILL)
    shared.write(GOOD + "sleep(0.1)\n")
    shared.expect_state("finished")
    expect(notices.last).to_contain_text("was started again")
    shared.page.get_by_role("button", name="Dismiss").last.click()


def test_each_text_on_the_way_to_a_program(shared: Shared) -> None:
    line = "if part == 1: movej([0, -1.2, 1.2, -1.5, -1.57, 0]) end"
    expect_problems_while_typing(shared, GOOD, line[::4])


@pytest.mark.slow
def test_each_character_of_a_program(shared: Shared) -> None:
    expect_problems_while_typing(shared, "", HOSTILE)
    expect_problems_while_typing(shared, GOOD, "while part < 3:\n  part = part + 1\n  sleep(0.1)\nend\n")


def expect_problems_while_typing(shared: Shared, before: str, typed: str) -> None:
    """Expect the findings of `check` after each character, also those that are half-typed."""
    problems = shared.region("Problems")
    for count in range(1, len(typed) + 1):
        text = before + typed[:count]
        shared.write(text)
        found = check_source(SourceFile(shared.file.name, text), profile())
        if not found:
            expect(problems).to_contain_text("No problems.")
        for problem in found[:1]:
            # Of a name that is not defined, the alarm of the run is the row, with the advice of `check`.
            kinds = f"({problem.severity} {problem.code}|alarm R100)"
            expect(problems).to_contain_text(re.compile(f"line {problem.line}, column {problem.column}: {kinds}"))
    assert shared.file.read_text() == GOOD


def test_hostile_texts(shared: Shared) -> None:
    messages = shared.region("Messages")
    shared.write(HOSTILE)
    shared.expect_state("finished")
    expect(messages).to_contain_text("<img src=x onerror=window.taken=1>")
    expect(messages).to_contain_text("</script><script>window.taken=1</script>")
    expect(messages).to_contain_text("<b>title</b>")
    shared.slider.press("End")
    expect(shared.region("Variables")).to_contain_text("<img src=x onerror=window.taken=1>")
    assert len(messages.inner_text()) < 20_000
    assert shared.page.locator("img:not(.cm-widgetBuffer)").count() == 0
    assert shared.page.evaluate("window.taken === undefined && document.documentElement.scrollWidth <= innerWidth")
    shared.write("<img src=x onerror=window.taken=1>\n\N{RIGHT-TO-LEFT OVERRIDE}\n")
    expect(shared.region("Problems")).to_contain_text("U+202E")
    assert shared.page.evaluate("window.taken === undefined")


@pytest.mark.skipif(sys.platform != "linux", reason="limits of another process are set on Linux alone")
def test_a_disk_that_is_full_and_what_writes(shared: Shared) -> None:
    import resource

    shared.write(GOOD + "sleep(0.25)\n")
    for name in ("Run", "Pause", "Step", "Step back", "Stop"):
        shared.press(name)
    shared.expect_state("finished")
    assert shared.file.read_text() == GOOD
    limits = resource.prlimit(shared.server.pid, resource.RLIMIT_FSIZE)
    resource.prlimit(shared.server.pid, resource.RLIMIT_FSIZE, (10, limits[1]))
    try:
        shared.press("Save")
        notice = shared.page.locator(".notice", has_text="Not saved")
        expect(notice).to_contain_text("File too large")
    finally:
        resource.prlimit(shared.server.pid, resource.RLIMIT_FSIZE, limits)
    assert [path.name for path in shared.file.parent.iterdir() if path.is_file()] == [shared.file.name]
    assert shared.file.read_text() == GOOD
    assert shared.page.title().startswith("●")
    shared.press("Save")
    expect(shared.page).to_have_title(re.compile("^a <b> job"))
    assert shared.file.read_text() == GOOD + "sleep(0.25)\n"
    shared.write(GOOD)
    shared.press("Save")
    expect(shared.page).to_have_title(re.compile("^a <b> job"))
    while (button := shared.page.get_by_role("button", name="Dismiss")).count():
        button.first.click()


def test_a_studio_that_stands_still(shared: Shared) -> None:
    os.kill(shared.server.pid, signal.SIGSTOP)
    try:
        shared.write(GOOD + "sleep(1)\n")
        shared.slider.press("ArrowRight")
        shared.expect_state("before line 6")
    finally:
        os.kill(shared.server.pid, signal.SIGCONT)
    shared.expect_state("finished")


def test_two_pages_on_one_file(shared: Shared, browser: Browser) -> None:
    other = shared._replace(page=new_page(browser))
    try:
        other.page.goto(shared.address)
        other.expect_state("finished")
        shared.write("# here\n" + GOOD)
        other.write("# there\n" + GOOD)
        other.press("Save")
        conflict = shared.page.get_by_role("complementary", name="Two texts of one file")
        expect(conflict).to_contain_text("# there")
        assert shared.file.read_text() == "# there\n" + GOOD
        conflict.get_by_role("button", name="Keep the text here").click()
        shared.write(GOOD)
        shared.press("Save")
        # It has changed nothing, so it follows the file.
        expect(other.page.get_by_role("textbox", name="Program text")).not_to_contain_text("# there")
        assert shared.file.read_text() == GOOD
    finally:
        other.page.context.close()


def test_what_is_shown_is_the_trace(shared: Shared) -> None:
    text = (
        "def f():\n  sleep(0.1)\nend\nstart_thread(f, ())\nservoj([0.1, -1.2, 1.2, -1.5, -1.57, 0.2], t=0.4)\n" + GOOD
    )
    shared.write(text)
    shared.expect_state("finished")
    trace = VirtualRobot().run(text, trace=True).trace
    assert trace is not None
    field = shared.page.get_by_role("textbox", name="Time in seconds")
    for key, t in (("0.3", None), ("1.237", None), ("", "PageUp"), ("", "ArrowLeft"), ("", "Home")):
        if t is None:
            field.fill(f"{key} s")
            field.press("Enter")
        else:
            shared.slider.press(t)
        expect_trace(shared, trace)
    # What is dragged comes to rest at a moment of the run too.
    box = shared.slider.bounding_box()
    assert box is not None
    shared.page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + box["height"] / 2)
    shared.page.mouse.down()
    shared.page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + box["height"] / 2, steps=5)
    shared.page.mouse.up()
    expect_trace(shared, trace)


def expect_trace(shared: Shared, trace: Sequence[TraceRow]) -> None:
    """Expect the joints of the trace at the time of the slider."""
    now = float(shared.slider.get_attribute("aria-valuenow") or -1)
    wanted = next(row.q for row in trace if abs(row.t - now) < 1e-9)
    shared.page.wait_for_function(
        """([t, joints]) => {
            const { time, joints: shown } = document.querySelector("[data-joints]").dataset;
            return Math.abs(time - t) < 1e-9 && shown.split(",").every((q, i) => Math.abs(q - joints[i]) < 1e-6);
        }""",
        arg=[now, list(wanted)],
    )


def test_undo_takes_back_a_fix_and_a_format(shared: Shared) -> None:
    text = "movej([0.1, -1.2, 1.2, -1.5, -1.57, 0.2])\nif True\n  sleep(  1)\nend\n"
    shared.write(text)
    shared.region("Problems").get_by_role("button", name="Fix", exact=True).click()
    editor = shared.page.get_by_role("textbox", name="Program text")
    expect(editor).to_contain_text("if True:")
    shared.page.keyboard.press("Control+z")
    expect(editor).not_to_contain_text("if True:")
    shared.page.keyboard.press("Control+y")
    shared.page.keyboard.press("Shift+Alt+f")
    expect(editor).to_contain_text("sleep(1)")
    shared.page.keyboard.press("Control+z")
    expect(editor).to_contain_text("sleep(  1)")
