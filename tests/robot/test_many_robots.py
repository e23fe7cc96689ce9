"""Many robots in one process: what they share, what each takes, and that a dropped one can be freed."""

from __future__ import annotations

import gc
import sys
import tracemalloc
import weakref
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from elitescript import VirtualRobot
from elitescript.messages.events import Event
from elitescript.models import model

PROGRAM = """
def job():
  movej([0.3, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
  set_standard_digital_out(0, True)
  sleep(0.5)
  textmsg("the arm is at ", get_actual_tcp_pose())
end
"""
OWN_ARM = 'base = "CS66"\nname = "mine"\ndefault_tool_speed = 0.25\n'


@pytest.fixture
def read_files(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return the names of models and model files that are read from now on."""
    parsed: list[str] = []

    def noted(read: Callable[..., object]) -> Callable[..., object]:
        def call(file: str, *text: str) -> object:
            parsed.append(file)
            return read(file, *text)

        return call

    monkeypatch.setattr(model, "packaged", noted(model.packaged))
    monkeypatch.setattr(model, "parsed", noted(model.parsed))
    return parsed


def calls_of(make: Callable[[], object]) -> int:
    """Return how many functions of Python and of C are called."""
    count = 0

    def note(_frame: object, event: str, _argument: object) -> None:
        nonlocal count
        count += event in ("call", "c_call")

    sys.setprofile(note)
    try:
        make()
    finally:
        sys.setprofile(None)
    return count


@pytest.mark.parametrize("name", ["CS66", "cs66", "CS625"])
def test_the_second_robot_of_a_kind_reads_no_file(
    name: str, read_files: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    model._packaged_model.cache_clear()
    first = VirtualRobot(name)
    assert read_files == [name]
    read_files.clear()

    def refuse(*arguments: object, **_: object) -> None:
        raise AssertionError(f"opened {arguments[0]}")

    monkeypatch.setattr(Path, "open", refuse)
    assert VirtualRobot(name).model is first.model
    assert read_files == []


def test_the_text_of_an_own_arm_is_parsed_once(tmp_path: Path, read_files: list[str]) -> None:
    file = tmp_path / "arm_parsed_once.toml"
    file.write_text(OWN_ARM)
    assert VirtualRobot(file).model is VirtualRobot(str(file)).model
    assert read_files.count(file.name) == 1


def test_an_own_arm_that_has_changed_is_read_again(tmp_path: Path) -> None:
    file = tmp_path / "arm_changed.toml"
    file.write_text(OWN_ARM)
    before = VirtualRobot(file)
    file.write_text(OWN_ARM.replace("0.25", "0.35"))
    after = VirtualRobot(file)
    assert (before.model.default_tool_speed, after.model.default_tool_speed) == (0.25, 0.35)
    assert before.options.model_text == OWN_ARM
    file.unlink()
    with pytest.raises(Exception, match=r"cannot read .*arm_changed\.toml"):
        VirtualRobot(file)


def test_two_files_of_one_text_are_two_arms_in_error_texts(tmp_path: Path) -> None:
    for name in ("left.toml", "right.toml"):
        (tmp_path / name).write_text("base = 3\n")
        with pytest.raises(Exception, match=rf"^{name}: base"):
            VirtualRobot(tmp_path / name)


def test_a_robot_is_made_in_few_calls() -> None:
    VirtualRobot()
    assert calls_of(VirtualRobot) < 470


def test_what_one_robot_does_no_other_sees() -> None:
    first, second = VirtualRobot(), VirtualRobot()
    first.signals["input_bool_register[3]"] = True
    first.run(PROGRAM).check()
    assert first.controller.non_default_signals() == {"input_bool_register[3]": True, "standard_digital_out[0]": True}
    assert second.controller.non_default_signals() == {}
    assert VirtualRobot().controller.non_default_signals() == {}
    assert second.controller.signals.image == VirtualRobot().controller.signals.image


def test_a_level_that_is_back_at_its_default_is_none_of_the_non_defaults() -> None:
    robot = VirtualRobot()
    robot.signals["standard_digital_in[1]"] = True
    robot.signals["standard_digital_in[2]"] = True
    robot.signals["standard_digital_in[1]"] = False
    assert robot.controller.non_default_signals() == {"standard_digital_in[2]": True}


@pytest.mark.parametrize("has_run", [False, True])
def test_a_robot_takes_less_than_100_kb(has_run: bool) -> None:
    def made() -> VirtualRobot:
        robot = VirtualRobot()
        if has_run:
            robot.run(PROGRAM).check()
        return robot

    made()
    tracemalloc.start()
    try:
        robots = [made() for _ in range(20)]
        traced, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert traced / len(robots) < 100_000


@pytest.mark.usefixtures("without_collection")
def test_a_robot_has_few_objects_that_the_collector_goes_through() -> None:
    VirtualRobot()
    before = len(gc.get_objects())
    robots = [VirtualRobot() for _ in range(20)]
    assert (len(gc.get_objects()) - before) / len(robots) < 178


@pytest.fixture
def without_collection() -> Iterator[None]:
    gc.collect()
    gc.disable()
    yield
    gc.enable()


@pytest.mark.usefixtures("without_collection")
def test_a_dropped_robot_is_gone_at_once() -> None:
    made, has_run = VirtualRobot(), VirtualRobot()
    has_run.run(PROGRAM).check()
    kept = [weakref.ref(made), weakref.ref(has_run)]
    del made, has_run
    assert [reference() for reference in kept] == [None, None]


@pytest.mark.usefixtures("without_collection")
def test_machine_and_stacks_of_a_dropped_robot_are_collected_with_a_program_under_way() -> None:
    program = """
def job():
  def other():
    try:
      sleep(100)
    finally:
      set_standard_digital_out(1, True)
      sleep(1)
    end
  end
  thread = start_thread(other, ())
  sleep(50)
end
"""
    events: list[Event] = []
    robot = VirtualRobot(on_event=events.append)
    run = robot.start(program)
    robot.advance(0.5)
    stacks = [strand._greenlet for strand in robot._host._scheduler.strands]
    assert len(stacks) == 2
    kept = [weakref.ref(it) for it in (robot, *stacks)]
    seen = len(events)
    del robot, stacks
    assert run.time_s == 0.5
    assert kept[0]() is not None, "a run that is under way shows its robot as it is"
    del run
    gc.collect()
    assert [reference() for reference in kept] == [None] * 3
    assert len(events) == seen
