"""A whole task with all its parts, read from a file as pendants write it, and its script written by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

from elitescript import VirtualRobot
from elitescript.program_tree import generated, read_task, task_bytes

TASK = """\
<EliTask name="取料-1" installationName="cell" robotType="CS66" createdVersion="2.15.0.477">
  <InitVariables typeName="Init Variables Value"/>
  <BeforeStart typeName="BeforeStart">
    <AssignmentNode valueSourceType="EXPRESSION" deepCopy="false" typeName="Assignment">
      <TaskVariable name="n" type="Default" prefersPersistentValue="false" favorite="false" describe=""/>
      <Expression><ExpressionCharCell char="0"/></Expression>
    </AssignmentNode>
  </BeforeStart>
  <MainTask isTaskAlwaysLoops="false" hasBeforeStart="true" hasInitVariables="true" typeName="Robot Main Task">
    <TimerNode action="RESET" typeName="Timer"><variable name="t1" prefersPersistentValue="false"/></TimerNode>
    <TimerNode action="START" typeName="Timer"><variable reference="../../TimerNode/variable"/></TimerNode>
    <CallSubTaskNode typeName="Call">
      <subTask name="grip" isHideSubtree="false" isSynchronized="false" isTracking="false" typeName="Subtask">
        <children>
          <AssignmentNode valueSourceType="EXPRESSION" deepCopy="false" typeName="Assignment">
            <TaskVariable reference="../../../../../../BeforeStart/AssignmentNode/TaskVariable"/>
            <Expression>
              <ExpressionVariableCell>
                <TaskVariable reference="../../../../../../../../BeforeStart/AssignmentNode/TaskVariable"/>
              </ExpressionVariableCell>
              <ExpressionCharCell char="+"/><ExpressionCharCell char="1"/>
            </Expression>
          </AssignmentNode>
        </children>
      </subTask>
    </CallSubTaskNode>
    <CallSubTaskNode typeName="Call"><subTask reference="../../CallSubTaskNode/subTask"/></CallSubTaskNode>
    <TimerNode action="STOP" typeName="Timer"><variable reference="../../TimerNode/variable"/></TimerNode>
  </MainTask>
  <SubTaskNode reference="../MainTask/CallSubTaskNode/subTask"/>
  <ThreadNode name="watch" isLoop="true" typeName="Thread">
    <children><WaitNode type="WAIT_TIME" typeName="Wait"><waitTime value="0.1" unit="S"/></WaitNode></children>
  </ThreadNode>
  <EventNode name="door" typeName="Event">
    <Expression><ExpressionPinCell><pin referenceName="digital_in[3]"/></ExpressionPinCell></Expression>
    <children><HaltNode typeName="Halt"/></children>
  </EventNode>
</EliTask>
"""

SCRIPT = """\
  # Initial Variables value.
  global n
  # Timer Node Preamble Script.
  global t1
  t1 = 0
  global timer_t1_on
  timer_t1_on = False
  def timer_thread():
    global t1
    while (True):
      if (timer_t1_on):
        t1 = t1 + get_steptime()
      end
      sync()
    end
  end
  threadId_timer_thread = start_thread(timer_thread, (), detach_mode = False)
  # SubTask Node Preamble Script.
  def subTask_grip():
    global n
    $ LINE: (10, "grip")
    $ LINE: (11, "Assignment")
    n = n+1
  end
  # Before Start Preamble Script.
  $ LINE: (2, "BeforeStart")
  $ LINE: (3, "Assignment")
  n = 0
  # Thread Node Preamble Script.
  def watch():
    while (True):
      $ LINE: (12, "watch")
      $ LINE: (13, "Wait")
      sleep(0.1)
    end
  end
  threadId_watch = start_thread(watch, (), detach_mode = False)
  # Event Node Preamble Script.
  def door():
    while (True):
      if (get_standard_digital_in(3)):
        $ LINE: (14, "door")
        $ LINE: (15, "Halt")
        halt()
        while (get_standard_digital_in(3)):
          sync()
        end
      end
      sync()
    end
  end
  threadId_door = start_thread(door, (), detach_mode = False)
  # Main Task Script.
  $ LINE: (4, "Robot Main Task")
  $ LINE: (5, "Timer")
  t1 = 0
  $ LINE: (6, "Timer")
  timer_t1_on = True
  $ LINE: (7, "grip")
  subTask_grip()
  $ LINE: (8, "grip")
  subTask_grip()
  $ LINE: (9, "Timer")
  timer_t1_on = False
end
"""


def test_the_script_of_all_parts() -> None:
    task = read_task(TASK.encode())
    assert task_bytes(task) == TASK.encode()
    found = generated(task, None, ())
    assert found.problems == ()
    head, mark, rest = found.text.partition("  # Initial Variables value.\n")
    assert head.startswith("def 取料_1():\n")
    assert f"{mark}{rest}" == SCRIPT


@pytest.mark.parametrize(("door_s", "state"), [(None, "finished"), (0.02, "stopped")])
def test_it_runs(door_s: float | None, state: str, tmp_path: Path) -> None:
    """Twice the sub-task counts; the event halts the program, if the door opens while it runs."""
    wait = '<WaitNode type="WAIT_TIME" typeName="Wait"><waitTime value="0.5" unit="S"/></WaitNode>'
    path = tmp_path / "cell.task"
    path.write_text(TASK.replace("  </MainTask>", f"    {wait}\n  </MainTask>"), encoding="utf-8")
    robot = VirtualRobot("CS66")
    if door_s is not None:
        robot.at(door_s, "standard_digital_in[3]", True)
    run = robot.run(path)
    assert run.state == state
    assert run.globals["n"] == 2
    assert run.time_s == pytest.approx(0.5 if door_s is None else door_s, abs=0.01)
