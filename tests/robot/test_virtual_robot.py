"""The Python API as its users know it."""

import signal
from pathlib import Path

import pytest

from elitescript import AlarmError, ProgramError, UsageError, VirtualRobot
from elitescript.controller.safety.limits import SafetyBounds, SafetyLimits
from elitescript.messages.enums import TaskState
from elitescript.messages.events import MotionEnded, SignalChanged, TaskStateChanged, Warned
from elitescript.messages.plant import PlantConfig
from elitescript.testing.world import World

HOME = (0.0, -1.5707963267948966, -1.5707963267948966, -1.5707963267948966, 1.5707963267948966, 0.0)


@pytest.fixture
def robot():
    return VirtualRobot("CS66")


def test_a_program_runs_to_its_end(robot):
    run = robot.run('def a():\n  global n\n  n = 3\n  sleep(1.5)\n  textmsg("n=", n)\n  print("done")\nend\n')
    assert (run.state, run.time_s, run.globals) == ("finished", 1.5, {"n": 3})
    assert (run.log, run.printed, run.alarms) == (["n=3"], ["done"], [])
    assert run.check() is run


def test_a_run_begins_where_the_last_one_ended(robot):
    robot.run("def a():\n  movej([0.2, -1.5, -1.5, -1.5, 1.5, 0])\n  set_flag(3, True)\nend\n")
    end_tick = robot.tick
    run = robot.run("def b():\n  textmsg(get_flag(3))\n  sleep(0.1)\nend\n")
    assert run.log == ["True"]
    assert run.time_s == 0.1
    assert robot.tick == end_tick + 25
    assert run.joints == (0.2, -1.5, -1.5, -1.5, 1.5, 0.0)


def test_an_alarm_says_what_where_and_with_which_limit(robot):
    run = robot.run("def a():\n  sleep(0.5)\n  movej([0, 0, 0, 0, 0, 7])\nend\n")
    (alarm,) = run.alarms
    assert run.state == "alarm"
    assert (alarm.line, alarm.thread, alarm.code, alarm.tick) == (3, "main", "R110", 125)
    assert "wrist3" in alarm.text
    assert "7" in alarm.text
    assert alarm.source_line.strip() == "movej([0, 0, 0, 0, 0, 7])"
    with pytest.raises(AlarmError, match="<program>:3:3: RuntimeError: "):
        run.check()


def test_a_text_that_does_not_compile_is_refused_with_all_problems(robot):
    with pytest.raises(ProgramError) as caught:
        robot.run("def a():\n  x = (1\n  y = = 2\nend\n")
    assert len(caught.value.problems) >= 2
    assert robot.state.task_state is TaskState.STOPPED


def test_halt_is_a_stop_and_not_an_alarm(robot):
    run = robot.run("def a():\n  halt()\nend\n")
    assert (run.state, run.alarms) == ("stopped", [])


def test_a_time_limit_stops_the_program_where_it_is(robot):
    run = robot.run("def a():\n  global n\n  n = 0\n  while True:\n    n += 1\n    sleep(1)\n  end\nend\n", until_s=10)
    assert (run.state, run.time_s, run.globals["n"]) == ("time_limit", 10.0, 11)
    assert robot.state.task_state is TaskState.STOPPED


@pytest.mark.parametrize(
    "body", ["while True:\n    pass", "[0 for x in iter(int, 1)]", "f = lambda: f()\n  while True: f"]
)
def test_an_endless_loop_stops_neither_time_nor_its_limit(robot, body):
    assert robot.run(f"def a():\n  {body}\n", until_s=0.2).state == "time_limit"


