"""Readings of a client's force sensor in the place of the arm's own."""

from __future__ import annotations

import pytest

from elitescript.robot import VirtualRobot


def run(*lines: str, wrench=(), payload="set_payload(0, [0, 0, 0])"):
    robot = VirtualRobot()
    for index, value in enumerate(wrench):
        robot.signals[f"external_force_torque[{index}]"] = value
    body = "".join(f"  {line}\n" for line in (payload, *lines, "f = get_tcp_force(True)"))
    return robot.run(f"def a():\n  global f\n{body}end\n").check().globals["f"]


def test_they_do_not_count_before_they_are_enabled():
    assert run(wrench=(1, 2, 3)) == pytest.approx([0] * 6)


def test_they_are_read_along_the_axes_of_the_tool_once_they_are():
    assert run("ft_rtsi_input_enable(True)", wrench=(1, 2, 3, 4, 5, 6)) == pytest.approx([1, 2, 3, 4, 5, 6])


def test_and_no_more_when_they_are_disabled():
    assert run("ft_rtsi_input_enable(True)", "ft_rtsi_input_enable(False)", wrench=(1, 2, 3)) == pytest.approx([0] * 6)


def test_the_payload_changes_nothing_in_them():
    force = run("ft_rtsi_input_enable(True)", wrench=(1, 2, 3), payload="set_payload(2, [0, 0, 0.05])")
    assert force == pytest.approx([1, 2, 3, 0, 0, 0])


def test_moments_are_about_the_tcp():
    """A force along x, measured 0.1 m behind the TCP, has a moment about y."""
    lines = ("set_tcp([0, 0, 0.1, 0, 0, 0])", "ft_rtsi_input_enable(True)")
    assert run(*lines, wrench=(10, 0, 0)) == pytest.approx([10, 0, 0, 0, -1, 0])
    lines = ("set_tcp([0, 0, 0.1, 0, 0, 0])", "ft_rtsi_input_enable(True, 0.3, [0, 0, 0.1])")
    assert run(*lines, wrench=(10, 0, 0)) == pytest.approx([10, 0, 0, 0, 0, 0])


def test_the_zero_counts():
    assert run("ft_rtsi_input_enable(True)", "zero_ftsensor()", wrench=(1, 2, 3)) == pytest.approx([0] * 6)
