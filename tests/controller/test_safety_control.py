"""The safety system at work: stops in the middle of motions, what they do to task and power, and the way back."""

import itertools

import pytest

from elitescript import VirtualRobot
from elitescript.controller.force.contact import ContactConfig, Plane
from elitescript.controller.safety.limits import SafetyBounds, SafetyLimits, SafetyPlane
from elitescript.errors import ScriptStateError, UsageError
from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from elitescript.messages.events import MotionEnded, RobotModeChanged, SafetyModeChanged, TaskStateChanged
from elitescript.messages.machine import AskSafety
from elitescript.messages.timing import ticks_for

UP = (0.0, 0.0, 1.0)
TABLE = SafetyLimits(planes=(SafetyPlane("table", (0.0, 0.0, 0.3), UP),))
DOWN = """def p():
  p = get_target_tcp_pose()
  p[2] -= 0.3
  movel(p, a=1, v=0.4)
  sleep(0.1)
end
"""
SWING = "def p():\n  movej([1.5, -1.5708, -1.5708, -1.5708, 1.5708, 0], a=2, v=1)\n  sleep(0.1)\nend\n"


def changes(run):
    return [(event.tick, event.mode) for event in run.events if isinstance(event, SafetyModeChanged)]


def robot_with(limits=None, **at):
    robot = VirtualRobot("CS66", safety=limits)
    for name, times in at.items():
        for time_s, value in times:
            robot.at(time_s, name, value)
    return robot


class TestLimits:
    def test_the_plane_stops_the_arm_and_the_program_with_everything_a_person_needs(self):
        robot = robot_with(TABLE)
        run = robot.run(DOWN, trace=True)
        (alarm,) = run.alarms
        assert (run.state, alarm.code, alarm.class_name, alarm.line) == ("alarm", "R140", "ProtectiveStop", 4)
        assert alarm.source_line == "  movel(p, a=1, v=0.4)"
        assert alarm.details["plane"] == "table"
        assert (alarm.details["limit"], alarm.details["unit"]) == (">= 0", "m")
        assert -0.002 < alarm.details["value"] < 0.0
        assert len(alarm.details["hints"]) == 3
        assert robot.state.safety_mode is SafetyMode.PROTECTIVE_STOP
        assert robot.state.robot_mode is RobotMode.RUNNING
        # It brakes on its path: v^2 / 2a of the stop and no more.
        assert 0.26 < run.tcp_pose[2] < 0.3
        start, end = run.trace[0].tcp_pose, run.tcp_pose
        assert end[:2] == pytest.approx(start[:2], abs=1e-6)

    def test_a_tcp_that_is_too_fast_stops_at_once(self):
        run = robot_with(SafetyLimits(SafetyBounds(tcp_speed_max=0.3))).run(DOWN)
        (alarm,) = run.alarms
        assert (alarm.details["reason"], alarm.details["limit"]) == ("tcp_speed", "<= 0.3")
        assert 0.306 < alarm.details["value"] < 0.32

    def test_a_joint_that_is_too_fast_or_too_far_is_named(self):
        slow = SafetyBounds(qd_max=(0.5, 3.0, 3.0, 3.0, 3.0, 3.0))
        near = SafetyBounds(q_min=(-1.0, *(-6.0,) * 5), q_max=(1.0, *(6.0,) * 5))
        for bounds, reason in ((slow, "joint_speed"), (near, "joint_range")):
            run = robot_with(SafetyLimits(bounds)).run(SWING)
            assert (run.alarms[0].details["reason"], run.alarms[0].details["joint"]) == (reason, "base")

    def test_a_motion_within_its_limits_is_not_touched(self):
        wide = SafetyLimits(SafetyBounds((-6.0,) * 6, (6.0,) * 6, (3.0,) * 6, 0.4))
        plain, watched = VirtualRobot("CS66").run(DOWN, trace=True), robot_with(wide).run(DOWN, trace=True)
        assert watched.state == "finished"
        assert (watched.trace, watched.events) == (plain.trace, plain.events)

    def test_a_tool_that_reaches_behind_a_plane_stops_the_arm_that_stands(self):
        run = robot_with(TABLE).run("def p():\n  sleep(1)\n  set_tcp([0, 0, 0.3, 0, 0, 0])\n  sleep(1)\nend\n")
        assert (run.state, run.time_s) == ("alarm", 1.004)
        assert run.alarms[0].details["reason"] == "plane"

    def test_a_plane_of_a_pair_of_inputs_counts_from_when_both_are_high(self):
        plane = SafetyPlane("door", (0.0, 0.0, 0.6), UP, pair=1)
        robot = VirtualRobot("CS66", safety=SafetyLimits(planes=(plane,)))
        robot.at(0.5, "configurable_digital_in[2]", True)
        robot.at(0.7, "configurable_digital_in[3]", True)
        run = robot.run("def p():\n  sleep(2)\nend\n")
        assert (run.state, run.time_s) == ("alarm", 0.7)
        assert run.alarms[0].details["plane"] == "door"

    @pytest.mark.parametrize("height", [0.3, 0.3 - 1e-5])
    def test_a_motion_that_ends_just_behind_a_plane_is_seen(self, height):
        program = (
            f"def p():\n  p = get_target_tcp_pose()\n  p[2] = {height}\n  movel(p, a=1, v=0.4)\n  sleep(0.1)\nend\n"
        )
        run = robot_with(TABLE).run(program)
        assert run.state == ("finished" if height == 0.3 else "alarm")

    def test_an_alarm_is_not_caught_by_the_program(self):
        program = DOWN.replace("  movel", "  try:\n    movel").replace(
            "  sleep(0.1)", '  except Exception:\n    textmsg("caught")\n  finally:\n    textmsg("end")\n  end'
        )
        run = robot_with(TABLE).run(program)
        assert (run.state, run.log) == ("alarm", ["end"])


