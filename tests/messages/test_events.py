"""Events as values: their text is Python that makes them again, as snapshots of tests need it."""

from __future__ import annotations

from elitescript import VirtualRobot
from elitescript.messages import enums, events, motion, path_offset, yielding

MODULES = (enums, events, motion, path_offset, yielding)
NAMES = {name: value for module in MODULES for name, value in vars(module).items()}
CELL = """def cell():
  movej([0.3, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
  set_standard_digital_out(0, True)
  textmsg("one ", 1)
  movel(pose_add(get_actual_tcp_pose(), [0, 0, 0.05, 0, 0, 0]))
  sleep(3)
  movej([9, 0, 0, 0, 0, 0])
end
"""


def test_the_repr_of_events_evaluates_to_them():
    robot = VirtualRobot()
    robot.at(2.0, "safeguard_stop", True)
    robot.at(3.0, "safeguard_stop", False)
    found = robot.run(CELL).events
    kinds = {type(event).__name__ for event in found}
    assert kinds >= {"Alarm", "MotionStarted", "SafetyModeChanged", "SignalChanged", "TaskStateChanged", "TextMessage"}
    assert eval(repr(found), NAMES) == found


def test_so_does_that_of_every_mode():
    for kind in (enums.RobotMode, enums.SafetyMode, enums.TaskState, path_offset.OffsetFrame):
        assert eval(repr(list(kind)), NAMES) == list(kind)