@pytest.mark.parametrize(
    ("program", "options"),
    [
        ("track_conveyor_linear([1, 0, 0, 0, 0, 0], 1000)\npause()\n", {}),
        ("force_mode([0] * 6, [0, 0, 1, 0, 0, 0], [0] * 6, 0, [0.1] * 6)\npause()\n", {}),
        ("speedl([0, 0, 0.05, 0, 0, 0], 1)\npause()\n", {"plant": PlantConfig(lag_s=0.05)}),
        ("movej([0.5, -1.57, -1.57, -1.57, 1.57, 0])\n", {"speed": 0.0, "plant": PlantConfig(lag_s=0.05)}),
        (
            "movej([0.5, -1.57, -1.57, -1.57, 1.57, 0])\n",
            {"speed": 0.0, "safety": SafetyLimits(SafetyBounds(tcp_speed_max=1.0))},
        ),
    ],
)
def test_an_arm_that_stands_while_every_tick_is_due_does_not_hide_that_nothing_goes_on(program, options):
    run = VirtualRobot("CS66", **options).run(program, until_s=10.0)
    assert (run.state, run.alarms[0].code) == ("stuck", "R130")
    assert 1.0 <= run.time_s < 2.0
    assert ("speed percentage is 0" in run.alarms[0].text) == ("speed" in options)


def test_an_arm_that_stands_for_long_may_still_go_on():
    program = (
        "track_conveyor_linear([1, 0, 0, 0, 0, 0], 1000)\nsleep(3)\nstop_conveyor_tracking()\n"
        "force_mode([0] * 6, [0, 0, 1, 0, 0, 0], [0] * 6, 0, [0.1] * 6)\nsleep(3)\nend_force_mode()\n"
    )
    assert VirtualRobot("CS66").run(program, until_s=20.0).state == "finished"
    robot = VirtualRobot("CS66")
    robot.at(5.0, "standard_digital_in[0]", True)
    program = "track_conveyor_linear([1, 0, 0, 0, 0, 0], 1000)\nwhile not get_standard_digital_in(0):\n  sync()\n"
    assert robot.run(program, until_s=20.0).time_s == pytest.approx(5.0, abs=0.01)


def test_threads_that_start_their_successors_do_not_stop_time(robot):
    run = robot.run("def w():\n  start_thread(w, ())\nend\nw()\nsleep(10)\n", until_s=0.04)
    assert (run.state, run.time_s) == ("time_limit", 0.04)


def test_what_can_never_go_on_is_stuck_and_names_every_thread(robot):
    run = robot.run(
        "def a():\n  import queue\n  q = queue.Queue()\n  def f():\n    q.get()\n  end\n"
        "  h = start_thread(f, ())\n  join_thread(h)\nend\n"
    )
    assert run.state == "stuck"
    assert "line 5" in run.alarms[0].text
    assert "line 8" in run.alarms[0].text
    assert [thread.line for thread in run.threads] == [8, 5]


def test_signals_are_set_read_and_reported(robot):
    robot.signals["standard_digital_in[3]"] = True
    robot.signals["input_float_register[7]"] = 2.5
    run = robot.run(
        "def a():\n  set_standard_digital_out(1, get_standard_digital_in(3))\n"
        "  write_output_float_register(0, read_input_float_register(7))\nend\n"
    )
    assert robot.signals["standard_digital_out[1]"] is True
    assert run.signals == {
        "standard_digital_in[3]": True,
        "standard_digital_out[1]": True,
        "input_float_register[7]": 2.5,
        "output_float_register[0]": 2.5,
    }


@pytest.mark.parametrize(
    ("name", "value"), [("standard_digital_in[3]", 2), ("input_int_register[0]", 1.5), ("nope", 1)]
)
def test_a_senseless_signal_is_refused(robot, name, value):
    with pytest.raises(UsageError):
        robot.signals[name] = value


def test_an_input_can_be_scripted(robot):
    robot.at(0.2, "standard_digital_in[0]", True)
    run = robot.run("def a():\n  while not get_standard_digital_in(0):\n    sync()\n  end\nend\n")
    assert run.time_s == 0.2
    assert [event.tick for event in run.events if isinstance(event, SignalChanged)] == [50]