class TestProtectiveStop:
    def test_speedj_into_the_end_of_a_range_is_one(self):
        run = VirtualRobot("CS66").run("def p():\n  speedj([2, 0, 0, 0, 0, 0], 3)\n  sleep(9)\nend\n")
        (alarm,) = run.alarms
        assert (alarm.code, alarm.line, alarm.details["reason"], alarm.details["joint"]) == (
            "R140",
            2,
            "obstacle",
            "base",
        )
        assert alarm.details["unit"] == "rad"
        assert run.joints[0] == pytest.approx(2 * 3.141592653589793, abs=0.02)

    def test_speedl_into_a_singularity_is_one(self):
        run = VirtualRobot("CS66").run("def p():\n  speedl([0.2, 0, 0, 0, 0, 0], 1)\n  sleep(60)\nend\n")
        (alarm,) = run.alarms
        assert (alarm.code, alarm.line, alarm.details["reason"]) == ("R140", 2, "obstacle")

    def test_a_person_may_ask_for_one_in_the_middle_of_a_motion(self):
        robot = VirtualRobot("CS66")
        robot.start(SWING)
        robot.advance(0.4)
        robot.protective_stop("the skin was touched")
        assert robot.state.safety_mode is SafetyMode.PROTECTIVE_STOP
        robot.advance(1.0)
        (alarm,) = robot.current.alarms
        assert (alarm.text, alarm.line, alarm.tick) == ("the skin was touched", 2, 100)
        assert robot.state.task_state is TaskState.STOPPED
        assert not robot.state.is_moving

    def test_it_is_unlocked_after_five_seconds_and_then_a_program_runs(self):
        robot = robot_with(TABLE)
        robot.run(DOWN)
        with pytest.raises(ScriptStateError, match="5 s after the stop"):
            robot.unlock_protective_stop()
        again = robot.run(SWING)
        assert (again.state, again.time_s, again.alarms[0].code) == ("alarm", 0.0, "R140")
        assert "cannot start: the arm is in protective stop" in again.alarms[0].text
        assert "behind safety plane 'table'" in again.alarms[0].text
        robot.advance(5.0)
        robot.unlock_protective_stop()
        # The arm has braked behind the plane: it may go back, slowly.
        assert robot.state.safety_mode is SafetyMode.RECOVERY
        back = robot.run("def p():\n  movej([0, -1.5708, -1.5708, -1.5708, 1.5708, 0])\nend\n")
        assert back.state == "finished"
        assert robot.state.safety_mode is SafetyMode.NORMAL

    def test_there_is_nothing_to_unlock_without_one(self):
        with pytest.raises(ScriptStateError, match="no protective stop to unlock; the safety mode is NORMAL"):
            VirtualRobot("CS66").unlock_protective_stop()

    def test_a_second_one_keeps_the_reason_of_the_first(self):
        robot = VirtualRobot("CS66")
        robot.protective_stop("first")
        robot.protective_stop("second")
        run = robot.run(SWING)
        assert "first" in run.alarms[0].text


