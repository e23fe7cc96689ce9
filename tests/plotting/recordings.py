"""Recordings for the tests of the page: made by hand, or by a short program."""

from random import Random

from elitescript import VirtualRobot
from elitescript.controller.views.trace import TraceRow
from elitescript.controller.views.trace_signals import NO_SIGNALS
from elitescript.language.text.source import SourceFile
from elitescript.models.model import load_model
from elitescript.plotting.page import Recording

PROGRAM = """def job():
  set_standard_digital_out(2, True)
  movej([0.4, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
  sleep(0.5)
  set_standard_digital_out(2, False)
  textmsg("</script><b>done</b>")
  movel([0.4, -0.2, 0.4, 3.14, 0, 0], a=1.2, v=0.25)
end
"""


def row(t, line=1, q1=0.0, qd1=0.0, x=0.4, state="playing"):
    return TraceRow(t, line, (q1, 0.0, 0.0, 0.0, 0.0, 0.0), (qd1, 0.0, 0.0, 0.0, 0.0, 0.0), (x, 0, 0.3, 0, 0, 0), state)


def restless(count):
    """Rows in which everything changes in every tick."""
    chance = Random(5)

    def six(width):
        return tuple(chance.uniform(-width, width) for _ in range(6))

    return [TraceRow(k * 0.004, 1 + k % 7, six(6.0), six(3.0), six(0.9), "playing") for k in range(count)]


def recorded(program=PROGRAM, plant=None):
    robot = VirtualRobot("CS66", plant=plant)
    run = robot.run(program, trace=True, until_s=60)
    rows = [row._replace(signals=NO_SIGNALS) for row in run.trace]
    return Recording("job.script", robot.model, rows, SourceFile("job.script", program), run.events, run.state)


def of_rows(rows):
    return Recording("out.csv", load_model("CS66"), rows)