def test_a_program_can_be_stepped_and_looked_at(robot):
    run = robot.start("def a():\n  movej([0.5, -1.5, -1.5, -1.5, 1.5, 0])\n  textmsg(1)\nend\n")
    robot.advance(0.1)
    assert robot.state.is_moving
    assert robot.state.line == 2
    assert run.state == ""
    robot.advance(10)
    assert (run.state, run.log, run.joints) == ("finished", ["1"], (0.5, -1.5, -1.5, -1.5, 1.5, 0.0))
    assert 0.5 < run.time_s < 2.0
    assert robot.time_s == pytest.approx(10.1)


def test_a_paused_program_goes_on_where_it_was(robot):
    run = robot.start("def a():\n  movej([0.5, -1.5, -1.5, -1.5, 1.5, 0])\nend\n")
    robot.advance(0.3)
    robot.pause()
    robot.advance(1.0)
    q = robot.state.q_target
    robot.advance(1.0)
    assert robot.state.q_target == q
    assert robot.state.task_state is TaskState.PAUSED
    robot.resume()
    robot.advance(5.0)
    assert run.state == "finished"
    assert robot.state.q_target == (0.5, -1.5, -1.5, -1.5, 1.5, 0.0)


def test_a_stopped_program_brakes_and_ends(robot):
    run = robot.start("def a():\n  movej([0.5, -1.5, -1.5, -1.5, 1.5, 0])\n  textmsg(1)\nend\n")
    robot.advance(0.4)
    robot.stop()
    robot.advance(1.0)
    assert (run.state, run.log) == ("stopped", [])
    assert not robot.state.is_moving
    assert [event.is_complete for event in run.events if isinstance(event, MotionEnded)] == [False]


def test_a_second_program_is_refused_while_one_runs(robot):
    robot.start("def a():\n  sleep(1)\nend\n")
    with pytest.raises(Exception, match="a task is running"):
        robot.start("def b():\n  pass\nend\n")


def test_a_secondary_program_reads_and_sets_globals(robot):
    run = robot.start("def a():\n  global go\n  go = False\n  while not go:\n    sync()\n  end\n  textmsg(go)\nend\n")
    robot.advance(0.1)
    robot.submit_secondary("sec s():\n  global go\n  go = 7\nend\n")
    robot.advance(0.1)
    assert (run.state, run.log) == ("finished", ["7"])


def test_a_secondary_program_runs_without_a_program(robot):
    robot.submit_secondary("sec s():\n  set_standard_digital_out(2, True)\nend\n")
    robot.advance(0.1)
    assert robot.signals["standard_digital_out[2]"] is True


def test_presets_are_globals_of_the_program(robot):
    run = robot.run("def a():\n  textmsg(count + 1)\nend\n", presets={"count": 4})
    assert (run.log, run.globals) == (["5"], {"count": 4})


def test_the_trace_has_a_row_for_each_tick_after_its_motion(robot):
    run = robot.run("def a():\n  movej([0.1, -1.5, -1.5, -1.5, 1.5, 0])\n  sleep(0.02)\nend\n", trace=True)
    assert [row.t for row in run.trace] == [tick / 250 for tick in range(robot.tick + 1)]
    assert run.trace[0].q != HOME
    assert run.trace[-1].q == run.joints
    assert [row.line for row in run.trace[-7:]] == [2, 3, 3, 3, 3, 3, 0]
    assert {row.state for row in run.trace[:-1]} == {"playing"}


def test_a_coarser_trace_is_a_part_of_the_full_one():
    program = "def a():\n  movej([0.3, -1.5, -1.5, -1.5, 1.5, 0])\nend\n"
    full = VirtualRobot("CS66").run(program, trace=True).trace
    coarse = VirtualRobot("CS66").run(program, trace=True, trace_step_s=0.02).trace
    assert coarse[:-1] == full[:-1:5]
    assert coarse[-1] == full[-1]