class TestEmergencyStop:
    @pytest.mark.parametrize(
        ("signal", "mode"),
        [
            ("emergency_stop", SafetyMode.ROBOT_EMERGENCY_STOP),
            ("system_emergency_stop", SafetyMode.SYSTEM_EMERGENCY_STOP),
        ],
    )
    def test_the_arm_brakes_before_its_power_goes_off(self, signal, mode):
        robot = robot_with(**{signal: [(0.6, True)]})
        run = robot.run(SWING, trace=True)
        (alarm,) = run.alarms
        assert (run.state, alarm.code, alarm.line) == ("alarm", "R141", 2)
        assert (robot.state.safety_mode, robot.state.robot_mode) == (mode, RobotMode.POWER_OFF)
        (off,) = [event.tick for event in run.events if isinstance(event, RobotModeChanged)]
        (rest,) = [event.tick for event in run.events if isinstance(event, MotionEnded)]
        assert off == rest > 150
        speeds = [row.qd[0] for row in run.trace]
        assert max(abs(b - a) for a, b in itertools.pairwise(speeds)) <= 8.0 * 0.004 + 1e-9

    def test_the_way_back_is_release_power_brakes(self):
        robot = robot_with(emergency_stop=[(0.2, True)])
        robot.run(SWING)
        assert robot.run(SWING).alarms[0].text.startswith("cannot start: the emergency stop is pressed; release it")
        with pytest.raises(ScriptStateError, match="release it"):
            robot.controller.power_up()
        robot.signals["emergency_stop"] = False
        assert (robot.state.safety_mode, robot.state.robot_mode) == (SafetyMode.NORMAL, RobotMode.POWER_OFF)
        assert robot.run(SWING).state == "finished"

    def test_starting_a_program_powers_on_and_releases_the_brakes(self):
        robot = robot_with(emergency_stop=[(0.5, True), (1.5, False)])
        run = robot.run(SWING)
        assert run.alarms[0].details["hints"][-1].endswith("then start the program again, from its first line")
        robot.advance(2.0)
        assert robot.state.robot_mode is RobotMode.POWER_OFF
        assert robot.run(SWING).state == "finished"

    def test_both_buttons_have_to_be_released(self):
        robot = VirtualRobot("CS66")
        robot.signals["system_emergency_stop"] = True
        robot.signals["emergency_stop"] = True
        robot.signals["emergency_stop"] = False
        assert robot.state.safety_mode is SafetyMode.SYSTEM_EMERGENCY_STOP
        robot.signals["system_emergency_stop"] = False
        assert robot.state.safety_mode is SafetyMode.NORMAL

    def test_a_button_that_was_pressed_only_between_two_ticks_counts(self):
        robot = VirtualRobot("CS66")
        robot.start(SWING)
        robot.advance(0.4)
        robot.signals["emergency_stop"] = True
        robot.signals["emergency_stop"] = False
        robot.advance(1.0)
        assert robot.current.state == "alarm"
        assert robot.state.robot_mode is RobotMode.POWER_OFF


