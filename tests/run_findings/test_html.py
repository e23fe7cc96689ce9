"""A run in a notebook: verdict, findings and a picture, small, escaped, and without scripts."""

from __future__ import annotations

import re
from base64 import b64decode
from pathlib import Path
from xml.etree import ElementTree

import pytest

from elitescript.robot import VirtualRobot
from elitescript.run.html import BAD, DOUBTFUL, FINDINGS_MAX, GOOD, _marks

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
SOUND = "def f():\n  sleep(0.1)\nend\n"
SERVO = "def f():\n  q = get_actual_joint_positions()\n  q[0] = q[0] + 0.8\n  servoj(q, t=0.008)\nend\n"
ALARM = "def f():\n  n = len([])\n  sleep(0.1)\n  x = 1 / n\nend\n"
ENDLESS = """def f():
  while True:
    set_standard_digital_out(0, True)
    sleep(0.5)
    set_standard_digital_out(0, False)
    sleep(0.5)
  end
end
"""


def shown(program, **settings):
    return VirtualRobot().run(program, **{"until_s": 5, **settings})._repr_html_()


def picture(html):
    """The image, parsed: it is well-formed XML."""
    (data,) = re.findall(r'src="data:image/svg\+xml;base64,([^"]*)"', html)
    return ElementTree.fromstring(b64decode(data))


def texts(image):
    return [node.text for node in image.iter() if node.tag.endswith("}text")]


@pytest.mark.parametrize(
    ("text", "color", "words"),
    [
        (SOUND, GOOD, "finished"),
        (SERVO, DOUBTFUL, "finished, 1 warning"),
        (ALARM, BAD, "ended by an alarm, 1 warning"),
        (ENDLESS, DOUBTFUL, "still running at the time limit"),
    ],
)
def test_verdict(text, color, words):
    assert f'<b style="color:{color}">{words}</b>' in shown(text)


def test_findings_have_their_place_and_advice():
    html = shown(SERVO)
    assert "warning W280" in html
    assert "line 4" in html
    assert "movej" in html
    many = "def f():\n" + "  x = get_standard_digital_in(0) == 'on'\n" * (FINDINGS_MAX + 3) + "  sleep(0.1)\nend\n"
    assert "and 3 more" in shown(many)


def test_a_pick_and_place_with_its_trace_is_small():
    robot = VirtualRobot()
    html = robot.run(EXAMPLES / "pick_and_place.script", trace=True)._repr_html_()
    assert len(html) < 100_000
    image = picture(html)
    assert sum(node.tag.endswith("}polyline") for node in image.iter()) == 6
    assert {"moves", "joint 1", "joint 6"} <= set(texts(image))


def test_signals_that_change_have_lanes():
    image = picture(shown(ENDLESS, until_s=4.9))
    assert "standard_digital_out[0]" in texts(image)
    lane = [node for node in image.iter() if node.tag.endswith("}rect")]
    assert len(lane) == 5
    widths = {node.get("width") for node in lane}
    assert len(widths) == 1, "each pulse takes half a second"


def test_a_signal_that_changes_in_every_tick_stays_small():
    text = "def f():\n  for i in range(20000):\n    set_standard_digital_out(0, i % 2 == 0)\n    sync()\n  end\nend\n"
    assert len(shown(text, until_s=None)) < 100_000


@pytest.mark.parametrize("text", ["<script>alert(1)</script>", '"><img src=x onerror=alert(1)>', "\x1b[2J", "]]>"])
def test_nothing_acts_in_texts_of_programs(text):
    html = shown(f"def f():\n  raise Exception({text!r})\nend\n")
    assert not re.search(r"<script|<img src=x|\x1b", html)
    assert "Exception" in html
    picture(html)


def test_a_run_that_has_not_ended_is_shown_too():
    robot = VirtualRobot()
    pages = []
    robot.run(SOUND, watch=lambda robot: pages.append(robot.current._repr_html_()) if not pages else None)
    assert "still running" in pages[0]


@pytest.mark.parametrize("span_s", [0.004, 0.1, 1.0, 1.428, 7.0, 60.0, 119.028, 86_400.0])
def test_marks_of_the_axis_are_few(span_s):
    marks = list(_marks(span_s))
    assert 4 <= len(marks) <= 12
    assert marks[-1] <= span_s