def test_the_clock_of_a_free_run_is_the_same_every_day(robot):
    assert robot.run("def a():\n  sleep(1)\n  textmsg(controller_timestamp())\nend\n").log == ["1704067201.0"]


def test_random_numbers_follow_the_seed():
    program = "def a():\n  textmsg(random())\nend\n"
    logs = [VirtualRobot(seed=seed).run(program).log for seed in (1, 1, 2)]
    assert logs[0] == logs[1] != logs[2]


def test_a_program_from_a_file_has_that_files_folder(tmp_path):
    (tmp_path / "points.txt").write_text("1 2 3\n", encoding="utf-8")
    program = tmp_path / "job.script"
    program.write_text("def job():\n  textmsg(open(get_task_path() + 'points.txt').read())\nend\n", encoding="utf-8")
    assert VirtualRobot().run(program).log == ["1 2 3\n"]
    assert VirtualRobot().run(str(program)).log == ["1 2 3\n"]


def test_a_program_text_has_an_empty_folder_of_its_own(robot):
    run = robot.run("def a():\n  with open(get_task_path() + 'x', 'w') as f:\n    f.write('1')\n  end\nend\n")
    assert run.state == "finished"
    assert not Path("x").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"model": "CS99"}, "CS99"),
        ({"firmware": "9.9"}, "9.9"),
        ({"joints": (0, 0, 0)}, "six"),
        ({"joints": (0, 0, 0, 0, 0, 9)}, "wrist3"),
        ({"speed": 1.5}, "speed"),
    ],
)
def test_a_senseless_robot_is_refused(arguments, words):
    with pytest.raises(UsageError, match=words):
        VirtualRobot(**arguments)


def test_a_missing_file_is_named(robot):
    with pytest.raises(UsageError, match=r"nowhere\.script"):
        robot.run("nowhere.script")


def test_two_robots_do_not_see_each_other():
    first, second = VirtualRobot(), VirtualRobot("CS620")
    first.run("def a():\n  global x\n  x = 1\n  set_flag(0, True)\nend\n")
    assert second.run("def a():\n  textmsg(get_flag(0))\nend\n").log == ["False"]


def test_the_task_state_is_told(robot):
    run = robot.run("def job():\n  pass\nend\n")
    states = [(event.state, event.name) for event in run.events if isinstance(event, TaskStateChanged)]
    assert states == [(TaskState.PLAYING, "job"), (TaskState.STOPPED, "job")]


def test_an_interruption_ends_the_run_at_the_next_checkpoint_and_keeps_every_threads_line():
    robot = VirtualRobot(on_event=lambda event: robot.interrupt() if getattr(event, "text", "") == "now" else None)
    run = robot.run(
        "def a():\n  def f():\n    sleep(9)\n  end\n  start_thread(f, ())\n  sleep(1)\n  textmsg('now')\n"
        "  while True:\n    pass\n  end\nend\n"
    )
    assert (run.state, run.time_s) == ("stopped", 1.0)
    main, other = run.threads
    assert (main.name, other.name, other.line) == ("main", "f", 3)
    assert main.line in (8, 9)
    assert robot.state.task_state is TaskState.STOPPED


MOVER = "  def mover():\n    movej([0.9, -1.5, -1.5, -1.5, 1.5, 0], a=1, v=0.5)\n    textmsg('mover goes on')\n  end\n"


def test_everybody_who_waits_for_a_move_that_is_braked_goes_on(robot):
    run = robot.run(
        f"def a():\n{MOVER}  def brake():\n    sleep(1)\n    stopj(2)\n    textmsg('brake goes on')\n  end\n"
        "  h = start_thread(mover, ())\n  k = start_thread(brake, ())\n  sleep(1)\n  stopj(2)\n"
        "  join_thread(h)\n  join_thread(k)\nend\n"
    )
    assert (run.state, sorted(run.log)) == ("finished", ["brake goes on", "mover goes on"])