class TestSafeguard:
    def test_the_task_pauses_and_goes_on_when_it_is_closed(self):
        robot = robot_with(safeguard_stop=[(0.6, True), (2.6, False)])
        run, plain = robot.run(SWING), VirtualRobot("CS66").run(SWING)
        assert (run.state, run.joints) == ("finished", plain.joints)
        assert plain.time_s + 1.9 < run.time_s < plain.time_s + 2.4
        assert changes(run) == [(150, SafetyMode.SAFEGUARD_STOP), (650, SafetyMode.NORMAL)]
        states = [event.state for event in run.events if isinstance(event, TaskStateChanged)]
        assert states == [TaskState.PLAYING, TaskState.PAUSED, TaskState.PLAYING, TaskState.STOPPED]

    def test_a_task_that_somebody_paused_waits_for_him(self):
        robot = robot_with(safeguard_stop=[(0.4, True), (1.0, False)])
        robot.start(SWING)
        robot.advance(0.5)
        robot.pause()
        robot.advance(2.0)
        assert (robot.state.safety_mode, robot.state.task_state) == (SafetyMode.NORMAL, TaskState.PAUSED)
        robot.resume()
        robot.advance(5.0)
        assert robot.current.state == "finished"

    def test_nobody_resumes_while_it_is_open(self):
        robot = robot_with(safeguard_stop=[(0.4, True)])
        robot.start(SWING)
        robot.advance(0.5)
        with pytest.raises(ScriptStateError, match="cannot resume task: the safeguard is open; close it"):
            robot.resume()

    def test_a_program_that_starts_behind_an_open_door_waits_for_it(self):
        robot = robot_with(safeguard_stop=[(1.0, False)])
        robot.signals["safeguard_stop"] = True
        run = robot.run(SWING)
        assert run.state == "finished"
        assert run.time_s == pytest.approx(VirtualRobot("CS66").run(SWING).time_s + 1.0, abs=0.01)

    def test_a_door_that_nobody_closes_is_the_reason_why_a_run_is_stuck(self):
        run = robot_with(safeguard_stop=[(0.4, True)]).run(SWING, trace=True)
        assert (run.state, run.trace[-1].qd) == ("stuck", (0.0,) * 6)
        assert "the safeguard is open; close it" in run.alarms[0].text

    def test_an_emergency_stop_ends_the_task_that_it_holds(self):
        run = robot_with(safeguard_stop=[(0.4, True), (3.0, False)], emergency_stop=[(2.0, True)]).run(SWING)
        assert (run.state, run.alarms[0].tick, run.alarms[0].code) == ("alarm", 500, "R141")


