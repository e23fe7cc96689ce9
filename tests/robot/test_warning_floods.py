from elitescript.messages.events import Warned
from elitescript.messages.inputs import RunUnit
from elitescript.robot import VirtualRobot
from tests.kernel.machine import READY, Session

POINTS = [(0.4, -0.3 + 0.005 * (number % 2), 0.4 + 0.001 * number) for number in range(60)]
WEAVE = (
    "def weave():\n  movel([0.4, -0.3, 0.4, 3.14, 0, 0])\n"
    + "".join(f"  movel([{x:.4f}, {y:.4f}, {z:.4f}, 3.14, 0, 0], r=0.05)\n" for x, y, z in POINTS)
    + "end\n"
)


def shortened(events):
    return [event for event in events if isinstance(event, Warned) and "is shortened" in event.text]


def test_a_run_warns_of_one_kind_ten_times_and_then_counts():
    run = VirtualRobot().run(WEAVE)
    *each, count = shortened(run.events)
    assert run.state == "finished"
    assert len(each) == 10
    assert count.text.startswith("… 49 more of this kind, beginning with: r = 0.05 m is shortened")
    assert run.warnings.count(count.text) == 1
    assert run.events.index(count) > run.events.index(each[-1])


def test_the_next_run_of_the_same_robot_begins_anew():
    robot = VirtualRobot()
    first, second = robot.run(WEAVE), robot.run(WEAVE)
    assert len(shortened(first.events)) == len(shortened(second.events)) == 11


def test_a_served_program_is_warned_of_each_kind_once_with_its_lines():
    session = Session(READY)
    session.send(RunUnit("primary#1", "program", WEAVE))
    session.run(20.0)
    (warning,) = shortened(session.events)
    assert "(also in lines 5, 6, 7, 8, 9, 10, 11, 12, 13, 14 and 48 more)" in warning.text