def test_a_limit_that_comes_while_the_arm_brakes_still_gives_the_whole_record(robot):
    run = robot.run(f"def a():\n{MOVER}  start_thread(mover, ())\n  sleep(1)\nend\n", until_s=1.02)
    assert (run.state, run.time_s, len(run.joints), len(run.tcp_pose)) == ("finished", 1.02, 6, 6)


def test_what_is_wrong_with_a_listener_is_not_the_programs_to_catch():
    def listener(event):
        if getattr(event, "text", "") == "boom":
            raise AssertionError("test failed")

    robot = VirtualRobot(on_event=listener)
    program = "def a():\n  while True:\n    try:\n      textmsg('boom')\n    except:\n      pass\n    end\n  end\nend\n"
    with pytest.raises(AssertionError, match="test failed"):
        robot.run(program)
    assert robot.current.state == "stopped"
    assert robot.run("def b():\n  textmsg('fine')\nend\n").log == ["fine"]


def test_an_interruption_is_over_with_its_run():
    robot = VirtualRobot(on_event=lambda event: robot.interrupt() if getattr(event, "text", "") == "now" else None)
    robot.run(f"def a():\n{MOVER}  start_thread(mover, ())\n  sleep(0.5)\n  textmsg('now')\n  sleep(9)\nend\n")
    assert robot.state.is_moving
    robot.advance(2.0)
    assert not robot.state.is_moving


def test_a_secondary_program_outlives_the_program_it_ran_beside(robot):
    robot.submit_secondary("sec s():\n  for i in range(60000):\n    pass\n  end\n  set_flag(1, True)\nend\n")
    robot.run("def a():\n  pass\nend\n")
    robot.run("def b():\n  pass\nend\n")
    robot.advance(0.2)
    assert robot.signals["flag[1]"] is True


def test_a_missing_task_folder_leaves_the_robot_usable(tmp_path):
    robot = VirtualRobot(task_dir=tmp_path / "missing")
    with pytest.raises(UsageError):
        robot.run("def a():\n  pass\nend\n")
    (tmp_path / "missing").mkdir()
    assert robot.run("def a():\n  pass\nend\n").state == "finished"


@pytest.mark.parametrize("world", [None, World()])
def test_a_task_folder_in_memory_is_a_new_one_for_each_program(world):
    robot = VirtualRobot(task_dir={"points.csv": b"12"}, world=world)
    program = 'def a():\n  f = open("points.csv", "r+")\n  textmsg(f.read())\n  f.write("3")\n  f.close()\nend\n'
    assert robot.run(program).log == ["12"]
    assert robot.run(program).log == ["12"]


def test_a_run_begins_powered_on(robot):
    assert robot.run("def a():\n  powerdown()\nend\n").state == "stopped"
    assert robot.run("def a():\n  movej([0.1, -1.5, -1.5, -1.5, 1.5, 0])\nend\n").state == "finished"


def test_a_path_of_any_name_brings_its_folder(tmp_path):
    (tmp_path / "data").write_text("42", encoding="utf-8")
    (tmp_path / "prog.txt").write_text("def a():\n  textmsg(open('data').read())\nend\n", encoding="utf-8")
    assert VirtualRobot().run(tmp_path / "prog.txt").log == ["42"]


def test_a_record_that_is_complete_does_not_change(robot):
    run = robot.run("def a():\n  pass\nend\n")
    count = len(run.events)
    robot.signals["flag[0]"] = True
    assert len(run.events) == count


@pytest.mark.parametrize("name", ["__builtins__", "if", "2x", "a.b"])
def test_a_preset_that_no_program_could_set_is_refused(robot, name):
    with pytest.raises(UsageError, match="global"):
        robot.run("def a():\n  pass\nend\n", presets={name: 1})