class TestReducedMode:
    LIMITS = SafetyLimits(reduced=SafetyBounds(qd_max=(0.8,) * 6, tcp_speed_max=0.2))

    @pytest.mark.parametrize("program", [SWING, DOWN, SWING.replace("v=1", "t=1.9")])
    def test_motions_that_begin_in_it_keep_its_speeds(self, program):
        robot = robot_with(self.LIMITS)
        robot.signals["reduced_mode"] = True
        run = robot.run(program, trace=True)
        assert run.state == "finished"
        assert run.joints == pytest.approx(VirtualRobot("CS66").run(program).joints, abs=1e-9)
        assert self.fastest(run.trace) <= 0.2 * 1.01
        assert max(abs(speed) for row in run.trace for speed in row.qd) <= 0.8 * 1.01

    @pytest.mark.parametrize("program", [SWING, DOWN])
    @pytest.mark.parametrize("time_s", [0.02, 0.3, 0.5, 0.7])
    def test_a_motion_under_way_is_slowed_down_and_speeds_up_again(self, program, time_s):
        robot = robot_with(self.LIMITS, reduced_mode=[(time_s, True), (time_s + 1.5, False)])
        run = robot.run(program, trace=True)
        assert run.state == "finished"
        slow = [row for row in run.trace if time_s + 0.5 < row.t < time_s + 1.5]
        assert self.fastest(slow) <= 0.2 * 1.02
        assert robot.state.speed_scale == 1.0
        speeds = [row.qd[0] for row in run.trace]
        assert max(abs(b - a) for a, b in itertools.pairwise(speeds)) <= 12.0 * 0.004

    KINDS = (
        ("movej", "  movej([1.5, -1.5708, -1.5708, -1.5708, 1.5708, 0], a=3, v=1)\n"),
        ("movel", "  p[1] += 0.3\n  movel(p, a=1.2, v=0.4)\n"),
        ("movec", "  w = p.copy()\n  w[0] -= 0.1\n  w[1] += 0.1\n  p[1] += 0.2\n  movec(w, p, a=1.2, v=0.4)\n"),
        ("movep", "  for i in range(60):\n    p[1] += 0.005\n    movep(p, a=1.2, v=0.4, r=0.002)\n  end\n"),
        (
            "blends",
            "  for i in range(4):\n    p[1] += 0.08\n    p[2] += 0.02\n    movel(p, a=1.2, v=0.4, r=0.03)\n  end\n",
        ),
        ("speedl", "  speedl([0, 0.4, 0, 0, 0, 0], 1.2, 2)\n"),
        ("speedj", "  speedj([0.8, 0, 0, 0, 0, 0], 3, 2)\n"),
    )

    @pytest.mark.parametrize(("name", "body"), KINDS, ids=[kind[0] for kind in KINDS])
    @pytest.mark.parametrize("time_s", [0.0, 0.1, 0.3, 0.5])
    def test_every_motion_settles_at_the_limit_whenever_it_begins(self, name, body, time_s):
        program = f"def p():\n  p = get_target_tcp_pose()\n{body}end\n"
        limits = SafetyLimits(reduced=SafetyBounds(tcp_speed_max=0.1))
        run = robot_with(limits, reduced_mode=[(time_s, True)]).run(program, trace=True)
        assert run.state == "finished"
        settled = [row for row in run.trace if time_s + 0.55 < row.t < time_s + 1.3]
        speeds = [self.fastest(pair) for pair in itertools.pairwise(settled)]
        assert (min(speeds), max(speeds)) == pytest.approx((0.099, 0.099), rel=0.03)

    @pytest.mark.parametrize(("name", "body"), KINDS[:5], ids=[kind[0] for kind in KINDS[:5]])
    @pytest.mark.parametrize("time_s", [0.0, 0.3])
    def test_a_motion_takes_up_its_own_speed_when_the_mode_ends(self, name, body, time_s):
        program = f"def p():\n  p = get_target_tcp_pose()\n{body}end\n"
        limits = SafetyLimits(reduced=SafetyBounds(tcp_speed_max=0.1))
        signal = [(time_s, True), (time_s + 0.6, False)]
        run = robot_with(limits, reduced_mode=signal).run(program, trace=True)
        assert run.state == "finished"
        own = self.fastest(VirtualRobot("CS66").run(program, trace=True).trace)
        assert self.fastest([row for row in run.trace if row.t > time_s + 0.6]) > 0.95 * own
        speeds = [row.qd for row in run.trace]
        jumps = [abs(y - x) for one, two in itertools.pairwise(speeds) for x, y in zip(one, two, strict=True)]
        assert max(jumps) <= 24.0 * 0.004

    def test_a_change_of_the_speed_percentage_does_not_lift_the_limit(self):
        robot = robot_with(self.LIMITS)
        robot.signals["reduced_mode"] = True
        robot.set_speed(0.3)
        robot.start(DOWN, trace=True)
        robot.advance(0.5)
        robot.set_speed(1.0)
        robot.advance(5.0)
        assert robot.current.state == "finished"
        assert self.fastest(robot.current.trace) <= 0.2 * 1.02

    def test_a_motion_that_was_slow_when_the_mode_changed_does_not_become_too_fast_later(self):
        robot = robot_with(self.LIMITS, reduced_mode=[(0.5, True)])
        robot.set_speed(0.1)
        robot.start(DOWN, trace=True)
        robot.advance(2.0)
        robot.set_speed(1.0)
        robot.advance(10.0)
        assert robot.current.state == "finished"
        assert self.fastest(robot.current.trace) == pytest.approx(0.2, rel=0.02)

    def test_a_motion_that_cannot_be_slowed_down_is_stopped_after_the_grace(self):
        robot = robot_with(SafetyLimits(reduced=SafetyBounds(tcp_speed_max=0.1)), reduced_mode=[(0.5, True)])
        program = (
            "def p():\n  q = get_target_joint_positions()\n  for i in range(1000):\n    q[0] += 0.002\n"
            "    servoj(q, t=0.004)\n  end\nend\n"
        )
        run = robot.run(program)
        assert (run.state, run.alarms[0].details["reason"]) == ("alarm", "tcp_speed")
        assert run.alarms[0].tick == ticks_for(1.0)

    def test_a_plane_may_trigger_it(self):
        plane = SafetyPlane("near people", (0.0, 0.0, 0.3), UP, use="trigger_reduced")
        limits = SafetyLimits(reduced=SafetyBounds(tcp_speed_max=0.1), planes=(plane,))
        up_again = DOWN.replace("  sleep(0.1)", "  p[2] += 0.3\n  movel(p, a=1, v=0.4)")
        run = VirtualRobot("CS66", safety=limits).run(up_again, trace=True)
        assert run.state == "finished"
        assert [mode for _, mode in changes(run)] == [SafetyMode.REDUCED, SafetyMode.NORMAL]
        low = [row for row in run.trace if row.tcp_pose[2] < 0.2]
        assert self.fastest(low) <= 0.1 * 1.02

    @staticmethod
    def fastest(rows):
        pairs = itertools.pairwise(rows)
        return max(sum((b.tcp_pose[k] - a.tcp_pose[k]) ** 2 for k in range(3)) ** 0.5 / 0.004 for a, b in pairs)

    @pytest.mark.parametrize("time_s", [0.0, 0.6])
    def test_a_hand_moves_the_arm_no_faster_than_the_limit(self, time_s):
        limits = SafetyLimits(reduced=SafetyBounds(tcp_speed_max=0.1))
        hand = {"external_wrench[1]": [(0.2, 30.0), (2.2, 0.0)]}
        robot = robot_with(limits, reduced_mode=[(time_s, True)], **hand)
        run = robot.run("def p():\n  freedrive_mode()\n  sleep(3)\n  end_freedrive_mode()\nend\n", trace=True)
        assert run.state == "finished"
        assert self.fastest([row for row in run.trace if row.t > time_s + 0.3]) == pytest.approx(0.099, rel=0.01)
        speeds = [row.qd for row in run.trace]
        jumps = [abs(y - x) for one, two in itertools.pairwise(speeds) for x, y in zip(one, two, strict=True)]
        assert max(jumps) <= 24.0 * 0.004


