"""Programs with one mistake each that only some runs show, and the worlds around them."""

from __future__ import annotations

from typing import Final

from elitescript.records import NamedTuple
from elitescript.sweep.plans.plan import Plan, Variation


class Planted(NamedTuple):
    """A mistake.

    Attributes:
        plan: of the sweep that finds it.
        property: that does not hold.
        line: text of the line that the failure names.
        kinds: of disturbances that remain when it is shrunk.
    """

    plan: Plan
    property: str
    line: str
    kinds: tuple[tuple[str, ...], ...]


_LOST: Final = r"""
def lost_acknowledgement():
  socket_open("10.0.0.9", 5000, "gripper")
  for n in range(4):
    socket_send_string("close\n", "gripper")
    answer = ""
    while "ok" not in answer:
      answer = socket_read_string("gripper", "", "", 0.5)
    end
    sleep(1)
  end
end
"""

_GRIPPER: Final = """
[[tcp]]
name = "gripper"
port = 5000
latency_s = 0.1
[[tcp.replies]]
to = "close"
send = "ok"
"""

_RACE: Final = """
def race():
  global height
  def measure():
    global height
    while not get_standard_digital_in(2):
      sync()
    end
    height = 0.2
  end
  set_standard_digital_out(1, True)
  worker = start_thread(measure)
  sleep(0.6)
  twice = 2 * height
  sleep(2)
end
"""

_SENSOR: Final = """
[[wire]]
name = "sensor"
when = "standard_digital_out[1]"
then = "standard_digital_in[2]"
after_s = 0.3
"""

_CORNER: Final = """
def corner():
  x = 0.40
  y = 0.30
  movej(get_inverse_kin([x, y, 0.2, d2r(180), 0, 0]), a=3, v=2)
end
"""

_LEFT_ON: Final = """
def left_on():
  VALVE = 3
  movej([0, -1.5, 1.5, -1.5, -1.5, 0], a=2, v=1)
  for n in range(3):
    set_standard_digital_out(VALVE, True)
    movej([0.3, -1.5, 1.5, -1.5, -1.5, 0], a=2, v=0.5)
    set_standard_digital_out(VALVE, False)
    movej([0, -1.5, 1.5, -1.5, -1.5, 0], a=2, v=0.5)
  end
end
"""

PLANTED: Final = {
    "a lost acknowledgement": Planted(
        Plan(_LOST, world=_GRIPPER, world_name="cell.toml", chaos="channels", seed=1),
        "never_stuck",
        'answer = socket_read_string("gripper", "", "", 0.5)',
        (("drop",),),
    ),
    "a race of two threads": Planted(
        Plan(_RACE, world=_SENSOR, world_name="cell.toml", chaos="inputs", seed=1),
        "no_alarm",
        "twice = 2 * height",
        (("late",), ("stuck",)),
    ),
    "a corner of the box": Planted(
        Plan(
            _CORNER,
            variations=(Variation("x", "uniform", (0.2, 0.7)), Variation("y", "uniform", (0.0, 0.7))),
            ensure=("no_alarm",),
            seed=1,
        ),
        "no_alarm",
        "movej(get_inverse_kin([x, y, 0.2, d2r(180), 0, 0]), a=3, v=2)",
        ((),),
    ),
    "an output left on by a stop": Planted(
        Plan(_LEFT_ON, chaos="all", seed=1),
        "no_output_left_on",
        "set_standard_digital_out(VALVE, True)",
        (("protective_stop",),),
    ),
}