def test_globals_are_those_after_the_last_finally(robot):
    run = robot.run(
        "def a():\n  global g\n  g = 0\n  try:\n    sleep(9)\n  finally:\n    g = 1\n  end\nend\n", until_s=1
    )
    assert run.globals == {"g": 1}


def test_an_endless_time_is_no_limit_and_nan_is_no_time(robot):
    assert robot.run("def a():\n  sleep(1)\nend\n", until_s=float("inf")).state == "finished"
    with pytest.raises(UsageError, match="nan"):
        robot.at(float("nan"), "flag[0]", True)


def test_a_set_of_objects_has_the_same_order_every_time():
    program = "def a():\n  class P:\n    def __init__(self, n):\n      self.n = n\n    end\n  end\n"
    program += "  textmsg([p.n for p in {P(i) for i in range(9)}])\nend\n"
    keep = [VirtualRobot().run(program).log for _ in range(5)]
    assert all(log == keep[0] for log in keep)


def test_a_file_that_is_a_secondary_program_runs_as_one(robot):
    run = robot.run("sec a():\n  set_flag(2, True)\n  movej([0, -1, 0, 0, 0, 0])\nend\n")
    assert (run.state, run.alarms, robot.signals["flag[2]"]) == ("finished", [], True)
    assert run.warnings[-1].startswith("[SEC] Exception: ")
    assert not robot.state.is_moving
    robot.start("def b():\n  sleep(1)\nend\n")
    with pytest.raises(Exception, match="a task is running"):
        robot.run("sec a():\n  pass\nend\n")


@pytest.mark.parametrize("move", ["movej(get_target_joint_positions(), t=2)", "movel(get_target_tcp_pose(), t=2)"])
def test_a_move_to_where_the_arm_stands_lasts_as_long_as_it_is_told(robot, move):
    run = robot.run(f"def a():\n  {move}\nend\n", trace=True)
    assert run.time_s == 2.0
    assert {row.q for row in run.trace} == {HOME}


def test_powerdown_is_the_end_of_the_program(robot):
    run = robot.run("def a():\n  powerdown()\n  textmsg('still here')\nend\n")
    assert (run.state, run.log) == ("stopped", [])


def test_a_thread_whose_call_fails_is_placed_where_it_was_started(robot):
    run = robot.run("def a():\n  def f(x):\n    pass\n  end\n  start_thread(f, (1, 2))\n  sleep(1)\nend\n")
    assert (run.alarms[0].class_name, run.alarms[0].line) == ("TypeError", 5)


def test_a_failing_secondary_program_names_its_line(robot):
    robot.start("def a():\n  sleep(1)\nend\n")
    robot.submit_secondary("sec s():\n\n  nope\nend\n")
    robot.advance(0.1)
    assert [event.line for event in robot.current.events if isinstance(event, Warned)] == [3]


def test_a_handler_may_name_the_users_interrupt(robot):
    program = "def a():\n  try:\n    raise ValueError\n  except KeyboardInterrupt:\n    pass\n"
    program += "  except ValueError:\n    textmsg(1)\nend\n"
    assert robot.run(program).log == ["1"]


def test_signals_of_a_run_that_are_at_their_default_read_as_that(robot):
    run = robot.run("def a():\n  set_standard_digital_out(1, True)\nend\n")
    assert run.signals == {"standard_digital_out[1]": True}
    assert run.signals["standard_digital_out[0]"] is False
    with pytest.raises(UsageError):
        run.signals["nope"]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ("movej([0.9, -1.5, -1.5, -1.5, 1.5, 0], a=30, v=60)", "v = 60 rad/s is lowered to 2.618"),
        ("movel([0.45, -0.15, 0.4, 3.1416, 0, -1.5708], a=1.2, v=250)", ""),
        ("movel([0.45, -0.15, 0.2, 3.1416, 0, -1.5708], a=30, v=250)", "v = 250 m/s is lowered to 2.5"),
    ],
)
def test_a_speed_that_the_arm_does_not_have_is_said_if_it_matters(robot, call, words):
    warnings = [text for text in robot.run(f"def a():\n  {call}\nend\n").warnings if "lowered" in text]
    assert any(words in warning for warning in warnings) if words else warnings == []