class TestRecovery:
    def test_an_arm_that_begins_outside_may_move_back_slowly(self):
        high = SafetyLimits(planes=(SafetyPlane("table", (0.0, 0.0, 0.6), UP),))
        robot = VirtualRobot("CS66", safety=high)
        run = robot.run("def p():\n  movej([0, -1.5708, -0.5, -1.5708, 1.5708, 0])\n  sleep(0.1)\nend\n")
        assert run.state == "finished"
        assert [mode for _, mode in changes(run)] == [SafetyMode.RECOVERY, SafetyMode.NORMAL]
        assert "begins outside its safety limits" in run.warnings[0]


class TestViolationAndFault:
    @pytest.mark.parametrize(("action", "mode"), [("violate", SafetyMode.VIOLATION), ("fail", SafetyMode.FAULT)])
    def test_both_end_everything_and_want_a_restart(self, action, mode):
        robot = VirtualRobot("CS66")
        robot.start(SWING)
        robot.advance(0.4)
        robot.controller.request(AskSafety(action, "board 3 does not answer"))
        robot.advance(1.0)
        assert (robot.state.safety_mode, robot.state.robot_mode) == (mode, RobotMode.POWER_OFF)
        assert robot.current.alarms[0].text == "board 3 does not answer"
        assert robot.run(SWING).alarms[0].code == "R142"
        robot.restart_safety()
        assert robot.state.safety_mode is SafetyMode.NORMAL
        robot.advance(0.1)
        assert robot.run(SWING).state == "finished"

    def test_a_restart_in_the_middle_of_a_program_ends_it(self):
        robot = VirtualRobot("CS66")
        robot.start(SWING)
        robot.advance(0.4)
        robot.restart_safety()
        robot.advance(1.0)
        assert (robot.current.state, robot.state.robot_mode) == ("alarm", RobotMode.POWER_OFF)

    def test_other_actions_cannot_be_asked_for(self):
        with pytest.raises(UsageError, match="no safety action is called 'come_inside'"):
            VirtualRobot("CS66").controller.request(AskSafety("come_inside"))


