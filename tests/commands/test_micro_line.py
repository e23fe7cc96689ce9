"""Point files as programs use them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from elitescript.commands import micro_line
from elitescript.errors import ArgumentRangeError, InvalidValueError, MotionError
from elitescript.kinematics.transforms import compose, pose_from_transform, transform_from_pose
from elitescript.messages.motion import MoveML
from tests.commands.conftest import CS66, Q_ACTUAL

JOINTS = b"# joints\n0.1 -1.2 1.3 -1.6 -1.5 0.2\n0.2 -1.2 1.3 -1.6 -1.5 0.2\n\n0.3 -1.2 1.3 -1.6 -1.5 0.2\n"
POSE = (0.35, 0.2, 0.4, 0.5, 1.0, -0.3)
POSES = " ".join(map(str, POSE)).encode() + b"\n0.35 0.21 0.4 0.5 1.0 -0.3\n9 9 9 0 0 0\n"


@pytest.fixture(autouse=True)
def files(robot: Any) -> dict[str, bytes]:
    robot.task_files = {"joints.txt": JOINTS, "poses.txt": POSES}
    held: dict[str, bytes] = robot.task_files
    return held


class TestLoading:
    def test_every_load_has_its_own_index(self, script: Callable[[str], Any], robot: Any) -> None:
        assert [script("load_micro_line_file('joints.txt', 4)") for _ in range(3)] == [0, 1, 2]
        line = robot.micro_lines[0]
        assert (line.name, line.interval_s, line.is_cartesian, len(line)) == ("joints.txt", 0.004, False, 3)
        assert robot.asked == []

    def test_equal_files_share_their_points(self, script: Callable[[str], Any], robot: Any) -> None:
        for _ in range(3):
            script("load_micro_line_file('joints.txt', 4)")
        first, second, third = robot.micro_lines
        assert first.numbers is second.numbers is third.numbers

    def test_what_is_changed_on_disk_is_seen_by_the_next_load(
        self, script: Callable[[str], Any], files: dict[str, bytes]
    ) -> None:
        script("load_micro_line_file('joints.txt', 4)")
        files["joints.txt"] = b"1 1 1 1 1 1\n"
        script("load_micro_line_file('joints.txt', 4)")
        assert script("get_micro_line_values_by_index(0, 0, 1)")[0] == pytest.approx(0.1)
        assert script("get_micro_line_values_by_index(1, 0, 1)")[0] == pytest.approx(1.0)

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("load_micro_line_file('no.txt', 4)", "the file 'no.txt' does not exist"),
            ("load_micro_line_file('bad.txt', 4)", "bad.txt, line 1: six numbers"),
        ],
    )
    def test_bad_files(self, script: Callable[[str], Any], files: dict[str, bytes], text: str, message: str) -> None:
        files["bad.txt"] = b"1 2 3\n"
        with pytest.raises(InvalidValueError, match=message):
            script(text)

    @pytest.mark.parametrize(
        "arguments", ["'joints.txt', 0", "'joints.txt', 3600001", "'joints.txt', 4, 2", "'joints.txt', 4, 0, 2"]
    )
    def test_ranges(self, script: Callable[[str], Any], arguments: str) -> None:
        with pytest.raises(ArgumentRangeError):
            script(f"load_micro_line_file({arguments})")

    def test_memory_is_bounded(
        self, script: Callable[[str], Any], files: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(micro_line, "POINTS_IN_ALL_MAX", 5)
        monkeypatch.setattr(micro_line, "INDICES_MAX", 4)
        script("load_micro_line_file('joints.txt', 4)")
        with pytest.raises(InvalidValueError, match="would hold more than 5 points"):
            script("load_micro_line_file('poses.txt', 4)")
        for _ in range(3):
            script("load_micro_line_file('joints.txt', 4)")
        with pytest.raises(InvalidValueError, match="has loaded 4 files already"):
            script("load_micro_line_file('joints.txt', 4)")


class TestPoints:
    def test_lines_without_a_point_do_not_count(self, script: Callable[[str], Any]) -> None:
        script("load_micro_line_file('joints.txt', 4)")
        assert [script(f"get_micro_line_values_by_index(0, 0, {n})")[0] for n in (1, 2, 3)] == [0.1, 0.2, 0.3]
        with pytest.raises(ArgumentRangeError, match=r"line_index must be in \[1, 3\]"):
            script("get_micro_line_values_by_index(0, 0, 4)")
        with pytest.raises(ArgumentRangeError):
            script("get_micro_line_values_by_index(0, 0, 0)")

    def test_pose_of_joints_is_that_of_the_active_tcp(self, script: Callable[[str], Any], robot: Any) -> None:
        script("load_micro_line_file('joints.txt', 4)")
        robot.machine.tcp_offset = (0.0, 0.0, 0.1, 0.0, 0.0, 0.0)
        T = CS66.forward_tcp(Q_ACTUAL, transform_from_pose(robot.machine.tcp_offset))
        assert script("get_micro_line_values_by_index(0, 1, 1)") == pytest.approx(pose_from_transform(T))

    def test_pose_of_poses_has_the_part_frame_worked_in(self, script: Callable[[str], Any]) -> None:
        script("load_micro_line_file('poses.txt', 4, 1)")
        assert script("get_micro_line_values_by_index(0, 1, 1)") == pytest.approx(POSE)
        frame = (0.1, -0.2, 0.05, 0.0, 0.0, 1.0)
        script(f"micro_line_set_pcs(0, {list(frame)})")
        T = compose(transform_from_pose(frame), transform_from_pose(POSE))
        assert script("get_micro_line_values_by_index(0, 1, 1)") == pytest.approx(pose_from_transform(T))

    def test_joints_of_poses_reach_them_and_are_near(self, script: Callable[[str], Any], robot: Any) -> None:
        script("load_micro_line_file('poses.txt', 4, 1)")
        robot.machine.tcp_offset = (0.0, 0.0, 0.1, 0.0, 0.0, 0.0)
        q = script("get_micro_line_values_by_index(0, 0, 1)")
        assert q == script(f"get_inverse_kin({list(POSE)})")
        with pytest.raises(MotionError, match=r"no joint position reaches line 3 of poses\.txt: too far by") as caught:
            script("get_micro_line_values_by_index(0, 0, 3)")
        assert caught.value.code == "R111"

    def test_a_frame_belongs_to_one_index(self, script: Callable[[str], Any], robot: Any) -> None:
        script("load_micro_line_file('poses.txt', 4, 1)")
        script("load_micro_line_file('poses.txt', 4, 1)")
        script("micro_line_set_pcs(0, [1, 0, 0, 0, 0, 0])")
        assert script("get_micro_line_values_by_index(1, 1, 1)") == pytest.approx(POSE)
        assert robot.asked == []

    def test_joint_positions_have_no_frame(self, script: Callable[[str], Any], robot: Any) -> None:
        script("load_micro_line_file('joints.txt', 4)")
        before = script("get_micro_line_values_by_index(0, 1, 1)")
        script("micro_line_set_pcs(0, [1, 0, 0, 0, 0, 0])")
        assert script("get_micro_line_values_by_index(0, 1, 1)") == before
        ((what, _, text),) = robot.asked
        assert what == "warn_once"
        assert "joints.txt holds joint positions" in text


class TestMoveml:
    @pytest.mark.parametrize(
        ("arguments", "first", "last"),
        [("0", 1, 3), ("0, 0, 0", 1, 3), ("0, 2", 2, 3), ("0, 0, 2", 1, 2), ("0, 2, 2", 2, 2), ("0, 3, 0", 3, 3)],
    )
    def test_lines(self, script: Callable[[str], Any], robot: Any, arguments: str, first: int, last: int) -> None:
        script("load_micro_line_file('joints.txt', 4)")
        script(f"moveml({arguments})")
        assert robot.asked == [MoveML(robot.micro_lines[0], first, last, 1.5, 1.1)]

    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            ("0, 3, 2", r"start_line must be at most end_line \(2\), got 3"),
            ("0, 4", r"start_line must be in \[0, 3\], the points of joints.txt; got 4"),
            ("0, 1, 4", r"end_line must be in \[0, 3\]"),
            ("0, -1", "start_line must be >= 0"),
            ("1", r"no file is loaded as 1"),
            ("-1", r"no file is loaded as -1"),
        ],
    )
    def test_wrong_numbers(self, script: Callable[[str], Any], robot: Any, arguments: str, message: str) -> None:
        script("load_micro_line_file('joints.txt', 4)")
        with pytest.raises(ArgumentRangeError, match=message) as caught:
            script(f"moveml({arguments})")
        assert caught.value.code == "R102"
        assert robot.asked == []

    def test_without_a_load(self, script: Callable[[str], Any]) -> None:
        for text in ("moveml(0)", "micro_line_set_pcs(0, [0] * 6)", "get_micro_line_values_by_index(0, 0, 1)"):
            with pytest.raises(ArgumentRangeError, match="no file is loaded as 0"):
                script(text)