def test_other_units_are_guessed(robot):
    (alarm,) = robot.run("def a():\n  movej([0, -90, 90, 0, 90, 0])\nend\n").alarms
    assert "d2r" in alarm.details["hint"]


def test_millimetres_are_told_although_such_a_target_is_a_direction(robot):
    run = robot.run("def a():\n  movel([400, -200, 300, 3.14, 0, 0])\nend\n")
    (found,) = [finding for finding in run.findings if finding.code == "W231"]
    assert "400 mm are 0.4 m" in found.hint
    assert "are millimetres meant?" in run.alarms[0].details["hints"][0]


@pytest.fixture
def _interrupts():
    """Handle SIGINT as Python does, also where the caller ignores it, as shells do for what runs in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("_interrupts")
def test_ctrl_c_ends_the_run_cleanly_and_then_interrupts():
    def press(event):
        if getattr(event, "text", "") == "now":
            signal.raise_signal(signal.SIGINT)

    robot = VirtualRobot(on_event=press)
    program = "def a():\n  while True:\n    try:\n      textmsg('now')\n    except:\n      pass\n    end\n  end\nend\n"
    with pytest.raises(KeyboardInterrupt):
        robot.run(program)
    assert robot.current.state == "stopped"
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert robot.run("def b():\n  textmsg('fine')\nend\n").log == ["fine"]


def test_open_is_told_what_becomes_of_broken_text(robot):
    program = 'def a():\n  open("x", "wb").write(b"a\\xffb")\n  textmsg(open("x", errors="ignore").read())\nend\n'
    assert robot.run(program).log == ["ab"]


def test_how_much_a_thread_may_do_in_a_tick_is_a_setting():
    program = "def a():\n  for i in range(100000):\n    pass\n  end\nend\n"
    slow, quick = (VirtualRobot(work_per_tick=work).run(program).time_s for work in (1000, 100_000))
    assert quick < 0.01 < 0.3 < slow


def test_a_program_that_is_refused_takes_nothing_from_the_one_that_runs(tmp_path):
    world = tmp_path / "world.toml"
    world.write_text('[[sphere]]\nname = "ball"\nradius = 0.05\npose = [0.9, 0.9, 0.9]\n', encoding="utf-8")

    def played(*, refused: bool):
        robot = VirtualRobot(world=world)
        run = robot.start("def mine():\n  movej([0.2, -1.5, -1.5, -1.5, 1.5, 0], v=2, a=9)\nend\n", trace=True)
        robot.advance(0.02)
        if refused:
            with pytest.raises(Exception, match="cannot start: a task is running"):
                robot.start("def other():\n  sleep(1)\nend\n", trace=True)
            assert robot.current is run
        name = robot.controller.task.name
        robot.advance(0.4)
        assert run.state == "finished"
        return name, list(run.trace), run.clearances

    alone, beside = played(refused=False), played(refused=True)
    assert alone[0] == "mine"
    assert len(alone[1]) > 50
    assert beside == alone


@pytest.mark.parametrize("value", [True, "5", b"5", -1, float("nan"), float("-inf"), [5], 10**400, -(10**400)])
def test_a_time_that_is_no_number_is_refused_before_anything_begins(robot, value):
    for call, name in (
        (lambda: robot.run("def a():\n  sleep(1)\nend\n", until_s=value), "until_s"),
        (lambda: robot.advance(value), "duration_s"),
        (lambda: robot.at(value, "standard_digital_in[0]", True), "time_s"),
        (lambda: robot.connect("dashboard").expect(b"x", within_s=value), "within_s"),
    ):
        with pytest.raises(UsageError, match=f"^{name} must be (a number in|>= 0) s, got "):
            call()
    assert robot.tick == 0