class TestForce:
    CRASH = "def p():\n  p = get_target_tcp_pose()\n  p[2] -= 0.1\n  movel(p, a=1, v=0.25)\nend\n"

    @staticmethod
    def table(stiffness=1e6):
        x, y, z, *_ = VirtualRobot("CS66").state.tcp_pose_target
        return ContactConfig((Plane((x, y, z - 0.05), UP, stiffness),))

    def test_a_move_into_a_surface_stops_with_everything_a_person_needs(self):
        robot = VirtualRobot("CS66", contact=self.table())
        run = robot.run(self.CRASH)
        (alarm,) = run.alarms
        assert (alarm.code, alarm.class_name, alarm.line) == ("R140", "ProtectiveStop", 4)
        assert (alarm.details["reason"], alarm.details["limit"], alarm.details["unit"]) == ("tcp_force", "<= 250", "N")
        assert 250.0 < alarm.details["value"] < 250.0 + 1e6 * 0.25 * 0.004 + 1.0
        assert len(alarm.details["hints"]) == 3
        assert robot.state.safety_mode is SafetyMode.PROTECTIVE_STOP

    def test_the_limit_is_configured_and_lower_in_reduced_mode(self):
        for limits, is_reduced, limit in (
            (SafetyLimits(SafetyBounds(tcp_force_max=80.0)), False, "<= 80"),
            (SafetyLimits(SafetyBounds(tcp_force_max=80.0)), True, "<= 80"),
            (SafetyLimits(), True, "<= 150"),
            (SafetyLimits(reduced=SafetyBounds(tcp_force_max=60.0)), True, "<= 60"),
        ):
            robot = VirtualRobot("CS66", contact=self.table(1e4), safety=limits)
            robot.signals["reduced_mode"] = is_reduced
            assert robot.run(self.CRASH).alarms[0].details["limit"] == limit
        wide = SafetyLimits(SafetyBounds(tcp_force_max=1e6))
        assert VirtualRobot("CS66", contact=self.table(), safety=wide).run(self.CRASH).state == "finished"

    def test_a_push_from_outside_stops_an_arm_that_stands(self):
        run = robot_with(**{"external_wrench[1]": [(0.5, -251.0)]}).run("def p():\n  sleep(2)\nend\n")
        assert (run.alarms[0].details["reason"], run.alarms[0].tick) == ("tcp_force", 125)

    def test_the_arm_may_back_out_of_a_surface_but_not_press_harder(self):
        robot = VirtualRobot("CS66", contact=self.table(1e5))
        assert robot.run(self.CRASH).state == "alarm"
        for way, state in (("-= 0.02", "alarm"), ("+= 0.1", "finished")):
            robot.advance(5.1)
            robot.unlock_protective_stop()
            program = f"def b():\n  p = get_target_tcp_pose()\n  p[2] {way}\n  movel(p, a=1, v=0.25)\nend\n"
            assert robot.run(program).state == state
        assert robot.run(self.CRASH).alarms[0].details["reason"] == "tcp_force"

    def test_force_mode_with_a_target_above_the_limit_is_warned_of_and_stopped(self):
        program = (
            "def p():\n  force_mode([0,0,0,0,0,0], [0,0,1,0,0,0], [0,0,{force},0,0,0], 0, [0.1,0.1,0.1,1,1,1])\n"
            "  sleep(3)\n  end_force_mode()\nend\n"
        )
        run = VirtualRobot("CS66", contact=self.table(1e4)).run(program.format(force=-400))
        assert "force_mode asks for 400 N; at more than 250 N the arm stops protectively" in str(run.warnings)
        assert (run.alarms[0].line, run.alarms[0].details["reason"]) == (2, "tcp_force")
        run = VirtualRobot("CS66", contact=self.table(1e4)).run(program.format(force=-100))
        assert (run.state, run.warnings) == ("finished", [])

    def test_time_leaps_where_nothing_can_touch(self):
        robot = VirtualRobot("CS66")
        robot.start(SWING)
        robot.advance(0.1)
        assert robot.controller.safety.next_tick(robot.tick) is None
